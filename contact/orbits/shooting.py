"""Periodic orbits of any contact law, by shooting from touch to touch.

Unknowns are the state at the first touch of the orbit and the drive: e = (u, v, S, C)
(``contact.touch_flow``). An orbit with k touches in m drive periods satisfies

    (u, v) after m/f  =  (u, v),      y(e) = 0 (the tip is at the stop),

2 N + 1 equations for 2 N + 2 unknowns: a curve.  One more equation picks a point of it: the approach velocity
y'(e) = v, or the amplitude S^2 + C^2 = Z^2.  With the approach velocity the curve is single-valued through
its fold and down to grazing, where Newton's method on the strobe map has nothing to hold on to (its square
root): see also arXiv:2510.16218.  The derivatives are the exact tangents of the flow, so that Newton's method
converges quadratically; floquet multipliers are the eigenvalues of d(u, v)(m/f)/d(u, v) at fixed drive, and

    dZ/dv = 0            at a fold,
    det(M + I) = 0       at a period doubling,
    a further touch      at a grazing (bisection on the certified flights).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam.parameters import is_whole, require_kind, require_within, shown
from contact.errors import NotPeriodic
from contact.flight.crossing import CROSSES, FREE, first_crossing
from contact.flight.modal_flow import steady_motion
from contact.flight.motion import Motion
from contact.orbits.kick import KickFamily, KickOrbit
from contact.orbits.saltation import sorted_multipliers
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.touch_flow import FLOWN, flow_from_touch
from contact.trajectory import ImpactKind, Regime, State

__all__ = ["PeriodicOrbit", "Shooting"]

Array = NDArray[np.float64]

MOST_ITERATIONS = 25
"""Of Newton's method: from a kick's orbit it takes three to six."""

LONGEST_STEP = 0.3
"""Longest change of an unknown in one iteration, in units of its scale (the gap): larger ones are
shortened."""

CONVERGED = 1e-12
"""Largest residual in units of gap and 2 pi f gap; rounding of the flow over m periods is about 1e-14."""

ROUNDED = 1e-9
"""Residual below which iterates that no longer improve count as an orbit: rounding, 1e-16, times the largest
multiplier, which grows as 1/v towards grazing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PeriodicOrbit:
    """A periodic orbit with impacts.

    Parameters
    ----------
    period : int
        m, in drive periods.
    impacts : int
        Touches in one period.
    amplitude : float
        Base amplitude [m].
    excess : float
        F/F_g - 1.
    speed : float
        Approach velocity of the first touch [m/s].
    approach : ndarray, shape (impacts,)
        Approach velocities of all touches [m/s].
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

    period: int
    impacts: int
    amplitude: float
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
    oscillator: ImpactOscillator = field(repr=False)

    @property
    def stable(self) -> bool:
        """All multipliers inside the unit circle."""
        return bool(np.abs(self.multipliers[0]) < 1.0)

    def state(self) -> State:
        """The physical state just before the first touch."""
        motion = self.oscillator.motion()
        q, q_rate = steady_motion(motion, np.array([self.phase]))
        return State(
            displacement=self.displacement + q[0], velocity=self.velocity + q_rate[0], time=self.phase
        )

    def strobe_state(self) -> State:
        """The state at the strobe that follows the first touch."""
        motion = self.oscillator.motion()
        before = self.state()
        run = simulate(self.oscillator, before, duration=motion.period - self.phase % motion.period)
        return run.end


@dataclass(frozen=True, kw_only=True, eq=False)
class Shooting:
    """The family of orbits with `impacts` touches in `period` drive periods.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Its drive amplitude does not matter.
    period, impacts : int
    """

    oscillator: ImpactOscillator
    period: int
    impacts: int = 1

    def __post_init__(self) -> None:
        require_kind("oscillator", self.oscillator, ImpactOscillator, "an ImpactOscillator")
        if not is_whole(self.impacts, 1):
            raise ValueError(f"impacts is {shown(self.impacts)}; it must be a whole number, one or more")
        _ = self.kicks

    @cached_property
    def kicks(self) -> KickFamily:
        """The description by kicks, from which the search starts."""
        return KickFamily(oscillator=self.oscillator, period=self.period)

    @property
    def _scale(self) -> Array:
        """Sizes of the unknowns (u, v, S, C)."""
        model, gap = self.oscillator.model, self.oscillator.stop.gap
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        size = gap / np.abs(model.phi).max()
        speed = np.maximum(model.omega, w)
        return np.concatenate([np.full(model.omega.size, size), size * speed, [gap, gap]])

    def _driven(self, unknown: Array) -> tuple[ImpactOscillator, float, float]:
        """The oscillator at the amplitude of `unknown`, that amplitude and the drive time of the touch."""
        amplitude, angle = float(np.hypot(*unknown[-2:])), float(np.arctan2(unknown[-2], unknown[-1]))
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        return self.oscillator.with_amplitude(amplitude), amplitude, angle % (2.0 * np.pi) / w

    def flow(self, unknown: Array, *, tangent: bool = True) -> tuple[Array, Array, Array]:
        """End of the flow (u, v), its tangent (2 N + 2, 2 N + 2) and the record of the touches.

        Raises
        ------
        NotPeriodic
            If the motion has fewer touches, or a contact does not end.
        """
        n = self.oscillator.n_modes
        driven, _amplitude, phase = self._driven(unknown)
        u, v = unknown[:n].copy(), unknown[n : 2 * n].copy()
        matrix = np.eye(2 * n + 2) if tangent else np.empty((0, 0))
        record = np.empty((self.impacts, 4 + 2 * n))
        length = self.period * self.oscillator.period
        outcome = flow_from_touch(
            driven.motion(), self.kicks.response, phase, u, v, length, matrix, record
        )
        if outcome != FLOWN:
            raise NotPeriodic(
                time=phase, gap=0.0, velocity=float(record[0, 2]),
                detail=f"an orbit of period {self.period} with {self.impacts} touches was lost",
            )
        return np.concatenate([u, v]), matrix, record

    def _tip_rows(self) -> tuple[Array, Array]:
        """Gradients of tip displacement and tip velocity in (u, v, S, C)."""
        n, response = self.oscillator.n_modes, self.kicks.response
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        phi = self.oscillator.model.phi
        place, rate = np.zeros(2 * n + 2), np.zeros(2 * n + 2)
        place[:n], rate[n : 2 * n] = phi, phi
        place[-2:] = response.real, response.imag
        rate[-2:] = -w * response.imag, w * response.real
        return place, rate

    def _at_the_stop(self, unknown: Array, speed: float) -> Array:
        """The same deviations with the drive that puts the tip on the stop with approach velocity `speed`."""
        n = self.oscillator.n_modes
        phi = self.oscillator.model.phi
        p, r = float(phi @ unknown[:n]), float(phi @ unknown[n : 2 * n])
        amplitude, phase = self.kicks.drive_at_touch(self.oscillator.stop.gap - p, speed - r)
        angle = self.oscillator.drive.angular_frequency * phase  # type: ignore[union-attr]
        return np.concatenate([unknown[: 2 * n], amplitude * np.array([np.sin(angle), np.cos(angle)])])

    def _solve(self, guess: Array, *, speed: float | None, amplitude: float | None) -> PeriodicOrbit:
        n, gap = self.oscillator.n_modes, self.oscillator.stop.gap
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        place, rate = self._tip_rows()
        scale, unknown = self._scale, guess.copy()
        if speed is not None and abs(place @ guess - gap) > 1e-9 * gap:
            unknown = self._at_the_stop(guess, speed)  # a neighbour at another frequency misses the stop
        weight = np.concatenate([scale[: 2 * n], [gap, w * gap if amplitude is None else gap]])
        found: tuple[Array, Array, Array, Array, Array, float] | None = None
        for iteration in range(MOST_ITERATIONS):
            end, matrix, record = self.flow(unknown)
            residual = np.empty(2 * n + 2)
            residual[: 2 * n] = end - unknown[: 2 * n]
            residual[2 * n] = place @ unknown - gap
            jacobian = np.empty((2 * n + 2, 2 * n + 2))
            jacobian[: 2 * n] = matrix[: 2 * n]
            jacobian[: 2 * n, : 2 * n] -= np.eye(2 * n)
            jacobian[2 * n] = place
            if speed is not None:
                residual[2 * n + 1] = rate @ unknown - speed
                jacobian[2 * n + 1] = rate
            elif amplitude is not None:
                size = np.hypot(*unknown[-2:])
                residual[2 * n + 1] = size - amplitude
                jacobian[2 * n + 1] = 0.0
                jacobian[2 * n + 1, -2:] = unknown[-2:] / size
            error = float(np.max(np.abs(residual / weight)))
            scaled = jacobian * scale / weight[:, None]
            # one step in any case: near grazing a neighbour can lie within the tolerance, and is another
            # orbit
            if iteration > 0:
                if found is None or error < found[-1]:
                    found = unknown, matrix, record, scaled, weight, error
                    if error < CONVERGED:
                        return self._orbit(*found)
                elif found[-1] < ROUNDED:
                    return self._orbit(*found)
            try:
                change = np.linalg.solve(scaled, residual / weight)
            except np.linalg.LinAlgError:
                break
            longest = float(np.max(np.abs(change)))
            unknown = unknown - scale * change * min(1.0, LONGEST_STEP / max(longest, 1e-300))
            if speed is not None and longest > LONGEST_STEP:
                unknown = self._at_the_stop(unknown, speed)
            if not np.all(np.isfinite(unknown)):
                break
        raise NotPeriodic(
            time=0.0,
            gap=0.0,
            velocity=record[0, 2],
            detail=(
                f"Newton's method did not converge to an orbit of period {self.period} (residual {error:.1e})"
            ),
        )

    def _orbit(
        self, unknown: Array, matrix: Array, record: Array, scaled: Array, weight: Array, error: float
    ) -> PeriodicOrbit:
        n = self.oscillator.n_modes
        driven, amplitude, phase = self._driven(unknown)
        _place, rate = self._tip_rows()
        grazing = self.oscillator.grazing_amplitude()
        # the tangent of the curve: null vector of the first 2 N + 1 equations, unit change of the approach
        # velocity
        closing = scaled.copy()
        unit = self._scale[-1] * self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        closing[2 * n + 1] = rate * self._scale / unit
        right = np.zeros(2 * n + 2)
        right[2 * n + 1] = 1.0 / unit
        change = self._scale * np.linalg.solve(closing, right)
        return PeriodicOrbit(
            period=self.period,
            impacts=self.impacts,
            amplitude=amplitude,
            excess=amplitude / grazing - 1.0,
            speed=float(rate @ unknown),
            approach=record[:, 2].copy(),
            phase=phase,
            displacement=unknown[:n].copy(),
            velocity=unknown[n : 2 * n].copy(),
            multipliers=sorted_multipliers(matrix[: 2 * n, : 2 * n]),
            slope=float(unknown[-2:] @ change[-2:]) / amplitude / grazing,
            residual=error,
            admissible=self._admissible(driven.motion(), phase, record, error),
            oscillator=driven,
        )

    def _admissible(self, motion: Motion, phase: float, record: Array, error: float) -> bool:
        """Whether the last flight is free of the stop up to the touch that closes the orbit (certified)."""
        n = self.oscillator.n_modes
        last, duration = record[-1], self.period * self.oscillator.period
        u, v = last[4 : 4 + n].copy(), last[4 + n :].copy()
        start, length = phase + last[1], duration - last[1]
        order = 1 if last[3] < 0.0 else 2
        outcome, s = first_crossing(motion, start, u, v, length * (1 + 1e-9), order)
        # the touch that closes the orbit is met at `length`, give or take the residual
        slack = 1e-6 * self.oscillator.period + 4.0 * error * motion.gap / record[0, 2]
        return outcome == FREE or bool(outcome == CROSSES and abs(s - length) <= slack)

    def guess(self, orbit: KickOrbit) -> Array:
        """Unknowns from an orbit of the kick description."""
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        drive = orbit.amplitude * np.array([np.sin(w * orbit.phase), np.cos(w * orbit.phase)])
        return np.concatenate([orbit.deviations[:, 0], orbit.deviations[:, 1], drive])

    def unknowns(self, orbit: PeriodicOrbit) -> Array:
        """Unknowns of an orbit, to start a neighbouring one from."""
        w = self.oscillator.drive.angular_frequency  # type: ignore[union-attr]
        drive = orbit.amplitude * np.array([np.sin(w * orbit.phase), np.cos(w * orbit.phase)])
        return np.concatenate([orbit.displacement, orbit.velocity, drive])

    def at_speed(self, speed: float, near: PeriodicOrbit | None = None) -> PeriodicOrbit:
        """The orbit whose first touch has approach velocity `speed` [m/s].

        Parameters
        ----------
        speed : float
        near : PeriodicOrbit, optional
            A neighbour to start from; otherwise the kick description is used.

        Raises
        ------
        NotPeriodic
            If there is none, or Newton's method does not find it.
        """
        require_within("speed", speed, "m/s", above=0)
        require_kind("near", near, (PeriodicOrbit, type(None)), "a PeriodicOrbit or None")
        start = self.guess(self.kicks.orbit(speed)) if near is None else self.unknowns(near)
        return self._solve(start, speed=speed, amplitude=None)

    def at_excess(self, excess: float, near: PeriodicOrbit) -> PeriodicOrbit:
        """The orbit at F/F_g - 1 = `excess` that is next to `near`."""
        require_within("excess", excess, "[1]", above=-1)
        require_kind("near", near, PeriodicOrbit, "a PeriodicOrbit")
        amplitude = (1.0 + excess) * self.oscillator.grazing_amplitude()
        return self._solve(self.unknowns(near), speed=None, amplitude=amplitude)

    def from_state(self, state: State) -> PeriodicOrbit:
        """The orbit on which a simulated motion has settled: its first touch from `state` starts the
        search."""
        require_kind("state", state, State, "a State")
        run = simulate(self.oscillator, state, periods=self.period + 1)
        hits = run.impacts.kind == ImpactKind.IMPACT
        hits[:1] &= state.regime == Regime.OUTSIDE  # a contact under way began with a touch that is not known
        if not np.any(hits):
            raise NotPeriodic(
                time=state.time, gap=0.0, velocity=0.0, detail="the motion has no impact to start from"
            )
        i = int(np.flatnonzero(hits)[0])
        motion = self.oscillator.motion()
        clock = float(run.impacts.start[i] % motion.period)
        q, q_rate = steady_motion(motion, np.array([clock]))
        amplitude = self.oscillator.drive.amplitude  # type: ignore[union-attr]
        angle = motion.drive * clock
        unknown = np.concatenate(
            [
                run.impacts.displacement_start[i] - q[0],
                run.impacts.velocity_start[i] - q_rate[0],
                amplitude * np.array([np.sin(angle), np.cos(angle)]),
            ]
        )
        return self._solve(unknown, speed=None, amplitude=amplitude)
