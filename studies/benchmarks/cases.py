"""What is timed: Eq. (1), one orbit and many, and the beam, beside heyoka and the arithmetic of the flow.

What is compared is timed in turns, A B A B ..., so that a machine that slows down slows both. The floor is
the arithmetic that no method of this kind can avoid in a period without a touch: every mode is carried by its
2 x 2 matrix, and one number is looked at that says that no touch was possible.

    (u, v) -> (a u + b v, c u + d v) for each mode,   one weighted sum compared with a bound

heyoka runs Eq. (1) in its own loop, as one who knows it would write it: no wrapper, the impact in the
callback of an event, at its default tolerance (the rounding of a double), one orbit or several in a batch.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from statistics import median
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from contact import ImpactOscillator, StroboscopicMap, simulate, strobed_orbits
from studies.peers import HeyokaTaylor
from studies.scene import Scene, single_mode_at

__all__ = [
    "BELOW", "FLOOR", "HEYOKA", "OURS", "SINGLE_EXCESS", "Row", "batch_rows", "beam_rows", "carry",
    "flows_of", "heyoka_batch", "heyoka_orbit", "in_turns", "single_rows",
]  # fmt: skip

OURS, HEYOKA, FLOOR = "grazing-spring", "heyoka", "floor"
SINGLE_EXCESS, BELOW = 0.02, -0.02
"""F/F_g - 1 of Eq. (1), and of a motion without a touch."""

SETTLING = 2000
"""Drive periods before the clock starts: a free motion falls to 0.92 in each."""

CORES, BATCH = 2, 32
"""Threads, and orbits in all: two batches of the widest kind on each."""

Orbit = Callable[[int], None]
"""orbit(periods): carries the motion on by that many drive periods."""

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
    runs: Mapping[str, Callable[[], object]], repeats: int, clock: Callable[[], float] = time.thread_time
) -> dict[str, float]:
    """Median seconds of each run, after one of each to warm up.

    The thread's own time is taken where one thread works; `clock` is time.perf_counter where several do.
    """
    spent: dict[str, list[float]] = {name: [] for name in runs}
    for run in runs.values():
        run()
    for _ in range(repeats):
        for name, run in runs.items():
            began = clock()
            run()
            spent[name].append(clock() - began)
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


def floor_of(oscillator: ImpactOscillator, periods: int) -> Callable[[], object]:
    """The arithmetic of that many periods without a touch."""
    flow, n = flows_of(oscillator), oscillator.n_modes
    u, v = np.full(n, 1e-3), np.full(n, 1e-3)
    return lambda: carry(flow, 1.0, u, v, periods)


def equation_1(oscillators: Sequence[ImpactOscillator]) -> tuple[list[Any], Any, float, list[float]]:
    """For heyoka: the system with the push as parameter, what is watched, restitution, pushes."""
    import heyoka as hy

    model, law, drive = oscillators[0].model, oscillators[0].stop.law, oscillators[0].drive
    if drive is None:
        raise ValueError("drive is None; Eq. (1) needs a HarmonicDrive")
    w = drive.angular_frequency
    x, v = hy.make_vars("x", "v")
    push = hy.par[0] * hy.sin(w * hy.time)
    system = [(x, v), (v, push - model.decay_rate[0] * v - model.omega[0] ** 2 * x)]
    amplitudes = [one.drive.amplitude for one in oscillators if one.drive is not None]
    pushes = [float(model.participation[0] * amplitude * w**2) for amplitude in amplitudes]
    return system, x - oscillators[0].stop.gap / model.phi[0], law.numbers[0], pushes


def heyoka_orbit(oscillator: ImpactOscillator) -> tuple[Orbit, Any]:
    """One orbit of Eq. (1) from rest, and heyoka's integrator."""
    import heyoka as hy

    system, depth, restitution, pushes = equation_1([oscillator])

    def impact(taylor: Any, _sign: int) -> bool:
        taylor.state[1] *= -restitution
        return True

    touch = hy.t_event(depth, direction=hy.event_direction.positive, callback=impact)
    taylor = hy.taylor_adaptive(system, [0.0, 0.0], t_events=[touch])
    taylor.pars[0] = pushes[0]

    def orbit(periods: int) -> None:
        taylor.propagate_until(taylor.time + periods * oscillator.period)

    return orbit, taylor


def heyoka_batch(oscillators: Sequence[ImpactOscillator]) -> tuple[Orbit, Any]:
    """As many orbits side by side as there are oscillators, which differ in the drive amplitude alone."""
    import heyoka as hy

    system, depth, restitution, pushes = equation_1(oscillators)

    def impact(taylor: Any, _sign: int, lane: int) -> bool:
        taylor.state[1, lane] *= -restitution
        return True

    touch = hy.t_event_batch(depth, direction=hy.event_direction.positive, callback=impact)
    taylor = hy.taylor_adaptive_batch(system, np.zeros((2, len(oscillators))), t_events=[touch])
    taylor.pars[0] = pushes

    def orbit(periods: int) -> None:
        taylor.propagate_until([float(t) + periods * oscillators[0].period for t in taylor.time])

    return orbit, taylor


