"""Which points stay at rest on their stops, and which hops end there, beside other contacts.

A point with d = d' = 0 stays under a force N >= 0, or leaves with d'' < 0.  Accelerations decide as
velocities do at an impact (``contact.touch.impulses``), with the pushes of all closed contacts.  Where
neither N nor d'' differs from zero within rounding, the next derivatives decide in the same way: this is so
at each release.  A point that all of them leave undecided stays.

Hops beside other contacts with speeds w over their stops, and impulses p that take these off, G p = w, end
after about W = 2 w.p/((1 - e) w.N), with the forces N that would hold the points at rest.  This is exact if a
single point hops and presses the others on: ``docs/theory/several.md``.
"""

import numpy as np

from contact.flight.numbers import DECAY, STACKED, WEIGHT, seen_from
from contact.flight.tip import tip_rounding
from contact.machine.compiled import kernel
from contact.state import CONTACT, OUTSIDE, SUSTAINED
from contact.touch.impulses import DEPENDENT, complementary
from contact.touch.newton import STEADY_PULL, STEADY_WANTED, acceleration_rounding, low_hop
from contact.touch.sets import CHANGES, IMPULSE, PASSIVE, fill
from contact.touch.time_series import ORDER


@kernel
def rounding_of_pull(numbers, stops, j, u, v, sets):
    """Bound of the rounding error of the acceleration over stop `j` [m/s^2]."""
    total = acceleration_rounding(seen_from(numbers, j), u, v)
    for i in range(stops.size):
        if stops[i].regime == CONTACT:
            other = seen_from(numbers, i)
            total += abs(sets.coupling[i, j]) * other.number0 * tip_rounding(other, u, v)
    return 4.0 * total


@kernel
def settle(numbers, clock, stops, u, v, sets):
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
    fill(numbers, clock, stops, u, v, 2, sets)
    for p in range(count):
        pull[p] = 2.0 * sets.heights[candidates[p], 2]
    complementary(sets.coupling, candidates, count, pull, push)
    unsure = 0
    for p in range(count):
        j, left = candidates[p], pull[p]
        for q in range(count):
            left -= sets.coupling[j, candidates[q]] * push[q]
        bound = rounding_of_pull(numbers, stops, j, u, v, sets)
        if push[p] * sets.coupling[j, j] > bound and sets.event[j] != CHANGES:
            stops[j].regime, stops[j].contact_order = SUSTAINED, 0
        elif not left < -bound or sets.event[j] == CHANGES:
            candidates[unsure] = j
            unsure += 1
    if unsure > 0:
        settle_by_jerk(numbers, clock, stops, u, v, candidates, unsure, sets)


@kernel
def settle_by_jerk(numbers, clock, stops, u, v, unsure, count, sets):
    """Decide over the stops `unsure`, beside those that stay: see `settle`."""
    held = fill(numbers, clock, stops, u, v, 3, sets)
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
        bound = numbers.fastest * rounding_of_pull(numbers, stops, j, u, v, sets)
        leaves = push[p] * free[at[p], at[p]] <= bound and (left < -bound or sets.event[j] == CHANGES)
        stops[j].regime, stops[j].contact_order = (OUTSIDE, 3) if leaves else (SUSTAINED, 0)


@kernel
def hops_end(numbers, run, stops, j, speed, u, v, sets):
    """Whether hops of this `speed` at stop `j` are a stay, see ``contact.touch.newton``.

    No other stop may be met before they end.
    """
    fill(numbers, run.clock, stops, u, v, ORDER, sets)
    seen, height = seen_from(numbers, j), sets.heights[j]
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
def hopping(numbers, clock, stops, speeds, u, v, sets):
    """W (1 - e) of hops that begin with these `speeds` over stops that then hold the points [s], and the rate
    at which they end earlier, as a part of W over W [1/s].

    The state (u, v) is that of the rest at which they end.  Row IMPULSE of ``Sets.values`` is filled with
    the impulses that take the speeds off, at each stop that holds its point.  Without a pull W is zero.
    """
    held, given = fill(numbers, clock, stops, u, v, 3, sets), sets.values[IMPULSE]
    decay, modes, mass, pull, rise, drag = numbers.modes[DECAY], numbers.modes, 0.0, 0.0, 0.0, 0.0
    given[:] = 0.0
    for a in range(held):
        j = sets.members[a]
        for b in range(held):
            given[j] += sets.inverse[a, b] * speeds[sets.members[b]]
        mass += speeds[j] * given[j]
        pull += speeds[j] * sets.forces[j, 0]
        rise += speeds[j] * sets.forces[j, 1]
    for k in range(decay.size):
        x = 0.0
        for a in range(held):
            x += given[sets.members[a]] * modes[STACKED * sets.members[a] + WEIGHT, k]
        drag += decay[k] * x * x
    for i in range(stops.size):
        if stops[i].regime == CONTACT:
            x = 0.0
            for a in range(held):
                x += given[sets.members[a]] * sets.coupling[sets.members[a], i]
            drag += seen_from(numbers, i).number1 * x * x
    if not (mass > 0.0 and pull > 0.0):
        return 0.0, 0.0
    return 2.0 * mass / pull, (rise / pull + 0.5 * drag / mass) / 3.0
