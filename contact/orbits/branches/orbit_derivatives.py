r"""How a periodic orbit changes with the numbers of its oscillator.

An orbit of m drive periods starts at its first touch from z = (u, v, S, C)
(``contact.orbits.families.shooting``): with F the flow over m/f, y and y' tip displacement over the stop and
velocity,

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0,      S^2 + C^2 = Z^2   or   y'(z, p) = s.

All this is smooth in z and in every parameter p, through the fold and down to grazing, so that dz/dp is one
linear solve, with the tangents of one more flow (``contact.flight.variation``).  At given amplitude Z it is
that of the orbit one observes; it ends at the fold.  At given approach speed s it goes on there, and the
derivative of the excess, which does not depend on s at a fold, is that of the fold itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require_kind
from contact.errors import NoDerivative
from contact.flight.modal_flow import steady_motion
from contact.flight.variation import all_tip_changes
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Change, Changes
from contact.sensitivity.replay import Retraced, pace_of_deviations
from contact.sensitivity.touch_flow import flown
from contact.simulation import simulate

Array = NDArray[np.float64]

STEEPEST = 1e10
"""Change of the start, in units of its size, per change of the equations, beyond which it is rounding: there
is no derivative at a fold at given amplitude."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitDerivatives:
    """Derivatives of a periodic orbit, per unit of each of P parameters.

    Parameters
    ----------
    orbit : PeriodicOrbit
    changes : Changes
    start : ndarray, shape (2 n_modes + 2, P)
        Those of (u, v, S, C) at the first touch.
    """

    orbit: PeriodicOrbit
    changes: Changes = field(repr=False)
    start: Array = field(repr=False)

    @property
    def amplitude(self) -> Array:
        """Those of the base amplitude, shape (P,) [m]."""
        return np.asarray(drive_of(self.orbit) @ self.start[-2:] / self.orbit.amplitude)

    @property
    def excess(self) -> Array:
        """Those of F/F_g - 1, shape (P,)."""
        grazing, level = self.orbit.oscillator.grazing_amplitude(), 1.0 + self.orbit.excess
        return np.asarray((self.amplitude - level * self.changes.grazing_amplitude) / grazing)

    @property
    def time(self) -> Array:
        """Those of the drive time of the first touch, shape (P,) [s]."""
        (sine, cosine), w = drive_of(self.orbit), self.orbit.oscillator.driven.angular_frequency
        turned = (cosine * self.start[-2] - sine * self.start[-1]) / self.orbit.amplitude**2
        return np.asarray((turned - self.orbit.phase * self.changes.pace) / w)

    @property
    def speed(self) -> Array:
        """Those of the approach speed of the first touch, shape (P,) [m/s]."""
        rate = at_touch(self.orbit, self.changes)[1]
        return np.asarray(rate[: len(self.start)] @ self.start + rate[len(self.start) :])

    @cached_property
    def _strobed(self) -> tuple[Array, Array]:
        orbit, changes, n = self.orbit, self.changes, self.orbit.oscillator.n_modes
        if not orbit.admissible:
            raise NoDerivative(
                time=orbit.phase,
                gap=0.0,
                velocity=orbit.speed,
                detail="the orbit meets the stop at another time than its touches",
            )
        state, period = orbit.state(), orbit.oscillator.period
        run = simulate(orbit.oscillator, state, periods=orbit.period)
        traced, size = Retraced(changes, run, state), 2 * n + 2
        traced.tangent = np.eye(size, size + len(changes.changes))
        found = np.empty((orbit.period, 2 * n, len(changes.changes)))
        for j in range(1, orbit.period + 1):
            tangent = traced.to(j * period)[: 2 * n]
            q = np.concatenate([run.strobe_displacement[j - 1], run.strobe_velocity[j - 1]])
            pace = pace_of_deviations(orbit.oscillator, q, bool(traced.touching(j * period)))
            moved = tangent[:, :size] @ self.start + tangent[:, size:]
            moved += np.multiply.outer(pace, j * changes.of_period - self.time)
            found[j - 1] = moved + changes.steady(0.0)
        return np.hstack([run.strobe_displacement, run.strobe_velocity]), found

    @property
    def strobes(self) -> Array:
        """The states (q, q') at the m strobes that follow the first touch, shape (m, 2 n_modes)."""
        return self._strobed[0]

    @property
    def strobes_changed(self) -> Array:
        """Their derivatives, shape (m, 2 n_modes, P).

        NoDerivative is raised where the orbit touches the stop besides, as one does that grazes.
        """
        return self._strobed[1]


def drive_of(orbit: PeriodicOrbit) -> Array:
    """(S, C) at the first touch [m]."""
    return orbit.oscillator.driven.components(orbit.phase)


