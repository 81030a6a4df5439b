"""The variational replay: a simulated motion once more, with its tangents from touch to touch.

The touches are taken from the simulation.  The time of a touch changes by -y(d)/v along a tangent d, v its
approach velocity.  At a graze v is zero, and the motion has no derivative.  See ``docs/theory/flight.md``.

A rest on the stop forgets two directions.  Let P be an orthonormal basis of the vectors orthogonal to phi.
Impulses act along phi alone.  The last, very low hops are not computed: their effect on P^T u and P^T v is of
second order in their speed.  During the rest the tangents of u and v are P a and P a', with

    a'' = -P^T c P a' - P^T omega^2 P a.

The start of the rest does not matter, because the force acts along phi, nor does its end, where the force is
zero.  After a touch without rebound the tip has no deviation of its displacement: one direction is lost.
"""

import math

import numpy as np
from numpy.typing import NDArray

from beam.parameters import Array
from contact.errors import NoDerivative
from contact.flight.modal_flow import propagate, steady_motion
from contact.flight.numbers import Numbers
from contact.flight.variation import all_tip_changes, tangent_flight
from contact.machine.compiled import kernel
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Sensitivities
from contact.sensitivity.touch_flow import FLOWN, TOUCHING, flow_error, flow_from_touch
from contact.state import ImpactKind, State
from contact.touch import LAWS
from contact.touch.passage import new_touches
from contact.trajectory import Trajectory


@kernel
def fly_through(vary, tangent, u, v, clock, times, table):
    """A flight with tangents from the time `clock` over rising `times` [s]; see ``Replay.along``."""
    numbers = vary.numbers
    for i in range(times.size):
        if times[i] > clock:
            tangent_flight(vary, tangent, u, v, clock % numbers.period, times[i] - clock)
            propagate(numbers, u, v, times[i] - clock, u, v)
            clock = times[i]
        table[i] = tangent[:-2]


