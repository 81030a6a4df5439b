"""Events on a curve of periodic orbits, between two of its points.

A number changes sign at each kind of event.  Its zero is located by Brent's method, which bisects where the
number is only a sign:

    fold              derivative of the parameter with the arc length: two orbits, one stable, meet
    period doubling   det(M + I): a multiplier passes -1
    torus             sign of prod (1 - m_i m_j), i < j: a complex pair of multipliers passes the unit circle
                      (Neimark-Sacker); two real ones with m_i m_j = 1 are no event
    branch point      determinant of the equations with the direction (``contact.orbits.branches.curve``):
                      two curves cross, as where an orbit of 2m periods runs through one of m
    grazing           +1 or -1: the tip gains or loses a touch of the stop (certified flights)

`Event` says when an event is called "undecided".
"""

from collections.abc import Callable, Sequence
from dataclasses import field, replace

import numpy as np

from beam.parameters import Array, record
from contact.errors import ContactError
from contact.flight.elementary import EPS
from contact.orbits.branches.curve import Curve, why_no_neighbours
from contact.orbits.families.newton import CurvePoint
from contact.orbits.families.touch_orbit import NEARLY, PeriodicOrbit

PLACE = 1e-12  # part of a step to which an event is located; a fold is exact to the square of it

CLOSE = 1e-6
"""Arc length below which two events, an event and a graze, or an event and the end of the range are not
distinguished; and largest error of the multiplier that identifies an event."""

ASIDE = 10.0 * CLOSE  # arc length left out on both sides of a branch point: there the equations are singular

PROBE, MOST_PROBES = 0.25, 4
"""A point is computed where the rate is expected below this part of the rates of both neighbours.  A first
probe and three halvings distinguish folds closer than a hundredth of a step."""

MOST_HALVINGS, MIDDLES = 12, (0.5, 0.4, 0.6)
"""Bound of halvings of a step with an uncertain event; and parts of a step that are tried as its middle."""

LEAST_TORUS = 1e-12  # the sign of a smaller test of a torus is rounding: without damping, some m_i m_j is 1


@record
class Event:
    """A point on a branch at which its orbits change, such as a fold.

    The kind "undecided" marks a place where an event is likely, but could not be identified.  There are five
    reasons:

    - No orbit is found at the event; then `orbit` is the one before.
    - The orbit is not on the curve of its neighbours.
    - The orbit has no multiplier within 1e-6 of its place at such an event.
    - Another event, or the end of the range, is closer than 1e-6 of arc length.
    - The change in the number of multipliers outside the unit circle does not match the events found.

    Period doublings and tori are not looked for where the largest multiplier exceeds about 1e8: rounding then
    hides the multipliers near the unit circle.

    Parameters
    ----------
    kind : str
        Kind of the event: "fold", "period doubling", "torus", "branch point", "grazing" or "undecided".
    orbit : PeriodicOrbit
        The orbit at the event.
    parameter : float or None
        The excess at the event [1], or its place on the path of `follow_path`; None if it is not known.
    x : ndarray, optional
        The unknowns of the curve at the event (``contact.orbits.branches.curve``).
    """

    kind: str
    orbit: PeriodicOrbit
    parameter: float | None = None
    x: Array = field(default_factory=lambda: np.empty(0), repr=False)


def event_at(curve: Curve, kind: str, point: CurvePoint) -> Event:
    """The event of this kind at a point of a curve."""
    return Event(kind=kind, orbit=point.orbit, parameter=curve.parameter(point), x=point.x)


def torus(orbit: PeriodicOrbit) -> float:
    """The least |1 - m_i m_j| with the sign of the product over all pairs of multipliers.

    The product itself is as small as rounding if there are many modes.
    """
    i, j = np.triu_indices(orbit.multipliers.size, 1)
    factors = 1.0 - orbit.multipliers[i] * orbit.multipliers[j]
    sizes = np.abs(factors)
    if not sizes.min(initial=1.0) > LEAST_TORUS:
        return 0.0
    return float(sizes.min(initial=1.0) * np.prod(factors / sizes).real)


def is_torus(orbit: PeriodicOrbit) -> bool:
    """Whether the pair of multipliers whose product is nearest to 1 is a complex one."""
    m = orbit.multipliers
    i, j = np.triu_indices(m.size, 1)
    return bool(m[i[np.argmin(np.abs(1.0 - m[i] * m[j]))]].imag)


