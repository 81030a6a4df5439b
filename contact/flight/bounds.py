"""Stretches of a flight proved free of a crossing.

Three proofs.  A signal y(s) is known with its first two derivatives, and a bound M of its third.  A span h
is settled by one of

    max over [0, h] of (y + y' s + y'' s^2/2) + M h^3/6 + R < -margin        no crossing,
    y' > 0 throughout, and y changes sign                                    one root,
    y'' < 0 throughout, and y' changes sign                                  one peak.

R bounds the modes that are not sampled.

The lowest mode alone.  Relative to the stop the tip is at y = -G + A cos(w (t - t_p)) + phi u(t) + R(t), |R|
<= r, u the free deviation of the lowest mode.  With rho = |phi| sqrt(u^2 + (v/omega)^2) at the start, let

    d = (|w^2 - omega^2| + c omega) rho/w^2,    K = G - d - r - margin,    z = y - R + G - d.

Let P be the drive period, the span within 3 P/4 of t_p, |t_1 - t_p| <= P/4, rho + r + margin < G and |z_1| <
K.  By Sturm's comparison theorem the height z_1 and slope z_1' at t_1 then prove

    z_1' <= 0: no touch after t_1;      z_1' >= 0: none before;      z_1^2 + (z_1'/w)^2 < K^2: none at all.

The first also holds for any later t_1, the second for any earlier one.  Derivation:
``docs/theory/crossing.md``.
"""

import math
from typing import NamedTuple

from contact.flight.elementary import sine_cosine
from contact.flight.modal_flow import START_U, START_V, mode_flow
from contact.flight.numbers import DECAY, OMEGA, SQUARE, WEIGHT
from contact.machine.compiled import kernel, part

SKIP, ROOT, PEAK, NEAR, STALL = 0, 1, 2, 3, 4


@kernel
def certify(y0, y1, y2, m3, rest, margin, h, h_min):
    """The longest span of h, h/2, h/4, ... that one of the three proofs settles: (proof, span).

    While some modes are only bounded (`rest` > 0), a span with a root or a peak of the others is reported
    as NEAR: there all modes must be sampled.
    """
    while h > h_min:
        top = max(y0, y0 + h * (y1 + 0.5 * h * y2))
        if y2 < 0.0 and y1 > 0.0 and -y1 > y2 * h:
            top = max(top, y0 - 0.5 * y1 * y1 / y2)
        cubic = m3 * h * h * h / 6.0
        if top + cubic + rest < -margin:
            return SKIP, h
        if y1 > 0.0:
            slope_loss = 0.5 * m3 * h * h
            if y1 + min(0.0, y2 * h) - slope_loss > 0.0:
                if y0 + h * (y1 + 0.5 * h * y2) - cubic > margin:
                    return (ROOT if rest == 0.0 else NEAR), h
            elif y2 + m3 * h < 0.0 and y1 + y2 * h + slope_loss < 0.0:
                return (PEAK if rest == 0.0 else NEAR), h
        h *= 0.5
    return STALL, h


LEAST_SLACK = 1.0 / 16.0  # smallest K/G for the bound: the margin then covers the rounding of squares
HIGHEST = 1e6  # largest steady amplitude over G for which the time of its peak is exact enough

UNCERTAIN = 1e-11
"""Bound of the rounding of w t_p: the part of the amplitude by which cos(w (t - t_p)) may be above zero."""

TRIES = 4  # largest number of trials t_1; two suffice unless the lowest mode is far from its steady motion
CLOSE = 1e-4  # accepted distance of y - R from -r at a t_1 before the touch, over G


class LowestMode(NamedTuple):
    """The numbers of the comparison for one flight."""

    peak: float  # t_p [s]
    quarter: float  # a quarter of the drive period [s]
    mean: float  # G - d [m]: z is the tip displacement without the other modes plus this
    slack: float  # K [m]; zero if nothing can be proved
    near: float  # r with its margin [m]


@part
def peak_of_drive(numbers):
    """The time of the steady peak of the tip, from 0 to the drive period [s]; 0 without a drive."""
    if not numbers.drive > 0.0:
        return 0.0
    angle = math.atan2(numbers.tip_sine, numbers.tip_cosine)
    return (angle if angle >= 0.0 else angle + 2.0 * math.pi) / numbers.drive


