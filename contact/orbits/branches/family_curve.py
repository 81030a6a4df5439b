"""The curve of a family of periodic orbits over the drive amplitude, and how it is entered and left.

Its unknowns are (u, v) and log v, v the approach velocity of the first touch
(``contact.orbits.families.shooting``).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require_kind
from contact.errors import BranchEnded, ContactError
from contact.orbits.branches.branch import SHORTER, Branch, Leg, branch_of, walk
from contact.orbits.branches.curve import Curve, Equations, Point, grazes
from contact.orbits.families.periodic_orbit import Followed, PeriodicOrbit

Array = NDArray[np.float64]

FIRST_STRIDE, LONGEST_STRIDE = 0.02, 0.3
"""Steps on the way to an event: the first, as it may be close, and the longest."""

STARTS = (0.1, 0.03, 0.3, 0.01)
"""Approach velocities, over 2 pi f gap, at which a branch is entered where kicks show no fold."""

LEAST_SPEED, GREATEST_SPEED = 1e-6, 2.0
"""Approach velocities, over 2 pi f gap, between which a fold is looked for: slower touches are grazes, faster
ones than 2 pi f gap belong to amplitudes far beyond the letter's."""

WHOLE = ("range", "closed", SHORTER)
"""Ends of a branch that was followed as far as it goes; so is one that ends by a graze."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FamilyCurve(Curve):
    """The curve of a family between two approach velocities [m/s]; its parameter is the excess."""

    family: Followed
    slowest: float
    fastest: float
    whole = False

    @property
    def ends(self) -> tuple[float, float]:
        """Range of log v over 2 pi f gap."""
        unit = self.like.oscillator.unit_speed
        return math.log(self.slowest / unit), math.log(self.fastest / unit)

    def equations(self, x: Array, touches: int) -> Equations:
        """See `Curve`; the number of touches is that of the family."""
        return self.family.equations

    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """See `Curve`; the time follows from the others."""
        return self.family.unknowns(start, speed)

    def parameter(self, point: Point) -> float:
        """The excess [1]."""
        return point.orbit.excess

    def start(self) -> Point:
        """The point next to the orbit `like`."""
        x = self.family.unknowns(self.like.deviations, self.like.speed)
        return self.at(x, self.like.impacts)


def require_followed(family: object, near: object = None) -> None:
    """TypeError unless this is a family to follow and `near` one of its orbits or None."""
    require_kind("family", family, Followed, "a Shooting family")
    require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")


def lost_at(orbit: PeriodicOrbit, words: str) -> BranchEnded:
    """The error of a search that ended at `orbit`, which it carries."""
    detail = f"{words}; the last orbit has excess {orbit.excess:.6g}"
    error = BranchEnded(time=orbit.phase, gap=0.0, velocity=orbit.speed, detail=detail)
    error.orbit = orbit
    return error


def downhill(family: Followed, start: PeriodicOrbit, fastest: float) -> Iterator[tuple[Leg, FamilyCurve]]:
    """The legs of the branch from `start` towards lower amplitudes."""
    unit = family.oscillator.unit_speed
    slow, fast = min(LEAST_SPEED * unit, 0.5 * start.speed), max(fastest * unit, 2.0 * start.speed)
    curve = FamilyCurve(like=start, family=family, slowest=slow, fastest=fast)
    first = curve.start()
    first = first if first.rate <= 0.0 else first.along(-first.direction)
    for leg in walk(curve, first, LONGEST_STRIDE, FIRST_STRIDE):
        yield leg, curve


def at_graze(ended: str, last: PeriodicOrbit) -> bool:
    """Whether a branch ends where a touch becomes a graze: the first one, or another one."""
    slow = ended == "range" and last.speed < 2.0 * LEAST_SPEED * last.oscillator.unit_speed
    return slow or (ended not in ("range", "closed") and grazes(last))


def whole_branch(family: Followed, near: PeriodicOrbit | None) -> tuple[FamilyCurve, list[Point], Branch]:
    """The whole branch with its curve and points.

    Raises BranchEnded if there is no orbit to start from, or if the branch is lost on the way.
    """
    require_followed(family, near)
    unit = family.oscillator.unit_speed
    for speed in [near.speed] if near is not None else [part * unit for part in STARTS]:
        try:
            here = family.at_speed(speed, near)
        except ContactError:
            continue
        low = min(LEAST_SPEED * unit, 0.5 * here.speed)
        high = max(GREATEST_SPEED * unit, 2.0 * here.speed)
        curve = FamilyCurve(like=here, family=family, slowest=low, fastest=high)
        branch, points = branch_of(curve, curve.start(), LONGEST_STRIDE, LONGEST_STRIDE)
        for ended, last in ((branch.ended_low, branch.orbits[0]), (branch.ended_high, branch.orbits[-1])):
            if ended not in WHOLE and not grazes(last):
                raise lost_at(last, f"it is lost: {ended}")
        return curve, points, branch
    words = f"no orbit of period {family.kicks.period} was found to start from"
    raise BranchEnded(time=0.0, gap=0.0, velocity=0.0, detail=words)
