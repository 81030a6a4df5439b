"""Predicted rows of a record for an oscillator with given parameters, and their derivatives.

Strobe points: the periodic orbit p_m next to the last one (``contact.orbits.Shooting``), its m strobes in the
cyclic order that fits best. Transitions: the fold of each p_m. A displacement is predicted in
`studies.measurement.identify.motion.displacement`.
"""

import copy
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np

from beam import InvalidValue
from contact import ContactLaw, ImpactOscillator, MaximalFamily, NewtonRestitution, simulate
from contact.orbits import (
    Change,
    KickFamily,
    PeriodicOrbit,
    Shooting,
    SingleImpactOrbit,
    excess_derivatives,
    fold_of,
    orbit_derivatives,
)
from studies.measurement.identify.record.records import Array, Record
from studies.physics.parameters import changes_of


class Prediction(ABC):
    """What is predicted of one record; `extra` are the unknowns beside the parameters.

    `sizes` measure changes of them, `prior` holds each about zero with this standard deviation (infinite:
    not), all of shape (n_extra,).  The last of them are the `sensor` numbers that are estimated, by name.
    Rows repeat after `period`, unless it is 0.
    """

    record: Record
    m: int = 0
    extra: Array = np.empty(0)
    sizes: Array = np.empty(0)
    prior: Array = np.empty(0)
    sensor: tuple[str, ...] = ()

    def parts(self) -> Sequence[Self]:
        """What is fitted one after the other, itself last."""
        return [self]

    def again(self) -> Self:
        """A copy, whose searches leave this one where it is."""
        return copy.copy(self)

    def cleared(self, oscillator: ImpactOscillator, extra: Array, width: float = 0.0) -> Self | None:
        """Another choice of rows, so far from impacts [s]; None if there is no better one."""
        return None

    @abstractmethod
    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The predicted rows, shape of `record.observed`; ContactError or Refusal where there are none."""

    @abstractmethod
    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values` by the named parameters and `extra`, shape (values.size, n_unknowns)."""


def in_closed_form(law: ContactLaw) -> bool:
    """Whether the orbits with one impact are known in closed form: under Newton's law with a constant."""
    return isinstance(law, NewtonRestitution) and law.table.size == 0


def family_of(oscillator: ImpactOscillator, m: int) -> MaximalFamily | KickFamily:
    """The orbits p_m by linear algebra: exact under Newton's law, close under any other."""
    family = MaximalFamily if in_closed_form(oscillator.stop.law) else KickFamily
    return family(oscillator=oscillator, m=m)


def shapes_changed(changes: Sequence[Change], count: int) -> Array:
    """Derivatives of the tip values phi by each change, shape (count, changes)."""
    still = np.zeros(count)
    return np.array([still if one.model is None else one.model.phi for one in changes]).reshape(-1, count).T


class Strobes(Prediction):
    """The m strobe points of p_m."""

    def __init__(self, record: Record, m: int, orbit: SingleImpactOrbit) -> None:
        self.record, self.m = record, m
        family = Shooting(oscillator=orbit.oscillator, m=m)
        self.orbit: PeriodicOrbit = family.at_speed(orbit.speed)
        self.at, rows = orbit.oscillator, record.observed
        self.mean = np.array([rows[k::m].mean(axis=0) for k in range(m)])

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The strobe points of the orbit next to the last one, a row for each of the record."""
        if oscillator is not self.at:
            family = Shooting(oscillator=oscillator, m=self.m)
            orbit = family.at_excess(oscillator.excess, self.orbit)
            if not orbit.admissible:
                raise InvalidValue(f"p{self.m} has another impact with these parameters")
            self.orbit, self.at = orbit, oscillator
        return self.of_orbit()

    def of_orbit(self) -> Array:
        """The strobe points of the last orbit."""
        oscillator = self.orbit.oscillator
        run = simulate(oscillator, self.orbit.state(), periods=self.m)
        rows = run.strobe_displacement, run.strobe_velocity
        points = np.column_stack([oscillator.tip(row) for row in rows[: self.mean.shape[1]]])
        return self._in_order(points, points[:, 0])

    def _in_order(self, values: Array, x: Array) -> Array:
        """`values` of the m strobes, shape (m, ...), as rows of the record, in the order in which x fits."""
        places = (np.arange(self.m) - np.arange(self.m)[:, None]) % self.m
        best = places[np.argmin(np.sum((x[places] - self.mean[:, 0]) ** 2, axis=1))]
        return np.asarray(values[best[np.arange(len(self.record.rows)) % self.m]])

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        points = self.values(oscillator, extra)
        n, changes = oscillator.n_modes, changes_of(self.orbit.oscillator, names)
        found = orbit_derivatives(self.orbit, changes)
        states = found.strobes_changed.reshape(self.m, 2, n, len(names))
        tips = np.tensordot(states, oscillator.model.phi, (2, 0))
        tips += found.strobes.reshape(self.m, 2, n) @ shapes_changed(changes, n)
        x = oscillator.tip(found.strobes[:, :n])
        return self._in_order(tips[:, : points.shape[1]], x).reshape(points.size, -1)


class Transitions(Prediction):
    """The fold of each p_m of a table."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.folds: list[PeriodicOrbit | None] = [None] * len(record.rows)

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """F/F_g - 1 at the folds."""
        for i, (frequency, period) in enumerate(self.record.rows[:, :2]):
            there = replace(oscillator, drive=replace(oscillator.driven, frequency=float(frequency)))
            exact = Shooting(oscillator=there, m=int(period))
            if in_closed_form(oscillator.stop.law):
                linear = MaximalFamily(oscillator=there, m=int(period)).fold()
                fold = exact.at_speed(linear.speed) if linear else None
            else:
                fold = fold_of(exact, self.folds[i])
            self.folds[i] = fold
            if fold is None:
                raise InvalidValue(f"p{period:g} has no fold at {frequency:g} Hz with these parameters")
        return np.array([[fold.excess] for fold in self.folds if fold is not None])

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        self.values(oscillator, extra)
        orbits = [fold for fold in self.folds if fold is not None]
        return np.array([excess_derivatives(one, changes_of(one.oscillator, names)) for one in orbits])
