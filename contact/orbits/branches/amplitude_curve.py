"""The curve of a family of periodic orbits over the drive amplitude, and how it is entered and left.

Its unknowns are the deviations and the logarithm of the approach velocity of the first touch
(``contact.orbits.families.newton_family``).
"""

import math
from collections.abc import Iterator
from contextlib import suppress

from beam.parameters import Array, record
from contact.errors import BranchEnded, ContactError
from contact.orbits.branches.branch import SHORTER, Branch, Leg, branch_of, walk
from contact.orbits.branches.curve import LATE, Curve, deadline, grazes
from contact.orbits.families.newton import CurvePoint, Equations
from contact.orbits.families.newton_family import NewtonFamily
from contact.orbits.families.touch_orbit import PeriodicOrbit

FIRST_STRIDE, LONGEST_STRIDE = 0.02, 0.3
"""Steps on the way to an event: the first, as it may be close, and the longest."""

STARTS = (0.1, 0.03, 0.3, 0.01, 1.0, 10.0)
"""Approach velocities, over 2 pi f gap, at which a branch is entered where kicks show no fold."""

LEAST_SPEED, GREATEST_SPEED = 1e-6, 1e2
"""Approach velocities, over 2 pi f gap, between which a branch is searched.  Slower touches are grazes.
Beyond the greatest one the gap is about a hundredth of the motion, or less.  Without a gap the amplitude is
proportional to the speed under Newton's law, and about so under others: no fold follows."""

FAR = 2.0  # approach velocity, over 2 pi f gap, beyond which the steps of a search grow with it

PROPORTIONAL = 0.5
"""Least d log(amplitude)/d log(speed) at the greatest speed of a branch without a fold beyond it: 1 without a
gap, negative before a fold."""

WHOLE = ("range", "closed", SHORTER)
"""Ends of a branch that was followed as far as it goes; a branch that ends by a graze was, too."""


@record
class AmplitudeCurve(Curve):
    """The curve of a family between two approach velocities [m/s]; its parameter is the excess."""

    family: NewtonFamily
    slowest: float
    fastest: float
    far: float = math.inf
    admissible_only = False

    @property
    def ends(self) -> tuple[float, float]:
        """Range of log v over 2 pi f gap."""
        unit = self.like.oscillator.unit_speed
        return math.log(self.slowest / unit), math.log(self.fastest / unit)

    def equations(self, x: Array, impacts: int) -> Equations:
        """The equations of the family, which has its own number of touches."""
        return self.family.equations

    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """The unknowns of an orbit from one of its touches; the time follows from the others."""
        return self.family.unknowns(start, speed)

    def parameter(self, point: CurvePoint) -> float:
        """The excess [1]."""
        return point.orbit.excess

    def step_factor(self, x: Array) -> float:
        """Beyond `far` times 2 pi f gap the deviations, and so the steps, grow with the approach velocity."""
        return max(1.0, math.exp(x[-1]) / self.far)

    def start(self) -> CurvePoint:
        """The point next to the orbit `like`."""
        x = self.family.unknowns(self.like.deviations, self.like.speed)
        return self.at(x, self.like.impacts)


def branch_ended(orbit: PeriodicOrbit, words: str) -> BranchEnded:
    """The error of a search that ended at `orbit`, which it carries."""
    error = orbit.failure(BranchEnded, f"{words}; the last orbit has excess {orbit.excess:.6g}")
    error.orbit = orbit
    return error


def downhill(family: NewtonFamily, start: PeriodicOrbit, until: float | None = None) -> Iterator[Leg]:
    """The legs of the branch from `start` towards lower amplitudes."""
    curve = curve_through(start, family, until)
    first = curve.start()
    first = first if first.rate <= 0.0 else first.oriented(-first.direction)
    return walk(curve, first, LONGEST_STRIDE, FIRST_STRIDE)


def at_graze(ended: str, last: PeriodicOrbit) -> bool:
    """Whether a branch ends where a touch becomes a graze: the first one, or another one."""
    slow = ended == "range" and last.speed < 2.0 * LEAST_SPEED * last.oscillator.unit_speed
    return slow or (ended not in ("range", "closed", LATE) and grazes(last))


def curve_through(orbit: PeriodicOrbit, family: NewtonFamily, until: float | None = None) -> AmplitudeCurve:
    """The curve of a family through `orbit`, over the speeds of a search and from below to above its own."""
    low, high = (part * family.oscillator.unit_speed for part in (LEAST_SPEED, GREATEST_SPEED))
    low, high = min(low, 0.5 * orbit.speed), max(high, 2.0 * orbit.speed)
    until = until or deadline()
    return AmplitudeCurve(like=orbit, family=family, slowest=low, fastest=high, far=FAR, until=until)


def entered(family: NewtonFamily, near: PeriodicOrbit | None = None) -> PeriodicOrbit:
    """An orbit of the family: next to `near`, or else at the first of the speeds `STARTS` that has one."""
    unit = family.oscillator.unit_speed
    for speed in [near.speed] if near is not None else [part * unit for part in STARTS]:
        with suppress(ContactError):
            return family.at_speed(speed, near)
    raise BranchEnded(
        detail=f"no orbit of period {family.m} was found to start from; settle a motion, and give its orbit"
    )


def whole_branch(
    family: NewtonFamily, near: PeriodicOrbit | None, until: float | None = None
) -> tuple[AmplitudeCurve, list[CurvePoint], Branch]:
    """The whole branch with its curve and points.

    Raises BranchEnded if there is no orbit to start from, or if the branch is lost on the way.
    """
    here = entered(family, near)
    curve = curve_through(here, family, until)
    try:
        branch, points = branch_of(curve, curve.start(), LONGEST_STRIDE, LONGEST_STRIDE)
    except ContactError as error:
        raise branch_ended(here, f"it cannot be followed: {error}") from error
    for ended, last in ((branch.ended_low, branch.orbits[0]), (branch.ended_high, branch.orbits[-1])):
        if ended not in WHOLE and (ended == LATE or not grazes(last)):
            raise branch_ended(last, f"it is lost: {ended}")
        rise = last.slope * last.speed / (1.0 + last.excess)
        if math.isclose(last.speed, curve.fastest) and rise < PROPORTIONAL:
            raise branch_ended(last, "at the greatest speed of the search the amplitude does not yet rise")
    return curve, points, branch
