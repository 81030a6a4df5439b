"""A collision as a kick, and the p_m orbits that follow by linear algebra.

One simulated collision, entered with approach velocity v from the steady motion with all modes at rest above
it, changes the deviations of all modes by B(v), referred to the touch by their free flow.  If on an orbit of
period m the same collision happens once in m drive periods, the deviations just before it are

    w = (I - P)^-1 P B(v),   P = free flow over m/f,

and the steady motion has to make up the rest of gap and velocity: with p = phi . w_u, r = phi . w_v,

    A(v)^2 = (gap - p)^2 + ((v - r)/(2 pi f))^2

is the square of the steady tip amplitude, so that F/F_g - 1 = A/gap - 1.  The orbit ends (fold) where A(v) is
smallest.  With Newton's law B is proportional to v and the result exact (``contact.orbits.single_impact``).

``DelayedRestitution`` (one mode, ``contact.touch.delayed``) has its orbits in closed form.  With (p, r) the
steady tip displacement and velocity at the touch, R their turn by the angle w delta and N the free flow over
m/f - delta, the tip leaves with the deviation (gap, -tau v) - R (p, r) and comes back with (gap, v) - (p, r):

    (I - N R) (p, r) = (gap, v) - N (gap, -tau v),      A(v)^2 = p^2 + (r/(2 pi f))^2.

What this neglects is that the real collision starts with the ringing w left over from the last one and at
another acceleration of the tip.  Both are there to be used: a second collision, simulated from w itself,
gives another A at the same v, and the difference is the estimate of the error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam.parameters import is_whole, require, require_array, require_kind, require_within, shown
from contact.errors import NotPeriodic
from contact.flight.crossing import CROSSES, first_crossing
from contact.flight.motion import Motion
from contact.laws import DELAYED
from contact.orbits.driven_modes import SINGULAR, modal_flow
from contact.oscillator import ImpactOscillator
from contact.touch.delayed import numbers_at
from contact.touch_flow import FLOWN, flow_from_touch

__all__ = ["Kick", "KickFamily", "KickOrbit"]

Array = NDArray[np.float64]

MOST_TOUCHES = 200
"""Bound of touches in one collision: a bare tip under a stiff spring makes some dozens."""

WINDOW = 0.5
"""Part of a drive period after the first touch in which further touches belong to the collision."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Kick:
    """What one collision does to all modes.

    Parameters
    ----------
    speed : float
        Approach velocity v of the tip [m/s].
    jump : ndarray, shape (n_modes, 2)
        B: jumps of displacement and velocity of the modes, referred to the touch.
    touches : int
        Contacts in the collision.
    duration : float
        From first touch to last release [s].
    """

    speed: float
    jump: Array
    touches: int
    duration: float


@dataclass(frozen=True, kw_only=True, eq=False)
class KickOrbit:
    """An orbit of the kick description.

    Parameters
    ----------
    period : int
        m.
    kick : Kick
        The collision that it was built from.
    deviations : ndarray, shape (n_modes, 2)
        w, just before the collision.
    amplitude : float
        Base amplitude [m].
    excess : float
        F/F_g - 1.
    phase : float
        Drive time of the touch [s].
    """

    period: int
    kick: Kick
    deviations: Array
    amplitude: float
    excess: float
    phase: float


