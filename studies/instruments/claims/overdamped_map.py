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

from contact.maximal_orbits import maximal_orbits
from contact.nordmark import NordmarkMap

__all__ = ["exponents", "overdamped", "overlap", "switch", "window"]


def overdamped(alpha: float, gamma: float = 0.0) -> NordmarkMap:
    """The map with real eigenvalues of the motion without impact and tau = 0."""
    return NordmarkMap(alpha=alpha, gamma=gamma, restitution=0.0, whole_turns=0)


def slow(alpha: float, gamma: float) -> float:
    """l, the larger eigenvalue."""
    return 0.5 * (alpha + math.sqrt(alpha * alpha - 4.0 * gamma))


def window(nordmark: NordmarkMap, period: int) -> tuple[float, float] | None:
    """The rho between which p_m is stable and without a second impact, None if there are none.

    x_0 rises with rho: along it p_m becomes stable once, and meets its second impact once.
    """
    size = slow(nordmark.alpha, nordmark.gamma) ** (2 * period - 2)

    def stable(z: float) -> bool:
        return any(orbit.stable for orbit in maximal_orbits(nordmark, period, size * z))

    def doubled(z: float) -> bool:
        return not any(orbit.admissible for orbit in maximal_orbits(nordmark, period, size * z))

    low, high = (first_true(statement, 1e-4, 1e6) for statement in (stable, doubled))
    return (size * low, size * high) if low < high else None


def first_true(statement: Callable[[float], bool], low: float, high: float) -> float:
    """Where a statement that is false at `low` and true at `high` becomes true, on a logarithmic scale."""
    for _ in range(60):  # halvings of 23: to rounding
        middle = math.sqrt(low * high)
        low, high = (low, middle) if statement(middle) else (middle, high)
    return high


def overlap(alpha: float, gamma: float, period: int) -> float:
    """log of upper end of p_(m+1) over lower end of p_m: above 0 where they coexist."""
    lower, upper = window(overdamped(alpha, gamma), period), window(overdamped(alpha, gamma), period + 1)
    return -1.0 if lower is None or upper is None else math.log(upper[1] / lower[0])


def switch(holds: Callable[[float], bool], low: float, high: float, halvings: int = 16) -> float:
    """Where a statement that is true at `low` and false at `high` changes."""
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return 0.5 * (low + high)


def exponents(
    alpha: float | np.ndarray, gamma: float, rho: np.ndarray, settle_steps: int, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Largest exponents of the map at each rho, and the last 120 x, by carrying one tangent along."""
    x, y = rho.copy(), np.zeros_like(rho)
    a, b = np.ones_like(rho), np.full_like(rho, 0.1)
    total = np.zeros_like(rho)
    kept = []
    for n in range(settle_steps + steps):
        hit = x > 0.0
        root = np.sqrt(np.where(hit, x, 1.0))
        slope = np.where(hit, -0.5 / root, alpha)
        lost = np.where(hit, 0.0, gamma)
        a, b = slope * a + b, -lost * a
        x, y = np.where(hit, -root, alpha * x) + y + rho, -lost * x
        size = np.hypot(a, b)
        a, b = a / size, b / size
        if n >= settle_steps:
            total += np.log(size)
        if n >= settle_steps + steps - 120:
            kept.append(x)
    return total / steps, np.array(kept)
