"""What an oscillator with given parameters would have put into a record, and how that changes with them.

Strobe points: the periodic orbit p_m next to the last one (``contact.orbits.Shooting``), its m strobes in the
cyclic order that fits best. Displacement: the motion from a start that is fitted too; modes that the record
hardly sees are held by a prior, one per cent of the gap at the tip. Transitions: the fold of each p_m.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from contact import (
    ContactError,
    ImpactOscillator,
    MaximalFamily,
    NewtonRestitution,
    State,
    Trajectory,
    simulate,
)
from contact.orbits import KickFamily, PeriodicOrbit, Shooting, SingleImpactOrbit, fold_of
from studies.identify.parameters import parameters_of, with_values
from studies.identify.records import Record

__all__ = ["PRIOR", "Displacement", "Prediction", "Strobes", "Transitions", "family_of"]

Array = NDArray[np.float64]

STEP = 1e-6
"""Of a central difference, in units of a parameter's size."""

FIRST, CLOSE, END = 3.0, 0.01, 0.002
"""Drive periods that a displacement is first fitted over if its start is not close; residuals over the size
of the record that are close; part of a record at whose end impacts do not count."""

PRIOR = 0.01
"""Standard deviation of a mode beyond the first at the start of a record, in gaps at the tip."""


class Prediction(Protocol):
    """What is predicted of one record; `extra` are the unknowns beside the parameters."""

    record: Record
    extra: Array
    """Start of the further unknowns, shape (n_extra,)."""
    sizes: Array
    """By which changes of them are measured, shape (n_extra,)."""
    prior: Array
    """Standard deviation of each about zero; infinite for none, shape (n_extra,)."""

    def parts(self, oscillator: ImpactOscillator) -> Sequence[Prediction]:
        """What is fitted one after the other, itself last."""

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The predicted rows, shape of `record.observed`; ContactError or ValueError where there are none."""

    def touches(self, oscillator: ImpactOscillator, extra: Array) -> int:
        """Number of impacts in what is predicted; -1 where the orbit is none."""

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values` by the named parameters and `extra`, shape (values.size, n_unknowns)."""


def differences(
    prediction: Prediction, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]
) -> Array:
    """The Jacobian of a prediction by central differences."""
    known, columns = parameters_of(oscillator), []
    for name in names:
        value, step = known[name].value, STEP * known[name].size
        ends = [prediction.values(with_values(oscillator, {name: value + s}), extra) for s in (step, -step)]
        columns.append((ends[0] - ends[1]).ravel() / (2.0 * step))
    for k, size in enumerate(prediction.sizes):
        step = STEP * size * np.eye(extra.size)[k]
        ends = [prediction.values(oscillator, extra + s) for s in (step, -step)]
        columns.append((ends[0] - ends[1]).ravel() / (2.0 * STEP * size))
    return np.array(columns).T


def family_of(oscillator: ImpactOscillator, period: int) -> MaximalFamily | KickFamily:
    """The orbits p_m by linear algebra: exact under Newton's law, close under any other."""
    newton = isinstance(oscillator.stop.law, NewtonRestitution)
    return (MaximalFamily if newton else KickFamily)(oscillator=oscillator, period=period)


