"""The first crossing of the stop as the letter looks for it: at a few instants of each drive period.

The letter (1996, note [11]) computes the exact position at t_1, ..., t_k in each drive period and detects
crossings "both directly", where a sampled position is beyond the stop, and at the turning points of the
motion, where the sampled velocities change from rising to falling.  Here t_j = j / (k f), and a flight that
begins in between starts with a shorter interval.  Once detected, a crossing is located to rounding on the
exact flow, by Newton's method within the bracket (``contact.tip_search``).

A crossing is seen if the tip is behind the stop at the end of the interval, or if the velocity changes from
rising to falling and the peak found is behind the stop.  Missed is one that the tip undoes within the
interval if it turns an even number of times there: for the ringing of a mode of frequency omega that is to be
expected as soon as the spacing exceeds half its period, k < omega / (pi f), and since turning points of a sum
of modes may lie as close together as they like, no k excludes it.  Where several crossings lie in one
interval, the one located need not be the first.
"""

from __future__ import annotations

import math

from contact.compiled import kernel
from contact.crossing import CROSSES, FREE
from contact.flight import flow_matrix, loaded_drift, propagate, tip_rounding, tip_state
from contact.impact_log import EVALUATIONS
from contact.modal_flow import load_state
from contact.tip_search import find_peak, find_root, tip_of

__all__ = ["first_sampled_crossing", "sampled_flow"]

ALIGNED = 1e-9
"""Part of the spacing by which an interval may differ from it and still be stepped over by its flow: the
samples serve to detect, not to locate."""


@kernel
def sampled_flow(motion, spacing, flow):
    """`flow`, shape (n_modes, 6): matrix by rows and drift under the load over a time `spacing` [s]."""
    for k in range(motion.omega.size):
        flow[k, 0], flow[k, 1], flow[k, 2], flow[k, 3] = flow_matrix(
            motion.omega[k], motion.decay[k], motion.damped[k], motion.damped_low[k], spacing
        )
        flow[k, 4], flow[k, 5] = 0.0, 0.0
        if motion.load[k] != 0.0:
            flow[k, 4], flow[k, 5] = loaded_drift(motion.decay[k], motion.load[k], spacing)


@kernel
def root_between(fixed, numbers, room, base, low, high, margin):
    """The root of the tip displacement in [low, high] [s]."""
    middle = 0.5 * (low + high)
    y0, y1, y2 = tip_of(fixed, numbers, room, base, middle)
    return find_root(fixed, numbers, room, base, middle, y0, y1, y2, math.inf, low, high, margin)


@kernel
def first_sampled_crossing(
    motion, fixed, numbers, room, base, u, v, duration, order, spacing, flow, integers, su, sv
):
    """First crossing that is detected in (0, duration] of a free flight.

    Parameters
    ----------
    motion : Motion
    fixed, numbers, room
        The same oscillator as in ``contact.modal_flow``; `room` is overwritten.
    base : float
        Time since the strobe at which the flight starts [s].
    u, v : ndarray, shape (n_modes,)
        Deviation at the start, and its velocity.
    duration : float
        Length of the flight [s].
    order : int
        How many derivatives of the tip displacement vanish at the start: 0 for a tip off the wall.
    spacing : float
        Time between two samples [s].
    flow : ndarray, shape (n_modes, 6)
        From `sampled_flow`.
    integers : ndarray of int64
        Where the positions computed are counted.
    su, sv : ndarray, shape (n_modes,)
        Work space.

    Returns
    -------
    outcome : int
        FREE or CROSSES.
    s : float
        Time since the start of the flight [s].
    """
    n = motion.omega.size
    margin = tip_rounding(motion, u, v)
    height, rate, _acceleration = tip_state(motion, base, u, v)
    if order == 0 and height >= -margin and rate > 0.0:
        return CROSSES, 0.0
    load_state(room, u, v)
    for k in range(n):
        su[k], sv[k] = u[k], v[k]
    j = int(base / spacing)
    s = 0.0
    while s < duration:
        j += 1
        until = min(j * spacing - base, duration)
        if until - s <= ALIGNED * spacing and until < duration:
            continue
        integers[EVALUATIONS] += 1
        if abs(until - s - spacing) <= ALIGNED * spacing:
            for k in range(n):
                uk = su[k]
                su[k] = flow[k, 0] * uk + flow[k, 1] * sv[k] + flow[k, 4]
                sv[k] = flow[k, 2] * uk + flow[k, 3] * sv[k] + flow[k, 5]
        else:
            propagate(motion, u, v, until, su, sv)
        height, new_rate, _acceleration = tip_state(motion, base + until, su, sv)
        if height > margin:
            return CROSSES, root_between(fixed, numbers, room, base, s, until, margin)
        if rate > 0.0 and new_rate < 0.0:
            middle = 0.5 * (s + until)
            _height, y1, y2 = tip_of(fixed, numbers, room, base, middle)
            peak = find_peak(fixed, numbers, room, base, middle, y1, y2, math.inf, s, until, margin)
            integers[EVALUATIONS] += 1
            if tip_of(fixed, numbers, room, base, peak)[0] > margin:
                return CROSSES, root_between(fixed, numbers, room, base, s, peak, margin)
        s, rate = until, new_rate
    return FREE, duration
