"""Tangents: derivatives of a motion with respect to its start and to the numbers of its oscillator.

The drive is carried along as two more coordinates, S = Z sin(w t) and C = Z cos(w t).  The motion is then an
autonomous flow of e = (u, v, S, C), 2 N + 2 numbers, and the tip is at

    y(e) = phi . u + a S + b C + level,      a + i b the tip response per unit base amplitude.

A tangent d = de(t)/de(0) is a column of a matrix.  In the variable s of the law's series, r = dt/ds,

    du = r v,   dv = r (-c v - omega^2 u) - phi (r N_d y(d) + r N_d' y'(d)),   dS = r w C,   dC = -r w S.

The sums over earlier orders, sum_j r_(n-j) x_j, belong to the motion itself.  A law therefore only has to
give the series of r, r N_d and r N_d' (`slopes`).  The last columns may belong to parameters
(``contact.sensitivity.change``).  With a dot for the derivative of a number, their sources are

    y(d)  + level. + a. S + b. C + phi. . u,      y'(d)  + w. (a C - b S) + w (a. C - b. S) + phi. . v,
    dv  - r ((omega^2). u + c. v) - phi. r N - phi (r N)_1 n_1. - phi (r N)_2 n_2.,
    dS  + r w. C,   dC  - r w. S,

where n_1, n_2 are the two numbers of the law.  With half = c/2, D = omega^2 - half^2 and cn, sn as in
``contact.flight.modal_flow`` (damping included), the flow of a free mode is (cn + half sn, sn; -omega^2 sn,
cn - half sn), and its derivatives follow from d exp(-half t)/dc = -t/2 exp(-half t) and

    d cn/dD = -t sn/2,      d sn/dD = (t cn - sn)/(2 D),      dD/d(omega^2) = 1,      dD/dc = -half.

Derivation: ``docs/theory/flight.md``.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.flight.modal_flow import flow_matrix, flow_over
from contact.flight.numbers import DAMPED, DAMPED_LOW, DECAY, OMEGA, WEIGHT, Numbers
from contact.machine.compiled import kernel, part

LEVEL, TIP_SINE, TIP_COSINE, DRIVE, NUMBER0, NUMBER1 = range(6)
"""Columns of `Variation.scalars`: the derivatives of level, a, b, w, n_1 and n_2."""

TERMS = 10
"""Terms of d sn/dD = e^(-half t) t^3 sum_k (-1)^k (D t^2)^(k-1) k/(2k + 1)!, k = 1, 2, ..., for |D t^2| < 1:
the next one is below 1e-19 of the first."""
TINY = 1e-300  # replaces |a + i b| where the drive does not move the tip


class Variation(NamedTuple):
    """The motion whose tangents are carried along, and its derivatives with respect to the parameters."""

    numbers: Numbers
    response: complex  # a + i b
    square: np.ndarray  # of omega^2, shape (parameters, n_modes)
    decay: np.ndarray  # of c, the same
    weight: np.ndarray  # of phi, the same
    scalars: np.ndarray  # of single numbers, shape (parameters, 6); the columns are named above


def variation(numbers, response, *derivatives):
    """The variation with these `derivatives`, its last four fields; without parameters none are given."""
    none = np.zeros((0, numbers.size))
    return Variation(numbers, response, *(derivatives or (none, none, none, np.zeros((0, NUMBER1 + 1)))))


@part
def drive_now(vary, clock):
    """S and C at the drive time `clock` [s]."""
    numbers, angle = vary.numbers, vary.numbers.drive * clock
    size = numbers.amplitude / max(abs(vary.response), TINY)
    return size * math.sin(angle), size * math.cos(angle)


@kernel
def flow_derivative(modes, k, square, decay, t):
    """Derivative of the flow of mode `k` over a time `t` [s], as four numbers, in a direction of the numbers.

    `square` and `decay` are the changes of omega^2 and c in that direction.
    """
    omega, half = modes[OMEGA, k], 0.5 * modes[DECAY, k]
    m11, sn, m21, m22 = flow_matrix(omega, modes[DECAY, k], modes[DAMPED, k], modes[DAMPED_LOW, k], t)
    distance = math.copysign(modes[DAMPED, k] ** 2, omega - half)
    x = distance * t * t
    if abs(x) < 1.0:
        term, slope = -t * t * t * math.exp(-half * t) / 6.0, 0.0
        for n in range(1, TERMS + 1):
            slope += n * term
            term *= -x / ((2.0 * n + 2.0) * (2.0 * n + 3.0))
    else:
        slope = (0.5 * t * (m11 + m22) - sn) / (2.0 * distance)
    moved, faded, spread = square - half * decay, -0.5 * t * decay, 0.5 * decay * sn
    even, odd = -0.5 * t * sn * moved, half * slope * moved
    return (
        faded * m11 + even + odd + spread,
        faded * sn + slope * moved,
        faded * m21 - sn * square - omega * omega * slope * moved,
        faded * m22 + even - odd - spread,
    )


@kernel
def tangent_flight(vary, tangent, u, v, clock, time):
    """Carry the tangents through a free flight of length `time` [s] that starts from (u, v) at `clock`."""
    numbers = vary.numbers
    n, count, flows = numbers.size, len(vary.scalars), flow_over(numbers, time)
    first = tangent.shape[1] - count
    for k in range(n):
        for j in range(tangent.shape[1]):
            x, y = tangent[k, j], tangent[n + k, j]
            tangent[k, j] = flows[k, 0] * x + flows[k, 1] * y
            tangent[n + k, j] = flows[k, 2] * x + flows[k, 3] * y
        for p in range(count):
            if vary.square[p, k] != 0.0 or vary.decay[p, k] != 0.0:
                a, b, c, d = flow_derivative(numbers.modes, k, vary.square[p, k], vary.decay[p, k], time)
                tangent[k, first + p] += a * u[k] + b * v[k]
                tangent[n + k, first + p] += c * u[k] + d * v[k]
    s, c = math.sin(numbers.drive * time), math.cos(numbers.drive * time)
    for j in range(tangent.shape[1]):
        a, b = tangent[2 * n, j], tangent[2 * n + 1, j]
        tangent[2 * n, j], tangent[2 * n + 1, j] = c * a + s * b, c * b - s * a
    if count > 0:
        sine, cosine = drive_now(vary, clock + time)
        for p in range(count):
            tangent[2 * n, first + p] += vary.scalars[p, DRIVE] * time * cosine
            tangent[2 * n + 1, first + p] -= vary.scalars[p, DRIVE] * time * sine


@kernel
def tip_changes(numbers, response, tangent, height, rate):
    """Fill `height` and `rate` with the changes of y and y' along tangents, without parameter sources."""
    n, w, a, b = numbers.size, numbers.drive, response.real, response.imag
    s, c = tangent[2 * n], tangent[2 * n + 1]
    for j in range(height.size):
        height[j] = a * s[j] + b * c[j]
        rate[j] = w * (a * c[j] - b * s[j])
    for k in range(n):
        phi, u, v = numbers.modes[WEIGHT, k], tangent[k], tangent[n + k]
        for j in range(height.size):
            height[j] += phi * u[j]
            rate[j] += phi * v[j]


