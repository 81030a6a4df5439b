"""Contacts at several stops, followed together from one instant to the next.

Each step of the closed contacts (``contact.touch.sets``) ends at the next touch or release of a stop, and
``contact.engine.together`` says what happens there.
"""

from contact import touch
from contact.engine import contacts
from contact.engine.contacts import GOING, MOST_STEPS, end_period, follow_contact, rest_of_hops
from contact.engine.recorder import put_sample, sample_due
from contact.engine.together import instant
from contact.flight.numbers import seen_from
from contact.machine.compiled import kernel, part
from contact.state import CONTACT, INSIDE, OUTSIDE, SUSTAINED
from contact.touch import time_series
from contact.touch.exchange import UNIFORM, exchange_of
from contact.touch.passage import CLOSEST, add_exchange, put_state
from contact.touch.series import Series, fitted
from contact.touch.sets import hold, step


@kernel
def exchange_together(numbers, run, stops, s, until, series, sets, space, recorder):
    """Write what the points give to the stops in a step up to `s`, at the clock `until` [s]."""
    rates = series.scalars[time_series.RATE]
    for j in range(stops.size):
        if stops[j].regime == CONTACT or stops[j].regime == SUSTAINED:
            row, hops = recorder.marks[j].row, rest_of_hops(run, j, until, recorder)
            if hops > 0.0:
                time_series.state(numbers, run, hops, series, space.u, space.v)
                put_state(recorder.log_state[row], 0, space.u, space.v)
            for n in range(time_series.ORDER):
                rates[n] = (n + 1.0) * sets.heights[j, n + 1]
            span, known = (hops, s), recorder.log[row].peak_force
            work, impulse, force = exchange_of(series, sets.forces[j], rates, UNIFORM, span, known)
            add_exchange(recorder, j, work if stops[j].regime == CONTACT else 0.0, impulse, force)
        elif stops[j].regime == INSIDE:
            known = recorder.log[recorder.marks[j].row].peak_force
            add_exchange(recorder, j, 0.0, 0.0, max(known, 0.0))


@part
def follow_together(numbers, u, v, run, last, clock_end, space, recorder, sets):
    """Follow closed contacts to the next instant or the end of the run; returns the status."""
    stops, whole = sets.states, space.series
    whole = fitted(whole, time_series.ORDER, numbers.modes.shape[1])
    series = Series(sets.rows, whole.sums, whole.scalars, whole.scaled, whole.places)
    status = GOING
    while status == GOING:
        end = clock_end if run.stretch == last else numbers.period
        while end - run.clock > CLOSEST * numbers.period:
            s = step(numbers, run.clock, stops, u, v, end - run.clock, sets)
            run.evaluations += 1
            run.steps += 1
            if run.steps > MOST_STEPS:
                return contacts.FAILED_STEPS
            if not s >= 0.0:
                return contacts.FAILED_SERIES
            until = run.clock + s if s < end - run.clock else end
            while sample_due(recorder, run.stretch, until):
                time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
                time_series.state(numbers, run, time, series, space.u, space.v)
                hold(numbers, run.clock + time, stops, space.u, space.v, sets)
                put_sample(recorder, space.u, space.v)
            if recorder.log.size > 0:
                exchange_together(numbers, run, stops, s, until, series, sets, space, recorder)
            time_series.state(numbers, run, s, series, u, v)
            run.clock = until
            hold(numbers, run.clock, stops, u, v, sets)
            happens = 0
            for j in range(stops.size):
                happens = max(happens, sets.event[j])
                if stops[j].regime == OUTSIDE and s > 0.0:
                    stops[j].contact_order = 0
            if happens > 0:
                return instant(numbers, run, u, v, sets, recorder)
        status = end_period(run, end, last, recorder, u, v)
    return status


@kernel
def follow_several(numbers, u, v, run, last, clock_end, space, recorder, sets):
    """Follow closed contacts, or one under a law that is followed alone; returns the status."""
    seen, own = seen_from(numbers, run.stop), sets.states[run.stop]
    if touch.joins(seen):
        return follow_together(numbers, u, v, run, last, clock_end, space, recorder, sets)
    status = follow_contact(seen, u, v, run, last, clock_end, space, recorder)
    own.regime, own.contact_order, run.contact_order = run.regime, run.contact_order, 0
    return status
