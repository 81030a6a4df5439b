"""The flow from touch to touch with its derivatives, of which periodic orbits are made.

The flow starts at a touch, y = 0, and runs through a given number of contacts.  After the last one it goes on
freely to the end of m drive periods, the wall ignored.  It is therefore smooth in the start through grazing,
where the strobe map has its square root.  Amplitude and phase of the drive are ordinary initial values
(``contact.flight.variation``).  Flights and touches are computed as in the simulation (``contact.flight``,
``contact.touch``).  Tangents go through flights with the flows of the modes, through contacts with their
series, and through instantaneous impacts by saltation matrices.
"""

import math

import numpy as np

from beam.parameters import Array
from contact import touch
from contact.engine.event_loop import STATE
from contact.errors import ContactError, ContactTooStiff, NotPeriodic
from contact.flight.crossing import CROSSES, first_crossing
from contact.flight.modal_flow import propagate, tip_state
from contact.flight.variation import Variation, force_jump, tangent_flight, variation
from contact.machine.compiled import borrowed, held, kernel, part
from contact.oscillator import ImpactOscillator
from contact.touch.series import new_series
from contact.touch.tangent_series import new_tangent_workspace, tangent_step
from contact.trajectory import CONTACT, OUTSIDE, SUSTAINED

FLOWN, FEWER_TOUCHES, FAILED, TOUCHING, TOO_STIFF = range(5)
"""Outcomes of a flow: it reached its end; it has too few touches; it was lost; its end falls into the last
touch of a force law; a touch needs more than `MOST_STEPS`."""

MOST_STEPS = 800
"""Bound of contact steps in one touch.  They cover 1600 radians of the fastest mode, fifty times the longest
contact of the letter's beam."""


@part
def through_touch(vary, run, u, v, end, tangent, record):
    """Follow a touch to its release, at most to the drive time `end` [s]; never FEWER_TOUCHES.

    Approach and rebound velocity are written to `record`.
    """
    motion, with_tangent = vary.motion, tangent.shape[1] > 0
    order, columns = touch.series_size(motion)
    series = new_series(order, columns)
    space = new_tangent_workspace(order if with_tangent else 0, tangent.shape[0], tangent.shape[1])
    approach = tip_state(motion, run.clock, u, v)[1]
    record[2] = approach
    if not approach > 0.0:
        return FAILED
    before = (run.clock, u.copy(), v.copy())
    run.regime, rebound, _loss = touch.strike(motion, run, u, v, approach)
    if run.regime == SUSTAINED:  # accumulating impacts are followed one by one
        run.regime, run.contact_order = OUTSIDE, 1 if rebound < 0.0 else 2
    if with_tangent and run.regime == CONTACT:
        force_jump(vary, touch.force(motion, 0.0, approach), approach, tangent, before)
    steps = 0
    while run.regime != OUTSIDE:
        if not run.clock < end:
            return TOUCHING
        steps += 1
        s, h, following = touch.step(motion, run, u, v, end - run.clock, series)
        if steps > MOST_STEPS or not (0.0 <= h < math.inf):
            return TOO_STIFF
        if with_tangent:
            terms = touch.slopes(motion, run, series, space.weights)
            if terms > 0:
                tangent_step(vary, space, terms, s, tangent, (run.clock, u, v))
        touch.state(motion, run, s, series, u, v)
        run.regime, run.clock = following, run.clock + h
        if following == OUTSIDE:
            touch.leave(motion, run, u, v)
    if with_tangent:
        touch.saltation(motion, vary, before, (run.clock, u, v), tangent)
    record[3] = tip_state(motion, run.clock, u, v)[1] if math.isnan(rebound) else rebound
    return FLOWN


@part
def fly(vary, u, v, tangent, clock, time):
    """A flight of length `time` [s] from the drive time `clock` [s], the wall ignored."""
    if tangent.shape[1] > 0:
        tangent_flight(vary, tangent, u, v, clock, time)
    propagate(vary.motion, u, v, time, u, v)


@kernel
def flow_from_touch(vary, base, u, v, duration, tangent, record):
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
    record : ndarray, shape (touches, 4 + 2 n_modes)
        One row for each contact to go through; in the last flight the wall is ignored.  Results: start and
        end of each contact since the first touch [s], approach and rebound velocity [m/s], deviations (u, v)
        at its end.  The rebound velocity is zero only after an impact that gives none.

    Returns the outcome: FLOWN, FEWER_TOUCHES, FAILED, TOUCHING or TOO_STIFF.
    """
    runs = np.zeros(1, dtype=STATE)
    run, end, outcome = runs[0], base + duration, FLOWN
    vary, tangent, record = borrowed(vary), borrowed(tangent), borrowed(record)
    u, v = borrowed(u), borrowed(v)
    n = vary.motion.size
    run.clock = base
    for i in range(record.shape[0]):
        if i > 0:
            crossing, s = first_crossing(vary.motion, run.clock, u, v, end - run.clock, run.contact_order)
            if crossing != CROSSES:
                outcome = FEWER_TOUCHES
                break
            fly(vary, u, v, tangent, run.clock, s)
            run.clock += s
        row = record[i]
        row[0] = run.clock - base
        outcome = through_touch(vary, run, u, v, end, tangent, row)
        if outcome == FLOWN and run.clock > end:
            outcome = FAILED
        if outcome != FLOWN:
            break
        row[1] = run.clock - base
        for k in range(n):
            row[4 + k] = u[k]
            row[4 + n + k] = v[k]
    if outcome == FLOWN:
        fly(vary, u, v, tangent, run.clock, end - run.clock)
    held(runs)  # a record does not keep the array it lies in
    return outcome


def flow_error(outcome: int, time: float, velocity: float, detail: str) -> ContactError:
    """The error of a flow that did not reach its end, from a touch at `time` [s] with `velocity` [m/s]."""
    if outcome == TOO_STIFF:
        detail = f"more than {MOST_STEPS} steps in one touch, or a step of no length"
        return ContactTooStiff(time=time, gap=0.0, velocity=velocity, detail=detail)
    return NotPeriodic(time=time, gap=0.0, velocity=velocity, detail=detail)


def flow_over_periods(
    oscillator: ImpactOscillator,
    period: int,
    phase: float,
    deviations: Array,
    touches: int,
    vary: Variation | None = None,
) -> tuple[Array, Array, Array]:
    """The flow over m = `period` drive periods from a touch at drive time `phase` [s].

    It starts from the `deviations` (u, v), shape (2 n_modes,).  Returned are (u, v) at the end, the tangents
    with respect to (u, v, S, C) and the parameters of `vary`, and the record of `flow_from_touch`.

    NotPeriodic is raised if the motion has fewer touches or a contact does not end, and ContactTooStiff if a
    contact needs more than `MOST_STEPS`.
    """
    (u, v), size, duration = deviations.reshape(2, -1).copy(), deviations.size, period * oscillator.period
    vary = variation(oscillator.motion(), oscillator.tip_response()) if vary is None else vary
    tangent, record = np.eye(size + 2, size + 2 + len(vary.scalars)), np.empty((touches, 4 + size))
    outcome = flow_from_touch(vary, phase, u, v, duration, tangent, record)
    if outcome != FLOWN:
        words = f"an orbit of period {period} with {touches} touches was lost"
        raise flow_error(outcome, phase, float(record[0, 2]), words)
    return np.concatenate([u, v]), tangent, record
