"""Periodic orbits of an impact oscillator, given by their first touch.

The state just before the first touch, as deviations from the steady motion, and the drive time of the touch
give the whole orbit.  `PeriodicOrbit` is what shooting finds: it has the record of all its touches.
"""

from abc import ABC, abstractmethod
from dataclasses import field
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from beam.parameters import Array, record
from contact.errors import ContactError
from contact.flight.crossing import CROSSES, FREE, first_crossing
from contact.flight.modal_flow import steady_motion
from contact.flight.tip import tip_state
from contact.flight.tip_search import peaks_of_flight, tip_at
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.state import State
from contact.touch.passage import Touches

Failure = TypeVar("Failure", bound=ContactError)
CLOSING = 1e-9  # part of a flight by which it is prolonged, so that the touch at its end is met

ALIKE = 1e-5
"""Difference between touches that is taken for none.  Behind a branch point touches part in proportion to the
distance, and the equations are singular up to about this distance."""

NEARLY = 1e-3  # the same for an orbit at a branch point, which is located only so far
SLACK = 1e-6  # part of a drive period by which the closing touch may be missed, in addition to the residual


@record
class TouchOrbit(ABC):
    """A periodic orbit of an impact oscillator, by its first touch.

    Parameters
    ----------
    oscillator : ImpactOscillator
        At the drive amplitude of the orbit.
    m : int
        m, in drive periods.
    excess, speed, phase : float
        F/F_g - 1 [1], and approach velocity [m/s] and drive time [s] of the first touch.
    displacement, velocity : ndarray, shape (n_modes,)
        Deviations from the steady motion just before it.
    """

    oscillator: ImpactOscillator = field(repr=False)
    m: int
    excess: float
    speed: float
    phase: float
    displacement: Array
    velocity: Array

    @abstractmethod
    def monodromy(self) -> Array:
        """Derivative of (u, u') over m/f from touch to touch at fixed drive, (2 n_modes, 2 n_modes)."""

    @abstractmethod
    def release(self) -> tuple[float, Array, Array, bool, float]:
        """The end of the last touch: its time since the first touch [s] and deviations u and u'.

        Then come whether the tip has a velocity away from the wall, or else is at rest on it, and the time by
        which the touch that closes the orbit may be missed [s].
        """

    @property
    def deviations(self) -> Array:
        """(u, v) of all modes just before the first touch, shape (2 n_modes,)."""
        return np.concatenate([self.displacement, self.velocity])

    @property
    def amplitude(self) -> float:
        """Base amplitude [m]."""
        return self.oscillator.driven.amplitude

    @property
    def duration(self) -> float:
        """m/f [s]."""
        return self.m * self.oscillator.period

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers: eigenvalues of `monodromy`, largest modulus first, shape (2 n_modes,)."""
        values = np.linalg.eigvals(self.monodromy()).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values))])

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.abs(self.multipliers[0]) < 1.0)

    @cached_property
    def admissible(self) -> bool:
        """Whether the last flight meets the wall at its end only (certified; a graze counts as a meeting)."""
        time, u, v, leaves, slack = self.release()
        length, numbers = self.duration - time, self.oscillator.numbers()
        base, until, order = self.phase + time, length * (1.0 + CLOSING), 1 if leaves else 2
        outcome, met = first_crossing(numbers, base, u.copy(), v.copy(), until, order)
        return bool(outcome == FREE or (outcome == CROSSES and abs(met - length) <= slack))

    def failure(self, kind: type[Failure], detail: str) -> Failure:
        """The error of this kind at the first touch, with its time and velocity."""
        return kind(time=self.phase, velocity=self.speed, detail=detail)

    def state(self) -> State:
        """The physical state just before the first touch, on the near side of the stop to the last digit."""
        numbers = self.oscillator.numbers()
        q, q_rate = steady_motion(numbers, self.phase)
        behind = max(0.0, tip_state(numbers, self.phase, self.displacement, self.velocity)[0])
        u = self.displacement - numbers.least_change(behind)  # rounding of the sum alone
        return State(displacement=u + q, velocity=self.velocity + q_rate, time=self.phase)

    def strobe_state(self) -> State:
        """The state at the strobe that follows the first touch."""
        m = self.oscillator.period
        return simulate(self.oscillator, self.state(), duration=m - self.phase % m).end


@record
class PeriodicOrbit(TouchOrbit):
    """A periodic orbit of an impact oscillator, found by shooting.

    `Shooting` returns such orbits, with the record of all their touches.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The oscillator at the drive amplitude of the orbit.
    m : int
        Period of the orbit in drive periods.
    excess : float
        Excess F/F_g - 1 of the orbit [1].
    speed : float
        Approach velocity of the first touch [m/s].
    phase : float
        Drive time of the first touch [s].
    displacement, velocity : ndarray, shape (n_modes,)
        Deviations of the modes from the steady motion just before the first touch [kg^(1/2) m], and their
        rates [kg^(1/2) m/s].
    record : Touches
        The touches of the orbit (``contact.touch.passage``), at times since the first one.
    tangent : ndarray, shape (2 n_modes, 2 n_modes)
        The monodromy matrix.
    slope : float
        Derivative of the excess with respect to the approach velocity along the family [s/m].
    residual : float
        Remaining error of the equations, in units of the gap [1].
    """

    record: Touches = field(repr=False)
    tangent: Array = field(repr=False)
    slope: float
    residual: float

    @property
    def impacts(self) -> int:
        """Touches in one period."""
        return len(self.record.log)

    @property
    def approach(self) -> Array:
        """Approach velocities of all touches in one period, shape (impacts,) [m/s]."""
        return np.asarray(self.record.log["approach"])

    def repeats(self, within: float = ALIKE) -> int:
        """How often the orbit runs through one of a shorter period: 1 for most.

        Times and speeds of its touches must agree `within` this part of the largest.
        """
        rows = np.column_stack([self.record.log[name] for name in ("start", "end", "approach", "rebound")])
        k, shift = self.impacts, np.zeros(4)
        for times in (times for times in range(k, 1, -1) if k % times == self.m % times == 0):
            shift[:2] = self.duration / times
            off = np.abs(rows[k // times :] - shift - rows[: -(k // times)])
            if np.all(off <= within * np.max(np.abs(rows), axis=0)):
                return times
        return 1

    def monodromy(self) -> Array:
        """The monodromy matrix, shape (2 n_modes, 2 n_modes)."""
        return self.tangent

    def release(self) -> tuple[float, Array, Array, bool, float]:
        """The end of the last touch; the closing one may be missed by a time that grows with the residual."""
        last, (u, v) = self.record.log[-1], self.record.states[-1, 1]
        off = 4.0 * self.residual * self.oscillator.stop.gap / self.approach[0]
        return float(last["end"]), u, v, bool(last["rebound"] < 0.0), SLACK * self.oscillator.period + off


def peaks(orbit: PeriodicOrbit) -> list[tuple[int, float, float]]:
    """All peaks of the flights of an orbit, the wall ignored; none is missed.

    Each is given by the number of the touch before it, the time since its end [s], and the height over the
    stop [m].
    """
    numbers, log, found = orbit.oscillator.numbers(), orbit.record.log, list[tuple[int, float, float]]()
    ends = np.append(log["start"][1:], orbit.duration)
    for i, (left, (u, v), end) in enumerate(zip(log["end"], orbit.record.states[:, 1], ends, strict=True)):
        base = float(orbit.phase + left)
        times = peaks_of_flight(numbers, base, u, v, (0.0, end - left), False).tolist()
        found += [(i, s, float(tip_at(numbers, base, u, v, s)[0])) for s in times]
    return found
