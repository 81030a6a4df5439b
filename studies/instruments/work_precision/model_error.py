r"""Error of the truncated beam beside the error of the time step: which of the two is worth refining.

For N modes (scene's beam, Hertz contact, the first collision at 21.50 Hz and F/F_g - 1 = 0.013),

    model error    distance of mode 1 one drive period after the start between N and 4 N modes of the same
                   mesh, both by the exact method, each at its own grazing amplitude
    step error     the same distance between central difference with step h and the exact method, N modes

in the scales of ``problems``.  Where the step error lies below the model error a finer step is wasted; the
step at which the two are equal follows by interpolation of log(error) over log(h).  Costs are microseconds
per drive period over a settled orbit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.integrators import CentralDifference, method_for
from contact.simulation import simulate
from contact.stop import Stop
from studies.instruments.oscillators import beam_of, hertz_of
from studies.instruments.scene import Scene
from studies.instruments.work_precision.cost import cost_of
from studies.instruments.work_precision.problems import EXCESS, FREQUENCY, Problem, driven_problem

__all__ = ["ModelErrors", "balanced_step", "model_errors"]

COUNTS, COUNTS_QUICK = (1, 2, 3, 4, 6, 8, 12, 16, 24), (2, 4, 8, 16)
"""Numbers of modes: 24 reach 27 kHz, two swings in a contact."""

FACTOR = 4
"""The larger model has this many times as many modes."""

STEPS, STEPS_QUICK = (32e-6, 16e-6, 8e-6, 4e-6, 1e-6), (16e-6, 4e-6)
"""Steps of central difference, from half a contact [s]; coarser ones are refused for any number of modes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelErrors:
    """Arrays over the number of modes (rows) and the steps (columns); NaN where a step is refused.

    `balance` is the step at which both errors are equal [s], NaN outside the steps tried.
    """

    modes: np.ndarray
    steps: np.ndarray
    model_error: np.ndarray
    step_error: np.ndarray
    default_cost: np.ndarray
    step_cost: np.ndarray
    balance: np.ndarray

    def rows(self) -> list[dict[str, Any]]:
        """For the summary, one a number of modes."""
        return [
            {
                "modes": int(n), "model_error": float(self.model_error[i]),
                "us_per_period": float(self.default_cost[i]), "balanced_step": float(self.balance[i]),
                "steps": self.steps, "step_errors": self.step_error[i], "step_us": self.step_cost[i],
            }
            for i, n in enumerate(self.modes)
        ]  # fmt: skip


def balanced_step(steps: Sequence[float], errors: Sequence[float], level: float) -> float:
    """The step at which the error of the step is `level`, NaN if none of the intervals holds it [s]."""
    pairs = [(h, e) for h, e in zip(steps, errors, strict=True) if math.isfinite(e) and e > 0]
    for (h0, e0), (h1, e1) in pairwise(pairs):
        if min(e0, e1) <= level <= max(e0, e1) and e0 != e1:
            part = math.log(level / e0) / math.log(e1 / e0)
            return h0 * (h1 / h0) ** part
    return math.nan


def _problem(scene: Scene, count: int) -> Problem:
    beam = beam_of(scene.replace({"modes.count": count}), FREQUENCY)
    hertz = replace(beam, stop=Stop(gap=scene.stop.gap_m, law=hertz_of(scene)))
    return driven_problem("hertz", f"{count} modes", hertz.with_excess(EXCESS), fold=False)


def _mode_1(problem: Problem, probe: float, method: CentralDifference | None = None) -> np.ndarray:
    """Scaled (q, q') of mode 1 at time `probe`."""
    run = simulate(
        problem.oscillator, problem.start, duration=problem.duration, times=np.array([probe]), method=method
    )
    return np.array([run.displacement[0, 0] / problem.size, run.velocity[0, 0] / problem.speed])


def model_errors(scene: Scene, *, quick: bool = False) -> ModelErrors:
    """Both errors and the costs for every number of modes."""
    counts = COUNTS_QUICK if quick else COUNTS
    steps = STEPS_QUICK if quick else STEPS
    shape = (len(counts), len(steps))
    model, default_cost = np.empty(shape[0]), np.empty(shape[0])
    step_error, step_cost, balance = np.full(shape, np.nan), np.full(shape, np.nan), np.empty(shape[0])
    problems = {n: _problem(scene, n) for n in sorted({*counts, *(FACTOR * n for n in counts)})}
    for i, n in enumerate(counts):
        here = problems[n]
        exact = _mode_1(here, here.probe)
        model[i] = np.hypot(*(exact - _mode_1(problems[FACTOR * n], here.probe)))
        default_cost[i] = cost_of(here, method_for(here.law)).microseconds
        for j, h in enumerate(steps):
            method = CentralDifference(step=h)
            try:
                step_error[i, j] = np.hypot(*(_mode_1(here, here.probe, method) - exact))
                step_cost[i, j] = cost_of(here, method, repeats=1).microseconds
            except ContactError:
                continue  # refused as unstable: the row shows no number
        balance[i] = balanced_step(steps, step_error[i], model[i])
    return ModelErrors(
        modes=np.array(counts), steps=np.array(steps), model_error=model, step_error=step_error,
        default_cost=default_cost, step_cost=step_cost, balance=balance,
    )  # fmt: skip


