"""The crossings of one mode in one drive period, searched between the nodes of its ``period_table``.

With |y''| <= B throughout, y lies between two nodes h apart below the greater of its values there plus
B h^2/8: stretches at whose ends y < -m - B h^2/8 are free, which is one pass over products with constants.
Within the others the three proofs of ``contact.flight.bounds`` decide (a parabola with a bound of its cubic
rest; y' > 0 throughout and a change of sign; y'' < 0 throughout and one peak), on a motion found without
sines.

Directly after an impact at velocity -r <= 0 towards the wall, with the acceleration a and |y'''| <= M,

    y(s)/s <= -r + max(0, a/2 + M h/6) h   on (0, h],   or   y'' <= a + M h,

and either being negative proves the flight free until the next node.  Impacts within a margin of rounding,
sequences that accumulate and whatever these proofs do not settle are left to ``event_loop.advance``.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import inlined, kernel
from contact.flight.bounds import PEAK, ROOT, SKIP, certify
from contact.flight.elementary import EPS
from contact.single_mode.period_table import flow_to, short_flow, tip_near
from contact.touch.newton import accumulation_time

__all__ = ["rising_zero", "searched_period"]

_FREE, _CROSSES, _UNSETTLED = 0, 1, 2

MOST_STEPS = 1000
"""Bound of stretches looked at in a search; one that needs more is given to the event loop."""

MOST_IMPACTS = 64
"""Bound of impacts in one period; more are on their way to rest, and given to the event loop."""

NEWTON_STEPS = 60
"""Bound of Newton steps; next to a graze each but halves the distance to the double root, from 1 to 1e-8."""


@kernel
def rising_zero(mode, rows, since, u, v, t, low, high, margin):
    """Newton's iteration from `t` for a zero of the tip displacement in (`low`, `high`) where it rises.

    (u, v) is the deviation at node `since`.

    Returns
    -------
    found : bool
        False if the slope is not positive on the way, or no zero beyond rounding is reached.
    time [s], deviation and its rate there, approach velocity [m/s].
    """
    for _ in range(NEWTON_STEPS):
        if not low < t < high:
            t = 0.5 * (low + high)
        un, vn, _swing, y0, y1, y2 = tip_near(mode, rows, since, u, v, t)
        if not y1 > 0.0:
            return False, t, un, vn, y1
        x = -y0 / y1
        if abs(y2) * x * x < 1e-3 * margin and low < t + x < high:
            # what is left after this step is below rounding: carry the state along it by its Taylor series
            acceleration = -mode.decay * vn - mode.stiffness * un
            un += x * vn
            vn += x * acceleration
            y1 += x * y2
            most = mode.crest + abs(mode.phi) * (
                mode.stiffness * abs(un) + (mode.decay + math.sqrt(mode.stiffness)) * abs(vn)
            )
            return y1 * y1 > 4.0 * most * margin, t + x, un, vn, y1
        if y0 < 0.0:
            low = t
        else:
            high = t
        # Halley's step where it is close to Newton's
        change = 0.5 * x * y2
        t += x if abs(change) > 0.25 * y1 else -y0 / (y1 + change)
    return False, t, u, v, 0.0


@kernel
def highest_point(mode, rows, since, u, v, low, high, margin):
    """The peak of the tip displacement in [`low`, `high`], where it is concave: time [s] and height [m]."""
    t = 0.5 * (low + high)
    for _ in range(NEWTON_STEPS):
        _u, _v, _swing, height, y1, y2 = tip_near(mode, rows, since, u, v, t)
        if y1 > 0.0:
            low = t
        else:
            high = t
        new = t - y1 / y2 if y2 < 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        # the height is settled long before the place: its error is y'' (new - t)^2 / 2
        if abs(y2) * (new - t) ** 2 <= 1e-3 * margin:
            return t, height
        t = new
    return t, math.nan


@inlined
def above_limit(table, since, u, v, k, limit):
    """Whether the tip displacement at node `k` exceeds `limit`."""
    return table.level[k] + table.from_u[k - since] * u + table.from_v[k - since] * v > limit


@kernel
def count_above(level, from_u, from_v, u, v, limit):
    """How many of the nodes of `level` lie above `limit`; a sum of whole numbers is one that vectorises."""
    count = 0
    for k in range(level.size):
        count += 1 if level[k] + from_u[k] * u + from_v[k] * v > limit else 0
    return count


@inlined
def third_bound(mode, u, v):
    """Bound of the tip's third derivative from (u, v) on [m/s^3]."""
    d2 = -mode.decay * v - mode.stiffness * u
    d3 = -mode.decay * d2 - mode.stiffness * v
    return mode.crest * mode.drive + abs(mode.phi) * math.sqrt(d3 * d3 + mode.stiffness * d2 * d2)


