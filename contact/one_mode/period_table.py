"""One mode in a drive period: its motion anywhere in the period without sines, and its constants.

The period P is cut into K equal parts by the nodes t_k = k P/K.  The table keeps for every node the steady
tip displacement X_k = S sin(w t_k) + C cos(w t_k), its quadrature R_k = X'_k/w, and the flow F_k of the free
deviation over k parts (``contact.flight``).  For a time t next to node k, x = t - t_k,

    steady motion = X_k cos(w x) + R_k sin(w x),      flow over t = F(x) F_k,

and with |x| <= P/(2K) the cosine, the sine and the flow F(x) follow from the series

    cos sqrt(z) = 1 - z/2! + z^2/4! - ...,   sin sqrt(z)/sqrt(z) = 1 - z/3! + z^2/5! - ...,   e^y = 1 + y ...

at z = (w x)^2, z = D x^2 (below zero for an over-damped mode) and y = -c x/2.  K is chosen such that w x,
omega x and c x stay below 0.05: the first terms left out, z^5/10! and y^9/9!, are then below 1e-17.

The steady motion peaks at the time t_p of the period, at the height A = sqrt(S^2 + C^2).  The deviation
(u, v) [m, m/s] of the tip obeys the equation of the mode.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.flight.bounds import HIGHEST, LEAST_SLACK
from contact.flight.elementary import EPS
from contact.flight.modal_flow import flow_matrix
from contact.flight.numbers import DAMPED, DAMPED_LOW, DECAY, OMEGA, Numbers
from contact.laws import NEWTON
from contact.machine.compiled import inlined, kernel

FEWEST, MOST = 64, 4096
"""Parts of a period: 64 where the drive is fastest (w x <= pi/64), more for a faster mode.  Beyond 4096, for
a mode some sixty times faster than the drive, the table would outgrow the nearest cache."""

SAFETY = 32.0
"""Factor of the margin m over the rounding bound of the tip displacement (4 roundings of all its terms).  It
covers the roundings of the proofs.  m is some 1e-13 of the gap; closer cases go to the event loop."""

SMALL = 1e-3  # part of the margin m up to which a tip displacement is zero: one rounding of the gap
Flow = tuple[float, float, float, float]  # a matrix by rows, by which a deviation (u, v) is multiplied


class OneMode(NamedTuple):
    """The constants of one driven mode before a stop, in the letters of ``contact.one_mode.loop``.

    drive = w, decay = c [1/s]; stiffness = omega^2, determinant = D [1/s^2]; gap = G, distance of the stop
    from the tip's mean place [m]; period = P, spacing = P/K, nodes_per_second = K/P, peak = t_p [s];
    period_flow = F_P; peak_flow = F_tp; kick = j/y' = -(1 + e), j the jump of v in an impact at tip velocity
    y'; detuning = d/rho; free_bound = |u''|/rho at most; mode_time_squared = 1/omega^2, drive_time_squared =
    1/w^2 [s^2].
    """

    drive: float
    decay: float
    stiffness: float
    determinant: float
    gap: float
    period: float
    spacing: float
    nodes_per_second: float
    peak: float
    period_flow: Flow
    peak_flow: Flow
    kick: float
    detuning: float
    free_bound: float
    mode_time_squared: float
    drive_time_squared: float


class Steady(NamedTuple):
    """The constants that depend on the amplitude of the drive.

    overshoot = A - G [m]; peak_acceleration = A w^2 [m/s^2]; largest_deviation = rho below which (*) is used,
    not above zero if never [m]; margin = m [m]; longest_step = greatest |d| of a step to a zero [s]; factor:
    of the amplitude over that of the rows.
    """

    overshoot: float
    peak_acceleration: float
    largest_deviation: float
    margin: float
    longest_step: float
    factor: float


class PeriodTable(NamedTuple):
    """A drive period of one mode: its constants, and X_k, R_k [m], F_k at each node, shape (K + 1, 6)."""

    mode: OneMode
    steady: Steady
    rows: np.ndarray


@inlined
def table_at(table, numbers, factor):
    """The `table` of `numbers` at `factor` times its amplitude, to which X_k and R_k are in proportion.

    None, the table of any other oscillator, stays None.
    """
    if table is None:
        return table
    mode, amplitude, omega = table.mode, factor * numbers.amplitude, numbers.modes[OMEGA, 0]
    steady = abs(numbers.level) + factor * (abs(numbers.tip_sine) + abs(numbers.tip_cosine)) + numbers.gap
    margin = SAFETY * 4.0 * EPS * (steady + 2.0 * max(1.0, 0.5 * mode.decay / omega) * abs(mode.gap))
    rho = (1.0 - LEAST_SLACK) * mode.gap / max(1.0, mode.detuning)
    # (*) needs the peak in the middle half of the period
    inner = abs(mode.peak / mode.period - 0.5) <= 0.25 + 1e-12 and amplitude <= HIGHEST * abs(mode.gap)
    fourth = amplitude * mode.drive**4 + omega * (omega + mode.decay) ** 3 * abs(rho)
    here = Steady(
        overshoot=amplitude + numbers.level,
        peak_acceleration=amplitude * mode.drive * mode.drive,
        largest_deviation=rho if inner else -1.0,
        margin=margin,
        longest_step=math.sqrt(math.sqrt(24.0 * SMALL * margin / fourth)),
        factor=factor * table.steady.factor,
    )
    return PeriodTable(mode, here, table.rows)


@kernel
def full_table(numbers, parts):
    """The table of a motion of one mode with its period in `parts` parts."""
    modes, w, period = numbers.modes, numbers.drive, numbers.period
    decay, omega, high, low = modes[DECAY, 0], modes[OMEGA, 0], modes[DAMPED, 0], modes[DAMPED_LOW, 0]
    peak = min((math.atan2(numbers.tip_sine, numbers.tip_cosine) % (2.0 * math.pi)) / w, period)
    mode = OneMode(
        drive=w,
        decay=decay,
        stiffness=omega * omega,
        determinant=math.copysign(high * (high + 2.0 * low), omega - 0.5 * decay),
        gap=-numbers.level,
        period=period,
        spacing=period / parts,
        nodes_per_second=parts / period,
        peak=peak,
        period_flow=flow_matrix(omega, decay, high, low, period),
        peak_flow=flow_matrix(omega, decay, high, low, peak),
        kick=-(1.0 + numbers.number0),
        detuning=(abs(w * w - omega * omega) + decay * omega) / (w * w),
        free_bound=omega * (omega + decay),
        mode_time_squared=1.0 / (omega * omega),
        drive_time_squared=1.0 / (w * w),
    )
    rows = np.empty((parts + 1, 6))
    for k in range(parts + 1):
        t = k * (period / parts)
        s, c = math.sin(w * t), math.cos(w * t)
        rows[k, 0] = numbers.tip_sine * s + numbers.tip_cosine * c
        rows[k, 1] = numbers.tip_sine * c - numbers.tip_cosine * s
        rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5] = flow_matrix(omega, decay, high, low, t)
    return table_at(PeriodTable(mode, Steady(0.0, 0.0, 0.0, 0.0, 0.0, 1.0), rows), numbers, 1.0)


def period_table(numbers: Numbers) -> PeriodTable | None:
    """The table of a driven oscillator of one mode under Newton's law with a constant restitution.

    Returns None for another law or several modes, without stiffness or drive, for a mode with its node at the
    tip, and for one so fast that too many nodes would be needed.
    """
    constant = numbers.law == NEWTON and numbers.table.size == 0
    suits = constant and numbers.size == 1 and numbers.inverse_mass != 0.0
    if not (suits and numbers.omega[0] > 0 and numbers.drive > 0):
        return None
    ratio = max(numbers.drive, float(numbers.omega[0]), float(numbers.decay[0])) / numbers.drive
    if not ratio * FEWEST <= MOST:
        return None
    table: PeriodTable = full_table(numbers, FEWEST * 2 ** math.ceil(math.log2(ratio)))
    return table


@inlined
def through(flow, u, v):
    """The deviation (u, v) after a flow."""
    return flow[0] * u + flow[1] * v, flow[2] * u + flow[3] * v


@inlined
def flow_to(rows, k, u, v):
    """The deviation (u, v) of a node after `k` parts of the period."""
    return rows[k, 2] * u + rows[k, 3] * v, rows[k, 4] * u + rows[k, 5] * v


@inlined
def short_circular(z):
    """cos sqrt(z) and sin sqrt(z)/sqrt(z) for |z| up to 0.0025."""
    even = 1.0 + z * (-1.0 / 2.0 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0))))
    return even, odd


@inlined
def short_hyperbolic(y):
    """cosh y and sinh y for |y| up to 0.05: e^y is their sum, e^-y their difference."""
    z = y * y
    even = 1.0 + z * (1.0 / 2.0 + z * (1.0 / 24.0 + z * (1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (1.0 / 6.0 + z * (1.0 / 120.0 + z * (1.0 / 5040.0)))
    return even, y * odd


@inlined
def short_flow(mode, x, u, v):
    """Deviation (u, v) after a time |x| <= P/(2K) [s], and the deviation that a time x later is (0, 1)."""
    half = 0.5 * mode.decay
    cosine, sine = short_circular(mode.determinant * x * x)
    cosh, sinh = short_hyperbolic(-half * x)
    sine *= x
    cn, sn = (cosh + sinh) * cosine, (cosh + sinh) * sine
    back = -(cosh - sinh) * sine
    return (
        cn * u + sn * (v + half * u),
        cn * v - sn * (mode.stiffness * u + half * v),
        back,
        (cosh - sinh) * cosine - half * back,
    )


@inlined
def flow_over(mode, rows, t, u, v):
    """Deviation (u, v) after a time `t` of at most a period [s]."""
    k = int(t * mode.nodes_per_second + 0.5)
    u, v, _back_u, _back_v = short_flow(mode, t - k * mode.spacing, u, v)
    return flow_to(rows, k, u, v)


@inlined
def free_derivatives(mode, u, v):
    """u'', u''' and u'''' of a free deviation."""
    u2 = -(mode.decay * v + mode.stiffness * u)
    u3 = -(mode.decay * u2 + mode.stiffness * v)
    return u2, u3, -(mode.decay * u3 + mode.stiffness * u2)


