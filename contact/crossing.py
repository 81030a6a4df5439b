"""The first crossing of the stop, certified.

A signal y(s) (tip displacement minus gap, or a contact force) is known in closed form with its first two
derivatives, and a bound M of its third.  Starting where y < 0, time is skipped only by a bound that proves
the stretch free:

    y(s + h) <= max over [0, h] of (y + y' h + y'' h^2/2) + M h^3/6 + R < -margin

(``contact.certificate``, with the two proofs that end a search: one root, one peak).  R is the sum of
amplitudes of those high modes that are bounded instead of sampled; they are taken in one by one as the gap
closes.  The bounds of the single modes are those of ``contact.flight``.  Whole flights, the way to just
before a touch, and what is left of a period after one, are settled by the lowest mode alone where that can be
done (``contact.lowest_mode``).

A graze, |peak| within the rounding bound of y (at most 1e-13 of the gap), is an outcome of its own.  A
stretch that none of this settles, with h down to rounding, is reported as unresolved and never passed.
"""

from __future__ import annotations

import math

from contact.certificate import PEAK, ROOT, SKIP, certify, first_polynomial_root
from contact.compiled import kernel
from contact.flight import EPS
from contact.lanes import LANES
from contact.lowest_mode import free_from, free_until, lowest_mode
from contact.modal_flow import (
    BEND,
    DECAY,
    HEIGHT,
    LOAD,
    RATE,
    SLOWNESS,
    SQUARE,
    START_U,
    START_V,
    THIRD,
    WEIGHT,
    flow_rows,
    load_state,
    mode_rows,
    rounding_of,
    scalars_of,
    swing_at,
    tip_rows,
)
from contact.tip_search import find_peak, find_root, tip_at, tip_of

__all__ = [
    "CROSSES",
    "FREE",
    "GRAZES",
    "UNRESOLVED",
    "first_crossing",
    "first_polynomial_root",
    "searched_flight",
    "tip_at",
]

FREE, CROSSES, GRAZES, UNRESOLVED = 0, 1, 2, 3

GRAZE_TOLERANCE = 1e-13
"""Largest rounding bound, relative to the gap, within which a peak may be called a graze."""


@kernel
def depart(fixed, numbers, room, base, order, h, h_min):
    """The longest of h, h/2, ... on which a flight that starts on the wall is proved free; 0 if none is.

    `order` derivatives of the tip displacement vanish at the start, from the zeroth on: 1, 2 or 3.
    """
    w = fixed.drive
    _level, y1, y2 = swing_at(fixed, base)
    y3 = -w * w * y1
    m4 = fixed.amplitude * w**4
    decay, square, phi, load = numbers[DECAY], numbers[SQUARE], numbers[WEIGHT], numbers[LOAD]
    u, v = room[START_U], room[START_V]
    for k in range(room.shape[1]):
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


@kernel
def amplitudes(numbers, room, envelope):
    """Fill `envelope` with the sums of the amplitudes of mode k and all above it [m]; returns how many modes,
    from the first on, have none that could be bounded (those of zero frequency and all below)."""
    n = envelope.size - 1
    u, v, phi, slowness = room[START_U], room[START_V], numbers[WEIGHT], numbers[SLOWNESS]
    for k in range(n):
        x = v[k] * slowness[k]
        envelope[k] = abs(phi[k]) * math.sqrt(u[k] * u[k] + x * x)
    envelope[n] = 0.0
    must = 0
    for k in range(n - 1, -1, -1):
        if must == 0 and not slowness[k] > 0.0:
            must = k + 1
        envelope[k] = envelope[k] + envelope[k + 1] if must == 0 else math.inf
    return must


