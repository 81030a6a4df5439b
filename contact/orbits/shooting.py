"""Periodic orbits of any contact law, by shooting from touch to touch.

Unknowns are the deviations (u, v) at the first touch of the orbit and its approach velocity s.  They give the
drive (S, C) (``contact.touch_flow``): the tip is at the stop, y = 0, with velocity y' = s, two linear
equations.  An orbit with k touches in m drive periods satisfies

    (u, v) after m/f  =  (u, v),

2 N equations for 2 N + 1 unknowns: a curve.  One more equation picks a point of it: the approach velocity
s = v, or the amplitude S^2 + C^2 = Z^2.  With the approach velocity the curve is single-valued through
its fold and down to grazing, where Newton's method on the strobe map has nothing to hold on to (its square
root): see also arXiv:2510.16218.  The derivatives are the exact tangents of the flow, so that Newton's method
converges quadratically; floquet multipliers are the eigenvalues of d(u, v)(m/f)/d(u, v) at fixed drive.  What
happens along the curve is told in ``contact.orbits.events``.
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

STEEPEST = 1e10
"""Change of an unknown with the approach velocity, both in units of their scale, beyond which it is rounding:
then the approach velocity does not tell an orbit from its neighbours."""


class _Iterate(NamedTuple):
    """An iterate of Newton's method: the unknowns, the drive (S, C) that goes with them, the tangent of the
    flow, the record of its touches, the scaled residual and Jacobian of the equations, and its error: the
    largest residual."""

    unknown: Array
    drive: Array
    matrix: Array
    record: Array
    residual: Array
    jacobian: Array
    error: float


def beside(orbit: TouchOrbit) -> Array:
    """Unknowns of an orbit, to start a neighbouring one from."""
    return np.append(orbit.deviations, orbit.speed)


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
        """Sizes of the unknowns (u, v, s)."""
        model, gap = self.oscillator.model, self.oscillator.stop.gap
        size = gap / np.abs(model.phi).max()
        speed = np.maximum(model.omega, self.oscillator.driven.angular_frequency)
        return np.concatenate([np.full(speed.size, size), size * speed, [self.oscillator.unit_speed]])

    @cached_property
    def _drive(self) -> tuple[Array, Array]:
        """K, shape (2, 2 N + 1), and k: (S, C) = K (u, v, s) + k puts the tip on the stop with velocity s."""
        phi, response = self.oscillator.model.phi, self.oscillator.tip_response()
        still, w = np.zeros(phi.size), self.oscillator.driven.angular_frequency
        steady = np.array([[response.real, response.imag], [-w * response.imag, w * response.real]])
        rows = np.array([[*-phi, *still, 0.0], [*still, *-phi, 1.0]])
        return np.linalg.solve(steady, rows), np.linalg.solve(steady, [self.oscillator.stop.gap, 0.0])

    def _driven(self, drive: Array) -> tuple[ImpactOscillator, float]:
        """The oscillator with the amplitude of `drive` = (S, C), and the drive time of the touch."""
        angle, w = math.atan2(*drive), self.oscillator.driven.angular_frequency
        return self.oscillator.with_amplitude(math.hypot(*drive)), angle % (2.0 * math.pi) / w

    def flow(self, start: Array) -> tuple[Array, Array, Array]:
        """End, tangent and record of the flow from a touch with (u, v, S, C) = `start`; see `flown`."""
        driven, phase = self._driven(start[-2:])
        return flown(driven, self.period, phase, start[:-2], self.impacts)

    def _iterate(self, unknown: Array, speed: float | None, amplitude: float | None) -> _Iterate:
        """The equations at `unknown`: closed, and with this speed or this amplitude."""
        (rows, offset), size = self._drive, unknown.size - 1
        drive = rows @ unknown + offset
        reached = math.hypot(*drive)
        end, matrix, record = self.flow(np.concatenate([unknown[:-1], drive]))
        picked, gradient, unit = unknown[-1] - (speed or 0.0), np.eye(size + 1)[-1], self._scale[-1]
        if amplitude is not None:
            picked, gradient, unit = reached - amplitude, drive @ rows / reached, self.oscillator.stop.gap
        closing = matrix[:size] @ np.vstack([np.eye(size, size + 1), rows]) - np.eye(size, size + 1)
        weight = np.append(self._scale[:-1], unit)
        residual = np.append(end - unknown[:-1], picked) / weight
        jacobian = np.vstack([closing, gradient]) * self._scale / weight[:, None]
        return _Iterate(unknown, drive, matrix, record, residual, jacobian, float(np.max(np.abs(residual))))

    def _solve(
        self, guess: Array, *, speed: float | None = None, amplitude: float | None = None
    ) -> PeriodicOrbit:
        """The orbit next to `guess` with this approach velocity [m/s] or this base amplitude [m]."""
        unknown, found = guess, None
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
            if speed is not None:
                unknown[-1] = speed
            if not np.all(np.isfinite(unknown)):
                break
        raise NotPeriodic(
            time=0.0, gap=0.0, velocity=here.record[0, 2],
            detail=f"Newton's method found no orbit of period {self.period} (residual {here.error:.1e})",
        )

    def _orbit(self, found: _Iterate) -> PeriodicOrbit:
        """The orbit at an iterate, with the slope of the curve of those that close there."""
        n, unknown, closing = self.oscillator.n_modes, found.unknown, found.jacobian[:-1]
        driven, phase = self._driven(found.drive)
        amplitude, grazing = driven.driven.amplitude, self.oscillator.grazing_amplitude()
        try:
            turn = np.append(np.linalg.solve(closing[:, :-1], -closing[:, -1]), 1.0)
        except np.linalg.LinAlgError:
            turn = np.full(unknown.size, np.inf)
        if not np.max(np.abs(turn)) < STEEPEST:
            raise NotPeriodic(
                time=phase, gap=0.0, velocity=float(unknown[-1]),
                detail=f"the orbits of period {self.period} do not follow from their approach velocity here",
            )
        change = self._drive[0] @ (self._scale * turn) / self._scale[-1]
        return PeriodicOrbit(
            oscillator=driven, period=self.period, excess=amplitude / grazing - 1.0,
            speed=float(unknown[-1]), phase=phase, displacement=unknown[:n].copy(),
            velocity=unknown[n : 2 * n].copy(), record=found.record, tangent=found.matrix[: 2 * n, : 2 * n],
            slope=float(found.drive @ change) / amplitude / grazing, residual=found.error,
        )  # fmt: skip

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
        return self._solve(beside(near or self.kicks.orbit(speed)), speed=speed)

    def at_excess(self, excess: float, near: PeriodicOrbit) -> PeriodicOrbit:
        """The orbit at F/F_g - 1 = `excess` that is next to `near`."""
        require_within("excess", excess, "[1]", above=-1)
        require_kind("near", near, PeriodicOrbit, "a PeriodicOrbit")
        amplitude = (1.0 + excess) * self.oscillator.grazing_amplitude()
        return self._solve(beside(near), amplitude=amplitude)

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
        motion, met = self.oscillator.motion(), run.impacts
        start = deviations(motion, met.start[i], met.displacement_start[i], met.velocity_start[i])
        return self._solve(np.append(start, met.approach[i]), amplitude=self.oscillator.driven.amplitude)

    def orbit(self, speed: float) -> PeriodicOrbit:
        """`at_speed`, from the kick description."""
        return self.at_speed(speed)

    def orbits(self, excess: float) -> tuple[PeriodicOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising speed (``continuation.orbits_at``)."""
        return orbits_at(self, excess)

    def fold(self) -> PeriodicOrbit | None:
        """The orbit of least amplitude at which two meet (``continuation.fold_of``)."""
        return fold_of(self)
