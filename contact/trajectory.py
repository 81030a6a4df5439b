"""States and motions as named arrays.

A modal state is a displacement q_k [m kg^0.5] and a velocity q_k' [m kg^0.5 / s] of each mode.
``ImpactOscillator.tip`` gives the displacement of the tip relative to the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property

import numpy as np

from beam.parameters import (
    InvalidValue,
    final,
    is_number,
    require,
    require_array,
    require_whole,
    require_within,
    shown,
)
from contact.drive import split_time
from contact.flight.modal_flow import steady_motion
from contact.flight.motion import Motion
from contact.oscillator import ImpactOscillator


class Regime(IntEnum):
    """How the stop acts on the tip.

    OUTSIDE: off the wall.  CONTACT: pushed by the wall.  INSIDE: behind the wall's rest position, without
    force.  SUSTAINED: held on the wall by the motion.  WAITING: on the wall, until a delayed rebound.
    """

    OUTSIDE = 0
    CONTACT = 1
    INSIDE = 2
    SUSTAINED = 3
    WAITING = 4


class ImpactKind(IntEnum):
    """Kind of a touch of the tip.

    IMPACT: a touch that acts on the motion.  GRAZE: a touch without effect, within rounding.  STAY: a stay on
    the wall after accumulated impacts, from the end of their last hop on.  UNDER_WAY: a contact that had
    begun before the run.
    """

    IMPACT = 0
    GRAZE = 1
    STAY = 2
    UNDER_WAY = 3


OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = map(int, Regime)
IMPACT, GRAZE, STAY, UNDER_WAY = map(int, ImpactKind)
"""The regimes and the kinds as plain integers, for the kernels."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Modal displacement and velocity of a spring at a time, and its contact with the stop.

    Parameters
    ----------
    displacement, velocity : ndarray, shape (n_modes,)
        Modal coordinates [m kg^0.5] and their rates [m kg^0.5 / s].
    time : float
        Time since the start of the drive, base at z = Z sin(2 pi f time) [s].
    regime : Regime
        A number from 0 to 4 is taken too.
    wait, rebound : float
        While waiting, the time still to wait [s] and the tip velocity with which it then leaves [m/s].
    stop : int
        Number of the stop that acts, unless the regime is OUTSIDE.
    """

    displacement: np.ndarray
    velocity: np.ndarray
    time: float = 0.0
    regime: Regime | int = Regime.OUTSIDE
    wait: float = 0.0
    rebound: float = 0.0
    stop: int = 0

    def __post_init__(self) -> None:
        shape, words = None, "a number for each mode"
        for name, unit in (("displacement", "m kg^0.5"), ("velocity", "m kg^0.5/s")):
            where, given = f"{name} of the state", getattr(self, name)
            array = require_array(where, given, unit, dimensions=1, shape=shape, words=words)
            object.__setattr__(self, name, array)
            require(array.size > 0, where, f"is []; it must be {words}")
            shape = array.shape
        if type(self.regime) is not Regime:
            if not (is_number(self.regime) and self.regime in (0, 1, 2, 3, 4)):
                raise InvalidValue(f"regime of the state is {shown(self.regime)}; it must be 0, 1, 2, 3 or 4")
            object.__setattr__(self, "regime", Regime(self.regime))
        for name, unit in (("time", "s"), ("wait", "s"), ("rebound", "m/s")):
            value = getattr(self, name)
            if type(value) is not float or not math.isfinite(value):  # the usual case without a call
                require_within(f"{name} of the state", value, unit)
        if self.stop != 0:
            require_whole("stop of the state", self.stop, "[1], the number of a stop", low=0)

    @staticmethod
    def rest(n_modes: int) -> State:
        """The straight spring at rest, at time zero."""
        size = require_whole("n_modes", n_modes, "modes")
        return State(displacement=np.zeros(size), velocity=np.zeros(size))


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """Start and end of a simulation, and the times at which its states are wanted."""

    start: State
    length: float  # duration [s]
    first: int  # number of the drive period in which the run starts
    last: int  # number of the one in which it ends
    clock: float  # start and end, as times since the strobes of these periods [s]
    clock_end: float
    times: np.ndarray  # at which the state is wanted [s], shape (n_times,)
    sample_period: np.ndarray  # the same as number of the drive period and time since its strobe [s]
    sample_clock: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class Impacts:
    """The touches of the tip, in the order in which they began.

    Times are kept as drive periods and the rest, and states as deviations u = q - q_s and v = q' - q_s' from
    the steady motion q_s of the `oscillator`.  Both are right to rounding however long the run.  Times in
    seconds and modal states are made of them on demand.

    Parameters
    ----------
    period : ndarray of int, shape (n_impacts,)
        Number of the drive period in which a touch begins.
    clock, end_clock : ndarray, shape (n_impacts,)
        First touch and release, counted from the strobe that begins this period [s]; equal for an impact
        law, the second NaN for a contact that had not ended.
    approach, rebound : ndarray, shape (n_impacts,)
        Velocity at both, positive towards the stop [m/s]; an approach before the run is NaN.
    loss : ndarray, shape (n_impacts,)
        Energy that the tip has given to the stop [J].  A contact that has ended has lost it; in one still
        closed it includes what the stop stores.  That of a stay is the energy of the hops before it.
    impulse : ndarray, shape (n_impacts,)
        Integral of the contact force over the touch, to the end of the run if it is still closed [N s].  A
        stay includes the impulse of the hops before it.
    peak_force : ndarray, shape (n_impacts,)
        Largest contact force in the touch, so far if it is still closed [N].  NaN if the law acts at once,
        without a force: an impact under Newton's law or a delayed rebound.  A stay has the largest force that
        holds the tip.  A method with a time step gives the largest force at its grid points.
    kind : ndarray of int, shape (n_impacts,)
        Values of `ImpactKind`.
    stop : ndarray of int, shape (n_impacts,)
        Numbers of the stops, from 0 on.
    deviations_start, deviations_end : ndarray, shape (n_impacts, 2, n_modes)
        Deviations (u, v) just before the touch and just after the release.
    """

    oscillator: ImpactOscillator = field(repr=False)
    period: np.ndarray
    clock: np.ndarray
    end_clock: np.ndarray
    approach: np.ndarray
    rebound: np.ndarray
    loss: np.ndarray
    impulse: np.ndarray
    peak_force: np.ndarray
    kind: np.ndarray
    stop: np.ndarray
    deviations_start: np.ndarray
    deviations_end: np.ndarray

    def __len__(self) -> int:
        return int(self.clock.size)

    @staticmethod
    def of_states(
        oscillator: ImpactOscillator, *, times: np.ndarray, states: np.ndarray, **numbers: np.ndarray
    ) -> Impacts:
        """Touches that another program has found; `numbers` are approach to stop of the list above.

        Without impulse or peak force these are NaN, and without numbers of the stops these are 0.

        `times` [s] has the shape (2, n_impacts), and the modal states (q, q') have (2, n_impacts, 2,
        n_modes): first the touches, then the releases.
        """
        count = times.shape[1]
        unknown = dict.fromkeys(("impulse", "peak_force"), np.full(count, np.nan))
        unknown["stop"] = np.zeros(count, dtype=np.int64)
        given, valid = ", ".join(sorted(numbers.keys() - unknown.keys())), "approach, kind, loss, rebound"
        require(given == valid, f"numbers has {given or 'no entries'}; it must have {valid}")
        period, clock = split_time(times[0], oscillator.period)
        end_clock, motion = times[1] - period * oscillator.period, oscillator.numbers()
        before, after = states - steady_states(motion, np.array([clock, end_clock]) % motion.period)
        return Impacts(
            oscillator=oscillator,
            period=period,
            clock=clock,
            end_clock=end_clock,
            deviations_start=before,
            deviations_end=after,
            **(unknown | numbers),
        )

    @cached_property
    def start(self) -> np.ndarray:
        """Times of the first touch [s], shape (n_impacts,)."""
        return self.period * self.oscillator.period + self.clock

    @cached_property
    def end(self) -> np.ndarray:
        """Times of the release [s], shape (n_impacts,)."""
        return self.period * self.oscillator.period + self.end_clock

    @cached_property
    def duration(self) -> np.ndarray:
        """Lengths of the touches [s], shape (n_impacts,): 0 under Newton's law, NaN for one still closed."""
        return self.end_clock - self.clock

    @cached_property
    def _steady(self) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        """Steady displacements and velocities at `start`, and at `end`."""
        motion = self.oscillator.numbers()
        return tuple(steady_motion(motion, np.fmod(at, motion.period)) for at in (self.clock, self.end_clock))

    @cached_property
    def displacement_start(self) -> np.ndarray:
        """Modal displacements just before the touch [m kg^0.5], shape (n_impacts, n_modes)."""
        return self._steady[0][0] + self.deviations_start[:, 0]

    @cached_property
    def velocity_start(self) -> np.ndarray:
        """Modal velocities just before the touch [m kg^0.5 / s], shape (n_impacts, n_modes)."""
        return self._steady[0][1] + self.deviations_start[:, 1]

    @cached_property
    def displacement_end(self) -> np.ndarray:
        """Modal displacements just after the release [m kg^0.5], shape (n_impacts, n_modes)."""
        return self._steady[1][0] + self.deviations_end[:, 0]

    @cached_property
    def velocity_end(self) -> np.ndarray:
        """Modal velocities just after the release [m kg^0.5 / s], shape (n_impacts, n_modes)."""
        return self._steady[1][1] + self.deviations_end[:, 1]


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory:
    """A motion of an `oscillator`: strobed states, sampled states, every impact, and the state at the `end`.

    Parameters
    ----------
    strobe_time : ndarray, shape (n_strobes,)
        Times of the strobes passed, the start excluded [s].
    strobe_displacement, strobe_velocity : ndarray, shape (n_strobes, n_modes)
        Modal states at the strobes.
    strobe_impacts : ndarray of int, shape (n_strobes,)
        Impacts that began since the strobe before (or the start).
    time, displacement, velocity : ndarray, shapes (n_times,) and (n_times, n_modes)
        The times that were asked for [s], and the states at them.
    impacts, evaluations : Impacts, int
        Every touch; and steps, or flights and sampled positions, that the method has made.
    """

    oscillator: ImpactOscillator
    end: State
    strobe_time: np.ndarray
    strobe_displacement: np.ndarray
    strobe_velocity: np.ndarray
    strobe_impacts: np.ndarray
    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    impacts: Impacts = field(repr=False)
    evaluations: int = 0


def steady_states(motion: Motion, clock: float | np.ndarray) -> np.ndarray:
    """States (q_s, q_s') of the steady motion at times `clock` since a strobe, shape (..., 2, n_modes)."""
    return np.stack(steady_motion(motion, clock), axis=-2)


def deviations(motion: Motion, time: float, q: np.ndarray, q_rate: np.ndarray) -> np.ndarray:
    """Deviations (u, v) of the modal state (q, q') from the steady motion at a time, shape (2, n_modes)."""
    return np.array([q, q_rate]) - steady_states(motion, math.fmod(time, motion.period))
