r"""A curve of periodic orbits: its points, one next to another, whatever its unknowns x are.

The orbits obey n equations for n + 1 unknowns x, in units of their sizes, and so lie on a curve.  Its
direction t at a point is the null vector of the n rows of derivatives.  A point is found by Newton's method
in a plane across the curve.  The determinant of the rows with t below them changes sign where two curves
cross, and only there.  The last unknown has a range, beyond which the curve is not followed.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import replace

import numpy as np

from beam.parameters import Array, Refusal, record
from contact.errors import ContactError
from contact.orbits.families.newton import CurvePoint, Equations, Iterate, newton
from contact.orbits.families.touch_orbit import PeriodicOrbit, peaks
from contact.simulation import simulate

BEND, TWIST, STRAIGHT = 0.3, 0.25, 5e-3
"""Largest angle between the directions of neighbours [rad], also the part of a step by which it may miss.
Their chord may differ from the mean of both directions by `TWIST` of that angle and `STRAIGHT`.  On a smooth
curve the difference is of second order in the step, between two curves it is not."""

SHORT = 1e-9  # length of a chord below which its direction is rounding
DRIFT = 0.1  # largest change of the time between first and another touch to a neighbour, in drive periods

CROSSING = "orbits that repeat themselves cross the curve"

SLOW, SHALLOW, SPLIT = 1e-3, 1e-6, 1e-5
"""At a graze: approach velocity over 2 pi f gap of a touch, depth over the gap of a peak, and rebound over
approach velocity of a touch that splits in two."""


@record
class Curve(ABC):
    """A curve of orbits through or near the orbit `like`, whose period and sizes all points share."""

    like: PeriodicOrbit

    @property
    @abstractmethod
    def ends(self) -> tuple[float, float]:
        """Range of the last unknown."""

    @property
    @abstractmethod
    def admissible_only(self) -> bool:
        """Whether the tip may touch the stop at no other time than in the touches of a point."""

    @abstractmethod
    def equations(self, x: Array, impacts: int) -> Equations:
        """The equations of orbits with so many touches, in the neighbourhood of `x`."""

    @abstractmethod
    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """The unknowns of an orbit at the parameter of `here`, from one of its touches: its deviations
        (u, v), time since a strobe [s] and approach velocity [m/s]."""

    @abstractmethod
    def parameter(self, point: CurvePoint) -> float:
        """The parameter at a point."""

    def step_factor(self, x: Array) -> float:
        """Factor of the longest step at `x`, where the unknowns are large."""
        return 1.0

    def solve(self, x: Array, normal: Array, impacts: int) -> CurvePoint:
        """The point of the curve next to `x`, in the plane through it across `normal`."""

        def pick(there: Array, _: Iterate) -> tuple[float, Array]:
            return float(normal @ (there - x)), normal

        return newton(self.equations(x, impacts), x, pick)

    def at(self, x: Array, impacts: int) -> CurvePoint:
        """The point next to `x` with the same last unknown, or the nearest one where that turns round."""
        try:
            return self.solve(x, np.eye(x.size)[-1], impacts)
        except ContactError:
            rows = self.equations(x, impacts)(x).rows
            return self.solve(x, np.linalg.svd(rows)[-1][-1], impacts)

    def next_point(self, here: CurvePoint, length: float, impacts: int) -> CurvePoint | str:
        """The next point of the curve, or a sentence that says why there is none.

        It lies a step of this `length` further on, or at the end of the range.  It must be a neighbour on the
        same curve; under `admissible_only` its tip meets the stop in its touches only.
        """
        slope = float(here.direction[-1])
        end = self.ends[1 if slope > 0.0 else 0]
        to_end = (end - here.x[-1]) / slope if slope else math.inf
        guess, across = here.x + min(length, to_end) * here.direction, here.direction
        if to_end <= length:
            guess[-1], across = end, np.eye(guess.size)[-1]
        try:
            there = self.solve(guess, across, impacts).oriented(here.direction)
        except (ContactError, Refusal) as error:
            return str(error)
        if np.linalg.norm(there.x - guess) >= BEND * length:
            return "the curve leaves its tangent"
        why_not = why_no_neighbours(here, there)
        if not why_not and self.admissible_only and not there.orbit.admissible:
            why_not = "a touch is gained"
        return why_not or replace(there, last=to_end <= length)

    def with_first_touch(self, here: CurvePoint, touch: int) -> CurvePoint:
        """The same orbit, started from its touch number `touch`."""
        if touch == 0:
            return here
        orbit = here.orbit
        hit = simulate(orbit.oscillator, orbit.state(), periods=orbit.m).impacts
        start, clock = hit.deviations_start[touch].ravel(), float(hit.clock[touch])
        x = self.unknowns(start, clock, float(hit.approach[touch]), here.x)
        return self.at(x, orbit.impacts)


def why_no_neighbours(a: CurvePoint, b: CurvePoint) -> str:
    """Why two points are no neighbours on one curve, in words; "" if they are.

    The directions of both must lie along the way from `a` to `b`.
    """
    if not a.direction @ b.direction > math.cos(BEND):
        return "the curve bends"
    before, after = (point.orbit.record.log["start"] for point in (a, b))
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
    """Whether a touch is about to be lost or to split, or a peak between touches about to become one.

    A touch splits where the tip leaves the stop with no velocity; only a plastic one leaves it so everywhere.
    """
    rebound = np.abs(orbit.record.log["rebound"])
    splits = np.any((rebound > 0.0) & (rebound < SPLIT * orbit.approach))
    if splits or orbit.approach.min() < SLOW * orbit.oscillator.unit_speed:
        return True
    return any(abs(height) < SHALLOW * orbit.oscillator.stop.gap for _, _, height in peaks(orbit))
