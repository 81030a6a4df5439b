"""The first crossing of the stop, certified.

A signal y(s) (tip displacement minus gap, or a contact force) is known in closed form with its first two
derivatives, and a bound M of its third.  Starting where y < 0, time is skipped only by a bound that proves
the stretch free:

    y(s + h) <= max over [0, h] of (y + y' h + y'' h^2/2) + M h^3/6 + R < -margin

(``contact.flight.bounds``, with the two proofs that end a search: one root, one peak).  R is the sum of
amplitudes of those high modes that are bounded instead of sampled; they are taken in one by one as the gap
closes.  The bounds of the single modes are those of
``contact.flight.modal_flow``.  Whole flights, the way to just
before a touch, and what is left of a period after one, are settled by the lowest mode alone where that can be
done (``contact.flight.bounds``).

A graze, |peak| within the rounding bound of y (at most 1e-13 of the gap), is an outcome of its own.  A
stretch that none of this settles, with h down to rounding, is reported as unresolved and never passed.
"""

from __future__ import annotations

import math

from contact.flight.bounds import PEAK, ROOT, SKIP, certify, free_from, free_until, lowest_mode
from contact.flight.elementary import EPS
from contact.flight.modal_flow import (
    ABOVE,
    BEND,
    HEIGHT,
    RATE,
    START_U,
    START_V,
    THIRD,
    U,
    V,
    flow,
    load_state,
    new_flight,
    tip_rounding,
    tip_steady,
)
from contact.flight.motion import DECAY, LOAD, SLOWNESS, SQUARE, WEIGHT
from contact.flight.tip_search import find_peak, find_root, tip_now
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import LANES

FREE, CROSSES, GRAZES, UNRESOLVED = 0, 1, 2, 3

GRAZE_TOLERANCE = 1e-13
"""Largest rounding bound, relative to the gap, within which a peak may be called a graze."""


@kernel
def depart(motion, flight, base, order, h, h_min):
    """The longest of h, h/2, ... on which a flight that starts on the wall is proved free; 0 if none is.

    `order` derivatives of the tip displacement vanish at the start, from the zeroth on: 1, 2 or 3.
    """
    w = motion.drive
    _level, y1, y2 = tip_steady(motion, base)
    y3 = -w * w * y1
    m4 = motion.amplitude * w**4
    modes, u, v = motion.modes, flight[START_U], flight[START_V]
    decay, square, phi, load = modes[DECAY], modes[SQUARE], modes[WEIGHT], modes[LOAD]
    for k in range(motion.size):
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
        if order == 1:
            bound += y1 + max(0.0, 0.5 * y2 * h) + max(0.0, y3 * h * h / 6.0)
        elif order == 2:
            bound += 0.5 * y2 * h + max(0.0, y3 * h * h / 6.0)
        else:
            bound += y3 * h * h / 6.0
        if bound < 0.0:
            return h
        h *= 0.5
    return 0.0


@part
def amplitudes(motion, flight):
    """Fill row ABOVE: the sum of the amplitudes of all modes above each [m].

    Returns
    -------
    must : int
        How many modes, from the first on, have none that could be bounded (those of zero frequency and all
        below).
    whole : float
        The sum of all amplitudes [m].
    """
    u, v, above = flight[START_U], flight[START_V], flight[ABOVE]
    phi, slowness = motion.modes[WEIGHT], motion.modes[SLOWNESS]
    for k in range(above.size):
        x = v[k] * slowness[k]
        above[k] = abs(phi[k]) * math.sqrt(u[k] * u[k] + x * x)
    must, whole = 0, 0.0
    for k in range(motion.size - 1, -1, -1):
        if must == 0 and not slowness[k] > 0.0:
            must = k + 1
        own = above[k] if must == 0 else math.inf
        above[k] = whole
        whole += own
    return must, whole


@part
def tip_rows(modes, flight, start, stop):
    """What modes `start` to `stop` add to the tip displacement, its derivatives and bounds, in rows HEIGHT to
    THIRD, from rows U, V."""
    decay, square, phi, load = modes[DECAY], modes[SQUARE], modes[WEIGHT], modes[LOAD]
    u, v, height, rate, bend, third = (
        flight[U],
        flight[V],
        flight[HEIGHT],
        flight[RATE],
        flight[BEND],
        flight[THIRD],
    )
    for k in range(start, stop):
        c, o2 = decay[k], square[k]
        a = load[k] - c * v[k] - o2 * u[k]
        height[k] = phi[k] * u[k]
        rate[k] = phi[k] * v[k]
        bend[k] = phi[k] * a
        j = -c * a - o2 * v[k]
        third[k] = abs(phi[k]) * math.sqrt(j * j + o2 * a * a)