class Replay:
    """Replays a `trajectory` with its variational equation.

    The run must start off the stop.

    Parameters
    ----------
    sensitivities, trajectory : Sensitivities, Trajectory
        The oscillator, and the parameters to which the last columns of `tangent` belong; and its motion.
    start : State, optional
        The state from which the run starts.  Without it the tangents must have S = C = 0 and no parameters.
        The motion may then rest.  Where directions are lost, a basis of the others replaces `tangent`.

    Attributes
    ----------
    tangent : ndarray, shape (2 n_modes + 2, columns)
        Tangents of (u, v, S, C) at the time reached; to be set before the first step.
    impact_time : dict of int to ndarray, shape (columns,)
        Derivatives of the start of touch number i along each tangent [s].
    factors : list of ndarray
        Coordinates, in the new basis, of the tangents that were replaced.  The derivative is
        ``tangent @ factors[-1] @ ... @ factors[0]``.

    NoDerivative is raised if the motion grazes the stop, or, with `start`, comes to rest on it.
    """

    def __init__(
        self, sensitivities: Sensitivities, trajectory: Trajectory, start: State | None = None
    ) -> None:
        self.vary, n, met = sensitivities.variation, sensitivities.oscillator.n_modes, trajectory.impacts
        numbers = self.vary.numbers
        words = "touches the stop", "grazes the stop", "comes to rest on the stop", "starts in the stop"
        stays = (met.kind == ImpactKind.STAY) & (start is None)
        for i in np.flatnonzero((met.kind != ImpactKind.IMPACT) & ~stays):
            at, speed = float(met.start[i]), float(met.approach[i])
            raise NoDerivative(time=at, velocity=speed, detail=f"it {words[met.kind[i]]} there")
        first = np.flatnonzero(~stays)
        self._rests = np.append(stays, [False])[first + 1]  # a stay follows the impact that begins it
        self.start, self.end = met.start[first], np.nan_to_num(met.end[first + self._rests], nan=np.inf)
        self.approach, self._phase = met.approach[first], met.clock[first]
        self._touch, self._released = met.deviations_start[first], met.deviations_end[first + self._rests]
        stuck = (met.rebound == 0.0) & np.isnan(met.peak_force) & (start is None)
        self._forgets = self._rests | stuck[first]
        self.tangent = np.zeros((2 * n + 2, len(self.vary.scalars)))
        self.impact_time, self.factors = dict[int, Array](), list[Array]()
        self._i, self.clock, self.u, self.v = 0, 0.0, np.zeros(n), np.zeros(n)
        if start is not None:
            self.clock = start.time
            q, q_rate = steady_motion(numbers, start.time % numbers.period)
            self.u, self.v = start.displacement - q, start.velocity - q_rate

    def touching(self, times: float | Array) -> NDArray[np.bool_]:
        """Whether the tip is in contact with the stop at `times` [s]."""
        at = np.asarray(times)[..., None]
        return np.asarray(np.any((self.start <= at) & (self.end > at), axis=-1))

    def to(self, time: float) -> Array:
        """The tangents at `time` [s], shape (2 n_modes + 2, columns); the time must not run back.

        If the time lies in a touch, `tangent` and `clock` stay before that touch.
        """
        while self._i < self.start.size and self.start[self._i] <= time:
            i, n = self._i, self.u.size
            if self._forgets[i]:
                self._forget(i)
                self._i += 1
                continue
            at, phase, (u, v) = float(self.start[i]), float(self._phase[i]), self._touch[i].copy()
            self._fly(at)
            self.impact_time[i] = -all_tip_changes(self.vary, self.tangent, u, v, phase)[0] / self.approach[i]
            until = min(time, self._next_touch(i + 1))
            tangent, record = self.tangent.copy(), new_touches(1, n)
            outcome = flow_from_touch(self.vary, phase, u, v, until - at, tangent, record)
            if outcome == TOUCHING and self.end[i] > time:
                return tangent
            if outcome != FLOWN:
                words = "a touch of the motion was lost on its way with derivatives"
                raise flow_error(outcome, at, float(self.approach[i]), words)
            self.tangent, self.clock, self.u, self.v = tangent, until, u, v
            self._i += 1
        self._fly(time)
        return self.tangent

    def _forget(self, i: int) -> None:
        """Go through touch number `i`, and a rest that follows, to a basis of what is not forgotten."""
        from scipy.linalg import block_diag, expm  # slow to import

        numbers, rests, n = self.vary.numbers, self._rests[i], self.u.size
        phase, (u, v) = float(self._phase[i]), self._touch[i].copy()
        after = phase + float(self.end[i] - self.start[i]), *self._released[i].copy()
        if rests:  # the last impact takes the velocity of the tip
            after = phase, u, v - numbers.least_change(self.approach[i])
        self._fly(float(self.start[i]))
        LAWS[numbers.law].saltation(numbers, self.vary, (phase, u, v), after, self.tangent)
        unit, free = numbers.fastest, np.linalg.qr(numbers.phi[:, None], mode="complete")[0][:, 1:]
        rates = free if rests else np.eye(n)
        self.factors.append(block_diag(free, rates / unit).T @ self.tangent[:-2])
        basis = block_diag(free, rates * unit)
        if rests:
            pull, drag = (-free.T * row @ free for row in (numbers.omega**2 / unit, numbers.decay))
            held = np.block([[np.zeros_like(pull), unit * np.eye(n - 1)], [pull, drag]])
            basis = basis @ expm(held * (self.end[i] - self.start[i]))
        self.tangent = np.vstack([basis, np.zeros((2, basis.shape[1]))])
        self.clock, (self.u, self.v) = float(self.end[i]), self._released[i].copy()

    def along(self, times: Array) -> Array:
        """The tangents of (u, v) at rising `times` [s], shape (n_times, 2 n_modes, columns)."""
        found, i = np.empty((len(times), len(self.tangent) - 2, self.tangent.shape[1])), 0
        while i < len(times):
            found[i], last = self.to(float(times[i]))[:-2], i + 1
            if self.clock == times[i]:  # in flight
                last = max(last, int(np.searchsorted(times, self._next_touch(self._i))))
                ahead = times[i + 1 : last], found[i + 1 : last]
                fly_through(self.vary, self.tangent, self.u, self.v, self.clock, *ahead)
                self.clock = float(times[last - 1])
            i = last
        return found

    def _next_touch(self, i: int) -> float:
        """Start of touch number `i` [s]; infinity behind the last one."""
        return float(self.start[i]) if i < self.start.size else math.inf

    def _fly(self, time: float) -> None:
        """Move on to a time before the next touch."""
        length = time - self.clock
        if length > 0.0:
            numbers = self.vary.numbers
            tangent_flight(self.vary, self.tangent, self.u, self.v, self.clock % numbers.period, length)
            propagate(numbers, self.u, self.v, length, self.u, self.v)
            self.clock = time


def deviation_rates(numbers: Numbers, u: Array, v: Array) -> Array:
    """Time derivatives d(u, v)/dt of the deviations off the stop, (..., n_modes) -> (..., 2 n_modes)."""
    return np.concatenate([v, -numbers.decay * v - numbers.omega**2 * u], axis=-1)


def deviation_rates_at_strobe(oscillator: ImpactOscillator, q: Array, touching: bool) -> Array:
    """Time derivatives d(u, v)/dt of the deviations in the state `q` = (q, q') at a strobe.

    Off the stop `q` may have shape (..., 2 n_modes); if the tip is `touching` it has shape (2 n_modes,).
    """
    numbers, n = oscillator.numbers(), oscillator.n_modes
    steady, steady_rate = steady_motion(numbers, 0.0)
    rates = deviation_rates(numbers, q[..., :n] - steady, q[..., n:] - steady_rate)
    if touching:
        rates[n:] = LAWS[numbers.law].acceleration(numbers, rates[n:], q[:n], q[n:])
    return rates
