"""The record of a run: impacts, strobes and samples, for exact and fixed-step methods alike.

Times are kept as the number of a drive period and the time since its strobe, so that a million periods bring
no loss of phase.  A method with a time step counts from one strobe throughout, and has its strobes among the
samples (``contact.integrators.fixed_step``).  The record keeps the modal state (u, v) that the method
carries: deviations from the steady motion, or displacements and velocities themselves.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.errors import ContactError
from contact.flight.modal_flow import steady_motion
from contact.machine.compiled import inlined, kernel, part
from contact.oscillator import ImpactOscillator
from contact.trajectory import IMPACT, STAY, Impacts, Run, State, Trajectory, steady_states

MARKS = np.dtype([(name, "i8") for name in ("logged", "sampled", "strobed", "impacts", "touching")])
"""Rows in use of log, samples and strobes; impacts since the last strobe; whether the tip touches."""

LOG = np.dtype(
    [
        ("period", "i8"),
        ("start", "f8"),
        ("end_period", "i8"),
        ("end", "f8"),
        ("approach", "f8"),
        ("rebound", "f8"),
        ("loss", "f8"),
        ("kind", "i8"),
    ]
)
"""A touch: period and clock of its start and of its end [s], tip velocity at both [m/s], energy lost [J] and
``contact.trajectory.ImpactKind``."""


class Recorder(NamedTuple):
    """The arrays into which a run writes."""

    marks: np.ndarray  # `MARKS`, shape (1,)
    log: np.ndarray  # `LOG`, shape (capacity,); empty if no impacts are wanted
    log_state: np.ndarray  # (u, v) just before the touch and just after the release, (capacity, 4 n_modes)
    strobes: np.ndarray  # (u, v) at the strobes, shape (n_strobes, 2 n_modes) or (0, 2 n_modes)
    counts: np.ndarray  # impacts since the strobe before, shape (n_strobes,) or (0,)
    sample_period: np.ndarray  # times wanted: drive period and time since its strobe [s], shape (n,)
    sample_clock: np.ndarray
    samples: np.ndarray  # (u, v) at these times, shape (n, 2 n_modes)


@kernel
def strobes_only(strobes, counts):
    """A recorder of strobes and counts alone, either of which may be empty."""
    wide = strobes.shape[1]
    return Recorder(
        np.zeros(1, dtype=MARKS),
        np.empty(0, dtype=LOG),
        np.empty((0, 2 * wide)),
        strobes,
        counts,
        np.empty(0, dtype=np.int64),
        np.empty(0),
        np.empty((0, wide)),
    )


@part
def put_state(row, at, u, v):
    """Write (u, v) into a row from column `at` on."""
    n = u.size
    for k in range(n):
        row[at + k] = u[k]
        row[at + n + k] = v[k]


@part
def is_full(recorder):
    """Whether the log has no rows left for a touch and the stay that may follow it."""
    return recorder.log.size > 0 and recorder.marks[0].logged >= recorder.log.size - 1


@kernel
def open_touch(recorder, period, clock, approach, kind, u, v):
    """Start a row of the log."""
    marks = recorder.marks[0]
    marks.touching = 1
    marks.impacts += 1 if kind == IMPACT else 0
    i = marks.logged
    marks.logged += 1
    if recorder.log.size == 0:
        return
    row, n = recorder.log[i], u.size
    row.period, row.start, row.end_period, row.end = period, clock, period, math.nan
    row.approach, row.rebound, row.loss, row.kind = approach, math.nan, 0.0, kind
    put_state(recorder.log_state[i], 0, u, v)
    recorder.log_state[i, 2 * n :] = math.nan


@part
def add_loss(recorder, energy):
    """Add energy that the touch under way has taken [J]."""
    if recorder.log.size > 0:
        recorder.log[recorder.marks[0].logged - 1].loss += energy


@kernel
def close_touch(recorder, period, clock, rebound, u, v):
    """Complete the last row of the log."""
    recorder.marks[0].touching = 0
    if recorder.log.size == 0:
        return
    i = recorder.marks[0].logged - 1
    row = recorder.log[i]
    row.end_period, row.end, row.rebound = period, clock, rebound
    put_state(recorder.log_state[i], 2 * u.size, u, v)


@part
def sample_due(recorder, period, until):
    """Whether the next sample lies in this period, at or before the clock `until`."""
    i = recorder.marks[0].sampled
    clock = recorder.sample_clock
    return i < clock.size and recorder.sample_period[i] == period and clock[i] <= until


@part
def put_sample(recorder, u, v):
    """Write the state at the next sample time."""
    marks = recorder.marks[0]
    put_state(recorder.samples[marks.sampled], 0, u, v)
    marks.sampled += 1


@inlined
def strobe(marks, strobes, counts, u, v):
    """Write the state at the next strobe, and the impacts since the strobe before.

    It takes no recorder, since each array in a tuple costs some nanoseconds a call.
    """
    if counts.size > 0:
        counts[marks.strobed] = marks.impacts
    if strobes.shape[0] > 0:
        put_state(strobes[marks.strobed], 0, u, v)
    marks.strobed += 1
    marks.impacts = 0


def recorder_for(run: Run, n_modes: int) -> Recorder:
    """An empty recorder for the strobes and times of `run`."""
    strobes, times, capacity = run.last - run.first, run.times.size, 64
    return Recorder(
        marks=np.zeros(1, dtype=MARKS),
        log=np.zeros(capacity, dtype=LOG),
        log_state=np.empty((capacity, 4 * n_modes)),
        strobes=np.empty((strobes, 2 * n_modes)),
        counts=np.zeros(strobes, dtype=np.int64),
        sample_period=np.asarray(run.sample_period, dtype=np.int64),
        sample_clock=run.sample_clock,
        samples=np.empty((times, 2 * n_modes)),
    )


def grown(recorder: Recorder) -> Recorder:
    """The recorder with a log twice as long."""
    log, state = recorder.log, recorder.log_state
    return recorder._replace(
        log=np.concatenate([log, np.zeros_like(log)]), log_state=np.concatenate([state, np.empty_like(state)])
    )


def trajectory_of(
    recorder: Recorder,
    run: Run,
    end: State,
    oscillator: ImpactOscillator,
    *,
    evaluations: int,
    deviations: bool,
) -> Trajectory:
    """The record as named arrays.

    Samples at the end of the run that were not written get the state `end`.  `deviations` tells whether the
    record holds deviations from the steady motion, or else modal states.
    """
    n, marks, period, motion = oscillator.n_modes, recorder.marks[0], oscillator.period, oscillator.motion()
    left = slice(int(marks["sampled"]), None)
    if np.any((recorder.sample_period[left] < run.last) | (recorder.sample_clock[left] < run.clock_end)):
        tip = oscillator.tip(np.array([end.displacement, end.velocity]))
        place = {"time": end.time, "gap": oscillator.stop.gap - float(tip[0]), "velocity": float(tip[1])}
        raise ContactError(**place, detail="the state at one of the times was not written down")
    logged, passed = int(marks["logged"]), run.last - run.first
    log, touches = recorder.log[:logged], recorder.log_state[:logged].reshape(logged, 2, 2, n).copy()
    rows = np.concatenate((recorder.strobes, recorder.samples))
    q, v = rows[:, :n].copy(), rows[:, n:].copy()
    if deviations:
        steady, rate = steady_motion(motion, np.concatenate((np.zeros(passed), run.sample_clock)))
        q, v = q + steady, v + rate
    else:
        touches -= steady_states(motion, np.fmod(np.column_stack((log["start"], log["end"])), period))
    q[passed:][left], v[passed:][left] = end.displacement, end.velocity
    # a method with a step counts from one strobe throughout
    number = log["period"] + np.floor(log["start"] / period).astype(np.int64)
    impacts = Impacts(
        oscillator=oscillator,
        period=number,
        clock=(log["period"] - number) * period + log["start"],
        end_clock=(log["end_period"] - number) * period + log["end"],
        approach=log["approach"].copy(),
        rebound=log["rebound"].copy(),
        loss=np.where(np.isnan(log["end"]) & (log["kind"] != STAY), np.nan, log["loss"]),
        kind=log["kind"].copy(),
        deviations_start=touches[:, 0],
        deviations_end=touches[:, 1],
    )
    return Trajectory(
        oscillator=oscillator,
        end=end,
        strobe_time=np.arange(run.first + 1, run.last + 1) * period,
        strobe_displacement=q[:passed],
        strobe_velocity=v[:passed],
        strobe_impacts=recorder.counts,
        time=run.times,
        displacement=q[passed:],
        velocity=v[passed:],
        impacts=impacts,
        evaluations=int(evaluations),
    )
