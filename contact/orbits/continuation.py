"""Branches of periodic orbits, and the points on them that matter.

A branch is followed in the approach velocity v of its first touch, which runs monotonically where the
amplitude turns round (``contact.orbits.shooting``).  Each orbit starts Newton's method for the next; a step
that fails is halved.  Between neighbours folds, period doublings and grazings are located
(``contact.orbits.events``).  A branch that cannot be continued ends with its last good orbit and the reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from beam.parameters import require_array, require_kind, require_within
from contact.errors import ContactError
from contact.laws import NEWTON
from contact.orbits.events import Branch, Event, events_between, locate, passes, probed
from contact.orbits.kick import SPEEDS
from contact.orbits.periodic_orbit import Followed, PeriodicOrbit

__all__ = [
    "Branch",
    "Event",
    "first_event",
    "fold_along_frequency",
    "fold_of",
    "folds_of",
    "follow",
    "lowest_of",
    "orbits_at",
]

GREATEST_STEP = 10.0
"""Longest step of log v: over four decades at once."""

SMALLEST_STEP = 1e-6
"""Step of log v at which a branch is given up: the orbit then changes its character, not its size."""

MOST_STEPS = 1000
"""Bound of steps along a branch beside twice those that it takes: they are halved where they fail."""

FASTEST = 100.0
"""Approach velocity, over 2 pi f gap, up to which an event is looked for, or twice the one of the start."""

FIRST_STRIDE, LONGEST_STRIDE = 0.02, 0.3
"""Steps of log v on the way to an event: the first, as it may be close, and the longest."""

GRAZED = 1e-2
"""An approach velocity below this part of the largest one is next to a graze: its contact ends the branch."""

STARTS = (0.1, 0.03, 0.3, 0.01)
"""Approach velocities, over 2 pi f gap, at which a branch is entered where kicks show no fold."""

LEAST_SPEED, GREATEST_SPEED = 1e-6, 2.0
"""Approach velocities, over 2 pi f gap, between which a fold is looked for: faster ones than 2 pi f gap
belong to amplitudes far beyond the letter's."""


Pairs = Iterator[tuple[PeriodicOrbit, PeriodicOrbit]]


def require_followed(family: object, near: object = None) -> None:
    """TypeError unless this is a family to follow and `near` one of its orbits or None."""
    require_kind("family", family, Followed, "a Shooting family")
    require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")


def follow(family: Followed, start: PeriodicOrbit, *, low: float, high: float, step: float = 0.1) -> Branch:
    """The branch through `start`, between the approach velocities `low` and `high` [m/s].

    Parameters
    ----------
    family : Shooting
    start : PeriodicOrbit
    low, high : float
    step : float
        Largest step of log v.
    """
    require_followed(family)
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
        try:
            for _, there in _walk(family, start, limit, first=step, longest=step):
                arm.append(there)
        except ContactError as error:
            reason = f"{error}; last orbit at {arm[-1].speed:.6g} m/s, excess {arm[-1].excess:.6g}"
        arms.append(arm)
        reasons.append(reason)
    orbits = [*arms[0][:0:-1], *arms[1]]
    events = [event for a, b in pairwise(orbits) for event in events_between(family, a, b)]
    return Branch(orbits=tuple(orbits), events=tuple(events), ended_low=reasons[0], ended_high=reasons[1])


def _walk(family: Followed, here: PeriodicOrbit, limit: float, *, first: float, longest: float) -> Pairs:
    """Neighbours along a branch, one after the other, up to the approach velocity `limit` [m/s].

    A step of log v grows from `first` to `longest`, and is halved where it fails; the ContactError of one
    that has become `SMALLEST_STEP` is raised.
    """
    stride = first
    for _ in range(MOST_STEPS + round(2.0 * abs(math.log(limit / here.speed)) / longest)):
        far = math.log(limit / here.speed)
        target = limit if abs(far) <= stride else here.speed * math.exp(math.copysign(stride, far))
        try:
            there = family.at_speed(target, here)
            orbits = [*probed(family, here, there), there]
        except ContactError:
            stride *= 0.5
            if stride < SMALLEST_STEP:
                raise
            continue
        yield from pairwise(orbits)
        if target == limit:
            return
        here, stride = there, min(1.5 * stride, longest)


def _downhill(family: Followed, start: PeriodicOrbit, slowest: float, fastest: float) -> Pairs:
    """Neighbours from `start` towards lower amplitudes, up to one of these approach velocities [m/s]."""
    limit = slowest if start.slope > 0.0 else fastest
    return _walk(family, start, limit, first=FIRST_STRIDE, longest=LONGEST_STRIDE)


