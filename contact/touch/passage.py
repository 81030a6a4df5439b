"""The passage of a touch, from its strike to its release, and the record of touches.

A touch begins with the strike: the law acts at once (`begin`, `meet`).  If the law then keeps the tip on the
wall, the contact is followed step by step until it releases the tip (`follower`).  The event loop
(``contact.engine.event_loop``) and the flow with tangents (``contact.sensitivity.touch_flow``) go this same
way.  They differ only in what they do at each step, the *watch*: one takes samples, the other carries the
tangents along.

The record keeps times as the number of a drive period and the time since its strobe, so that a million
periods bring no loss of phase.  In an orbit they count from its first touch.  States are those that the
method carries: deviations from the steady motion, or displacements and velocities themselves.
"""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from beam.parameters import Array
from contact import touch
from contact.flight.elementary import EPS
from contact.flight.tip import hold, tip_state
from contact.machine.compiled import kernel, part
from contact.state import GRAZE, IMPACT, OUTSIDE, STAY, SUSTAINED

MARKS = np.dtype([(name, "i8") for name in ("logged", "sampled", "strobed", "impacts", "touching", "row")])
"""Rows in use of log, samples and strobes, and impacts since the last strobe, all in the first record;
whether a stop is touched, and the row of its last touch, in the record of its number."""

_NAMES = "stretch start end_stretch end approach rebound loss impulse peak_force kind stop together".split()
_WHOLE = ("stretch", "end_stretch", "kind", "stop", "together")
TOUCH = np.dtype([(name, "i8" if name in _WHOLE else "f8") for name in _NAMES])
"""A touch: stretch and clock of its start and of its end [s], velocity towards the stop at both [m/s], energy
given to the stop [J], impulse [N s] and largest force [N] (NaN if not known),
``contact.state.ImpactKind``, number of the stop, and whether others acted at this instant."""


class Touches(NamedTuple):
    """Touches in the order in which they began; a record with more fields can stand in its place."""

    marks: np.ndarray  # `MARKS`, shape (1,), or one for each of several stops
    log: np.ndarray  # `TOUCH`, shape (capacity,); empty if no touches are wanted
    log_state: np.ndarray  # (u, v) just before the touch and just after the release, (capacity, 4 n_modes)
    slopes: np.ndarray  # derivatives of start and approach along tangents, (capacity, 2, columns)

    @property
    def states(self) -> Array:
        """(u, v) just before and just after each touch, shape (capacity, 2, 2, n_modes)."""
        return self.log_state.reshape(len(self.log), 2, 2, -1)


def new_touches(capacity: int, n_modes: int, stops: int = 1, columns: int = 0) -> Touches:
    """An empty record with a place for `capacity` touches, and for their derivatives along `columns`."""
    rows = np.zeros(capacity, TOUCH), np.empty((capacity, 4 * n_modes)), np.empty((capacity, 2, columns))
    return Touches(np.zeros(stops, MARKS), *rows)


@part
def put_state(row, at, u, v):
    """Write (u, v) into a row from column `at` on."""
    n = u.size
    for k in range(n):
        row[at + k] = u[k]
        row[at + n + k] = v[k]


@part
def is_full(record, rows=2):
    """Whether the log has less than so many `rows` left, one for a touch and one for a stay that follows."""
    return record.log.size > 0 and record.marks[0].logged > record.log.size - rows


@kernel
def open_touch(record, stop, stretch, clock, approach, kind, u, v):
    """Start a row of the log, for a touch of the stop of this number."""
    marks, own = record.marks[0], record.marks[stop]
    i = marks.logged
    own.touching, own.row = 1, i
    marks.impacts += 1 if kind == IMPACT else 0
    marks.logged += 1
    if record.log.size == 0:
        return
    row, n = record.log[i], u.size
    row.stretch, row.start, row.end_stretch, row.end = stretch, clock, stretch, math.nan
    row.approach, row.rebound, row.loss, row.kind, row.stop = approach, math.nan, 0.0, kind, stop
    row.impulse, row.peak_force, row.together = math.nan, math.nan, 0
    put_state(record.log_state[i], 0, u, v)
    record.log_state[i, 2 * n :] = math.nan


@part
def add_exchange(record, stop, work, impulse, force):
    """Add work [J], impulse [N s] and largest force [N] (NaN if it has none) to the last touch of a stop."""
    if record.log.size > 0:
        row = record.log[record.marks[stop].row]
        row.loss += work
        row.impulse = impulse if math.isnan(row.impulse) else row.impulse + impulse
        row.peak_force = row.peak_force if force <= row.peak_force else force


@kernel
def close_touch(record, stop, stretch, clock, rebound, u, v):
    """Complete the row of the last touch of a stop."""
    record.marks[stop].touching = 0
    if record.log.size == 0:
        return
    i = record.marks[stop].row
    row = record.log[i]
    row.end_stretch, row.end, row.rebound = stretch, clock, rebound
    put_state(record.log_state[i], 2 * u.size, u, v)