def single_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[Row]:
    """One orbit of Eq. (1): the package, the floor and, if asked for, heyoka."""
    ours, theirs = (2000, 200) if quick else (20000, 2000)
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency).with_excess(SINGLE_EXCESS))
    state = strobed.orbit(strobed.steady(), SETTLING).end
    runs: dict[str, Callable[[], object]] = {
        OURS: lambda: strobed.orbit(state, ours), FLOOR: floor_of(strobed.oscillator, ours),
    }  # fmt: skip
    if peers:
        orbit, _taylor = heyoka_orbit(strobed.oscillator)
        orbit(SETTLING)
        runs[HEYOKA] = lambda: orbit(theirs)
    length = {OURS: ours, FLOOR: ours, HEYOKA: theirs}
    return [
        Row(case="single mode", tool=tool, modes=1, frequency_hz=frequency, excess=SINGLE_EXCESS,
            us_per_period=1e6 * spent / length[tool])
        for tool, spent in in_turns(runs, 3 if quick else 7).items()
    ]  # fmt: skip


def batch_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[Row]:
    """Many orbits of Eq. (1) on two cores, time per orbit and drive period."""
    ours, theirs = (2000, 200) if quick else (20000, 1000)
    base = single_mode_at(scene, frequency)
    oscillators = [base.with_excess(SINGLE_EXCESS + 1e-4 * i) for i in range(BATCH)]
    maps = [StroboscopicMap(oscillator=oscillator) for oscillator in oscillators]
    states = [one.orbit(one.steady(), SETTLING).end for one in maps]
    runs: dict[str, Callable[[], object]] = {OURS: lambda: strobed_orbits(maps, states, ours, workers=CORES)}
    with ThreadPoolExecutor(CORES) as pool:
        if peers:
            import heyoka as hy

            lanes = int(min(hy.recommended_simd_size(), BATCH // CORES))
            batches = [heyoka_batch(oscillators[i : i + lanes])[0] for i in range(0, BATCH, lanes)]
            for batch in batches:
                batch(SETTLING)
            runs[HEYOKA] = lambda: list(pool.map(lambda batch: batch(theirs), batches))
        spent = in_turns(runs, 3 if quick else 7, time.perf_counter)
    length = {OURS: ours, HEYOKA: theirs}
    return [
        Row(case="batch on two cores", tool=tool, modes=1, frequency_hz=frequency, excess=SINGLE_EXCESS,
            us_per_period=1e6 * seconds / length[tool] / BATCH)
        for tool, seconds in spent.items()
    ]  # fmt: skip


def beam_rows(
    case: str, oscillator: ImpactOscillator, excess: float, *, quick: bool, tolerance: float | None
) -> list[Row]:
    """The beam's settled orbit, the same without a touch, the floor and, with a tolerance, heyoka.

    What the periods take beyond those without a touch is the cost of the collisions.
    """
    count, theirs = (200, 8) if quick else (2000, 40)
    strobed = StroboscopicMap(oscillator=oscillator.with_excess(excess))
    free = strobed.at(BELOW)
    state, still = strobed.orbit(strobed.steady(), SETTLING).end, free.steady()
    impacts = strobed.orbit(state, count).impacts.sum() / count
    runs: dict[str, Callable[[], object]] = {
        OURS: lambda: strobed.orbit(state, count), "free": lambda: free.orbit(still, count),
        FLOOR: floor_of(oscillator, count),
    }  # fmt: skip
    length = {OURS: count, "free": count, FLOOR: count, HEYOKA: theirs}
    if tolerance is not None:
        peer = HeyokaTaylor(tolerance=tolerance)
        runs[HEYOKA] = lambda: simulate(strobed.oscillator, state, periods=theirs, method=peer)
    spent = {
        tool: 1e6 * seconds / length[tool] for tool, seconds in in_turns(runs, 3 if quick else 7).items()
    }
    collision = (spent[OURS] - spent["free"]) / impacts if impacts else None
    mine: dict[str, dict[str, Any]] = {
        OURS: dict(case=case, tool=OURS, excess=excess, us_per_collision=collision),
        "free": dict(case=f"{case}, no touch", tool=OURS, excess=BELOW),
        FLOOR: dict(case=case, tool=FLOOR, excess=excess),
        HEYOKA: dict(case=case, tool=HEYOKA, excess=excess, tolerance=tolerance),
    }  # fmt: skip
    common: dict[str, Any] = {"modes": oscillator.n_modes, "frequency_hz": 1.0 / oscillator.period}
    return [Row(us_per_period=each, **common, **mine[tool]) for tool, each in spent.items()]
