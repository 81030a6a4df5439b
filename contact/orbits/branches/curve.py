r"""A curve of periodic orbits: its points, one beside another, whatever its unknowns x are.

The orbits obey n equations for n + 1 unknowns x, in units of their sizes, and so lie on a curve.  Its
direction t at a point is the null vector of the n rows of derivatives.  A point is found by Newton's method
in a plane across the curve.  The determinant of the rows with t below them changes sign where two curves
cross, and only there.  The last unknown has a range, beyond which the curve is not followed.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beam.parameters import Refusal
from contact.errors import ContactError, NotPeriodic
from contact.orbits.branches.event_derivatives import peaks
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.simulation import simulate

Array = NDArray[np.float64]

CONVERGED = 1e-12
"""Largest residual in units of the sizes; rounding of the flow over m periods is about 1e-14."""

ROUNDED = 1e-9
"""Residual below which iterates that no longer improve count as an orbit: rounding, 1e-16, times the largest
multiplier, which grows as 1/v towards grazing."""

MOST_ITERATIONS = 25
"""Of Newton's method: from a kick's orbit it takes three to six."""

LONGEST_STEP = 0.3
"""Longest change of an unknown in one iteration, in units of its size: larger ones are shortened."""

BEND, TWIST, STRAIGHT = 0.3, 0.25, 5e-3
"""Largest angle between the directions of neighbours [rad], also part of a step by which it may miss.  Their
chord may differ from the mean of both directions by `TWIST` of that angle and `STRAIGHT`.  On a smooth curve
the difference is of second order in the step, between two curves it is not."""

SHORT = 1e-9
"""Length of a chord below which its direction is rounding."""

DRIFT = 0.1
"""Largest change of the time from the first touch to another one, in drive periods, from neighbour to
neighbour."""

CROSSING = "orbits that repeat themselves cross the curve"

SLOW, SHALLOW = 1e-3, 1e-6
"""Approach velocity over 2 pi f gap of a touch, and depth over the gap of a peak, at a graze."""


class Iterate(NamedTuple):
    """The equations at x: the motion from there, which need not close; the scaled residual, shape (n,), its
    derivatives with x, (n, n + 1); the derivatives of parameter and approach velocity with x, (n + 1,)."""

    orbit: PeriodicOrbit
    residual: Array
    rows: Array
    rise: Array
    quickening: Array


Equations = Callable[[Array], Iterate]


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A point of a curve.

    Parameters
    ----------
    x, direction : ndarray, shape (n + 1,)
    orbit : PeriodicOrbit
    rate : float
        Derivative of the parameter with the arc length.
    turn : float
        Determinant of the rows of derivatives with the direction below them.
    last : bool
        Whether it lies at the end of the range.
    """

    x: Array
    direction: Array
    orbit: PeriodicOrbit
    rate: float
    turn: float
    last: bool = False

    def along(self, other: Array) -> Point:
        """The same with its direction on the side of `other`."""
        if self.direction @ other >= 0.0:
            return self
        return replace(self, direction=-self.direction, rate=-self.rate, turn=-self.turn)


def newton(
    equations: Equations, x: Array, pick: Callable[[Array, Iterate], tuple[float, Array]], period: int
) -> Point:
    """The solution next to `x` of the equations and of one more, ``pick(x, iterate)``: value and gradient.

    One step is made in any case: near grazing a neighbour can lie within the tolerance, and is another orbit.
    """
    found, best, error = None, math.inf, math.inf
    for iteration in range(MOST_ITERATIONS):
        here = equations(x)
        value, gradient = pick(x, here)
        error = max(float(np.max(np.abs(here.residual))), abs(value))
        matrix = np.vstack([here.rows, gradient])
        try:
            inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
        except np.linalg.LinAlgError:
            break
        if iteration > 0:
            if error < best:
                found, best = (x, here, matrix, inverse[:, -1]), error
            if found is not None and (best < CONVERGED or (best < ROUNDED and not error <= best)):
                return _point(found, best)
        change = inverse @ np.append(here.residual, value)
        x = x - change * min(1.0, LONGEST_STEP / max(float(np.max(np.abs(change))), 1e-300))
        if not np.all(np.isfinite(x)):
            break
    if found is not None and best < ROUNDED:
        return _point(found, best)
    raise NotPeriodic(
        time=0.0,
        gap=0.0,
        velocity=0.0,
        detail=f"Newton's method found no orbit of period {period} (residual {error:.1e})",
    )


