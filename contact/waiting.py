"""The touch that waits: the tip is held on the stop for a delay, then leaves with a part of its speed.

One mode, met at time t with approach velocity v = y'(t) > 0, tau and delta the law's two numbers at this
speed (``contact.laws.DelayedRestitution``).  At t + delta the tip, y = phi u + a S + b C + level, has

    y = 0,      y' = -tau(v) v,

while the drive (S, C) has turned by w delta: the deviations (u, u') after the touch are linear in the drive,
and hold nothing of those before it but v.

A neighbour whose tip stands `reach` higher at t, and moves faster by `rate`, comes to the stop later by
dt = -reach/v, hits it faster by dv = rate + y''(t) dt, and leaves it later by d = dt + delta' dv.  Seen at
t + delta, its tip there differs by

    reach -> tau v d,      rate -> -(tau + tau' v) dv - y''(t + delta) d,

the saltation matrix of this law, of determinant tau (tau + tau' v); without delay and slopes that of Newton's.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

from contact.compiled import kernel
from contact.flight import tip_state, tip_steady

__all__ = ["numbers_at", "waiting_touch"]


@kernel
def numbers_at(table, speed):
    """Restitution [1], its slope [s/m], delay [s] and its slope [s^2/m] at an approach speed [m/s].

    They are those of the cubics through values and slopes of a law's table; beyond it the end values hold.
    """
    n = table.shape[1]
    if speed <= table[0, 0]:
        return table[1, 0], 0.0, table[3, 0], 0.0
    if speed >= table[0, n - 1]:
        return table[1, n - 1], 0.0, table[3, n - 1], 0.0
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[0, middle] <= speed:
            low = middle
        else:
            high = middle
    h = table[0, high] - table[0, low]
    s = (speed - table[0, low]) / h
    restitution, restitution_slope = hermite(table, 1, low, high, h, s)
    delay, delay_slope = hermite(table, 3, low, high, h, s)
    return restitution, restitution_slope, delay, delay_slope


@kernel
def hermite(table, row, low, high, h, s):
    """Value and slope of row `row` at the part `s` of the way `h` [m/s] between two columns."""
    a, b = table[row, low], table[row, high]
    da, db = h * table[row + 1, low], h * table[row + 1, high]
    square, cube = 3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db
    return a + s * (da + s * (square + s * cube)), (da + s * (2.0 * square + 3.0 * s * cube)) / h


@kernel
def waiting_touch(motion, response_sine, response_cosine, base, u, v, approach, tangent):
    """Carry the deviation (u, v), shape (1,) each, and its tangents through the wait: delay [s], rebound [m/s].

    Parameters are those of ``contact.tangent.flow_from_touch``; `base` is the drive time of the touch [s] and
    `approach` the velocity with which it is met [m/s].
    """
    w, phi = motion.drive, motion.phi[0]
    restitution, restitution_slope, delay, delay_slope = numbers_at(motion.table, approach)
    _height, _velocity, before = tip_state(motion, base, u, v)
    rebound = -restitution * approach
    height, velocity, _acceleration = tip_steady(motion, base + delay)
    u[0] = -height / phi
    v[0] = (rebound - velocity) / phi
    if tangent.shape[0] == 0:
        return delay, rebound
    _height, _velocity, after = tip_state(motion, base + delay, u, v)
    sine, cosine = math.sin(w * delay), math.cos(w * delay)
    for j in range(4):
        s, c = tangent[2, j], tangent[3, j]
        reach = phi * tangent[0, j] + response_sine * s + response_cosine * c
        rate = phi * tangent[1, j] + w * (response_sine * c - response_cosine * s)
        late = -reach / approach
        faster = rate + before * late
        late += delay_slope * faster
        reach = -rebound * late
        rate = -(restitution + restitution_slope * approach) * faster - after * late
        s, c = cosine * s + sine * c, cosine * c - sine * s
        tangent[0, j] = (reach - response_sine * s - response_cosine * c) / phi
        tangent[1, j] = (rate - w * (response_sine * c - response_cosine * s)) / phi
        tangent[2, j], tangent[3, j] = s, c
    return delay, rebound
