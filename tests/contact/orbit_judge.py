"""A judge of periodic orbits, of their events and of the branches on which they lie.

It continues the curve of the orbits over a parameter p by itself: from the package it takes the flow from
touch to touch alone.
"""

import contextlib
import math
from collections.abc import Callable
from functools import cache

import numpy as np
from simulated_orbit import touches
from tip_judge import Signal

import contact
from contact import ContactError, ImpactOscillator
from contact.orbits import Event, PeriodicOrbit
from contact.orbits.families.equations import driven_at, shoot, sizes_of
from contact.sensitivity.change import Sensitivities

PLACE, ROUNDING = 1e-6, 1e-11
"""How far a multiplier, or in gaps a peak, may be off; part of a matrix that is rounding."""

Path = Callable[[float], ImpactOscillator]


class Curve:
    """The orbits with the touches of `like` over p, in scaled unknowns (u, v, approach velocity, p)."""

    def __init__(self, path: Path, like: PeriodicOrbit, unit: float) -> None:
        self.path, self.like = path, like
        self.scale = np.concatenate([sizes_of(like.oscillator), [like.oscillator.unit_speed, unit]])

    def unknowns(self, orbit: PeriodicOrbit, p: float) -> np.ndarray:
        return np.concatenate([orbit.deviations, [orbit.speed, p]]) / self.scale

    def equations(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What is left of them, their derivatives with all unknowns but p, and the touches."""
        (*start, speed, p), n = x * self.scale, x.size - 2
        oscillator = self.path(p)
        tip = np.kron(np.eye(2), oscillator.model.phi)
        response, w = oscillator.tip_response(), oscillator.driven.angular_frequency
        steady = np.array([[response.real, response.imag], [-w * response.imag, w * response.real]])
        drive = np.linalg.solve(steady, [oscillator.stop.gap, speed] - tip @ start)  # Z (sin, cos)
        with_start = np.linalg.solve(steady, np.column_stack([-tip, [0.0, 1.0]]))
        (driven, phase), like = driven_at(oscillator, drive), self.like
        known = Sensitivities(oscillator=driven)
        orbit, miss, flow = shoot(known, phase, np.array(start), like.m, like.impacts)
        size, weight = math.hypot(*drive), np.append(self.scale[:n], self.like.amplitude)
        rest = np.append(miss, size - oscillator.driven.amplitude) / weight
        closing = flow @ np.vstack([np.eye(n, n + 1), with_start]) - np.eye(n, n + 1)
        rows = np.vstack([closing, drive @ with_start / size]) * self.scale[:-1] / weight[:, None]
        return rest, rows, orbit.record

    def solve(self, x: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The orbit next to `x` in the plane across `normal`, and the tangent there; None: not found."""
        guess, h = x, 1e-6 * np.eye(x.size)[-1]
        for side in (1.0, -1.0):  # a touch is lost on one side of a graze
            with contextlib.suppress(ContactError, ValueError, np.linalg.LinAlgError):
                with_p = (self.equations(x + side * h)[0] - self.equations(x)[0]) / (side * 1e-6)
                for _ in range(10):
                    rest, rows, _record = self.equations(x)
                    inverse = np.linalg.inv(np.vstack([np.column_stack([rows, with_p]), normal]))
                    step = inverse @ np.append(rest, normal @ (x - guess))
                    x = x - step
                    if np.max(np.abs(step)) < 1e-9:
                        return x, inverse[:, -1] / np.linalg.norm(inverse[:, -1])
                return None
        return None

    def joins(self, start: PeriodicOrbit, p: float, end: PeriodicOrbit, q: float) -> bool:
        """Whether the curve leads from one orbit to the other, on either way and wherever it bends."""
        a, b = self.unknowns(start, p), self.unknowns(end, q)
        length = float(np.linalg.norm(b - a))
        first = self.solve(a, (b - a) / max(length, 1e-300))
        sides = self.unlike(start.approach) @ self.unlike(end.approach)
        if length < 1e-5 or sides < 0.0:  # next to a graze; two curves cross in between
            return True
        return first is not None and any(self.leads(a, way, b, length) for way in (first[1], -first[1]))

    def leads(self, x: np.ndarray, way: np.ndarray, b: np.ndarray, length: float) -> bool:
        """Whether the curve leads from `x` along `way` to `b`, which is `length` away."""
        step = 0.3 * length
        for _ in range(60):
            ahead, off = (b - x) @ way, np.linalg.norm(b - x)
            over = 0.0 < ahead <= step and off < 2.0 * step
            guess = x + (ahead if over else step) * way
            there = None if off > 3.0 * length else self.solve(guess, way)
            if there is None or np.linalg.norm(there[0] - guess) > 0.3 * step or there[1] @ way < 0.8:
                step *= 0.5
                continue
            if over and np.linalg.norm(there[0] - b) < PLACE * max(length, 1.0):
                return True
            x, way, step = there[0], there[1], min(2.0 * step, 0.3 * length)
        return False

    def unlike(self, speeds: np.ndarray) -> np.ndarray:
        """How far an orbit is from a shorter one that is run through several times; 1 if it cannot be."""
        parts, k = math.gcd(self.like.m, self.like.impacts), self.like.impacts
        shifts = [speeds - np.roll(speeds, k // q) for q in (2, 3, 5) if parts % q == 0]
        return min(shifts, key=np.linalg.norm, default=speeds) / speeds.max()

    def wrong_fold(self, fold: PeriodicOrbit, p: float) -> str:
        """What is wrong with a fold: p must turn round, no orbit be on one side and two on the other."""
        x = self.unknowns(fold, p)
        try:
            across = np.append(np.linalg.svd(self.equations(x)[1])[2][-1], 0.0)  # the curve runs along this
        except ContactError as error:
            return f"is no orbit: {error}"
        for step in (1e-3, 1e-4, 1e-5, 1e-6):
            ends = [self.solve(x + h * across, across) for h in (step, -step)]
            if None not in ends:
                sides = [end[0][-1] - x[-1] for end in ends]
                speeds = [self.equations(y)[2].log["approach"] for y in (x, ends[0][0])]
                if np.divide(*(np.linalg.norm(self.unlike(row)) for row in speeds)) < 0.01:
                    return "is a branch point: a shorter orbit, run through several times"
                return "" if sides[0] * sides[1] > 0.0 else "has an orbit on either side"
        return "has no orbits beside it"


def wrong_multiplier(kind: str, orbit: PeriodicOrbit) -> str:
    """What is wrong with the multipliers at an event.

    One may be off by more where no method can tell it: where rounding of the matrix puts it in its place.
    """
    size, torus = sizes_of(orbit.oscillator), kind == "torus"
    matrix = orbit.monodromy() * size / size[:, None]
    values = np.linalg.eigvals(matrix).astype(complex)
    values = values[values.imag != 0.0] if torus else values
    if not values.size:
        return "has no complex multipliers"
    places = values / np.abs(values) if torus else np.full(values.size, -1.0 if "doubling" in kind else 1.0)
    nearest = int(np.argmin(np.abs(values - places)))
    least = np.linalg.svd(matrix - places[nearest] * np.eye(len(matrix)), compute_uv=False)
    if abs(values[nearest] - places[nearest]) < PLACE or least[-1] < ROUNDING * least[0]:
        return ""
    return f"has the multiplier {values[nearest]:.7g}"


@cache
def nearest_graze(orbit: PeriodicOrbit) -> float:
    """The height over the stop, in gaps, of the extremum of the tip nearest to it: 0 for a slow touch, else a
    peak of a flight, the touch at its end ignored, or its lowest point, or the least depth in a contact."""
    oscillator, heights = orbit.oscillator, [math.inf]
    if orbit.approach.min() < math.sqrt(PLACE) * oscillator.unit_speed:
        return 0.0
    numbers, gap, state = oscillator.numbers(), oscillator.stop.gap, orbit.state()
    log = orbit.record.log
    ends = np.append(log["start"][1:], orbit.duration)
    for low, high, end, after in zip(log["start"], log["end"], ends, orbit.record.states[:, 1], strict=True):
        tip = Signal(numbers, float(orbit.phase + high), *after)
        length = float(end - high)
        heights += list(tip(tip.peaks(length + 0.1 * oscillator.period)) / gap - 1.0)
        heights.append(float(np.min(tip(tip.samples(length)))) / gap - 1.0)
        for _ in range(3 if high > low and orbit.admissible else 0):
            times = np.linspace(low, high, 202)[1:-1]
            run = contact.simulate(oscillator, state, duration=float(high), times=state.time + times)
            depth = oscillator.tip(run.displacement) / gap - 1.0
            inner = np.flatnonzero((depth[1:-1] <= depth[:-2]) & (depth[1:-1] <= depth[2:])) + 1
            if not inner.size:
                break
            least = inner[np.argmin(np.abs(depth[inner]))]
            heights.append(float(depth[least]))
            low, high = times[least - 1], times[least + 1]
    return min(heights, key=abs)


def wrong_orbit(orbit: PeriodicOrbit) -> str:
    """What is wrong with an orbit: it must close, and say rightly whether it touches the stop only then."""
    if abs(nearest_graze(orbit)) < PLACE:
        return ""  # rounding decides on the touch that grazes
    curve = Curve(orbit.oscillator.with_excess, orbit, 1.0)
    try:
        open_by = float(np.max(np.abs(curve.equations(curve.unknowns(orbit, orbit.excess))[0])))
        met = touches(orbit)
    except contact.NotPeriodic as error:
        return f"is no orbit: {error}"
    if open_by > 1e-8:
        return f"does not close by {open_by:.1e}"
    right = (met == orbit.impacts) == orbit.admissible
    return "" if right else f"has {orbit.impacts} touches, admissible {orbit.admissible}; its motion {met}"


def wrong_event(event: Event, path: Path, p: float, unit: float) -> str:
    """What is wrong with an event of a branch along `path`; nothing if it is right."""
    kind, height = event.kind, abs(nearest_graze(event.orbit))
    if kind == "grazing" and height >= PLACE:
        return f"has no extremum of the tip closer to the stop than {height:.1e} gaps"
    if kind in ("grazing", "undecided"):
        return ""
    return wrong_multiplier(kind, event.orbit) or (
        Curve(path, event.orbit, unit).wrong_fold(event.orbit, p) if kind == "fold" else ""
    )