@kernel
def first_crossing(motion, base, u, v, duration, order):
    """First time in (0, duration] at which a free flight crosses the stop.

    Parameters
    ----------
    motion : Motion
        The oscillator.
    base : float
        Time since the strobe at which the flight starts [s].
    u, v : ndarray, shape (n_modes,)
        Deviation from the steady motion at the start, and its velocity.
    duration : float
        Length of the flight [s].
    order : int
        How many derivatives of the tip displacement, from the zeroth on, vanish at the start by construction:
        0 for a tip off the wall, 1 after an impact, 2 after a plastic one or a graze, 3 at a release.

    Returns
    -------
    outcome : int
        FREE, CROSSES, GRAZES or UNRESOLVED.
    s : float
        Time since the start of the flight [s].
    """
    flight = new_flight(motion)
    load_state(flight, u, v)
    return searched_flight(motion, flight, base, duration, order)


@kernel
def searched_flight(motion, flight, base, duration, order):
    """`first_crossing` of the flight that starts at rows START_U and START_V of its work space."""
    n, w = motion.size, motion.drive
    margin = tip_rounding(motion, flight[START_U], flight[START_V])
    must, whole = amplitudes(motion, flight)  # modes that are always sampled
    if order == 0 and motion.level + motion.amplitude + whole < -margin:
        return FREE, duration
    above = flight[ABOVE]
    lowest = lowest_mode(motion, flight, base, duration, above[0], margin)
    h = 0.05 * motion.period
    s = 0.0
    if order == 0:
        s = free_until(motion, flight, lowest, base, duration)
        if s >= duration:
            return FREE, duration
    h_min = 64.0 * EPS * (base + duration)
    if motion.fastest > 0.0:
        h_min += 1e-15 / motion.fastest
    if order > 0:
        s = depart(motion, flight, base, order, h, h_min)
        if s == 0.0:
            return UNRESOLVED, 0.0
    sampled = n if order > 0 else max(must, 1)
    distance = 0.0
    height, rate, bend, third = flight[HEIGHT], flight[RATE], flight[BEND], flight[THIRD]
    while s < duration:
        if distance > 0.0:
            while sampled > max(must, 1) and above[sampled - 2] < 0.125 * distance:
                sampled -= 1
        y0, y1, y2 = tip_steady(motion, base + s)
        m3 = motion.amplitude * w**3
        k, ready = 0, 0
        while k < sampled:
            if k == ready:
                flow(motion, flight, ready, ready + LANES, s)
                tip_rows(motion.modes, flight, ready, ready + LANES)
                ready += LANES
            y0 += height[k]
            y1 += rate[k]
            y2 += bend[k]
            m3 += third[k]
            if k == 0 and free_from(lowest, base + s, y0, y1):
                return FREE, duration
            k += 1
            if k == sampled and sampled < n and above[sampled - 1] > 0.25 * max(-y0, 0.0):
                sampled += 1
        if sampled == n and s == 0.0 and abs(y0) <= margin:
            # on the wall within rounding although not by construction: the velocity decides
            if y1 > 0.0:
                return CROSSES, 0.0
            s = depart(motion, flight, base, 1 if y1 < 0.0 else 2, h, h_min)
            if s == 0.0:
                return UNRESOLVED, 0.0
            continue
        rest = above[sampled - 1]
        point = (s, y0, y1, y2)
        proof, step = certify(y0, y1, y2, m3, rest, margin, h, h_min)
        if proof == SKIP:
            s += step
            distance = -y0
            h = 2.0 * step
        elif proof == ROOT:
            root = find_root(motion, flight, base, point, (s, s + step), m3, margin)
            if root > duration:
                return FREE, duration
            return CROSSES, root
        elif proof == PEAK:
            peak = find_peak(motion, flight, base, point, (s, s + step), m3, margin)
            if peak > duration:
                # the motion rises all the way to the end: its height there decides
                if tip_now(motion, flight, base, duration)[0] > margin:
                    return CROSSES, find_root(motion, flight, base, point, (s, duration), m3, margin)
                return FREE, duration
            top = tip_now(motion, flight, base, peak)[0]
            if top > margin:
                return CROSSES, find_root(motion, flight, base, point, (s, peak), m3, margin)
            if top >= -margin:
                if margin > GRAZE_TOLERANCE * motion.gap:
                    return UNRESOLVED, peak
                return GRAZES, peak
            s += step
            distance = -top
            h = 2.0 * step
        elif sampled < n:
            sampled = n
            distance = 0.0
        else:
            return UNRESOLVED, s
    return FREE, duration
