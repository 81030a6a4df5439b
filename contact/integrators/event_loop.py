"""The loop over flights and contacts: flights in closed form, contacts at once or by their power series.

A run goes from strobe to strobe, with time counted from the last strobe, so that a million periods bring no
loss of phase.  In each period a certified search (``contact.crossing``) finds the first touch, or, if that is
asked for, the letter's sampled one (``contact.integrators.sampled_search``); an impact law acts at once, a
force law is followed through the contact (``contact.linear_lanes``, ``contact.hertz_lanes``) until the tip is
off the wall again.  Periods without a touch cost one multiplication by the flow of a period and a proof, most
often by the lowest mode alone (``contact.lowest_mode``).

The three exact methods, ``event_driven``, ``piecewise_linear`` and ``contact_series``, differ in the law that
meets them here, and share everything else.
"""

from __future__ import annotations

import numpy as np

from contact.certificate import first_polynomial_root
from contact.compiled import kernel
from contact.crossing import CROSSES, FREE, UNRESOLVED, searched_flight
from contact.flight import (
    EPS,
    flow_matrix,
    pull_rounding,
    tip_rounding,
    tip_state,
    tip_steady,
)
from contact.hertz_lanes import (
    ROOT,
    contact_work,
    depth_root,
    lane_arrays,
    lane_series,
    lane_state,
    speed_scale,
)
from contact.hertz_series import evaluate
from contact.hertz_step import lane_step
from contact.impact_log import (
    CLOCK,
    COUNT,
    EVALUATIONS,
    GRAZE,
    IMPACT,
    LOGGED,
    LOSS,
    ORDER,
    REBOUND,
    REGIME,
    SAMPLED,
    SEARCH,
    STAY,
    WAIT,
    close_row,
    open_row,
    sample_flight,
    sample_hertz,
    sample_linear,
    sample_waiting,
)
from contact.integrators.sampled_search import first_sampled_crossing, sampled_flow
from contact.laws import DELAYED, HERTZ, NEWTON
from contact.linear_lanes import (
    DEPTH,
    FORCE,
    LINEAR_ORDER,
    linear_arrays,
    linear_series,
    linear_state,
    linear_step,
    linear_work,
)
from contact.modal_flow import carry, load_state, mode_rows, scalars_of
from contact.newton import accumulation_time, newton_impact
from contact.series import CONTACT, INSIDE, OUTSIDE, SUSTAINED, WAITING
from contact.waiting import numbers_at

__all__ = ["advance"]

DONE, FAILED_CROSSING, FAILED_CHATTER, FAILED_STEPS, LOG_FULL = 0, 1, 2, 3, 4

MOST_IMPACTS = 100_000
"""Bound of impacts in one drive period: accumulating impacts with e = 0.999 take about 2e4 before the hops
drown in rounding, so a longer sequence is not on its way to rest."""

OVERFLOW = 1e300
"""A coefficient of the contact series beyond this is about to leave the range of doubles: some 1e18 times the
stiffness of the spring."""

MOST_STEPS = 1_000_000
"""Bound of flights and series steps in one drive period: 1e6 steps of two radians reach modes of 3e5 drive
frequencies."""


@kernel
def negate(series, negative):
    """`negative` = -`series`."""
    for n in range(series.size):
        negative[n] = -series[n]


