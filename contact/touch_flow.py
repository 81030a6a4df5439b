"""From touch to touch with derivatives: the flow that periodic orbits are made of.

Starting at a touch, y = 0, the flow runs through a given number of contacts and then freely to the end of m
drive periods, the wall ignored after the last of them: it is therefore smooth in the start right through
grazing, where the strobe map has its square root.  Amplitude and phase of the drive are ordinary initial
values (``contact.touch.tangents``).  Flights and touches are those of the simulation (``contact.flight``,
``contact.touch``); the tangents go through flights with the flows of the modes, through contacts with their
series, and through what happens at once by saltation matrices.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

import numpy as np

from contact import touch
from contact.compiled import borrowed, held, kernel, part
from contact.event_loop import STATE
from contact.flight.crossing import CROSSES, first_crossing
from contact.flight.modal_flow import propagate, tip_state
from contact.touch.series import new_series
from contact.touch.tangents import new_room, onset, tangent_flight, tangent_step
from contact.trajectory import CONTACT, OUTSIDE, SUSTAINED

__all__ = ["FAILED", "FEWER_TOUCHES", "FLOWN", "flow_from_touch"]

FLOWN, FEWER_TOUCHES, FAILED = 0, 1, 2

MOST_STEPS = 1_500
"""Bound of contact steps in one touch: they cover 3000 radians of the fastest mode, a hundred times the
longest contact of the letter's beam."""


@part
def through_touch(motion, response, run, u, v, end, tangent, record):
    """From a touch to its release, at most to the drive time `end` [s]; whether it got there.

    `record` gets approach and rebound velocity.
    """
    with_tangent = tangent.shape[0] > 0
    order, columns = touch.room(motion)
    series = new_series(order, columns)
    room = new_room(order if with_tangent else 0, tangent.shape[0])
    approach = tip_state(motion, run.clock, u, v)[1]
    record[2] = approach
    if not approach > 0.0:
        return False
    before = (run.clock, u.copy(), v.copy())
    run.regime, rebound, _loss = touch.strike(motion, run, u, v, approach)
    if run.regime == SUSTAINED:  # accumulating impacts are followed one by one
        run.regime, run.order = OUTSIDE, 1 if rebound < 0.0 else 2
    if with_tangent and run.regime == CONTACT:
        onset(motion, response, touch.force(motion, 0.0, approach), approach, tangent)
    steps = 0
    while run.regime != OUTSIDE:
        steps += 1
        s, h, following = touch.step(motion, run, u, v, end - run.clock, series)
        if steps > MOST_STEPS or not (0.0 <= h < math.inf) or not run.clock < end:
            return False
        if with_tangent:
            terms = touch.slopes(motion, run, series, room.weights)
            if terms > 0:
                tangent_step(motion, response, room, terms, s, tangent)
        touch.state(motion, run, s, series, u, v)
        run.regime, run.clock = following, run.clock + h
        if following == OUTSIDE:
            touch.leave(motion, run, u, v)
    if with_tangent:
        touch.saltation(motion, response, before, (run.clock, u, v), tangent)
    record[3] = tip_state(motion, run.clock, u, v)[1] if math.isnan(rebound) else rebound
    return True


@part
def fly(motion, u, v, tangent, time):
    """A flight of length `time` [s], the wall ignored."""
    propagate(motion, u, v, time, u, v)
    if tangent.shape[0] > 0:
        tangent_flight(motion, tangent, time)


@kernel
def flow_from_touch(motion, response, base, u, v, duration, tangent, record):
    """Flow for `duration` from a touch at time `base` after a strobe.

    Parameters
    ----------
    motion : Motion
        Driven at the amplitude of this orbit.
    response : complex
        a + i b, the tip response per unit base amplitude [1].
    base : float
        Drive time of the touch [s].
    u, v : ndarray, shape (n_modes,)
        Deviations at the touch; overwritten by those at the end.
    duration : float
        m/f [s].
    tangent : ndarray, shape (2 n_modes + 2, 2 n_modes + 2), or (0, 0)
        The unit matrix on entry; overwritten by the derivatives of (u, v, S, C).
    record : ndarray, shape (touches, 4 + 2 n_modes)
        Its length tells how many contacts to go through; in the last flight the wall is ignored.  Results:
        start and end of each contact since the first touch [s], approach and rebound velocity [m/s],
        deviations (u, v) at its end.  The rebound velocity is zero only after an impact that gives none.

    Returns
    -------
    outcome : int
        FLOWN, FEWER_TOUCHES or FAILED.
    """
    runs = np.zeros(1, dtype=STATE)
    n, run, end, outcome = motion.size, runs[0], base + duration, FLOWN
    motion, u, v, tangent, record = (
        borrowed(motion), borrowed(u), borrowed(v), borrowed(tangent), borrowed(record)
    )  # fmt: skip
    run.clock = base
    for i in range(record.shape[0]):
        if i > 0:
            crossing, s = first_crossing(motion, run.clock, u, v, end - run.clock, run.order)
            if crossing != CROSSES:
                outcome = FEWER_TOUCHES
                break
            fly(motion, u, v, tangent, s)
            run.clock += s
        row = record[i]
        row[0] = run.clock - base
        if not through_touch(motion, response, run, u, v, end, tangent, row) or run.clock > end:
            outcome = FAILED
            break
        row[1] = run.clock - base
        for k in range(n):
            row[4 + k] = u[k]
            row[4 + n + k] = v[k]
    if outcome == FLOWN:
        fly(motion, u, v, tangent, end - run.clock)
    held(runs)  # a record does not keep the array it lies in
    return outcome