def first_event(family: Followed, start: PeriodicOrbit, lowest: float) -> Event | None:
    """The event that ends the orbit `start` when the amplitude is lowered.

    The branch is followed towards lower amplitudes until an event is met, or until the excess is below
    `lowest` [1]: then the answer is None.
    An orbit that can be followed no further because one of its touches has become a graze ends by "grazing";
    so does one whose only touch falls below `LEAST_SPEED`, as under a contact so soft that no fold is left.
    NotPeriodic is raised if the branch is lost for another reason.
    """
    require_followed(family)
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    require_within("lowest", lowest, "[1]", above=-1)
    last, unit = start, family.oscillator.unit_speed
    slow, fast = min(LEAST_SPEED * unit, 0.5 * start.speed), max(FASTEST * unit, 2.0 * start.speed)
    try:
        for here, there in _downhill(family, start, slow, fast):
            events = events_between(family, here, there)
            if events:
                return events[0]
            last = there
            if there.excess < lowest:
                return None
    except ContactError:
        if last.approach.min() >= GRAZED * last.approach.max():
            raise
        return Event(kind="grazing", orbit=last)
    return Event(kind="grazing", orbit=last) if start.slope > 0.0 else None


def fold_of(family: Followed, near: PeriodicOrbit | None = None) -> PeriodicOrbit | None:
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


def folds_of(family: Followed, near: PeriodicOrbit | None = None) -> tuple[PeriodicOrbit, ...]:
    """All folds of the branch, by rising approach velocity from 1e-6 to 2 times 2 pi f gap.

    The branch is followed through `near`, or else through the first orbit that the kick description leads to;
    empty also if it leads to none.  Between two steps a pair of folds is seen when the slope comes near zero.
    """
    return tuple(_whole_branch(family, near).of_kind("fold"))


def lowest_of(family: Followed, near: PeriodicOrbit | None = None) -> Event | None:
    """The admissible orbit of smallest amplitude: a "fold", or the "grazing" that ends the branch below it.

    Parameters and errors are those of `fold_of`.  None if the branch has no such orbit, as where amplitude
    rises all along it from grazing on.
    """
    fold = _fold_near(family, near)
    if fold is not None and fold.excess < 0.0 and fold.admissible:
        return Event(kind="fold", orbit=fold)
    events = _whole_branch(family, near if fold is None else fold).events
    ends = [event for event in events if event.kind in ("fold", "grazing") and event.orbit.admissible]
    return min(ends, key=lambda event: event.orbit.excess, default=None)


def orbits_at(family: Followed, excess: float) -> tuple[PeriodicOrbit, ...]:
    """The orbits of the branch of `folds_of` at F/F_g - 1 = `excess`, by rising approach velocity."""
    require_within("excess", excess, "[1]", above=-1)
    branch = _whole_branch(family, None)
    orbits = sorted([*branch.orbits, *branch.of_kind("fold")], key=lambda orbit: orbit.speed)
    return tuple(
        locate(family, a, b, lambda orbit: orbit.excess - excess)
        for a, b in pairwise(orbits)
        if (a.excess - excess) * (b.excess - excess) < 0.0
    )


def _whole_branch(family: Followed, near: PeriodicOrbit | None) -> Branch:
    """The branch over all approach velocities; without orbits if none of it is found.

    Raises NotPeriodic if an event on it is not located: from another start it would be the same one.
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
        return follow(family, here, low=low, high=high, step=LONGEST_STRIDE)
    return Branch(orbits=(), events=(), ended_low="no orbit", ended_high="no orbit")


def _fold_near(family: Followed, near: PeriodicOrbit | None) -> PeriodicOrbit | None:
    """The first fold downhill from `near`, or from the fold of the kick description."""
    require_followed(family, near)
    guess = near or family.kicks.fold() or family.kicks.fold((SPEEDS[0], GREATEST_SPEED))
    if guess is None:
        return None
    start, unit = family.at_speed(guess.speed, near), family.oscillator.unit_speed
    slow, fast = LEAST_SPEED * unit, GREATEST_SPEED * unit
    if slow < start.speed < fast:
        for a, b in _downhill(family, start, slow, fast):
            if passes(a.slope, b.slope):
                return locate(family, a, b, lambda orbit: orbit.slope)
    return None


def fold_along_frequency(
    family: Followed, frequencies: np.ndarray, near: PeriodicOrbit | None = None
) -> list[PeriodicOrbit | None]:
    """The folds at `frequencies` [Hz], each started from the one before; None where there is none."""
    require_followed(family, near)
    found: list[PeriodicOrbit | None] = []
    for frequency in require_array("frequencies", frequencies, "Hz", dimensions=1, words="drive frequencies"):
        drive = replace(family.oscillator.driven, frequency=float(frequency))
        here = family.of(replace(family.oscillator, drive=drive))
        fold = None
        for start in dict.fromkeys((near, None)):
            try:
                fold = fold or fold_of(here, start)
            except ContactError:
                continue
        found.append(fold)
        near = fold
    return found
