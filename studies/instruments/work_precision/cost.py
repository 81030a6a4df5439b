"""What a method costs: seconds per drive period along the settled orbit.

The run is repeated, warm, and the median taken; it is made long enough that the clock and the call itself do
not count (the swung beam's 12 ms cannot be made longer: there the call, 0.1 ms, is part of the cost).
Nothing else of the study runs meanwhile.  What is counted is the processor's time in the thread, which all
methods here use alone: on a free core it is the time that passes, on a busy one it does not grow.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

from contact.integrators import Integrator
from contact.simulation import simulate
from studies.instruments.work_precision.problems import Problem

__all__ = ["Cost", "cost_of"]

REPEATS = 9
LONG_ENOUGH = 0.01
"""Length of a timed run [s], a hundred times the call's own."""

MOST_PERIODS = 512
"""Bound of the periods of a timed run."""

PATIENCE = 0.4
"""Time spent on the repetitions of one point at most [s]; a slower run is timed once."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """Per drive period: time [us] and evaluations, flights or steps [1]; and the number of timed runs."""

    microseconds: float
    evaluations: float
    repeats: int


def cost_of(problem: Problem, method: Integrator, *, repeats: int = REPEATS) -> Cost:
    """Time and evaluations of `method` on the cost run of `problem`."""
    periods = problem.cost_periods

    def once(count: int) -> tuple[float, int]:
        begun = time.thread_time()
        run = simulate(problem.oscillator, problem.cost_start, duration=count * problem.period, method=method)
        return time.thread_time() - begun, run.evaluations

    took, evaluations = once(periods)
    if problem.oscillator.drive is not None:
        while took < LONG_ENOUGH and periods < MOST_PERIODS:
            periods = min(MOST_PERIODS, periods * max(2, min(8, int(LONG_ENOUGH / took))))
            took, evaluations = once(periods)
    times = [took]
    if took < PATIENCE:
        count = max(1, min(repeats, int(PATIENCE / took)))
        times = [once(periods)[0] for _ in range(count)]
    return Cost(
        microseconds=1e6 * statistics.median(times) / periods, evaluations=evaluations / periods,
        repeats=len(times),
    )  # fmt: skip
