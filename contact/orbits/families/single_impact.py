"""Orbits with one collision every m drive periods: closed by linear algebra, exact under Newton's law.

A collision at approach speed v changes the deviations (u_k, u_k') from the steady motion by B_k(v), referred
to its first touch.  With w = 2 pi f, N the free flow of mode k over m/f, G = det N = exp(-c_k m/f) and
D = det(I - N) = 1 - tr N + G, the deviations that repeat after m/f are, just before the touch,

    (I - N)^-1 N B = (N - G I) B/D,      and B more just after it.

With p = sum phi_k u_k, r = sum phi_k u_k' there and the steady tip amplitude A the orbit has

    A^2 = (gap - p)^2 + ((v - r)/w)^2,      F/F_g - 1 = A/gap - 1.                                      (a)

**Newton's law.** B_k = (0, -(1 + e) phi_k v/sum phi^2), so that p = s v and (v - r)/w = b v: (a) is a
quadratic.  If s > 0, A has a least value, the **fold** of the node (larger v) and the saddle:

    v = s gap/(s^2 + b^2),   A_m/gap = F_m/F_g = 1/sqrt(1 + k^2),   k = s/b.

The formulae are exact if the tip does not reach the wall at another time (`SingleImpactOrbit.admissible`).
Units: SI with mass-normalised modes (q in m kg^0.5).
Sources: letter of 1996, Eq. (1) and Fig. 3; A. B. Nordmark, J. Sound Vib. 145 (1991) 279.
Derivation: ``docs/theory/orbits.md``.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from beam.parameters import Array, InvalidType, InvalidValue, require_kind, require_whole, require_within
from beam.record import record
from contact.flight.modal_flow import free_flow
from contact.flight.polynomial_root import positive_roots
from contact.laws import NewtonRestitution
from contact.orbits.families.equations import shoot
from contact.orbits.families.touch_orbit import CLOSING, TouchOrbit
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.sensitivity.change import Sensitivities
from contact.stop import Stop
from contact.touch.newton import newton_impact

SINGULAR = 1e-13  # a D below this is rounding of 1 - tr N + G, terms of size 1: the mode is back after m/f
HEIGHT = 1e-13  # rounding of the height at which the flight ends, in units of the gap


@record
class Kick:
    """The effect of one collision on all modes.

    Parameters
    ----------
    speed : float
        Approach speed v of the tip [m/s].
    jump : ndarray, shape (n_modes, 2)
        Jumps B of displacement [m kg^0.5] and velocity [m kg^0.5/s] of the modes, referred to the first
        touch.
    impacts : int, optional
        Touches in the collision.
    duration : float, optional
        Time from the first touch to the last release [s].
    leaves : bool, optional
        Whether the tip then has a velocity away from the wall; otherwise it is at rest on the wall.
    """

    speed: float
    jump: Array
    impacts: int = 1
    duration: float = 0.0
    leaves: bool = True


@record
class SingleImpactOrbit(TouchOrbit):
    """An orbit with one collision in m drive periods, as `MaximalFamily` and `KickFamily` return it.

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
        Deviations from the steady motion just before the first touch [kg^(1/2) m], and their rates
        [kg^(1/2) m/s].
    kick : Kick
        The effect of the collision on the modes.
    """

    kick: Kick

    def release(self) -> tuple[float, Array, Array, bool, float]:
        """The end of the collision."""
        numbers, duration = self.oscillator.numbers(), self.kick.duration
        after = self.deviations.reshape(2, -1).T + self.kick.jump  # referred to the first touch
        u, v = np.einsum("kij,kj->ik", free_flow(numbers, duration), after)
        return duration, u, v, self.kick.leaves, CLOSING * self.duration + HEIGHT * numbers.gap / self.speed

    def monodromy(self) -> Array:
        """The monodromy matrix of the oscillator's own collision, entered as on this orbit.

        NotPeriodic is raised if that collision has fewer touches than the kick, or does not end.
        """
        known = Sensitivities(oscillator=self.oscillator)
        return shoot(known, self.phase, self.deviations, self.m, self.kick.impacts)[0].tangent


@record
class SingleImpactFamily(ABC):
    """The orbits with one collision in m drive periods, from the kick of that collision.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Without constant load; its drive amplitude does not matter.
    m : int
        m, one or more.
    """

    oscillator: ImpactOscillator
    m: int

    def __post_init__(self) -> None:
        require_one_stop(self.oscillator, "an orbit")
        if self.oscillator.load is not None:
            raise InvalidValue("load is given; it must be None for orbits with one collision")
        self.oscillator.grazing_amplitude()  # the drive moves the tip
        require_whole("m", self.m, "drive periods")

    @abstractmethod
    def kick(self, speed: float) -> Kick:
        """The collision with approach speed `speed`, above zero [m/s]."""

    @cached_property
    def flow(self) -> Array:
        """N, mode by mode, shape (n_modes, 2, 2)."""
        return free_flow(self.oscillator.numbers(), self.m * self.oscillator.period)

    @cached_property
    def _closing(self) -> tuple[Array, NDArray[np.bool_]]:
        """(N - G I)/D of each mode, and whether the mode returns to itself after m/f (D = 0)."""
        shrink = np.exp(-self.oscillator.numbers().decay * self.m * self.oscillator.period)
        distance = np.abs(1.0 - self.flow[:, 0, 0] - self.flow[:, 1, 1] + shrink)
        trapped = distance <= SINGULAR
        sizes = np.where(trapped, 1.0, distance)[:, None, None]
        return (self.flow - shrink[:, None, None] * np.eye(2)) / sizes, trapped

    def closed(self, jump: Array) -> Array:
        """(N - G I) B/D: deviations before a collision that repeats, from its jump B; both (n_modes, 2).

        ValueError is raised if a kicked mode returns to itself after m/f: then no orbit is periodic.
        """
        matrices, trapped = self._closing
        back = np.flatnonzero(trapped & np.any(jump != 0.0, axis=1))  # one that is not kicked stays at rest
        if back.size:
            given = f"omega[{back[0]}] is {self.oscillator.model.omega[back[0]]} rad/s, a mode that is back"
            words = f"after {self.m} drive periods; it must have damping or another frequency"
            raise InvalidValue(f"{given} {words}")
        closed: Array = np.einsum("kij,kj->ki", matrices, jump)
        return closed

    def excess(self, speed: float) -> float:
        """F/F_g - 1 of the orbit that meets the wall at `speed`, above zero [m/s]; raises as `orbit` does."""
        kick, gap = self.kick(require_within("speed", speed, "m/s", above=0)), self.oscillator.stop.gap
        p, r = self.oscillator.numbers().tip(self.closed(kick.jump))
        return excess_of(p / gap, (kick.speed - r) / self.oscillator.unit_speed)

    def orbit_of(self, kick: Kick) -> SingleImpactOrbit:
        """The orbit on which `kick` happens once in m drive periods."""
        require_kind("kick", kick, Kick, "a Kick")
        before, gap = self.closed(kick.jump), self.oscillator.stop.gap
        p, r = self.oscillator.numbers().tip(before)
        rate = kick.speed - r
        amplitude, phase = self.oscillator.drive_at(gap - p, rate)
        return SingleImpactOrbit(
            oscillator=self.oscillator.with_amplitude(amplitude),
            m=self.m,
            excess=excess_of(p / gap, rate / self.oscillator.unit_speed),
            speed=kick.speed,
            phase=phase,
            displacement=before[:, 0].copy(),
            velocity=before[:, 1].copy(),
            kick=kick,
        )

    def orbit(self, speed: float) -> SingleImpactOrbit:
        """The orbit that meets the wall at `speed`, above zero [m/s].

        NotPeriodic is raised if the collision does not end, or has no orbit.
        """
        return self.orbit_of(self.kick(require_within("speed", speed, "m/s", above=0)))


def excess_of(p: float, rate: float) -> float:
    """A/gap - 1 of Eq. (a), from p and (v - r)/w over the gap, without the cancellation."""
    square = p * (p - 2.0) + rate * rate
    return float(square / (1.0 + math.sqrt(max(1.0 + square, 0.0))))


@record
class MaximalFamily(SingleImpactFamily):
    """The p_m orbits under Newton's law with a constant restitution, in closed form.

    Each orbit has one impact in m drive periods.  Over the excess, a stable and an unstable orbit meet in the
    fold.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven oscillator with one stop and without constant load; its drive amplitude does not matter.
    m : int
        Period of the orbits in drive periods, one or more.

    Raises
    ------
    TypeError
        If the oscillator has another law, or a restitution that depends on the speed.
    ValueError
        If the oscillator has several stops, a constant load, or no drive that moves the tip.  If `m` is below
        one, or if an undamped mode returns to itself after m drive periods.

    See Also
    --------
    contact.orbits.KickFamily : The same orbits from kicks, under any law.
    contact.orbits.Shooting : Orbits with any number of touches, under any law.
    contact.MapFamily : The orbits of Nordmark's map.

    Examples
    --------
    Two orbits of period 5 exist between the fold and grazing; the faster one is stable.

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, MaximalFamily, NewtonRestitution, Stop
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=22.2))
    >>> family = MaximalFamily(oscillator=oscillator, m=5)
    >>> print(f"{family.fold().excess:.5f}")
    -0.00148
    >>> [(f"{orbit.speed:.3f} m/s", orbit.stable) for orbit in family.orbits(-1e-3)]
    [('0.069 m/s', False), ('0.252 m/s', True)]
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self.oscillator.local_restitution, self.coefficients  # each mode that is kicked comes to rest
        if self.oscillator.stop.law.table.size:
            words = "must have a constant restitution here; KickFamily and Shooting take any law"
            raise InvalidType("law of the stop", words)

    @classmethod
    def from_oscillator(
        cls, oscillator: ImpactOscillator, *, m: int, local_restitution: float | None = None
    ) -> Self:
        """The orbits of an oscillator; `local_restitution` [1] replaces its law."""
        if local_restitution is not None:
            require_one_stop(oscillator, "an orbit")
            law = NewtonRestitution(local_restitution=local_restitution)
            oscillator = replace(oscillator, stop=Stop(gap=oscillator.stop.gap, law=law))
        return cls(oscillator=oscillator, m=m)

    def kick(self, speed: float) -> Kick:
        """The collision under Newton's law: a jump of the velocities."""
        numbers, velocity = self.oscillator.numbers(), np.zeros(self.oscillator.n_modes)
        newton_impact(numbers, velocity, speed, numbers.number0)
        jump = np.column_stack([np.zeros(velocity.size), velocity])
        return Kick(speed=speed, jump=jump, leaves=numbers.number0 > 0.0)

    @cached_property
    def coefficients(self) -> tuple[float, float]:
        """(s, b): p and (v - r)/w of Eq. (a) per unit approach speed [s]."""
        s, r = self.oscillator.numbers().tip(self.closed(self.kick(1.0).jump))
        return float(s), float((1.0 - r) / self.oscillator.driven.angular_frequency)

    def orbits(self, excess: float) -> tuple[SingleImpactOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, 0 to 2, by rising speed (of two, saddle, then node)."""
        require_within("excess", excess, "[1]", above=-1)
        s, b = self.coefficients
        roots = positive_roots(s * s + b * b, -2.0 * s, -excess * (2.0 + excess))
        return tuple(self.orbit(self.oscillator.stop.gap * root) for root in roots)

    def fold(self) -> SingleImpactOrbit | None:
        """The orbit of least amplitude, at which node and saddle meet; None if s <= 0 (no fold)."""
        s, b = self.coefficients
        return self.orbit(s * self.oscillator.stop.gap / (s * s + b * b)) if s > 0.0 else None
