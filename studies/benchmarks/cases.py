"""What is timed: Eq. (1), one orbit and many, and the beam, beside heyoka and the arithmetic of the flow.

What is compared is timed in turns, A B A B ..., so that a machine that slows down slows both. The floor is
the arithmetic that no method of this kind can avoid in a period without a touch:

    (u, v) -> (a u + b v, c u + d v) for each mode,   one sum compared with a bound

heyoka runs Eq. (1) in its own loop, as one who knows it would write it: no wrapper, the impact in the
callback of an event, at its default tolerance (the rounding of a double), one orbit or several in a batch.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from contact import ImpactOscillator, StroboscopicMap, simulate, strobed_orbits
from studies import letter
from studies.peers import OutsideSolver
from studies.scene import Scene, single_mode_at

__all__ = [
    "FLOOR", "HEYOKA", "OURS", "Row", "batch_rows", "beam_rows", "carry", "error_of", "flows_of",
    "heyoka_orbits", "in_turns", "single_rows",
]  # fmt: skip

OURS, HEYOKA, FLOOR = "grazing-spring", "heyoka", "floor"
EXCESS, SINGLE_EXCESS, BELOW = letter.TIME_TRACE_EXCESS, 0.02, -0.02
"""F/F_g - 1 of the beam, of Eq. (1), and of a motion without a touch."""

EIGHT, TOLERANCE = 8, 1e-7
"""Modes for which heyoka's error is told; the coarsest of its decades that brings it below 1e-8."""

SETTLING = 2000
"""Drive periods before the clock starts: a free motion falls to 0.92 in each."""

CORES, BATCH = 2, 32
"""Threads, and orbits in all: two batches of the widest kind on each."""

Orbit = Callable[[int], object]
"""orbit(periods): carries a motion on by that many drive periods."""