@inlined
def taylor_flow(mode, u, v, x):
    """The deviation (u, v) a tiny time `x` later, by its Taylor polynomial of third order."""
    u2, u3, u4 = free_derivatives(mode, u, v)
    return u + x * (v + x * (0.5 * u2 + x * u3 / 6.0)), v + x * (u2 + x * (0.5 * u3 + x * u4 / 6.0))


@inlined
def tip_derivatives(table, k, x, u, v):
    """Tip displacement relative to the stop [m] and its first four derivatives, a time `x` after node `k`.

    (u, v): the deviation then.
    """
    mode, w = table.mode, table.mode.drive
    cosine, sine = short_circular(w * w * x * x)
    sine *= w * x
    here, ahead = table.steady.factor * table.rows[k, 0], table.steady.factor * table.rows[k, 1]
    in_phase, quadrature = here * cosine + ahead * sine, ahead * cosine - here * sine
    u2, u3, u4 = free_derivatives(mode, u, v)
    pull = w * w * in_phase
    return (
        in_phase - mode.gap + u,
        w * quadrature + v,
        u2 - pull,
        u3 - w * w * w * quadrature,
        u4 + w * w * pull,
    )


@inlined
def tip_near(table, u, v, t):
    """The motion at the time `t` since the strobe, where the deviation was (u, v).

    Returns deviation and rate, and the tip displacement relative to the stop [m] with two derivatives.
    """
    k = int(t * table.mode.nodes_per_second + 0.5)
    x = t - k * table.mode.spacing
    un, vn = flow_to(table.rows, k, u, v)
    un, vn, _back_u, _back_v = short_flow(table.mode, x, un, vn)
    y0, y1, y2, _y3, _y4 = tip_derivatives(table, k, x, un, vn)
    return un, vn, y0, y1, y2
