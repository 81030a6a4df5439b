"""Linear stability of the generalised-alpha family, Newmark's method and HHT-alpha among it.

A step multiplies the free motions of a mode q'' + c q' + omega^2 q = 0 by the roots z of

    (z - 1)^2 (alpha_m + (1 - alpha_m) z) + (alpha_f + (1 - alpha_f) z) [ c h (1 - gamma + gamma z)(z - 1)
        + y (beta z^2 + (1/2 + gamma - 2 beta) z + 1/2 - gamma + beta) ] = 0,   y = h^2 omega^2

(from the equations of ``generalised_alpha`` with q, v, a ~ z^n).  With z = (1 + s)/(1 - s), A = 1 - 2
alpha_m, F = 1 - 2 alpha_f, g = 2 gamma - 1, b = 4 beta - 2 gamma and X = 2 c h this is p3 s^3 + p2 s^2 + p1 s
+ y = 0,

    p3 = 4 A + F (b y + X g),   p2 = 4 + b y + X g + F (g y + X),   p1 = (g + F) y + X,

stable if none is below zero and p2 p1 >= p3 y (Routh and Hurwitz).  Without damping all four conditions are
linear in y,

    4 A + F b y,   4 + (b + F g) y,   (g + F) y,   4 (g + F - A) + g (b + F g + F^2) y   >= 0,

hence the limit: for Newmark's method (A = F = 1) y <= 1/(gamma/2 - beta), none if 2 beta >= gamma >= 1/2; for
the others of order 2 none if alpha_m <= alpha_f <= 1/2 and beta >= 1/4 + (alpha_f - alpha_m)/2 (J. Chung,
G. M. Hulbert, J. Appl. Mech. 60 (1993) 371).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

__all__ = ["AlphaNumbers", "factors", "limit", "stable"]

MARGIN = 1e-12
"""Slack of the conditions, in units of their terms: on the limit itself they cancel up to rounding."""


class AlphaNumbers(NamedTuple):
    """The numbers of a member of the family, as in ``generalised_alpha`` [1]."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float


def _letters(numbers: AlphaNumbers) -> tuple[float, float, float, float]:
    """A, F, g, b."""
    alpha_m, alpha_f, beta, gamma = numbers
    return 1.0 - 2.0 * alpha_m, 1.0 - 2.0 * alpha_f, 2.0 * gamma - 1.0, 4.0 * beta - 2.0 * gamma


def factors(numbers: AlphaNumbers, size: float, decay: float = 0.0) -> np.ndarray:
    """The roots z for h omega = `size` and h c = `decay`, complex, shape (3,)."""
    alpha_m, alpha_f, beta, gamma = numbers
    inertia = np.convolve([1.0 - alpha_m, alpha_m], [1.0, -2.0, 1.0])
    spring = size**2 * np.array([beta, 0.5 + gamma - 2.0 * beta, 0.5 - gamma + beta])
    dashpot = decay * np.array([gamma, 1.0 - 2.0 * gamma, gamma - 1.0])
    return np.asarray(np.roots(inertia + np.convolve([1.0 - alpha_f, alpha_f], spring + dashpot)))


def limit(numbers: AlphaNumbers) -> float:
    """Largest h omega without damping; infinite if there is none, 0 if any is too large [1]."""
    a, f, g, b = _letters(numbers)
    largest = math.inf
    for constant, slope in (
        (4.0 * a, f * b), (4.0, b + f * g), (0.0, g + f), (4.0 * (g + f - a), g * (b + f * g + f * f)),
    ):  # fmt: skip
        if constant < -MARGIN or (constant < MARGIN and slope < -MARGIN):
            return 0.0
        if slope < -MARGIN:
            largest = min(largest, -constant / slope)
    return math.sqrt(largest)


def stable(numbers: AlphaNumbers, size: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """Whether a mode with h omega = `size` and h c = `decay` does not grow, elementwise."""
    a, f, g, b = _letters(numbers)
    y, x = size**2, 2.0 * decay
    p3, p2, p1 = 4.0 * a + f * (b * y + x * g), 4.0 + b * y + x * g + f * (g * y + x), (g + f) * y + x
    scale = MARGIN * (4.0 + y + x) * (1.0 + abs(b) + abs(g) + abs(f))
    least = np.minimum(np.minimum(p3, p2), p1)
    return np.asarray((least >= -scale) & (p2 * p1 - p3 * y >= -scale * (y + x)))
