"""Stops that are touched at once: instants at which one is met or let go, and the motion between them.

At an instant the impulses of Newton's law come first (``contact.touch.impulses``), for all stops that are
met within rounding and all at which a point rests.  Then contacts with a force begin and end.  Last,
accelerations decide which points stay at rest (``contact.touch.rests``).

Each stop has a state of its own, its regime and order (``Sets.states``).  That of the run names the first
stop that is closed, and its regime.
"""

import math

import numpy as np

from contact import touch
from contact.engine.contacts import FAILED_CHATTER, FAILED_SECOND, GOING
from contact.flight.elementary import EPS
from contact.flight.modal_flow import mode_acceleration
from contact.flight.numbers import NUMBERS, seen_from
from contact.flight.tip import tip_rounding, tip_state
from contact.laws import NEWTON
from contact.machine.compiled import kernel, part
from contact.state import CONTACT, IMPACT, INSIDE, OUTSIDE, STAY, SUSTAINED
from contact.touch.impulses import MOST, moreau, sequence
from contact.touch.newton import STEADY_PULL, newton_impact, restitution_at
from contact.touch.passage import add_exchange, begin, close_touch, meet, open_touch
from contact.touch.rests import hopping, hops_end, settle
from contact.touch.sets import AFTER, CHANGES, IMPULSE, LEAVES, LOSS, RESTITUTION, SPEED, hold, push_back

HOPS, STAYS = 3, 4  # events of a stop that an impulse has left with a velocity; that its hops lead to rest


@part
def rate_rounding(seen, u, v):
    """Bound of the rounding error of a velocity [m/s], by that of the height and the fastest change."""
    return tip_rounding(seen, u, v) * seen.fastest


@kernel
def meet_ties(numbers, run, stops, u, v, sets):
    """Go on to the last of the instants at which stops are met, if rounding leaves their order open.

    A stop that is met slowly is met within its rounding bound over its velocity.
    """
    later = 0.0
    for j in range(stops.size):
        slow = seen_from(numbers, j)
        if stops[j].regime == OUTSIDE and sets.event[j] == CHANGES:
            _height, rate, _pull = tip_state(slow, run.clock, u, v)
            for i in range(stops.size):
                height, faster, _pull = tip_state(seen_from(numbers, i), run.clock, u, v)
                late = -height / max(faster, rate)
                follows = stops[i].regime == OUTSIDE and faster > rate > 0.0
                if follows and late * rate <= tip_rounding(slow, u, v):
                    later = max(later, late)
    if later > 0.0:
        for k in range(u.size):
            pull = mode_acceleration(numbers, k, u[k], v[k])
            u[k] += later * v[k]
            v[k] += later * pull
        run.clock += later


@kernel
def strike_together(numbers, run, u, v, sets, recorder):
    """The impulses at all of Newton's stops that are met, or hold their point at rest; returns the status.

    Stops that are then left have the event `HOPS`; where no velocity is left the regime is SUSTAINED.
    """
    stops = sets.states
    members, values, count, hits = np.empty(stops.size, np.int64), np.empty((5, stops.size)), 0, 0
    for j in range(stops.size):
        seen, regime = seen_from(numbers, j), stops[j].regime
        if seen.law != NEWTON:
            continue
        height, rate, _pull = tip_state(seen, run.clock, u, v)
        near = abs(height) <= tip_rounding(seen, u, v) and rate > 0.0
        if regime == SUSTAINED or (regime == OUTSIDE and (near or sets.event[j] == CHANGES)):
            members[count] = j
            values[SPEED, count] = max(rate, 0.0) if regime == OUTSIDE else 0.0
            values[RESTITUTION, count] = restitution_at(seen, values[SPEED, count])[0]
            hits += 1 if regime == OUTSIDE else 0
            count += 1
    if hits == 0:
        return GOING
    if count > MOST:
        return FAILED_SECOND
    answer = values[IMPULSE], values[AFTER], values[LOSS]
    if numbers.modes[NUMBERS + 1, 6] == 0.0:
        moreau(sets.coupling, members, count, values[RESTITUTION], values[SPEED], answer)
    elif not sequence(sets.coupling, members, count, values[RESTITUTION], values[SPEED], answer):
        return FAILED_CHATTER
    for p in range(count):
        if stops[members[p]].regime == OUTSIDE:
            open_touch(recorder, members[p], run.stretch, run.clock, values[SPEED, p], IMPACT, u, v)
    for p in range(count):
        push_back(numbers.modes, members[p], values[IMPULSE, p], v)
    for p in range(count):
        j, after = members[p], values[AFTER, p]
        add_exchange(recorder, j, values[LOSS, p], values[IMPULSE, p], math.nan)
        if stops[j].regime == OUTSIDE:
            close_touch(recorder, j, run.stretch, run.clock, after, u, v)
            if recorder.log.size > 0:
                recorder.log[recorder.marks[j].row].together = 1 if count > 1 else 0
        leaves = after < -rate_rounding(seen_from(numbers, j), u, v)
        stops[j].regime, stops[j].contact_order = (OUTSIDE, 1) if leaves else (SUSTAINED, 0)
        sets.event[j] = HOPS if leaves else 0
    return GOING