@kernel
def first_crossing(motion, base, u, v, duration, order, envelope):
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
    envelope : ndarray, shape (n_modes + 1,)
        Work space.

    Returns
    -------
    outcome : int
        FREE, CROSSES, GRAZES or UNRESOLVED.
    s : float
        Time since the start of the flight [s].
    """
    fixed = scalars_of(motion)
    numbers, room = mode_rows(motion)
    load_state(room, u, v)
    return searched_flight(fixed, numbers, room, base, duration, order, envelope)


@kernel
def searched_flight(fixed, numbers, room, base, duration, order, envelope):
    """`first_crossing` with the oscillator and the start of the flight as ``contact.modal_flow`` keeps
    them."""
    n, w = envelope.size - 1, fixed.drive
    margin = rounding_of(fixed, numbers, room)
    must = amplitudes(numbers, room, envelope)  # modes that are always sampled
    if order == 0 and fixed.level + fixed.amplitude + envelope[0] < -margin:
        return FREE, duration
    lowest = lowest_mode(fixed, numbers, room, base, duration, envelope[1], margin)
    h = 0.05 * fixed.period
    s = 0.0
    if order == 0:
        s = free_until(fixed, numbers, room, lowest, base, duration)
        if s >= duration:
            return FREE, duration
    h_min = 64.0 * EPS * (base + duration)
    if fixed.fastest > 0.0:
        h_min += 1e-15 / fixed.fastest
    if order > 0:
        s = depart(fixed, numbers, room, base, order, h, h_min)
        if s == 0.0:
            return UNRESOLVED, 0.0
    sampled = n if order > 0 else max(must, 1)
    distance = 0.0
    padded = room.shape[1]
    height, rate, bend, third = room[HEIGHT], room[RATE], room[BEND], room[THIRD]
    while s < duration:
        if distance > 0.0:
            while sampled > max(must, 1) and envelope[sampled - 1] < 0.125 * distance:
                sampled -= 1
        y0, y1, y2 = swing_at(fixed, base + s)
        m3 = fixed.amplitude * w**3
        k, ready = 0, 0
        while k < sampled:
            if k == ready:
                flow_rows(fixed, numbers, room, ready, min(ready + LANES, padded), s)
                tip_rows(numbers, room, ready, min(ready + LANES, padded))
                ready += LANES
            y0 += height[k]
            y1 += rate[k]
            y2 += bend[k]
            m3 += third[k]
            if k == 0 and free_from(lowest, base + s, y0, y1):
                return FREE, duration
            k += 1
            if k == sampled and sampled < n and envelope[sampled] > 0.25 * max(-y0, 0.0):
                sampled += 1
        if sampled == n and s == 0.0 and abs(y0) <= margin:
            # on the wall within rounding although not by construction: the velocity decides
            if y1 > 0.0:
                return CROSSES, 0.0
            s = depart(fixed, numbers, room, base, 1 if y1 < 0.0 else 2, h, h_min)
            if s == 0.0:
                return UNRESOLVED, 0.0
            continue
        rest = envelope[sampled]
        proof, step = certify(y0, y1, y2, m3, rest, margin, h, h_min)
        if proof == SKIP:
            s += step
            distance = -y0
            h = 2.0 * step
        elif proof == ROOT:
            root = find_root(fixed, numbers, room, base, s, y0, y1, y2, m3, s, s + step, margin)
            if root > duration:
                return FREE, duration
            return CROSSES, root
        elif proof == PEAK:
            peak = find_peak(fixed, numbers, room, base, s, y1, y2, m3, s, s + step, margin)
            if peak > duration:
                # the motion rises all the way to the end: its height there decides
                if tip_of(fixed, numbers, room, base, duration)[0] > margin:
                    return CROSSES, find_root(
                        fixed, numbers, room, base, s, y0, y1, y2, m3, s, duration, margin
                    )
                return FREE, duration
            top = tip_of(fixed, numbers, room, base, peak)[0]
            if top > margin:
                return CROSSES, find_root(fixed, numbers, room, base, s, y0, y1, y2, m3, s, peak, margin)
            if top >= -margin:
                if margin > GRAZE_TOLERANCE * fixed.gap:
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


