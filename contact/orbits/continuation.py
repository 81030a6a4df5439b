"""Branches of periodic orbits, and the points on them that matter.

A branch is followed in the approach velocity v of its first touch, which runs monotonically where the
amplitude turns round (``contact.orbits.shooting``).  Each orbit starts Newton's method for the next; a step
that fails is halved.  Between neighbours the following are located by Brent's method on log v:

    fold              dZ/dv changes sign: two orbits, one stable, meet
    period doubling   det(M + I) changes sign: a multiplier passes -1
    grazing           the orbit gains or loses a touch of the stop (certified flights)

A branch that cannot be continued ends with its last good orbit and the reason.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from beam.parameters import require_array, require_kind, require_within
from contact.errors import ContactError
from contact.orbits.kick import KickFamily
from contact.orbits.shooting import PeriodicOrbit, Shooting

__all__ = ["Branch", "Event", "fold_along_frequency", "fold_of", "follow"]

GREATEST_STEP = 10.0
"""Longest step of log v: over four decades at once."""

SMALLEST_STEP = 1e-6
"""Step of log v at which a branch is given up: the orbit then changes its character, not its size."""

MOST_STRIDES = 30
"""Bound of steps towards a fold: they cover three decades of the approach velocity."""

LEAST_SPEED, GREATEST_SPEED = 1e-6, 2.0
"""Approach velocities, over 2 pi f gap, between which a fold is looked for: faster ones than 2 pi f gap
belong to amplitudes far beyond the letter's."""

PLACE = 1e-10
"""Accuracy of log v at a located point; the excess there is good to the square of it at a fold."""

MOST_HALVINGS = 60
"""Bound of the halvings of a bracket: 2^-60 of any step is below PLACE."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Event:
    """A point on a branch: "fold", "period doubling" or "grazing"."""

    kind: str
    orbit: PeriodicOrbit


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


def doubling(orbit: PeriodicOrbit) -> float:
    """det(M + I): zero where a multiplier is -1."""
    return float(np.prod(orbit.multipliers + 1.0).real)


def _locate(
    family: Shooting, a: PeriodicOrbit, b: PeriodicOrbit, test: Callable[[PeriodicOrbit], float]
) -> PeriodicOrbit:
    """The orbit between neighbours a and b where `test` changes sign."""
    seen = {math.log(a.speed): a, math.log(b.speed): b}

    def value(x: float) -> float:
        if x not in seen:
            near = min(seen.values(), key=lambda orbit: abs(math.log(orbit.speed) - x))
            seen[x] = family.at_speed(math.exp(x), near)
        return test(seen[x])

    root = brentq(value, math.log(a.speed), math.log(b.speed), xtol=PLACE, rtol=1e-14)
    value(root)
    return seen[root]


def _bisect(family: Shooting, a: PeriodicOrbit, b: PeriodicOrbit) -> PeriodicOrbit:
    """The last admissible orbit between an admissible and an inadmissible neighbour."""
    good, bad = (a, b) if a.admissible else (b, a)
    for _ in range(MOST_HALVINGS):
        if abs(math.log(good.speed / bad.speed)) <= PLACE:
            break
        middle = family.at_speed(math.sqrt(good.speed * bad.speed), good)
        if middle.admissible:
            good = middle
        else:
            bad = middle
    return good


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
                arm.append(family.at_speed(target, arm[-1]))
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
    events = []
    for a, b in pairwise(orbits):
        if a.slope * b.slope < 0:
            events.append(Event(kind="fold", orbit=_locate(family, a, b, lambda orbit: orbit.slope)))
        if doubling(a) * doubling(b) < 0:
            events.append(Event(kind="period doubling", orbit=_locate(family, a, b, doubling)))
        if a.admissible != b.admissible:
            events.append(Event(kind="grazing", orbit=_bisect(family, a, b)))
    return Branch(orbits=tuple(orbits), events=tuple(events), ended_low=reasons[0], ended_high=reasons[1])


def fold_of(family: Shooting, near: PeriodicOrbit | None = None) -> PeriodicOrbit | None:
    """The orbit of smallest amplitude, where the family's downward scan ends; None if there is no fold.

    Parameters
    ----------
    family : Shooting
    near : PeriodicOrbit, optional
        An orbit close to the fold, such as that of a neighbouring frequency; otherwise the kick description
        leads there.

    Raises
    ------
    NotPeriodic
        If the orbits around the place where the fold should be are not found.
    """
    require_kind("family", family, Shooting, "a Shooting family")
    require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")
    if near is None:
        kick = KickFamily(oscillator=family.oscillator, period=family.period).fold()
        if kick is None:
            return None
        here = family.at_speed(kick.kick.speed)
    else:
        here = family.at_speed(near.speed, near)
    stride = 0.02
    unit = family.oscillator.drive.angular_frequency * family.oscillator.stop.gap  # type: ignore[union-attr]
    for _ in range(MOST_STRIDES):
        if not LEAST_SPEED * unit < here.speed < GREATEST_SPEED * unit:
            break
        direction = -math.copysign(1.0, here.slope)
        there = family.at_speed(here.speed * math.exp(direction * stride), here)
        if there.slope * here.slope <= 0:
            return _locate(family, here, there, lambda orbit: orbit.slope)
        here, stride = there, min(1.5 * stride, 0.3)
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