@kernel
def advance(
    motion, u, v, integers, floats, first, periods, clock_end, strobes, counts, log, log_state,
    sample_period, sample_clock, samples,
):
    """Carry the deviations (u, v) from period `first` to time `clock_end` after strobe `first` + `periods`.

    Parameters
    ----------
    motion : Motion
    u, v : ndarray, shape (n_modes,)
        Deviations from the steady motion; overwritten.
    integers : ndarray of int64, shape (7,)
        Regime, vanishing derivatives at the start of the flight, rows logged, samples taken, impacts in this
        period, flights, contact steps and sampled positions so far, kind of search; carried from call to
        call.
    floats : ndarray, shape (5,)
        Time since the strobe; approach velocity, energy loss, waiting time and rebound velocity of the
        contact under way; carried likewise.
    first, periods : int
        Number of the drive period in which the run starts, and strobes to pass.
    clock_end : float
        Time after the last strobe at which the run ends [s].
    strobes : ndarray, shape (periods, 2 n_modes) or (0, 2 n_modes)
        Deviations at the strobes, if wanted.
    counts : ndarray of int64, shape (periods,) or (0,)
        Impacts that began in each period, if wanted.
    log, log_state : ndarray, shapes (capacity, 8) and (capacity, 4 n_modes), or (0, ...)
        The impacts, if wanted.
    sample_period, sample_clock, samples : ndarray, shapes (n,), (n,), (n, 2 n_modes)
        Times, as period and time since its strobe, at which the deviations are wanted.

    Returns
    -------
    status : int
        DONE, LOG_FULL (call again with a longer log), or one of the failures.
    period : int
        The period reached.
    """
    n = motion.omega.size
    flow = np.empty((n, 4))
    loaded = False
    for k in range(n):
        flow[k, 0], flow[k, 1], flow[k, 2], flow[k, 3] = flow_matrix(
            motion.omega[k], motion.decay[k], motion.damped[k], motion.damped_low[k], motion.period
        )
        loaded = loaded or motion.load[k] != 0.0
    search = integers[SEARCH]
    spacing, spaced = motion.period / max(1, search), np.empty((n, 6))
    if search > 0:
        sampled_flow(motion, spacing, spaced)
    envelope, fixed = np.empty(n + 1), scalars_of(motion)
    numbers, room = mode_rows(motion)
    su, sv = np.empty(n), np.empty(n)
    series, sums, scalars = lane_arrays(numbers) if motion.law == HERTZ else linear_arrays(numbers)
    depth, force, negative = scalars[DEPTH], scalars[FORCE], np.empty(scalars.shape[1])
    speed_size = -1.0  # modal speeds at the start of the contact; below zero when to be computed anew
    root = -1.0  # sqrt of the penetration under Hertz's law; below zero when it is to be computed anew

    index = first
    steps = 0
    while True:
        last = index == first + periods
        end = clock_end if last else motion.period
        while floats[CLOCK] < end:
            base = floats[CLOCK]
            if log.shape[0] > 0 and integers[LOGGED] >= log.shape[0] - 1:
                return LOG_FULL, index
            steps += 1
            integers[EVALUATIONS] += 1
            if steps > MOST_STEPS:
                return FAILED_STEPS, index
            if integers[COUNT] > MOST_IMPACTS:
                return FAILED_CHATTER, index
            if integers[REGIME] == OUTSIDE:
                if search == 0:
                    load_state(room, u, v)
                    outcome, s = searched_flight(
                        fixed, numbers, room, base, end - base, integers[ORDER], envelope
                    )
                else:
                    outcome, s = first_sampled_crossing(
                        motion, fixed, numbers, room, base, u, v, end - base, integers[ORDER], spacing,
                        spaced, integers, su, sv,
                    )
                if outcome == UNRESOLVED:
                    carry(fixed, numbers, room, s, u, v)
                    floats[CLOCK] = base + s
                    return FAILED_CROSSING, index
                until = end if outcome == FREE else base + s
                if integers[SAMPLED] < sample_clock.size:
                    sample_flight(
                        motion, u, v, base, until, index, integers, sample_period, sample_clock, samples, su,
                        sv,
                    )
                if outcome == FREE and base == 0.0 and not last and not loaded:
                    for k in range(n):
                        uk = u[k]
                        u[k] = flow[k, 0] * uk + flow[k, 1] * v[k]
                        v[k] = flow[k, 2] * uk + flow[k, 3] * v[k]
                else:
                    carry(fixed, numbers, room, s, u, v)
                integers[ORDER] = 0
                if outcome == FREE:
                    floats[CLOCK] = end
                    continue
                floats[CLOCK] = base + s
                base = floats[CLOCK]
                _height, approach, acceleration = tip_state(motion, base, u, v)
                if outcome != CROSSES:
                    open_row(log, log_state, integers, floats, index, base, 0.0, GRAZE, u, v)
                    close_row(log, log_state, integers, floats, index, base, 0.0, u, v)
                    integers[ORDER] = 2
                    continue
                open_row(log, log_state, integers, floats, index, base, approach, IMPACT, u, v)
                if motion.law == DELAYED:
                    restitution, _slope, floats[WAIT], _slope = numbers_at(motion.table, approach)
                    floats[REBOUND] = -restitution * approach
                    floats[LOSS] = 0.5 * (approach * approach - floats[REBOUND] ** 2) / motion.compliance
                    integers[REGIME] = WAITING
                    continue
                if motion.law != NEWTON:
                    integers[REGIME] = CONTACT
                    root, speed_size = 0.0, -1.0
                    continue
                e, rounding = motion.number0, tip_rounding(motion, u, v)
                newton_impact(motion, v, approach, e)
                floats[LOSS] = 0.5 * (1.0 - e * e) * approach * approach / motion.compliance
                close_row(log, log_state, integers, floats, index, base, -e * approach, u, v)
                _height, _velocity, acceleration = tip_state(motion, base, u, v)
                rest = accumulation_time(e * approach, acceleration, e, rounding)
                if rest >= 0.0:
                    # the remaining hops take `rest`; then the tip stays on the wall
                    open_row(log, log_state, integers, floats, index, base, -e * approach, STAY, u, v)
                    rest = min(rest, end - base)  # what is left after the strobe is below rounding
                    if rest > 0.0:
                        carry(fixed, numbers, room, rest, u, v)
                        floats[CLOCK] = base + rest
                    height, velocity, _a = tip_state(motion, floats[CLOCK], u, v)
                    for k in range(n):
                        u[k] -= motion.phi[k] * height / motion.compliance
                        v[k] -= motion.phi[k] * velocity / motion.compliance
                    integers[REGIME] = SUSTAINED
                else:
                    integers[ORDER] = 1 if e * approach > 0.0 else 2
                continue

            regime = integers[REGIME]
            if regime == WAITING:
                leaves = base + floats[WAIT] <= end
                until = base + floats[WAIT] if leaves else end
                sample_waiting(motion, until, index, integers, sample_period, sample_clock, samples)
                floats[WAIT] -= until - base
                floats[CLOCK] = until
                height, velocity, _a = tip_steady(motion, until)
                u[0] = -height / motion.phi[0]
                v[0] = ((floats[REBOUND] if leaves else 0.0) - velocity) / motion.phi[0]
                if leaves:
                    close_row(log, log_state, integers, floats, index, until, floats[REBOUND], u, v)
                    integers[REGIME] = OUTSIDE
                    integers[ORDER] = 1 if floats[REBOUND] < 0.0 else 2
                continue

            # in contact: one step of the series, cut at the first event
            if motion.law == HERTZ:
                if speed_size < 0.0:
                    speed_size = speed_scale(fixed, numbers, u, v)
                scalars[ROOT, 0] = root if root >= 0.0 else depth_root(motion, base, u, v)
                lane_series(fixed, numbers, base, u, v, series, sums, scalars)
                s, released, h = lane_step(numbers, speed_size, series, scalars, negative, end - base)
                until = base + h if h < end - base else end
                if integers[SAMPLED] < sample_clock.size:
                    sample_hertz(
                        series, sums, scalars, base, until, s, index, integers, sample_period, sample_clock,
                        samples, negative, su, sv,
                    )
                if log.shape[0] > 0:
                    floats[LOSS] += contact_work(s, series, scalars)
                lane_state(s, series, sums, scalars, u, v)
                root = evaluate(scalars[ROOT], s)
                floats[CLOCK] = until
                if released:
                    integers[REGIME] = OUTSIDE
                    integers[ORDER] = 1
                    _height, velocity, _a = tip_state(motion, until, u, v)
                    close_row(log, log_state, integers, floats, index, until, velocity, u, v)
                continue
            linear_series(fixed, numbers, regime, base, u, v, series, scalars)
            if not (abs(depth[LINEAR_ORDER]) < OVERFLOW and abs(force[LINEAR_ORDER - 2]) < OVERFLOW):
                return FAILED_STEPS, index
            stored = motion.number0 * depth[0] ** 2 if motion.law != NEWTON else 0.0
            h = min(linear_step(fixed, numbers, stored, u, v, series), end - base)
            if end - base <= 4.0 * EPS * motion.period:
                floats[CLOCK] = end
                continue
            if not h > EPS * base:
                return FAILED_STEPS, index
            rounding = tip_rounding(motion, u, v)
            stop_at, next_regime = -1.0, regime
            if regime == CONTACT:
                negate(force, negative)
                margin = rounding * motion.number0
                stop_at = first_polynomial_root(negative, 0.0, h, margin)
                next_regime = OUTSIDE if motion.number1 == 0.0 else INSIDE
            elif regime == SUSTAINED:
                negate(force, negative)
                margin = pull_rounding(motion, u, v) / motion.compliance
                stop_at = first_polynomial_root(negative, 0.0, h, margin)
                next_regime = OUTSIDE
            else:
                closes = first_polynomial_root(force, 0.0, h, rounding * motion.number0)
                negate(depth, negative)
                leaves = first_polynomial_root(negative, 0.0, h, rounding)
                if leaves >= 0.0 and (closes < 0.0 or leaves <= closes):
                    stop_at, next_regime = leaves, OUTSIDE
                elif closes >= 0.0:
                    stop_at, next_regime = closes, CONTACT
            if stop_at >= 0.0:
                h = stop_at
            until = base + h if h < end - base else end
            if integers[SAMPLED] < sample_clock.size:
                sample_linear(
                    series, sums, scalars, base, until, index, integers, sample_period, sample_clock, samples,
                    su, sv,
                )
            if regime == CONTACT and log.shape[0] > 0:
                floats[LOSS] += linear_work(h, scalars)
            linear_state(h, series, sums, scalars, u, v)
            floats[CLOCK] = until
            if regime == SUSTAINED:
                # rounding would let the tip drift off the wall over many steps
                drift, drift_rate, _a = tip_state(motion, until, u, v)
                for k in range(n):
                    u[k] -= motion.phi[k] * drift / motion.compliance
                    v[k] -= motion.phi[k] * drift_rate / motion.compliance
            if stop_at >= 0.0:
                integers[REGIME] = next_regime
                if next_regime == OUTSIDE:
                    _height, velocity, _a = tip_state(motion, floats[CLOCK], u, v)
                    close_row(log, log_state, integers, floats, index, floats[CLOCK], velocity, u, v)
                    integers[ORDER] = 3 if regime == SUSTAINED else 1

        if last:
            return DONE, index
        if counts.size > 0:
            counts[index - first] = integers[COUNT]
        if strobes.shape[0] > 0:
            for k in range(n):
                strobes[index - first, k] = u[k]
                strobes[index - first, n + k] = v[k]
        integers[COUNT] = 0
        floats[CLOCK] = 0.0
        steps = 0
        index += 1
