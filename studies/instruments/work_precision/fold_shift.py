r"""How far a method moves a fold, from one run of the method.

Let P(x, A) be the exact m-period map and x* = P(x*, A*) its orbit at the fold, where I - DP is singular with
left null vector w.  A method's own map P~ = P + D has its fold near by, at (x* + y, A* + dA):

    (I - DP) y = D(x*, A*) + P_A dA + quadratic terms,    hence    dA = - w.D(x*, A*) / (w.P_A).       (a)

The next terms are y^2 D^2 P and y DD, both of second order in the defect D (y is fixed by the condition that
I - D P~ be singular, which makes it of the size of D as well).  One run of m periods from x* gives D; DP and
P_A come from central differences of the exact map.  D is taken against the exact map in extended precision,
so that rounding of the point x* itself cancels.

(a) is trusted while |dA| is below `FIRST_ORDER` of the depth of the fold, |A* - A_g|: speeds of impact scale
with the root of that depth, and it is in their scale that the map is curved.  Beyond, no number is given.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import State
from studies.instruments.work_precision.problems import FoldPoint

__all__ = ["FIRST_ORDER", "FoldTest", "fold_test"]

FIRST_ORDER = 0.1
"""Part of the fold's depth up to which the first order is given; tests measure what it leaves."""

DIFFERENCE = 1e-6
"""Step of the central differences in units of the gap: their error is 1e-8 of the derivatives."""

Map = Callable[[ImpactOscillator, State], State]
"""m drive periods from a strobe."""


def exact_map(periods: int) -> Map:
    """The m-period map by the exact method of the law."""
    return lambda oscillator, state: simulate(oscillator, state, periods=periods).end


def flat(state: State) -> np.ndarray:
    """(displacements, velocities) as one array."""
    return np.concatenate([state.displacement, state.velocity])


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldTest:
    """What (a) needs: the fold, the exact image of its state, w and w.P_A.

    `singular` is the smallest singular value of I - DP over the next one, in scaled coordinates: how well the
    orbit is known to be the fold.
    """

    fold: FoldPoint
    image: np.ndarray
    left: np.ndarray
    slope: float
    grazing_amplitude: float
    singular: float

    def shift(self, end: State) -> float:
        """dA over the grazing amplitude, for a method's image `end` of the fold's state [1]."""
        defect = flat(end) - self.image
        return float(-(self.left @ defect) / self.slope / self.grazing_amplitude)

    def within_first_order(self, shift: float) -> bool:
        """Whether (a) may be trusted."""
        return abs(shift) <= FIRST_ORDER * abs(self.fold.excess)


def fold_test(fold: FoldPoint, image: np.ndarray | None = None) -> FoldTest:
    """Derivatives of the exact map at the fold.

    Parameters
    ----------
    fold : FoldPoint
    image : ndarray, shape (2 n_modes,), optional
        P(x*, A*) from a reference; from the exact method if left out.
    """
    oscillator, state = fold.oscillator, fold.state
    drive, model = oscillator.drive, oscillator.model
    assert drive is not None
    period_map, n = exact_map(fold.periods), oscillator.n_modes
    size = oscillator.stop.gap / np.abs(model.phi).max()
    scale = np.concatenate([np.full(n, size), size * np.maximum(model.omega, drive.angular_frequency)])
    start = flat(state)

    def at(x: np.ndarray, amplitude: float) -> np.ndarray:
        moved = replace(state, displacement=x[:n], velocity=x[n:])
        return flat(period_map(oscillator.with_amplitude(amplitude), moved)) / scale

    jacobian = np.empty((2 * n, 2 * n))
    for j in range(2 * n):
        step = np.zeros(2 * n)
        step[j] = DIFFERENCE * scale[j]
        ahead, behind = at(start + step, drive.amplitude), at(start - step, drive.amplitude)
        jacobian[:, j] = (ahead - behind) / (2.0 * DIFFERENCE)
    change = DIFFERENCE * drive.amplitude
    ahead, behind = at(start, drive.amplitude + change), at(start, drive.amplitude - change)
    by_amplitude = (ahead - behind) / (2.0 * change)
    left, values, _right = np.linalg.svd(np.eye(2 * n) - jacobian)
    w = left[:, -1]
    return FoldTest(
        fold=fold, image=flat(period_map(oscillator, state)) if image is None else image, left=w / scale,
        slope=float(w @ by_amplitude), grazing_amplitude=oscillator.grazing_amplitude(),
        singular=float(values[-1] / values[-2]),
    )  # fmt: skip