class Strobes:
    """The m strobe points of p_m."""

    extra = sizes = prior = np.empty(0)

    def __init__(self, record: Record, period: int, orbit: SingleImpactOrbit) -> None:
        self.record, self.period = record, period
        family = Shooting(oscillator=orbit.oscillator, period=period)
        self.orbit: PeriodicOrbit = family.at_speed(orbit.speed)
        rows = record.observed
        self.mean = np.array([rows[k::period].mean(axis=0) for k in range(period)])

    def parts(self, oscillator: ImpactOscillator) -> Sequence[Prediction]:
        """Itself."""
        return [self]

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The strobe points of the orbit next to the last one, as many rows as the record has."""
        family = Shooting(oscillator=oscillator, period=self.period)
        self.orbit = family.at_excess(oscillator.excess, self.orbit)
        return self.of_orbit()

    def of_orbit(self) -> Array:
        """The strobe points of the last orbit."""
        oscillator = self.orbit.oscillator
        run = simulate(oscillator, self.orbit.state(), periods=self.period)
        rows = run.strobe_displacement, run.strobe_velocity
        points = np.column_stack([oscillator.tip(row) for row in rows[: self.mean.shape[1]]])
        return self._in_order(points, points[:, 0])

    def _in_order(self, values: Array, x: Array) -> Array:
        """`values` of the m strobes, shape (m, ...), as rows of the record, in the order in which `x` fits."""
        off = [np.sum((np.roll(x, k) - self.mean[:, 0]) ** 2) for k in range(self.period)]
        turned = np.roll(values, int(np.argmin(off)), axis=0)
        return np.asarray(turned[np.arange(len(self.record.rows)) % self.period])

    def touches(self, oscillator: ImpactOscillator, extra: Array) -> int:
        """1 as long as the tip touches nowhere else."""
        self.values(oscillator, extra)
        return 1 if self.orbit.admissible else -1

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        return differences(self, oscillator, extra, names)


class Transitions:
    """The fold of each p_m of a table."""

    extra = sizes = prior = np.empty(0)

    def __init__(self, record: Record) -> None:
        self.record = record
        self.near: list[PeriodicOrbit | None] = [None] * len(record.rows)

    def parts(self, oscillator: ImpactOscillator) -> Sequence[Prediction]:
        """Itself."""
        return [self]

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """F/F_g - 1 at the folds."""
        found = []
        for i, (frequency, period) in enumerate(self.record.rows[:, :2]):
            there = replace(oscillator, drive=replace(oscillator.driven, frequency=float(frequency)))
            if isinstance(oscillator.stop.law, NewtonRestitution):
                fold = MaximalFamily(oscillator=there, period=int(period)).fold()
            else:
                fold = self.near[i] = _fold(Shooting(oscillator=there, period=int(period)), self.near[i])
            if fold is None:
                raise ValueError(f"p{period:g} has no fold at {frequency:g} Hz with these parameters")
            found.append([fold.excess])
        return np.array(found)

    def touches(self, oscillator: ImpactOscillator, extra: Array) -> int:
        """1 where all folds exist."""
        self.values(oscillator, extra)
        return 1

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        return differences(self, oscillator, extra, names)


def _fold(family: Shooting, near: PeriodicOrbit | None) -> PeriodicOrbit | None:
    try:
        return fold_of(family, near)
    except ContactError:
        return fold_of(family)


class Displacement:
    """The tip at the times of the record, or up to some row of it."""

    def __init__(self, record: Record, oscillator: ImpactOscillator, start: State) -> None:
        self.record, model = record, oscillator.model
        first = int(np.searchsorted(record.rows[:, 0], start.time - 1e-12))
        self.record = replace(record, rows=record.rows[first:])
        self.time, self.times = float(start.time), self.record.rows[:, 0]
        tip = oscillator.stop.gap / np.abs(model.phi)
        self.sizes = np.concatenate([tip, tip * model.omega])
        free = np.arange(model.n_modes) == 0
        self.prior = np.where(np.tile(free, 2), np.inf, PRIOR * self.sizes)
        self.extra = np.concatenate([start.displacement, start.velocity])
        self.hits: int | None = None

    def parts(self, oscillator: ImpactOscillator) -> Sequence[Prediction]:
        """Itself where it starts close to the record; otherwise first its beginning, then twice as much ..."""
        seen = self.record.observed
        try:
            off = self.values(oscillator, self.extra) - seen
            if off.std() < CLOSE * seen.std():
                return [self]
        except (ContactError, ValueError):
            pass
        first, rows = FIRST * oscillator.period / (self.times[1] - self.times[0]), len(seen)
        counts = [int(first * 2**k) for k in range(64) if first * 2**k < 0.75 * rows]
        return [*(self._upto(count) for count in counts), self]

    def _upto(self, count: int) -> Displacement:
        part = copy.copy(self)
        part.record = replace(self.record, rows=self.record.rows[:count])
        part.times, part.hits = self.times[:count], None
        return part

    def _run(self, oscillator: ImpactOscillator, extra: Array) -> Trajectory:
        q, v = extra.reshape(2, -1)
        state = State(displacement=q, velocity=v, time=self.time)
        periods = math.ceil((self.times[-1] - self.time) / oscillator.period + 1e-9)
        return simulate(oscillator, state, periods=periods, times=self.times)

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The displacement of the tip; ValueError for another number of impacts than before."""
        run = self._run(oscillator, extra)
        hits = self._hits(run)
        if self.hits is None:
            self.hits = hits
        if hits != self.hits:
            raise ValueError(f"the motion has {hits} impacts instead of {self.hits}")
        return oscillator.tip(run.displacement)[:, None]

    def _hits(self, run: Trajectory) -> int:
        """Impacts up to the last rows, among which one more may come and go."""
        return int(np.sum(run.impacts.start <= self.times[-1] - END * (self.times[-1] - self.time)))

    def touches(self, oscillator: ImpactOscillator, extra: Array) -> int:
        """Impacts in the record."""
        return self._hits(self._run(oscillator, extra))

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        return differences(self, oscillator, extra, names)
