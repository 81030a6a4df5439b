"""When a strobed motion is known: its points repeat, or its free motion can never reach the stop again.

**Repetition.** The orbit has period p if all coordinates of the last L points repeat those p strobes before
to a tolerance and the impacts of each strobe repeat exactly, p <= L.

**No impact any more.** The free motion left over can only shrink (``contact.flight``), so that with

    |x_steady| + sum_k |phi_k| sqrt(u_k^2 + (u_k'/omega_k)^2)  <  gap

the tip never meets the stop again.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import numpy as np

from beam.parameters import require, require_whole, require_within
from contact.compiled import kernel
from contact.flight.modal_flow import tip_bound
from contact.flight.motion import OMEGA

__all__ = ["free_for_good", "period_of", "repetition"]


@kernel
def repetition(points, impacts, rows, stretch, tolerance):
    """The smallest p <= `stretch` with which the last `stretch` of `rows` strobes repeat, or 0.

    Parameters
    ----------
    points : ndarray, shape (capacity, n_coordinates)
    impacts : ndarray of int, shape (capacity,)
    rows : int
        Rows in use, at least 2 `stretch`.
    """
    for period in range(1, stretch + 1):
        same, i = True, rows
        while same and i > rows - stretch:
            i -= 1
            same, k = impacts[i] == impacts[i - period], 0
            while same and k < points.shape[1]:
                same, k = abs(points[i, k] - points[i - period, k]) <= tolerance, k + 1
        if same:
            return period
    return 0


def period_of(points: np.ndarray, impacts: np.ndarray, *, largest_period: int, tolerance: float) -> int:
    """The smallest p <= `largest_period` with which the last `largest_period` points repeat, or 0.

    Parameters
    ----------
    points : ndarray, shape (n_strobes, n_coordinates)
        At least 2 * `largest_period` strobes.
    impacts : ndarray of int, shape (n_strobes,)
    largest_period : int
    tolerance : float
        In the unit of the points.
    """
    rows, stretch = len(points), require_whole("largest_period", largest_period, "strobes", low=0)
    require(rows >= 2 * stretch, f"points has {rows} strobes; it must have {2 * stretch} or more")
    require_within("tolerance", tolerance, "(the unit of the points)", low=0)
    given = np.ascontiguousarray(points, dtype=float), np.ascontiguousarray(impacts, dtype=np.int64)
    return int(repetition(*given, rows, stretch, float(tolerance)))


@kernel
def free_for_good(motion, u, v):
    """Whether the free motion left over in the deviations (u, v) can never bring the tip to the stop."""
    left = motion.amplitude
    for k in range(motion.size):
        if not motion.modes[OMEGA, k] > 0.0:
            return False
        left += tip_bound(motion, k, u[k], v[k] / motion.modes[OMEGA, k])
    return left < -motion.level * (1.0 - 1e-12)