def _point(solution: tuple[Array, Iterate, Array, Array], error: float) -> Point:
    """The point at a solution: x, the equations there, their rows with one more, and what these turn into the
    last unit vector."""
    x, here, matrix, across = solution
    length = float(np.linalg.norm(across))
    direction = across / length
    rate, quickening = float(here.rise @ direction), float(here.quickening @ direction)
    orbit = replace(here.orbit, residual=error, slope=rate / quickening if quickening else math.inf)
    # the last row of the matrix, turned into the direction, changes its determinant by this factor
    return Point(x=x, direction=direction, orbit=orbit, rate=rate, turn=float(np.linalg.det(matrix)) * length)


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve(ABC):
    """What is the same for all points of a curve: in `ends` the range of the last unknown."""

    like: PeriodicOrbit

    @property
    @abstractmethod
    def ends(self) -> tuple[float, float]:
        """Range of the last unknown."""

    @property
    @abstractmethod
    def whole(self) -> bool:
        """Whether the tip may touch the stop at no other time than in the touches of a point."""

    @abstractmethod
    def equations(self, x: Array, touches: int) -> Equations:
        """The equations of orbits with so many touches, in the neighbourhood of `x`."""

    @abstractmethod
    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """The unknowns of an orbit at the parameter of `here` from a touch: deviations (u, v), time since a
        strobe [s], approach velocity [m/s]."""

    @abstractmethod
    def parameter(self, point: Point) -> float:
        """The parameter at a point."""

    def solve(self, x: Array, normal: Array, touches: int) -> Point:
        """The point of the curve next to `x`, in the plane through it across `normal`."""
        return newton(
            self.equations(x, touches),
            x,
            lambda there, _: (float(normal @ (there - x)), normal),
            self.like.period,
        )

    def at(self, x: Array, touches: int) -> Point:
        """The point next to `x` with its last unknown, or beside it where that turns round there."""
        try:
            return self.solve(x, np.eye(x.size)[-1], touches)
        except ContactError:
            rows = self.equations(x, touches)(x).rows
            return self.solve(x, np.linalg.svd(rows)[-1][-1], touches)

    def near(self, here: Point, length: float, touches: int) -> Point | str:
        """The point a step further on, or at the end of the range; or a sentence that says why there is none.

        The step is refused where the next point is no neighbour on the same curve, or where the tip touches
        the stop at other times than in the touches of the orbit.
        """
        ahead = float(here.direction[-1])
        end = self.ends[1 if ahead > 0.0 else 0]
        room = (end - here.x[-1]) / ahead if ahead else math.inf
        guess, across = here.x + min(length, room) * here.direction, here.direction
        if room <= length:
            guess[-1], across = end, np.eye(guess.size)[-1]
        try:
            there = self.solve(guess, across, touches).along(here.direction)
        except (ContactError, Refusal) as error:
            return str(error)
        if np.linalg.norm(there.x - guess) >= BEND * length:
            return "the curve leaves its tangent"
        why_not = why_not_beside(here, there)
        if not why_not and self.whole and not there.orbit.admissible:
            why_not = "a touch is gained"
        return why_not or replace(there, last=room <= length)

    def restarted(self, here: Point, touch: int) -> Point:
        """The same orbit, started from another of its touches."""
        if touch == 0:
            return here
        orbit = here.orbit
        hit = simulate(orbit.oscillator, orbit.state(), periods=orbit.period).impacts
        start, clock = hit.deviations_start[touch].ravel(), float(hit.clock[touch])
        x = self.unknowns(start, clock, float(hit.approach[touch]), here.x)
        return self.at(x, orbit.impacts)


def why_not_beside(a: Point, b: Point) -> str:
    """Why two points with directions along the way from `a` to `b` are no neighbours on one curve; or ""."""
    if not a.direction @ b.direction > math.cos(BEND):
        return "the curve bends"
    before, after = a.orbit.record[:, 0], b.orbit.record[:, 0]
    if before.size == after.size and np.max(np.abs(after - before)) > DRIFT * a.orbit.oscillator.period:
        return "a touch is gained or lost between others"
    if a.orbit.repeats() != b.orbit.repeats():
        return CROSSING
    chord, mean = b.x - a.x, a.direction + b.direction
    part = chord @ mean / (mean @ mean)
    length = float(np.linalg.norm(chord))
    allowed = STRAIGHT + TWIST * float(np.linalg.norm(b.direction - a.direction))
    if length > SHORT and not (part > 0.0 and np.linalg.norm(chord - part * mean) <= allowed * length):
        return "the step leads to another curve"
    return ""


def grazes(orbit: PeriodicOrbit) -> bool:
    """Whether a touch is about to be lost, or a peak between touches about to become one."""
    if orbit.approach.min() < SLOW * orbit.oscillator.unit_speed:
        return True
    return any(abs(height) < SHALLOW * orbit.oscillator.stop.gap for _, _, height in peaks(orbit))