@kernel
def search(table, since, first, u, v, rho):
    """First crossing after node `first` of the flight with the deviation (u, v) at node `since`.

    `rho` bounds the free tip motion from there on.

    Returns
    -------
    outcome : int
        FREE, CROSSES or UNSETTLED.
    time [s], deviation and its rate there, approach velocity [m/s].
    """
    mode, rows = table.mode, table.rows
    last = rows.shape[0] - 1
    margin = mode.rounding + mode.rounding_rho * rho
    most = mode.crest + mode.second * rho
    limit = -(margin + 0.125 * most * mode.stretch**2)
    start = first - since
    if count_above(table.level[first:], table.from_u[start:], table.from_v[start:], u, v, limit) == 0:
        return _FREE, 0.0, u, v, 0.0
    t = first * mode.stretch
    end = mode.period * (1.0 - 4.0 * EPS)
    h = mode.stretch
    h_min = h / 256.0
    for _ in range(MOST_STEPS):
        # to the next stretch with a flagged end
        k = int(t * mode.per_second)
        while k < last and not (
            above_limit(table, since, u, v, k, limit) or above_limit(table, since, u, v, k + 1, limit)
        ):
            k += 1
            t = k * mode.stretch
        if k >= last or t >= end:
            return _FREE, 0.0, u, v, 0.0
        un, vn, _swing, y0, y1, y2 = tip_near(mode, rows, since, u, v, t)
        if y0 >= -margin:
            return _UNSETTLED, t, un, vn, y1
        m3 = third_bound(mode, un, vn)
        proof, step = certify(y0, y1, y2, m3, 0.0, margin, min(h, mode.period - t), h_min)
        until = t + step
        if proof == ROOT or proof == PEAK:
            # a rising zero of this stretch is the first; a parabola tells about where
            under = y1 * y1 - 2.0 * y0 * y2
            if proof == ROOT or under > 0.0:
                near = t - 2.0 * y0 / (y1 + math.sqrt(max(0.0, under)))
                found, at, un, vn, speed = rising_zero(mode, rows, since, u, v, near, t, until, margin)
                if found:
                    return _CROSSES, at, un, vn, speed
            top, height = until, 0.0
            if proof == PEAK:
                top, height = highest_point(mode, rows, since, u, v, t, until, margin)
            if height > margin:
                near = t + y0 / (y0 - height) * (top - t)
                found, at, un, vn, speed = rising_zero(mode, rows, since, u, v, near, t, top, margin)
                if found:
                    return _CROSSES, at, un, vn, speed
            if not height < -margin:
                return _UNSETTLED, top, un, vn, 0.0
        elif proof != SKIP:
            return _UNSETTLED, t, un, vn, 0.0
        t = until
        h = 2.0 * step
    return _UNSETTLED, t, u, v, 0.0


@inlined
def departs(rebound, acceleration, m3, h):
    """Whether a flight that leaves the wall with -`rebound` is proved free for a time `h`."""
    if rebound > h * max(0.0, 0.5 * acceleration + m3 * h / 6.0):
        return True
    return rebound >= 0.0 and acceleration + m3 * h < 0.0


@kernel
def searched_period(table, u, v):
    """A period from the deviation (u, v) at its strobe, off the wall.

    Returns
    -------
    impacts : int
        Impacts of the period, or -1 if it is left to the event loop.
    u, v : float
        The deviation at the next strobe, of no use if it is left.
    """
    mode, rows = table.mode, table.rows
    last, e = rows.shape[0] - 1, mode.restitution
    # literal zeros would make numba compile the search twice
    since, first = np.int64(0), np.int64(0)
    rho = abs(mode.phi) * math.sqrt(u * u + v * v / mode.stiffness)
    for impacts in range(MOST_IMPACTS):
        outcome, t, ui, vi, approach = search(table, since, first, u, v, rho)
        if outcome == _UNSETTLED:
            return -1, u, v
        if outcome == _FREE:
            u, v = flow_to(rows, last - since, u, v)
            return impacts, u, v
        margin = mode.rounding + mode.rounding_rho * rho
        vi += mode.kick * approach
        rho = abs(mode.phi) * math.sqrt(ui * ui + vi * vi / mode.stiffness)
        _u, _v, swing, _y0, _y1, _y2 = tip_near(mode, rows, np.int64(0), 0.0, 0.0, t)
        acceleration = -mode.drive**2 * swing - mode.phi * (mode.decay * vi + mode.stiffness * ui)
        since, first = int(t * mode.per_second + 0.5), int(t * mode.per_second) + 1
        if first > last:
            return -1, u, v
        if not departs(e * approach, acceleration, third_bound(mode, ui, vi), first * mode.stretch - t):
            return -1, u, v
        if accumulation_time(e * approach, acceleration, e, margin) >= 0.0:
            return -1, u, v
        u, v = short_flow(mode, since * mode.stretch - t, ui, vi)
    return -1, u, v
