"""The first crossing of the stop, certified.

Starting where the tip is off the stop, time is skipped only if a bound proves the span free
(``contact.flight.bounds``).  High modes are bounded instead of sampled, and more are sampled as the gap
closes.  A graze, |peak| within the rounding bound of y (at most 1e-13 of the gap), is an outcome of its own.
A span that no proof settles, with h down to rounding, is reported as unresolved and never passed.
Derivation: ``docs/theory/crossing.md``.
"""

import math

import numpy as np

from contact.flight import modal_flow as rows
from contact.flight.bounds import PEAK, ROOT, SKIP, certify, free_from, free_until, lowest_mode, peak_of_drive
from contact.flight.elementary import EPS
from contact.flight.modal_flow import flow, load_state, new_flight
from contact.flight.numbers import DECAY, INVERSE_OMEGA, LOAD, SQUARE, WEIGHT
from contact.flight.polynomial_root import horner
from contact.flight.tip import tip_rounding, tip_steady
from contact.flight.tip_search import find_peak, find_root, tip_now
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import LANES

FREE, CROSSES, GRAZES, UNRESOLVED = range(4)
BELOW = -1  # outcome of a span with a peak that stays below the stop: the search goes on
HOP, HOP_ORDER = 1.0, 20  # longest hop, in radians of the fastest mode or the drive; order of its series
GRAZE_TOLERANCE = 1e-13  # largest rounding bound, relative to the gap, with which a peak within it is a graze


@kernel
def span_off_wall(numbers, flight, base, contact_order, h, h_min):
    """The longest of h, h/2, ... on which a flight that starts on the wall is proved free; 0 if none is.

    `contact_order` derivatives of the tip displacement vanish at the start, from the zeroth on: 1, 2 or 3.
    """
    w = numbers.drive
    _level, y1, y2 = tip_steady(numbers, base)
    y3 = -w * w * y1
    m4 = numbers.amplitude * w**4
    modes, u, v = numbers.modes, flight[rows.START_U], flight[rows.START_V]
    decay, square, phi, load = modes[DECAY], modes[SQUARE], modes[WEIGHT], modes[LOAD]
    for k in range(numbers.size):
        c, o2 = decay[k], square[k]
        d2 = load[k] - c * v[k] - o2 * u[k]
        d3 = -c * d2 - o2 * v[k]
        d4 = -c * d3 - o2 * d2
        y1 += phi[k] * v[k]
        y2 += phi[k] * d2
        y3 += phi[k] * d3
        m4 += abs(phi[k]) * math.sqrt(d4 * d4 + o2 * d3 * d3)
    while h > h_min:
        # (y - vanishing terms) / (leading power of h), bounded from above on (0, h]
        bound = m4 * h * h * h / 24.0
        if contact_order == 1:
            bound += y1 + max(0.0, 0.5 * y2 * h) + max(0.0, y3 * h * h / 6.0)
        elif contact_order == 2:
            bound += 0.5 * y2 * h + max(0.0, y3 * h * h / 6.0)
        else:
            bound += y3 * h * h / 6.0
        if bound < 0.0:
            return h
        h *= 0.5
    return 0.0


@part
def amplitudes(numbers, flight):
    """Fill row ABOVE: the sum of the amplitudes of all modes above each [m].

    Returns the number of modes, from the first on, that cannot be bounded and are always sampled (modes of
    zero frequency and all below them), and the sum of all amplitudes [m].
    """
    u, v, above = flight[rows.START_U], flight[rows.START_V], flight[rows.ABOVE]
    phi, inverse_omega = numbers.modes[WEIGHT], numbers.modes[INVERSE_OMEGA]
    for k in range(above.size):
        x = v[k] * inverse_omega[k]
        above[k] = abs(phi[k]) * math.sqrt(u[k] * u[k] + x * x)
    must, whole = 0, 0.0
    for k in range(numbers.size - 1, -1, -1):
        if must == 0 and not inverse_omega[k] > 0.0:
            must = k + 1
        own = above[k] if must == 0 else math.inf
        above[k] = whole
        whole += own
    return must, whole


