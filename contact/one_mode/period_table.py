"""One mode in a drive period: its motion anywhere in the period without sines, and its constants.

The period P is cut into K equal stretches by the nodes t_k = k P/K.  Kept are, for every node, the swing of
the steady tip motion, X_k = S sin(w t_k) + C cos(w t_k) and R_k = X'_k/w, and the flow F_k of the free
deviation over k stretches (``contact.flight``).  For a time t next to node k, x = t - t_k,

    steady motion = X_k cos(w x) + R_k sin(w x),      flow over t = F(x) F_k,

and with |x| <= P/(2K) the cosine, the sine and the flow F(x) follow from the series

    cos sqrt(z) = 1 - z/2! + z^2/4! - ...,   sin sqrt(z)/sqrt(z) = 1 - z/3! + z^2/5! - ...,   e^y = 1 + y ...

at z = (w x)^2, z = D x^2 (below zero for an over-damped mode) and y = -c x/2.  K is chosen such that w x,
omega x and c x stay below 0.05: the first terms left out, z^5/10! and y^9/9!, are then below 1e-17.

The peak of the steady motion lies at the time t_p of the period, at the height A = sqrt(S^2 + C^2).
Deviations are those of the tip, (u, v) [m, m/s], which obey the equation of the mode.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.flight.bounds import HIGHEST, LEAST_SLACK
from contact.flight.elementary import EPS
from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import DAMPED, DAMPED_LOW, DECAY, OMEGA, Motion
from contact.laws import NEWTON
from contact.machine.compiled import inlined, kernel

FEWEST, MOST = 64, 4096
"""Stretches of a period: 64 where the drive is fastest (w x <= pi/64), more for a faster mode; beyond 4096,
for a mode some sixty times faster than the drive, the table would outgrow the nearest cache."""

SAFETY = 32.0
"""Margin m over the rounding bound of the tip displacement (4 roundings of all its terms): room for the
roundings of the proofs themselves.  It is some 1e-13 of the gap; what lies within goes to the event loop."""

SMALL = 1e-3
"""Part of the margin m up to which a tip displacement is zero: one rounding of the gap."""


Flow = tuple[float, float, float, float]
"""A matrix by rows, by which a deviation (u, v) is multiplied."""


class OneMode(NamedTuple):
    """The constants of one driven mode before a stop, in the letters of ``contact.one_mode.loop``.

    drive = w, decay = c [1/s]; stiffness = omega^2, determinant = D [1/s^2]; gap = G, distance of the stop
    from the tip's mean place, above = A - G [m]; crest = A w^2 [m/s^2]; period = P, stretch = P/K,
    per_second = K/P, peak = t_p [s]; period_flow = F_P; peak_flow = F_tp; kick = j/y' = -(1 + e), j the jump
    of v in an impact at tip velocity y'; detuning = d/rho; inverse = 1/omega^2, slow = 1/w^2 [s^2]; most =
    rho below which (*) is used, not above zero if never [m]; second: |y''| <= crest + second rho; margin = m
    [m]; reach = greatest |d| of a step to a zero [s]; factor: of the amplitude over that of the rows.
    """

    drive: float
    decay: float
    stiffness: float
    determinant: float
    gap: float
    above: float
    crest: float
    period: float
    stretch: float
    per_second: float
    peak: float
    period_flow: Flow
    peak_flow: Flow
    kick: float
    detuning: float
    inverse: float
    most: float
    slow: float
    second: float
    margin: float
    reach: float
    factor: float


class PeriodTable(NamedTuple):
    """A drive period of one mode: its constants, and X_k, R_k [m] and the four numbers of F_k of all nodes,
    shape (K + 1, 6)."""

    mode: OneMode
    rows: np.ndarray


@kernel
def mode_flow(motion, t):
    """The flow of the deviation over a time `t` [s]."""
    modes = motion.modes
    return flow_matrix(modes[OMEGA, 0], modes[DECAY, 0], modes[DAMPED, 0], modes[DAMPED_LOW, 0], t)


@kernel
def constants_of(motion, stretches):
    """The `OneMode` of a motion whose period is cut into `stretches`."""
    modes, w = motion.modes, motion.drive
    peak = min((math.atan2(motion.tip_sine, motion.tip_cosine) % (2.0 * math.pi)) / w, motion.period)
    decay, omega, high = modes[DECAY, 0], modes[OMEGA, 0], modes[DAMPED, 0]
    at_rest = OneMode(
        drive=w,
        decay=decay,
        stiffness=omega * omega,
        determinant=math.copysign(high * (high + 2.0 * modes[DAMPED_LOW, 0]), omega - 0.5 * decay),
        gap=-motion.level,
        above=0.0,
        crest=0.0,
        period=motion.period,
        stretch=motion.period / stretches,
        per_second=stretches / motion.period,
        peak=peak,
        period_flow=mode_flow(motion, motion.period),
        peak_flow=mode_flow(motion, peak),
        kick=-(1.0 + motion.number0),
        detuning=(abs(w * w - omega * omega) + decay * omega) / (w * w),
        inverse=1.0 / (omega * omega),
        most=0.0,
        slow=1.0 / (w * w),
        second=omega * (omega + decay),
        margin=0.0,
        reach=0.0,
        factor=1.0,
    )
    return mode_at(at_rest, motion, 1.0)


@inlined
def mode_at(mode, motion, factor):
    """The constants of `motion`, `mode`, at `factor` times its drive amplitude.

    The steady motion alone depends on the amplitude, and in proportion: the rows are shared.
    """
    m, w, amplitude = mode, mode.drive, factor * motion.amplitude
    omega = motion.modes[OMEGA, 0]
    steady = abs(motion.level) + factor * (abs(motion.tip_sine) + abs(motion.tip_cosine)) + motion.gap
    margin = SAFETY * 4.0 * EPS * (steady + 2.0 * max(1.0, 0.5 * m.decay / omega) * abs(m.gap))
    rho = (1.0 - LEAST_SLACK) * m.gap / max(1.0, m.detuning)
    # (*) needs the peak in the middle half of the period
    inner = abs(m.peak / m.period - 0.5) <= 0.25 + 1e-12 and amplitude <= HIGHEST * abs(m.gap)
    fourth = amplitude * w**4 + omega * (omega + m.decay) ** 3 * abs(rho)
    return OneMode(
        w,
        m.decay,
        m.stiffness,
        m.determinant,
        m.gap,
        amplitude + motion.level,
        amplitude * w * w,
        m.period,
        m.stretch,
        m.per_second,
        m.peak,
        m.period_flow,
        m.peak_flow,
        m.kick,
        m.detuning,
        m.inverse,
        rho if inner else -1.0,
        m.slow,
        m.second,
        margin,
        math.sqrt(math.sqrt(24.0 * SMALL * margin / fourth)),
        factor * m.factor,
    )


@kernel
def full_table(motion, stretches):
    """The table of a motion of one mode with `stretches` stretches."""
    w, period = motion.drive, motion.period
    rows = np.empty((stretches + 1, 6))
    for k in range(stretches + 1):
        t = k * (period / stretches)
        s, c = math.sin(w * t), math.cos(w * t)
        rows[k, 0] = motion.tip_sine * s + motion.tip_cosine * c
        rows[k, 1] = motion.tip_sine * c - motion.tip_cosine * s
        rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5] = mode_flow(motion, t)
    return PeriodTable(constants_of(motion, stretches), rows)


def period_table(motion: Motion) -> PeriodTable | None:
    """The table of a driven oscillator of one mode under Newton's law.

    None for any other: one with another law or several modes, no stiffness or no drive, its node at the tip,
    or so fast that too many nodes would be needed.
    """
    if motion.law != NEWTON or motion.size != 1 or motion.inverse_mass == 0.0:
        return None
    if not (motion.omega[0] > 0 and motion.drive > 0):
        return None
    ratio = max(motion.drive, float(motion.omega[0]), float(motion.decay[0])) / motion.drive
    if not ratio * FEWEST <= MOST:
        return None
    table: PeriodTable = full_table(motion, FEWEST * 2 ** math.ceil(math.log2(ratio)))
    return table


@inlined
def through(flow, u, v):
    """The deviation (u, v) after a flow."""
    return flow[0] * u + flow[1] * v, flow[2] * u + flow[3] * v


@inlined
def flow_to(rows, k, u, v):
    """The deviation (u, v) of a node after `k` stretches."""
    return rows[k, 2] * u + rows[k, 3] * v, rows[k, 4] * u + rows[k, 5] * v


@inlined
def short_turn(z):
    """cos sqrt(z) and sin sqrt(z)/sqrt(z) for |z| up to 0.0025."""
    even = 1.0 + z * (-1.0 / 2.0 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0))))
    return even, odd


@inlined
def short_fades(y):
    """cosh y and sinh y for |y| up to 0.05: e^y is their sum, e^-y their difference."""
    z = y * y
    even = 1.0 + z * (1.0 / 2.0 + z * (1.0 / 24.0 + z * (1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (1.0 / 6.0 + z * (1.0 / 120.0 + z * (1.0 / 5040.0)))
    return even, y * odd


@inlined
def short_flow(mode, x, u, v):
    """Deviation (u, v) after a time |x| <= P/(2K) [s], and what is (0, 1) after it was at its beginning."""
    half = 0.5 * mode.decay
    even, odd = short_turn(mode.determinant * x * x)
    fade, less = short_fades(-half * x)
    odd *= x
    cn, sn = (fade + less) * even, (fade + less) * odd
    back = -(fade - less) * odd
    return (
        cn * u + sn * (v + half * u),
        cn * v - sn * (mode.stiffness * u + half * v),
        back,
        (fade - less) * even - half * back,
    )


@inlined
def flow_over(mode, rows, t, u, v):
    """Deviation (u, v) after a time `t` of at most a period [s]."""
    k = int(t * mode.per_second + 0.5)
    u, v, _back_u, _back_v = short_flow(mode, t - k * mode.stretch, u, v)
    return flow_to(rows, k, u, v)


@inlined
def steady_near(mode, rows, k, x):
    """The steady motion X, R a time `x` after node `k`."""
    even, odd = short_turn(mode.drive * mode.drive * x * x)
    odd *= mode.drive * x
    swing, glide = mode.factor * rows[k, 0], mode.factor * rows[k, 1]
    return swing * even + glide * odd, glide * even - swing * odd


@inlined
def tip_near(mode, rows, u, v, t):
    """The motion at the time `t` since the strobe, where the deviation was (u, v).

    Returns
    -------
    Deviation and its rate; tip displacement relative to the stop [m] and two derivatives.
    """
    w = mode.drive
    k = int(t * mode.per_second + 0.5)
    x = t - k * mode.stretch
    un, vn = flow_to(rows, k, u, v)
    un, vn, _back_u, _back_v = short_flow(mode, x, un, vn)
    swing, glide = steady_near(mode, rows, k, x)
    return (
        un,
        vn,
        swing - mode.gap + un,
        w * glide + vn,
        -w * w * swing - (mode.decay * vn + mode.stiffness * un),
    )
