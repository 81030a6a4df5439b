r"""Branches of periodic orbits along a path p -> oscillator, such as a response curve in the drive frequency.

An orbit starts at its first touch from z = (u, v, S, C), with the tip y over the stop, and obeys

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0,      |(S, C)| = Z(p)

(``contact.orbits.derivatives``, with exact tangents in z and p): 2 N + 2 equations for the 2 N + 3 unknowns
(z, p), a curve.  It is followed in its own arc length, in units of the sizes of the unknowns, and turns round
where p does.  Between two points of it events are located by Brent's method: a fold where the p-component of
its direction changes sign, the others by the tests of ``contact.orbits.events``.  Where the tip gains or
loses a touch the curve goes on with another number of touches, if the law's force is continuous; else it
ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require, require_kind, require_within
from contact.change import Changes, Path, change_along
from contact.errors import ContactError, NotPeriodic
from contact.flight.modal_flow import steady_motion
from contact.orbits.derivatives import drive_of, equations_of, sizes_of
from contact.orbits.events import TESTS, Branch, Event, is_torus, passes
from contact.orbits.periodic_orbit import PeriodicOrbit
from contact.simulation import simulate
from contact.virtual_motion import deviations

__all__ = ["follow_path"]

Array = NDArray[np.float64]

CONVERGED, ROUNDED, MOST_ITERATIONS = 1e-12, 1e-9, 8
"""Largest residual in units of the sizes; below which an iterate that no longer improves counts, as in
``contact.orbits.shooting``; and iterations of Newton's method."""

SMALLEST, NOISY, MOST_STEPS = 1e-9, 1e-6, 5000
"""Arc length to which a graze is located; over which no other event is looked for, since there the tests are
rounding; and bound of steps."""

BEND = 0.3
"""Largest angle between the directions of neighbours [rad], and part of a step by which it may miss."""

ACROSS = tuple(10.0**-k for k in range(9, 2, -1))
"""Steps tried from a grazing orbit to the first one with another number of touches."""

