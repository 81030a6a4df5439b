"""All modes of a flight at once, eight side by side.

The closed form of ``contact.flight`` for under-damped modes without load, written without a branch, so that
the processor carries several modes in one instruction:

    u(t) = e^{-ct/2} [ cos(dt) u_0 + sin(dt)/d (v_0 + c u_0/2) ]
    v(t) = e^{-ct/2} [ cos(dt) v_0 - sin(dt)/d (omega^2 u_0 + c v_0/2) ],      d = sqrt(omega^2 - (c/2)^2),

the phase d t a sum of two doubles, sine, cosine and exponential by the sums of ``contact.flight``.  Other
modes, and phases beyond the reach of those sums, go one by one.  Rows are filled up to a multiple of eight
with modes that stay zero.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.flight import (
    _C4,
    _C6,
    _C8,
    _C10,
    _C12,
    _C14,
    _C16,
    _E2,
    _E3,
    _E4,
    _E5,
    _E6,
    _E7,
    _E8,
    _E9,
    _E10,
    _E11,
    _E12,
    _E13,
    _FARTHEST,
    _LN2,
    _LN2_LOW,
    _LOWEST,
    _POWERS_OF_TWO,
    _QUARTER,
    _QUARTER_LOW,
    _S3,
    _S5,
    _S7,
    _S9,
    _S11,
    _S13,
    _S15,
    _S17,
    _SPLIT,
    EPS,
    mode_flow,
    sine_cosine,
)
from contact.lanes import LANES, aligned

__all__ = [
    "Scalars",
    "carry",
    "flow_rows",
    "load_state",
    "mode_rows",
    "rounding_of",
    "scalars_of",
    "swing_at",
    "tip_rows",
]

DECAY, SQUARE, WEIGHT, LOAD, DAMPED, LOW, SLOWNESS, SHORTNESS, OMEGA = 0, 1, 2, 3, 4, 5, 6, 7, 8
"""Rows of numbers: c, omega^2, phi, g, d as a sum of two, 1/omega (or zero), 1/max(omega, c/2) (or the
period), omega.  The first four are those that ``contact.lanes`` counts on."""

START_U, START_V, U, V, HEIGHT, RATE, BEND, THIRD = 0, 1, 2, 3, 4, 5, 6, 7
"""Rows of the work space: deviation and velocity at the start of the flight, and now; what they add to the
tip displacement and two derivatives, and to the bound of the third."""


class Scalars(NamedTuple):
    """The numbers of an oscillator that belong to no single mode.

    A kernel that is called often takes these and two arrays, not the oscillator's ``Motion``: to hand on a
    tuple with a dozen arrays takes several times as long as to carry eight modes.

    level [m], sine, cosine [m], drive [rad/s], period [s], gap [m], compliance [1/kg] : float
        Of ``contact.flight.Motion``.
    amplitude : float
        sqrt(sine^2 + cosine^2) [m].
    still : float
        Sum of (w S)^2 + (w C)^2, twice the modal energy scale of the steady motion [J].
    stiffness, damping : float
        The first two numbers of the law.
    plain : bool
        Whether all modes are under-damped and without load.
    phase_rate, fastest : float
        Largest d, and largest of w, omega and c [rad/s].
    """

    level: float
    sine: float
    cosine: float
    drive: float
    period: float
    gap: float
    compliance: float
    amplitude: float
    still: float
    stiffness: float
    damping: float
    plain: bool
    phase_rate: float
    fastest: float


@kernel
def scalars_of(motion):
    """The `Scalars` of an oscillator."""
    w = motion.drive
    plain, phase_rate, fastest, still = True, 0.0, w, 0.0
    for k in range(motion.omega.size):
        omega, decay = motion.omega[k], motion.decay[k]
        fastest = max(fastest, omega, decay)
        phase_rate = max(phase_rate, motion.damped[k])
        still += w * w * (motion.sine[k] ** 2 + motion.cosine[k] ** 2)
        plain = plain and motion.damped[k] > 0.0 and omega > 0.5 * decay and motion.load[k] == 0.0
    return Scalars(
        motion.level, motion.tip_sine, motion.tip_cosine, w, motion.period, motion.gap, motion.compliance,
        math.sqrt(motion.tip_sine**2 + motion.tip_cosine**2), still, motion.number0, motion.number1, plain,
        phase_rate, fastest,
    )  # fmt: skip


@kernel
def mode_rows(motion):
    """The numbers of the modes and room to work, shapes (9, m) and (8, m)."""
    n = motion.omega.size
    m = (n + LANES - 1) // LANES * LANES
    numbers, room = aligned(9, m), aligned(8, m)
    for k in range(m):
        numbers[DAMPED, k] = 1.0
    for k in range(n):
        omega, half = motion.omega[k], 0.5 * motion.decay[k]
        top = max(omega, half)
        numbers[DECAY, k] = motion.decay[k]
        numbers[DAMPED, k], numbers[LOW, k] = motion.damped[k], motion.damped_low[k]
        numbers[SQUARE, k] = omega * omega
        numbers[WEIGHT, k] = motion.phi[k]
        numbers[SLOWNESS, k] = 1.0 / omega if omega > 0.0 else 0.0
        numbers[SHORTNESS, k] = 1.0 / top if top > 0.0 else motion.period
        numbers[OMEGA, k] = omega
        numbers[LOAD, k] = motion.load[k]
    return numbers, room


@kernel
def load_state(room, u, v):
    """Take (u, v), shape (n_modes,) each, as the start of a flight."""
    for k in range(u.size):
        room[START_U, k] = u[k]
        room[START_V, k] = v[k]


@kernel
def swing_at(fixed, t):
    """Steady tip displacement relative to the stop, velocity and acceleration at drive time `t`."""
    w = fixed.drive
    s, c = sine_cosine(w * t, 0.0)
    x = fixed.sine * s + fixed.cosine * c
    return fixed.level + x, w * (fixed.sine * c - fixed.cosine * s), -w * w * x


@kernel
def plain_rows(numbers, room, start, stop, t):
    """`flow_rows` for modes that have this closed form."""
    decay, damped, low, square = numbers[DECAY], numbers[DAMPED], numbers[LOW], numbers[SQUARE]
    u, v, u_out, v_out = room[START_U], room[START_V], room[U], room[V]
    x = _SPLIT * t
    t_high = x - (x - t)
    t_low = t - t_high
    for k in range(start, stop):
        d = damped[k]
        p = d * t
        x = _SPLIT * d
        high = x - (x - d)
        rest = d - high
        rest = ((high * t_high - p) + high * t_low + rest * t_high) + rest * t_low + low[k] * t
        n = np.floor(p * (2.0 / math.pi) + 0.5)
        lead, part = p - n * _QUARTER, n * _QUARTER_LOW
        near = lead - part
        rest = ((lead - near) - part) + rest
        x = near + rest
        rest = (near - x) + rest
        z = x * x
        z2 = z * z
        z4 = z2 * z2
        tail = (_S3 + z * _S5) + z2 * (_S7 + z * _S9) + z4 * ((_S11 + z * _S13) + z2 * (_S15 + z * _S17))
        s = x + (x * z * tail + rest * (1.0 - 0.5 * z))
        bow = 0.5 * z
        c = 1.0 - bow
        tail = (_C4 + z * _C6) + z2 * (_C8 + z * _C10) + z4 * ((_C12 + z * _C14) + z2 * _C16)
        c += ((1.0 - c) - bow) + (z2 * tail - x * rest)
        quarter = n - 4.0 * np.floor(0.25 * n)
        odd = quarter == 1.0 or quarter == 3.0
        sine = c if odd else s
        cosine = s if odd else c
        sine = -sine if quarter >= 2.0 else sine
        cosine = -cosine if (quarter == 1.0 or quarter == 2.0) else cosine
        half = 0.5 * decay[k]
        y = max(-half * t, _LOWEST)
        n = np.floor(y * 1.4426950408889634 + 0.5)
        r = (y - n * _LN2) - n * _LN2_LOW
        r2 = r * r
        r4 = r2 * r2
        tail = (_E2 + r * _E3) + r2 * (_E4 + r * _E5)
        top = (_E10 + r * _E11) + r2 * (_E12 + r * _E13)
        tail += r4 * (((_E6 + r * _E7) + r2 * (_E8 + r * _E9)) + r4 * top)
        fade = _POWERS_OF_TWO[int(n) + 1020] * (1.0 + (r + r2 * tail))
        cn, sn = fade * cosine, fade * sine / d
        u_out[k] = cn * u[k] + sn * (v[k] + half * u[k])
        v_out[k] = cn * v[k] - sn * (square[k] * u[k] + half * v[k])


@kernel
def single_rows(numbers, room, start, stop, t):
    """`flow_rows`, mode by mode."""
    for k in range(start, stop):
        room[U, k], room[V, k] = mode_flow(
            numbers[OMEGA, k], numbers[DECAY, k], numbers[DAMPED, k], numbers[LOW, k], numbers[LOAD, k],
            room[START_U, k], room[START_V, k], t,
        )  # fmt: skip


@kernel
def flow_rows(fixed, numbers, room, start, stop, t):
    """Deviations of modes `start` to `stop` (multiples of 8) a time `t` [s] into the flight, in rows U, V."""
    if fixed.plain and fixed.phase_rate * t < _FARTHEST:
        plain_rows(numbers, room, start, stop, t)
    else:
        single_rows(numbers, room, start, stop, t)


@kernel
def tip_rows(numbers, room, start, stop):
    """What modes `start` to `stop` add to the tip displacement, its derivatives and bounds, in rows HEIGHT to
    THIRD, from rows U, V."""
    decay, square, phi, load = numbers[DECAY], numbers[SQUARE], numbers[WEIGHT], numbers[LOAD]
    u, v, height, rate, bend, third = (
        room[U], room[V], room[HEIGHT], room[RATE], room[BEND], room[THIRD]
    )  # fmt: skip
    for k in range(start, stop):
        c, o2 = decay[k], square[k]
        a = load[k] - c * v[k] - o2 * u[k]
        height[k] = phi[k] * u[k]
        rate[k] = phi[k] * v[k]
        bend[k] = phi[k] * a
        j = -c * a - o2 * v[k]
        third[k] = abs(phi[k]) * math.sqrt(j * j + o2 * a * a)


@kernel
def carry(fixed, numbers, room, t, u, v):
    """Deviations (u, v) of all modes after a time `t` [s], in place."""
    load_state(room, u, v)
    flow_rows(fixed, numbers, room, 0, room.shape[1], t)
    for k in range(u.size):
        u[k] = room[U, k]
        v[k] = room[V, k]


@kernel
def rounding_of(fixed, numbers, room):
    """``contact.flight.tip_rounding`` of the start of the flight [m]."""
    total = abs(fixed.level) + abs(fixed.sine) + abs(fixed.cosine) + fixed.gap
    u, v, phi, shortness = room[START_U], room[START_V], numbers[WEIGHT], numbers[SHORTNESS]
    for k in range(room.shape[1]):
        total += abs(phi[k]) * (abs(u[k]) + abs(v[k]) * shortness[k])
    return 4.0 * EPS * total