@part
def parameter_changes(vary, p, sine, cosine, constant):
    """Changes of y and y' that come from parameter `p` directly at (S, C), without the modes.

    `constant` is 1 for values and coefficients of order 0, and 0 for higher orders, where the level is
    absent.
    """
    w, a, b, change = vary.numbers.drive, vary.response.real, vary.response.imag, vary.scalars[p]
    da, db = change[TIP_SINE], change[TIP_COSINE]
    own, steady = da * cosine - db * sine, a * cosine - b * sine
    return change[LEVEL] * constant + da * sine + db * cosine, change[DRIVE] * steady + w * own


@kernel
def all_tip_changes(vary, tangent, u, v, clock):
    """Changes of tip displacement and velocity along all tangents at (u, v), parameter sources included."""
    columns, count = tangent.shape[1], len(vary.scalars)
    height, rate = np.empty(columns), np.empty(columns)
    tip_changes(vary.numbers, vary.response, tangent, height, rate)
    if count > 0:
        sine, cosine = drive_now(vary, clock)
        for p in range(count):
            y, y_rate = parameter_changes(vary, p, sine, cosine, 1.0)
            for k in range(u.size):
                y += vary.weight[p, k] * u[k]
                y_rate += vary.weight[p, k] * v[k]
            height[columns - count + p] += y
            rate[columns - count + p] += y_rate
    return height, rate


@kernel
def force_jump(vary, force, approach, tangent, before):
    """The effect on the tangents of a touch at which the `force` F jumps from zero: d -> d - phi F y(d)/v.

    This is the saltation matrix of Aizerman and Gantmacher (R. I. Leine, H. Nijmeijer, Dynamics and
    Bifurcations of Non-Smooth Mechanical Systems, 2004, ch. 7).
    """
    numbers = vary.numbers
    if force == 0.0:
        return
    clock, u, v = before
    height, _rate = all_tip_changes(vary, tangent, u, v, clock)
    for k in range(numbers.size):
        for j in range(height.size):
            tangent[numbers.size + k, j] -= numbers.modes[WEIGHT, k] * force * height[j] / approach
