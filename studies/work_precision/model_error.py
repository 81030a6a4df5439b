r"""Error of the truncated beam beside the error of the time step: which of the two is worth refining.

For N modes (scene's beam, Hertz contact, the first collision at 21.50 Hz and F/F_g - 1 = 0.013),

    model error    distance of mode 1 one drive period after the start between N and 4 N modes of the same
                   mesh, both by the exact method, each at its own grazing amplitude
    step error     the same distance between central difference with step h and the exact method, N modes

in the scales of ``problems``. Where the step error lies below the model error a finer step is wasted; the
step at which the two are equal follows by interpolation of log(error) over log(h).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from contact import ContactError, simulate
from contact.integrators import CentralDifference, Exact, Integrator
from studies.run import Run
from studies.scene import Scene
from studies.work_precision.measures import cost_of
from studies.work_precision.problems import Problem, driven_problem, hertz_beam

__all__ = ["ModelError", "balanced_step", "model_errors"]

COUNTS, COUNTS_QUICK = (1, 2, 3, 4, 6, 8, 12, 16, 24), (2, 4, 8)
"""Numbers of modes: 24 reach 27 kHz, two swings in a contact."""

FACTOR = 4
"""The larger model has this many times as many modes."""

STEPS = (32e-6, 16e-6, 8e-6, 4e-6, 1e-6)
"""Steps of central difference, from half a contact [s]; coarser ones are refused for any number of modes."""


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """Error of a number of modes, what the exact method costs with it, and the step that errs as much."""

    modes: int
    error: float
    us_per_period: float
    balanced_step_s: float | None
    """None outside the steps tried."""


def balanced_step(errors: Sequence[float | None], level: float) -> float | None:
    """The step whose error is `level` among those of the `STEPS` (None where a step is refused), None if none
    of the intervals holds it [s]."""
    known = [(step, error) for step, error in zip(STEPS, errors, strict=True) if error]
    for (h0, e0), (h1, e1) in pairwise(known):
        if min(e0, e1) <= level <= max(e0, e1) and e0 != e1:
            return float(h0 * (h1 / h0) ** (math.log(level / e0) / math.log(e1 / e0)))
    return None


def mode_1(problem: Problem, probe: float, method: Integrator) -> complex | None:
    """Scaled q + i q' of mode 1 at time `probe` [s]; None where the method refuses its step, or a contact."""
    try:
        run = simulate(problem.oscillator, problem.start, duration=problem.duration, times=np.array([probe]),
                       method=method)  # fmt: skip
    except ContactError:
        return None
    return complex(run.displacement[0, 0] / problem.size, run.velocity[0, 0] / problem.speed)


def model_errors(scene: Scene, run: Run) -> list[ModelError]:
    """Both errors and the cost for every number of modes."""
    counts, found = COUNTS_QUICK if run.quick else COUNTS, []
    problems = {
        n: driven_problem("hertz", f"{n} modes", hertz_beam(scene.replace({"modes.count": n})))
        for n in sorted({*counts, *(FACTOR * n for n in counts)})
    }
    for n in run.track(counts, "number of modes against time step"):
        here, probe = problems[n], problems[n].probe
        exact, more = (mode_1(one, probe, Exact()) or math.nan for one in (here, problems[FACTOR * n]))
        stepped = [mode_1(here, probe, CentralDifference(step=h)) for h in STEPS]
        errors = [None if one is None else abs(one - exact) for one in stepped]
        level = abs(exact - more)
        found.append(ModelError(modes=n, error=level, us_per_period=cost_of(here, Exact()),
                                balanced_step_s=balanced_step(errors, level)))  # fmt: skip
    return found