@dataclass(frozen=True, kw_only=True, eq=False)
class KickFamily:
    """The p_m orbits with one collision, of an oscillator with any contact law, from kicks.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Its drive amplitude does not matter.
    period : int
        m, one or more.
    modes : int, optional
        Keep the kick of the first `modes` modes only; with 1 the letter's single-mode description with its
        measured restitution and delay.
    """

    oscillator: ImpactOscillator
    period: int
    modes: int | None = None

    def __post_init__(self) -> None:
        require_kind("oscillator", self.oscillator, ImpactOscillator, "an ImpactOscillator")
        if self.oscillator.drive is None:
            raise ValueError("drive is None; orbits of a driven spring need a HarmonicDrive")
        if self.oscillator.load is not None:
            raise ValueError(
                "load is given; the orbits from kicks are those of a spring without constant load"
            )
        if not is_whole(self.period, 1):
            raise ValueError(
                f"period is {shown(self.period)}; it must be a whole number of drive periods, one or more"
            )
        most = self.oscillator.n_modes
        if self.modes is not None and not (is_whole(self.modes, 1) and self.modes <= most):
            raise ValueError(f"modes is {shown(self.modes)}; it must lie between 1 and {most}")

    @cached_property
    def response(self) -> complex:
        """Tip response per unit base amplitude, complex [1]."""
        return self.oscillator.tip_response()

    @cached_property
    def flow(self) -> Array:
        """Free flow over m/f, shape (n_modes, 2, 2)."""
        return modal_flow(self._motion.omega, self._motion.decay, self.period * self.oscillator.period)

    @cached_property
    def _motion(self) -> Motion:
        return self.oscillator.motion()

    def drive_at_touch(self, reach: float, rate: float) -> tuple[float, float]:
        """Base amplitude [m] and drive time [s] at which the steady tip motion has displacement `reach` [m]
        and velocity `rate` [m/s]."""
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        # x = Z Im(H e^{i w t}), x' = Z w Re(H e^{i w t})
        turned = (rate / w + 1j * reach) / self.response
        return abs(turned), float(np.angle(turned) % (2.0 * np.pi)) / w

    def kick(self, speed: float, deviations: Array | None = None) -> Kick:
        """One collision with approach velocity `speed` [m/s], from rest or from given deviations.

        Raises
        ------
        ValueError
            If `speed` is not finite and above zero.
        NotPeriodic
            If the collision does not end within half a drive period.
        """
        require_within("speed", speed, "m/s", above=0)
        gap, n = self.oscillator.stop.gap, self.oscillator.n_modes
        w = np.zeros((n, 2)) if deviations is None else deviations
        p, r = self._motion.phi @ w
        amplitude, phase = self.drive_at_touch(gap - p, speed - r)
        motion = self.oscillator.with_amplitude(amplitude).motion()
        window = WINDOW * self.oscillator.period
        touches = 1
        while True:
            u, v = w[:, 0].copy(), w[:, 1].copy()
            record = np.empty((touches, 4 + 2 * n))
            outcome = flow_from_touch(
                motion, self.response, phase, u, v, window, np.empty((0, 0)), record
            )
            end, u, v = record[-1, 1], record[-1, 4 : 4 + n].copy(), record[-1, 4 + n :].copy()
            if outcome != FLOWN or touches > MOST_TOUCHES:
                raise NotPeriodic(
                    time=phase + window, gap=0.0, velocity=speed,
                    detail="the collision does not end within half a drive period",
                )
            order = 1 if record[-1, 3] < 0.0 else 2
            again, _time = first_crossing(motion, phase + end, u, v, window - end, order)
            if again != CROSSES:
                break
            touches += 1
        free = np.einsum("kij,kj->ki", modal_flow(motion.omega, motion.decay, end), w)
        back = modal_flow(motion.omega, motion.decay, -end)
        jump = np.einsum("kij,kj->ki", back, np.column_stack([u, v]) - free)
        if self.modes is not None:
            jump[self.modes :] = 0.0
        return Kick(speed=speed, jump=jump, touches=touches, duration=float(end))

    def orbit_of(self, kick: Kick) -> KickOrbit:
        """The orbit on which `kick` happens once in m drive periods."""
        w = np.linalg.solve(np.eye(2) - self.flow, np.einsum("kij,kj->ki", self.flow, kick.jump)[..., None])[
            ..., 0
        ]
        p, r = self._motion.phi @ w
        amplitude, phase = self.drive_at_touch(self.oscillator.stop.gap - p, kick.speed - r)
        return KickOrbit(
            period=self.period, kick=kick, deviations=w, amplitude=amplitude,
            excess=amplitude / self.oscillator.grazing_amplitude() - 1.0, phase=phase,
        )

    def orbit(self, speed: float) -> KickOrbit:
        """The orbit whose collision has approach velocity `speed` [m/s]; exact with `DelayedRestitution`.

        Raises
        ------
        ValueError
            If `speed` is not finite and above zero.
        NotPeriodic
            If the collision does not end within half a drive period, or a delay takes up the m periods.
        """
        if self._motion.law == DELAYED:
            return self.orbit_of(self._waiting_kick(speed))
        return self.orbit_of(self.kick(speed))

    def _waiting_kick(self, speed: float) -> Kick:
        """The touch of `DelayedRestitution` that repeats once in m drive periods."""
        require_within("speed", speed, "m/s", above=0)
        motion, gap = self._motion, self.oscillator.stop.gap
        restitution, _slope, delay, _slope = numbers_at(motion.table, speed)
        left = self.period * self.oscillator.period - delay
        w, angle = motion.drive, motion.drive * delay
        turn = np.array([[np.cos(angle), np.sin(angle) / w], [-w * np.sin(angle), np.cos(angle)]])
        before, after = np.array([gap, speed]), np.array([gap, -restitution * speed])
        flow = modal_flow(motion.omega, motion.decay, max(left, 0.0))[0]
        back = np.eye(2) - flow @ turn
        if left <= 0.0 or abs(np.linalg.det(back)) <= SINGULAR:
            raise NotPeriodic(
                time=delay, gap=0.0, velocity=speed,
                detail=f"no orbit of period {self.period} has a touch that waits for {delay:g} s",
            )
        steady = np.linalg.solve(back, before - flow @ after)
        met, left_with = before - steady, after - turn @ steady
        jump = modal_flow(motion.omega, motion.decay, -delay)[0] @ left_with - met
        return Kick(speed=speed, jump=jump[None] / motion.phi[0], touches=1, duration=float(delay))

    def error(self, orbit: KickOrbit) -> float:
        """Estimated error of the excess of an orbit: the change when its collision starts from its own
        ringing."""
        w = (
            orbit.deviations
            if self.modes is None
            else orbit.deviations * (np.arange(len(orbit.deviations)) < self.modes)[:, None]
        )
        return self.orbit_of(self.kick(orbit.kick.speed, w)).excess - orbit.excess

    def fold(
        self, speeds: tuple[float, float] = (1e-4, 1.0), *, kick: Callable[[float], Kick] | None = None
    ) -> KickOrbit | None:
        """The orbit of smallest amplitude, where the p_m orbit ends; None if it is not inside the range.

        Parameters
        ----------
        kick : callable, optional
            Approach velocity [m/s] to Kick, in place of the simulated collision.
        speeds : (float, float)
            Range of approach velocities over 2 pi f gap, in which the amplitude is searched on a logarithmic
            grid and then minimised by Brent's method.
        """
        from scipy.optimize import minimize_scalar  # slow to import

        low, high = require_array("speeds", speeds, "[1]", shape=(2,), words="two rising numbers above zero")
        require(0.0 < low < high, f"speeds is {shown(speeds)}; it must be two rising numbers above zero")
        unit = self._motion.drive * self.oscillator.stop.gap

        def orbit(log_speed: float) -> KickOrbit:
            speed = float(np.exp(log_speed))
            return self.orbit(speed) if kick is None else self.orbit_of(kick(speed))

        def excess(log_speed: float) -> float:
            return orbit(log_speed).excess

        grid = np.linspace(np.log(speeds[0] * unit), np.log(speeds[1] * unit), 33)
        values = [excess(x) for x in grid]
        # a contact that is soft at low speed makes A(v) start from grazing upwards: look for minima inside
        inside = [i for i in range(1, len(grid) - 1) if values[i - 1] > values[i] <= values[i + 1]]
        if not inside:
            return None
        i = min(inside, key=lambda k: values[k])
        best = minimize_scalar(
            excess, bracket=(grid[i - 1], grid[i], grid[i + 1]), method="brent", options={"xtol": 1e-9}
        )
        return orbit(best.x)
