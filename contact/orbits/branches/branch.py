"""A branch of periodic orbits: a curve followed in its arc length both ways from one orbit.

A step that fails is halved; between neighbours events are located (``contact.orbits.branches.events``).  The
branch ends at the end of the range, where it closes on itself, or where there is no neighbour: then a
sentence says why.  Where the tip gains or loses a touch, a curve with `admissible_only` goes on with another
number of touches.  Such a neighbour exists under a law whose force is continuous.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from textwrap import shorten
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from beam.record import record
from contact import plots
from contact.errors import ContactError
from contact.orbits.branches.curve import BEND, CROSSING, LATE, Curve, grazes
from contact.orbits.branches.events import CLOSE, Event, event_at, events_between, refined, with_undecided
from contact.orbits.families.newton import CurvePoint
from contact.orbits.families.touch_orbit import NEARLY, PeriodicOrbit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SMALLEST, MOST_STEPS = 1e-9, 5000
"""Step of arc length at which a branch is given up and to which a graze is located; and bound of steps."""

ACROSS = tuple(10.0**-k for k in range(9, 2, -1))
"""Steps tried from a grazing orbit to the first one with another number of touches."""

FEW, WIDE, SLOW = 4, 80, 1e-3
"""Events that are printed, and characters of a reason; slowest touch of a picture over the fastest one."""

SHORTER = "the orbit becomes one of a shorter period, which runs through it several times"


@record
class Branch:
    """A branch of periodic orbits, with the events on it.

    `follow` and `follow_path` return branches.  Both kinds of branches hold their orbits in the order along
    the curve.

    Parameters
    ----------
    orbits : tuple of PeriodicOrbit
        The orbits in their order along the branch.
    events : tuple of Event
        The events in their order along the branch.
    ended_low, ended_high : str
        Why the branch ends at its first and at its last orbit: "range", "closed", or a sentence.
    parameters : tuple of float, optional
        The parameter of each orbit on the path of `follow_path`; empty for a branch over the amplitude.
    """

    orbits: tuple[PeriodicOrbit, ...]
    events: tuple[Event, ...]
    ended_low: str
    ended_high: str
    parameters: tuple[float, ...] = ()

    def __repr__(self) -> str:
        """Number and kind of its orbits, the first events, and why it ends."""
        admissible = [orbit for orbit in self.orbits if orbit.admissible]
        kinds = f"{len(admissible)} admissible, {sum(orbit.stable for orbit in admissible)} of them stable"
        named = [f"{event.kind} at {event.parameter:#.3g}" for event in self.events[:FEW]]
        more = [f"{len(self.events) - FEW} events more"] if len(self.events) > FEW else []
        return (
            f"Branch({len(self.orbits)} orbits p{self.orbits[0].m}, {kinds}\n"
            f"    {', '.join([*named, *more]) or 'no event'}\n"
            f"    ended_low={shorten(self.ended_low, WIDE)}\n    ended_high={shorten(self.ended_high, WIDE)})"
        )

    def plot(self, axes: Axes | None = None, **look: plots.Look) -> Axes:
        """Draw the approach speed [mm/s] of the orbits against the excess, or the parameter of a path.

        Stable orbits are solid and unstable ones dashed.  Orbits that are not admissible are pale dots: they
        pass through the stop between their impacts.  Marks name the events.  The axes extend to twice the
        excess of the farthest event, and leave out very slow impacts; `set_xlim` and `set_ylim` show more.
        It draws on `axes` of matplotlib, or makes a figure, and returns the axes; `look` are properties of
        the lines.
        """
        places = self.parameters or [orbit.excess for orbit in self.orbits]
        flags = [(orbit.stable, orbit.admissible) for orbit in self.orbits]
        line = np.column_stack([places, [math.log(orbit.speed) for orbit in self.orbits]])
        marks = [
            (event.kind, np.array([event.parameter, math.log(event.orbit.speed)])) for event in self.events
        ]
        for _, mark in marks:  # between the two orbits where it makes the least detour
            to, on = (
                np.linalg.norm(difference, axis=1) for difference in (line - mark, np.diff(line, axis=0))
            )
            after = 1 + int(np.argmin(to[:-1] + to[1:] - on)) if len(on) else 0
            line, flags = np.insert(line, after, mark, axis=0), [*flags[:after], flags[after], *flags[after:]]
        empty = axes is None or not axes.has_data()
        axes = plots.branch(axes, line[:, 0], 1e3 * np.exp(line[:, 1]), *zip(*flags, strict=True), **look)
        for kind, (place, log_speed) in marks:
            at = place, 1e3 * math.exp(log_speed)
            axes.plot(*at, "o", color="black", markersize=3.5)
            axes.annotate(kind, at, (4.0, -8.0), textcoords="offset points", annotation_clip=True)
        if empty:
            axes.set(yscale="log", ylabel="approach speed (mm/s)", xlabel="excess $F/F_g - 1$")
            if self.parameters:
                axes.set_xlabel("parameter of the path")
            elif marks:
                far = 2.0 * max(abs(place) for _, (place, _) in marks)
                fastest = 1e3 * math.exp(max(line[line[:, 0] <= far, 1]))
                axes.set(xlim=(min(1.1 * min(places), 0.0), far), ylim=(SLOW * fastest, 1.5 * fastest))
        return axes

    def of_kind(self, kind: str) -> list[PeriodicOrbit]:
        """The orbits at the events of one kind."""
        return [event.orbit for event in self.events if event.kind == kind]


class Leg(NamedTuple):
    """The way to the next point of a branch: the points after the last one, and the events on the way.

    `ended` says on the last leg why the branch ends.
    """

    points: list[CurvePoint]
    events: list[Event]
    ended: str


def walk(curve: Curve, first: CurvePoint, longest: float, stride: float) -> Iterator[Leg]:
    """The branch from `first` along its direction, leg by leg.

    Steps of arc length grow from `stride` to `longest` times the factor ``curve.stretch``.
    """
    here = looked = first  # events have been looked for up to `looked`
    edges, step, firsts = list[CurvePoint](), stride, list[CurvePoint]()
    if first.x[-1] == curve.ends[1 if first.direction[-1] > 0.0 else 0]:
        yield Leg([], [], "range")
        return
    for count in range(MOST_STEPS):
        if curve.late():
            yield Leg([], [], LATE)
            return
        there = curve.next_point(here, step, here.orbit.impacts)
        if isinstance(there, str) and step > SMALLEST:
            step *= 0.5
            continue
        if isinstance(there, str):
            leg = _leg_to_edge(curve, looked, here, there)
            if curve.late():
                continue
            yield leg
            if leg.ended:
                return
            here = looked = leg.points[-1]
            edges, step = [here], SMALLEST
            continue
        if not firsts:
            started = (curve.with_first_touch(first, touch) for touch in range(first.orbit.impacts))
            firsts = [point for point in started if point is not None]
        closing = _closing(firsts, here, there) if count > 3 else None
        if closing is not None and closing.direction @ there.direction < 0.0:
            yield Leg([], [], "the branch comes back the other way: a step was too long")
            return
        there = closing or there
        ended = "closed" if closing else "range" if there.last else ""
        if ended or np.linalg.norm(there.x - looked.x) > CLOSE:
            leg = _leg_between(curve, looked, there, [*edges, there] if there.last else edges)
            if curve.late():
                continue
            edges, looked, ended = [], there, leg.ended or ended
            yield leg._replace(ended=ended)
        if ended:
            return
        here, step = there, min(1.5 * step, longest * curve.step_factor(there.x))
    yield Leg([], [], f"the bound of {MOST_STEPS} steps is used up")


def _leg_between(curve: Curve, a: CurvePoint, b: CurvePoint, edges: list[CurvePoint]) -> Leg:
    """The leg from `a` to its neighbour `b`.

    It ends at a branch point if the orbits behind it are those before it, some drive periods later.
    """
    try:
        points = [*refined(curve, a, b), b]
    except ContactError:
        points = [a, b]
    found = [event for c, d in pairwise(points) for event in events_between(curve, c, d)]
    events = with_undecided(found, edges)
    for i, event in enumerate(events):
        if event.kind == "branch point" and event.orbit.repeats(NEARLY) > a.orbit.repeats():
            return Leg([], events[: i + 1], SHORTER)
    return Leg(points[1:], events, "")


def _leg_to_edge(curve: Curve, looked: CurvePoint, here: CurvePoint, why: str) -> Leg:
    """The leg from `looked` to `here`, the last point before a graze, or before the branch is lost."""
    points = [here] if here is not looked else []
    if why == CROSSING:
        return Leg(points, [event_at(curve, "branch point", here)], SHORTER)
    events = with_undecided(events_between(curve, looked, here) if points else [], [here])
    beyond = _with_other_touches(curve, here)
    if beyond is None and not grazes(here.orbit):
        return Leg(points, events, why)
    events.append(event_at(curve, "grazing", here))
    if beyond is None:
        return Leg(points, events, f"one of {here.orbit.impacts} touches is a graze")
    return Leg([*points, beyond], events, "")


def branch_of(
    curve: Curve, first: CurvePoint, longest: float, stride: float
) -> tuple[Branch, list[CurvePoint]]:
    """The branch through `first` and its points; the side along the direction of `first` comes last."""
    sides = list[Leg]()
    for start in (first.oriented(-first.direction), first):
        if sides and sides[0].ended == "closed":
            sides.append(Leg([], [], "closed"))
            break
        legs = list(walk(curve, start, longest, stride))
        events = with_undecided([event for leg in legs for event in leg.events], [])
        sides.append(Leg([point for leg in legs for point in leg.points], events, legs[-1].ended))
    before, after = sides
    points = [*before.points[::-1], first, *after.points]
    pairs = zip(before.events[:1], after.events[:1], strict=False)  # an event at `first` is found from both
    twice = sum(a.kind == b.kind and bool(np.linalg.norm(a.x - b.x) < CLOSE) for a, b in pairs)
    return Branch(
        orbits=tuple(point.orbit for point in points),
        events=(*before.events[::-1], *after.events[twice:]),
        ended_low=before.ended,
        ended_high=after.ended,
    ), points


def _with_other_touches(curve: Curve, here: CurvePoint) -> CurvePoint | None:
    """The first point beyond a grazing orbit, with a touch more or less; None if there is none.

    It starts from the fastest touch, since the slowest one is about to be lost.
    """
    if not curve.admissible_only:
        return None
    here = curve.with_first_touch(here, int(np.argmax(here.orbit.approach))) or here
    for impacts in (here.orbit.impacts + 1, here.orbit.impacts - 1):
        for length in ACROSS if impacts else ():
            there = curve.next_point(here, length, impacts)
            if isinstance(there, CurvePoint):
                return there
    return None


def _closing(firsts: Sequence[CurvePoint], a: CurvePoint, b: CurvePoint) -> CurvePoint | None:
    """The first point of the curve, if the curve passes it between neighbours a and b in either direction.

    `firsts` holds that point, started from each of its touches.
    """
    chord = b.x - a.x
    for first in firsts:
        way = first.x - a.x
        part, straight = way @ chord / (chord @ chord), abs(first.direction @ b.direction) > 0.5
        if straight and first.orbit.impacts == b.orbit.impacts and 0.0 < part <= 1.0:
            if np.linalg.norm(way - part * chord) < BEND * np.linalg.norm(chord):
                return first
    return None
