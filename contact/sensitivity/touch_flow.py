"""The flow from touch to touch with its derivatives, of which periodic orbits are made.

The flow starts at a touch, y = 0, and runs through a given number of contacts.  After the last one it goes on
freely to the end of m drive periods, the wall ignored.  It is therefore smooth in the start through grazing,
where the strobe map has its square root.  Tangents (``contact.flight.variation``) go through contacts with
their series, and through instantaneous impacts by saltation matrices.
"""

import numpy as np

from contact import touch
from contact.errors import ContactError, ContactTooStiff, NotPeriodic
from contact.flight.crossing import CROSSES, first_crossing
from contact.flight.modal_flow import propagate
from contact.flight.tip import tip_state
from contact.flight.variation import all_tip_changes, force_jump, tangent_flight
from contact.machine.compiled import borrowed, held, kernel, part
from contact.state import CONTACT, OUTSIDE, SUSTAINED
from contact.touch.passage import AT_END, RELEASED, STATE, begin, follower
from contact.touch.series import new_series
from contact.touch.tangent_series import new_tangent_workspace, tangent_step

FLOWN, FEWER_TOUCHES, FAILED, TOUCHING, TOO_STIFF = range(5)
"""Outcomes of a flow: it reached its end; it has too few touches; it was lost; its end falls into the last
touch of a force law; a touch needs more than `MOST_STEPS`."""

MOST_STEPS = 800
"""Bound of contact steps in one touch.  They cover 1600 radians of the fastest mode, fifty times the longest
contact of the letter's beam."""


@kernel
def carry_tangents(numbers, run, u, v, s, until, series, watcher):
    """The `Watch` of this flow: the tangents go through each step of a contact by its series."""
    vary, tangent, space = watcher
    terms = touch.slopes(numbers, run, series, space.weights) if tangent.shape[1] > 0 else 0
    if terms > 0:
        tangent_step(vary, space, terms, s, tangent, (run.clock, u, v))
    return False


follow = follower(lambda law: carry_tangents)


@part
def through_touch(vary, run, u, v, end, tangent, touches):
    """Follow a touch to its release, at most to the drive time `end` [s]; never FEWER_TOUCHES."""
    numbers, with_tangent = vary.numbers, tangent.shape[1] > 0
    order, columns = touch.series_size(numbers)
    series = new_series(order, columns)
    space = new_tangent_workspace(order if with_tangent else 0, tangent.shape[0], tangent.shape[1])
    before = (run.clock, u.copy(), v.copy())
    approach, rebound = begin(numbers, run, u, v, touches)
    if not approach > 0.0:
        return FAILED
    if run.regime == SUSTAINED:  # accumulating impacts are followed one by one
        run.regime, run.contact_order = OUTSIDE, 1 if rebound < 0.0 else 2
    if with_tangent and run.regime == CONTACT:
        force_jump(vary, touch.force(numbers, 0.0, approach), approach, tangent, before)
    run.steps = 0
    if run.regime != OUTSIDE:
        left = follow(numbers, u, v, run, end, MOST_STEPS, touches, series, (vary, tangent, space))
        if left == AT_END:
            if with_tangent:
                touch.inside(numbers, vary, (run.clock, u, v), run.clock - before[0], tangent)
            return TOUCHING
        if left != RELEASED:
            return TOO_STIFF
    if with_tangent:
        touch.saltation(numbers, vary, before, (run.clock, u, v), tangent)
    return FLOWN


@part
def fly(vary, u, v, tangent, clock, time):
    """A flight of length `time` [s] from the drive time `clock` [s], the wall ignored."""
    if tangent.shape[1] > 0:
        tangent_flight(vary, tangent, u, v, clock, time)
    propagate(vary.numbers, u, v, time, u, v)


@part
def touch_slopes(vary, clock, u, v, tangent, slopes):
    """Fill two rows with the derivatives of the time of a touch and of its approach along the tangents."""
    height, rate = all_tip_changes(vary, tangent, u, v, clock)
    _height, approach, acceleration = tip_state(vary.numbers, clock, u, v)
    for j in range(height.size):
        slopes[0, j] = -height[j] / approach
        slopes[1, j] = rate[j] + acceleration * slopes[0, j]


@kernel
def flow_from_touch(vary, base, u, v, duration, tangent, touches):
    """Flow for `duration` from a touch at time `base` after a strobe.

    Parameters
    ----------
    vary : Variation
        Of the motion driven at the amplitude of this orbit.
    base, duration : float
        Drive time of the touch, and m/f [s].
    u, v : ndarray, shape (n_modes,)
        Deviations at the touch; overwritten by those at the end.
    tangent : ndarray, shape (2 n_modes + 2, columns)
        Tangents of (u, v, S, C), overwritten by their values at the end; the last columns belong to the
        parameters of `vary`.  The unit matrix turns into the derivatives with respect to the start.  Without
        columns no tangents are computed.
    touches : Touches
        With a row for each contact to go through; in the last flight the wall is ignored.  Filled with these
        contacts, at times since the first one, and their slopes if there is room for them.  The rebound
        velocity is zero only after an impact that gives none.

    Returns the outcome: FLOWN, FEWER_TOUCHES, FAILED, TOUCHING or TOO_STIFF.
    """
    runs = np.zeros(1, dtype=STATE)
    run, end, outcome = runs[0], base + duration, FLOWN
    vary, tangent, touches = borrowed(vary), borrowed(tangent), borrowed(touches)
    u, v = borrowed(u), borrowed(v)
    run.clock = base
    for i in range(touches.log.size):
        if i > 0:
            crossing, s = first_crossing(vary.numbers, run.clock, u, v, end - run.clock, run.contact_order)
            if crossing != CROSSES:
                outcome = FEWER_TOUCHES
                break
            fly(vary, u, v, tangent, run.clock, s)
            run.clock += s
        if touches.slopes.shape[2] > 0:
            touch_slopes(vary, run.clock, u, v, tangent, touches.slopes[i])
        outcome = through_touch(vary, run, u, v, end, tangent, touches)
        if outcome == FLOWN and run.clock > end:
            outcome = FAILED
        if outcome != FLOWN:
            break
    if outcome == FLOWN:
        fly(vary, u, v, tangent, run.clock, end - run.clock)
    for i in range(touches.marks[0].logged):
        touches.log[i].start -= base
        touches.log[i].end -= base
    held(runs)  # a record does not keep the array it lies in
    return outcome


def flow_error(outcome: int, time: float, velocity: float, detail: str) -> ContactError:
    """The error of a flow that did not reach its end, from a touch at `time` [s] with `velocity` [m/s]."""
    if outcome == TOO_STIFF:
        detail = f"more than {MOST_STEPS} steps in one touch, or a step of no length"
    kind = ContactTooStiff if outcome == TOO_STIFF else NotPeriodic
    return kind(time=time, velocity=velocity, detail=detail)