TESTS: dict[str, Callable[[CurvePoint], float]] = {
    "branch point": lambda point: point.determinant,
    "fold": lambda point: point.rate,
    "period doubling": lambda point: float(np.prod(point.orbit.multipliers + 1.0).real),
    "torus": lambda point: torus(point.orbit),
    "grazing": lambda point: 1.0 if point.orbit.admissible else -1.0,
}
"""The number that changes sign at each kind of event."""

OFF: dict[str, Callable[[np.ndarray], float]] = {
    "branch point": lambda m: float(np.min(np.abs(m - 1.0))),
    "fold": lambda m: float(np.min(np.abs(m - 1.0))),
    "period doubling": lambda m: float(np.min(np.abs(m + 1.0))),
    "torus": lambda m: float(np.min(np.abs(np.abs(m[m.imag != 0.0]) ** 2 - 1.0), initial=np.inf)),
    "grazing": lambda m: 0.0,
}
"""Distance of the nearest multiplier from its place at each kind of event."""


def rounded(orbit: PeriodicOrbit) -> bool:
    """Whether the multipliers near the unit circle are not known to `CLOSE`, next to such large ones."""
    return bool(orbit.multipliers.size * EPS * abs(orbit.multipliers[0]) > CLOSE)


def accounted(a: CurvePoint, b: CurvePoint, events: Sequence[Event]) -> bool:
    """Whether the number of multipliers outside the unit circle changes as the events from a to b say.

    It changes by two at a torus, by one at other events, and not at a graze, where the curve keeps its
    touches.  A multiplier within `CLOSE` of the circle may lie on either side of it.
    """
    if rounded(a.orbit) or rounded(b.orbit):
        return True
    before, after = (np.abs(point.orbit.multipliers) for point in (a, b))
    least = int(np.sum(after > 1.0 + CLOSE)) - int(np.sum(before > 1.0 - CLOSE))
    most = int(np.sum(after > 1.0 - CLOSE)) - int(np.sum(before > 1.0 + CLOSE))
    changes = sum({"grazing": 0, "torus": 2}.get(event.kind, 1) for event in events)
    undecided = any(event.kind == "undecided" for event in events)
    return undecided or any(least <= change <= most for change in range(-changes, changes + 1, 2))


def passes(here: float, there: float) -> bool:
    """Whether a number is zero here or between here and there; at a fold the rate can be zero here."""
    return (here == 0.0 and there != 0.0) or here * there < 0.0


class Arc:
    """The points of a curve between two neighbours, each given by its part of the chord."""

    def __init__(self, curve: Curve, a: CurvePoint, b: CurvePoint) -> None:
        self.curve, self.a, self.chord = curve, a, b.x - a.x
        self.length = float(np.linalg.norm(self.chord))
        self.seen = {0.0: a, 1.0: b}

    def __call__(self, part: float) -> CurvePoint:
        """The point of the curve in the plane across the chord at this part of it."""
        if part not in self.seen:
            normal = self.chord / self.length
            near = min(self.seen, key=lambda other: abs(other - part))
            guess = self.seen[near].x + (part - near) * self.chord
            self.seen[part] = self.curve.solve(guess, normal, self.a.orbit.impacts).oriented(normal)
        return self.seen[part]

    def root(self, test: Callable[[CurvePoint], float], place: float = PLACE) -> CurvePoint:
        """The point where `test` changes sign.

        For a test that is only a sign, return the last point on the +1 side.
        """
        from scipy.optimize import brentq  # slow to import

        root = float(brentq(lambda part: test(self(part)), 0.0, 1.0, xtol=place))
        self(root)
        kept = (part for part in self.seen if test(self.seen[part]) != -1.0)
        return self.seen[min(kept, key=lambda part: abs(part - root))]

    def middle(self) -> CurvePoint | None:
        """A point near the middle on the same curve, if there is one."""
        for part in MIDDLES:
            try:
                if self.on_curve(self(part)):
                    return self(part)
            except ContactError:
                continue
        return None

    def on_curve(self, point: CurvePoint) -> bool:
        """Whether both ends and a point between them are neighbours on one curve."""
        return not why_no_neighbours(self.a, point) and not why_no_neighbours(point, self.seen[1.0])


