"""Errors and costs of every method at every setting.

    error     mode 1 at the probe, past the collision: distance of (q/size, q'/speed) from the reference
    missed    share of crossings of known depth that are not seen, each from `PHASES` starts with the free
              modes of the problem (``studies.methods.crossings``)
    time      processor time of the thread, along the settled orbit; the median of warm runs long enough that
              the clock and the call do not count

All methods here use one thread, whose time does not grow on a busy core. For a periodic motion the error is
that of mode 1 at a strobe in flight; the cost is the time that finds it from the state 40 periods after rest.
The reference has settled and errs by what does not close.
"""

import math
import time
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import partial
from statistics import median
from typing import Annotated, TypeVar

import numpy as np

from contact import ContactError, State, simulate
from contact.integrators import Integrator
from contact.orbits import Shooting
from studies.methods.crossings import Crossing
from studies.methods.work_precision.harmonic_balance import balanced
from studies.methods.work_precision.methods import PERIODIC, Sweep
from studies.methods.work_precision.problems import Problem, driven_problem, two_masses
from studies.methods.work_precision.reference import DIGITS, extended_motion

Name = TypeVar("Name", bound=Hashable)
Orbit = Callable[[int], object]  # orbit(periods): carries a motion on by that many drive periods


def in_turns(runs: Mapping[Name, tuple[Orbit, int]], repeats: int) -> dict[Name, float]:
    """Median microseconds per drive period of each orbit over its periods.

    Compared programs run in turns, A B A B ..., so that a machine that slows down slows both. Each runs once
    before the clock starts.
    """
    spent: dict[Name, list[float]] = {name: [] for name in runs}
    for orbit, periods in runs.values():
        orbit(periods)
    for _ in range(repeats):
        for name, (orbit, periods) in runs.items():
            began = time.thread_time()
            orbit(periods)
            spent[name].append(1e6 * (time.thread_time() - began) / periods)
    return {name: median(times) for name, times in spent.items()}


def timed(call: Callable[[], object], repeats: int) -> float:
    """Median microseconds of a call."""
    return in_turns({"": (lambda _: call(), 1)}, repeats)[""]


REPEATS, SLOWEST = 9, 0.5
"""Timed runs of a point; longest drive period of a setting that is run [s]: errors and cost take twenty."""

LONG_ENOUGH, MOST_PERIODS, PATIENCE = 0.01, 512, 0.4
"""Length of a timed run [s], a hundred times the call's own; bound of its periods; time spent on repetitions
of one point at most [s]: a slower run is timed once."""

SAMPLES = {5: 1024, 11: 1024, 21: 1024, 41: 4096, 81: 16384, 161: 65536}
"""Orders of harmonic balance; samples grow with their square, so that both errors fall together."""

SETTLING = (20, 80, 320)  # drive periods of settling: deviations fall to 0.886 in each

OVERSHOOTS, PHASES = tuple(10.0**-p for p in range(2, 9)), 4
"""Depths of the crossings over the gap, and starts for each."""

RINGING = 2e-3
"""Part of the peak in the higher modes, as mode 2 rings between collisions of the scene's beam [1]."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A method at a setting: its error and its cost on a problem, or why there is none."""

    problem: Annotated[str, "problem"]
    method: Annotated[str, "method"]
    family: Annotated[str, "family of methods"]
    setting: Annotated[str, "setting"]
    value: Annotated[float | None, "value of the setting; step, spacing of samples in periods, or tolerance"]
    unit: Annotated[str, "unit of this value"] = "1"
    certified: Annotated[bool, "whether it proves that it misses no touch"]
    error: Annotated[float | None, "error of mode 1 past the first collision; in its motion at grazing"] = (
        None
    )
    missed: Annotated[float | None, "share of the shallow crossings that are missed"] = None
    time_per_period_us: Annotated[float | None, "time per drive period [µs]; of two masses, per orbit"] = None
    failed: Annotated[str, "why there is no error"] = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """What the errors on one problem are measured with: mode 1 at the probe; `own_error` is its own."""

    problem: Problem
    displacement: Decimal
    velocity: Decimal
    own_error: float

    def error_of(self, displacement: float | Decimal, velocity: float | Decimal) -> float:
        """Scaled distance of mode 1 from the reference; differences are formed in extended precision [1]."""
        away = float(Decimal(displacement) - self.displacement) / self.problem.size
        return math.hypot(away, float(Decimal(velocity) - self.velocity) / self.problem.speed)


def reference_of(problem: Problem) -> Reference:
    """The reference of a problem, from the runs of both precisions."""
    motion = partial(extended_motion, problem.oscillator, problem.start, problem.probe)
    (q, v), other = ((run.displacement[0], run.velocity[0]) for run in map(motion, DIGITS))
    found = Reference(problem=problem, displacement=q, velocity=v, own_error=0.0)
    return replace(found, own_error=found.error_of(*other))


