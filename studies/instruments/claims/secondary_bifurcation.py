"""The secondary bifurcation of p_m, of Eq. (1) and of the map: second impact or flip above the fold.

At time s after its impact the tip of an orbit with approach speed v is at

    x - gap = v G(s) - gap (1 - cos w s),   G = h - s_0 cos w s + b sin w s,

(s_0, b) the arms of the family, h the free motion per unit speed: linear in v.  Hence the first orbit with a
second impact has v_2 = min over G > 0 of gap (1 - cos w s)/G(s).  The trace of its multipliers is p + q/v, so
that the flip (multiplier -1) has v = -q/(1 + D + p), D their determinant; the secondary bifurcation is the
one that comes first above the fold.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from contact.maximal_orbits import fold, stable_range
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily

__all__ = ["Secondary", "flip_speed", "second_impact_speed", "secondary", "secondary_of_map"]


def second_impact_speed(family: MaximalFamily, points: int = 2000) -> float:
    """v_2 [m/s] of a family of one mode, infinity if there is none (`points` for each drive period)."""
    duration, w = family.period / family.drive_frequency, family.angular_frequency
    half, damped = (
        0.5 * float(family.decay_rate[0]),
        math.sqrt(float(family.omega[0]) ** 2 - (0.5 * float(family.decay_rate[0])) ** 2),
    )
    height, rate = (float(row[0]) * float(family.phi[0]) for row in family.deviations[1])
    s0, b = family.arms

    def ratio(s: Any) -> Any:
        decay = np.exp(-half * s)
        free = decay * (height * np.cos(damped * s) + (rate + half * height) / damped * np.sin(damped * s))
        reach = free - s0 * np.cos(w * s) + b * np.sin(w * s)
        return np.where(
            reach > 0.0, family.gap * (1.0 - np.cos(w * s)) / np.where(reach > 0.0, reach, 1.0), np.inf
        )

    # the ends are the impact itself, where both sides vanish and rounding decides
    times = np.linspace(0.0, duration, points * family.period + 1)[1:-1]
    values = ratio(times)
    i = int(np.argmin(values))
    if not np.isfinite(values[i]):
        return math.inf
    if 0 < i < times.size - 1:
        best = minimize_scalar(
            lambda s: float(ratio(s)),
            bounds=(times[i - 1], times[i + 1]),
            method="bounded",
            options={"xatol": 1e-12 * duration},
        )
        return min(float(best.fun), float(values[i]))
    return float(values[i])


def flip_speed(family: MaximalFamily) -> float:
    """Approach speed [m/s] of the multiplier -1 of a family of one mode, infinity if there is none."""
    speeds = (1e-3 * family.gap * family.angular_frequency, family.gap * family.angular_frequency)
    first, second = (float(np.trace(family.orbit(v).monodromy())) for v in speeds)
    q = (first - second) / (1.0 / speeds[0] - 1.0 / speeds[1])
    p = second - q / speeds[1]
    size = 1.0 + float(np.linalg.det(family.orbit(speeds[1]).monodromy())) + p
    v = -q / size if size != 0.0 else math.inf
    return v if v > 0.0 else math.inf


@dataclass(frozen=True, kw_only=True)
class Secondary:
    """The first bifurcation of the node p_m above its fold: excesses of both; `admissible`: the fold."""

    fold: float
    excess: float
    kind: str
    admissible: bool


def secondary(family: MaximalFamily) -> Secondary | None:
    """Of Eq. (1); None where there is no fold."""
    s, b = family.arms
    if not s > 0.0:
        return None
    least = s * family.gap / (s * s + b * b)
    second, flip = second_impact_speed(family), flip_speed(family)
    flip = flip if flip > least else math.inf
    first = min(second, flip)
    return Secondary(
        fold=family.excess(least),
        excess=family.excess(first) if math.isfinite(first) else math.inf,
        kind="second impact" if second <= flip else "flip",
        admissible=second > least,
    )


def secondary_of_map(nordmark: NordmarkMap, period: int) -> Secondary | None:
    """Of the map."""
    end, stable = fold(nordmark, period), stable_range(nordmark, period)
    if end is None or stable is None:
        return None
    high = stable[1]
    return Secondary(
        fold=nordmark.excess(end.rho),
        excess=nordmark.excess(high) if math.isfinite(high) else math.inf,
        kind="second impact",
        admissible=end.admissible,
    )
