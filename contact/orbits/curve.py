r"""The curve of periodic orbits over the parameter of a path p -> oscillator: its points, one beside another.

An orbit starts at its first touch from z = (u, v, S, C), with the tip y over the stop, and obeys

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0,      |(S, C)| = Z(p)

(``contact.orbits.derivatives``, with exact tangents in z and p): 2 N + 2 equations for the 2 N + 3 unknowns
(z, p).  A point is found by Newton's method in a plane across the curve; the unknowns are in units of their
sizes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contact.change import Change, Changes, Path, change_along
from contact.errors import ContactError, NotPeriodic
from contact.flight.modal_flow import steady_motion
from contact.orbits.derivatives import drive_of, equations_of, sizes_of
from contact.orbits.event_derivatives import peaks
from contact.orbits.periodic_orbit import PeriodicOrbit
from contact.simulation import simulate
from contact.virtual_motion import deviations

__all__ = ["Curve", "Point", "grazes"]

Array = NDArray[np.float64]

CONVERGED, ROUNDED, MOST_ITERATIONS = 1e-12, 1e-9, 8
"""Largest residual in units of the sizes; below which an iterate that no longer improves counts, as in
``contact.orbits.shooting``; and iterations of Newton's method."""

BEND = 0.3
"""Largest angle between the directions of neighbours [rad], and part of a step by which it may miss."""

SLOW, SHALLOW = 1e-3, 1e-6
"""Approach velocity over 2 pi f gap of a touch, and depth over the gap of a peak, at a graze."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A point of the curve: scaled unknowns, direction, and the orbit."""

    x: Array
    direction: Array
    orbit: PeriodicOrbit

    def along(self, other: Array) -> Point:
        """The same with its direction on the side of `other`."""
        return self if self.direction @ other >= 0.0 else replace(self, direction=-self.direction)


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """What is the same for all points; the unknowns are scaled by the sizes of the orbit `like`."""

    path: Path
    low: float
    high: float
    like: PeriodicOrbit

    @cached_property
    def scale(self) -> Array:
        """Sizes of (u, v, S, C, p - low)."""
        amplitude = self.like.oscillator.grazing_amplitude()
        return np.concatenate([sizes_of(self.like), [amplitude, amplitude, 0.1 * (self.high - self.low)]])

    def unknowns(self, start: Array, drive: Array, p: float) -> Array:
        """The scaled unknowns of (u, v), (S, C) and p."""
        return np.concatenate([start, drive, [p - self.low]]) / self.scale

    def parameter(self, x: Array) -> float:
        """p at these unknowns; the ends of the range without rounding."""
        p = self.low + float(x[-1] * self.scale[-1])
        near = 1e-14 * (self.high - self.low)
        return next((end for end in (self.low, self.high) if abs(p - end) <= near), p)

    def at(self, x: Array, touches: int) -> Point:
        """The point next to `x` at its p, or beside it where p turns round there."""
        try:
            return self.solve(x, np.eye(x.size)[-1], touches)
        except NotPeriodic:
            across = np.linalg.svd(self.equations(x, touches, self.change(x))[-1][:-1])[-1][-1]
            return self.solve(x, across, touches)

    def start(self, p: float) -> Point:
        """The point next to the orbit `like`, at this p."""
        return self.at(self.unknowns(self.like.deviations, drive_of(self.like), p), self.like.impacts)

    def solve(self, x: Array, normal: Array, touches: int) -> Point:
        """The point of the curve next to `x`, in the plane through it across `normal`."""
        guess, best, found = x, math.inf, Point(x=x, direction=normal, orbit=self.like)
        change = self.change(x)  # p hardly moves; where the curve turns round does not depend on it
        for iteration in range(MOST_ITERATIONS):
            orbit, residual, rows = self.equations(x, touches, change)
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
                found = Point(x=x, direction=direction, orbit=replace(orbit, slope=slope, residual=error))
                if error < CONVERGED:
                    return found
            x = x - inverse @ np.append(residual, normal @ (x - guess))
        words = f"Newton's method found no orbit of period {self.like.period} (residual {best:.1e})"
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=words)

    def change(self, x: Array) -> Change:
        """How the numbers of the oscillator change with p there."""
        return change_along(self.path, self.parameter(x), self.low, self.high)

    def equations(self, x: Array, touches: int, change: Change) -> tuple[PeriodicOrbit, Array, Array]:
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
        changes = Changes(oscillator=driven, changes=(change,))
        end, record, tangent, rows = equations_of(orbit, changes)
        weight = np.append(self.scale[:n], [here.stop.gap, self.scale[-2], here.unit_speed])
        reach = float(here.tip(u + q)) - driven.motion().gap
        residual = np.concatenate([end - z[:n], [reach, reached - here.driven.amplitude]]) / weight[:-1]
        return replace(orbit, record=record, tangent=tangent), residual, rows * self.scale / weight[:, None]

    def near(self, here: Point, length: float, touches: int) -> Point | str:
        """The point a step further on, or at the end of the range; why not, if there is none close to it or
        its tip touches the stop at other times than told."""
        rate, p = self.scale[-1] * here.direction[-1], self.parameter(here.x)
        room = ((self.high if rate > 0.0 else self.low) - p) / rate if rate else math.inf
        guess, across = here.x + min(length, room) * here.direction, here.direction
        if room <= length:
            across = np.eye(guess.size)[-1]
        try:
            there = self.solve(guess, across, touches).along(here.direction)
        except (ContactError, ValueError) as error:
            return str(error)
        if np.linalg.norm(there.x - guess) >= BEND * length:
            return "the curve leaves its tangent"
        if there.direction @ here.direction <= math.cos(BEND):
            return "the curve bends"
        return there if there.orbit.admissible else "a touch is gained"

    def restarted(self, here: Point, touch: int) -> Point:
        """The same orbit, started from another of its touches."""
        if touch == 0:
            return here
        orbit, p_axis = here.orbit, np.eye(here.x.size)[-1]
        hit = simulate(orbit.oscillator, orbit.state(), periods=orbit.period).impacts
        time, q, rate = (part[touch] for part in (hit.start, hit.displacement_start, hit.velocity_start))
        turn = orbit.amplitude * np.exp(1j * orbit.oscillator.driven.angular_frequency * time)
        start = deviations(orbit.oscillator.motion(), time, q, rate).ravel()
        x = self.unknowns(start, np.array([turn.imag, turn.real]), self.parameter(here.x))
        return self.at(x, orbit.impacts).along(p_axis * here.direction[-1])


def grazes(orbit: PeriodicOrbit) -> bool:
    """Whether a touch is about to be lost, or a peak between touches about to become one."""
    if orbit.approach.min() < SLOW * orbit.oscillator.unit_speed:
        return True
    return any(height > -SHALLOW * orbit.oscillator.stop.gap for _, _, height in peaks(orbit))


def _slope(orbit: PeriodicOrbit, rows: Array) -> float:
    """Change of the excess with the approach speed, at fixed p [s/m]; infinite where it does not follow."""
    try:
        turn = np.linalg.solve(np.delete(rows, -2, axis=0), np.eye(len(rows) - 1)[-1])
    except np.linalg.LinAlgError:
        return math.inf
    unit = orbit.oscillator.unit_speed
    return float(drive_of(orbit) @ turn[-2:] / orbit.amplitude / orbit.oscillator.grazing_amplitude() / unit)
