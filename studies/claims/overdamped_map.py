"""The overdamped Nordmark map: windows of p_m, their overlap, and Lyapunov exponents.

Its eigenvalues without impact are 1 > l > l' >= 0.  For gamma = 0 (l' = 0, l = alpha) p_m has, as rho -> 0+,

    x_0 = l^(2m-2) z^2,   rho = l^(2m-2) (1 - l) z (z + 1),   1/2 < z < (1 - l)/l,

stable above the lower end, without a second impact below the upper one.  The windows of rho are empty for
l > 2/3, overlap for l < 1/4, and leave gaps in between, ln((3/4)/(1 - l)) / (2 ln(1/l)) of ln rho, that chaos
fills.  Source: W. Chin, E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact import NordmarkMap, maximal_orbits

__all__ = ["exponents", "outside_windows", "overdamped_map", "overlap", "switch", "window"]

KEPT = 120
"""Last iterates that `exponents` returns."""


def overdamped_map(alpha: float, gamma: float = 0.0) -> NordmarkMap:
    """The map with real eigenvalues of the motion without impact and tau = 0."""
    return NordmarkMap(alpha=alpha, gamma=gamma, restitution=0.0, whole_turns=0)


def window(nordmark: NordmarkMap, period: int) -> tuple[float, float] | None:
    """The rho between which p_m is stable and without a second impact, None if there are none.

    x_0 rises with rho: along it p_m becomes stable once, and meets its second impact once.
    """
    alpha, gamma = nordmark.alpha, nordmark.gamma
    size = (0.5 * (alpha + math.sqrt(alpha * alpha - 4.0 * gamma))) ** (2 * period - 2)

    def unstable(log: float) -> bool:
        return not any(orbit.stable for orbit in maximal_orbits(nordmark, period, size * math.exp(log)))

    def simple(log: float) -> bool:
        return any(orbit.admissible for orbit in maximal_orbits(nordmark, period, size * math.exp(log)))

    # 60 halvings of 23: to rounding
    low, high = (math.exp(switch(what, math.log(1e-4), math.log(1e6), 60)) for what in (unstable, simple))
    return (size * low, size * high) if low < high else None


def overlap(alpha: float, gamma: float, period: int) -> float:
    """log of upper end of p_(m+1) over lower end of p_m: above 0 where they coexist."""
    nordmark = overdamped_map(alpha, gamma)
    lower, upper = window(nordmark, period), window(nordmark, period + 1)
    return -1.0 if lower is None or upper is None else math.log(upper[1] / lower[0])


def outside_windows(alpha: float) -> float:
    """Part of ln rho outside all windows for gamma = 0 as rho -> 0+."""
    if alpha > 2.0 / 3.0:
        return 1.0
    return min(max(math.log(0.75 / (1.0 - alpha)) / (2.0 * math.log(1.0 / alpha)), 0.0), 1.0)


def switch(holds: Callable[[float], bool], low: float, high: float, halvings: int) -> float:
    """Where a statement that is true at `low` and false at `high` changes."""
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return 0.5 * (low + high)


def exponents(
    alpha: ArrayLike, rho: NDArray[np.float64], settle_steps: int, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest exponents of the map with gamma = 0 = tau at each rho, and its last `KEPT` x.

    An impact leaves x = -sqrt(x) + rho, a step without one alpha x + rho: one dimension, so that the
    exponent is the mean of log |slope|.
    """
    x, total, kept = rho.copy(), np.zeros_like(rho), []
    factor = np.broadcast_to(np.asarray(alpha, dtype=float), rho.shape)
    for n in range(settle_steps + steps):
        hit = x > 0.0
        root = np.sqrt(np.where(hit, x, 1.0))
        if n >= settle_steps:
            total += np.log(np.where(hit, 0.5 / root, factor))
        x = np.where(hit, -root, factor * x) + rho
        if n >= settle_steps + steps - KEPT:
            kept.append(x)
    return total / steps, np.array(kept)
