"""Derivatives of a periodic orbit with respect to the numbers of its oscillator.

An orbit starts at its first touch from z = (u, v, S, C) and obeys the equations of
``contact.orbits.families.equations``.  The derivative dz/dp is one linear solve, with the tangents of one
more flow.  At given amplitude it ends at a fold; at given approach speed the derivative of the excess is that
of the fold itself.  Derivation: ``docs/theory/folds.md``.
"""

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from beam.parameters import Array, record, require_kind
from contact.errors import NoDerivative
from contact.orbits.families.equations import STEEPEST, drive_of, shoot, sizes_of, slopes_of, tip_slopes
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.sensitivity.change import Change, Sensitivities
from contact.sensitivity.replay import Replay, deviation_rates_at_strobe
from contact.simulation import simulate
from contact.trajectory import Trajectory


@record
class OrbitDerivatives:
    """Derivatives of a periodic orbit, per unit of each of P parameters.

    `orbit_derivatives` returns them.

    Parameters
    ----------
    orbit : PeriodicOrbit
        The orbit.
    changes : Sensitivities
        The P parameters, with the derivatives of the oscillator and of its steady motion.
    start : ndarray, shape (2 n_modes + 2, P)
        Derivatives of (u, v, S, C) at the first touch.  These are the deviations of the modes, and the parts
        S = Z sin(w t) and C = Z cos(w t) of the drive.
    """

    orbit: PeriodicOrbit
    changes: Sensitivities = field(repr=False)
    start: Array = field(repr=False)

    @property
    def amplitude(self) -> Array:
        """Derivatives of the base amplitude, shape (P,) [m]."""
        return np.asarray(drive_of(self.orbit) @ self.start[-2:] / self.orbit.amplitude)

    @property
    def excess(self) -> Array:
        """Derivatives of F/F_g - 1, shape (P,)."""
        grazing, level = self.orbit.oscillator.grazing_amplitude(), 1.0 + self.orbit.excess
        return np.asarray((self.amplitude - level * self.changes.grazing_amplitude) / grazing)

    @property
    def time(self) -> Array:
        """Derivatives of the drive time of the first touch, shape (P,) [s]."""
        (sine, cosine), w = drive_of(self.orbit), self.orbit.oscillator.driven.angular_frequency
        angle = (cosine * self.start[-2] - sine * self.start[-1]) / self.orbit.amplitude**2
        return np.asarray((angle - self.orbit.phase * self.changes.frequency) / w)

    @property
    def speed(self) -> Array:
        """Derivatives of the approach speed of the first touch, shape (P,) [m/s]."""
        rate = tip_slopes(self.orbit, self.changes)[1]
        return np.asarray(rate[: len(self.start)] @ self.start + rate[len(self.start) :])

    @cached_property
    def _run(self) -> Trajectory:
        return simulate(self.orbit.oscillator, self.orbit.state(), periods=self.orbit.m)

    @property
    def strobes(self) -> Array:
        """The states (q, q') at the m strobes that follow the first touch, shape (m, 2 n_modes)."""
        return np.hstack([self._run.strobe_displacement, self._run.strobe_velocity])

    @cached_property
    def strobes_changed(self) -> Array:
        """Derivatives of the states at the strobes, shape (m, 2 n_modes, P).

        NoDerivative is raised where the orbit meets the stop at another time than its touches, as at a graze.
        """
        orbit, changes, n = self.orbit, self.changes, self.orbit.oscillator.n_modes
        if not orbit.admissible:
            raise orbit.failure(NoDerivative, "the orbit meets the stop at another time than its touches")
        replay, m, size = Replay(changes, self._run, orbit.state()), orbit.oscillator.period, 2 * n + 2
        replay.tangent = np.eye(size, size + len(changes.changes))
        found = list[Array]()
        for j, q in enumerate(self.strobes, start=1):
            tangent = replay.to(j * m)[: 2 * n]
            rates = deviation_rates_at_strobe(orbit.oscillator, q, bool(replay.touching(j * m)))
            moved = tangent[:, :size] @ self.start + tangent[:, size:]
            moved += np.multiply.outer(rates, j * changes.period - self.time)
            found.append(moved + changes.steady(0.0))
        return np.array(found)


