"""Errors of a method at a setting, against the reference in extended precision.

    error              mode 1 one period after the start, past the collision: distance of (q/size, q'/speed)
    error_time         first touch (or release), over the period
    error_restitution  of the first collision, as a number
    error_kick         the same
    error_fold         shift of the fold of p_m, over the grazing amplitude (`fold_shift`)
    missed             share of planted crossings without an impact; largest_missed their largest overshoot

None stands for what does not exist (no drive), was not reached (no collision), or lies beyond the first order
(`fold_note` says so).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp

from contact.collision import collisions
from contact.errors import ContactError
from contact.integrators import Integrator
from contact.simulation import simulate
from contact.trajectory import ImpactKind
from studies.instruments.work_precision.crossings import Plant, missed_share, plants
from studies.instruments.work_precision.extended_reference import Reference, reference_of
from studies.instruments.work_precision.fold_shift import FoldTest, fold_test
from studies.instruments.work_precision.problems import Problem

__all__ = [
    "MEASURES", "Yardstick", "collision_errors", "fold_errors", "missed_crossings", "sentence_of",
    "yardstick_of",
]  # fmt: skip

MEASURES = ("error", "error_time", "error_restitution", "error_kick", "error_fold", "missed")


@dataclass(frozen=True, kw_only=True, eq=False)
class Yardstick:
    """What the errors on one problem are measured with."""

    problem: Problem
    reference: Reference
    fold: FoldTest | None
    fold_error: float
    planted: list[Plant]

    @property
    def reference_error(self) -> dict[str, float]:
        """Differences of the two routes to the reference, by measure."""
        found = {"error": self.reference.error["state"], "error_time": self.reference.error.get("time", 0.0)}
        for name in ("restitution", "kick"):
            if name in self.reference.error:
                found[f"error_{name}"] = self.reference.error[name]
        if self.fold is not None:
            found["error_fold"] = self.fold_error
        return found


def yardstick_of(problem: Problem) -> Yardstick:
    """References of a problem, each by two routes."""
    reference = reference_of(
        problem.oscillator, problem.start, [problem.probe], scales=problem.scales, period=problem.period,
        near=problem.collision, touches=problem.touches,
    )  # fmt: skip
    test, fold_error = None, 0.0
    if problem.fold is not None:
        fold = problem.fold
        image = reference_of(
            fold.oscillator, fold.state, [fold.periods * fold.oscillator.period], scales=problem.scales,
            period=problem.period,
        )  # fmt: skip
        q, v = image.states[0]
        test = fold_test(fold, np.array([float(x) for x in (*q, *v)]))
        reach = float(np.abs(test.left) @ np.concatenate(problem.scales))
        fold_error = image.error["state"] * reach / abs(test.slope) / test.grazing_amplitude
    return Yardstick(
        problem=problem, reference=reference, fold=test, fold_error=fold_error,
        planted=plants(problem.oscillator),
    )  # fmt: skip


def sentence_of(error: Exception) -> str:
    """What goes into `failed`."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _difference(found: float, exact: Any) -> float | None:
    """|found - exact|, formed in extended precision."""
    return float(abs(mp.mpf(found) - exact)) if math.isfinite(found) and exact is not None else None


def collision_errors(yardstick: Yardstick, method: Integrator) -> dict[str, float | None]:
    """The errors of the run through the first collision."""
    problem, reference = yardstick.problem, yardstick.reference
    run = simulate(
        problem.oscillator, problem.start, duration=problem.duration, times=np.array([problem.probe]),
        method=method,
    )  # fmt: skip
    (displacement, velocity), k = reference.states[0], problem.mode
    away = float(abs(mp.mpf(float(run.displacement[0, k])) - displacement[k])) / problem.size
    fast = float(abs(mp.mpf(float(run.velocity[0, k])) - velocity[k])) / problem.speed
    found: dict[str, float | None] = {
        "error": math.hypot(away, fast), "error_time": None, "error_restitution": None, "error_kick": None,
    }  # fmt: skip
    touches = np.flatnonzero(run.impacts.kind == ImpactKind.IMPACT)
    if touches.size:
        timed = run.impacts.end if problem.timed_end else run.impacts.start
        late = _difference(
            float(timed[touches[0]]), reference.end if problem.timed_end else reference.start
        )
        found["error_time"] = None if late is None else late / problem.period
    if problem.collision is not None:
        met = collisions(problem.oscillator, run, unfinished="drop")
        if met:
            found["error_restitution"] = _difference(met[0].restitution, reference.restitution)
            found["error_kick"] = _difference(met[0].kick, reference.kick)
    return found


def fold_errors(yardstick: Yardstick, method: Integrator) -> dict[str, Any]:
    """The shift of the fold, or why there is none."""
    test = yardstick.fold
    if test is None:
        return {"error_fold": None, "fold_note": "no fold"}
    fold = test.fold
    try:
        end = simulate(fold.oscillator, fold.state, periods=fold.periods, method=method).end
    except ContactError as error:
        return {"error_fold": None, "fold_note": sentence_of(error)}
    shift = test.shift(end)
    if not test.within_first_order(shift):
        return {"error_fold": None, "fold_note": f"beyond first order: {shift:.2g} against {fold.excess:.2g}"}
    return {"error_fold": abs(shift), "fold_note": ""}


def missed_crossings(yardstick: Yardstick, method: Integrator) -> dict[str, float | None]:
    """The share of planted crossings missed, and the largest of them."""
    missed, largest = missed_share(method, yardstick.planted)
    return {"missed": missed, "largest_missed": largest}
