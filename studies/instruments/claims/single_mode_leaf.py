"""Eq. (1) without its restitution: its Nordmark map and its p_m families at any frequency and restitution.

The free period T and the decay rate fix the map (Eqs. (2), (3)) at each drive frequency, and with it the band
m, and the family of p_m orbits of Eq. (1) itself.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.maximal_orbits import maximal_period
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily
from studies.instruments.scene import Scene

__all__ = ["Leaf"]


@dataclass(frozen=True, kw_only=True)
class Leaf:
    """Eq. (1) without its restitution: free period [s] and decay rate [1/s]."""

    free_period: float
    decay_rate: float

    @staticmethod
    def of(scene: Scene) -> Leaf:
        return Leaf(
            free_period=scene.single_mode.free_period_s, decay_rate=scene.single_mode.decay_rate_per_s
        )

    def map(self, frequency: float, restitution: float) -> NordmarkMap:
        return NordmarkMap.from_frequencies(
            drive_frequency=frequency,
            free_period=self.free_period,
            decay_rate=self.decay_rate,
            restitution=restitution,
        )

    def family(self, frequency: float, restitution: float, period: int) -> MaximalFamily:
        return MaximalFamily.single_mode(
            drive_frequency=frequency,
            free_period=self.free_period,
            decay_rate=self.decay_rate,
            restitution=restitution,
            period=period,
        )

    def period(self, frequency: float, restitution: float) -> int:
        """The m of the band of the map."""
        return maximal_period(self.map(frequency, restitution))