@kernel
def change_contacts(numbers, run, u, v, sets, recorder):
    """Begin and end the contacts with a force; returns the status."""
    stops = sets.states
    for j in range(stops.size):
        seen, regime = seen_from(numbers, j), stops[j].regime
        if seen.law == NEWTON:
            continue
        height, rate, _pull = tip_state(seen, run.clock, u, v)
        rounding, own = tip_rounding(seen, u, v), stops[j]
        near = abs(height) <= rounding
        if regime == OUTSIDE:
            if not rate > 0.0 and sets.event[j] == CHANGES:
                own.contact_order = 1  # an impulse at this instant has turned it round
            elif rate > 0.0 and (near or sets.event[j] == CHANGES):
                run.stop = j
                for i in range(stops.size):
                    joined = touch.joins(seen) and touch.joins(seen_from(numbers, i))
                    if stops[i].regime != OUTSIDE and not joined:
                        return FAILED_SECOND
                begin(seen, run, u, v, recorder)
                own.regime, own.contact_order = run.regime, 0
        elif touch.joins(seen):
            push = touch.coefficient(seen, 0, (height, rate))
            if regime == CONTACT and (sets.event[j] == CHANGES or push < -rounding * seen.number0):
                own.regime = INSIDE if height > rounding else OUTSIDE
            elif regime == INSIDE and sets.event[j] != LEAVES and (sets.event[j] == CHANGES or push > 0.0):
                own.regime = CONTACT
            elif sets.event[j] == LEAVES:
                own.regime = OUTSIDE
            if own.regime == OUTSIDE:
                own.contact_order = 1
                close_touch(recorder, j, run.stretch, run.clock, rate, u, v)
    return GOING


@kernel
def end_of_hops(numbers, run, u, v, sets):
    """Put points to rest whose hops are low; returns the velocities of all points over their stops [m/s]."""
    stops = sets.states
    rates, low, closed = np.zeros(stops.size), False, False
    for j in range(stops.size):
        closed = closed or stops[j].regime != OUTSIDE
    for j in range(stops.size):
        seen = seen_from(numbers, j)
        _height, rates[j], pull = tip_state(seen, run.clock, u, v)
        if sets.event[j] == HOPS:
            speed = -rates[j]
            lowest = 1e3 * tip_rounding(seen, u, v) * pull / max(1.0 - seen.number0, EPS)
            low_enough = closed or 0.5 * speed * speed <= lowest
            if low_enough and hops_end(numbers, run, stops, j, speed, u, v, sets):
                sets.event[j], low = STAYS, True
    for j in range(stops.size):
        if sets.event[j] == STAYS:
            stops[j].regime = SUSTAINED
    if low:
        settle(numbers, run.clock, stops, u, v, sets)
    return rates


