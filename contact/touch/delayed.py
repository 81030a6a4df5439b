"""A rebound that waits: the tip stays on the wall for a time, then leaves (``DelayedRestitution``).

One mode, met at time t with approach velocity v = y'(t) > 0, tau and delta the law's two numbers at this
speed, sampled in a table with their slopes.  At t + delta the tip, y = phi u + a S + b C + level, has

    y = 0,      y' = -tau(v) v,

while the drive (S, C) has turned by w delta: the deviations (u, u') on the wall (regime WAITING) and after it
are linear in the drive, and hold nothing of those before the touch but v.

A neighbour whose tip stands `reach` higher at t, and moves faster by `rate`, comes to the stop later by
dt = -reach/v, hits it faster by dv = rate + y''(t) dt, and leaves it later by d = dt + delta' dv.  Seen at
t + delta, its tip there differs by

    reach -> tau v d,      rate -> -(tau + tau' v) dv - y''(t + delta) d,

the saltation matrix of this law, of determinant tau (tau + tau' v); without delay and slopes that of
Newton's.
"""

from __future__ import annotations

import numpy as np

from contact.flight.modal_flow import push_on, tip_state
from contact.flight.variation import FIRST, all_tip_changes, tangent_flight
from contact.machine.compiled import kernel, part
from contact.touch import newton
from contact.trajectory import OUTSIDE, WAITING

LAW = "DelayedRestitution"
REGIMES = (OUTSIDE, WAITING)

force, stiffness, slopes, room, place, work = (
    newton.force,
    newton.stiffness,
    newton.slopes,
    newton.room,
    newton.place,
    newton.work,
)

RESTITUTION, DELAY = 1, 3
"""Rows of the table, each with its slope behind; the first holds the approach speeds."""


@kernel
def hermite(table, row, low, high, h, s):
    """Value and slope of row `row` at the part `s` of the way `h` [m/s] between two columns."""
    a, b = table[row, low], table[row, high]
    da, db = h * table[row + 1, low], h * table[row + 1, high]
    square, cube = 3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db
    return a + s * (da + s * (square + s * cube)), (da + s * (2.0 * square + 3.0 * s * cube)) / h


@kernel
def numbers_at(table, speed):
    """Restitution [1], its slope [s/m], delay [s] and its slope [s^2/m] at an approach speed [m/s].

    They are those of the cubics through values and slopes of a law's table; beyond it the end values hold.
    """
    n = table.shape[1]
    if speed <= table[0, 0]:
        return table[RESTITUTION, 0], 0.0, table[DELAY, 0], 0.0
    if speed >= table[0, n - 1]:
        return table[RESTITUTION, n - 1], 0.0, table[DELAY, n - 1], 0.0
    high = np.searchsorted(table[0], speed, "right")
    low = high - 1
    h = table[0, high] - table[0, low]
    s = (speed - table[0, low]) / h
    restitution, restitution_slope = hermite(table, RESTITUTION, low, high, h, s)
    delay, delay_slope = hermite(table, DELAY, low, high, h, s)
    return restitution, restitution_slope, delay, delay_slope


@kernel
def strike(motion, run, u, v, approach):
    """The touch: how long the tip will wait, and with which velocity it will leave."""
    restitution, _slope, run.wait, _slope = numbers_at(motion.table, approach)
    run.rebound = -restitution * approach
    return WAITING, run.rebound, 0.5 * (approach * approach - run.rebound**2) / motion.compliance


@part
def step(motion, run, u, v, limit, series):
    """The wait, at most `limit` [s]; see ``contact.touch``."""
    h = min(run.wait, limit)
    run.wait -= h
    return h, h, WAITING if run.wait > 0.0 else OUTSIDE


@part
def state(motion, run, h, series, u, v):
    """The deviation a time `h` [s] into the wait."""
    u[0], v[0] = 0.0, 0.0
    newton.hold(motion, run.clock + h, u, v)


@part
def leave(motion, run, u, v):
    """The rebound."""
    newton.newton_impact(motion, v, -run.rebound, 0.0)
    run.order = 1 if run.rebound < 0.0 else 2


@kernel
def saltation(motion, vary, before, after, tangent):
    """The tangents over the touch, with the wait; see ``contact.touch``."""
    share = push_on(motion, 0, -1.0 / motion.compliance)  # of the one mode in a change at the tip: 1/phi
    clock, u, v = before
    _height, approach, pull_in = tip_state(motion, clock, u, v)
    restitution, restitution_slope, delay, delay_slope = numbers_at(motion.table, approach)
    _height, _velocity, pull_out = tip_state(motion, after[0], after[1], after[2])
    reach, rate = all_tip_changes(vary, tangent, u, v, clock)
    first = reach.size - len(vary.rest)
    for j in range(reach.size):
        late = -reach[j] / approach
        faster = rate[j] + pull_in * late
        late += delay_slope * faster
        slower = -(restitution + restitution_slope * approach) * faster
        if j >= first:
            late += vary.rest[j - first, FIRST + 1]
            slower -= vary.rest[j - first, FIRST] * approach
        reach[j], rate[j] = restitution * approach * late, slower - pull_out * late
    # (u, v) after the wait are what is left to the mode; the drive turns as in a flight
    tangent_flight(vary, tangent, np.zeros(1), np.zeros(1), clock, delay)
    tangent[:2] = 0.0
    own = all_tip_changes(vary, tangent, after[1], after[2], after[0])
    for j in range(reach.size):
        tangent[0, j], tangent[1, j] = share * (reach[j] - own[0][j]), share * (rate[j] - own[1][j])
