"""The loop over flights and touches: flights in closed form, touches by the contact law.

A run goes from strobe to strobe.  Time counts from the last strobe, so that a million periods lose no phase.
In each period a certified search (``contact.flight.crossing``) or, as an option, the letter's sampled search
(``contact.flight.sampled_crossing``) finds the first touch.  An impact law acts at once.  A force law is
followed through the contact until the tip leaves the wall (``contact.touch``).  A period without a touch
costs one multiplication by the flow of a period and a proof, most often from the lowest mode alone.

With several stops each flight is searched for a touch of one after the other, always up to the earliest touch
found so far.  ``contact.engine.together`` says what happens there, and ``contact.engine.sets`` follows the
contacts.
"""

from typing import NamedTuple

import numpy as np

from contact import touch
from contact.engine import contacts
from contact.engine.contacts import CROSSED, DONE, FAILED_CHATTER, GOING, GRAZED, LOG_FULL, MOST_STEPS
from contact.engine.recorder import sample_due, sample_flight, strobe
from contact.engine.sets import follow_several
from contact.engine.together import instant, meet_several
from contact.flight import modal_flow
from contact.flight.crossing import CROSSES, FREE, UNRESOLVED, searched_flight
from contact.flight.modal_flow import apply_flow, flow_over, load_state, new_flight, propagate_flight
from contact.flight.numbers import seen_from, stops_of
from contact.flight.sampled_crossing import first_sampled_crossing
from contact.machine.compiled import borrowed, held, kernel, part
from contact.state import OUTSIDE
from contact.touch import time_series
from contact.touch.passage import is_full, meet
from contact.touch.series import Series, new_series

MOST_IMPACTS = 100_000
"""Bound of impacts in one drive period.  Accumulating impacts with e = 0.999 take about 2e4 before the hops
are lost in rounding, so that a longer sequence does not come to rest."""


class Workspace(NamedTuple):
    """Workspace of a run."""

    flight: np.ndarray  # workspace of ``contact.flight.modal_flow``
    whole: np.ndarray  # flow over a drive period, shape (n_modes, 6)
    series: Series  # workspace of a contact step
    u: np.ndarray  # deviations at a sample, shape (n_modes,) each
    v: np.ndarray
    stops: np.ndarray  # the table of the motion, with all stops
    height: np.ndarray  # series of the height over another stop in a contact step, shape (order + 1,)


@part
def new_workspace(numbers):
    """Workspace for a run of an oscillator."""
    order, columns, several = 0, 0, stops_of(numbers) > 1
    if several:
        order, columns = time_series.ORDER, numbers.modes.shape[1]
    for j in range(stops_of(numbers)):
        own = touch.series_size(seen_from(numbers, j) if several else numbers)
        order, columns = max(order, own[0]), max(columns, own[1])
    flight, whole = new_flight(numbers), flow_over(numbers, numbers.period)
    series, u, v = new_series(order, columns), np.empty(numbers.size), np.empty(numbers.size)
    return Workspace(flight, whole, series, u, v, numbers.modes, np.empty(series.scalars.shape[1]))


@kernel
def earliest_touch(numbers, flight, base, duration, run, states):
    """The first touch of any of several stops: outcome and time as of ``searched_flight``, and its stop."""
    outcome, s, stop = FREE, duration, run.stop
    for j in range(stops_of(numbers)):
        found, at = searched_flight(seen_from(numbers, j), flight, base, s, states[j].contact_order)
        if found != FREE:
            outcome, s, stop = found, at, j
    for j in range(states.size):
        states[j].contact_order = 0 if s > 0.0 else states[j].contact_order
    return outcome, s, stop


@part
def follow_flights(numbers, u, v, run, run_end, space, recorder, samples, sets):
    """Follow flights from strobe to strobe, to the next touch or the end of the run; returns the status.

    `run_end` is the number of the period of the end, and its clock.
    """
    last, clock_end = run_end
    flight, whole, marks = space.flight, space.whole, recorder.marks[0]
    strobes, counts, status = recorder.strobes, recorder.counts, GOING
    while status == GOING:
        base, at_last = run.clock, run.stretch == last
        end = clock_end if at_last else numbers.period
        if base < end:
            load_state(flight, u, v)
            count, order = 0, run.contact_order
            if sets is not None:
                outcome, s, run.stop = earliest_touch(numbers, flight, base, end - base, run, sets.states)
            elif samples is None:
                outcome, s = searched_flight(numbers, flight, base, end - base, order)
            else:
                outcome, s, count = first_sampled_crossing(numbers, flight, base, end - base, order, samples)
            run.evaluations += count + 1
            run.steps += 1
            until = end if outcome == FREE else base + s
            if outcome != UNRESOLVED and sample_due(recorder, run.stretch, until):
                sample_flight(numbers, run, until, space, recorder)
            if outcome == FREE and base == 0.0 and not at_last:
                apply_flow(whole, u, v)
                if run.stretch % modal_flow.LOOK == 0:
                    modal_flow.clear_faint(u, v)
            else:
                propagate_flight(numbers, flight, s, u, v)
            run.clock = until
            if outcome == UNRESOLVED:
                status = contacts.FAILED_CROSSING
            elif outcome != FREE:
                status = CROSSED if outcome == CROSSES else GRAZED
            run.contact_order = 0
        if status == GOING:
            status = DONE if at_last else GOING
            if not at_last:
                strobe(run, marks, strobes, counts, u, v)
    return status


@kernel
def advance(numbers, u, v, runs, last, clock_end, recorder, samples, sets):
    """Carry the deviations (u, v), shape (n_modes,) each, to the time `clock_end` [s] after strobe `last`.

    They and `runs`, a record array of ``contact.touch.passage.STATE`` of shape (1,), are overwritten.
    Several stops need `sets`, ``contact.touch.sets.Sets``, and an order above zero in the run says that they
    are to be settled first.  With `samples`, ``contact.flight.sampled_crossing.Samples``, crossings are
    looked for at samples, with None they are proved.  Returns the status: DONE, LOG_FULL (call again with a
    longer log), or one of the failures.
    """
    run, workspace = runs[0], new_workspace(numbers)
    numbers, u, v, recorder = borrowed(numbers), borrowed(u), borrowed(v), borrowed(recorder)
    space = borrowed(workspace)
    status, rows = GOING, 2
    if sets is not None:
        rows = 2 * sets.states.size
        if run.contact_order > 0:
            run.contact_order, sets.event[:] = 0, 0
            status = instant(numbers, run, u, v, sets, recorder)
    while status < DONE:
        if is_full(recorder, rows):
            status = LOG_FULL
        elif recorder.marks[0].impacts > MOST_IMPACTS:
            status = FAILED_CHATTER
        elif run.steps > MOST_STEPS:
            status = contacts.FAILED_STEPS
        elif run.regime == OUTSIDE:
            status = follow_flights(numbers, u, v, run, (last, clock_end), space, recorder, samples, sets)
        elif sets is None:
            status = contacts.follow_contact(numbers, u, v, run, last, clock_end, space, recorder)
        else:
            status = follow_several(numbers, u, v, run, last, clock_end, space, recorder, sets)
        if status == CROSSED or status == GRAZED:
            if sets is None:
                meet(numbers, run, u, v, status == CROSSED, recorder)
            else:
                status = meet_several(numbers, run, u, v, status == CROSSED, recorder, sets)
    held(workspace)
    return status
