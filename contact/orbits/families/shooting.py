"""Periodic orbits of any contact law, by shooting from touch to touch.

Unknowns are the deviations (u, v) at the first touch of the orbit and its approach velocity s.  They give the
drive (S, C) (``contact.sensitivity.touch_flow``): the tip is at the stop, y = 0, with velocity y' = s, two
linear equations.  An orbit with k touches in m drive periods satisfies

    (u, v) after m/f  =  (u, v),

2 N equations for 2 N + 1 unknowns: a curve.  One more equation picks a point of it: the approach velocity
s = v, or the amplitude S^2 + C^2 = Z^2.  With the approach velocity the curve is single-valued through
its fold and down to grazing, where Newton's method on the strobe map has nothing to hold on to (its square
root): see also arXiv:2510.16218.  The derivatives are the exact tangents of the flow, so that Newton's method
converges quadratically; floquet multipliers are the eigenvalues of d(u, v)(m/f)/d(u, v) at fixed drive.  What
happens along the curve is told in ``contact.orbits.branches.events``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam.parameters import is_whole, require, require_kind, require_within, shown
from contact.errors import NotPeriodic
from contact.orbits.branches.continuation import lowest_fold, orbits_at
from contact.orbits.branches.curve import Iterate, newton
from contact.orbits.branches.orbit_derivatives import sizes_of
from contact.orbits.families.kick import KickFamily
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.touch_flow import flown
from contact.simulation import simulate
from contact.trajectory import ImpactKind, Regime, State

Array = NDArray[np.float64]

STEEPEST = 1e10
"""Change of an unknown along the branch, over that of the approach velocity, both in units of their size,
beyond which it is rounding: then the approach velocity does not tell an orbit from its neighbours."""


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
        require(
            is_whole(self.impacts, 1),
            f"impacts is {shown(self.impacts)}; it must be a whole number, one or more",
        )
        _ = self.kicks

    def of(self, oscillator: ImpactOscillator) -> Shooting:
        """The same family of another oscillator."""
        return replace(self, oscillator=oscillator)

    def with_impacts(self, impacts: int) -> Shooting:
        """The family with another number of touches."""
        return replace(self, impacts=impacts)

    @cached_property
    def kicks(self) -> KickFamily:
        """The description by kicks, from which the search starts."""
        return KickFamily(oscillator=self.oscillator, period=self.period)

    @cached_property
    def _scale(self) -> Array:
        """Sizes of the deviations (u, v)."""
        return sizes_of(self.oscillator)

    @cached_property
    def _drive(self) -> tuple[Array, Array]:
        """K, shape (2, 2 N + 1), and k: (S, C) = K (u, v, s) + k puts the tip on the stop with velocity s."""
        phi, response = self.oscillator.model.phi, self.oscillator.tip_response()
        still, w = np.zeros(phi.size), self.oscillator.driven.angular_frequency
        steady = np.array([[response.real, response.imag], [-w * response.imag, w * response.real]])
        rows = np.array([[*-phi, *still, 0.0], [*still, *-phi, 1.0]])
        return np.linalg.solve(steady, rows), np.linalg.solve(steady, [self.oscillator.stop.gap, 0.0])

    def flow(self, start: Array) -> tuple[Array, Array, Array]:
        """End, tangent and record of the flow from a touch with (u, v, S, C) = `start`; see `flown`."""
        driven, phase = self.oscillator.with_components(*start[-2:])
        return flown(driven, self.period, phase, start[:-2], self.impacts)

    def unknowns(self, start: Array, speed: float) -> Array:
        """(u, v) in units of their sizes, and log v over 2 pi f gap, shape (2 n_modes + 1,)."""
        return np.append(start / self._scale, math.log(speed / self.oscillator.unit_speed))

    def equations(self, x: Array) -> Iterate:
        """The equations of a closed orbit at these unknowns, with the excess as the parameter."""
        (rows, offset), size, n = self._drive, x.size - 1, self.oscillator.n_modes
        speed, start = self.oscillator.unit_speed * math.exp(x[-1]), x[:-1] * self._scale
        drive, grazing = rows @ np.append(start, speed) + offset, self.oscillator.grazing_amplitude()
        end, matrix, record = self.flow(np.concatenate([start, drive]))
        driven, phase = self.oscillator.with_components(*drive)
        stretch, reached = np.append(self._scale, speed), driven.driven.amplitude
        closing = matrix[:size] @ np.vstack([np.eye(size, size + 1), rows]) - np.eye(size, size + 1)
        orbit = PeriodicOrbit(
            oscillator=driven,
            period=self.period,
            excess=reached / grazing - 1.0,
            speed=speed,
            phase=phase,
            displacement=start[:n],
            velocity=start[n:],
            record=record,
            tangent=matrix[:size, :size],
            slope=math.nan,
            residual=math.nan,
        )
        return Iterate(
            orbit,
            (end - start) / self._scale,
            closing * stretch / self._scale[:, None],
            drive @ rows * stretch / (reached * grazing),
            speed * np.eye(size + 1)[-1],
        )

    def _solve(self, x: Array, *, speed: float | None = None, excess: float = 0.0) -> PeriodicOrbit:
        """The orbit next to `x` with its approach velocity, or with this excess [1]."""

        def pick(there: Array, here: Iterate) -> tuple[float, Array]:
            if speed is not None:
                return 0.0, np.eye(x.size)[-1]
            return here.orbit.excess - excess, here.rise

        point = newton(self.equations, x, pick, self.period)
        if not abs(point.direction[-1]) * STEEPEST > 1.0:
            raise NotPeriodic(
                time=point.orbit.phase,
                gap=0.0,
                velocity=point.orbit.speed,
                detail=f"the orbits of period {self.period} do not follow from their approach velocity here",
            )
        return point.orbit if speed is None else replace(point.orbit, speed=speed)

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
        start = (near or self.kicks.orbit(speed)).deviations
        return self._solve(self.unknowns(start, speed), speed=speed)

    def at_excess(self, excess: float, near: PeriodicOrbit) -> PeriodicOrbit:
        """The orbit at F/F_g - 1 = `excess` that is next to `near`."""
        require_within("excess", excess, "[1]", above=-1)
        require_kind("near", near, PeriodicOrbit, "a PeriodicOrbit")
        return self._solve(self.unknowns(near.deviations, near.speed), excess=excess)

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
        i, met = int(np.flatnonzero(hits)[0]), run.impacts
        start = self.unknowns(met.deviations_start[i].ravel(), met.approach[i])
        return self._solve(start, excess=self.oscillator.excess)

    def orbit(self, speed: float) -> PeriodicOrbit:
        """`at_speed`, from the kick description."""
        return self.at_speed(speed)

    def orbits(self, excess: float) -> tuple[PeriodicOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising speed (``continuation.orbits_at``)."""
        return orbits_at(self, excess)

    def fold(self) -> PeriodicOrbit | None:
        """The orbit of least amplitude at which two meet; None if the branch has none."""
        return lowest_fold(self)[0]
