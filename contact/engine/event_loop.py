"""The loop over flights and touches: flights in closed form, touches as their law has them.

A run goes from strobe to strobe, with time counted from the last strobe, so that a million periods bring no
loss of phase.  In each period a certified search (``contact.flight.crossing``) finds the first touch, or, if
that is asked for, the letter's sampled one (``contact.flight.sampled_crossing``); an impact law acts at once,
a force law is followed through the contact until the tip is off the wall again (``contact.touch``).  Periods
without a touch cost one multiplication by the flow of a period and a proof, most often by the lowest mode
alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import ModuleType
from typing import NamedTuple

import numpy as np

from contact import touch
from contact.engine.recorder import add_loss, close_touch, is_full, open_touch, put_sample, sample_due, strobe
from contact.flight.crossing import CROSSES, FREE, UNRESOLVED, searched_flight
from contact.flight.elementary import EPS
from contact.flight.modal_flow import apply_flow, carry, flow_over, load_state, new_flight, tip_state
from contact.flight.sampled_crossing import first_sampled_crossing
from contact.machine.compiled import borrowed, held, kernel, part
from contact.touch.newton import hold
from contact.touch.series import Series, new_series
from contact.trajectory import GRAZE, IMPACT, OUTSIDE, STAY, SUSTAINED

DONE, FAILED_CROSSING, FAILED_CHATTER, FAILED_STEPS, FAILED_SERIES, LOG_FULL = range(6)
GOING, CROSSED, GRAZED, RELEASED = range(-4, 0)
"""How a stretch of flights, or of steps in touch, ends besides: not yet; at a touch; at a graze; off the
wall."""

MOST_IMPACTS = 100_000
"""Bound of impacts in one drive period: accumulating impacts with e = 0.999 take about 2e4 before the hops
drown in rounding, so a longer sequence is not on its way to rest."""

MOST_STEPS = 200_000
"""Bound of flights and series steps in one drive period: 2e5 steps of two radians reach modes of 6e4 drive
frequencies, and with twelve modes they take half a second."""

STATE = np.dtype(
    [
        ("regime", "i8"),
        ("order", "i8"),
        ("period", "i8"),
        ("evaluations", "i8"),
        ("search", "i8"),
        ("steps", "i8"),
        ("clock", "f8"),
        ("wait", "f8"),
        ("rebound", "f8"),
        ("root", "f8"),
        ("speed", "f8"),
    ]
)
"""Where a run stands.

regime: ``contact.trajectory.Regime``; order: how many derivatives of the tip displacement vanish at the start
of the flight; period, clock: number of the drive period and time since its strobe [s]; evaluations: flights,
contact steps and sampled positions so far; search: 0 for certified crossings, else samples per period; steps:
flights and contact steps since the strobe.

