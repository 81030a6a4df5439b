"""The record of a run: impacts, strobes and samples, for exact and fixed-step methods alike.

Touches are kept as in ``contact.touch.passage``, and times alike.  A method with a time step counts from one
strobe throughout, and has its strobes among the samples (``contact.integrators.fixed_step``).
"""

from typing import NamedTuple

import numpy as np

from contact.engine.plan import Plan
from contact.errors import ContactError
from contact.flight.modal_flow import propagate_flight, steady_motion
from contact.impacts import Impacts, steady_states
from contact.machine.compiled import inlined, kernel, part
from contact.oscillator import ImpactOscillator
from contact.state import STAY, State
from contact.touch.passage import MARKS, TOUCH, new_touches, put_state
from contact.trajectory import Trajectory

COPIED = "approach", "rebound", "loss", "impulse", "peak_force", "kind", "stop"  # columns of the log


class Recorder(NamedTuple):
    """The arrays into which a run writes; the first three make a ``touch.passage.Touches``."""

    marks: np.ndarray
    log: np.ndarray
    log_state: np.ndarray
    strobes: np.ndarray  # (u, v) at the strobes, shape (n_strobes, 2 n_modes) or (0, 2 n_modes)
    counts: np.ndarray  # impacts since the strobe before, shape (n_strobes,) or (0,)
    sample_stretch: np.ndarray  # times wanted, as stretches and clocks [s], shape (n,)
    sample_clock: np.ndarray
    samples: np.ndarray  # (u, v) at these times, shape (n, 2 n_modes)


@kernel
def strobes_only(strobes, counts):
    """A recorder of strobes and counts alone, either of which may be empty."""
    wide = strobes.shape[1]
    marks, log, log_state = np.zeros(1, dtype=MARKS), np.empty(0, dtype=TOUCH), np.empty((0, 2 * wide))
    stretch, clock, samples = np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, wide))
    return Recorder(marks, log, log_state, strobes, counts, stretch, clock, samples)


@part
def sample_due(recorder, stretch, until):
    """Whether the next sample lies in this stretch, at or before the clock `until`."""
    i = recorder.marks[0].sampled
    clock = recorder.sample_clock
    return i < clock.size and recorder.sample_stretch[i] == stretch and clock[i] <= until


@part
def put_sample(recorder, u, v):
    """Write the state at the next sample time."""
    marks = recorder.marks[0]
    put_state(recorder.samples[marks.sampled], 0, u, v)
    marks.sampled += 1


@kernel
def sample_flight(numbers, run, until, space, recorder):
    """Write states at the sample times of a flight up to `until` [s]."""
    while sample_due(recorder, run.stretch, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        propagate_flight(numbers, space.flight, time, space.u, space.v)
        put_sample(recorder, space.u, space.v)


@inlined
def strobe(run, marks, strobes, counts, u, v):
    """A drive period ends: write the state at the strobe, and the impacts since the strobe before.

    It takes no recorder, since each array in a tuple costs some nanoseconds a call.
    """
    run.clock, run.steps = 0.0, 0
    run.stretch += 1
    if counts.size > 0:
        counts[marks.strobed] = marks.impacts
    if strobes.shape[0] > 0:
        put_state(strobes[marks.strobed], 0, u, v)
    marks.strobed += 1
    marks.impacts = 0


def recorder_for(plan: Plan, n_modes: int, stops: int = 1) -> Recorder:
    """An empty recorder for the strobes and times of `plan`, and a number of stops."""
    touches, passed = new_touches(64, n_modes, stops), plan.last - plan.first  # the log grows by itself
    strobes, counts = np.empty((passed, 2 * n_modes)), np.zeros(passed, dtype=np.int64)
    samples = np.zeros((plan.times.size, 2 * n_modes))  # the last may stay as they are
    return Recorder(*touches[:3], strobes, counts, plan.sample_stretch, plan.sample_clock, samples)


def grown(recorder: Recorder) -> Recorder:
    """The recorder with a log twice as long."""
    log, state = recorder.log, recorder.log_state
    log, state = np.concatenate([log, np.zeros_like(log)]), np.concatenate([state, np.empty_like(state)])
    return recorder._replace(log=log, log_state=state)


def trajectory_of(
    recorder: Recorder, plan: Plan, end: State, oscillator: ImpactOscillator, count: int, *, deviations: bool
) -> Trajectory:
    """The record as named arrays, with a `count` of evaluations.

    Samples at the end of the run that were not written get the state `end`.  With `deviations` the record
    holds deviations from the steady motion, without it modal states.
    """
    n, marks, period, numbers = oscillator.n_modes, recorder.marks[0], oscillator.period, oscillator.stacked()
    left = slice(int(marks["sampled"]), None)
    if np.any((recorder.sample_stretch[left] < plan.last) | (recorder.sample_clock[left] < plan.clock_end)):
        place = {"time": end.time, "gap": -float(oscillator.heights(end.displacement)[0])}
        place["velocity"] = float(oscillator.tip(end.velocity))
        raise ContactError(**place, detail="the state at one of the times was not written down")
    logged, passed = int(marks["logged"]), plan.last - plan.first
    log, touches = recorder.log[:logged].copy(), recorder.log_state[:logged].reshape(logged, 2, 2, n).copy()
    rows = np.concatenate((recorder.strobes, recorder.samples))
    q, v = rows[:, :n].copy(), rows[:, n:].copy()
    if deviations:
        steady, rate = steady_motion(numbers, np.concatenate((np.zeros(passed), plan.sample_clock)))
        q, v = q + steady, v + rate
    else:
        touches -= steady_states(numbers, np.fmod(np.column_stack((log["start"], log["end"])), period))
    q[passed:][left], v[passed:][left] = end.displacement, end.velocity
    # a stay whose hops the release or the end of the run cuts short
    opened, last = np.isnan(log["end"]), np.where(np.isnan(log["end"]), plan.last, log["end_stretch"])
    until = (last - log["stretch"]) * period + np.where(opened, plan.clock_end, log["end"])
    late = (log["kind"] == STAY) & (log["start"] > until)
    log["start"][late] = until[late]
    # a method with a step counts from one strobe throughout
    number = log["stretch"] + np.floor(log["start"] / period).astype(np.int64)
    impacts = Impacts(
        oscillator=oscillator,
        stretch=number,
        clock=(log["stretch"] - number) * period + log["start"],
        end_clock=(log["end_stretch"] - number) * period + log["end"],
        **{name: log[name].copy() for name in COPIED},
        together=log["together"] == 1,
        deviations_start=touches[:, 0],
        deviations_end=touches[:, 1],
    )
    return Trajectory(
        oscillator=oscillator,
        end=end,
        strobe_time=np.arange(plan.first + 1, plan.last + 1) * period,
        strobe_displacement=q[:passed],
        strobe_velocity=v[:passed],
        strobe_impacts=recorder.counts,
        time=plan.times,
        displacement=q[passed:],
        velocity=v[passed:],
        impacts=impacts,
        evaluations=int(count),
    )
