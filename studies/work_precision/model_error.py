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
from numpy.typing import NDArray

from contact import ContactError, simulate
from contact.integrators import CentralDifference, Integrator, method_for
from studies.run import Run
from studies.scene import Scene
from studies.work_precision.measures import cost_of
from studies.work_precision.problems import Problem, driven_problem, hertz_beam

__all__ = ["ModelError", "StepError", "balanced_step", "model_errors"]

COUNTS, COUNTS_QUICK = (1, 2, 3, 4, 6, 8, 12, 16, 24), (2, 4, 8)
"""Numbers of modes: 24 reach 27 kHz, two swings in a contact."""

FACTOR = 4
"""The larger model has this many times as many modes."""

STEPS, STEPS_QUICK = (32e-6, 16e-6, 8e-6, 4e-6, 1e-6), (16e-6, 4e-6)
"""Steps of central difference, from half a contact [s]; coarser ones are refused for any number of modes."""


@dataclass(frozen=True, kw_only=True)
class StepError:
    """Error of a time step and what it costs; None where the step is refused."""

    step_s: float
    error: float | None
    us_per_period: float | None


@dataclass(frozen=True, kw_only=True)
class ModelError:
    """Error of a number of modes, what the exact method costs with it, and the step that errs as much."""

    modes: int
    error: float
    us_per_period: float
    balanced_step_s: float | None
    """None outside the steps tried."""
    steps: list[StepError]


def balanced_step(steps: Sequence[StepError], level: float) -> float | None:
    """The step whose error is `level`, None if none of the intervals holds it [s]."""
    known = [(one.step_s, one.error) for one in steps if one.error]
    for (h0, e0), (h1, e1) in pairwise(known):
        if min(e0, e1) <= level <= max(e0, e1) and e0 != e1:
            return float(h0 * (h1 / h0) ** (math.log(level / e0) / math.log(e1 / e0)))
    return None


def mode_1(problem: Problem, probe: float, method: Integrator | None = None) -> NDArray[np.float64]:
    """Scaled (q, q') of mode 1 at time `probe` [s]."""
    run = simulate(problem.oscillator, problem.start, duration=problem.duration, times=np.array([probe]),
                   method=method)  # fmt: skip
    return np.array([run.displacement[0, 0] / problem.size, run.velocity[0, 0] / problem.speed])


def step_error(problem: Problem, step: float, exact: NDArray[np.float64]) -> StepError:
    """The error of central difference with `step` [s]; it may refuse the step, or a contact later on."""
    method, error, cost = CentralDifference(step=step), None, None
    try:
        error = float(np.hypot(*(mode_1(problem, problem.probe, method) - exact)))
        cost = cost_of(problem, method, 1)[0]
    except ContactError:
        pass
    return StepError(step_s=step, error=error, us_per_period=cost)


def model_errors(scene: Scene, run: Run) -> list[ModelError]:
    """Both errors and the costs for every number of modes."""
    counts, steps = (COUNTS_QUICK, STEPS_QUICK) if run.quick else (COUNTS, STEPS)
    problems = {
        n: driven_problem("hertz", f"{n} modes", hertz_beam(scene.replace({"modes.count": n})))
        for n in sorted({*counts, *(FACTOR * n for n in counts)})
    }
    found = []
    for n in run.track(counts, "number of modes against time step"):
        here = problems[n]
        exact = mode_1(here, here.probe)
        level = float(np.hypot(*(exact - mode_1(problems[FACTOR * n], here.probe))))
        errors = [step_error(here, h, exact) for h in steps]
        cost = cost_of(here, method_for(here.oscillator.stop.law.code))[0]
        found.append(ModelError(modes=n, error=level, us_per_period=cost,
                                balanced_step_s=balanced_step(errors, level), steps=errors))  # fmt: skip
    return found
