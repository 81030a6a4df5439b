"""Least squares along curved valleys: Levenberg and Marquardt with geodesic acceleration.

Where a record determines some combinations of the parameters ten thousand times better than others, chi^2 is
a narrow, curved valley, and a step along its tangent soon leaves it.  With residuals r(u), J = dr/du and a
damping l, a step is d + a, with second derivatives along d from one more evaluation:

    (J^T J + l D^2) d = -J^T r,   (J^T J + l D^2) a = -J^T r''/2,   r'' = (2/h) ((r(u + h d) - r)/h - J d).

It is taken if |a| is well below |d| and chi^2 falls (M. K. Transtrum and J. P. Sethna, arXiv:1201.5885).  The
search ends where a further step would lower chi^2 by less than a given amount, to first order.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.measurement.identify.record.records import Array

AHEAD, BEND = 0.1, 0.75  # part h of a step at which it is tried for its bend; largest 2 |a|/|d|
DAMPING, LESS, MORE = 1e-3, 0.2, 3.0  # at first; factors after a step that is taken and one that is not
STUCK = 1e12  # damping where no step is short enough
SEEN = 1e-8  # ratio of singular values below which residuals do not depend on a direction
INSIDE = 1e-9  # part of a unit by which a bounded unknown stays off its bound


@dataclass(frozen=True, eq=False)
class Found:
    """The end of a search: unknowns, residuals, their derivatives, and the fall of chi^2 that is `left`."""

    x: Array
    fun: Array
    jac: Array
    left: float

    @property
    def chi2(self) -> float:
        """The sum of the squared residuals."""
        return float(self.fun @ self.fun)


def descend(
    residuals: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: Array,
    bounds: Array,
    most: int,
    enough: float,
) -> Found:
    """The least sum of squares from `start`, in `most` steps, between `bounds` of shape (2, n).

    Residuals that are not finite reject a step.  The search ends where chi^2 would fall by less than the part
    `enough` of it.
    """
    low, high = bounds[0] + INSIDE, bounds[1] - INSIDE
    u = np.clip(start, low, high)
    r, damping, scale = residuals(u), DAMPING, np.zeros(u.size)
    j = jacobian(u)
    for count in range(most + 1):
        downhill = -(j.T @ r)
        free = ~(((u <= low) & (downhill < 0.0)) | ((u >= high) & (downhill > 0.0)))
        q, triangle = np.linalg.qr(j[:, free])
        left = _left(triangle, q.T @ r)
        if left < enough * float(r @ r) or count == most:
            break
        scale = np.maximum(scale, np.linalg.norm(j, axis=0))
        taken = None
        while taken is None and damping < STUCK:
            damped = np.vstack([triangle, np.diag(math.sqrt(damping) * scale[free])])

            def step(rows: Array, damped: Array = damped, free: Array = free, q: Array = q) -> Array:
                found = np.zeros(free.size)
                right = np.append(-(q.T @ rows), np.zeros(int(free.sum())))
                found[free] = np.linalg.lstsq(damped, right, rcond=None)[0]
                return found

            d = step(r)
            ahead = residuals(np.clip(u + AHEAD * d, low, high))
            a = 0.5 * step((2.0 / AHEAD) * ((ahead - r) / AHEAD - j @ d)) if np.all(np.isfinite(ahead)) else d
            if 2.0 * np.linalg.norm(scale * a) <= BEND * np.linalg.norm(scale * d):
                at = np.clip(u + d + a, low, high)
                tried = residuals(at)
                if float(tried @ tried) < float(r @ r):
                    taken = at, tried
                    break
            damping *= MORE
        if taken is None:
            break
        (u, r), damping = taken, damping * LESS
        j = jacobian(u)
    return Found(u, r, j, left)


def _left(triangle: Array, rest: Array) -> float:
    """The part of chi^2 along the directions that the unknowns move the residuals in."""
    lengths = np.linalg.norm(triangle, axis=0)
    axes, singular, _ = np.linalg.svd(triangle / np.where(lengths > 0.0, lengths, 1.0))
    return float(np.sum((axes[:, singular > SEEN * singular[0]].T @ rest) ** 2))
