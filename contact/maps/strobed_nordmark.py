"""Nordmark's map at its rho as a strobed motion: scans and exponents take it as they take a beam."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import require_kind, require_within
from contact.maps.nordmark import NordmarkMap, pair_of
from contact.maps.protocol import Jacobians, StrobedOrbit, amplitude_factors


@dataclass(frozen=True, kw_only=True)
class StrobedNordmarkMap:
    """A Nordmark map at its rho as a ``contact.maps.protocol.StrobedMap``.

    A state is the array (x, y), which is also its point; an impact occurs in the step that starts from x > 0.

    Parameters
    ----------
    map : NordmarkMap
    rho : float
        The bifurcation parameter [1]; `at` sets it from the excess over grazing.
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

    @property
    def period(self) -> float:
        """The time of one step, 1: the map has no clock."""
        return 1.0

    def at(self, excess: float) -> StrobedNordmarkMap:
        """The same map at F/F_g - 1 = `excess` [1]."""
        return replace(self, rho=self.map.rho(excess))

    def steady(self) -> NDArray[np.float64]:
        """The fixed point of the branch without impact: x = rho / (1 - alpha + gamma), y = -gamma x."""
        x = self.rho / (1.0 - self.map.alpha + self.map.gamma)
        return np.array([x, -self.map.gamma * x])

    def orbit(
        self, state: ArrayLike, count: int, *, factors: ArrayLike | None = None
    ) -> StrobedOrbit[NDArray[np.float64]]:
        """`count` steps from `state`; the points are (x, y), shape (count, 2).

        With `factors`, one for each step, the amplitude is that of the map times the factor of the step.
        """
        changing, rho = amplitude_factors(factors, count), np.full(count, self.rho)
        if changing.size:
            rho += (self.map.rho_per_excess + self.rho) * (changing - 1.0)
        points = np.vstack([pair_of(state), self.map.iterate(state, rho, count)])
        impacts = (points[:-1, 0] > 0).astype(np.int64)
        return StrobedOrbit(end=points[-1].copy(), points=points[1:], impacts=impacts)

    def jacobians(self, state: ArrayLike, count: int) -> Jacobians[NDArray[np.float64]]:
        """The derivatives along `count` steps, and the end."""
        points = np.vstack([pair_of(state), self.orbit(state, count).points])
        return [(self.map.jacobian(row), 1) for row in points[:-1]], points[-1].copy()

    def coordinates(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """The state itself."""
        return state
