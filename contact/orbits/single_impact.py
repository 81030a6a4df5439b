r"""Maximal orbits of an impact oscillator: one impact every m drive periods, Newton's law, in closed form.

    q_k'' + c_k q_k' + omega_k^2 q_k = -Gamma_k z'' + phi_k J delta(t - t_0),   x = sum_k phi_k q_k,
    z = Z sin(w t),  w = 2 pi f;   at the wall x = gap:  x' -> -e x'.

**Kick.** Let q_k = Z Im(H_k exp(i w t)) + u_k, H_k = Gamma_k w^2/(omega_k^2 - w^2 + i c_k w); u_k is free. An
impact at approach speed v changes u_k' by B_k v, B_k = -(1 + e) phi_k/sum phi^2. With N the free flow of mode
k over m/f, G = det N = exp(-c_k m/f) and D = 1 - tr N + G, the deviations that repeat after m/f are

    before the impact:  u_k = N12 B_k v/D,  u_k' = (N22 - G) B_k v/D
    after the impact:   u_k = N12 B_k v/D,  u_k' = (1 - N11) B_k v/D

**Amplitude against impact.** Before the impact let s = sum phi_k u_k/v [s], r = sum phi_k u_k'/v [1] and
b = (1 - r)/w [s]. With the steady tip amplitude A = Z |sum phi_k H_k| [m], the conditions x = gap, x' = v are

    A sin(psi) = gap - s v,   A cos(psi) = b v,   psi = w t_0 + arg sum phi_k H_k
    A(v)^2 = (gap - s v)^2 + (b v)^2                                                                     (a)

for every speed. If s > 0, A has a least value, the **fold** of the node (larger v) and the saddle:

    v = s gap/(s^2 + b^2),   A_m/gap = F_m/F_g = 1/sqrt(1 + k^2),   k = s/b.

For one mode k = -w N12 (1 + e)/(1 - N11 + e N22 - e G), which is the F_m of Eq. (1) at any amplitude.

Everything is exact as long as the tip does not reach the wall at another time: `SingleImpactOrbit.admissible`
says whether it does, by the certified search of ``contact.flight.crossing``. Multipliers of an orbit are in
``contact.orbits.saltation``. Units: SI with mass-normalised modes (q in m kg^0.5).
Sources: letter of 1996, Eq. (1) and Fig. 3; A. B. Nordmark, J. Sound Vib. 145 (1991) 279.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import require, require_array, require_within
from contact.flight.crossing import CROSSES, FREE, first_crossing
from contact.orbits.driven_modes import DrivenModes, modal_flow
from contact.orbits.saltation import monodromy, sorted_multipliers
from contact.touch import newton

__all__ = ["MaximalFamily", "MaximalFlight", "SingleImpactOrbit", "modal_flow"]

Array = NDArray[np.float64]
CLOSING = 1e-9  # part of the flight within which a crossing is the impact that ends it
HEIGHT = 1e-13  # the same in units of the gap: rounding of the height at which the flight ends


@dataclass(frozen=True, kw_only=True, eq=False)
class MaximalFlight:
    """The free flight of a maximal orbit from its impact to the next, as initial data.

    `start`: drive time of the impact [s]; `duration` m/f [s]; `displacement`, `velocity`: deviations u, u'
    from the steady motion just after the impact, shape (n_modes,) [m kg^0.5, m kg^0.5/s].
    """

    start: float
    duration: float
    displacement: Array
    velocity: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SingleImpactOrbit:
    """One orbit of a `MaximalFamily`, its `family`.

    `speed` v of approach [m/s]; `amplitude` Z of the base [m]; `excess` F/F_g - 1 [1]; `flight` from the
    impact on; `before`: deviations (u, u') just before the impact, shape (2, n_modes).
    """

    family: MaximalFamily
    speed: float
    amplitude: float
    excess: float
    flight: MaximalFlight
    before: Array

    def state(self, time: ArrayLike) -> Array:
        """Modal (q, q') at drive times within the flight [s], shape (2, n_modes) + shape of `time`.

        At the start of the flight it is the state after the impact, at its end that before the next one.
        """
        family, flight, times = self.family, self.flight, require_array("time", time, "s", words="times")
        since, slack = times.ravel() - flight.start, 1e-9 * flight.duration  # rounding of the caller's times
        inside = np.all((since >= -slack) & (since <= flight.duration + slack))
        require(bool(inside), f"time leaves the flight; it must lie within {flight.duration} s of its start")
        flows = np.array([modal_flow(family.omega, family.decay_rate, t) for t in since.tolist()])
        start = np.column_stack([flight.displacement, flight.velocity])
        free = np.einsum("tkij,kj->ikt", flows.reshape(-1, family.size, 2, 2), start)
        w = family.angular_frequency
        phase = self.amplitude * family.response[:, None] * np.exp(1j * w * times.ravel())
        return (np.array([phase.imag, w * phase.real]) + free).reshape((2, family.size, *times.shape))

    def tip(self, time: ArrayLike) -> tuple[Array, Array]:
        """Tip displacement [m] and velocity [m/s] relative to the base at drive times within the flight."""
        q, v = self.state(time)
        return np.tensordot(self.family.phi, q, 1), np.tensordot(self.family.phi, v, 1)

    def residual(self) -> float:
        """Largest relative mismatch of the closed orbit: gap, speed, Newton's law, return of modes [1]."""
        family, flight = self.family, self.flight
        after, arrival = self.state(flight.start), self.state(flight.start + flight.duration)
        x, v = family.phi @ arrival[0], family.phi @ arrival[1]
        jump = arrival[1] - (1.0 + family.restitution) * family.phi / (family.phi @ family.phi) * v
        mismatch = [abs(x / family.gap - 1.0), abs(v / self.speed - 1.0)]
        for found, wanted in ((arrival[0], after[0]), (jump, after[1])):
            mismatch.append(float(np.max(np.abs(found - wanted)) / np.max(np.abs(wanted))))
        return float(max(mismatch))

    @cached_property
    def admissible(self) -> bool:
        """Whether the flight meets the wall at its end only (certified; a graze counts as a meeting)."""
        family, flight = self.family, self.flight
        # the tip leaves with velocity -e v, or is at rest on the wall: one or two derivatives vanish at the
        # start
        order = 1 if family.restitution > 0.0 else 2
        outcome, time = first_crossing(
            family.motion(self.amplitude), flight.start, flight.displacement.copy(), flight.velocity.copy(),
            flight.duration * (1.0 + CLOSING), order,
        )  # fmt: skip
        slack = CLOSING * flight.duration + HEIGHT * family.gap / self.speed
        return bool(outcome == FREE or (outcome == CROSSES and abs(time - flight.duration) <= slack))

    def saltation(self) -> Array:
        """Saltation matrix of the impact in (q, q') of all modes, shape (2 n_modes, 2 n_modes)."""
        family, flight, size = self.family, self.flight, 2 * self.family.size
        motion, tangent = family.motion(self.amplitude), np.eye(size + 2)
        before = (flight.start, self.before[0].copy(), self.before[1].copy())
        after = (flight.start, flight.displacement, flight.velocity)
        newton.saltation(motion, family.tip_response, before, after, tangent)
        return tangent[:size, :size]

    def monodromy(self) -> Array:
        """Derivative of the motion over m/f, from just before an impact to just before the next, Phi S."""
        return monodromy(self.family.flow, self.saltation())

    def multipliers(self) -> NDArray[np.complex128]:
        """Eigenvalues of `monodromy`, shape (2 n_modes,), largest modulus first."""
        return sorted_multipliers(self.monodromy())

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.abs(self.multipliers()[0]) < 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class MaximalFamily(DrivenModes):
    """All orbits with one impact every `period` drive periods, by approach speed.

    Parameters
    ----------
    omega, decay_rate, phi, participation : array_like, shape (n_modes,)
        omega_k [rad/s], c_k [1/s], phi_k [kg^-0.5], Gamma_k [kg^0.5].
    drive_frequency : float
        f [Hz].
    gap : float
        Distance of the wall, above zero [m].
    restitution : float
        e of the law, from 0 to 1 [1].
    period : int
        m, one or more [1].

    Raises
    ------
    ValueError
        For numbers outside these ranges; if the drive is at the frequency of an undamped mode; or if a mode
        that the impact excites returns to itself after m/f (zero frequency, or undamped and in resonance),
        for then no orbit is periodic.
    """

    @cached_property
    def deviations(self) -> tuple[Array, Array]:
        """(u, u') per unit approach speed, just before and just after the impact, each (2, n_modes)."""
        moved = self.phi != 0.0  # a mode that the impact does not reach stays at rest
        kick = -(1.0 + self.restitution) * self.phi / (self.phi @ self.phi)
        kick = np.where(moved, kick / np.where(moved, self.distance_from_return, 1.0), 0.0)
        height = self.flow[:, 0, 1] * kick
        before = (self.flow[:, 1, 1] - self.determinant) * kick
        return np.array([height, before]), np.array([height, (1.0 - self.flow[:, 0, 0]) * kick])

    @cached_property
    def arms(self) -> tuple[float, float]:
        """(s, b) of Eq. (a) [s]."""
        before = self.deviations[0]
        return float(self.phi @ before[0]), float((1.0 - self.phi @ before[1]) / self.angular_frequency)

    def excess(self, speed: float) -> float:
        """F/F_g - 1 of the orbit with approach speed `speed` [m/s]."""
        s, b = self.arms
        v = require_within("speed", speed, "m/s", low=0) / self.gap
        square = v * ((s * s + b * b) * v - 2.0 * s)  # (A/gap)^2 - 1, without the cancellation
        return square / (1.0 + math.sqrt(max(1.0 + square, 0.0)))

    def orbit(self, speed: float) -> SingleImpactOrbit:
        """The orbit that meets the wall at `speed`, above zero [m/s]."""
        require_within("speed", speed, "m/s", above=0)
        s, b = self.arms
        phase = math.atan2(self.gap - s * speed, b * speed) - float(np.angle(self.tip_response))
        excess = self.excess(speed)
        before, after = (rows * speed for rows in self.deviations)
        flight = MaximalFlight(
            start=(phase % (2.0 * math.pi)) / self.angular_frequency,
            duration=self.period / self.drive_frequency, displacement=after[0], velocity=after[1],
        )  # fmt: skip
        return SingleImpactOrbit(
            family=self, speed=speed, amplitude=(1.0 + excess) * self.grazing_amplitude, excess=excess,
            flight=flight, before=before,
        )  # fmt: skip

    def orbits(self, excess: float) -> tuple[SingleImpactOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, 0 to 2, by rising speed (of two, saddle, then node)."""
        require_within("excess", excess, "[1]", above=-1)
        s, b = self.arms
        square, above = s * s + b * b, excess * (2.0 + excess)
        if s * s + square * above < 0.0:
            return ()
        half = s + math.copysign(math.sqrt(s * s + square * above), s)  # v/gap: half/square and -above/half
        speeds = sorted((self.gap * half / square, -self.gap * above / half if half != 0.0 else 0.0))
        return tuple(self.orbit(v) for v in speeds if v > 0.0)

    def fold(self) -> SingleImpactOrbit | None:
        """The orbit of least amplitude, at which node and saddle meet; None if s <= 0 (no fold)."""
        s, b = self.arms
        return self.orbit(s * self.gap / (s * s + b * b)) if s > 0.0 else None
