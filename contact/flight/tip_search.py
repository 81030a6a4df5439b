"""The tip during a flight, its root and its peak in a bracket, and all its peaks.

Root and peak are found on the exact flow by Newton's method within the bracket; for a root the parabola
through a point replaces the tangent.  With |y'''| <= M a last step of length x ends within M x^3/6 of the
height sought, or with y' within M x^2/2 of zero.
"""

import math

import numpy as np

from contact.flight.elementary import EPS
from contact.flight.modal_flow import U, V, flow, load_state, new_flight
from contact.flight.tip import jerk_bound, tip_rounding, tip_state
from contact.machine.compiled import kernel

SHORTEST = 1e-9
"""Shortest span over the length of a flight, which bounds the number of spans.  A peak and a valley
that lie closer differ in height by less than rounding."""


@kernel
def tip_now(numbers, flight, base, s):
    """Tip displacement relative to the stop and two derivatives, a time `s` into the flight."""
    flow(numbers, flight, 0, flight.shape[1], s)
    return tip_state(numbers, base + s, flight[U], flight[V])


@kernel
def tip_at(numbers, base, u, v, s):
    """Tip displacement relative to the stop and two derivatives, a time `s` into the flight from (u, v)."""
    flight = new_flight(numbers)
    load_state(flight, u, v)
    return tip_now(numbers, flight, base, s)


@kernel
def find_root(numbers, flight, base, point, bracket, m3, margin):
    """The root of the tip displacement in the `bracket`, where it rises from below to above zero [s].

    The search begins at `point`, a time with the displacement and two derivatives there.  `m3` bounds the
    third derivative from the start of the bracket on, or is infinite.
    """
    s, y0, y1, y2 = point
    low, high = bracket
    for _ in range(200):
        if abs(y0) <= 0.05 * margin:
            return s
        low, high = (s, high) if y0 < 0.0 else (low, s)
        square = y1 * y1 - 2.0 * y0 * y2
        new = low
        if y1 > 0.0 and square > 0.0:
            # the root of the parabola through the point
            new = s - 2.0 * y0 / (y1 + math.sqrt(square))
        if not (low < new < high):
            new = 0.5 * (low + high)
        elif m3 * abs(new - s) ** 3 <= 0.3 * margin:
            return new
        if abs(new - s) <= 2.0 * EPS * abs(s) or high - low <= 2.0 * EPS * high:
            return new
        s = new
        y0, y1, y2 = tip_now(numbers, flight, base, s)
    return s


@kernel
def root_between(numbers, flight, base, low, high, margin):
    """The root of the tip displacement in [low, high] [s]."""
    middle = 0.5 * (low + high)
    point = (middle, *tip_now(numbers, flight, base, middle))
    return find_root(numbers, flight, base, point, (low, high), math.inf, margin)


@kernel
def find_peak(numbers, flight, base, point, bracket, m3, margin):
    """The peak of the tip displacement in a `bracket` where it is concave [s]; arguments of `find_root`."""
    s, _y0, y1, y2 = point
    low, high = bracket
    for _ in range(200):
        if y1 == 0.0:
            return s
        low, high = (s, high) if y1 > 0.0 else (low, s)
        new = s - y1 / y2 if y2 < 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        else:
            # the height is exact long before the time: its error is y''/2 times the square of the
            # error of the time, which is at most m3 (new - s)^2 / (2 y'')
            off = min(m3 * (new - s) ** 2, -2.0 * y2 * abs(new - s))
            if off * off <= -4e-3 * margin * y2:
                return new
        if high - low <= 4.0 * EPS * (base + high):
            return new
        s = new
        _unused, y1, y2 = tip_now(numbers, flight, base, s)
    return s


@kernel
def peaks_of_flight(numbers, base, u, v, span, rising):
    """All peaks of the tip in a `span` of times of the flight from (u, v) [s], shape (n,).

    With |y'''| <= M and r = sqrt(y''^2 + 2 M |y'|), y' keeps its sign for a time (r - |y''|)/M, or
    (r + |y''|)/M where y'' leads away from zero, and y'' keeps its sign for |y''|/M.  None of these spans
    holds two peaks.  Set `rising` if the tip may rise at the start; a tip that leaves the stop does not.
    """
    flight = new_flight(numbers)
    load_state(flight, u, v)
    margin = EPS * tip_rounding(numbers, u, v)  # so that the time is as exact as the height
    (s, end), found, before, m3 = span, [0.0], 0.0, 0.0
    point, least = (s, 0.0, 0.0, 0.0), SHORTEST * (end - s)
    while True:
        y0, y1, y2 = tip_now(numbers, flight, base, s)
        if before > 0.0 >= y1:
            found.append(find_peak(numbers, flight, base, point, (point[0], s), m3, margin))
            flow(numbers, flight, 0, flight.shape[1], s)
        if not s < end:
            return np.array(found[1:])
        before, point, m3 = y1 if rising else 0.0, (s, y0, y1, y2), jerk_bound(numbers, flight[U], flight[V])
        rising = True
        root, bend = math.sqrt(y2 * y2 + 2.0 * m3 * abs(y1)), abs(y2)
        sure = root + bend if y1 * y2 > 0.0 else max(bend, root - bend)
        s = min(s + max(sure / m3, least), end) if m3 > 0.0 else end