def _solved(orbit: PeriodicOrbit, changes: Sensitivities, *, at_speed: bool) -> Array:
    """Derivatives of z with respect to the parameters, and last to the speed or the amplitude itself, shape
    (2 n_modes + 2, P + 1)."""
    n, sizes = orbit.deviations.size, sizes_of(orbit.oscillator)
    flow = shoot(changes, orbit.phase, orbit.deviations, orbit.m, orbit.impacts)[2]
    equations = np.delete(slopes_of(orbit, flow, changes), n + 1 if at_speed else n + 2, axis=0)
    unit = orbit.oscillator.unit_speed if at_speed else orbit.amplitude
    scale = np.concatenate([sizes, np.full(2, orbit.amplitude)])
    weight = np.concatenate([sizes, [orbit.oscillator.stop.gap, unit]])
    known = np.column_stack([-equations[:, n + 2 :], np.eye(n + 2)[-1]]) / weight[:, None]
    matrix = equations[:, : n + 2] * scale / weight[:, None]
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full_like(matrix, np.inf)
    if not np.max(np.abs(inverse)) < STEEPEST:
        given = "approach speed" if at_speed else "amplitude"
        words = f"the orbit of period {orbit.m} does not follow from its {given} here, as at a fold"
        raise orbit.failure(NoDerivative, words)
    return np.asarray(scale[:, None] * (inverse @ known))


def orbit_derivatives(
    orbit: PeriodicOrbit, changes: Sequence[Change], *, at_speed: bool = False
) -> OrbitDerivatives:
    """Return the derivatives of a periodic orbit with respect to parameters of its oscillator.

    Parameters
    ----------
    orbit : PeriodicOrbit
        The orbit, as `Shooting` finds it.
    changes : sequence of Change
        The P parameters, each a direction in which the numbers of the oscillator change.
    at_speed : bool, optional
        Whether the approach speed is held fixed.  By default the drive amplitude is held fixed, except for
        its own change.

    Returns
    -------
    OrbitDerivatives
        Derivatives of amplitude, excess, time, speed and strobes of the orbit.

    Raises
    ------
    TypeError
        If `orbit` is no PeriodicOrbit, or `changes` holds anything but Change objects.
    ValueError
        If a change has another number of modes, or changes a number that the law does not have.
    NoDerivative
        If the orbit does not follow from its amplitude, as at a fold, or with `at_speed` from its speed.
    NotPeriodic
        If a touch of the orbit is lost.
    """
    require_kind("orbit", orbit, PeriodicOrbit, "a PeriodicOrbit")
    several = Sensitivities(oscillator=orbit.oscillator, changes=changes)
    start = _solved(orbit, several, at_speed=at_speed)[:, :-1]
    return OrbitDerivatives(orbit=orbit, changes=several, start=start)


def excess_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """Return the derivatives of the excess of an orbit at given approach speed.

    At a fold they are the derivatives of the fold itself.

    Parameters
    ----------
    orbit : PeriodicOrbit
        The orbit, as `Shooting` or `fold_of` finds it.
    changes : sequence of Change
        The P parameters, each a direction in which the numbers of the oscillator change.

    Returns
    -------
    ndarray, shape (P,)
        Derivatives of F/F_g - 1, per unit of each parameter.

    Raises
    ------
    TypeError
        If `orbit` is no PeriodicOrbit, or `changes` holds anything but Change objects.
    ValueError
        If a change has another number of modes, or changes a number that the law does not have.
    NoDerivative
        If the orbit does not follow from its approach speed.
    NotPeriodic
        If a touch of the orbit is lost.
    """
    return orbit_derivatives(orbit, changes, at_speed=True).excess
