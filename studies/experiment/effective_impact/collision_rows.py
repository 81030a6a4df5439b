"""The row of an approach, and what is read off the rows of a curve.

A first collision is that of the steady driven motion; one of a settled orbit is its first. Beside what
`contact.collisions` measures a row holds

    arc_s          v/a, the time in which the arc of the single mode beyond the gap reaches its top [s]
    ball_limit     2 M phi_1^2, the kick of the ball by itself on a hard stop [1]
    energy_share   energy given to the higher modes over that of the approach, v^2/(2 phi_1^2) [1]

Between the cases of a curve restitution has a corner where the kick is 1, its square has none: smallest
values over the tip mass are read off monotone splines through the kick and through
restitution^2 - (1 - kick)^2 = 2 a shift/v^2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

FINE = 2001
"""Points at which a spline is looked through: the smallest value is good to 1e-6 of itself."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One approach; what does not exist is not a number.

    `orbit_period` is None for a first collision and 0 where the motion did not settle: then there are no
    numbers.
    """

    curve: str
    series: str
    value: float
    excess: float
    modes: int
    mass_ratio: float
    orbit_period: int | None = None
    approach_m_s: float = math.nan
    restitution: float = math.nan
    delay_s: float = math.nan
    kick: float = math.nan
    shift_m: float = math.nan
    contact_s: float = math.nan
    arc_s: float = math.nan
    ball_limit: float
    energy_share: float = math.nan
    impacts: int = 0
    forced_by_ringing: bool = False
    returns: bool = False


def select(rows: Sequence[Row], curve: str, series: str | None = None) -> list[Row]:
    """The rows of a curve, or of one of its series, by rising value."""
    chosen = [row for row in rows if row.curve == curve and series in (None, row.series)]
    return sorted(chosen, key=lambda row: row.value)


def series_of(rows: Sequence[Row], curve: str) -> list[str]:
    """The series of a curve, in their order."""
    return list(dict.fromkeys(row.series for row in rows if row.curve == curve))


def on_orbits(rows: Sequence[Row]) -> list[Row]:
    """The collisions on settled orbits that belong to a peak of mode 1."""
    return [row for row in select(rows, "orbit") if row.impacts and not row.forced_by_ringing]


def crossing(x: Sequence[float], y: Sequence[float], level: float) -> float:
    """The first x at which y(x) goes through `level`, by a monotone spline in log x; NaN if it never does."""
    if len(x) < 2:
        return math.nan
    roots = PchipInterpolator(np.log(x), np.array(y) - level).roots(extrapolate=False)
    return math.exp(roots[0]) if roots.size else math.nan


@dataclass(frozen=True, kw_only=True)
class Floor:
    """The smallest restitution over the tip mass, for one local restitution."""

    local_restitution: float
    restitution: float
    mass_ratio: float
    kick: float


def floor_of(rows: Sequence[Row]) -> Floor | None:
    """The floor of one series over tip mass; None with fewer than three collisions of one impact, and if
    restitution falls up to the end of the range."""
    kept = [row for row in rows if row.impacts == 1 and row.mass_ratio > 0.0]
    kept = [row for row in kept if math.isfinite(row.restitution)]
    if len(kept) < 3:
        return None
    where = np.log([row.mass_ratio for row in kept])
    kick = PchipInterpolator(where, [row.kick for row in kept])
    rest = PchipInterpolator(where, [row.restitution**2 - (1.0 - row.kick) ** 2 for row in kept])
    fine = np.linspace(where[0], where[-1], FINE)
    square = np.maximum((1.0 - kick(fine)) ** 2 + rest(fine), 0.0)
    least = int(np.argmin(square))
    if least in (0, FINE - 1):
        return None
    return Floor(
        local_restitution=float(kept[0].series),
        restitution=math.sqrt(square[least]),
        mass_ratio=math.exp(fine[least]),
        kick=float(kick(fine[least])),
    )
