"""The loop over flights and touches: flights in closed form, touches by the contact law.

A run goes from strobe to strobe.  Time counts from the last strobe, so that a million periods lose no phase.
In each period a certified search (``contact.flight.crossing``) or, as an option, the letter's sampled search
(``contact.flight.sampled_crossing``) finds the first touch.  An impact law acts at once.  A force law is
followed through the contact until the tip leaves the wall (``contact.touch``).  A period without a touch
costs one multiplication by the flow of a period and a proof, most often from the lowest mode alone.
"""

import math
from collections.abc import Callable
from types import ModuleType
from typing import NamedTuple

import numpy as np

from contact import touch
from contact.engine.recorder import add_loss, close_touch, is_full, open_touch, put_sample, sample_due, strobe
from contact.flight.crossing import CROSSES, FREE, UNRESOLVED, searched_flight
from contact.flight.elementary import EPS
from contact.flight.modal_flow import (
    apply_flow,
    flow_over,
    load_state,
    new_flight,
    propagate_flight,
    tip_state,
)
from contact.flight.sampled_crossing import first_sampled_crossing
from contact.machine.compiled import borrowed, held, kernel, part
from contact.touch.newton import hold
from contact.touch.series import Series, new_series
from contact.trajectory import GRAZE, IMPACT, OUTSIDE, STAY, SUSTAINED

DONE, FAILED_CROSSING, FAILED_CHATTER, FAILED_STEPS, FAILED_SERIES, LOG_FULL = range(6)
GOING, CROSSED, GRAZED, RELEASED = range(-4, 0)
"""Further statuses within the loop: not at an end; at a touch; at a graze; off the wall."""

MOST_IMPACTS = 100_000
"""Bound of impacts in one drive period.  Accumulating impacts with e = 0.999 take about 2e4 before the hops
are lost in rounding, so that a longer sequence does not come to rest."""

MOST_STEPS = 200_000
"""Bound of flights and contact steps in one drive period.  2e5 steps of two radians reach modes of 6e4 drive
frequencies; with twelve modes they take half a second."""

INTEGERS = ("regime", "contact_order", "period", "evaluations", "search", "steps")
STATE = np.dtype(
    [(name, "i8") for name in INTEGERS]
    + [(name, "f8") for name in ("clock", "wait", "rebound", "root", "speed")]
)
"""The state of a run.

regime: ``contact.trajectory.Regime``; contact_order: number of derivatives of the tip displacement that
vanish at the start of the flight; period, clock: number of the drive period and time since its strobe [s];
evaluations: flights, contact steps and sampled positions so far; search: 0 for certified crossings, otherwise
samples per period; steps: flights and contact steps since the strobe.

Of the touch under way: wait, rebound: time until it ends by itself [s] and tip velocity after that [m/s];
root: sqrt of the penetration [m^0.5]; speed: the modal speeds at its start; both are negative when they are
to be computed anew.
"""


class Workspace(NamedTuple):
    """Workspace of a run."""

    flight: np.ndarray  # workspace of ``contact.flight.modal_flow``
    whole: np.ndarray  # flow over a drive period, shape (n_modes, 6)
    spaced: np.ndarray  # flow over the `spacing`, shape (n_modes, 6)
    spacing: float  # time between samples of a sampled search [s]
    series: Series  # workspace of a contact step
    u: np.ndarray  # deviations at a sample, shape (n_modes,) each
    v: np.ndarray


@part
def new_workspace(motion, search):
    """Workspace for a run of an oscillator."""
    spacing = motion.period / max(1, search)
    order, columns = touch.series_size(motion)
    return Workspace(
        new_flight(motion),
        flow_over(motion, motion.period),
        flow_over(motion, spacing),
        spacing,
        new_series(order, columns),
        np.empty(motion.size),
        np.empty(motion.size),
    )


