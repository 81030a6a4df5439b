"""Branches of periodic orbits, and the points on them that matter.

A branch is followed in the approach velocity v of its first touch, which runs monotonically where the
amplitude turns round (``contact.orbits.shooting``).  Each orbit starts Newton's method for the next; a step
that fails is halved.  Between neighbours folds, period doublings and grazings are located
(``contact.orbits.events``).  A branch that cannot be continued ends with its last good orbit and the reason.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from beam.parameters import require_array, require_kind, require_within
from contact.errors import ContactError
from contact.laws import NEWTON
from contact.orbits.events import Event, events_between, locate, probed
from contact.orbits.kick import KickFamily
from contact.orbits.shooting import PeriodicOrbit, Shooting

__all__ = [
    "Branch",
    "Event",
    "first_event",
    "fold_along_frequency",
    "fold_of",
    "folds_of",
    "follow",
    "lowest_of",
]

GREATEST_STEP = 10.0
"""Longest step of log v: over four decades at once."""

SMALLEST_STEP = 1e-6
"""Step of log v at which a branch is given up: the orbit then changes its character, not its size."""

MOST_STRIDES = 30
"""Bound of steps towards a fold: they cover three decades of the approach velocity."""

MOST_STEPS = 1000
"""Bound of steps towards an event, those included that failed and were halved: a branch has some hundred."""

FIRST_STRIDE, LONGEST_STRIDE = 0.02, 0.3
"""Steps of log v on the way to an event: the first, as it may be close, and the longest."""

GRAZED = 1e-2
"""An approach velocity below this part of the largest one is next to a graze: its contact ends the branch."""

STARTS = (0.1, 0.03, 0.3, 0.01)
"""Approach velocities, over 2 pi f gap, at which a branch is entered where kicks show no fold."""

LEAST_SPEED, GREATEST_SPEED = 1e-6, 2.0
"""Approach velocities, over 2 pi f gap, between which a fold is looked for: faster ones than 2 pi f gap
belong to amplitudes far beyond the letter's."""

@dataclass(frozen=True, kw_only=True, eq=False)
class Branch:
    """A branch of periodic orbits in the order of the approach velocity.

    Parameters
    ----------
    orbits : tuple of PeriodicOrbit
    events : tuple of Event
    ended_low, ended_high : str
        Why the branch ends there: "range", or the sentence of the failure.
    """

    orbits: tuple[PeriodicOrbit, ...]
    events: tuple[Event, ...]
    ended_low: str
    ended_high: str

    def of_kind(self, kind: str) -> list[PeriodicOrbit]:
        """The orbits at the events of one kind."""
        return [event.orbit for event in self.events if event.kind == kind]


def follow(family: Shooting, start: PeriodicOrbit, *, low: float, high: float, step: float = 0.1) -> Branch:
    """The branch through `start`, between the approach velocities `low` and `high` [m/s].

    Parameters
    ----------
    family : Shooting
    start : PeriodicOrbit
    low, high : float
    step : float
        Largest step of log v.
    """
    require_kind("family", family, Shooting, "a Shooting family")
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    for name, value in (("low", low), ("high", high)):
        require_within(name, value, "m/s")
    require_within("step", step, "[1]", low=SMALLEST_STEP, high=GREATEST_STEP)
    if not 0 < low < start.speed < high:
        raise ValueError(
            f"low and high are {low} and {high} m/s; they must enclose the start, {start.speed:g} m/s"
        )
    arms, reasons = [], []
    for limit in (low, high):
        arm, reason = [start], "range"
        stride = step
        # ends: a step reaches the limit, or halvings reach SMALLEST_STEP; no step succeeds below that
        while True:
            far = math.log(limit / arm[-1].speed)
            target = limit if abs(far) <= stride else arm[-1].speed * math.exp(math.copysign(stride, far))
            try:
                there = family.at_speed(target, arm[-1])
                arm += [*probed(family, arm[-1], there)[1:], there]
                stride = min(step, 1.5 * stride)
                if target == limit:
                    break
            except ContactError as error:
                stride *= 0.5
                if stride < SMALLEST_STEP:
                    reason = f"{error}; last orbit at {arm[-1].speed:.6g} m/s, excess {arm[-1].excess:.6g}"
                    break
        arms.append(arm)
        reasons.append(reason)
    orbits = [*arms[0][:0:-1], *arms[1]]
    events = [event for a, b in pairwise(orbits) for event in events_between(family, a, b)]
    return Branch(orbits=tuple(orbits), events=tuple(events), ended_low=reasons[0], ended_high=reasons[1])


def first_event(family: Shooting, start: PeriodicOrbit, lowest: float) -> Event | None:
    """The event that ends the orbit `start` when the amplitude is lowered.

    The branch is followed towards lower amplitudes until an event is met, or until the excess is below
    `lowest` [1]: then the answer is None.
    An orbit that can be followed no further because one of its touches has become a graze ends by "grazing";
    so does one whose only touch falls below `LEAST_SPEED`, as under a contact so soft that no fold is left.

    Raises
    ------
    NotPeriodic
        If the branch is lost for another reason.
    """
    require_kind("family", family, Shooting, "a Shooting family")
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    require_within("lowest", lowest, "[1]", above=-1)
    here, stride, direction = start, FIRST_STRIDE, -math.copysign(1.0, start.slope)
    least = min(LEAST_SPEED * _unit(family), start.speed)
    for _ in range(MOST_STEPS):
        if here.speed < least:
            return Event(kind="grazing", orbit=here)
        try:
            there = family.at_speed(here.speed * math.exp(direction * stride), here)
            orbits = [*probed(family, here, there), there]
        except ContactError:
            stride *= 0.5
            if stride < SMALLEST_STEP:
                if here.approach.min() < GRAZED * here.approach.max():
                    return Event(kind="grazing", orbit=here)
                raise
            continue
        for a, b in pairwise(orbits):
            events = events_between(family, a, b)
            if events:
                return events[0]
        if there.excess < lowest:
            return None
        here, stride = there, min(1.5 * stride, LONGEST_STRIDE)
    return None


