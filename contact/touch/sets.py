"""Contacts at several stops at the same time: their series in time, and where one of them ends.

Stops that hold their point at rest (Newton's law) and stops that push it (laws that offer `coefficient`, see
``contact.touch``) may be closed in any number.  The modes obey the equations of ``contact.touch.time_series``
under the sum of all forces.  Order n of the forces N at rest makes order n + 2 of the heights over these
stops zero, G N = pull, G = W W^T (``docs/theory/several.md``).  G is inverted when the set changes.

`Sets` keeps all series.  The heights over all stops are among them, so that a touch of an open stop is a root
as a release is.  A stop that has just been left has a height whose first orders vanish: it is divided by s to
this order.
"""

import math
from typing import NamedTuple

import numpy as np

from contact import touch
from contact.flight.elementary import EPS, sine_cosine
from contact.flight.numbers import DECAY, LOAD, NUMBERS, SQUARE, STACKED, WEIGHT, seen_from
from contact.flight.polynomial_root import first_polynomial_root
from contact.flight.tip import tip_rounding, tip_state
from contact.machine.compiled import aligned, kernel, part
from contact.state import CONTACT, INSIDE, OUTSIDE, SUSTAINED
from contact.touch.impulses import inverse_of
from contact.touch.newton import acceleration_rounding
from contact.touch.series import limited_by_force
from contact.touch.time_series import EDGE, ORDER, OVERFLOW, longest_of_modes

PASSIVE = 4  # order of a stop whose point rests because others hold it: it gives no force
CHANGES, LEAVES = 1, 2
"""Events of a stop: it is met, or its force ends or begins; its point leaves from behind the wall."""

SPEED, AFTER, IMPULSE, LOSS, RESTITUTION, PULL, ROOT = range(7)  # rows of `Sets.values`


class Sets(NamedTuple):
    """Workspace of contacts at several stops."""

    rows: np.ndarray  # coefficients of the modes, row n of order n, shape (order + 1, columns)
    heights: np.ndarray  # series of the height over each stop [m], shape (stops, order + 1)
    forces: np.ndarray  # and of its force [N]; behind the wall without force, of the force that waits there
    coupling: np.ndarray  # G, shape (stops, stops)
    inverse: np.ndarray  # of G over the stops that hold their point at rest, by their places in `members`
    members: np.ndarray  # numbers of some stops
    event: np.ndarray  # what happens at a stop at the end of a step: 0, CHANGES or LEAVES
    values: np.ndarray  # of the members, or of each stop, shape (7, stops)
    states: np.ndarray  # ``contact.touch.passage.STATE`` of each stop, of which regime and order count


@kernel
def new_sets(numbers, states):
    """A workspace of zeros for stops with these `states`, with their coupling."""
    count = states.size
    coupling, modes = np.zeros((count, count)), numbers.modes
    for i in range(count):
        for j in range(count):
            for k in range(modes.shape[1]):
                coupling[i, j] += modes[STACKED * i + WEIGHT, k] * modes[STACKED * j + WEIGHT, k]
    rows, inverse = aligned(ORDER + 1, modes.shape[1]), np.zeros((count, count))
    heights, forces = np.zeros((count, ORDER + 1)), np.zeros((count, ORDER + 1))
    members, event, values = np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros((7, count))
    return Sets(rows, heights, forces, coupling, inverse, members, event, values, states)


@part
def at_stop(modes, j, values):
    """The sum of modal values, of as many columns as the table has, at stop `j`."""
    total, weight = 0.0, modes[STACKED * j + WEIGHT]
    for k in range(values.size):
        total += weight[k] * values[k]
    return total


@part
def push_back(modes, j, push, values):
    """Take the share of a push of stop `j` off modal values."""
    weight = modes[STACKED * j + WEIGHT]
    for k in range(values.size):
        values[k] -= weight[k] * push


@kernel
def resting(stops, sets):
    """Gather the stops that hold their point at rest in `members`, with `inverse`; returns their number."""
    count = 0
    for j in range(stops.size):
        if stops[j].regime == SUSTAINED and stops[j].contact_order != PASSIVE:
            sets.members[count] = j
            count += 1
    inverse_of(sets.coupling, sets.members, count, sets.inverse)
    return count


@kernel
def fill(numbers, clock, stops, u, v, order, sets):
    """The series from (u, v) at the drive time `clock` [s], up to this order of modes and heights.

    Returns the number of stops that hold their point at rest, see `resting`.
    """
    modes, w, rows, heights, forces = numbers.modes, numbers.drive, sets.rows, sets.heights, sets.forces
    decay, square, load, count = modes[DECAY], modes[SQUARE], modes[LOAD], resting(stops, sets)
    sine, cosine = sine_cosine(w * clock, 0.0)
    for k in range(u.size):
        rows[0, k] = u[k]
        rows[1, k] = v[k]
    for j in range(stops.size):
        own, height = modes[STACKED * j + NUMBERS], heights[j]
        height[0], height[1] = own[1] * sine + own[2] * cosine, w * (own[1] * cosine - own[2] * sine)
        for n in range(order - 1):
            height[n + 2] = -w * w * height[n] / ((n + 1.0) * (n + 2.0))
        height[0] += own[0] + at_stop(modes, j, rows[0])
        height[1] += at_stop(modes, j, rows[1])
        forces[j, order - 1 :] = 0.0
    for n in range(order - 1):
        new, inverse, lift = rows[n + 2], 1.0 / ((n + 1.0) * (n + 2.0)), 1.0 if n == 0 else 0.0
        for k in range(new.size):
            pull = lift * load[k] - (n + 1.0) * decay[k] * rows[n + 1, k] - square[k] * rows[n, k]
            new[k] = inverse * pull
        for j in range(stops.size):
            forces[j, n], regime = 0.0, stops[j].regime
            if regime == CONTACT or regime == INSIDE:
                forces[j, n] = touch.coefficient(seen_from(numbers, j), n, heights[j])
            if regime == CONTACT:
                push_back(modes, j, inverse * forces[j, n], new)
        for a in range(count):
            member = sets.members[a]
            sets.values[PULL, a] = (heights[member, n + 2] + at_stop(modes, member, new)) / inverse
        for a in range(count):
            for b in range(count):
                forces[sets.members[a], n] += sets.inverse[a, b] * sets.values[PULL, b]
        for a in range(count):
            push_back(modes, sets.members[a], inverse * forces[sets.members[a], n], new)
        for j in range(stops.size):
            heights[j, n + 2] += at_stop(modes, j, new)
    return count


