"""Branches of periodic orbits along a path p -> oscillator, such as a response curve in the drive frequency.

The curve of the orbits (``contact.orbits.curve``) is followed in its own arc length, in units of the sizes of
its unknowns, and turns round where p does.  Events are found by change of sign between two of its points, so
that two of a kind within one step are not seen, and located by Brent's method: a fold where the p-component
of its direction changes sign, the others by the tests of ``contact.orbits.events``.  Where the tip gains or
loses a touch the curve goes on with another number of touches if there is such an orbit beside it, as under a
law whose force is continuous; else it ends.  What lies within 1e-6 of such a graze is not told from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require, require_kind, require_within
from contact.change import Path
from contact.errors import ContactError, NotPeriodic
from contact.orbits.curve import BEND, Curve, Point, grazes
from contact.orbits.events import TESTS, Branch, Event, is_torus, passes
from contact.orbits.periodic_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator

__all__ = ["follow_path"]

Array = NDArray[np.float64]

SMALLEST, NOISY, MOST_STEPS = 1e-9, 1e-6, 5000
"""Arc length to which a graze is located; over which no other event is looked for, since there the tests are
rounding; and bound of steps."""

ACROSS = tuple(10.0**-k for k in range(9, 2, -1))
"""Steps tried from a grazing orbit to the first one with another number of touches."""

PLACE = 1e-11
"""Part of a step to which an event is located."""

Arm = tuple[list[Point], list[Event], str]
"""Points and events on one side of the start, and why they end."""


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
        If there is no orbit next to `start`, or its tip meets the stop at other times than its touches.
    """
    require(callable(path), f"path is {path!r}; it must be a function of one number")
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    require_within("low", low, "[of p]")
    require_within("high", high, "[of p]", above=low)
    require_within("at", at, "[of p]", low=low, high=high)
    require_within("step", step, "[1]", above=0, high=1)
    modes = require_kind("path(at)", path(at), ImpactOscillator, "an ImpactOscillator").n_modes
    known = start.oscillator.n_modes
    require(modes == known, f"path(at) has {modes} modes; the start has {known}")
    curve = Curve(path=path, low=low, high=high, like=start)
    first = curve.start(at)
    if not first.orbit.admissible:
        words = "the start meets the stop at another time than its touches"
        raise NotPeriodic(time=first.orbit.phase, gap=0.0, velocity=first.orbit.speed, detail=words)
    before, met_before, ended_low = _arm(curve, replace(first, direction=-first.direction), step)
    after, met_after, ended_high = [first], list[Event](), ended_low
    if ended_low != "closed":
        after, met_after, ended_high = _arm(curve, first, step)
    points = [*before[:0:-1], *after]
    return Branch(
        orbits=tuple(point.orbit for point in points), events=(*met_before[::-1], *met_after),
        ended_low=ended_low, ended_high=ended_high,
        parameters=tuple(curve.parameter(point.x) for point in points),
    )  # fmt: skip


def _arm(curve: Curve, first: Point, longest: float) -> Arm:
    """The arm along the direction of `first`."""
    points, events, here, step, looked = [first], list[Event](), first, 0.3 * longest, first
    if curve.parameter(first.x) == (curve.high if first.direction[-1] > 0.0 else curve.low):
        return points, events, "range"
    firsts = [curve.restarted(first, touch) for touch in range(first.orbit.impacts)]
    try:
        while len(points) < MOST_STEPS:
            there, closing = curve.near(here, step, here.orbit.impacts), None
            if isinstance(there, str) and step > SMALLEST:
                step *= 0.5
                continue
            if isinstance(there, str):
                p, reason, beyond = curve.parameter(here.x), there, _with_other_touches(curve, here)
                if beyond is None and not grazes(here.orbit):
                    return points, events, f"at {p:.9g}: {reason}"
                events.append(Event(kind="grazing", orbit=here.orbit, parameter=p))
                if beyond is None:
                    return points, events, f"at {p:.9g} one of {here.orbit.impacts} touches is a graze"
                looked = there = beyond
            else:
                closing = _closing(firsts, here, there) if len(points) > 3 else None
                if closing is not None and closing.direction @ there.direction < 0.0:
                    return points, events, "back the other way: a step was too long"
                there = closing or there
                if np.linalg.norm(there.x - looked.x) > NOISY:
                    events += _events_between(curve, looked, there)
                    looked = there
            points.append(there)
            if closing is not None:
                return points, events, "closed"
            if curve.parameter(there.x) in (curve.low, curve.high):
                return points, events, "range"
            here, step = there, min(1.5 * step, longest)
    except ContactError as error:
        return points, events, f"at {curve.parameter(points[-1].x):.9g}: {error}"
    return points, events, f"{MOST_STEPS} steps"


def _with_other_touches(curve: Curve, here: Point) -> Point | None:
    """The first point beyond a grazing orbit, with a touch more or less, started from its fastest touch: not
    from one that is about to be lost."""
    here = curve.restarted(here, int(np.argmax(here.orbit.approach)))
    for touches in (here.orbit.impacts + 1, here.orbit.impacts - 1):
        for length in ACROSS if touches else ():
            there = curve.near(here, length, touches)
            if isinstance(there, Point):
                return there
    return None


def _closing(firsts: Sequence[Point], a: Point, b: Point) -> Point | None:
    """The first point of the curve, started from one of its touches, if the curve comes by it between
    neighbours a and b, either way."""
    chord = b.x - a.x
    for first in firsts:
        way = first.x - a.x
        part, straight = way @ chord / (chord @ chord), abs(first.direction @ b.direction) > 0.5
        if straight and first.orbit.impacts == b.orbit.impacts and 0.0 < part <= 1.0:
            if np.linalg.norm(way - part * chord) < BEND * np.linalg.norm(chord):
                return first
    return None


def _events_between(curve: Curve, a: Point, b: Point) -> list[Event]:
    """Folds, period doublings and tori between neighbours, in the order in which they are met."""
    from scipy.optimize import brentq  # slow to import

    chord, found = b.x - a.x, list[tuple[float, Event]]()
    normal, seen = chord / np.linalg.norm(chord), {0.0: a, 1.0: b}

    def point(part: float) -> Point:
        if part not in seen:
            near = min(seen, key=lambda other: abs(other - part))
            guess = seen[near].x + (part - near) * chord
            seen[part] = curve.solve(guess, normal, a.orbit.impacts).along(normal)
        return seen[part]

    def test(kind: str, part: float) -> float:
        there = point(part)
        return float(there.direction[-1]) if kind == "fold" else TESTS[kind](there.orbit)

    for kind in ("fold", "period doubling", "torus"):
        if passes(test(kind, 0.0), test(kind, 1.0), "turn" if kind == "fold" else kind):
            place = float(brentq(partial(test, kind), 0.0, 1.0, xtol=PLACE))
            there = point(place)
            if kind != "torus" or is_torus(there.orbit):
                p = curve.parameter(there.x)
                found.append((place, Event(kind=kind, orbit=there.orbit, parameter=p)))
    return [event for _, event in sorted(found, key=lambda pair: pair[0])]
