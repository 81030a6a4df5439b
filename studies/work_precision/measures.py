"""Errors and costs of every method at every setting, the Pareto front, and the orders that the errors show.

    error         mode 1 at the probe, past the collision: distance of (q/size, q'/speed) from the reference
    error_time    first touch (swung beam: first release), over the period
    missed        share of the known crossings without an impact; largest_missed their largest overshoot
    us_per_period processor time of the thread per drive period along the settled orbit, the median of warm
                  runs long enough that the clock and the call do not count (the swung beam's 12 ms cannot be
                  made longer: there the call, 0.1 ms, is part of the cost)

All methods here use one thread, whose time is on a free core the time that passes, and does not grow on a
busy one. None stands for what does not exist (no drive) or was not reached (no touch). A setting that fails
is a row with the sentence of its failure; one whose drive period is expected to take longer than a bound,
from the setting before it, is a row that says so.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np

from contact import simulate
from contact.integrators import Integrator
from studies.work_precision.crossings import KnownCrossing, known_crossings, missed_share
from studies.work_precision.methods import EXACT, STEPPED, Sweep
from studies.work_precision.problems import Problem
from studies.work_precision.reference import DIGITS, extended_motion

__all__ = [
    "Order", "Reference", "Row", "cheapest", "cost_of", "errors_of", "front", "measured_order", "orders_of",
    "reference_of", "rows_of",
]  # fmt: skip

REPEATS = 9
"""Timed runs of a point."""

SLOWEST = 0.5
"""Longest time for one drive period of a setting that is run [s]: its errors and its cost take twenty."""

LONG_ENOUGH = 0.01
"""Length of a timed run [s], a hundred times the call's own."""

MOST_PERIODS = 512
"""Bound of the periods of a timed run."""

PATIENCE = 0.4
"""Time spent on the repetitions of one point at most [s]; a slower run is timed once."""

ROUNDING, COARSE, FEWEST = 1e-11, 3e-2, 3
"""Errors between which an order is read, and the fewest settings for it: above, a method is not yet in its
asymptotic range; below, rounding over millions of steps shows."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A method at a setting on a problem."""

    problem: str
    method: str
    family: str
    setting: str
    value: float | None
    """Step [s], spacing of samples over the period, or tolerance [1]."""
    order: float | None
    certified: bool
    error: float | None = None
    error_time: float | None = None
    missed: float | None = None
    largest_missed: float | None = None
    us_per_period: float | None = None
    evaluations_per_period: float | None = None
    repeats: int = 0
    failed: str = ""

    @property
    def default(self) -> bool:
        """Whether `simulate` takes it by default."""
        return self.family == EXACT

    @property
    def named(self) -> str:
        """Method and setting."""
        return self.method if self.default else f"{self.method}, {self.setting}"


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """What the errors on one problem are measured with; `own_error` and `own_error_time` are its own."""

    problem: Problem
    displacement: Decimal
    velocity: Decimal
    instant: Decimal
    own_error: float
    own_error_time: float
    crossings: list[KnownCrossing]


def reference_of(problem: Problem) -> Reference:
    """The reference of a problem, from the runs of both precisions."""
    probes = []
    for digits in DIGITS:
        motion = extended_motion(problem.oscillator, problem.start, [problem.probe], digits)
        (q, v), touch = motion.states[0], motion.touches[0]
        probes.append((q[0], v[0], touch.end if problem.timed_end else touch.start))
    one, other = probes
    away, fast, late = (float(abs(a - b)) for a, b in zip(one, other, strict=True))
    return Reference(
        problem=problem, displacement=one[0], velocity=one[1], instant=one[2],
        own_error=math.hypot(away / problem.size, fast / problem.speed), own_error_time=late / problem.period,
        crossings=known_crossings(problem.oscillator),
    )  # fmt: skip


def errors_of(reference: Reference, method: Integrator) -> tuple[float, float | None]:
    """Error of mode 1 and of the first touch; differences are formed in extended precision."""
    problem = reference.problem
    run = simulate(problem.oscillator, problem.start, duration=problem.duration,
                   times=np.array([problem.probe]), method=method)  # fmt: skip
    away = float(abs(Decimal(float(run.displacement[0, 0])) - reference.displacement)) / problem.size
    fast = float(abs(Decimal(float(run.velocity[0, 0])) - reference.velocity)) / problem.speed
    timed = (run.impacts.end if problem.timed_end else run.impacts.start)[run.impacts.kind == 0]
    if not timed.size or not math.isfinite(timed[0]):
        return math.hypot(away, fast), None
    return math.hypot(away, fast), float(abs(Decimal(float(timed[0])) - reference.instant)) / problem.period


