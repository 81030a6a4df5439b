"""Pieces of a drive period of one mode with one impact: straight through, no iteration, no branch.

In the notation of ``contact.integrators.single_mode_loop``, the period P starts from the deviation (u, v) at
its strobe, and F_t is the flow of a free deviation over t.

**Where the crossing is.**  At the peak of the steady motion the motion and its first four derivatives follow
from (p, q) = phi F_tp (u, v).  The lower zero of the parabola of the first three, improved by one step of
Halley's iteration on the quartic, gives a time t, usually within 1e-4/w of the crossing.

**The crossing.**  At t the motion is found anew, from the next node t_k of ``strobe_nodes``, with its
derivatives.  With D = -y/y', B = y''/(2 y'), C = y'''/(6 y') the zero of their cubic lies at t + d,

    d = D - B D^2 + (2 B^2 - C) D^3 + ...

What remains there, of the cubic and of the order that it lacks, has to be as small as one rounding of y:

    |y + y' d + y'' d^2/2 + y''' d^3/6| <= m/1000   and   |d| <= (24 m/(1000 Y))^(1/4),   |y''''| <= Y,

Y = A w^4 + omega (omega + c)^3 rho by repeated use of u'' = -c u' - omega^2 u.

**What the impact does.**  It adds j = -(1 + e) y'/phi to u', so that the deviation at the end is

    F_P (u, v) + j F_(P - t - d) (0, 1),     F_(P - t - d) = F_(P - t_k) F_(t_k - t) F_(-d).

The series of F_(t - t_k) give F_(t_k - t) as well; d is bridged by the Taylor polynomial of third order, the
rest of which is as small as that of the cubic.

Each piece is small enough to be compiled into the loop that uses it, and has no branch, so that a loop over
orbits is turned into vector instructions.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.flight import EPS
from contact.integrators.node_search import SAFETY
from contact.integrators.strobe_nodes import short_fades, short_turn
from contact.newton import newton_impact

__all__ = [
    "LoopNumbers",
    "carried",
    "free_near",
    "guessed",
    "is_settled",
    "loop_numbers",
    "steady_near",
    "tip_derivatives",
    "zero_of",
]

LEAST_ROOM = 1.0 / 16.0
"""G - d and G - rho over G below which (*) is not used, so that squares are rounded by less than m allows."""

SMALL = 1e-3
"""Part of the margin m up to which a tip displacement is zero: one rounding of the gap."""


class LoopNumbers(NamedTuple):
    """What the loop of one mode needs of its oscillator, plain numbers all.

    drive = w, decay = c, stiffness = omega^2, phi, determinant = D as in ``strobe_nodes.SingleMode``; level
    [m]; period = P, stretch of the nodes [s], per_second [1/s]; peak = t_p [s]; f0 ... f3 = F_P; g0 ... g3 =
    phi F_tp; gap = G, above = A - G, margin = m [m]; crest = A w^2 [m/s^2]; detuning = d/rho; square_u,
    square_v: rho^2 = square_u u^2 + square_v v^2; most = rho^2 below which (*) is used [m^2]; slow = 1/w^2;
    second: |y''| <= crest + second rho; kick = j/y'; reach = greatest |d| [s].
    """

    drive: float
    decay: float
    stiffness: float
    phi: float
    determinant: float
    level: float
    period: float
    stretch: float
    per_second: float
    peak: float
    f0: float
    f1: float
    f2: float
    f3: float
    g0: float
    g1: float
    g2: float
    g3: float
    gap: float
    above: float
    margin: float
    crest: float
    detuning: float
    square_u: float
    square_v: float
    most: float
    slow: float
    second: float
    kick: float
    reach: float


@kernel
def loop_numbers(motion, nodes):
    """The numbers of an oscillator with its nodes."""
    mode, last = nodes.mode, nodes.rows.shape[0] - 1
    w, decay, stiffness, phi, omega = mode.drive, mode.decay, mode.stiffness, mode.phi, motion.omega[0]
    gap, amplitude = -motion.level, nodes.amplitude
    steady = abs(motion.level) + abs(motion.tip_sine) + abs(motion.tip_cosine) + motion.gap
    margin = SAFETY * 4.0 * EPS * (steady + 2.0 * max(1.0, 0.5 * decay / omega) * abs(gap))
    detuning = (abs(w * w - stiffness) + decay * omega) / (w * w)
    rho = (1.0 - LEAST_ROOM) * gap / max(1.0, detuning)
    square = rho * rho if nodes.inner and rho > 0.0 else -1.0
    fourth = amplitude * w**4 + omega * (omega + decay) ** 3 * abs(rho)
    jump = np.zeros(1)
    newton_impact(motion, jump, 1.0, motion.number0)
    return LoopNumbers(
        drive=w,
        decay=decay,
        stiffness=stiffness,
        phi=phi,
        determinant=mode.determinant,
        level=mode.level,
        period=motion.period,
        stretch=mode.stretch,
        per_second=mode.per_second,
        peak=nodes.peak,
        f0=nodes.rows[last, 2],
        f1=nodes.rows[last, 3],
        f2=nodes.rows[last, 4],
        f3=nodes.rows[last, 5],
        g0=nodes.to_peak[0],
        g1=nodes.to_peak[1],
        g2=nodes.to_peak[2],
        g3=nodes.to_peak[3],
        gap=gap,
        above=amplitude + motion.level,
        margin=margin,
        crest=amplitude * w * w,
        detuning=detuning,
        square_u=phi * phi,
        square_v=phi * phi / stiffness,
        most=square,
        slow=1.0 / (w * w),
        second=omega * (omega + decay),
        kick=jump[0],
        reach=math.sqrt(math.sqrt(24.0 * SMALL * margin / fourth)),
    )


@kernel
def guessed(n, p, q, height):
    """About when the tip meets the stop, since the strobe [s]; NaN if the parabola does not.

    p, q and `height`: free part, slope and tip displacement relative to the stop at the steady peak.
    """
    drop = n.decay * q + n.stiffness * p
    dip = n.crest + drop
    twist = n.decay * drop - n.stiffness * q
    bend = n.crest * n.drive * n.drive + n.stiffness * drop - n.decay * twist
    rate = math.sqrt(q * q + 2.0 * dip * height)
    x = (q - rate) / dip
    inverse = 1.0 / (rate + x * x * (0.5 * twist + x * bend / 6.0))
    change = x * x * x * (twist / 6.0 + x * bend / 24.0) * inverse
    x -= change * (1.0 + 0.5 * change * inverse * (x * (twist + 0.5 * x * bend) - dip))
    return n.peak + x


@kernel
def free_near(n, x, u, v):
    """The deviation (u, v) of a node a time `x` after it, and what (0, 1) was at the node."""
    half = 0.5 * n.decay
    even, odd = short_turn(n.determinant * x * x)
    fade, less = short_fades(-half * x)
    odd *= x
    cn, sn = (fade + less) * even, (fade + less) * odd
    back = -(fade - less) * odd
    return (
        cn * u + sn * (v + half * u), cn * v - sn * (n.stiffness * u + half * v),
        back, (fade - less) * even - half * back,
    )  # fmt: skip


@kernel
def carried(n, u, v, x):
    """The deviation (u, v) a tiny time `x` later, by its Taylor polynomial of third order."""
    u2 = -(n.decay * v + n.stiffness * u)
    u3 = -(n.decay * u2 + n.stiffness * v)
    u4 = -(n.decay * u3 + n.stiffness * u2)
    return u + x * (v + x * (0.5 * u2 + x * u3 / 6.0)), v + x * (u2 + x * (0.5 * u3 + x * u4 / 6.0))


@kernel
def steady_near(n, x, swing, glide):
    """The steady motion of a node and its rate over w, a time `x` later."""
    even, odd = short_turn(n.drive * n.drive * x * x)
    odd *= n.drive * x
    return swing * even + glide * odd, glide * even - swing * odd


@kernel
def tip_derivatives(n, u, v, swing, glide):
    """Tip displacement relative to the stop [m] and its first four derivatives."""
    w = n.drive
    u2 = -(n.decay * v + n.stiffness * u)
    u3 = -(n.decay * u2 + n.stiffness * v)
    u4 = -(n.decay * u3 + n.stiffness * u2)
    pull = w * w * swing
    return (
        n.level + swing + n.phi * u, w * glide + n.phi * v, n.phi * u2 - pull,
        n.phi * u3 - w * w * w * glide, n.phi * u4 + w * w * pull,
    )  # fmt: skip


@kernel
def zero_of(y0, y1, y2, y3, y4):
    """d [s], what the cubic is there [m], and the velocity of the tip [m/s]."""
    inverse = -1.0 / y1
    d = y0 * inverse
    y2, y3 = 0.5 * y2, y3 / 6.0
    ratio = d * inverse
    d += d * (y2 * ratio + d * ratio * (2.0 * y2 * y2 * inverse + y3))
    rest = y0 + d * (y1 + d * (y2 + d * y3))
    return d, rest, y1 + d * (2.0 * y2 + d * (3.0 * y3 + d * y4 / 6.0))


@kernel
def is_settled(n, rho, u, v, slope, d, rest, approach):
    """Whether the crossing is proved, and the rest of the period from (u, v) after the impact on free."""
    return (
        (slope > 0.0) & (approach > 0.0) & (abs(d) <= n.reach) & (abs(rest) <= SMALL * n.margin)
        & (approach * approach > 4.0 * (n.crest + n.second * rho) * n.margin)
        & (n.square_u * u * u + n.square_v * v * v < n.most)
    )  # fmt: skip