@part
def lowest_mode(numbers, flight, base, span, peak, rest, margin):
    """The bounds for a `span` of times of a flight that starts a time `base` after a strobe [s].

    `flight` holds its start, `peak` is `peak_of_drive`, `rest` is r, infinite if a mode of zero frequency
    takes part [m], and `margin` the rounding bound of the tip displacement [m].
    """
    w, gap, omega, period = numbers.drive, -numbers.level, numbers.modes[OMEGA, 0], numbers.period
    u, v = flight[START_U, 0], flight[START_V, 0]
    near = rest * (1.0 + 1e-12) + 8.0 * margin
    nothing = LowestMode(0.0, 0.0, 0.0, 0.0, near)
    if not (w > 0.0 and omega > 0.0 and gap > near):
        return nothing
    rho = abs(numbers.modes[WEIGHT, 0]) * math.sqrt(u * u + v * v / (omega * omega))
    deviant = (abs(w - omega) * (w + omega) + numbers.modes[DECAY, 0] * omega) * rho / (w * w)
    slack = gap - deviant - near
    if not (slack > LEAST_SLACK * gap and rho + near + UNCERTAIN * numbers.amplitude < gap):
        return nothing
    quarter, start, end = 0.25 * period, base + span[0], base + span[1]
    reach = 3.0 * quarter * (1.0 + 1e-12)
    if max(peak - start, end - peak) > reach:  # the peak before or after may be closer
        peak += period if start > peak else -period
    if not (max(peak - start, end - peak) <= reach and numbers.amplitude <= HIGHEST * gap):
        return nothing
    return LowestMode(peak, quarter, gap - deviant, slack, near)


@part
def free_from(lowest, t, height, rate):
    """Whether no touch can come after the drive time `t`, given `height` and `rate` of the tip without the
    other modes at that time."""
    return rate <= 0.0 and abs(height + lowest.mean) < lowest.slack and t >= lowest.peak - lowest.quarter


@part
def without_others(numbers, flight, base, s):
    """Tip displacement relative to the stop without the modes above the lowest, and three derivatives."""
    w, c, o2 = numbers.drive, numbers.modes[DECAY, 0], numbers.modes[SQUARE, 0]
    sine, cosine = sine_cosine(w * (base + s), 0.0)
    steady = numbers.tip_sine * sine + numbers.tip_cosine * cosine
    steady_rate = w * (numbers.tip_sine * cosine - numbers.tip_cosine * sine)
    u, v = mode_flow(numbers.modes, 0, flight[START_U, 0], flight[START_V, 0], s)
    a = -c * v - o2 * u
    phi = numbers.modes[WEIGHT, 0]
    return (
        numbers.level + steady + phi * u,
        steady_rate + phi * v,
        phi * a - w * w * steady,
        -w * w * steady_rate - phi * (c * a + o2 * v),
    )


@part
def free_until(numbers, flight, lowest, base, span):
    """Time since the start of the flight up to which no touch can come in a `span` of it [s]; the end of the
    span if none can."""
    free, duration = span
    if not lowest.slack > 0.0:
        return free
    w, least, start, end = numbers.drive, lowest.slack, base + free, base + duration
    goal = 1.25 * lowest.near + 0.5 * CLOSE * abs(numbers.level)
    t = min(max(lowest.peak, start), end)
    for _ in range(TRIES):
        if t - lowest.peak > lowest.quarter:
            return duration if t == start else free
        height, rate, curvature, third = without_others(numbers, flight, base, t - base)
        z = height + lowest.mean
        if z * z + (rate / w) ** 2 < least * least and t >= lowest.peak - lowest.quarter:
            return duration
        if t == start and free_from(lowest, t, height, rate):
            return duration
        if rate >= 0.0 and abs(z) < least:
            free = t - base
            if t == end or -height < 2.0 * goal:
                return free
        # next t_1: where `height` rises through -goal, or its peak if it stays below
        under = rate * rate - 2.0 * curvature * (height + goal)
        if curvature >= 0.0:
            return free
        if under > 0.0:
            x = (math.sqrt(under) - rate) / curvature
            speed = rate + x * (curvature + 0.5 * x * third)
            if speed > 0.0:
                x -= (height + goal + x * (rate + x * (0.5 * curvature + x * third / 6.0))) / speed
        else:
            x = -rate / curvature
            x -= 0.5 * third * x * x / (curvature + third * x)
        if not abs(x) < lowest.quarter or t + x <= start:
            return free
        t = min(t + x, end)
    return free