STATE = np.dtype(
    [(name, "i8") for name in ("regime", "contact_order", "stop", "stretch", "evaluations", "steps")]
    + [(name, "f8") for name in ("clock", "wait", "rebound", "memory0", "memory1")]
)
"""The state of a motion besides its deviations: ``contact.state.State`` for kernels.

regime, wait, rebound: as there; contact_order: number of derivatives of the height over `stop` that vanish at
the start of the flight; stop: number of the stop that is touched or was the last to be; stretch,
clock: as in ``contact.flight.clock``; evaluations: flights, contact steps and sampled positions so far;
steps: flights and contact steps since the strobe;
memory0, memory1: what the law keeps of the touch under way for itself, negative when to be computed anew.
"""

RELEASED, AT_END, TOO_MANY, NO_STEP, SECOND = range(5)
"""How a contact is left: released; at the end of the time; after too many steps; at a step of no length; at
a touch of a second stop."""

CLOSEST = 4.0 * EPS  # part of a drive period next to the end in which no step is made

Watch = Callable[[SimpleNamespace], Callable[..., bool]]
"""From a law of ``touch.LAWS`` to watch(numbers, run, u, v, s, until, series, watcher), done at each step.
The step leads from (u, v) at the clock of the run to `s`, in the law's own variable, at the clock `until`.
It returns whether a second stop is touched on the way."""


@part
def begin(numbers, run, u, v, touches):
    """The strike of a touch: the law acts at once; returns the approach and the rebound velocity [m/s].

    The touch is written into the record `touches`, and closed unless the contact lasts.
    """
    approach = tip_state(numbers, run.clock, u, v)[1]
    open_touch(touches, run.stop, run.stretch, run.clock, approach, IMPACT, u, v)
    run.regime, rebound, loss, impulse = touch.strike(numbers, run, u, v, approach)
    add_exchange(touches, run.stop, loss, impulse, math.nan)
    if run.regime == OUTSIDE or run.regime == SUSTAINED:
        close_touch(touches, run.stop, run.stretch, run.clock, rebound, u, v)
    return approach, rebound


@part
def meet(numbers, run, u, v, crosses, touches):
    """A flight has met the stop: a touch begins, or with `crosses` false it is a graze, without effect.

    Accumulated impacts become a stay: their last hops are left out.  It begins when these would have ended,
    and their energy is its loss.
    """
    if not crosses:
        open_touch(touches, run.stop, run.stretch, run.clock, 0.0, GRAZE, u, v)
        add_exchange(touches, run.stop, 0.0, 0.0, 0.0)
        close_touch(touches, run.stop, run.stretch, run.clock, 0.0, u, v)
        run.contact_order = 2
    else:
        _approach, rebound = begin(numbers, run, u, v, touches)
        if run.regime == SUSTAINED:
            hold(numbers, run.clock, u, v)
            late = int((run.clock + run.memory0) / numbers.period)
            begins = run.clock + run.memory0 - late * numbers.period
            open_touch(touches, run.stop, run.stretch + late, begins, 0.0, STAY, u, v)
            work, impulse = 0.5 * rebound * rebound / numbers.inverse_mass, rebound / numbers.inverse_mass
            add_exchange(touches, run.stop, work, impulse, math.nan)
            run.memory0 = -1.0


def _follow(law: SimpleNamespace, watch: Callable[..., bool]) -> Callable[..., int]:
    """`follower` for one law, so that the law is looked up once a touch and not once a step."""
    step, state, leave = law.step, law.state, law.leave

    def follow(numbers, u, v, run, end, most, touches, series, watcher):
        """Follow a contact to its release, or to the clock `end`; returns how it is left.

        At most `most` steps are made since the strobe.  A release is written into the record `touches`.
        """
        while end - run.clock > CLOSEST * numbers.period:
            s, h, following = step(numbers, run, u, v, end - run.clock, series)
            run.evaluations += 1
            run.steps += 1
            if run.steps > most:
                return TOO_MANY
            if not (0.0 <= h < math.inf):
                return NO_STEP
            until = run.clock + h if h < end - run.clock else end
            if watch(numbers, run, u, v, s, until, series, watcher):
                return SECOND
            state(numbers, run, s, series, u, v)
            run.regime, run.clock = following, until
            if following == OUTSIDE:
                velocity = leave(numbers, run, u, v)
                close_touch(touches, run.stop, run.stretch, run.clock, velocity, u, v)
                return RELEASED
        return AT_END

    return part(follow)


def follower(watch: Watch) -> Callable[..., int]:
    """The compiled way through a contact under any law, with a `watch` on each step."""
    return touch.by_law({code: _follow(law, watch(law)) for code, law in touch.LAWS.items()})