PLACE = 1e-11
"""Part of a step to which an event is located."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Point:
    """A point of the curve: scaled unknowns, direction, and the orbit."""

    x: Array
    direction: Array
    orbit: PeriodicOrbit

    def along(self, other: Array) -> _Point:
        """The same with its direction on the side of `other`."""
        return self if self.direction @ other >= 0.0 else replace(self, direction=-self.direction)


def follow_path(
    path: Path, start: PeriodicOrbit, at: float, *, low: float, high: float, step: float = 0.05
) -> Branch:
    """The branch through `start`, an orbit of ``path(at)``, as long as the parameter is in [low, high].

    Parameters
    ----------
    path : callable
        p -> ImpactOscillator for p from `low` to `high`, smooth, of one law and number of modes.  A constant
        force f is Z = f/w^2 at frequency w [rad/s], a constant base acceleration a is Z = a/w^2.
    start : PeriodicOrbit
    at, low, high : float
        In the unit of the parameter.
    step : float
        Longest step in units of the sizes: the gap, 2 pi f gap, the grazing amplitude, a tenth of the range.

    Returns
    -------
    Branch
        Orbits and their `parameters` from one end to the other, and events with theirs: "fold" (the parameter
        turns round), "period doubling", "torus", and "grazing" (a touch is gained or lost).  A closed curve
        ends where it began, "closed".

    Raises
    ------
    NotPeriodic
        If there is no orbit next to `start`.
    """
    require(callable(path), f"path is {path!r}; it must be a function of one number")
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    require_within("low", low, "[of p]")
    require_within("high", high, "[of p]", above=low)
    require_within("at", at, "[of p]", low=low, high=high)
    require_within("step", step, "[1]", above=0, high=1)
    curve = _Curve(path=path, low=low, high=high, step=step, like=start)
    first = curve.solve(curve.unknowns(start, at), np.eye(start.deviations.size + 3)[-1], start.impacts)
    before, met_before, ended_low = curve.arm(replace(first, direction=-first.direction))
    after, met_after, ended_high = [first], list[Event](), ended_low
    if ended_low != "closed":
        after, met_after, ended_high = curve.arm(first)
    points = [*before[:0:-1], *after]
    return Branch(
        orbits=tuple(point.orbit for point in points), events=(*met_before[::-1], *met_after),
        ended_low=ended_low, ended_high=ended_high,
        parameters=tuple(curve.parameter(point.x) for point in points),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class _Curve:
    """What is the same for all points; the unknowns are scaled by the sizes of the orbit `like`."""

    path: Path
    low: float
    high: float
    step: float
    like: PeriodicOrbit

    @property
    def scale(self) -> Array:
        """Sizes of (u, v, S, C, p)."""
        amplitude = self.like.oscillator.grazing_amplitude()
        return np.concatenate([sizes_of(self.like), [amplitude, amplitude, 0.1 * (self.high - self.low)]])

    def unknowns(self, orbit: PeriodicOrbit, at: float) -> Array:
        """The scaled unknowns of an orbit."""
        return np.concatenate([orbit.deviations, drive_of(orbit), [at]]) / self.scale

    def parameter(self, x: Array) -> float:
        """p at these unknowns; the ends of the range without rounding."""
        p = float(x[-1] * self.scale[-1])
        return next((end for end in (self.low, self.high) if math.isclose(p, end, rel_tol=1e-15)), p)

    def solve(self, x: Array, normal: Array, touches: int) -> _Point:
        """The point of the curve next to `x`, in the plane through it across `normal`."""
        guess, best, found = x, math.inf, _Point(x=x, direction=normal, orbit=self.like)
        for iteration in range(MOST_ITERATIONS):
            orbit, residual, rows = self.equations(x, touches)
            error = float(np.max(np.abs(residual)))
            if iteration > 0 and best < ROUNDED and not error < best:
                return found
            try:
                inverse = np.linalg.inv(np.vstack([rows[:-1], normal]))
            except np.linalg.LinAlgError:
                break
            if iteration > 0:
                direction, best = inverse[:, -1] / np.linalg.norm(inverse[:, -1]), error
                slope = _slope(orbit, rows[:, :-1] / self.scale[:-1])
                found = _Point(x=x, direction=direction, orbit=replace(orbit, slope=slope, residual=error))
                if error < CONVERGED:
                    return found
            x = x - inverse @ np.append(residual, normal @ (x - guess))
        words = f"Newton's method found no orbit of period {self.like.period} (residual {best:.1e})"
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=words)

    def equations(self, x: Array, touches: int) -> tuple[PeriodicOrbit, Array, Array]:
        """The motion from these unknowns, which need not close; the residual of its equations, and their
        derivatives with the last row that of the approach speed, all scaled."""
        z, n, p = x * self.scale, x.size - 3, self.parameter(x)
        here, (u, v) = self.path(p), z[:n].reshape(2, -1).copy()
        reached, w = math.hypot(z[-3], z[-2]), here.driven.angular_frequency
        driven, phase = here.with_amplitude(reached), math.atan2(z[-3], z[-2]) % (2.0 * math.pi) / w
        q, q_rate = steady_motion(driven.motion(), phase)
        orbit = PeriodicOrbit(
            oscillator=driven, period=self.like.period, phase=phase, displacement=u, velocity=v,
            excess=reached / here.grazing_amplitude() - 1.0, speed=float(here.tip(v + q_rate)),
            record=np.empty((touches, 4 + n)), tangent=np.eye(n), slope=math.nan, residual=math.nan,
        )  # fmt: skip
        changes = Changes(oscillator=driven, changes=(change_along(self.path, p, self.low, self.high),))
        end, record, tangent, rows = equations_of(orbit, changes)
        weight = np.append(self.scale[:n], [here.stop.gap, self.scale[-2], here.unit_speed])
        reach = float(here.tip(u + q)) - driven.motion().gap
        residual = np.concatenate([end - z[:n], [reach, reached - here.driven.amplitude]]) / weight[:-1]
        return replace(orbit, record=record, tangent=tangent), residual, rows * self.scale / weight[:, None]

    def near(self, here: _Point, length: float, touches: int) -> _Point | None:
        """The point a step further on, or at the end of the range; None if there is none close to it, or its
        tip touches the stop at other times than told."""
        rate, p = self.scale[-1] * here.direction[-1], self.parameter(here.x)
        room = ((self.high if rate > 0.0 else self.low) - p) / rate if rate else math.inf
        guess, across = here.x + min(length, room) * here.direction, here.direction
        if room <= length:
            across = np.eye(guess.size)[-1]
        try:
            there = self.solve(guess, across, touches).along(here.direction)
        except (ContactError, ValueError):
            return None
        close = np.linalg.norm(there.x - guess) < BEND * length
        straight = there.direction @ here.direction > math.cos(BEND)
        return there if close and straight and there.orbit.admissible else None

    def arm(self, first: _Point) -> tuple[list[_Point], list[Event], str]:
        """Points and events along the direction of `first`, and why they end."""
        points, events, here, step = [first], list[Event](), first, 0.3 * self.step
        looked = first  # up to where events have been looked for
        while len(points) < MOST_STEPS:
            there = self.near(here, step, here.orbit.impacts)
            if there is None and step > SMALLEST:
                step *= 0.5
                continue
            if there is None:
                p, there = self.parameter(here.x), self.with_other_touches(here)
                events.append(Event(kind="grazing", orbit=here.orbit, parameter=p))
                if there is None:
                    return points, events, f"at {p:.9g} one of {here.orbit.impacts} touches is a graze"
                looked = there
            elif np.linalg.norm(there.x - looked.x) > NOISY:
                events += self.events_between(looked, there)
                looked = there
            points.append(there)
            if self.parameter(there.x) in (self.low, self.high):
                return points, events, "range"
            if len(points) > 3 and _passes(first, here, there):
                return points, events, "closed"
            here, step = there, min(1.5 * step, self.step)
        return points, events, f"{MOST_STEPS} steps"

    def with_other_touches(self, here: _Point) -> _Point | None:
        """The first point beyond a grazing orbit, with a touch more or less, started from its fastest touch:
        not from one that is about to be lost."""
        orbit, fastest, p_axis = here.orbit, int(np.argmax(here.orbit.approach)), np.eye(here.x.size)[-1]
        if fastest > 0:
            hit = simulate(orbit.oscillator, orbit.state(), periods=orbit.period).impacts
            time, q, rate = (
                part[fastest] for part in (hit.start, hit.displacement_start, hit.velocity_start)
            )
            turn = orbit.amplitude * np.exp(1j * orbit.oscillator.driven.angular_frequency * time)
            start = deviations(orbit.oscillator.motion(), time, q, rate).ravel()
            z = np.concatenate([start, [turn.imag, turn.real, self.parameter(here.x)]])
            forward = p_axis * here.direction[-1]
            here = self.solve(z / self.scale, p_axis, orbit.impacts).along(forward)
        for touches in (orbit.impacts + 1, orbit.impacts - 1):
            for length in ACROSS if touches else ():
                there = self.near(here, length, touches)
                if there is not None:
                    return there
        return None

    def events_between(self, a: _Point, b: _Point) -> list[Event]:
        """Folds, period doublings and tori between neighbours, in the order in which they are met."""
        from scipy.optimize import brentq  # slow to import

        chord, found = b.x - a.x, list[tuple[float, Event]]()
        normal, seen = chord / np.linalg.norm(chord), {0.0: a, 1.0: b}

        def point(part: float) -> _Point:
            if part not in seen:
                near = min(seen, key=lambda other: abs(other - part))
                guess = seen[near].x + (part - near) * chord
                seen[part] = self.solve(guess, normal, a.orbit.impacts).along(normal)
            return seen[part]

        def test(kind: str, part: float) -> float:
            there = point(part)
            return float(there.direction[-1]) if kind == "fold" else TESTS[kind](there.orbit)

        for kind in ("fold", "period doubling", "torus"):
            if passes(test(kind, 0.0), test(kind, 1.0)):
                place = float(brentq(partial(test, kind), 0.0, 1.0, xtol=PLACE))
                there = point(place)
                if kind != "torus" or is_torus(there.orbit):
                    p = self.parameter(there.x)
                    found.append((place, Event(kind=kind, orbit=there.orbit, parameter=p)))
        return [event for _, event in sorted(found, key=lambda pair: pair[0])]


def _slope(orbit: PeriodicOrbit, rows: Array) -> float:
    """Change of the excess with the approach speed, at fixed p [s/m]; infinite where it does not follow."""
    try:
        turn = np.linalg.solve(np.delete(rows, -2, axis=0), np.eye(len(rows) - 1)[-1])
    except np.linalg.LinAlgError:
        return math.inf
    unit = orbit.oscillator.unit_speed
    return float(drive_of(orbit) @ turn[-2:] / orbit.amplitude / orbit.oscillator.grazing_amplitude() / unit)


def _passes(first: _Point, a: _Point, b: _Point) -> bool:
    """Whether the curve comes by its first point, in its direction, between neighbours a and b."""
    if first.orbit.impacts != b.orbit.impacts or first.direction @ b.direction < 0.5:
        return False
    chord, way = b.x - a.x, first.x - a.x
    part = way @ chord / (chord @ chord)
    return bool(0.0 < part <= 1.0 and np.linalg.norm(way - part * chord) < BEND * np.linalg.norm(chord))