def refined(curve: Curve, a: CurvePoint, b: CurvePoint, depth: int = 0) -> list[CurvePoint]:
    """The point `a`, and points between it and its neighbour `b` that separate two folds in between.

    A cubic through the parameters and rates of both shows where the rate is least.  If it comes near zero
    there, that point is computed.
    """
    between = Arc(curve, a, b)
    first, last = a.rate * between.length, b.rate * between.length
    rise = curve.parameter(b) - curve.parameter(a)
    bend = first + last - 2.0 * rise
    if depth == MOST_PROBES or first * last <= 0.0 or bend == 0.0:
        return [a]
    # rate(t) = first + (6 rise - 4 first - 2 last) t + 3 bend t^2, t from 0 at a to 1 at b
    t = (2.0 * first + last - 3.0 * rise) / (3.0 * bend)
    least = first + t * (6.0 * rise - 4.0 * first - 2.0 * last) + 3.0 * t * t * bend
    if not 0.0 < t < 1.0 or least * np.sign(first) > PROBE * min(abs(first), abs(last)):
        return [a]
    middle = between(t)
    if not between.on_curve(middle):
        return [a]
    return [*refined(curve, a, middle, depth + 1), *refined(curve, middle, b, depth + 1)]


def events_between(curve: Curve, a: CurvePoint, b: CurvePoint, depth: int = 0) -> list[Event]:
    """The events from `a`, itself included, to its neighbour `b`, in their order along the curve.

    If an event is not sound, or if the multipliers change otherwise than the events say, both halves of the
    way are searched.  A curve with `admissible_only` has its grazes where it ends.
    """
    between, found, middle = Arc(curve, a, b), list[Event](), None
    divisible = depth < MOST_HALVINGS and between.length > ASIDE
    for tested, test in TESTS.items():
        kind = tested
        if kind in ("period doubling", "torus") and (rounded(a.orbit) or rounded(b.orbit)):
            continue
        if (kind == "grazing" and curve.admissible_only) or not passes(test(a), test(b)):
            continue
        try:
            point = between.root(test, PLACE if kind != "branch point" else 0.1 * CLOSE / between.length)
            if kind == "torus" and not is_torus(point.orbit):
                continue
            if kind == "fold" and point.orbit.repeats(NEARLY) > a.orbit.repeats():
                kind = "branch point"
            if kind == "branch point" and OFF[kind](point.orbit.multipliers) < CLOSE:
                return _around_branch_point(between, point)
            sound = between.on_curve(point) and OFF[kind](point.orbit.multipliers) < CLOSE
        except ContactError:
            point, sound = a, False
        middle = between.middle() if divisible and not sound else None
        if middle is not None:
            break
        found.append(event_at(curve, kind if sound else "undecided", point))
    missing = middle is None and not accounted(a, b, found)
    middle = between.middle() if divisible and missing else middle
    if middle is not None:
        halves = ((a, middle), (middle, b))
        return [event for c, d in halves for event in events_between(curve, c, d, depth + 1)]
    if missing:
        found.append(event_at(curve, "undecided", a))
    return sorted(found, key=lambda event: float(np.linalg.norm(event.x - a.x)))


def _around_branch_point(between: Arc, point: CurvePoint) -> list[Event]:
    """A branch point, and the events before and behind it."""
    at = float((point.x - between.a.x) @ between.chord) / between.length**2
    aside, b = ASIDE / between.length, between.seen[1.0]
    before = events_between(between.curve, between.a, between(at - aside)) if at > aside else []
    behind = events_between(between.curve, between(at + aside), b) if at + aside < 1.0 else []
    return [*before, event_at(between.curve, "branch point", point), *behind]


def with_undecided(found: list[Event], edges: list[CurvePoint]) -> list[Event]:
    """The events, "undecided" where one lies next to another one or to an edge; a graze stays a graze.

    Events next to a branch point, where the equations are singular, are left out.
    """

    def near(event: Event, others: Sequence[Event | CurvePoint], distance: float) -> bool:
        return any(np.linalg.norm(other.x - event.x) < distance for other in others)

    crossings = [event for event in found if event.kind == "branch point"]
    kept = [event for event in found if event in crossings or not near(event, crossings, 2.0 * ASIDE)]
    marked = list[Event]()
    for event in kept:
        others: list[Event | CurvePoint] = [*edges, *(other for other in kept if other is not event)]
        alone = event.kind == "grazing" or not near(event, others, CLOSE)
        marked.append(event if alone else replace(event, kind="undecided"))
    return marked
