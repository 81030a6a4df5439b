"""Periodic orbits with any number of touches, and what finds the neighbours of one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from contact.flight.modal_flow import steady_motion
from contact.orbits.kick import KickFamily
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import State

__all__ = ["Followed", "PeriodicOrbit"]

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class PeriodicOrbit:
    """A periodic orbit with impacts.

    Parameters
    ----------
    oscillator : ImpactOscillator
        At the drive amplitude of the orbit.
    period : int
        m, in drive periods.
    excess : float
        F/F_g - 1.
    speed : float
        Approach velocity of the first touch [m/s].
    approach : ndarray, shape (impacts,)
        Approach velocities of all touches in one period [m/s].
    phase : float
        Drive time of the first touch [s].
    displacement, velocity : ndarray, shape (n_modes,)
        Deviations from the steady motion there.
    multipliers : ndarray of complex, shape (2 n_modes,)
        Floquet multipliers, the largest first.
    slope : float
        Change of the excess with the approach velocity along the family [s/m].
    residual : float
        What is left of the equations, in units of the gap.
    admissible : bool
        The tip touches the stop at these impacts only (certified).
    """

    oscillator: ImpactOscillator = field(repr=False)
    period: int
    excess: float
    speed: float
    approach: Array
    phase: float
    displacement: Array
    velocity: Array
    multipliers: NDArray[np.complex128]
    slope: float
    residual: float
    admissible: bool

    @property
    def impacts(self) -> int:
        """Touches in one period."""
        return self.approach.size

    @property
    def amplitude(self) -> float:
        """Base amplitude [m]."""
        return self.oscillator.driven.amplitude

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.abs(self.multipliers[0]) < 1.0)

    def state(self) -> State:
        """The physical state just before the first touch."""
        q, q_rate = steady_motion(self.oscillator.motion(), np.array([self.phase]))
        return State(
            displacement=self.displacement + q[0], velocity=self.velocity + q_rate[0], time=self.phase
        )

    def strobe_state(self) -> State:
        """The state at the strobe that follows the first touch."""
        period = self.oscillator.period
        return simulate(self.oscillator, self.state(), duration=period - self.phase % period).end


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
