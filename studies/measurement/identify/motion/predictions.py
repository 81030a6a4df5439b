"""Predicted rows of a record for an oscillator with given parameters, and their derivatives.

Transitions: the fold of each p_m. A motion and its strobe points are predicted in
`studies.measurement.identify.motion.readings`.
"""

import copy
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np

from beam import InvalidValue
from contact import ContactLaw, ImpactOscillator, MaximalFamily, NewtonRestitution
from contact.orbits import KickFamily, PeriodicOrbit, Shooting, excess_derivatives, fold_of
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
