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

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from beam.parameters import is_whole, require, require_kind, require_within, shown
from contact.errors import NotPeriodic
from contact.orbits.continuation import fold_of, orbits_at
from contact.orbits.family import TouchOrbit, flown
from contact.orbits.kick import KickFamily
from contact.orbits.periodic_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import ImpactKind, Regime, State
from contact.virtual_motion import deviations

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

OFF_THE_STOP = 1e-9
"""Distance of a first guess from the stop, over the gap, beyond which the drive is set anew."""


class _Iterate(NamedTuple):
    """An iterate of Newton's method: the unknowns, the tangent of their flow, the record of its touches, the
    scaled residual and Jacobian of the equations, and the largest residual."""

    unknown: Array
    matrix: Array
    record: Array
    residual: Array
    jacobian: Array
    error: float


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
        require(is_whole(self.impacts, 1),
                f"impacts is {shown(self.impacts)}; it must be a whole number, one or more")  # fmt: skip
        _ = self.kicks

    def of(self, oscillator: ImpactOscillator) -> Shooting:
        """The same family of another oscillator."""
        return replace(self, oscillator=oscillator)

    @cached_property
    def kicks(self) -> KickFamily:
        """The description by kicks, from which the search starts."""
        return KickFamily(oscillator=self.oscillator, period=self.period)

    @cached_property
    def _scale(self) -> Array:
        """Sizes of the unknowns (u, v, S, C)."""
        model, gap = self.oscillator.model, self.oscillator.stop.gap
        size = gap / np.abs(model.phi).max()
        speed = np.maximum(model.omega, self.oscillator.driven.angular_frequency)
        return np.concatenate([np.full(model.omega.size, size), size * speed, [gap, gap]])

    @cached_property
    def _tip_rows(self) -> tuple[Array, Array]:
        """Gradients of tip displacement and tip velocity in (u, v, S, C)."""
        n, response, phi = self.oscillator.n_modes, self.oscillator.tip_response(), self.oscillator.model.phi
        w = self.oscillator.driven.angular_frequency
        place, rate = np.zeros(2 * n + 2), np.zeros(2 * n + 2)
        place[:n], rate[n : 2 * n] = phi, phi
        place[-2:] = response.real, response.imag
        rate[-2:] = -w * response.imag, w * response.real
        return place, rate

    def _unknown(self, deviations: Array, amplitude: float, phase: float) -> Array:
        """The unknowns of a touch: deviations (u, v), shape (2 n_modes,), base amplitude and drive time."""
        angle = self.oscillator.driven.angular_frequency * phase
        return np.concatenate([deviations, amplitude * np.array([math.sin(angle), math.cos(angle)])])

    def _at_the_stop(self, unknown: Array, speed: float) -> Array:
        """The same deviations with the drive that puts the tip on the stop with approach velocity `speed`."""
        deviations, (place, rate) = unknown[:-2], self._tip_rows
        p, r = float(place[:-2] @ deviations), float(rate[:-2] @ deviations)
        return self._unknown(deviations, *self.oscillator.drive_at(self.oscillator.stop.gap - p, speed - r))

    def _driven(self, unknown: Array) -> tuple[ImpactOscillator, float]:
        """The oscillator at the amplitude of `unknown`, and the drive time of the touch."""
        amplitude, angle = math.hypot(*unknown[-2:]), math.atan2(*unknown[-2:])
        w = self.oscillator.driven.angular_frequency
        return self.oscillator.with_amplitude(amplitude), angle % (2.0 * math.pi) / w

    def flow(self, unknown: Array) -> tuple[Array, Array, Array]:
        """End, tangent and record of the flow from a touch with these unknowns, as those of `flown`."""
        driven, phase = self._driven(unknown)
        return flown(driven, self.period, phase, unknown[:-2], self.impacts)

    def _iterate(self, unknown: Array, speed: float | None, amplitude: float | None) -> _Iterate:
        """The equations at `unknown`: closed, at the stop, and with this speed or this amplitude."""
        place, rate = self._tip_rows
        gap, size = self.oscillator.stop.gap, math.hypot(*unknown[-2:])
        end, matrix, record = self.flow(unknown)
        if speed is not None:
            picked, gradient, unit = float(rate @ unknown) - speed, rate, self.oscillator.unit_speed
        else:
            picked, gradient, unit = size - (amplitude or 0.0), np.zeros(unknown.size), gap
            gradient[-2:] = unknown[-2:] / size
        jacobian = matrix - np.eye(unknown.size)
        jacobian[-2:] = place, gradient
        weight = np.concatenate([self._scale[:-2], [gap, unit]])
        residual = np.concatenate([end - unknown[:-2], [place @ unknown - gap, picked]]) / weight
        scaled = jacobian * self._scale / weight[:, None]
        return _Iterate(unknown, matrix, record, residual, scaled, float(np.max(np.abs(residual))))

    def _solve(
        self, guess: Array, *, speed: float | None = None, amplitude: float | None = None
    ) -> PeriodicOrbit:
        """The orbit next to `guess` with this approach velocity [m/s] or this base amplitude [m]."""
        gap, unknown, found = self.oscillator.stop.gap, guess, None
        if speed is not None and abs(self._tip_rows[0] @ guess - gap) > OFF_THE_STOP * gap:
            unknown = self._at_the_stop(guess, speed)  # a neighbour at another frequency misses the stop
        for iteration in range(MOST_ITERATIONS):
            here = self._iterate(unknown, speed, amplitude)
            # one step in any case: near grazing a neighbour can lie within the tolerance, and is another
            # orbit
            if iteration > 0:
                found = here if found is None or here.error < found.error else found
                if found.error < (CONVERGED if found is here else ROUNDED):
                    return self._orbit(found)
            try:
                change = np.linalg.solve(here.jacobian, here.residual)
            except np.linalg.LinAlgError:
                break
            longest = float(np.max(np.abs(change)))
            unknown = unknown - self._scale * change * min(1.0, LONGEST_STEP / max(longest, 1e-300))
            if speed is not None and longest > LONGEST_STEP:
                unknown = self._at_the_stop(unknown, speed)
            if not np.all(np.isfinite(unknown)):
                break
        raise NotPeriodic(
            time=0.0, gap=0.0, velocity=here.record[0, 2],
            detail=f"Newton's method found no orbit of period {self.period} (residual {here.error:.1e})",
        )

    def _orbit(self, found: _Iterate) -> PeriodicOrbit:
        n, unknown, rate = self.oscillator.n_modes, found.unknown, self._tip_rows[1]
        driven, phase = self._driven(unknown)
        amplitude, grazing = driven.driven.amplitude, self.oscillator.grazing_amplitude()
        # the tangent of the curve: null vector of the first 2 N + 1 equations, unit change of the approach
        # velocity
        closing, right, unit = found.jacobian.copy(), np.zeros(2 * n + 2), self.oscillator.unit_speed
        closing[-1], right[-1] = rate * self._scale / unit, 1.0 / unit
        try:
            change = self._scale * np.linalg.solve(closing, right)
        except np.linalg.LinAlgError as error:
            raise NotPeriodic(
                time=phase, gap=0.0, velocity=float(rate @ unknown),
                detail=f"the orbits of period {self.period} do not follow from their approach velocity here",
            ) from error
        return PeriodicOrbit(
            oscillator=driven, period=self.period, excess=amplitude / grazing - 1.0,
            speed=float(rate @ unknown), phase=phase, displacement=unknown[:n].copy(),
            velocity=unknown[n : 2 * n].copy(), record=found.record, tangent=found.matrix[: 2 * n, : 2 * n],
            slope=float(unknown[-2:] @ change[-2:]) / amplitude / grazing, residual=found.error,
        )  # fmt: skip

    def _beside(self, orbit: TouchOrbit) -> Array:
        """Unknowns of an orbit, to start a neighbouring one from."""
        return self._unknown(orbit.deviations, orbit.amplitude, orbit.phase)

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
        return self._solve(self._beside(near or self.kicks.orbit(speed)), speed=speed)

    def at_excess(self, excess: float, near: PeriodicOrbit) -> PeriodicOrbit:
        """The orbit at F/F_g - 1 = `excess` that is next to `near`."""
        require_within("excess", excess, "[1]", above=-1)
        require_kind("near", near, PeriodicOrbit, "a PeriodicOrbit")
        amplitude = (1.0 + excess) * self.oscillator.grazing_amplitude()
        return self._solve(self._beside(near), amplitude=amplitude)

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
        phase, met = float(run.impacts.start[i] % self.oscillator.period), run.impacts
        motion, amplitude = self.oscillator.motion(), self.oscillator.driven.amplitude
        start = deviations(motion, phase, met.displacement_start[i], met.velocity_start[i]).ravel()
        return self._solve(self._unknown(start, amplitude, phase), amplitude=amplitude)

    def orbit(self, speed: float) -> PeriodicOrbit:
        """`at_speed`, from the kick description."""
        return self.at_speed(speed)

    def orbits(self, excess: float) -> tuple[PeriodicOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising speed (``continuation.orbits_at``)."""
        return orbits_at(self, excess)

    def fold(self) -> PeriodicOrbit | None:
        """The orbit of least amplitude at which two meet (``continuation.fold_of``)."""
        return fold_of(self)
