"""The displacement of the tip as a sensor reads it, and its derivatives.

    y(t) = offset + scale x(t),   base motion Z sin(2 pi f t + phase),

t the time of the record.  The motion begins at the first row, at modal displacements and velocities that are
fitted too; a mode that hardly appears in the record is held by a prior, one per cent of the gap at the tip.
With the drive later by a time s and the same start the tip is at x(t; s), and

    dx/ds = x'(t) - Phi(t) (q', q'')  at the start,

Phi the derivative with respect to the start (``contact.orbits.motion_derivatives``).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactKind, ImpactOscillator, State, Trajectory, simulate
from contact.orbits import MotionDerivatives, motion_derivatives
from studies.measurement.identify.predictions import Prediction
from studies.measurement.identify.records import Record
from studies.physics.parameters import changes_of

Array = NDArray[np.float64]

CLOSE, END = 0.01, 0.002
"""Residuals over the size of the record that are close; part of a record at whose end impacts do not
count."""

PRIOR = 0.01
"""Standard deviation of a mode beyond the first at the start of a record, in gaps at the tip."""

SENSOR: Mapping[str, float] = {"phase": 0.0, "offset": 0.0, "scale": 1.0}
"""The numbers of a sensor, each with its value where it is not fitted: the phase of the drive at time zero
[rad], the reading at equilibrium [m], the reading per displacement [1]."""


UNITS = {"phase": "rad", "offset": "m", "scale": "1"}


class Displacement(Prediction):
    """The reading at the times of the record, from modal displacements and velocities at its row `begin`.

    `sensor` has all numbers of the sensor; those named in `free` are fitted.  The `first` rows are one orbit
    and a half.
    """

    def __init__(
        self,
        record: Record,
        oscillator: ImpactOscillator,
        start: Array,
        sensor: Mapping[str, float],
        free: Sequence[str],
        begin: int = 0,
        first: int = 0,
    ) -> None:
        model, gap = oscillator.model, oscillator.stop.gap
        self.record = replace(record, rows=record.rows[begin:])
        self.times, self.first = self.record.rows[:, 0], first
        tip = gap / np.abs(model.phi)
        sizes = {"phase": 1.0, "offset": gap, "scale": 1.0}
        self.sensor, self.fixed = tuple(free), dict(sensor)
        self.sizes = np.concatenate([tip, tip * model.omega, [sizes[name] for name in free]])
        leading = np.tile(np.arange(model.n_modes) == model.leading_mode, 2)
        states = 2 * model.n_modes
        held = np.where(leading, np.inf, PRIOR * self.sizes[:states])
        self.prior = np.append(held, np.full(len(free), np.inf))
        self.extra = np.concatenate([np.ravel(start), [sensor[name] for name in free]])

    def parts(self, oscillator: ImpactOscillator) -> Sequence[Prediction]:
        """Itself if it starts close to the record, else first its beginning, twice as long each time."""
        if self.first == 0 or self.off(oscillator) < CLOSE:
            return [self]
        most = 0.75 * len(self.times)
        counts = [self.first * 2**k for k in range(64) if self.first * 2**k < most]
        return [*(self.upto(count) for count in counts), self]

    def off(self, oscillator: ImpactOscillator) -> float:
        """Residuals at the start over the size of the record."""
        seen = self.record.observed
        try:
            return float((self.values(oscillator, self.extra) - seen).std() / seen.std())
        except (ContactError, Refusal):
            return math.inf

    def upto(self, count: int) -> Displacement:
        """The prediction of the first rows."""
        part = copy.copy(self)
        part.record = replace(self.record, rows=self.record.rows[:count])
        part.times = self.times[:count]
        return part

    def reading(self, extra: Array) -> dict[str, float]:
        """The numbers of the sensor."""
        states = extra.size - len(self.sensor)
        return self.fixed | dict(zip(self.sensor, extra[states:].tolist(), strict=True))

    def _placed(self, oscillator: ImpactOscillator, extra: Array) -> tuple[State, Array, int]:
        """The start and the times of the rows on the clock of the drive, and how many periods they last."""
        w = oscillator.driven.angular_frequency
        begun = ((self.reading(extra)["phase"] + w * self.times[0]) % (2.0 * math.pi)) / w
        q, v = extra[: 2 * oscillator.n_modes].reshape(2, -1)
        lasting = self.times - self.times[0]
        periods = math.ceil((begun + lasting[-1]) / oscillator.period + 1e-9)
        return State(displacement=q, velocity=v, time=begun), begun + lasting, periods

    def run(self, oscillator: ImpactOscillator, extra: Array) -> Trajectory:
        """The motion; InvalidValue if it rests on the stop."""
        state, times, periods = self._placed(oscillator, extra)
        run = simulate(oscillator, state, periods=periods, times=times)
        if np.any(run.impacts.kind != ImpactKind.IMPACT):
            raise InvalidValue("the motion grazes the stop or comes to rest on it")
        return run

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The readings."""
        sensor = self.reading(extra)
        x = oscillator.tip(self.run(oscillator, extra).displacement)
        return (sensor["offset"] + sensor["scale"] * x)[:, None]

    def touches(self, oscillator: ImpactOscillator, extra: Array) -> int:
        """Impacts in the record up to the last rows, among which one more may come and go."""
        _, times, _ = self._placed(oscillator, extra)
        end = times[-1] - END * (times[-1] - times[0])
        return int(np.sum(self.run(oscillator, extra).impacts.start <= end))

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        state, times, periods = self._placed(oscillator, extra)
        n, w = oscillator.n_modes, oscillator.driven.angular_frequency
        found = motion_derivatives(
            oscillator, state, changes_of(oscillator, names), periods=periods, times=times
        )
        tip = np.tensordot(found.states[:, :n], oscillator.model.phi, (1, 0))
        tips, own = tip[:, : 2 * n], tip[:, 2 * n :]
        later = self._later(oscillator, state, found, tips)
        if "frequency" in names:  # at the same phase the drive is then later by this much
            delay = (self.times[0] - state.time) / oscillator.driven.frequency
            own[:, list(names).index("frequency")] += delay * later
        scale = self.reading(extra)["scale"]
        x = oscillator.tip(found.run.displacement)
        columns = {"phase": later / w * scale, "offset": np.ones(x.size), "scale": x}
        more = np.array([columns[name] for name in self.sensor]).reshape(-1, x.size).T
        return np.hstack([scale * own, scale * tips, more])

    def _later(
        self, oscillator: ImpactOscillator, state: State, found: MotionDerivatives, tips: Array
    ) -> Array:
        """dx/ds of the rows."""
        model, drive = oscillator.model, oscillator.driven
        w = drive.angular_frequency
        base = -drive.amplitude * w * w * math.sin(w * state.time)
        pull = -model.participation * base + (0.0 if oscillator.load is None else oscillator.load)
        rate = pull - model.decay_rate * state.velocity - model.omega**2 * state.displacement
        return oscillator.tip(found.run.velocity) - tips @ np.append(state.velocity, rate)
