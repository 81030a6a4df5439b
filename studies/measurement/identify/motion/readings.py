"""A motion as a sensor reads it, and its derivatives; ``record.channel`` says what x is.

    y(t) = offset + scale x(t),   base motion Z sin(2 pi f t + phase),

t the time of the record, and x the displacement of the tip, its velocity or its acceleration.  Strobe points
have x, and perhaps the velocity, at whole drive periods.  A settled motion repeats after m drive periods
P = m/f.  Its rows are folded onto one orbit: a row at t belongs to the time

    s = s_0 + (t + phase/(2 pi f) - s_0) mod P

on the clock of the drive.  With Phi and D the derivatives of the state at s_0 + P with respect to that at s_0
and to the parameters, Newton's method closes the orbit, and the state at s_0 follows the parameters by

    dq_0 = (1 - Phi)^-1 D dp.

No error grows from orbit to orbit, and an unstable orbit is fitted as well as a stable one.

A motion that does not repeat begins at its first row, in a state that is fitted; a mode that hardly appears
in the record is held by a prior, one per cent of the gap at the tip.  With the drive later by a time u and
the same start the tip is at x(t; u), and

    dx/du = x'(t) - Phi(t) (q', q'')  at the start,

Phi the derivative with respect to the start (``contact.orbits.motion_derivatives``).
"""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from contact import ImpactKind, ImpactOscillator, State, Trajectory, simulate
from contact.orbits import motion_derivatives
from studies.measurement.identify.motion.predictions import Prediction
from studies.measurement.identify.record.channel import clear_of, rates, readings, readings_changed
from studies.measurement.identify.record.records import Array, NoAnswer, Record
from studies.physics.parameters import changes_of, parameters_of

PRIOR = 0.01  # standard deviation of a mode beyond the first at the start of a record, in gaps at the tip
CLOSED, STEPS = 1e-10, 12  # last step of Newton's method on an orbit, in gaps at the tip; most steps
FAR = 1.0  # a step of Newton's method that leads nowhere, in gaps at the tip
SLOW = 0.3  # least gain by a step with the derivatives of another orbit
FEW = 1500  # rows with which a search begins
GROWTH = 1.2  # of the rows of a motion that does not repeat; in chaos more leads to local optima

SENSOR: Mapping[str, float] = {"phase": 0.0, "offset": 0.0, "scale": 1.0}
"""The numbers of a sensor, each with its value where it is not fitted: the phase of the drive at time zero
[rad], the reading at equilibrium, in the unit of the record, and the reading over what is read [1]."""

UNITS = {"phase": "rad", "offset": "m", "scale": "1"}


@dataclass
class Orbit:
    """The last orbit that was accepted: its `state` at the clock, (1 - Phi)^-1, and how the state follows the
    parameters of these names from their values there."""

    state: Array
    inverse: Array | None = None
    names: tuple[str, ...] = ()
    values: Array = field(default_factory=lambda: np.empty(0))
    follow: Array = field(default_factory=lambda: np.empty((0, 0)))

    def at(self, oscillator: ImpactOscillator) -> Array:
        """The state with other parameters, to first order."""
        if not self.names:
            return self.state
        return self.state + self.follow @ (_values(oscillator, self.names) - self.values)


def _values(oscillator: ImpactOscillator, names: Sequence[str]) -> Array:
    known = parameters_of(oscillator)
    return np.array([known[name].value for name in names])


