"""Contacts of the exact motion: their steps, the samples in them, and a second touch.

A contact is followed by the steps of its law (``contact.touch``) until the stop lets go.  With several stops
this serves laws that are followed alone.  Each step gives the heights over the other stops as power series,
and a touch of one of them ends the run.
"""

from collections.abc import Callable
from types import SimpleNamespace

from contact import touch
from contact.engine.recorder import put_sample, sample_due, strobe
from contact.flight.elementary import EPS
from contact.flight.numbers import NUMBERS, STACKED, TIME_SCALE, WEIGHT
from contact.flight.polynomial_root import first_polynomial_root
from contact.machine.compiled import kernel, part
from contact.state import STAY
from contact.touch.passage import AT_END, RELEASED, SECOND, TOO_MANY, add_exchange, follower, put_state
from contact.touch.series import fitted

DONE, FAILED_CROSSING, FAILED_CHATTER, FAILED_STEPS, FAILED_SERIES, FAILED_SECOND, LOG_FULL = range(7)
GOING, CROSSED, GRAZED = range(-3, 0)
"""Further statuses within the loop: not at an end; at a touch; at a graze."""

MOST_STEPS = 200_000
"""Bound of flights and contact steps in one drive period.  2e5 steps of two radians reach modes of 6e4 drive
frequencies; with twelve modes they take half a second."""


@kernel
def sample_touch(numbers, run, s, until, series, space, recorder):
    """Write states at the sample times of a contact step up to `s`, at the clock `until` [s]."""
    while sample_due(recorder, run.stretch, until):
        time = recorder.sample_clock[recorder.marks[0].sampled] - run.clock
        at = touch.series_variable(numbers, time, s, series)
        touch.state(numbers, run, at, series, space.u, space.v)
        put_sample(recorder, space.u, space.v)


@part
def rest_of_hops(run, stop, until, recorder):
    """How far a step up to the clock `until` [s] lies in the hops before a stay at a stop, whose row is open
    [s]."""
    row = recorder.log[recorder.marks[stop].row]
    if row.kind != STAY or row.stretch < run.stretch:
        return 0.0
    return max(0.0, (until if row.stretch > run.stretch else min(row.start, until)) - run.clock)


def reached(law: SimpleNamespace) -> Callable[..., tuple[float, float]]:
    """Where a step of a contact first reaches another stop; within rounding counts as a touch."""
    height_over, series_variable = law.height_over, law.series_variable

    def reaches(numbers, run, u, v, s, length, series, space):
        """The variable of the series and the time [s] at which a step touches another stop; both are negative
        if it touches none.  The step leads from (u, v) to `s` and lasts `length` [s]."""
        stops, out, first = space.stops, space.height, -1.0
        for j in range(stops.shape[0] // STACKED):
            weight, own = stops[STACKED * j + WEIGHT], stops[STACKED * j + NUMBERS]
            order = 0 if j == run.stop else height_over(numbers, run, weight, own, series, out)
            size, away, reach = abs(own[0]) + own[3] + own[4], 0.0, 1.0
            for k in range(u.size):
                size += abs(weight[k]) * (abs(u[k]) + abs(v[k]) * numbers.modes[TIME_SCALE, k])
            for n in range(1, order + 1):
                reach *= s
                away += abs(out[n]) * reach
            margin = 8.0 * EPS * size
            out[0] += 2.0 * margin
            if order > 0 and out[0] + away > -margin:
                out[order + 1 :] = 0.0
                root = first_polynomial_root(out, 1.0, s, margin)
                first = root if root >= 0.0 and (first < 0.0 or root < first) else first
        low, high = (-1.0, -1.0) if first < 0.0 else (0.0, length)
        for _ in range(60):
            middle = 0.5 * (low + high)
            before = series_variable(numbers, middle, s, series) < first
            low, high = (middle, high) if before else (low, middle)
        return first, high

    return kernel(reaches)


def recorded(law: SimpleNamespace) -> Callable[..., bool]:
    """The `Watch` of the event loop: samples are taken, what the tip gives to the stop is written."""
    exchange, state, reaches = law.exchange, law.state, reached(law)

    def watch(numbers, run, u, v, s, until, series, watcher):
        space, recorder = watcher
        if space.stops.shape[0] > STACKED:
            first, time = reaches(numbers, run, u, v, s, until - run.clock, series, space)
            if first >= 0.0:
                state(numbers, run, first, series, u, v)
                run.clock += time
                return True
        if sample_due(recorder, run.stretch, until):
            sample_touch(numbers, run, s, until, series, space, recorder)
        if recorder.log.size > 0:
            last, hops = recorder.marks[run.stop].row, rest_of_hops(run, run.stop, until, recorder)
            if hops > 0.0:
                state(numbers, run, hops, series, space.u, space.v)
                put_state(recorder.log_state[last], 0, space.u, space.v)
            known = recorder.log[last].peak_force
            work, impulse, force = exchange(numbers, run, (hops, s), series, known)
            add_exchange(recorder, run.stop, work, impulse, force)
        return False

    return part(watch)


follow = follower(recorded)


@part
def end_period(run, end, last, recorder, u, v):
    """End a drive period, or at the stretch `last` the run, at the clock `end`; returns the status."""
    while sample_due(recorder, run.stretch, end):  # samples closer to the end than any step
        put_sample(recorder, u, v)
    run.clock = end
    if run.stretch == last:
        return DONE
    strobe(run, recorder.marks[0], recorder.strobes, recorder.counts, u, v)
    return GOING


@part
def follow_contact(numbers, u, v, run, last, clock_end, space, recorder):
    """Follow a contact to its release or the end of the run; returns the status."""
    status, series = GOING, space.series
    if space.stops.shape[0] > STACKED:
        order, columns = touch.series_size(numbers)
        series = fitted(series, order, columns)
    while status == GOING:
        end = clock_end if run.stretch == last else numbers.period
        left = follow(numbers, u, v, run, end, MOST_STEPS, recorder, series, (space, recorder))
        if left == RELEASED:
            return GOING
        if left == SECOND:
            return FAILED_SECOND
        if left != AT_END:
            return FAILED_STEPS if left == TOO_MANY else FAILED_SERIES
        status = end_period(run, end, last, recorder, u, v)
    return status
