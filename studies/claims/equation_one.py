"""Eq. (1) at any frequency and restitution: its Nordmark map, its p_m orbits and their first bifurcation.

The free period T and the decay rate mu fix the map (Eqs. (2), (3)) at a drive frequency, with it the band m,
and the family of p_m orbits of Eq. (1) itself. At time s after its impact the tip of an orbit with approach
speed v is at

    x - gap = v G(s) - gap (1 - cos w s),   G = h - s_0 cos w s + b sin w s,

(s_0, b) the arms of the family, h the free motion per unit speed: linear in v. Hence the first orbit with a
second impact has v_2 = min over G > 0 of gap (1 - cos w s)/G(s). The trace of its multipliers is p + q/v, so
that the flip (multiplier -1) has v = -q/(1 + D + p), D their determinant. The secondary bifurcation of the
node p_m is the one of the two that comes first above its fold.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from contact import MaximalFamily, NordmarkMap, fold, stable_range
from studies.scene import Scene, single_mode_at

__all__ = ["RESTITUTIONS", "Secondary", "falls", "family_at", "flip_speed", "map_at", "second_impact_speed",
           "secondary_of", "secondary_of_map"]  # fmt: skip

RESTITUTIONS = tuple(np.round(np.linspace(0.0, 0.9, 19), 3).tolist())
"""tau of the claims on loss."""

ROUNDING = 1e-12
"""Change of an excess that is rounding."""

SEARCHED = 2000
"""Times of a drive period at which a second impact is looked for; G turns a few times in one."""


def falls(values: Sequence[float]) -> bool:
    """Whether no value exceeds the one before it by more than rounding; a NaN does not fall."""
    return bool(np.all(np.diff(values) <= ROUNDING))


def map_at(scene: Scene, frequency: float, restitution: float) -> NordmarkMap:
    """The Nordmark map of the scene's mode at a drive frequency [Hz]."""
    return NordmarkMap.from_frequencies(
        drive_frequency=frequency, free_period=scene.single_mode.free_period_s,
        decay_rate=scene.single_mode.decay_rate_per_s, restitution=restitution,
    )  # fmt: skip


def family_at(scene: Scene, frequency: float, restitution: float, period: int) -> MaximalFamily:
    """The orbits p_m of Eq. (1), m = `period`, at a drive frequency [Hz]."""
    return MaximalFamily.from_oscillator(
        single_mode_at(scene, frequency), period=period, restitution=restitution
    )


def second_impact_speed(family: MaximalFamily) -> float:
    """v_2 [m/s] of a family of one mode, infinity if there is none."""
    model, gap = family.oscillator.model, family.oscillator.stop.gap
    duration, w = family.period * family.oscillator.period, family.oscillator.driven.angular_frequency
    half = 0.5 * float(model.decay_rate[0])
    damped = math.sqrt(float(model.omega[0]) ** 2 - half**2)
    height, rate = (float(entry) * float(model.phi[0]) for entry in family.orbit(1.0).after[0])
    s0, b = family.arms

    def ratio(s: NDArray[np.float64]) -> NDArray[np.float64]:
        free = height * np.cos(damped * s) + (rate + half * height) / damped * np.sin(damped * s)
        reach = np.exp(-half * s) * free - s0 * np.cos(w * s) + b * np.sin(w * s)
        held = gap * (1.0 - np.cos(w * s))
        return np.where(reach > 0.0, held / np.where(reach > 0.0, reach, 1.0), np.inf)

    # the ends are the impact itself, where both sides vanish and rounding decides
    times = np.linspace(0.0, duration, SEARCHED * family.period + 1)[1:-1]
    values = ratio(times)
    i = int(np.argmin(values))
    least = float(values[i])
    if not math.isfinite(least) or not 0 < i < times.size - 1:
        return least
    best = minimize_scalar(
        lambda s: float(ratio(np.asarray(s))), bounds=(times[i - 1], times[i + 1]), method="bounded",
        options={"xatol": 1e-12 * duration},
    )  # fmt: skip
    return min(float(best.fun), least)


def flip_speed(family: MaximalFamily) -> float:
    """Approach speed [m/s] of the multiplier -1 of a family of one mode, infinity if there is none."""
    unit = family.oscillator.unit_speed
    slow, fast = (family.orbit(v).monodromy() for v in (1e-3 * unit, unit))
    q = float(np.trace(slow) - np.trace(fast)) * unit / 999.0
    size = 1.0 + float(np.linalg.det(fast)) + float(np.trace(fast)) - q / unit
    speed = -q / size if size != 0.0 else math.inf
    return speed if speed > 0.0 else math.inf


@dataclass(frozen=True, kw_only=True)
class Secondary:
    """The first bifurcation of the node p_m above its fold.

    `fold`, `excess`: F/F_g - 1 of both, infinite if nothing bifurcates; `kind`: "second impact" or "flip";
    `admissible`: whether the orbit at the fold has one impact only.
    """

    fold: float
    excess: float
    kind: str
    admissible: bool


def secondary_of(family: MaximalFamily) -> Secondary | None:
    """Of Eq. (1); None where p_m has no fold."""
    least = family.fold()
    if least is None:
        return None
    second, flip = second_impact_speed(family), flip_speed(family)
    flip = flip if flip > least.speed else math.inf
    first = min(second, flip)
    return Secondary(
        fold=least.excess,
        excess=family.excess(first) if math.isfinite(first) else math.inf,
        kind="second impact" if second <= flip else "flip",
        admissible=second > least.speed,
    )


def secondary_of_map(nordmark: NordmarkMap, period: int) -> float | None:
    """Excess at the upper end of the node p_m of the map, infinite without one; None where it has no fold."""
    if fold(nordmark, period) is None or (stable := stable_range(nordmark, period)) is None:
        return None
    return nordmark.excess(stable[1]) if math.isfinite(stable[1]) else math.inf
