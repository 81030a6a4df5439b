"""The Nordmark map behind the interface of a strobed oscillator.

One step of the map is one drive period, so that scans, settling and classification take it as they take the
beam.  A state is the array (x, y) of the letter's Eqs. (2), (3); the drive is set as excess over grazing and
turned into rho by the map's own coefficients.  An impact occurs in the step that starts from x > 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require_kind, require_within
from contact.nordmark import NordmarkMap
from contact.stroboscope import StrobedOrbit

__all__ = ["StrobedNordmarkMap"]

State = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class StrobedNordmarkMap:
    """A Nordmark map at a fixed excess over grazing.

    Parameters
    ----------
    map : NordmarkMap
    rho : float
        The bifurcation parameter [1].
    """

    map: NordmarkMap
    rho: float = 0.0

    def __post_init__(self) -> None:
        require_kind("map", self.map, NordmarkMap, "a NordmarkMap")
        require_within("rho", self.rho, "[1]")

    @property
    def scale(self) -> float:
        """Size of the state of an orbit with impacts, from the square root's slope at |rho| = 1e-3 [1]."""
        return 1e-3

    def at(self, excess: float) -> StrobedNordmarkMap:
        """The same map at another F/F_g - 1."""
        return replace(self, rho=self.map.rho(excess))

    def steady(self) -> State:
        """The fixed point of the branch without impact: x = rho / (1 - alpha + gamma), y = -gamma x."""
        x = self.rho / (1.0 - self.map.alpha + self.map.gamma)
        return np.array([x, -self.map.gamma * x])

    def orbit(self, state: State, count: int) -> StrobedOrbit[State]:
        """`count` steps from `state`; the points are (x, y), shape (count, 2)."""
        points = self.map.iterate(state, self.rho, count)
        before = np.concatenate([[state[0]], points[:-1, 0]])
        return StrobedOrbit(end=points[-1].copy(), points=points, impacts=(before > 0).astype(np.int64))