@kernel
def longest_step(numbers, stops, u, v, sets):
    """Longest time over which the neglected terms stay below rounding [s]; NaN if the series overflows."""
    stored, largest = 0.0, 0.0
    for j in range(stops.size):
        largest = max(largest, max(abs(sets.heights[j, ORDER]), abs(sets.forces[j, ORDER - 2])))
        if stops[j].regime == CONTACT:
            stored += abs(sets.forces[j, 0] * sets.heights[j, 0])
    if not largest < OVERFLOW:
        return math.nan
    h, speed = longest_of_modes(numbers, stored, u, v, sets.rows)
    for j in range(stops.size):
        if stops[j].regime == CONTACT or stops[j].regime == SUSTAINED:
            mobility = math.sqrt(sets.coupling[j, j])
            h = limited_by_force(h, sets.forces[j], ORDER - 2, mobility, speed, EDGE)
    return h


@kernel
def touch_of(height, order, h, margin):
    """Where the height over an open stop rises through zero within `h`, or -1; see the top of this file."""
    size, power, away = ORDER + 1 - order, 1.0, 0.0
    lowered = np.zeros(size)
    for n in range(size):
        lowered[n] = height[n + order]
        away += abs(lowered[n]) * power if n > 0 else 0.0
        power *= h
    margin = margin if order == 0 else EPS * (away + abs(lowered[0]))
    return -1.0 if lowered[0] + away < -margin else first_polynomial_root(lowered, 1.0, h, margin)


@kernel
def step(numbers, clock, stops, u, v, limit, sets):
    """One step of the contacts from (u, v), at most `limit` [s]; returns its length, or NaN without one.

    It ends at the first event of a stop; `event` holds all that come at this very instant.
    """
    count, first = fill(numbers, clock, stops, u, v, ORDER, sets), -1.0
    h = min(longest_step(numbers, stops, u, v, sets), limit)
    if not h > EPS * clock:
        return math.nan
    for j in range(stops.size):
        seen, regime, roots = seen_from(numbers, j), stops[j].regime, sets.values[ROOT]
        margin, leaves, roots[j], sets.event[j] = tip_rounding(seen, u, v), -1.0, -1.0, 0
        if regime == OUTSIDE:
            roots[j] = touch_of(sets.heights[j], stops[j].contact_order, h, margin)
        elif regime == CONTACT:
            roots[j] = first_polynomial_root(sets.forces[j], -1.0, h, margin * seen.number0)
        elif regime == INSIDE:
            roots[j] = first_polynomial_root(sets.forces[j], 1.0, h, margin * seen.number0)
            leaves = first_polynomial_root(sets.heights[j], -1.0, h, margin)
        elif stops[j].contact_order != PASSIVE:
            margin = 0.0
            for a in range(count):
                for b in range(count):
                    if sets.members[a] == j:
                        pull = acceleration_rounding(seen_from(numbers, sets.members[b]), u, v)
                        margin += abs(sets.inverse[a, b]) * pull
            roots[j] = first_polynomial_root(sets.forces[j], -1.0, h, margin)
        if leaves >= 0.0 and (roots[j] < 0.0 or leaves <= roots[j]):
            roots[j], sets.event[j] = leaves, LEAVES
        if roots[j] >= 0.0 and (first < 0.0 or roots[j] < first):
            first = roots[j]
    for j in range(stops.size):
        at_once = first >= 0.0 and sets.values[ROOT, j] == first
        sets.event[j] = max(sets.event[j], CHANGES) if at_once else 0
    return first if first >= 0.0 else h


@kernel
def hold(numbers, clock, stops, u, v, sets):
    """Put the points that rest on their stops there, at rest."""
    count, values = resting(stops, sets), sets.values
    for a in range(count):
        seen = seen_from(numbers, sets.members[a])
        values[SPEED, a], values[AFTER, a], _pull = tip_state(seen, clock, u, v)
    for a in range(count):
        height, rate = 0.0, 0.0
        for b in range(count):
            height += sets.inverse[a, b] * sets.values[SPEED, b]
            rate += sets.inverse[a, b] * sets.values[AFTER, b]
        push_back(numbers.modes, sets.members[a], height, u)
        push_back(numbers.modes, sets.members[a], rate, v)
