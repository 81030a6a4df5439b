"""Long stretches of a flight proved free by its lowest mode alone.

Relative to the stop the tip is at

    y(t) = -G + A cos(w (t - t_p)) + phi u(t) + R(t),      |R| <= r,

G the distance of the stop from the tip's mean place, A and t_p height and time of the steady peak, u the free
deviation of the lowest mode and R that of all others, which is bounded by the sum r of their amplitudes
(``contact.flight``).  Let rho = |phi| sqrt(u^2 + (v/omega)^2) at the start of the flight.  From then on

    y'' - R'' + w^2 (y - R + G) = phi (u'' + w^2 u) <= w^2 d,     d = (|w^2 - omega^2| + c omega) rho/w^2,

because of u'' = -c u' - omega^2 u, |phi u| <= rho and |phi u'| <= omega rho.  Hence z = y - R + G - d obeys
z'' + w^2 z <= 0, and lies below the swing that shares its height z_1 and slope z_1' at any t_1 of the flight
(the difference is an integral over sin(w (t - s)) >= 0 of something not above zero):

    z(t) <= z_1 cos(w (t - t_1)) + (z_1'/w) sin(w (t - t_1)),      |t - t_1| <= pi/w.                  (1)

With m the margin for rounding, the tip stays off the stop wherever z < K = G - d - r - m, and also where
cos(w (t - t_p)) <= 0 if rho + r + m < G.  Let t_p lie in the middle half of the drive period to which the
flight is confined, |t_1 - t_p| be at most a quarter of it, and |z_1| < K > 0.  What (1) leaves out, more than
half a period from t_1, then has cos(w (t - t_p)) <= 0, and the bound in (1) stays below |z_1| on one side:

    z_1' <= 0: no touch after t_1;      z_1' >= 0: none before;      z_1^2 + (z_1'/w)^2 < K^2: none at all.

The first two hold with t_1 farther off as well, after t_p - P/4 and before t_p + P/4.  A flight that is free
all the time is so settled by the motion at t_p or at the peak next to it, one that is not up to just before
y - R first comes within r of the stop.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math
from typing import NamedTuple

from contact.compiled import kernel
from contact.flight import mode_flow, sine_cosine
from contact.modal_flow import DAMPED, DECAY, LOW, OMEGA, SQUARE, START_U, START_V, WEIGHT

__all__ = ["LowestMode", "free_from", "free_until", "lowest_mode"]

LEAST_ROOM = 1.0 / 16.0
"""K over G below which nothing is claimed, so that squares are rounded by less than the margin allows."""

HIGHEST = 1e6
"""Steady amplitude in gaps up to which the place of its peak is good enough to tell a period's middle."""

UNCERTAIN = 1e-11
"""Rounding of the peak's place, as part of the amplitude that cos(w (t - t_p)) <= 0 may fail to take away."""

TRIES = 4
"""Looks for a t_1; two do unless the lowest mode has moved far from its steady motion."""

CLOSE = 1e-4
"""Distance from r, over G, within which a t_1 before the touch is good enough."""


class LowestMode(NamedTuple):
    """What the claims about one flight need.

    peak, quarter : float
        t_p and a quarter of the drive period [s].
    mean : float
        G - d [m]: z is the tip displacement without the other modes plus this.
    room : float
        K [m]; zero if nothing can be claimed.
    near : float
        r with its margin [m].
    """

    peak: float
    quarter: float
    mean: float
    room: float
    near: float