Array = NDArray[np.float64]
compiled: Any = numba.njit(cache=True, nogil=True)


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a drive period costs with one tool."""

    case: str
    tool: str
    modes: int
    frequency_hz: float
    excess: float
    us_per_period: float
    us_per_collision: float | None = None
    tolerance: float | None = None
    """Of heyoka; the package has none."""
    error: float | None = None
    """Of mode 1 after one collision, in units of its displacement and velocity at grazing."""


def in_turns(
    runs: Mapping[str, tuple[Orbit, int]], repeats: int, clock: Callable[[], float] = time.thread_time
) -> dict[str, float]:
    """Median microseconds per drive period of each orbit over its periods, after one of each to warm up.

    The thread's own time is taken where one thread works; `clock` is time.perf_counter where several do.
    """
    spent: dict[str, list[float]] = {name: [] for name in runs}
    for orbit, periods in runs.values():
        orbit(periods)
    for _ in range(repeats):
        for name, (orbit, periods) in runs.items():
            began = clock()
            orbit(periods)
            spent[name].append(1e6 * (clock() - began) / periods)
    return {name: median(times) for name, times in spent.items()}


def flows_of(oscillator: ImpactOscillator) -> Array:
    """The flow of a drive period of each mode, shape (n_modes, 4)."""
    numbers = zip(oscillator.model.omega, oscillator.model.decay_rate, strict=True)
    return np.array(
        [expm(np.array([[0.0, 1.0], [-(w**2), -c]]) * oscillator.period).ravel() for w, c in numbers]
    )


@compiled
def carry(flow: Array, bound: float, u: Array, v: Array, periods: int) -> int:
    """Carry the deviations over `periods`; returns how often the sum of |u| exceeded `bound`."""
    exceeded = 0
    for _ in range(periods):
        total = 0.0
        for k in range(u.size):
            uk = u[k]
            u[k] = flow[k, 0] * uk + flow[k, 1] * v[k]
            v[k] = flow[k, 2] * uk + flow[k, 3] * v[k]
            total += abs(u[k])
        if total > bound:
            exceeded += 1
    return exceeded


def floor_of(oscillator: ImpactOscillator) -> Orbit:
    """The arithmetic of periods without a touch."""
    flow, n = flows_of(oscillator), oscillator.n_modes
    u, v = np.full(n, 1e-3), np.full(n, 1e-3)
    return lambda periods: carry(flow, 1.0, u, v, periods)


def heyoka_orbits(oscillators: Sequence[ImpactOscillator]) -> tuple[Orbit, Any]:
    """Orbits of Eq. (1) from rest, side by side, which differ in the drive amplitude alone; and heyoka's
    integrator."""
    import heyoka as hy

    first, lanes = oscillators[0], len(oscillators)
    model, drives = first.model, [one.drive for one in oscillators if one.drive is not None]
    w = drives[0].angular_frequency
    x, v = hy.make_vars("x", "v")
    push = hy.par[0] * hy.sin(w * hy.time)
    system = [(x, v), (v, push - model.decay_rate[0] * v - model.omega[0] ** 2 * x)]

    def impact(taylor: Any, _sign: int, *lane: int) -> bool:
        taylor.state[(1, *lane)] *= -first.stop.law.numbers[0]
        return True

    event, adaptive, shape = (
        (hy.t_event, hy.taylor_adaptive, 2)
        if lanes == 1
        else (hy.t_event_batch, hy.taylor_adaptive_batch, (2, lanes))
    )
    surface = x - first.stop.gap / model.phi[0]
    touch = event(surface, direction=hy.event_direction.positive, callback=impact)
    taylor = adaptive(system, np.zeros(shape), t_events=[touch])
    taylor.pars[:] = np.reshape([model.participation[0] * one.amplitude * w**2 for one in drives],
                                taylor.pars.shape)  # fmt: skip

    def orbit(periods: int) -> None:
        taylor.propagate_until((np.asarray(taylor.time) + periods * first.period).tolist())

    return orbit, taylor


def single_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[Row]:
    """One orbit of Eq. (1): the package, the floor and, if asked for, heyoka."""
    ours, theirs = (2000, 200) if quick else (20000, 2000)
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency).with_excess(SINGLE_EXCESS))
    state = strobed.orbit(strobed.steady(), SETTLING).end
    runs = {
        OURS: (lambda periods: strobed.orbit(state, periods), ours),
        FLOOR: (floor_of(strobed.oscillator), ours),
    }
    if peers:
        orbit, _taylor = heyoka_orbits([strobed.oscillator])
        orbit(SETTLING)
        runs[HEYOKA] = (orbit, theirs)
    return [
        Row(case="single mode", tool=tool, modes=1, frequency_hz=frequency, excess=SINGLE_EXCESS,
            us_per_period=spent)
        for tool, spent in in_turns(runs, 3 if quick else 7).items()
    ]  # fmt: skip


def batch_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[Row]:
    """Many orbits of Eq. (1) on two cores, time per orbit and drive period."""
    ours, theirs = (2000, 200) if quick else (20000, 1000)
    base = single_mode_at(scene, frequency)
    oscillators = [base.with_excess(SINGLE_EXCESS + 1e-4 * i) for i in range(BATCH)]
    maps = [StroboscopicMap(oscillator=oscillator) for oscillator in oscillators]
    states = [one.orbit(one.steady(), SETTLING).end for one in maps]
    runs: dict[str, tuple[Orbit, int]] = {
        OURS: (lambda periods: strobed_orbits(maps, states, periods, workers=CORES), ours)
    }
    with ThreadPoolExecutor(CORES) as pool:
        if peers:
            import heyoka as hy

            lanes = int(min(hy.recommended_simd_size(), BATCH // CORES))
            batches = [heyoka_orbits(oscillators[i : i + lanes])[0] for i in range(0, BATCH, lanes)]
            for batch in batches:
                batch(SETTLING)
            runs[HEYOKA] = (lambda periods: list(pool.map(lambda batch: batch(periods), batches)), theirs)
        spent = in_turns(runs, 3 if quick else 7, time.perf_counter)
    return [
        Row(case="batch on two cores", tool=tool, modes=1, frequency_hz=frequency, excess=SINGLE_EXCESS,
            us_per_period=each / BATCH)
        for tool, each in spent.items()
    ]  # fmt: skip


def beam_rows(case: str, oscillator: ImpactOscillator, *, quick: bool, peers: bool) -> list[Row]:
    """The beam's settled orbit, the same without a touch, the floor and, if asked for, heyoka."""
    count, theirs = (200, 8) if quick else (2000, 40)
    driven = oscillator.with_excess(EXCESS)
    strobed = StroboscopicMap(oscillator=driven)
    free = strobed.at(BELOW)
    state, still = strobed.orbit(strobed.steady(), SETTLING).end, free.steady()
    impacts = strobed.orbit(state, count).impacts.sum() / count
    runs: dict[str, tuple[Orbit, int]] = {
        OURS: (lambda periods: strobed.orbit(state, periods), count),
        "free": (lambda periods: free.orbit(still, periods), count), FLOOR: (floor_of(oscillator), count),
    }  # fmt: skip
    if peers:
        peer = OutsideSolver(solver="heyoka Taylor", tolerance=TOLERANCE)
        runs[HEYOKA] = (lambda periods: simulate(driven, state, periods=periods, method=peer), theirs)
    spent = in_turns(runs, 3 if quick else 7)
    rows = [
        Row(case=case, tool=tool, modes=oscillator.n_modes, frequency_hz=1.0 / oscillator.period,
            excess=EXCESS, us_per_period=each)
        for tool, each in spent.items() if tool != "free"
    ]  # fmt: skip
    rows.insert(1, replace(rows[0], case=f"{case}, no touch", excess=BELOW, us_per_period=spent["free"]))
    if impacts:
        rows[0] = replace(rows[0], us_per_collision=(spent[OURS] - spent["free"]) / impacts)
    if peers:
        error = error_of(driven, TOLERANCE) if oscillator.n_modes == EIGHT else None
        rows[-1] = replace(rows[-1], tolerance=TOLERANCE, error=error)
    return rows


def error_of(oscillator: ImpactOscillator, tolerance: float) -> float:
    """heyoka's error of mode 1 after a drive period from the steady motion at a strobe, past a collision, in
    units of its displacement and velocity at grazing [1]."""
    start, peer = (
        StroboscopicMap(oscillator=oscillator).steady(),
        OutsideSolver(solver="heyoka Taylor", tolerance=tolerance),
    )
    exact, found = (simulate(oscillator, start, periods=1, method=method).end for method in (None, peer))
    size = oscillator.stop.gap / abs(float(oscillator.model.phi[0]))
    away = (found.displacement[0] - exact.displacement[0]) / size
    fast = (found.velocity[0] - exact.velocity[0]) / (size * 2.0 * math.pi / oscillator.period)
    return math.hypot(away, fast)
