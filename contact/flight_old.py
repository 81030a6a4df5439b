"""Motion between contacts, in closed form.

Each mode obeys q'' + c q' + omega^2 q = g + Gamma Z w^2 sin(w t) (mass-normalised, w = 2 pi f).  Write
q = q_s(t) + u with the steady motion

    q_s(t) = g/omega^2 + S sin(w t) + C cos(w t),   S + iC = Gamma Z w^2 / (omega^2 - w^2 + i c w)

(the g-term only for omega > 0).  The deviation u is free, u'' + c u' + omega^2 u = 0, and with D = omega^2 -
(c/2)^2

    u(t) = e^{-ct/2} [ Cn(t) u_0 + Sn(t) (v_0 + c u_0/2) ]
    v(t) = e^{-ct/2} [ Cn(t) v_0 - Sn(t) (omega^2 u_0 + c v_0/2) ]

where (Cn, Sn) is (cos, sin/d) of d t with d = sqrt(D) for an under-damped mode, (1, t) for a critical one and
(cosh, sinh/k) of k t with k = sqrt(-D) for an over-damped one.  A mode of zero frequency under a constant
load g adds g t^2 phi_2(-c t) to u, phi_2(x) = (e^x - 1 - x)/x^2.

Bounds: every derivative of a free mode obeys the same equation, and v^2 + omega^2 u^2 never grows, hence for
all later times, whatever the damping,

    |u^(n)|   <= sqrt( (u^(n))^2 + (u^(n+1)/omega)^2 ) now,
    |u^(n+1)| <= sqrt( (u^(n+1))^2 + omega^2 (u^(n))^2 ) now.

The phase d t is formed as an unevaluated sum of two doubles, so that its rounding error stays that of the
result even after 1e5 rad.  Sine and cosine of it come from one reduction by multiples of pi/2, whose leading
33 bits make the product exact (W. J. Cody and W. Waite, Software Manual for the Elementary Functions,
Prentice-Hall 1980), and their Taylor sums on |x| <= pi/4; the exponential likewise on |x| <= ln 2/2.  Each is
good to one unit in the last place, without a call of the system's library.  Units: SI with mass-normalised
modes (u in m kg^0.5).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel

__all__ = ["Motion", "flow_matrix", "propagate", "steady_motion", "tip_rounding"]

EPS = 2.220446049250313e-16
_SPLIT = 134217729.0  # 2^27 + 1, Veltkamp's splitting of a double into two halves


class Motion(NamedTuple):
    """The numbers of one impact oscillator, as kernels see them.

    Arrays have shape (n_modes,): omega [rad/s], decay = c [1/s], damped and damped_low = sqrt|D| as a sum of
    two doubles [rad/s], phi [kg^-0.5], load = g of the modes of zero frequency, sine and cosine = S and C,
    offset = g/omega^2.  Scalars: tip_sine, tip_cosine = sums of phi S and phi C [m]; level = static tip
    displacement minus gap [m]; drive = w [rad/s]; period [s]; gap [m]; compliance = sum phi^2 [1/kg]; law,
    its numbers and its table.
    """

    omega: np.ndarray
    decay: np.ndarray
    damped: np.ndarray
    damped_low: np.ndarray
    phi: np.ndarray
    load: np.ndarray
    sine: np.ndarray
    cosine: np.ndarray
    offset: np.ndarray
    tip_sine: float
    tip_cosine: float
    level: float
    drive: float
    period: float
    gap: float
    compliance: float
    law: int
    number0: float
    number1: float
    table: np.ndarray


@kernel
def two_product(a, b):
    """a*b and its rounding error, so that product + error is exact (Dekker)."""
    p = a * b
    t = _SPLIT * a
    ah = t - (t - a)
    al = a - ah
    t = _SPLIT * b
    bh = t - (t - b)
    bl = b - bh
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


@kernel
def damped_frequency(omega, decay):
    """sqrt(|omega^2 - (c/2)^2|) as a sum of two doubles [rad/s]."""
    half = 0.5 * decay
    p, ep = two_product(omega, omega)
    r, er = two_product(half, half)
    d = p - r
    back = d - p
    low = ((p - (d - back)) + (-r - back)) + (ep - er)  # with the rounding error of p - r (Knuth)
    lead = d + low
    back = lead - d
    low = (d - (lead - back)) + (low - back)
    d = lead
    high = math.sqrt(abs(d))
    if high == 0.0:
        return 0.0, 0.0
    s, es = two_product(high, high)
    if d < 0.0:
        d, low = -d, -low
    residual = (d - s) + (low - es)
    return high, residual / (2.0 * high)


_QUARTER, _QUARTER_LOW = 1.5707963267341256, 6.077100506506192e-11  # pi/2, its first 33 bits and the rest
_LN2, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # ln 2, its first 32 bits and the rest
_FARTHEST = 5e5  # phase up to which the number of quarter turns leaves the product with pi/2 exact [rad]
_LOWEST = -700.0  # exponent down to which powers of two are tabulated
_POWERS_OF_TWO = 2.0 ** np.arange(-1020.0, 1.0)
_S3, _S5, _S7, _S9, _S11, _S13, _S15, _S17 = (
    (-1.0) ** n / math.factorial(2 * n + 1) for n in range(1, 9)
)
_C4, _C6, _C8, _C10, _C12, _C14, _C16 = ((-1.0) ** n / math.factorial(2 * n) for n in range(2, 9))
_E2, _E3, _E4, _E5, _E6, _E7, _E8, _E9, _E10, _E11, _E12, _E13 = (
    1.0 / math.factorial(n) for n in range(2, 14)
)


@kernel
def sine_cosine(phase, rest):
    """sin and cos of `phase` + `rest`, |rest| far below one."""
    if not abs(phase) < _FARTHEST:
        s, c = math.sin(phase), math.cos(phase)
        return s + rest * c, c - rest * s
    n = np.floor(phase * (2.0 / math.pi) + 0.5)
    lead, part = phase - n * _QUARTER, n * _QUARTER_LOW
    near = lead - part
    low = ((lead - near) - part) + rest
    x = near + low
    low = (near - x) + low
    z = x * x
    z2 = z * z
    z4 = z2 * z2
    tail = (_S3 + z * _S5) + z2 * (_S7 + z * _S9) + z4 * ((_S11 + z * _S13) + z2 * (_S15 + z * _S17))
    s = x + (x * z * tail + low * (1.0 - 0.5 * z))
    half = 0.5 * z
    c = 1.0 - half
    tail = (_C4 + z * _C6) + z2 * (_C8 + z * _C10) + z4 * ((_C12 + z * _C14) + z2 * _C16)
    c += ((1.0 - c) - half) + (z2 * tail - x * low)
    turns = int(n) & 3
    if turns & 1:
        s, c = c, -s
    if turns & 2:
        s, c = -s, -c
    return s, c


@kernel
def fading(x):
    """exp(x) for x <= 0."""
    if not x > _LOWEST:
        return math.exp(x)
    n = np.floor(x * 1.4426950408889634 + 0.5)
    r = (x - n * _LN2) - n * _LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    tail = (_E2 + r * _E3) + r2 * (_E4 + r * _E5)
    high = (_E10 + r * _E11) + r2 * (_E12 + r * _E13)
    tail += r4 * (((_E6 + r * _E7) + r2 * (_E8 + r * _E9)) + r4 * high)
    return _POWERS_OF_TWO[int(n) + 1020] * (1.0 + (r + r2 * tail))


@kernel
def flow_matrix(omega, decay, damped, damped_low, t):
    """The 2 x 2 flow (u, v) -> (u, v) of a free mode over a time `t` [s], as four numbers."""
    half = 0.5 * decay
    if damped > 0.0 and omega > half:
        p, e = two_product(damped, t)
        e += damped_low * t
        s, c = sine_cosine(p, e)
        fade = fading(-half * t)
        cn = fade * c
        sn = fade * s / damped
    elif damped > 0.0:
        slow = omega * omega / (half + damped)
        fade = math.exp(-slow * t)
        lost = -math.expm1(-2.0 * damped * t)
        cn = fade * (1.0 - 0.5 * lost)
        sn = fade * lost / (2.0 * damped)
    else:
        cn = math.exp(-half * t)
        sn = cn * t
    return cn + half * sn, sn, -omega * omega * sn, cn - half * sn


@kernel
def loaded_drift(decay, load, t):
    """Displacement and velocity that a constant `load` adds to a mode of zero frequency in a time `t`."""
    x = -decay * t
    if x > -1.0:
        phi2 = 0.0
        for n in range(20, 1, -1):
            phi2 = (1.0 + x * phi2) / n
        phi1 = 1.0 + x * phi2
    else:
        phi1 = math.expm1(x) / x
        phi2 = (phi1 - 1.0) / x
    return load * t * t * phi2, load * t * phi1


@kernel
def mode_flow(omega, decay, damped, damped_low, load, u, v, t):
    """Deviation (u, v) of one mode after a time `t` [s]."""
    a, b, c, d = flow_matrix(omega, decay, damped, damped_low, t)
    un, vn = a * u + b * v, c * u + d * v
    if load != 0.0:
        du, dv = loaded_drift(decay, load, t)
        un += du
        vn += dv
    return un, vn


@kernel
def propagate(motion, u, v, t, u_out, v_out):
    """Deviations of all modes after a time `t` [s]; `u_out`, `v_out` may be `u`, `v` themselves."""
    # arrays taken out of the tuple once: inside the loop each access would count references
    omega, decay, damped, low, load = (
        motion.omega, motion.decay, motion.damped, motion.damped_low, motion.load
    )
    for k in range(omega.size):
        u_out[k], v_out[k] = mode_flow(omega[k], decay[k], damped[k], low[k], load[k], u[k], v[k], t)


@kernel
def mode_acceleration(motion, k, u, v):
    """Second derivative of the deviation of mode `k` when no contact acts."""
    return motion.load[k] - motion.decay[k] * v - motion.omega[k] * motion.omega[k] * u


@kernel
def tip_steady(motion, t):
    """Tip displacement relative to the stop, velocity and acceleration of the steady motion at drive time
    `t`."""
    w = motion.drive
    s, c = math.sin(w * t), math.cos(w * t)
    x = motion.tip_sine * s + motion.tip_cosine * c
    return motion.level + x, w * (motion.tip_sine * c - motion.tip_cosine * s), -w * w * x


@kernel
def tip_state(motion, t, u, v):
    """Tip displacement relative to the stop [m], its velocity and acceleration, at drive time `t`."""
    y0, y1, y2 = tip_steady(motion, t)
    for k in range(motion.omega.size):
        y0 += motion.phi[k] * u[k]
        y1 += motion.phi[k] * v[k]
        y2 += motion.phi[k] * mode_acceleration(motion, k, u[k], v[k])
    return y0, y1, y2


@kernel
def pull_rounding(motion, u, v):
    """Bound of the rounding error of the tip acceleration at (u, v) [m/s^2]."""
    total = (abs(motion.tip_sine) + abs(motion.tip_cosine)) * motion.drive**2
    for k in range(motion.omega.size):
        total += abs(motion.phi[k]) * (
            motion.omega[k] ** 2 * abs(u[k]) + motion.decay[k] * abs(v[k]) + abs(motion.load[k])
        )
    return 4.0 * EPS * total


@kernel
def tip_rounding(motion, u, v):
    """Bound of the rounding error of the tip displacement in a flight that starts at (u, v) [m]."""
    total = abs(motion.level) + abs(motion.tip_sine) + abs(motion.tip_cosine) + motion.gap
    for k in range(motion.omega.size):
        w = max(motion.omega[k], 0.5 * motion.decay[k])
        total += abs(motion.phi[k]) * (abs(u[k]) + (abs(v[k]) / w if w > 0.0 else abs(v[k]) * motion.period))
    return 4.0 * EPS * total


def steady_motion(motion: Motion, clock: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Steady modal displacement and velocity at times `clock` since a strobe, each (n_times, n_modes)."""
    phase = motion.drive * np.asarray(clock, dtype=float)[:, None]
    s, c = np.sin(phase), np.cos(phase)
    return (
        motion.offset + motion.sine * s + motion.cosine * c,
        motion.drive * (motion.sine * c - motion.cosine * s),
    )