@kernel
def sample_flight(motion, run, until, space, recorder):
    """Write states at the sample times of a flight up to `until` [s]."""
    while sample_due(recorder, run.period, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        propagate_flight(motion, space.flight, time, space.u, space.v)
        put_sample(recorder, space.u, space.v)


@kernel
def sample_touch(motion, run, s, until, space, recorder):
    """Write states at the sample times of a contact step up to `s`, at the clock `until` [s]."""
    while sample_due(recorder, run.period, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        at = touch.series_variable(motion, time, s, space.series)
        touch.state(motion, run, at, space.series, space.u, space.v)
        put_sample(recorder, space.u, space.v)


@part
def follow_flights(motion, u, v, run, last, clock_end, space, recorder):
    """Follow flights from strobe to strobe, to the next touch or the end of the run; returns the status."""
    flight, whole, marks = space.flight, space.whole, recorder.marks[0]
    strobes, counts, samples = recorder.strobes, recorder.counts, recorder.sample_clock.size
    status = GOING
    while status == GOING:
        base, at_last = run.clock, run.period == last
        end = clock_end if at_last else motion.period
        if base < end:
            load_state(flight, u, v)
            if run.search == 0:
                outcome, s = searched_flight(motion, flight, base, end - base, run.contact_order)
            else:
                outcome, s, count = first_sampled_crossing(
                    motion, flight, base, end - base, run.contact_order, space.spacing, space.spaced
                )
                run.evaluations += count
            run.evaluations += 1
            run.steps += 1
            until = end if outcome == FREE else base + s
            if marks.sampled < samples and outcome != UNRESOLVED:
                sample_flight(motion, run, until, space, recorder)
            if outcome == FREE and base == 0.0 and not at_last:
                apply_flow(whole, u, v)
            else:
                propagate_flight(motion, flight, s, u, v)
            run.clock = until
            if outcome == UNRESOLVED:
                status = FAILED_CROSSING
            elif outcome != FREE:
                status = CROSSED if outcome == CROSSES else GRAZED
            run.contact_order = 0
        if status == GOING:
            if at_last:
                status = DONE
            else:
                strobe(marks, strobes, counts, u, v)
                run.clock, run.steps = 0.0, 0
                run.period += 1
    return status


@part
def handle_crossing(motion, u, v, run, crosses, recorder):
    """Let the law act where a flight meets the stop; without `crosses` the touch is a graze."""
    approach = tip_state(motion, run.clock, u, v)[1]
    if crosses:
        open_touch(recorder, run.period, run.clock, approach, IMPACT, u, v)
        run.regime, rebound, loss = touch.strike(motion, run, u, v, approach)
        add_loss(recorder, loss)
        if run.regime == OUTSIDE or run.regime == SUSTAINED:
            close_touch(recorder, run.period, run.clock, rebound, u, v)
        if run.regime == SUSTAINED:
            # the hops that are left are a stay, and their energy is its loss
            open_touch(recorder, run.period, run.clock, rebound, STAY, u, v)
            add_loss(recorder, 0.5 * rebound * rebound / motion.inverse_mass)
            hold(motion, run.clock, u, v)
    else:
        open_touch(recorder, run.period, run.clock, 0.0, GRAZE, u, v)
        close_touch(recorder, run.period, run.clock, 0.0, u, v)
        run.contact_order = 2


def contact_follower(file: ModuleType) -> Callable[..., object]:
    """`follow_contact` for one law, so that the law is looked up once a touch and not once a step."""
    step, state, work = file.step, file.state, file.work

    def follow_contact(motion, u, v, run, last, clock_end, space, recorder):
        """Follow a contact to its release or the end of the run; returns the status."""
        series, marks, logged = space.series, recorder.marks[0], recorder.log.size > 0
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
                        sample_touch(motion, run, s, until, space, recorder)
                    if logged:
                        loss += work(motion, run, s, series)
                    state(motion, run, s, series, u, v)
                    run.regime, run.clock = following, until
                    if following == OUTSIDE:
                        status = RELEASED
            if status == GOING and until >= end:
                while sample_due(recorder, run.period, end):  # samples closer to the end than any step
                    put_sample(recorder, u, v)
                if at_last:
                    run.clock, status = end, DONE
                else:
                    strobe(marks, strobes, counts, u, v)
                    run.clock, run.steps = 0.0, 0
                    run.period += 1
        add_loss(recorder, loss)
        return status

    return part(follow_contact)


follow_contact = touch.by_law({code: contact_follower(file) for code, file in touch.TOUCHES.items()})


@kernel
def advance(motion, u, v, runs, last, clock_end, recorder):
    """Carry the deviations (u, v), shape (n_modes,) each, to the time `clock_end` [s] after strobe `last`.

    They and `runs`, a record array of `STATE` of shape (1,), are overwritten.  Returns the status: DONE,
    LOG_FULL (call again with a longer log), or one of the failures.
    """
    run, workspace = runs[0], new_workspace(motion, runs[0].search)
    motion, u, v, recorder = borrowed(motion), borrowed(u), borrowed(v), borrowed(recorder)
    space = borrowed(workspace)
    status = GOING
    while status < DONE:
        if is_full(recorder):
            status = LOG_FULL
        elif recorder.marks[0].impacts > MOST_IMPACTS:
            status = FAILED_CHATTER
        elif run.steps > MOST_STEPS:
            status = FAILED_STEPS
        elif run.regime == OUTSIDE:
            status = follow_flights(motion, u, v, run, last, clock_end, space, recorder)
        else:
            status = follow_contact(motion, u, v, run, last, clock_end, space, recorder)
        if status == CROSSED or status == GRAZED:
            handle_crossing(motion, u, v, run, status == CROSSED, recorder)
        elif status == RELEASED:
            touch.leave(motion, run, u, v)
            velocity = tip_state(motion, run.clock, u, v)[1]
            close_touch(recorder, run.period, run.clock, velocity, u, v)
    held(workspace)
    return status
