"""A drive period of one mode with one impact: straight through, no iteration.

In the notation of ``contact.one_mode.loop``, the period P starts from the deviation (u, v) at its strobe,
and F_t is the flow of a free deviation over t.

**Guess.**  At the peak of the steady motion y and four derivatives follow from (p, q) = F_tp (u, v).  The
lower zero of the parabola of the first three, improved by one step of Halley's iteration on the quartic,
gives a time t, usually within 1e-4/w of the crossing.

**Crossing.**  The motion at t, with its derivatives, follows from the next node t_k of ``period_table``.
With D = -y/y', B = y''/(2 y'), C = y'''/(6 y') the zero of their cubic lies at t + d,

    d = D - B D^2 + (2 B^2 - C) D^3 + ...

The error of this zero, of the cubic and of the order that it lacks, must not exceed one rounding of y:

    |y + y' d + y'' d^2/2 + y''' d^3/6| <= m/1000   and   |d| <= (24 m/(1000 Y))^(1/4),   |y''''| <= Y,

Y = A w^4 + omega (omega + c)^3 rho by repeated use of u'' = -c u' - omega^2 u.

**Impact.**  It adds j = -(1 + e) y' to u', so that the deviation at the end is

    F_P (u, v) + j F_(P - t - d) (0, 1),     F_(P - t - d) = F_(P - t_k) F_(t_k - t) F_(-d).

The series of F_(t - t_k) give F_(t_k - t) as well.  F_(-d) is its Taylor polynomial of third order, with an
error as small as that of the cubic.
"""

import math

from contact.machine.compiled import inlined
from contact.one_mode.period_table import SMALL, flow_to, short_flow, taylor_flow, through, tip_derivatives


@inlined
def peak_derivatives(n, s, p, q):
    """-y'', y''' and y'''' of the tip displacement at the steady peak, where the deviation is (p, q)."""
    free = n.decay * q + n.stiffness * p
    jerk = n.decay * free - n.stiffness * q
    snap = s.peak_acceleration * n.drive * n.drive + n.stiffness * free - n.decay * jerk
    return s.peak_acceleration + free, jerk, snap


@inlined
def crossing_guess(n, s, p, q):
    """Approximate time of the crossing since the strobe [s]; NaN if the parabola has no zero.

    (p, q): the deviation at the steady peak.
    """
    deceleration, jerk, snap = peak_derivatives(n, s, p, q)
    rate = math.sqrt(q * q + 2.0 * deceleration * (s.overshoot + p))
    x = (q - rate) / deceleration
    inverse = 1.0 / (rate + x * x * (0.5 * jerk + x * snap / 6.0))
    change = x * x * x * (jerk / 6.0 + x * snap / 24.0) * inverse
    x -= change * (1.0 + 0.5 * change * inverse * (x * (jerk + 0.5 * x * snap) - deceleration))
    return n.peak + x


@inlined
def zero_of(y0, y1, y2, y3, y4):
    """d [s], the value of the cubic there [m], and the velocity of the tip [m/s]."""
    inverse = -1.0 / y1
    d = y0 * inverse
    y2, y3 = 0.5 * y2, y3 / 6.0
    ratio = d * inverse
    d += d * (y2 * ratio + d * ratio * (2.0 * y2 * y2 * inverse + y3))
    rest = y0 + d * (y1 + d * (y2 + d * y3))
    return d, rest, y1 + d * (2.0 * y2 + d * (3.0 * y3 + d * y4 / 6.0))


@inlined
def is_proved(n, s, rho, u, v, slope, d, rest, approach):
    """Whether the crossing is proved, and the rest of the period from (u, v) after the impact on free."""
    return (
        (slope > 0.0)
        & (approach > 0.0)
        & (abs(d) <= s.longest_step)
        & (abs(rest) <= SMALL * s.margin)
        & (approach * approach > 4.0 * (s.peak_acceleration + n.free_bound * rho) * s.margin)
        & (u * u + n.mode_time_squared * v * v < s.largest_deviation * s.largest_deviation)
    )


@inlined
def one_impact(table, t, rho, u, v):
    """The period from (u, v), of size `rho`, whose crossing is next to the time `t` in [0, P].

    Returns whether it is proved, and the deviation at the next strobe, which is right only then.
    """
    n, rows = table.mode, table.rows
    k = int(t * n.nodes_per_second + 0.5)
    x = t - k * n.spacing
    u0, v0 = flow_to(rows, k, u, v)
    u0, v0, back_u, back_v = short_flow(n, x, u0, v0)
    y0, y1, y2, y3, y4 = tip_derivatives(table, k, x, u0, v0)
    d, rest, approach = zero_of(y0, y1, y2, y3, y4)
    u0, v0 = taylor_flow(n, u0, v0, d)
    back_u, back_v = taylor_flow(n, back_u, back_v, -d)
    jump = n.kick * approach
    proved = is_proved(n, table.steady, rho, u0, v0 + jump, y1, d, rest, approach)
    u, v = through(n.period_flow, u, v)
    back_u, back_v = flow_to(rows, rows.shape[0] - 1 - k, back_u, back_v)
    return proved, u + jump * back_u, v + jump * back_v