def at_touch(orbit: PeriodicOrbit, changes: Changes) -> tuple[Array, Array]:
    """The changes of y and y' at the first touch with (u, v, S, C) and the parameters."""
    size = orbit.deviations.size + 2
    whole = np.eye(size, size + len(changes.changes))
    found: tuple[Array, Array] = all_tip_changes(
        changes.variation, whole, orbit.displacement, orbit.velocity, orbit.phase
    )
    return found


def equations_of(orbit: PeriodicOrbit, changes: Changes) -> tuple[Array, Array, Array, Array]:
    """(u, v) at the end of the flow from the touch of `orbit`, which need not close; its record, its
    monodromy matrix; and the derivatives of the equations with z and the parameters.

    Their rows are those of (u, v) closing, of y, of the amplitude and of y', shape (2 n_modes + 3, .).
    """
    n = orbit.deviations.size
    end, flow, record = flown(
        orbit.oscillator, orbit.period, orbit.phase, orbit.deviations, orbit.impacts, changes.variation
    )
    reach, rate = at_touch(orbit, changes)
    closing = flow[:n] - np.eye(n, flow.shape[1])
    q = orbit.deviations + np.concatenate(steady_motion(changes.variation.motion, orbit.phase))
    pace = pace_of_deviations(orbit.oscillator, q, False, orbit.phase)
    closing[:, n + 2 :] += np.multiply.outer(pace, orbit.period * changes.of_period)
    ahead = np.concatenate([np.zeros(n), drive_of(orbit) / orbit.amplitude, -changes.amplitude])
    return end, record, flow[:n, :n], np.vstack([closing, reach, ahead, rate])


def _solved(orbit: PeriodicOrbit, changes: Changes, *, at_speed: bool) -> Array:
    """dz with the parameters, and last with the speed or the amplitude itself; (2 n_modes + 2, P + 1)."""
    n = orbit.deviations.size
    equations = np.delete(equations_of(orbit, changes)[-1], n + 1 if at_speed else n + 2, axis=0)
    unit = orbit.oscillator.unit_speed if at_speed else orbit.amplitude
    scale = np.concatenate([sizes_of(orbit.oscillator), np.full(2, orbit.amplitude)])
    weight = np.concatenate([sizes_of(orbit.oscillator), [orbit.oscillator.stop.gap, unit]])
    known = np.column_stack([-equations[:, n + 2 :], np.eye(n + 2)[-1]]) / weight[:, None]
    matrix = equations[:, : n + 2] * scale / weight[:, None]
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full_like(matrix, np.inf)
    if not np.max(np.abs(inverse)) < STEEPEST:
        raise NoDerivative(
            time=orbit.phase,
            gap=0.0,
            velocity=orbit.speed,
            detail=f"the orbit of period {orbit.period} does not follow from its "
            f"{'approach speed' if at_speed else 'amplitude'} here, as at a fold",
        )
    return np.asarray(scale[:, None] * (inverse @ known))


def sizes_of(oscillator: ImpactOscillator) -> Array:
    """Sizes of the deviations (u, v)."""
    model, size = oscillator.model, oscillator.stop.gap / np.abs(oscillator.model.phi).max()
    speed = np.maximum(model.omega, oscillator.driven.angular_frequency)
    return np.concatenate([np.full(oscillator.n_modes, size), size * speed])


def orbit_derivatives(
    orbit: PeriodicOrbit, changes: Sequence[Change], *, at_speed: bool = False
) -> OrbitDerivatives:
    """Derivatives of a periodic orbit at given drive amplitude, or `at_speed` at given approach speed.

    Raises
    ------
    NoDerivative
        At a fold, where the orbit does not follow from the amplitude.
    NotPeriodic
        If a touch of the orbit is lost.
    """
    require_kind("orbit", orbit, PeriodicOrbit, "a PeriodicOrbit")
    several = Changes(oscillator=orbit.oscillator, changes=changes)
    return OrbitDerivatives(
        orbit=orbit, changes=several, start=_solved(orbit, several, at_speed=at_speed)[:, :-1]
    )


def excess_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp at given approach speed, shape (P,); for the orbit at a fold that of the fold."""
    return orbit_derivatives(orbit, changes, at_speed=True).excess


def with_speed(orbit: PeriodicOrbit, changes: Sequence[Change]) -> OrbitDerivatives:
    """Derivatives at given approach speed, and last those with the approach speed itself [s/m]."""
    require_kind("orbit", orbit, PeriodicOrbit, "a PeriodicOrbit")
    given = Changes(oscillator=orbit.oscillator, changes=changes)
    several = replace(given, changes=(*given.changes, Change()))
    start = np.delete(_solved(orbit, several, at_speed=True), -2, axis=1)
    return OrbitDerivatives(orbit=orbit, changes=several, start=start)