class Readings(Prediction):
    """The reading at the times of the record, from the modal displacements and velocities `start`.

    A motion with a `period` m has this start at the time `clock` of the drive [s]; one that does not repeat
    (0) has it at the first row.  `sensor` has all numbers of the sensor; those named in `free` are fitted.
    The `first` rows of a motion that does not repeat are fitted first.
    """

    def __init__(
        self,
        record: Record,
        oscillator: ImpactOscillator,
        start: Array,
        sensor: Mapping[str, float],
        free: Sequence[str],
        *,
        whole: Record | None = None,
        m: int = 0,
        clock: float = 0.0,
        first: int = 0,
    ) -> None:
        model, gap = oscillator.model, oscillator.stop.gap
        self.whole, self.record = whole or record, record
        self.strobed, count = record.kind == "strobe", np.arange(len(record.rows), dtype=float)
        self.times = count if self.strobed else record.rows[:, 0]  # of strobes in drive periods
        self.m, self.clock, self.first = m, clock, first
        tip = gap / np.abs(model.phi)
        self.scale = np.append(tip, tip * model.omega)
        self.orbit = Orbit(state=np.ravel(start))
        reading = gap * oscillator.driven.angular_frequency**record.order
        sizes = {"phase": 1.0, "offset": reading, "scale": 1.0}
        own = np.empty(0) if m else self.scale
        others = np.tile(np.arange(model.n_modes) != model.leading_mode, 2)[: own.size]
        self.sensor, self.fixed = tuple(free), dict(sensor)
        self.sizes = np.append(own, [sizes[name] for name in free])
        self.prior = np.append(np.where(others, PRIOR * own, np.inf), np.full(len(free), np.inf))
        self.extra = np.append(self.orbit.state[: own.size], [sensor[name] for name in free])
        self._last: tuple[ImpactOscillator, Array, Trajectory, NDArray[np.int64]] | None = None

    def parts(self) -> Sequence[Self]:
        """Few rows of an orbit, then all; of other motions more and more rows from the first on."""
        rows = len(self.times)
        if self.m:
            return [self.part(slice(None, None, -(-rows // FEW))), self]
        counts = [int(self.first * GROWTH**k) for k in range(64) if 0 < self.first * GROWTH**k < rows]
        return [*(self.part(slice(count)) for count in counts), self]

    def again(self) -> Self:
        """A copy with a start of its own."""
        found = copy.copy(self)
        found.orbit = copy.copy(self.orbit)
        return found

    def part(self, rows: slice) -> Self:
        """The prediction of some rows."""
        return self._of(replace(self.record, rows=self.record.rows[rows]), self.times[rows])

    def _of(self, record: Record, times: Array) -> Self:
        found = copy.copy(self)
        found.record, found.times, found._last = record, times, None
        return found

    def cleared(self, oscillator: ImpactOscillator, extra: Array, width: float = 0.0) -> Self | None:
        """The prediction of all rows but ones next to its impacts [s], if these are others than before."""
        if not (self.m and self.record.order):
            return None
        hits, w = self.run(oscillator, extra)[0].impacts, oscillator.driven.angular_frequency
        away = self.reading(extra)["phase"] / w
        record = clear_of(self.whole, hits.start - away, hits.end - away, self.m * oscillator.period, width)
        return None if np.array_equal(record.rows, self.record.rows) else self._of(record, record.rows[:, 0])

    def between(self, times: Array) -> Self:
        """The prediction at other times, the first row's the first."""
        return self._of(self.record, times)

    def reading(self, extra: Array) -> dict[str, float]:
        """The numbers of the sensor."""
        states = extra.size - len(self.sensor)
        return self.fixed | dict(zip(self.sensor, extra[states:].tolist(), strict=True))

    def _placed(self, oscillator: ImpactOscillator, extra: Array) -> tuple[State, Array, float]:
        """The start, the times of the rows and the end of the motion, on the clock of the drive."""
        w, phase = oscillator.driven.angular_frequency, self.reading(extra)["phase"]
        if self.m:
            begun, lasting = self.clock, self.m * oscillator.period
            stamps = self.times * (oscillator.period if self.strobed else 1.0)
            times = begun + (stamps + phase / w - begun) % lasting
            return self._closed(oscillator), times, begun + lasting
        begun = ((phase + w * self.times[0]) % (2.0 * math.pi)) / w
        q, v = extra[: 2 * oscillator.n_modes].reshape(2, -1)
        times = begun + self.times - self.times[0]
        return State(displacement=q, velocity=v, time=begun), times, float(times[-1])

    def _closed(self, oscillator: ImpactOscillator) -> State:
        """The state at the clock on the orbit next to the last one; NoAnswer if none is found.

        With the derivatives of the last orbit a step costs a motion; it is Newton's where these do not help.
        """
        n, begun, last = oscillator.n_modes, self.clock, self.orbit
        state, inverse, before = last.at(oscillator), last.inverse, FAR
        end = np.array([begun + self.m * oscillator.period])
        for _ in range(STEPS):
            at = State(displacement=state[:n], velocity=state[n:], time=begun)
            periods = _periods(float(end[0]), oscillator)
            if inverse is None:
                found = motion_derivatives(oscillator, at, periods=periods, times=end)
                run, inverse = found.trajectory, np.linalg.inv(np.eye(2 * n) - found.states[0])
            else:
                run = simulate(oscillator, at, periods=periods, times=end)
            step = inverse @ (np.append(run.displacement[0], run.velocity[0]) - state)
            size = float(np.abs(step / self.scale).max())
            if not size < FAR:
                break
            state = state + step
            if size < CLOSED:
                return State(displacement=state[:n], velocity=state[n:], time=begun)
            inverse, before = inverse if size < SLOW * before else None, size
        raise NoAnswer(f"no orbit of {self.m} drive periods was found with these parameters")

    def run(self, oscillator: ImpactOscillator, extra: Array) -> tuple[Trajectory, NDArray[np.int64]]:
        """The motion, the place of each row and of the end in it; InvalidValue if it rests on the stop."""
        if self._last is None or self._last[0] is not oscillator or self._last[1] is not extra:
            state, rows, end = self._placed(oscillator, extra)
            times, place = np.unique(np.append(rows, end), return_inverse=True)
            run = simulate(oscillator, state, periods=_periods(end, oscillator), times=times)
            if np.any(run.impacts.kind != ImpactKind.IMPACT):
                raise InvalidValue("the motion grazes the stop or comes to rest on it")
            self._last = oscillator, extra, run, place
        return self._last[2:]

    def values(self, oscillator: ImpactOscillator, extra: Array) -> Array:
        """The readings."""
        (run, place), sensor = self.run(oscillator, extra), self.reading(extra)
        q, v, times = (one[place[:-1]] for one in (run.displacement, run.velocity, run.time))
        read = readings(self.record, oscillator, times, rates(oscillator, times, q, v))[:-1]
        return np.asarray(sensor["offset"] + sensor["scale"] * read.T)

    def jacobian(self, oscillator: ImpactOscillator, extra: Array, names: Sequence[str]) -> Array:
        """Derivatives of `values`."""
        state, rows, end = self._placed(oscillator, extra)
        n, w, f = oscillator.n_modes, oscillator.driven.angular_frequency, oscillator.driven.frequency
        times, place = np.unique(np.append(rows, end), return_inverse=True)
        changes, periods = changes_of(oscillator, names), _periods(end, oscillator)
        found = motion_derivatives(oscillator, state, changes, periods=periods, times=times)
        run, scale = found.trajectory, self.reading(extra)["scale"]
        at, q, v = (one[place[:-1]] for one in (times, run.displacement, run.velocity))
        motion, rate = rates(oscillator, at, q, v), _rate(oscillator, state)
        read, moved = readings(self.record, oscillator, at, motion), [name == "frequency" for name in names]
        parts = readings_changed(self.record, oscillator, changes, at, motion, found.states[place[:-1]])
        if self.m:
            last, orbit = found.states[place[-1]], self.orbit
            ends = last[:, 2 * n :] - np.outer(rate * self.m * oscillator.period / f, moved)
            orbit.inverse = np.linalg.inv(np.eye(2 * n) - last[:, : 2 * n])
            orbit.state, orbit.follow = np.append(state.displacement, state.velocity), orbit.inverse @ ends
            orbit.names, orbit.values = tuple(names), _values(oscillator, names)
        rowwise = list[Array]()
        for x, later, (tips, own) in zip(read[:-1], read[1:], parts, strict=True):
            if self.m:
                stamps = 0.0 if self.strobed else self.times
                own = own + tips @ orbit.follow + np.outer((stamps - rows) / f * later, moved)
                tips = tips[:, :0]
            else:
                later = later - tips @ rate
                own = own + np.outer((self.times[0] - state.time) / f * later, moved)
            columns = {"phase": later / w * scale, "offset": np.ones(x.size), "scale": x}
            more = np.array([columns[name] for name in self.sensor]).reshape(-1, x.size).T
            rowwise.append(np.hstack([scale * own, scale * tips, more]))
        return np.stack(rowwise, axis=1).reshape(-1, rowwise[0].shape[1])


def _periods(end: float, oscillator: ImpactOscillator) -> int:
    """Whole drive periods up to a time."""
    return math.ceil(end / oscillator.period + 1e-9)


def _rate(oscillator: ImpactOscillator, state: State) -> Array:
    """Modal velocities and accelerations off the stop."""
    q, v = state.displacement[None], state.velocity[None]
    return np.ravel(rates(oscillator, np.array([state.time]), q, v)[1:3])
