"""Points on a branch of periodic orbits: what happens between two neighbouring orbits of it.

Between neighbours, told apart by the approach velocity v of their first touch, a number changes sign; its
zero is located by Brent's method on log v, which bisects where the number is a mere sign:

    fold              dZ/dv: two orbits, one stable, meet
    period doubling   det(M + I): a multiplier passes -1
    torus             sign of prod (1 - m_i m_j), i < j: a complex pair of multipliers passes the unit circle
                      (Neimark-Sacker); two real ones with m_i m_j = 1 are no event
    grazing           +1 or -1: the orbit gains or loses a touch of the stop (certified flights)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.orbits.periodic_orbit import Followed, PeriodicOrbit

__all__ = ["Branch", "Event", "events_between", "locate", "passes", "probed"]

PLACE = 1e-12
"""Accuracy of log v at a located point; the excess there is good to the square of it at a fold."""

PROBE, MOST_PROBES = 0.25, 4
"""An orbit is computed where the slope is expected below this part of that of both neighbours: a first probe
and three halvings tell apart folds closer than a hundredth of a step."""


LEAST = {"torus": 1e-12, "turn": 1e-6}
"""Size of a test below which its sign is rounding: without damping, where some m_i m_j is 1, and next to a
graze, where the parameter of a path hardly changes along the curve."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Event:
    """A point on a branch: "fold", "period doubling", "torus" or "grazing", and `parameter`, where it lies on
    a path (``contact.orbits.path``)."""

    kind: str
    orbit: PeriodicOrbit
    parameter: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch:
    """A branch of periodic orbits in the order of the approach velocity, or along a path.

    Parameters
    ----------
    orbits : tuple of PeriodicOrbit
    events : tuple of Event
    ended_low, ended_high : str
        Why the branch ends there: "range", or the sentence of the failure; on a path also "closed".
    parameters : tuple of float
        Where the orbits lie on a path (``contact.orbits.path``); empty for other branches.
    """

    orbits: tuple[PeriodicOrbit, ...]
    events: tuple[Event, ...]
    ended_low: str
    ended_high: str
    parameters: tuple[float, ...] = ()

    def of_kind(self, kind: str) -> list[PeriodicOrbit]:
        """The orbits at the events of one kind."""
        return [event.orbit for event in self.events if event.kind == kind]


def torus(orbit: PeriodicOrbit) -> float:
    """The least |1 - m_i m_j| with the sign of the product over all pairs of multipliers: the product itself
    of many modes is as small as rounding."""
    i, j = np.triu_indices(orbit.multipliers.size, 1)
    factors = 1.0 - orbit.multipliers[i] * orbit.multipliers[j]
    sizes = np.abs(factors)
    return float(sizes.min() * np.prod(factors / sizes).real) if sizes.min() > 0.0 else 0.0


def is_torus(orbit: PeriodicOrbit) -> bool:
    """Whether the pair of multipliers whose product is nearest to 1 is a complex one."""
    m = orbit.multipliers
    i, j = np.triu_indices(m.size, 1)
    return bool(m[i[np.argmin(np.abs(1.0 - m[i] * m[j]))]].imag)


TESTS: dict[str, Callable[[PeriodicOrbit], float]] = {
    "fold": lambda orbit: orbit.slope,
    "period doubling": lambda orbit: float(np.prod(orbit.multipliers + 1.0).real),
    "torus": torus,
    "grazing": lambda orbit: 1.0 if orbit.admissible else -1.0,
}
"""What changes sign at each kind of event."""


def passes(here: float, there: float, kind: str = "") -> bool:
    """Whether a number is zero here, as the slope of a fold that a branch starts from, or between here and
    there."""
    least = LEAST.get(kind, 0.0)
    return (here == 0.0 and not least) or (here * there < 0.0 and min(abs(here), abs(there)) >= least)


def locate(
    family: Followed, a: PeriodicOrbit, b: PeriodicOrbit, test: Callable[[PeriodicOrbit], float]
) -> PeriodicOrbit:
    """The orbit between neighbours a and b where `test` changes sign; of a sign, the last where it is +1."""
    from scipy.optimize import brentq  # slow to import

    seen = {math.log(a.speed): a, math.log(b.speed): b}

    def value(x: float) -> float:
        if x not in seen:
            near = min(seen.values(), key=lambda orbit: abs(math.log(orbit.speed) - x))
            seen[x] = family.at_speed(math.exp(x), near)
        return test(seen[x])

    root = brentq(value, *seen, xtol=PLACE, rtol=1e-14)
    value(root)
    return seen[min((x for x in seen if test(seen[x]) != -1.0), key=lambda x: abs(x - root))]


def probed(family: Followed, a: PeriodicOrbit, b: PeriodicOrbit, depth: int = 0) -> list[PeriodicOrbit]:
    """`a`, and the orbits between it and its neighbour `b` that tell apart two folds in between.

    The cubic in log v with the amplitudes and slopes of both says where the slope is least; if it comes near
    zero there, that orbit is computed.
    """
    x = math.log(b.speed / a.speed)
    first, last, rise = a.slope * a.speed * x, b.slope * b.speed * x, b.excess - a.excess
    bend = first + last - 2.0 * rise
    if depth == MOST_PROBES or first * last <= 0.0 or bend == 0.0:
        return [a]
    # slope(t) = first + (6 rise - 4 first - 2 last) t + 3 bend t^2, t from 0 at a to 1 at b
    t = (2.0 * first + last - 3.0 * rise) / (3.0 * bend)
    least = first + t * (6.0 * rise - 4.0 * first - 2.0 * last) + 3.0 * t * t * bend
    if not 0.0 < t < 1.0 or least * math.copysign(1.0, first) > PROBE * min(abs(first), abs(last)):
        return [a]
    middle = family.at_speed(a.speed * math.exp(t * x), a)
    return [*probed(family, a, middle, depth + 1), *probed(family, middle, b, depth + 1)]


def events_between(family: Followed, a: PeriodicOrbit, b: PeriodicOrbit) -> list[Event]:
    """What happens from `a`, itself included, to its neighbour `b`, in the order in which it is met."""
    found = [
        Event(kind=kind, orbit=locate(family, a, b, test))
        for kind, test in TESTS.items()
        if passes(test(a), test(b), kind)
    ]
    found = [event for event in found if event.kind != "torus" or is_torus(event.orbit)]
    return sorted(found, key=lambda event: abs(math.log(event.orbit.speed / a.speed)))