@part
def tip_rows(modes, flight, start, stop):
    """Fill rows HEIGHT to JERK_BOUND with the tip parts of modes `start` to `stop`, from rows U and V."""
    decay, square, phi, load = modes[DECAY], modes[SQUARE], modes[WEIGHT], modes[LOAD]
    u, v, height, rate = flight[rows.U], flight[rows.V], flight[rows.HEIGHT], flight[rows.RATE]
    acceleration, jerk_bound = flight[rows.ACCELERATION], flight[rows.JERK_BOUND]
    for k in range(start, stop):
        c, o2 = decay[k], square[k]
        a = load[k] - c * v[k] - o2 * u[k]
        height[k] = phi[k] * u[k]
        rate[k] = phi[k] * v[k]
        acceleration[k] = phi[k] * a
        j = -c * a - o2 * v[k]
        jerk_bound[k] = abs(phi[k]) * math.sqrt(j * j + o2 * a * a)


@kernel
def first_crossing(numbers, base, u, v, duration, contact_order):
    """First time in (0, duration] at which a free flight crosses the stop.

    Parameters
    ----------
    base, duration : float
        Time since the strobe at which the flight starts, and its length [s].
    u, v : ndarray, shape (n_modes,)
        Deviation from the steady motion at the start, and its velocity.
    contact_order : int
        Number of derivatives of the tip displacement, from the zeroth on, that vanish at the start by
        construction: 0 for a tip off the wall, 1 after an impact, 2 after a plastic one or a graze, 3 at the
        release of a tip held on the wall.

    Returns the outcome, FREE, CROSSES, GRAZES or UNRESOLVED, and the time since the start of the flight [s].
    """
    flight = new_flight(numbers)
    load_state(flight, u, v)
    return searched_flight(numbers, flight, base, duration, contact_order)


@part
def needed_modes(above, sampled, least, distance):
    """How many of the `sampled` modes, at least `least`, are needed at a `distance` from the stop [m]."""
    while sampled > least and above[sampled - 2] < 0.125 * distance:
        sampled -= 1
    return sampled


@part
def sample_tip(numbers, flight, lowest, base, s, sampled):
    """Sample the lowest modes a time `s` into the flight, more than `sampled` if the gap is small.

    Returns the number of modes sampled, 0 if the lowest proves that no touch can come any more; without the
    other modes, the tip displacement relative to the stop and two derivatives; and a bound of the third.
    """
    w, above = numbers.drive, flight[rows.ABOVE]
    height, rate = flight[rows.HEIGHT], flight[rows.RATE]
    acceleration, jerk_bound = flight[rows.ACCELERATION], flight[rows.JERK_BOUND]
    y0, y1, y2 = tip_steady(numbers, base + s)
    m3 = numbers.amplitude * w**3
    k, ready = 0, 0
    while k < sampled:
        if k == ready:
            flow(numbers, flight, ready, ready + LANES, s)
            tip_rows(numbers.modes, flight, ready, ready + LANES)
            ready += LANES
        y0 += height[k]
        y1 += rate[k]
        y2 += acceleration[k]
        m3 += jerk_bound[k]
        if k == 0 and free_from(lowest, base + s, y0, y1):
            sampled = 0
        k += 1
        if k == sampled and sampled < numbers.size and above[sampled - 1] > 0.25 * max(-y0, 0.0):
            sampled += 1
    return sampled, y0, y1, y2, m3


@part
def outcome_at_peak(numbers, flight, base, point, step, duration, m3, margin):
    """Outcome and time of a span of length `step` with one peak, and the height of the peak [m].

    The span starts at `point`, (time, tip displacement and two derivatives).
    """
    s = point[0]
    peak = find_peak(numbers, flight, base, point, (s, s + step), m3, margin)
    beyond = peak > duration
    end = duration if beyond else peak  # the motion rises up to here
    top = tip_now(numbers, flight, base, end)[0]
    if top > margin:
        return CROSSES, find_root(numbers, flight, base, point, (s, end), m3, margin), top
    if beyond:
        return FREE, duration, top
    if top >= -margin:
        return UNRESOLVED if margin > GRAZE_TOLERANCE * numbers.gap else GRAZES, peak, top
    return BELOW, peak, top


