"""Periodic orbits with any number of touches, and what finds the neighbours of one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from contact.orbits.family import Release, TouchOrbit
from contact.orbits.kick import KickFamily
from contact.oscillator import ImpactOscillator

__all__ = ["Followed", "PeriodicOrbit"]

Array = NDArray[np.float64]
SLACK = 1e-6
"""Part of a drive period by which the touch that closes an orbit may miss it, beside the residual."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PeriodicOrbit(TouchOrbit):
    """An orbit from shooting; beside the fields of `TouchOrbit`:

    Parameters
    ----------
    record : ndarray, shape (impacts, 4 + 2 n_modes)
        Its touches, as in ``contact.touch_flow``.
    tangent : ndarray, shape (2 n_modes, 2 n_modes)
        Its monodromy matrix.
    slope : float
        Change of the excess with the approach velocity along the family [s/m].
    residual : float
        What is left of the equations, in units of the gap.
    """

    record: Array = field(repr=False)
    tangent: Array = field(repr=False)
    slope: float
    residual: float

    @property
    def impacts(self) -> int:
        """Touches in one period."""
        return len(self.record)

    @property
    def approach(self) -> Array:
        """Approach velocities of all touches in one period, shape (impacts,) [m/s]."""
        return self.record[:, 2]

    def monodromy(self) -> Array:
        """The field `tangent`."""
        return self.tangent

    def release(self) -> Release:
        """That of the last touch; the residual moves the touch that closes the orbit."""
        n, last = self.oscillator.n_modes, self.record[-1]
        off = 4.0 * self.residual * self.oscillator.stop.gap / self.record[0, 2]
        slack = SLACK * self.oscillator.period + off
        return Release(float(last[1]), last[4 : 4 + n], last[4 + n :], bool(last[3] < 0.0), slack)


@runtime_checkable
class Followed(Protocol):
    """A family of which each orbit leads to its neighbours: ``contact.orbits.shooting.Shooting``."""

    @property
    def oscillator(self) -> ImpactOscillator:
        """The oscillator; its drive amplitude does not matter."""

    @property
    def kicks(self) -> KickFamily:
        """The description by kicks, from which a search starts."""

    def at_speed(self, speed: float, near: PeriodicOrbit | None = None) -> PeriodicOrbit:
        """The orbit whose first touch has approach velocity `speed` [m/s]; NotPeriodic if it is not found."""

    def of(self, oscillator: ImpactOscillator) -> Followed:
        """The same family of another oscillator."""
