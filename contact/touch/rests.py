"""Which points stay at rest on their stops, and which hops end there, beside other contacts.

A point with d = d' = 0 stays under a force N >= 0, or leaves with d'' < 0.  Accelerations decide as
velocities do at an impact (``contact.touch.impulses``), with the pushes of all closed contacts.  Where
neither N nor d'' differs from zero within rounding, the next derivatives decide in the same way: this is so
at each release.  A point that all of them leave undecided stays.  If other stops hold it as well, it rests
without a force.

Hops beside other contacts end as those of ``contact.touch.newton`` do.  Their pull is that under the other
contacts, and the mean force of the hops is the force that would hold the point at rest beside them.
"""

import math

import numpy as np

from contact.flight.elementary import EPS
from contact.flight.modal_flow import tip_rounding
from contact.flight.motion import DECAY, STACKED, WEIGHT, seen_from, stops_of
from contact.machine.compiled import kernel
from contact.touch.impulses import DEPENDENT, complementary
from contact.touch.newton import STEADY_PULL, STEADY_WANTED, acceleration_rounding, low_hop
from contact.touch.passage import STATE
from contact.touch.sets import CHANGES, PASSIVE, fill, hold, new_sets
from contact.touch.time_series import ORDER
from contact.trajectory import CONTACT, IMPACT, OUTSIDE, STAY, SUSTAINED


@kernel
def rounding_of_pull(motion, stops, j, u, v, sets):
    """Bound of the rounding error of the acceleration over stop `j` [m/s^2]."""
    total = acceleration_rounding(seen_from(motion, j), u, v)
    for i in range(stops.size):
        if stops[i].regime == CONTACT:
            other = seen_from(motion, i)
            total += abs(sets.coupling[i, j]) * other.number0 * tip_rounding(other, u, v)
    return 4.0 * total


@kernel
def settle(motion, clock, stops, u, v, sets):
    """Decide over all stops at rest, regime SUSTAINED: they stay so, or are OUTSIDE with the order at which
    the point leaves.  A stop with an event has a force that falls through zero."""
    candidates, count = np.empty(stops.size, np.int64), 0
    for j in range(stops.size):
        if stops[j].regime == SUSTAINED:
            candidates[count] = j
            stops[j].regime, stops[j].contact_order = OUTSIDE, 2
            count += 1
    if count == 0:
        return
    pull, push = np.empty(count), np.empty(count)
    fill(motion, clock, stops, u, v, 2, sets)
    for p in range(count):
        pull[p] = 2.0 * sets.heights[candidates[p], 2]
    complementary(sets.coupling, candidates, count, pull, push)
    unsure = 0
    for p in range(count):
        j, left = candidates[p], pull[p]
        for q in range(count):
            left -= sets.coupling[j, candidates[q]] * push[q]
        bound = rounding_of_pull(motion, stops, j, u, v, sets)
        if push[p] * sets.coupling[j, j] > bound and sets.event[j] != CHANGES:
            stops[j].regime, stops[j].contact_order = SUSTAINED, 0
        elif not left < -bound or sets.event[j] == CHANGES:
            candidates[unsure] = j
            unsure += 1
    if unsure > 0:
        settle_by_jerk(motion, clock, stops, u, v, candidates, unsure, sets)


@kernel
def settle_by_jerk(motion, clock, stops, u, v, unsure, count, sets):
    """Decide over the stops `unsure`, beside those that stay: see `settle`."""
    held = fill(motion, clock, stops, u, v, 3, sets)
    members, inverse, free = sets.members, sets.inverse, np.empty((count, count))
    for p in range(count):
        for q in range(count):
            free[p, q] = sets.coupling[unsure[p], unsure[q]]
            for a in range(held):
                for b in range(held):
                    left, right = sets.coupling[unsure[p], members[a]], sets.coupling[members[b], unsure[q]]
                    free[p, q] -= left * inverse[a, b] * right
    at, size = np.empty(count, np.int64), 0
    for p in range(count):
        j = unsure[p]
        if free[p, p] > DEPENDENT * sets.coupling[j, j]:
            at[size] = p
            size += 1
        else:
            stops[j].regime, stops[j].contact_order = SUSTAINED, PASSIVE
    if size == 0:
        return
    jerk, push = np.empty(size), np.empty(size)
    for p in range(size):
        jerk[p] = 6.0 * sets.heights[unsure[at[p]], 3]
    complementary(free, at, size, jerk, push)
    for p in range(size):
        j, left = unsure[at[p]], jerk[p]
        for q in range(size):
            left -= free[at[p], at[q]] * push[q]
        bound = motion.fastest * rounding_of_pull(motion, stops, j, u, v, sets)
        leaves = push[p] * free[at[p], at[p]] <= bound and (left < -bound or sets.event[j] == CHANGES)
        stops[j].regime, stops[j].contact_order = (OUTSIDE, 3) if leaves else (SUSTAINED, 0)


