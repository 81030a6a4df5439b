r"""A curve of periodic orbits: its points, one next to another, whatever its unknowns x are.

The orbits obey n equations for n + 1 unknowns x, in units of their sizes, and so lie on a curve.  Its
direction t at a point is the null vector of the n rows of derivatives.  A point is found by Newton's method
in a plane across the curve.  The determinant of the rows with t below them changes sign where two curves
cross, and only there.  The last unknown has a range, beyond which the curve is not followed.
"""

import math
import time
from abc import ABC, abstractmethod
from dataclasses import field, replace

import numpy as np

from beam.parameters import Array, Refusal, record
from contact.errors import BranchEnded, ContactError
from contact.orbits.families.newton import CurvePoint, Equations, Iterate, newton
from contact.orbits.families.touch_orbit import ALIKE, PeriodicOrbit, peaks

BEND, TWIST, STRAIGHT = 0.3, 0.25, 5e-3
"""Largest angle between the directions of neighbours [rad], also the part of a step by which it may miss.
Their chord may differ from the mean of both directions by `TWIST` of that angle and `STRAIGHT`.  On a smooth
curve the difference is of second order in the step, between two curves it is not."""

MOST_SECONDS = 20.0
LATE = f"{MOST_SECONDS:g} s of processor time are used up"
"""Processor time of one call.  Branches of the letter's spring take less than two seconds; a branch on which
every step fails could take hours."""

SHORT = 1e-9  # length of a chord below which its direction is rounding

CROSSING = "orbits that repeat themselves cross the curve"

SLOW, SHALLOW, SPLIT = 1e-3, 1e-6, 1e-3
"""At a graze: approach velocity over 2 pi f gap of a touch, depth over the gap of a peak, and rebound over
approach velocity of a touch that splits in two."""


def deadline() -> float:
    """The processor time of this thread at which a call that begins now gives up [s]."""
    return time.thread_time() + MOST_SECONDS


@record
class Curve(ABC):
    """A curve of orbits through or near the orbit `like`, whose period and sizes all points share.

    No point is looked for after the processor time `until` of this thread [s].
    """

    like: PeriodicOrbit
    until: float = field(default_factory=deadline)

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

    def late(self) -> bool:
        """Whether the processor time is used up."""
        return time.thread_time() > self.until

    def step_factor(self, x: Array) -> float:
        """Factor of the longest step at `x`, where the unknowns are large."""
        return 1.0

    def solve(self, x: Array, normal: Array, impacts: int) -> CurvePoint:
        """The point of the curve next to `x`, in the plane through it across `normal`."""
        if self.late():
            raise BranchEnded(detail=LATE)

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
        if to_end > length and (there.x[-1] - end) * slope > 0.0:
            return "the curve bends out of its range"
        if np.linalg.norm(there.x - guess) >= BEND * length:
            return "the curve leaves its tangent"
        why_not = why_no_neighbours(here, there)
        if not why_not and self.admissible_only and not there.orbit.admissible:
            why_not = "a touch is gained"
        return why_not or replace(there, last=to_end <= length)

    def with_first_touch(self, here: CurvePoint, touch: int) -> CurvePoint | None:
        """The same orbit, started from its touch number `touch`; None if it is not found again from there."""
        if touch == 0:
            return here
        orbit, (log, states) = here.orbit, (here.orbit.record.log, here.orbit.record.states)
        time, speed = orbit.phase + float(log["start"][touch]), float(log["approach"][touch])
        try:
            there = self.at(self.unknowns(states[touch, 0].ravel(), time, speed, here.x), orbit.impacts)
        except ContactError:
            return None
        same = np.abs(there.orbit.approach - np.roll(orbit.approach, -touch)) <= ALIKE * orbit.approach.max()
        return there if np.all(same) else None


def why_no_neighbours(a: CurvePoint, b: CurvePoint) -> str:
    """Why two points are no neighbours on one curve, in words; "" if they are.

    The directions of both must lie along the way from `a` to `b`.  Besides the unknowns, times and approach
    velocities of the touches count as coordinates.  Near a graze one of them changes fast.
    """
    ways, chord = [a.direction, b.direction], b.x - a.x
    if a.orbit.impacts == b.orbit.impacts > 1:
        sizes = np.array([[a.orbit.oscillator.period / (2.0 * math.pi)], [a.orbit.approach.max()]])
        before, after = (np.array([p.orbit.record.log["start"], p.orbit.approach]) for p in (a, b))
        chord = np.append(chord, (after - before) / sizes)
        ways = [np.append(p.direction, p.touches / sizes) for p in (a, b)]
        ways = [way / np.linalg.norm(way) for way in ways]
    if not ways[0] @ ways[1] > math.cos(BEND):
        return "the curve bends"
    if a.orbit.repeats() != b.orbit.repeats():
        return CROSSING
    mean = ways[0] + ways[1]
    part = chord @ mean / (mean @ mean)
    length = float(np.linalg.norm(chord))
    allowed = STRAIGHT + TWIST * float(np.linalg.norm(ways[1] - ways[0]))
    if length > SHORT and not (part > 0.0 and np.linalg.norm(chord - part * mean) <= allowed * length):
        return "the step leads to another curve"
    return ""


def grazes(orbit: PeriodicOrbit) -> bool:
    """Whether a touch is about to be lost or to split, or a peak between touches about to become one.

    A contact of finite duration splits where the tip leaves the stop with no velocity.
    """
    log = orbit.record.log
    splits = np.any((log["end"] > log["start"]) & (np.abs(log["rebound"]) < SPLIT * orbit.approach))
    if splits or orbit.approach.min() < SLOW * orbit.oscillator.unit_speed:
        return True
    return any(abs(height) < SHALLOW * orbit.oscillator.stop.gap for _, _, height in peaks(orbit))