Of the touch under way: wait, rebound: time until it ends by itself [s] and velocity with which the tip then
leaves [m/s]; root: sqrt of the penetration [m^0.5]; speed: the modal speeds at its start; both below zero
when they are to be computed anew.
"""


class Work(NamedTuple):
    """Room to work.

    flight : ndarray
        Of ``contact.flight.modal_flow``.
    whole, spaced : ndarray, shape (n_modes, 6)
        Flow over a drive period, and over the `spacing` of a sampled search [s].
    series : Series
        Of a step in touch.
    u, v : ndarray, shape (n_modes,)
    """

    flight: np.ndarray
    whole: np.ndarray
    spaced: np.ndarray
    spacing: float
    series: Series
    u: np.ndarray
    v: np.ndarray


@part
def new_work(motion, search):
    """Room to work for an oscillator."""
    spacing = motion.period / max(1, search)
    order, columns = touch.room(motion)
    return Work(
        new_flight(motion),
        flow_over(motion, motion.period),
        flow_over(motion, spacing),
        spacing,
        new_series(order, columns),
        np.empty(motion.size),
        np.empty(motion.size),
    )


@kernel
def sample_flight(motion, run, until, held_down, work, recorder):
    """States at the sample times of a flight, or of hops `held_down` on the wall, up to the clock `until`."""
    while sample_due(recorder, run.period, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        carry(motion, work.flight, time, work.u, work.v)
        if held_down:
            hold(motion, run.clock + time, work.u, work.v)
        put_sample(recorder, work.u, work.v)


@kernel
def sample_touch(motion, run, s, until, work, recorder):
    """States at the sample times of a step in touch that ends at `s`, at the clock `until`."""
    while sample_due(recorder, run.period, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        at = touch.place(motion, time, s, work.series)
        touch.state(motion, run, at, work.series, work.u, work.v)
        put_sample(recorder, work.u, work.v)


@part
def fly(motion, u, v, run, last, clock_end, work, recorder):
    """Flights from strobe to strobe, up to the next touch or the end of the run; how it ended."""
    flight, whole, marks = work.flight, work.whole, recorder.marks[0]
    strobes, counts, samples = recorder.strobes, recorder.counts, recorder.sample_clock.size
    status = GOING
    while status == GOING:
        base, at_last = run.clock, run.period == last
        end = clock_end if at_last else motion.period
        if base < end:
            load_state(flight, u, v)
            if run.search == 0:
                outcome, s = searched_flight(motion, flight, base, end - base, run.order)
            else:
                outcome, s, count = first_sampled_crossing(
                    motion, flight, base, end - base, run.order, work.spacing, work.spaced
                )
                run.evaluations += count
            run.evaluations += 1
            run.steps += 1
            until = end if outcome == FREE else base + s
            if marks.sampled < samples and outcome != UNRESOLVED:
                sample_flight(motion, run, until, False, work, recorder)
            if outcome == FREE and base == 0.0 and not at_last:
                apply_flow(whole, u, v)
            else:
                carry(motion, flight, s, u, v)
            run.clock = until
            if outcome == UNRESOLVED:
                status = FAILED_CROSSING
            elif outcome != FREE:
                status = CROSSED if outcome == CROSSES else GRAZED
            run.order = 0
        if status == GOING:
            if at_last:
                status = DONE
            else:
                strobe(marks, strobes, counts, u, v)
                run.clock, run.steps = 0.0, 0
                run.period += 1
    return status


@part
def land(motion, u, v, run, crosses, end, work, recorder):
    """What happens where a flight meets the stop."""
    approach = tip_state(motion, run.clock, u, v)[1]
    if crosses:
        open_touch(recorder, run.period, run.clock, approach, IMPACT, u, v)
        run.regime, rebound, loss = touch.strike(motion, run, u, v, approach)
        add_loss(recorder, loss)
        if run.regime == OUTSIDE or run.regime == SUSTAINED:
            close_touch(recorder, run.period, run.clock, rebound, u, v)
        if run.regime == SUSTAINED:
            # the remaining hops take a time run.wait, of which what lies after the strobe is below rounding
            open_touch(recorder, run.period, run.clock, rebound, STAY, u, v)
            rest = min(run.wait, end - run.clock)
            run.wait = 0.0
            if rest > 0.0:
                load_state(work.flight, u, v)
                sample_flight(motion, run, run.clock + rest, True, work, recorder)
                carry(motion, work.flight, rest, u, v)
                run.clock += rest
            hold(motion, run.clock, u, v)
    else:
        open_touch(recorder, run.period, run.clock, 0.0, GRAZE, u, v)
        close_touch(recorder, run.period, run.clock, 0.0, u, v)
        run.order = 2


def press_of(file: ModuleType) -> Callable[..., object]:
    """The steps in touch under one law: a law is told apart once a touch, not once a step."""
    step, state, work_done = file.step, file.state, file.work

    def press(motion, u, v, run, last, clock_end, work, recorder):
        """Steps in touch with the stop, up to the release or the end of the run; how it ended."""
        series, marks, logged = work.series, recorder.marks[0], recorder.log.size > 0
        strobes, counts, samples = recorder.strobes, recorder.counts, recorder.sample_clock.size
        status, loss = GOING, 0.0
        while status == GOING:
            base, at_last = run.clock, run.period == last
            end = clock_end if at_last else motion.period
            until = end
            if end - base > 4.0 * EPS * motion.period:
                s, h, following = step(motion, run, u, v, end - base, series)
                run.evaluations += 1
                run.steps += 1
                if run.steps > MOST_STEPS:
                    status = FAILED_STEPS
                elif not (0.0 <= h < math.inf):
                    status = FAILED_SERIES
                else:
                    until = base + h if h < end - base else end
                    if marks.sampled < samples:
                        sample_touch(motion, run, s, until, work, recorder)
                    if logged:
                        loss += work_done(motion, run, s, series)
                    state(motion, run, s, series, u, v)
                    run.regime, run.clock = following, until
                    if following == OUTSIDE:
                        status = RELEASED
            if status == GOING and until >= end:
                while sample_due(recorder, run.period, end):  # nearer to the end than a step can be
                    put_sample(recorder, u, v)
                if at_last:
                    run.clock, status = end, DONE
                else:
                    strobe(marks, strobes, counts, u, v)
                    run.clock, run.steps = 0.0, 0
                    run.period += 1
        add_loss(recorder, loss)
        return status

    return part(press)


press = touch.by_law({code: press_of(file) for code, file in touch.TOUCHES.items()})


@kernel
def advance(motion, u, v, runs, last, clock_end, recorder):
    """Carry the deviations (u, v) to the time `clock_end` after strobe `last`.

    Parameters
    ----------
    motion : Motion
    u, v : ndarray, shape (n_modes,)
        Deviations from the steady motion; overwritten.
    runs : record array of `STATE`, shape (1,)
        Where the run stands; overwritten.
    last : int
        Number of the last strobe.
    clock_end : float
        Time after it at which the run ends [s].
    recorder : Recorder

    Returns
    -------
    status : int
        DONE, LOG_FULL (call again with a longer log), or one of the failures.
    """
    run, room = runs[0], new_work(motion, runs[0].search)
    motion, u, v, recorder, work = (
        borrowed(motion),
        borrowed(u),
        borrowed(v),
        borrowed(recorder),
        borrowed(room),
    )
    status = GOING
    while status < DONE:
        if is_full(recorder):
            status = LOG_FULL
        elif recorder.marks[0].impacts > MOST_IMPACTS:
            status = FAILED_CHATTER
        elif run.steps > MOST_STEPS:
            status = FAILED_STEPS
        elif run.regime == OUTSIDE:
            status = fly(motion, u, v, run, last, clock_end, work, recorder)
        else:
            status = press(motion, u, v, run, last, clock_end, work, recorder)
        if status == CROSSED or status == GRAZED:
            end = clock_end if run.period == last else motion.period
            land(motion, u, v, run, status == CROSSED, end, work, recorder)
        elif status == RELEASED:
            touch.leave(motion, run, u, v)
            velocity = tip_state(motion, run.clock, u, v)[1]
            close_touch(recorder, run.period, run.clock, velocity, u, v)
    held(room)
    return status