@kernel
def lowest_mode(fixed, numbers, room, base, duration, rest, margin):
    """The claims about a flight.

    Parameters
    ----------
    fixed, numbers, room
        As in ``contact.modal_flow``, with the start of the flight.
    base, duration : float
        Time since the strobe at which the flight starts, and its length [s].
    rest : float
        r, infinite if a mode of zero frequency takes part [m].
    margin : float
        Rounding bound of the tip displacement [m].
    """
    w, gap, omega, period = fixed.drive, -fixed.level, numbers[OMEGA, 0], fixed.period
    u, v = room[START_U, 0], room[START_V, 0]
    near = rest * (1.0 + 1e-12) + 8.0 * margin
    nothing = LowestMode(0.0, 0.0, 0.0, 0.0, near)
    if not (w > 0.0 and omega > 0.0 and gap > near and base + duration <= period * (1.0 + 1e-12)):
        return nothing
    rho = abs(numbers[WEIGHT, 0]) * math.sqrt(u * u + v * v / (omega * omega))
    deviant = (abs(w - omega) * (w + omega) + numbers[DECAY, 0] * omega) * rho / (w * w)
    room = gap - deviant - near
    if not (room > LEAST_ROOM * gap and rho + near + UNCERTAIN * fixed.amplitude < gap):
        return nothing
    angle = math.atan2(fixed.sine, fixed.cosine)
    peak = (angle if angle >= 0.0 else angle + 2.0 * math.pi) / w
    quarter = 0.25 * period
    if not (abs(peak - 2.0 * quarter) <= quarter * (1.0 + 1e-12) and fixed.amplitude <= HIGHEST * gap):
        return nothing
    return LowestMode(peak, quarter, gap - deviant, room, near)


@kernel
def free_from(lowest, t, height, rate):
    """Whether no touch can come after the drive time `t` at which the tip, without the other modes, is at
    `height` and moves at `rate`."""
    return rate <= 0.0 and abs(height + lowest.mean) < lowest.room and t >= lowest.peak - lowest.quarter


@kernel
def without_others(fixed, numbers, room, base, s):
    """Tip displacement relative to the stop without the modes above the lowest, and three derivatives."""
    w, c, o2 = fixed.drive, numbers[DECAY, 0], numbers[SQUARE, 0]
    sine, cosine = sine_cosine(w * (base + s), 0.0)
    swing = fixed.sine * sine + fixed.cosine * cosine
    swing_rate = w * (fixed.sine * cosine - fixed.cosine * sine)
    u, v = mode_flow(
        numbers[OMEGA, 0], c, numbers[DAMPED, 0], numbers[LOW, 0], 0.0, room[START_U, 0], room[START_V, 0], s
    )
    a = -c * v - o2 * u
    phi = numbers[WEIGHT, 0]
    return (
        fixed.level + swing + phi * u, swing_rate + phi * v, phi * a - w * w * swing,
        -w * w * swing_rate - phi * (c * a + o2 * v),
    )  # fmt: skip


@kernel
def free_until(fixed, numbers, room, lowest, base, duration):
    """Time from the start of the flight up to which no touch can come, `duration` if none comes [s]."""
    if not lowest.room > 0.0:
        return 0.0
    w, least, end = fixed.drive, lowest.room, base + duration
    goal = 1.25 * lowest.near + 0.5 * CLOSE * abs(fixed.level)
    t, free = min(max(lowest.peak, base), end), 0.0
    for _ in range(TRIES):
        if t - lowest.peak > lowest.quarter:
            return duration if t == base else free
        height, rate, bend, twist = without_others(fixed, numbers, room, base, t - base)
        z = height + lowest.mean
        if z * z + (rate / w) ** 2 < least * least and t >= lowest.peak - lowest.quarter:
            return duration
        if t == base and free_from(lowest, t, height, rate):
            return duration
        if rate >= 0.0 and abs(z) < least:
            free = t - base
            if t == end or -height < 2.0 * goal:
                return free
        # on to where `height` rises through -goal, or to its peak if it stays below
        under = rate * rate - 2.0 * bend * (height + goal)
        if bend >= 0.0:
            return free
        if under > 0.0:
            x = (math.sqrt(under) - rate) / bend
            speed = rate + x * (bend + 0.5 * x * twist)
            if speed > 0.0:
                x -= (height + goal + x * (rate + x * (0.5 * bend + x * twist / 6.0))) / speed
        else:
            x = -rate / bend
            x -= 0.5 * twist * x * x / (bend + twist * x)
        if not abs(x) < lowest.quarter or t + x <= base:
            return free
        t = min(t + x, end)
    return free