def error_of(reference: Reference, method: Integrator) -> float:
    """Error of mode 1 by a method [1]."""
    problem = reference.problem
    probe = np.array([problem.probe])
    run = simulate(problem.oscillator, problem.start, duration=problem.duration, times=probe, method=method)
    return reference.error_of(float(run.displacement[0, 0]), float(run.velocity[0, 0]))


def missed_share(problem: Problem, method: Integrator) -> float | None:
    """Share of the crossings not seen; a run that fails has seen none. None without a drive, for a stop that
    is not met freely [1]."""
    if problem.oscillator.drive is None:
        return None
    crossing = Crossing.of(problem.oscillator.model, problem.oscillator.stop, RINGING)
    leads = crossing.leads(PHASES).tolist()
    touches = [crossing.touch(method, depth, lead) for depth in OVERSHOOTS for lead in leads]
    return float(np.mean(np.isnan(touches)))


def cost_of(problem: Problem, method: Integrator, repeats: int = REPEATS) -> float:
    """Time per drive period of the settled orbit [µs]."""
    periods = problem.cost_periods

    def once(count: int) -> float:
        begun = time.thread_time()
        simulate(problem.oscillator, problem.cost_start, duration=count * problem.period, method=method)
        return time.thread_time() - begun

    took = once(periods)
    while took < LONG_ENOUGH and periods < MOST_PERIODS and problem.oscillator.drive is not None:
        periods = min(MOST_PERIODS, periods * max(2, min(8, int(LONG_ENOUGH / took))))
        took = once(periods)
    times = [took, *(once(periods) for _ in range(min(repeats, int(PATIENCE / took))))]
    return 1e6 * median(times) / periods


def rows_of(
    reference: Reference, sweep: Sweep, *, slowest: float = SLOWEST, repeats: int = REPEATS
) -> list[Measured]:
    """One row for each setting of a sweep; settings that would take longer than `slowest` [s] are not run."""
    rows, expected = [], 0.0
    for setting in sweep.settings:
        method = setting.method
        row = Measured(
            problem=reference.problem.name,
            method=sweep.label,
            family=sweep.family,
            setting=setting.text,
            value=setting.value,
            unit=setting.unit,
            certified=method.certified,
        )
        if expected > slowest:
            about = f"not run: a period would take about {expected:.2g} s, the bound is {slowest:g} s"
            row = replace(row, failed=about)
            expected *= sweep.growth
        else:
            try:
                row = replace(
                    row,
                    error=error_of(reference, method),
                    missed=missed_share(reference.problem, method),
                    time_per_period_us=(cost := cost_of(reference.problem, method, repeats)),
                )
                expected = 1e-6 * cost * sweep.growth
            except Exception as error:  # an outside solver may raise anything, and it is a result
                row = replace(row, failed=f"{type(error).__name__}: {' '.join(str(error).split())}")
        rows.append(row)
    return rows


def orbit_rows(*, quick: bool, repeats: int) -> tuple[Reference, list[Measured]]:
    """The reference of the two masses; rows of harmonic balance, shooting and settling."""
    problem = replace(driven_problem("two masses", "two masses, an orbit", two_masses(0.635)), unit="orbit")
    o, settled, start = problem.oscillator, problem.cost_start, simulate(problem.oscillator, periods=40).end
    reference = reference_of(replace(problem, start=settled, probe=problem.period))
    found = reference.error_of(settled.displacement[0], settled.velocity[0])  # what it fails to close by
    reference, rows = replace(reference, own_error=found), list[Measured]()

    def balance(order: int) -> State:
        found = balanced(o, order, SAMPLES[order], start)
        return State(displacement=found.modes(np.zeros(1))[0], velocity=found.modes(np.zeros(1), 1)[0])

    def later(periods: int) -> State:
        return simulate(o, start, periods=periods).end

    def shot() -> State:
        return Shooting(oscillator=o, m=1).from_state(start).strobe_state()

    jobs = [("harmonic balance", f"order {n}", partial(balance, n)) for n in SAMPLES if n < 81 or not quick]
    jobs += [("settling", f"{n} periods", partial(later, n)) for n in SETTLING]
    for label, text, work in [*jobs, ("shooting", "1e-12", partial(shot))]:
        row = Measured(
            problem=problem.name,
            method=label,
            family=PERIODIC,
            setting=text,
            value=None,
            certified=label != "harmonic balance",
        )
        try:
            end = work()
            error = reference.error_of(end.displacement[0], end.velocity[0])
            rows.append(replace(row, error=error, time_per_period_us=timed(work, repeats)))
        except ContactError as failure:
            rows.append(replace(row, failed=str(failure)))
    return reference, rows


def cheapest(rows: Sequence[Measured], target: float) -> Measured | None:
    """The row of least cost with an error of at most `target`; None if there is none."""
    known = [row for row in rows if row.error is not None and row.error <= target]
    return min(known, key=lambda row: (row.time_per_period_us, row.error), default=None)