def cost_of(problem: Problem, method: Integrator, repeats: int = 9) -> tuple[float, float, int]:
    """Per drive period of the settled orbit: time [us] and evaluations; and the number of timed runs."""
    periods = problem.cost_periods

    def once(count: int) -> tuple[float, int]:
        begun = time.thread_time()
        run = simulate(problem.oscillator, problem.cost_start, duration=count * problem.period, method=method)
        return time.thread_time() - begun, run.evaluations

    took, evaluations = once(periods)
    while took < LONG_ENOUGH and periods < MOST_PERIODS and problem.oscillator.drive is not None:
        periods = min(MOST_PERIODS, periods * max(2, min(8, int(LONG_ENOUGH / took))))
        took, evaluations = once(periods)
    times = [took]
    if took < PATIENCE:
        times = [once(periods)[0] for _ in range(max(1, min(repeats, int(PATIENCE / took))))]
    return 1e6 * statistics.median(times) / periods, evaluations / periods, len(times)


def rows_of(
    reference: Reference, sweep: Sweep, *, slowest: float = SLOWEST, repeats: int = REPEATS,
    tick: Callable[[], None] = lambda: None,
) -> list[Row]:  # fmt: skip
    """One row for each setting of a sweep; settings that would take longer than `slowest` [s] are not run."""
    rows, expected = [], 0.0
    for setting in sweep.settings:
        method = setting.method
        order = method.order if math.isfinite(method.order) else None
        row = Row(
            problem=reference.problem.name, method=sweep.label, family=sweep.family, setting=setting.text,
            value=setting.value, order=order, certified=method.certified,
        )  # fmt: skip
        if expected > slowest:
            row = replace(
                row, failed=f"not run: a period would take about {expected:.2g} s, the bound is {slowest:g} s"
            )
            expected *= sweep.growth
        else:
            try:
                error, error_time = errors_of(reference, method)
                missed, largest = missed_share(method, reference.crossings)
                cost, evaluations, count = cost_of(reference.problem, method, repeats)
                row = replace(
                    row, error=error, error_time=error_time, missed=missed, largest_missed=largest,
                    us_per_period=cost, evaluations_per_period=evaluations, repeats=count,
                )  # fmt: skip
                expected = 1e-6 * cost * sweep.growth
            except Exception as error:  # an outside solver may raise anything, and it is a result
                row = replace(row, failed=f"{type(error).__name__}: {' '.join(str(error).split())}")
        rows.append(row)
        tick()
    return rows


def _points(rows: Sequence[Row]) -> list[tuple[float, float, Row]]:
    """(cost, error, row) of the rows that have both, by rising cost."""
    known = [
        (row.us_per_period, row.error, row) for row in rows
        if row.us_per_period is not None and row.error is not None and math.isfinite(row.error)
    ]  # fmt: skip
    return sorted(known, key=lambda point: point[:2])


def front(rows: Sequence[Row]) -> list[Row]:
    """The rows that no other row beats in both error and cost, by rising cost; of equal ones, all."""
    kept: list[tuple[float, float, Row]] = []
    for point in _points(rows):
        if not kept or point[1] < kept[-1][1] or point[:2] == kept[-1][:2]:
            kept.append(point)
    return [row for _cost, _error, row in kept]


def cheapest(rows: Sequence[Row], target: float) -> Row | None:
    """The row of least cost with an error of at most `target`; None if there is none."""
    return next((row for _cost, error, row in _points(rows) if error <= target), None)


@dataclass(frozen=True, kw_only=True)
class Order:
    """The order that a method states for smooth motion, and those that its rows show."""

    problem: str
    method: str
    stated: float | None
    measured: float | None
    measured_time: float | None


def measured_order(rows: Sequence[Row], measure: str = "error") -> float | None:
    """Least-squares slope of log(error) over log(step); None with fewer than three settings in range.

    Where the contact is met between grid points, the error carries a factor that depends on where, so that
    single ratios scatter about the slope.
    """
    points = [(row.value, getattr(row, measure)) for row in rows]
    known = [point for point in points if None not in point and ROUNDING < point[1] < COARSE]
    if len(known) < FEWEST:
        return None
    step, error = np.log(np.array(known)).T
    return float(np.polyfit(step, error, 1)[0])


def orders_of(rows: Sequence[Row]) -> list[Order]:
    """The orders of each method with a step on each problem."""
    found = []
    for problem, method in dict.fromkeys((row.problem, row.method) for row in rows if row.family == STEPPED):
        mine = [row for row in rows if (row.problem, row.method) == (problem, method)]
        found.append(Order(
            problem=problem, method=method, stated=mine[0].order, measured=measured_order(mine),
            measured_time=measured_order(mine, "error_time"),
        ))  # fmt: skip
    return found