@kernel
def hops_end(motion, run, stops, j, speed, u, v, sets):
    """Whether hops of this `speed` at stop `j` are a stay, see ``contact.touch.newton``.

    No other stop may be met before they end.
    """
    fill(motion, run.clock, stops, u, v, ORDER, sets)
    seen, height = seen_from(motion, j), sets.heights[j]
    pull = 2.0 * height[2]
    verdict = low_hop(seen, run.clock, pull, speed, tip_rounding(seen, u, v))
    if verdict != STEADY_WANTED:
        return verdict > 0
    whole, change, power = 2.0 * speed / (pull * (1.0 - seen.number0)), 0.0, 1.0
    for n in range(3, ORDER + 1):
        power *= whole
        change += n * (n - 1.0) * abs(height[n]) * power
    if change > STEADY_PULL * pull:
        return False
    for i in range(stops.size):
        if i != j and stops[i].regime == OUTSIDE:
            other, order = sets.heights[i], stops[i].contact_order
            near, power = other[order], 1.0
            for n in range(order + 1, ORDER + 1):
                power *= whole
                near += abs(other[n]) * power
            if near >= 0.0:
                return False
    return True


@kernel
def hopping(motion, clock, stops, j, speed, u, v, sets):
    """W of hops that begin with this `speed` at stop `j` [s], the part by which they end earlier [1], and the
    mass that hops [kg].

    The state (u, v) is that of the rest at which they end.  The mass is zero if stop `j` gives no force.
    """
    held, share, drag = fill(motion, clock, stops, u, v, 3, sets), 0.0, 0.0
    decay, modes = motion.modes[DECAY], motion.modes
    for a in range(held):
        if sets.members[a] == j:
            share = sets.inverse[a, a]
            for k in range(decay.size):
                x = 0.0
                for b in range(held):
                    x += sets.inverse[a, b] * modes[STACKED * sets.members[b] + WEIGHT, k]
                drag += decay[k] * x * x / share
            for i in range(stops.size):
                if stops[i].regime == CONTACT:
                    x = 0.0
                    for b in range(held):
                        x += sets.inverse[a, b] * sets.coupling[sets.members[b], i]
                    drag += seen_from(motion, i).number1 * x * x / share
    if not (share > 0.0 and sets.forces[j, 0] > 0.0):
        return 0.0, 0.0, share
    pull, jerk = sets.forces[j, 0] / share, sets.forces[j, 1] / share
    lost = pull * (1.0 - seen_from(motion, j).number0)
    whole = 2.0 * speed / lost if lost > 0.0 else math.inf
    return whole, (jerk + 0.5 * drag * pull) * whole / (3.0 * pull), share


@kernel
def date_stays(motion, log, states):
    """Date the stays of a finished log by the impacts before them, as ``newton.improve`` does for one stop.

    Hops count while the other stops stay as they are: open, or closed to the end of the hops.
    """
    count = stops_of(motion)
    sets, stops, latest = new_sets(motion, count), np.zeros(count, STATE), np.full(count, -1)
    for i in range(log.size):
        stay, j, least, rest, back, following = log[i], log[i].stop, math.inf, 0.0, 1, 1
        seen, since = seen_from(motion, j), -math.inf
        for other in range(count):
            stops[other].regime = OUTSIDE
            if stay.kind == STAY and other != j and latest[other] >= 0:
                row = log[latest[other]]
                ended = (row.end_period - stay.period) * motion.period + row.end - stay.start
                if not ended < 0.0:
                    stops[other].regime = SUSTAINED if row.kind == STAY else CONTACT
                else:
                    since = max(since, ended)
        stops[j].regime, same = SUSTAINED, i if seen.table.shape[1] == 0 else 1
        lost = max(1.0 - seen.number0, EPS)
        while stay.kind == STAY and back <= same and log[i - back].kind == IMPACT and log[i - back].stop == j:
            row, u, v = log[i - back], states[i - back, 1, 0].copy(), states[i - back, 1, 1].copy()
            before = (row.period - stay.period) * motion.period + row.start
            if before - stay.start < since:
                break
            if back == following:
                following += 1 + back // 4
                rounding = tip_rounding(seen, u, v)
                hold(motion, row.start, stops, u, v, sets)
                whole, sooner, _mass = hopping(motion, row.start, stops, j, -row.rebound, u, v, sets)
                error = whole * (sooner**2 + (whole * motion.fastest) ** 2)
                error += rounding / max(-row.rebound * lost * lost, 1e-300)
                found = before + whole * (1.0 - sooner)
                if 0.0 < whole and error < least and (back == 1 or abs(found - rest) <= least):
                    least, rest = error, found
            back += 1
        if least < math.inf:
            stay.start = rest
            hold(motion, rest, stops, states[i, 0, 0], states[i, 0, 1], sets)
        latest[j] = i
