"""The tip during a flight, and where in a bracket it crosses the stop or turns back.

Both places are found on the exact flow by Newton's method within the bracket, the root of the parabola
through a point in place of that of the tangent.  With a bound M of the third derivative the last step needs
no check: one of length x ends within M x^3/6 of the height sought, or with y' within M x^2/2 of zero.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

from contact.compiled import kernel
from contact.flight import EPS
from contact.modal_flow import (
    DECAY,
    LOAD,
    SQUARE,
    WEIGHT,
    U,
    V,
    flow_rows,
    load_state,
    mode_rows,
    scalars_of,
    swing_at,
)

__all__ = ["find_peak", "find_root", "tip_at", "tip_of"]


@kernel
def tip_of(fixed, numbers, room, base, s):
    """Tip displacement relative to the stop and two derivatives, a time `s` into the flight."""
    y0, y1, y2 = swing_at(fixed, base + s)
    padded = room.shape[1]
    flow_rows(fixed, numbers, room, 0, padded, s)
    u, v = room[U], room[V]
    decay, square, phi, load = numbers[DECAY], numbers[SQUARE], numbers[WEIGHT], numbers[LOAD]
    for k in range(padded):
        y0 += phi[k] * u[k]
        y1 += phi[k] * v[k]
        y2 += phi[k] * (load[k] - decay[k] * v[k] - square[k] * u[k])
    return y0, y1, y2


@kernel
def tip_at(motion, base, u, v, s):
    """Tip displacement relative to the stop and two derivatives, a time `s` into the flight from (u, v)."""
    fixed = scalars_of(motion)
    numbers, room = mode_rows(motion)
    load_state(room, u, v)
    return tip_of(fixed, numbers, room, base, s)


@kernel
def find_root(fixed, numbers, room, base, s, y0, y1, y2, m3, low, high, margin):
    """The root of the tip displacement in [low, high], where it rises from below to above zero [s].

    (y0, y1, y2) are its derivatives at `s`, where the search begins, and `m3` bounds the third from `low` on
    (or is infinite).
    """
    for _ in range(200):
        if abs(y0) <= 0.05 * margin:
            return s
        if y0 < 0.0:
            low = s
        else:
            high = s
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
        y0, y1, y2 = tip_of(fixed, numbers, room, base, s)
    return s


@kernel
def find_peak(fixed, numbers, room, base, s, y1, y2, m3, low, high, margin):
    """The peak of the tip displacement in [low, high], where it is concave [s].

    (y1, y2) are its slope and curvature at `s`, where the search begins, and `m3` bounds the third derivative
    from `low` on (or is infinite).
    """
    for _ in range(200):
        if y1 == 0.0:
            return s
        if y1 > 0.0:
            low = s
        else:
            high = s
        new = s - y1 / y2 if y2 < 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        else:
            # the height is settled long before the place: its error is y''/2 times the square of
            # what is left, at most m3 (new - s)^2 / (2 y'')
            off = min(m3 * (new - s) ** 2, -2.0 * y2 * abs(new - s))
            if off * off <= -4e-3 * margin * y2:
                return new
        if high - low <= 4.0 * EPS * (base + high):
            return new
        s = new
        _unused, y1, y2 = tip_of(fixed, numbers, room, base, s)
    return s