def fold_of(family: Shooting, near: PeriodicOrbit | None = None) -> PeriodicOrbit | None:
    """The fold of smallest amplitude, where the family's downward scan ends; None if there is no fold.

    Where contact is soft, at an excess of some 1e-5 and less, a branch can have several folds, and go on
    below the lowest of them until another touch grazes.  A fold below grazing is the orbit of smallest
    amplitude: the soft stretch of the branch, which begins at excess 0 upwards, lies above it.  Any other is
    looked for among `folds_of` the branch, but under Newton's law, where no contact is soft; `lowest_of`
    gives the orbit of smallest amplitude, fold or graze.

    Parameters
    ----------
    family : Shooting
    near : PeriodicOrbit, optional
        An orbit close to the fold, such as that of a neighbouring frequency: the first fold downhill from it
        is taken for the lowest.  Otherwise the kick description, searched over all speeds, leads there.

    Raises
    ------
    NotPeriodic
        If the orbits around the place where the fold should be are not found.
    """
    fold = _fold_near(family, near)
    if (fold is not None and fold.excess < 0.0) or family.oscillator.stop.law.code == NEWTON:
        return fold
    folds = folds_of(family, near if fold is None else fold)
    return min(folds, key=lambda orbit: (not orbit.admissible, orbit.excess), default=None)


def folds_of(family: Shooting, near: PeriodicOrbit | None = None) -> tuple[PeriodicOrbit, ...]:
    """All folds of the branch, by rising approach velocity from 1e-6 to 2 times 2 pi f gap.

    The branch is followed through `near`, or else through the first orbit that the kick description leads to;
    empty also if it leads to none.  Between two steps a pair of folds is seen when the slope comes near zero.
    """
    branch = _whole_branch(family, near)
    return () if branch is None else tuple(branch.of_kind("fold"))


def lowest_of(family: Shooting, near: PeriodicOrbit | None = None) -> Event | None:
    """The admissible orbit of smallest amplitude: a "fold", or the "grazing" that ends the branch below it.

    Parameters and errors are those of `fold_of`.  None if the branch has no such orbit, as where amplitude
    rises all along it from grazing on.
    """
    fold = _fold_near(family, near)
    if fold is not None and fold.excess < 0.0 and fold.admissible:
        return Event(kind="fold", orbit=fold)
    branch = _whole_branch(family, near if fold is None else fold)
    ends = () if branch is None else branch.events
    ends = tuple(event for event in ends if event.kind != "period doubling" and event.orbit.admissible)
    return min(ends, key=lambda event: event.orbit.excess, default=None)


def _whole_branch(family: Shooting, near: PeriodicOrbit | None) -> Branch | None:
    """The branch over all approach velocities; None if no orbit of it is found.

    Raises NotPeriodic if an event on it is not located: from another start it would be the same one.
    """
    require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")
    require_kind("family", family, Shooting, "a Shooting family")
    unit = _unit(family)
    starts = [near] if near is not None else [None] * len(STARTS)
    for start, part in zip(starts, STARTS, strict=False):
        try:
            here = family.at_speed(part * unit if start is None else start.speed, start)
        except ContactError:
            continue
        low = min(LEAST_SPEED * unit, 0.5 * here.speed)
        high = max(GREATEST_SPEED * unit, 2.0 * here.speed)
        return follow(family, here, low=low, high=high, step=LONGEST_STRIDE)
    return None


def _unit(family: Shooting) -> float:
    """2 pi f gap [m/s]."""
    return family.oscillator.drive.angular_frequency * family.oscillator.stop.gap  # type: ignore[union-attr]


def _fold_near(family: Shooting, near: PeriodicOrbit | None) -> PeriodicOrbit | None:
    """The first fold downhill from `near`, or from the fold of the kick description."""
    require_kind("family", family, Shooting, "a Shooting family")
    require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")
    if near is None:
        kick = KickFamily(oscillator=family.oscillator, period=family.period).fold()
        if kick is None:
            return None
        here = family.at_speed(kick.kick.speed)
    else:
        here = family.at_speed(near.speed, near)
    stride, unit = FIRST_STRIDE, _unit(family)
    for _ in range(MOST_STRIDES):
        if not LEAST_SPEED * unit < here.speed < GREATEST_SPEED * unit:
            break
        direction = -math.copysign(1.0, here.slope)
        there = family.at_speed(here.speed * math.exp(direction * stride), here)
        if there.slope * here.slope <= 0:
            return locate(family, here, there, lambda orbit: orbit.slope)
        here, stride = there, min(1.5 * stride, LONGEST_STRIDE)
    return None


def fold_along_frequency(
    family: Shooting, frequencies: np.ndarray, near: PeriodicOrbit | None = None
) -> list[PeriodicOrbit | None]:
    """The folds at `frequencies` [Hz], each started from the one before; None where there is none."""
    require_kind("family", family, Shooting, "a Shooting family")
    found: list[PeriodicOrbit | None] = []
    for frequency in require_array("frequencies", frequencies, "Hz", dimensions=1, words="drive frequencies"):
        drive = replace(family.oscillator.drive, frequency=float(frequency))  # type: ignore[type-var]
        here = replace(family, oscillator=replace(family.oscillator, drive=drive))
        fold = None
        for start in (near, None):
            try:
                fold = fold_of(here, start)
            except ContactError:
                fold = None
            if fold is not None or start is None:
                break
        found.append(fold)
        near = fold
    return found