@kernel
def end_of_hop(numbers, flight, base, s):
    """The end of a short flight from the wall and back, near `s`, to all digits.

    Heights of a low hop are small differences of large numbers.  Here height zero at the start is exact, and
    the end is a root of y(s)/s, from the Taylor series of the modes.
    """
    w, modes, height = numbers.drive, numbers.modes, np.zeros(HOP_ORDER)
    _level, height[0], pull = tip_steady(numbers, base)
    height[1] = 0.5 * pull
    for n in range(2, HOP_ORDER):
        height[n] = -w * w * height[n - 2] / (n * (n + 1.0))
    for k in range(numbers.size):
        low, high, load = flight[rows.START_U, k], flight[rows.START_V, k], modes[LOAD, k]
        for n in range(HOP_ORDER):
            height[n] += modes[WEIGHT, k] * high
            pull = load - (n + 1.0) * modes[DECAY, k] * high - modes[SQUARE, k] * low
            low, high, load = high, pull / ((n + 1.0) * (n + 2.0)), 0.0  # the load is constant
    found = s
    for _ in range(3):
        y, slope, _bend = horner(height, 1.0, 0.0, found)
        found -= y / slope if slope > 0.0 else 0.0
    return found if abs(found - s) < 0.1 * s else s


@kernel
def searched_flight(numbers, flight, base, duration, contact_order):
    """`first_crossing` of the flight that starts at rows START_U and START_V of its workspace."""
    must, whole = amplitudes(numbers, flight)
    margin = tip_rounding(numbers, flight[rows.START_U], flight[rows.START_V])
    if contact_order == 0 and numbers.level + numbers.amplitude + whole < -margin:
        return FREE, duration
    peak, first, end, half = peak_of_drive(numbers), 0.0, duration, 0.5 * numbers.period
    if base < half < base + duration and abs(peak - half) > 0.5 * half * (1.0 + 1e-12):
        end = half - base
    while True:
        span, order = (first, end), 0 if first > 0.0 else contact_order
        outcome, s = searched_span(numbers, flight, base, span, order, peak, must, margin)
        if outcome == CROSSES and contact_order == 1 and s * numbers.fastest < HOP:
            s = end_of_hop(numbers, flight, base, s)
        if outcome != FREE or s >= duration:
            return outcome, min(s, duration)
        first, end = s, duration


@part
def searched_span(numbers, flight, base, span, contact_order, peak, must, margin):
    """The first crossing in a `span` of times of a flight [s], which is free up to there."""
    n, above, duration = numbers.size, flight[rows.ABOVE], span[1]
    lowest = lowest_mode(numbers, flight, base, span, peak, above[0], margin)
    h, h_min = 0.05 * numbers.period, 64.0 * EPS * (base + duration)
    if numbers.fastest > 0.0:
        h_min += 1e-15 / numbers.fastest
    if contact_order == 0:
        s = free_until(numbers, flight, lowest, base, span)
        if s >= duration:
            return FREE, duration
    else:
        s = span_off_wall(numbers, flight, base, contact_order, h, h_min)
        if s == 0.0:
            return UNRESOLVED, 0.0
        if s >= duration:
            return FREE, s
    least = max(must, 1)
    sampled, distance = least if contact_order == 0 else n, 0.0
    while s < duration:
        if distance > 0.0:
            sampled = needed_modes(above, sampled, least, distance)
        sampled, y0, y1, y2, m3 = sample_tip(numbers, flight, lowest, base, s, sampled)
        if sampled == 0:
            return FREE, duration
        if sampled == n and s == 0.0 and abs(y0) <= margin:
            # on the wall within rounding although not by construction: the velocity decides
            if y1 > 0.0:
                return CROSSES, 0.0
            s = span_off_wall(numbers, flight, base, 1 if y1 < 0.0 else 2, h, h_min)
            if s == 0.0:
                return UNRESOLVED, 0.0
            continue
        point = (s, y0, y1, y2)
        proof, step = certify(y0, y1, y2, m3, above[sampled - 1], margin, h, h_min)
        if proof == SKIP:
            distance = -y0
        elif proof == ROOT:
            root = find_root(numbers, flight, base, point, (s, s + step), m3, margin)
            return (FREE, duration) if root > duration else (CROSSES, root)
        elif proof == PEAK:
            outcome, time, top = outcome_at_peak(numbers, flight, base, point, step, duration, m3, margin)
            if outcome != BELOW:
                return outcome, time
            distance = -top
        elif sampled < n:
            sampled, distance = n, 0.0
            continue
        else:
            return UNRESOLVED, s
        s += step
        h = 2.0 * step
    return FREE, duration