@kernel
def begin_stays(numbers, run, speeds, u, v, sets, recorder):
    """Open the rows of rests that hops of these `speeds` lead to; NaN for the other stops."""
    stops, some = sets.states, False
    hops = np.zeros(stops.size)
    for j in range(stops.size):
        hops[j], some = (0.0, some) if math.isnan(speeds[j]) else (speeds[j], True)
    if not some:
        return
    span, rate = hopping(numbers, run.clock, stops, hops, u, v, sets)
    given = sets.values[IMPULSE]
    for j in range(stops.size):
        if not math.isnan(speeds[j]):
            whole = span / max(1.0 - seen_from(numbers, j).number0, EPS)
            begins = whole * (1.0 - rate * whole)
            begins = begins if whole <= numbers.period and abs(rate * whole) < STEADY_PULL else 0.0
            late = int((run.clock + begins) / numbers.period)
            clock = run.clock + begins - late * numbers.period
            open_touch(recorder, j, run.stretch + late, clock, 0.0, STAY, u, v)
        if stops[j].regime == SUSTAINED:
            add_exchange(recorder, j, 0.5 * hops[j] * given[j], given[j], math.nan)


@kernel
def instant(numbers, run, u, v, sets, recorder):
    """What happens at an instant at which stops have an event, or are met; returns the status."""
    stops, before = sets.states, np.empty(sets.states.size, np.int64)
    for j in range(stops.size):
        before[j] = stops[j].regime
    meet_ties(numbers, run, stops, u, v, sets)
    status = strike_together(numbers, run, u, v, sets, recorder)
    if status == GOING:
        status = change_contacts(numbers, run, u, v, sets, recorder)
    if status != GOING:
        return status
    settle(numbers, run.clock, stops, u, v, sets)
    rates = end_of_hops(numbers, run, u, v, sets)
    hold(numbers, run.clock, stops, u, v, sets)
    for j in range(stops.size):
        stays = stops[j].regime == SUSTAINED
        if before[j] == SUSTAINED and not stays:
            close_touch(recorder, j, run.stretch, run.clock, rates[j], u, v)
        elif stops[j].regime == OUTSIDE and stops[j].contact_order == 1 and rates[j] > 0.0:
            stops[j].contact_order = 0  # an impulse at another stop sends the point back at once
        rates[j] = max(-rates[j], 0.0) if stays and before[j] != SUSTAINED else math.nan
        sets.event[j] = 0
    begin_stays(numbers, run, rates, u, v, sets, recorder)
    run.regime = OUTSIDE
    for j in range(stops.size - 1, -1, -1):
        if stops[j].regime != OUTSIDE:
            run.regime, run.stop = stops[j].regime, j
    return GOING


@part
def lone_impact(numbers, seen, run, u, v, recorder, sets):
    """The impact at a stop of Newton's law that is met alone, and left with more than low hops, while all are
    open.  This most frequent `instant` costs little; returns whether it was one."""
    height, rate, pull = tip_state(seen, run.clock, u, v)
    if seen.law != NEWTON:
        return False
    e, _slope = restitution_at(seen, rate)
    rebound, rounding, stop = e * rate, tip_rounding(seen, u, v), run.stop
    lowest = 1e3 * rounding * max(abs(pull), rounding * seen.fastest**2) / max(1.0 - e, EPS)
    if not 0.5 * rebound * rebound > lowest:
        return False
    for j in range(sets.states.size):
        if j != stop:
            other = seen_from(numbers, j)
            height, other_rate, pull = tip_state(other, run.clock, u, v)
            if other_rate > 0.0 and abs(height) <= tip_rounding(other, u, v) + other_rate * rounding / rate:
                return False
    open_touch(recorder, stop, run.stretch, run.clock, rate, IMPACT, u, v)
    newton_impact(seen, v, rate, e)
    impulse = (1.0 + e) * rate / seen.inverse_mass
    add_exchange(recorder, stop, 0.5 * (1.0 - e) * impulse * rate, impulse, math.nan)
    close_touch(recorder, stop, run.stretch, run.clock, -rebound, u, v)
    sets.states[stop].contact_order = 1
    return True


@kernel
def meet_several(numbers, run, u, v, crosses, recorder, sets):
    """A flight has met the stop of the run, or with `crosses` false grazes it; returns the status."""
    status = GOING
    seen = seen_from(numbers, run.stop)
    if not crosses:
        meet(seen, run, u, v, False, recorder)
        sets.states[run.stop].contact_order, run.contact_order = run.contact_order, 0
    elif not lone_impact(numbers, seen, run, u, v, recorder, sets):
        sets.event[:] = 0
        sets.event[run.stop] = CHANGES
        status = instant(numbers, run, u, v, sets, recorder)
    return status
