"""A simulated motion retraced from touch to touch, with tangents carried along.

The touches are those that the simulation has found; between them flights, and through them the law's own
tangents (``contact.flight.variation``).  The time t of a touch moves along a tangent d by -y(d)/v, v its
approach velocity: where v is zero, at a graze, the motion has no derivative.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from contact.errors import NoDerivative
from contact.flight.modal_flow import propagate, steady_motion
from contact.flight.variation import all_tip_changes, tangent_flight
from contact.laws import DELAYED
from contact.machine.compiled import kernel
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Changes
from contact.sensitivity.touch_flow import FLOWN, TOUCHING, flow_from_touch, lost
from contact.touch import force
from contact.trajectory import ImpactKind, State, Trajectory

Array = NDArray[np.float64]


@kernel
def fly_through(vary, tangent, u, v, clock, times, table):  # type: ignore[no-untyped-def]
    """A flight with tangents from the time `clock` over rising `times` [s]; see ``Retraced.along``."""
    motion = vary.motion
    for i in range(times.size):
        if times[i] > clock:
            tangent_flight(vary, tangent, u, v, clock % motion.period, times[i] - clock)
            propagate(motion, u, v, times[i] - clock, u, v)
            clock = times[i]
        table[i] = tangent[:-2]


class Retraced:
    """The motion of `run`, which starts off the stop at `start`, or at strobe zero where nobody asks for the
    derivatives of a flight.

    Parameters
    ----------
    changes : Changes
        The oscillator, and the parameters to which the last columns of `tangent` belong.
    run : Trajectory
    start : State, optional

    Attributes
    ----------
    tangent : ndarray, shape (2 n_modes + 2, columns)
        Those of (u, v, S, C) where the motion has been retraced to; to be set before the first step.
    late : dict of int to ndarray, shape (columns,)
        By how much later touch number i comes along each of them [s].

    Raises
    ------
    NoDerivative
        If the motion grazes the stop, or comes to rest on it.
    """

    def __init__(self, changes: Changes, run: Trajectory, start: State | None = None) -> None:
        self.vary, self.oscillator, met = changes.variation, changes.oscillator, run.impacts
        motion, n = self.vary.motion, self.oscillator.n_modes
        words = "touches the stop", "grazes the stop", "comes to rest on the stop", "starts in the stop"
        for i in np.flatnonzero(met.kind != ImpactKind.IMPACT):
            at, detail = float(met.start[i]), f"it {words[met.kind[i]]} there"
            raise NoDerivative(time=at, gap=0.0, velocity=float(met.approach[i]), detail=detail)
        self.start, self.end = met.start, np.nan_to_num(met.end, nan=np.inf)
        self.approach, self._phase, self._touch = met.approach, met.clock, met.deviations_start
        self.tangent = np.zeros((2 * n + 2, len(self.vary.rest)))
        self.late = dict[int, Array]()
        self._i, self.clock, self.u, self.v = 0, 0.0, np.zeros(n), np.zeros(n)
        if start is not None:
            self.clock = start.time
            q, q_rate = steady_motion(motion, start.time % motion.period)
            self.u, self.v = start.displacement - q, start.velocity - q_rate

    def touching(self, times: float | Array) -> NDArray[np.bool_]:
        """Whether the tip is in touch with the stop at `times` [s]."""
        at = np.asarray(times)[..., None]
        return np.asarray(np.any((self.start < at) & (self.end > at), axis=-1))

    def to(self, time: float) -> Array:
        """The tangents at `time` [s], later than where they are; shape (2 n_modes + 2, columns).

        In a touch they are those there, and those kept remain before it.
        """
        while self._i < self.start.size and self.start[self._i] <= time:
            i, n = self._i, self.oscillator.n_modes
            at, phase, (u, v) = float(self.start[i]), float(self._phase[i]), self._touch[i].copy()
            self._fly(at)
            self.late[i] = -all_tip_changes(self.vary, self.tangent, u, v, phase)[0] / self.approach[i]
            following = self.start[i + 1] if i + 1 < self.start.size else math.inf
            until = min(time, float(following))
            tangent, record = self.tangent.copy(), np.empty((1, 4 + 2 * n))
            outcome = flow_from_touch(self.vary, phase, u, v, until - at, tangent, record)
            if outcome == TOUCHING and self.end[i] > time:
                return self._waiting(tangent, u, v, at, time) if self.vary.motion.law == DELAYED else tangent
            if outcome != FLOWN:
                words = "a touch of the motion was lost on its way with derivatives"
                raise lost(outcome, at, float(self.approach[i]), words)
            self.tangent, self.clock, self.u, self.v = tangent, until, u, v
            self._i += 1
        self._fly(time)
        return self.tangent

    def along(self, times: Array) -> Array:
        """The tangents of (u, v) at rising `times` [s], shape (n_times, 2 n_modes, columns)."""
        found, i = np.empty((len(times), len(self.tangent) - 2, self.tangent.shape[1])), 0
        while i < len(times):
            found[i], last = self.to(float(times[i]))[:-2], i + 1
            if self.clock == times[i]:  # not in touch
                following = self.start[self._i] if self._i < self.start.size else math.inf
                last = max(last, int(np.searchsorted(times, following)))
                ahead = times[i + 1 : last], found[i + 1 : last]
                fly_through(self.vary, self.tangent, self.u, self.v, self.clock, *ahead)
                self.clock = float(times[last - 1])
            i = last
        return found

    def _waiting(self, tangent: Array, u: Array, v: Array, at: float, time: float) -> Array:
        """The tangents at `time` [s], when the tip waits on the stop since `at`, as the drive leaves them to
        the one mode."""
        motion = self.vary.motion
        phase = at % motion.period
        tangent_flight(self.vary, tangent, u, v, phase, time - at)
        tangent[:2] = 0.0
        reach, rate = all_tip_changes(self.vary, tangent, u, v, phase + time - at)
        tangent[:2] = -np.array([reach, rate]) / motion.phi[0]
        return tangent

    def _fly(self, time: float) -> None:
        """On to a time before the next touch."""
        length = time - self.clock
        if length > 0.0:
            motion = self.vary.motion
            tangent_flight(self.vary, self.tangent, self.u, self.v, self.clock % motion.period, length)
            propagate(motion, self.u, self.v, length, self.u, self.v)
            self.clock = time


def pace_of_deviations(oscillator: ImpactOscillator, q: Array, touching: bool, clock: float = 0.0) -> Array:
    """d(u, v)/dt of the deviations in the state `q`, (2 n_modes,), or (..., 2 n_modes) off the stop, at
    `clock` [s] after a strobe."""
    motion, n = oscillator.motion(), oscillator.n_modes
    steady, steady_rate = steady_motion(motion, clock)
    u, v = q[..., :n] - steady, q[..., n:] - steady_rate
    slowing = -motion.decay * v - motion.omega**2 * u
    if touching and motion.law == DELAYED:  # the tip rests, and the mode follows the drive
        slowing = motion.drive**2 * steady
    elif touching and (reach := oscillator.tip(q[:n]) - motion.gap) > 0.0:
        slowing = slowing - motion.phi * force(motion, reach, oscillator.tip(q[n:]))
    return np.concatenate([v, slowing], axis=-1)
