"""How a motion changes with its start and with the numbers of its oscillator: tangents.

The drive is carried along as two more coordinates, S = Z sin(w t) and C = Z cos(w t), so that the motion is
an autonomous flow of e = (u, v, S, C), 2 N + 2 numbers.  The tip is at

    y(e) = phi . u + a S + b C + level,      a + i b the tip response per unit base amplitude.

A tangent d = de(t)/de(0) is a column of a (2 N + 2) x (2 N + 2) matrix.  In the variable s of the law's
series

    du = r v,   dv = r (-c v - omega^2 u) - phi (r N_d y(d) + r N_d' y'(d)),   dS = r w C,   dC = -r w S

with r = dt/ds: the sums over earlier orders, sum_j r_(n-j) x_j, are those of the motion itself, and the
series of r, r N_d and r N_d' are all that a law has to give (`slopes`).

The last columns of a matrix may belong to parameters p, each a direction in which the numbers of the
oscillator change (``contact.sensitivity.change``).  They have sources besides: with a dot for the derivative
of a number, and with (u, v, S, C) the motion itself,

    y(d)  + level. + a. S + b. C + phi. . u,      y'(d)  + w. (a C - b S) + w (a. C - b. S) + phi. . v,
    dv  - r ((omega^2). u + c. v) - phi. r N - phi (r N)_1 n_1. - phi (r N)_2 n_2.,
    dS  + r w. C,   dC  - r w. S,

n_1, n_2 the two numbers of the law.  The motion itself is one more column of the series, pushed by r N.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.flight.flow_derivative import flow_derivative
from contact.flight.modal_flow import flow_over
from contact.flight.motion import WEIGHT, Motion
from contact.machine.compiled import kernel, part

NUMBERS, PACE, FIRST = 6, 3, 4
"""Columns of `Variation.rest`, the changes of level, a, b, w, n_1 and n_2; those of w and of n_1 among
them."""

TINY = 1e-300
"""Stands for |a + i b| of a tip that the drive does not move."""

FORCES = 3
"""Rows of the weights from which on they hold r N and its derivatives with respect to n_1 and n_2."""


class Variation(NamedTuple):
    """Whose tangents are carried along: of an oscillator's motion, with these parameters.

    motion : Motion
    response : complex
        a + i b.
    square, decay, weight : ndarray, shape (parameters, n_modes)
        Changes of omega^2, c and phi.
    rest : ndarray, shape (parameters, 6)
        Those of level, a, b, w, n_1 and n_2.
    """

    motion: Motion
    response: complex
    square: np.ndarray
    decay: np.ndarray
    weight: np.ndarray
    rest: np.ndarray


def variation(motion, response, square=None, decay=None, weight=None, rest=None):
    """The variation of an oscillator; without parameters unless these are given."""
    none, numbers = np.zeros((0, motion.size)), np.zeros((0, NUMBERS))
    return Variation(
        motion,
        response,
        *(none if each is None else each for each in (square, decay, weight)),
        numbers if rest is None else rest,
    )


@part
def drive_now(vary, clock):
    """S and C at the drive time `clock` [s]."""
    motion, angle = vary.motion, vary.motion.drive * clock
    size = motion.amplitude / max(abs(vary.response), TINY)
    return size * math.sin(angle), size * math.cos(angle)


@kernel
def tangent_flight(vary, tangent, u, v, clock, time):
    """Carry the tangents through a free flight of length `time` [s] that starts from (u, v) at `clock`."""
    motion = vary.motion
    n, count, flows = motion.size, len(vary.rest), flow_over(motion, time)
    first = tangent.shape[1] - count
    for k in range(n):
        for j in range(tangent.shape[1]):
            x, y = tangent[k, j], tangent[n + k, j]
            tangent[k, j] = flows[k, 0] * x + flows[k, 1] * y
            tangent[n + k, j] = flows[k, 2] * x + flows[k, 3] * y
        for p in range(count):
            if vary.square[p, k] != 0.0 or vary.decay[p, k] != 0.0:
                a, b, c, d = flow_derivative(motion.modes, k, vary.square[p, k], vary.decay[p, k], time)
                tangent[k, first + p] += a * u[k] + b * v[k]
                tangent[n + k, first + p] += c * u[k] + d * v[k]
    s, c = math.sin(motion.drive * time), math.cos(motion.drive * time)
    for j in range(tangent.shape[1]):
        a, b = tangent[2 * n, j], tangent[2 * n + 1, j]
        tangent[2 * n, j], tangent[2 * n + 1, j] = c * a + s * b, c * b - s * a
    if count > 0:
        sine, cosine = drive_now(vary, clock + time)
        for p in range(count):
            tangent[2 * n, first + p] += vary.rest[p, PACE] * time * cosine
            tangent[2 * n + 1, first + p] -= vary.rest[p, PACE] * time * sine


@kernel
def tip_changes(motion, response, tangent, reach, rate):
    """Fill `reach`, `rate` with the changes y and y' of tip displacement and velocity along tangents, without
    the sources of the parameters."""
    n, w, a, b = motion.size, motion.drive, response.real, response.imag
    s, c = tangent[2 * n], tangent[2 * n + 1]
    for j in range(reach.size):
        reach[j] = a * s[j] + b * c[j]
        rate[j] = w * (a * c[j] - b * s[j])
    for k in range(n):
        phi, u, v = motion.modes[WEIGHT, k], tangent[k], tangent[n + k]
        for j in range(reach.size):
            reach[j] += phi * u[j]
            rate[j] += phi * v[j]


@part
def own_changes(vary, p, sine, cosine, still):
    """What parameter `p` itself adds to y and y' at (S, C), the modes left out; `still` is 1, or 0 for a
    coefficient of a higher order, to which the level adds nothing."""
    w, a, b, rest = vary.motion.drive, vary.response.real, vary.response.imag, vary.rest[p]
    in_phase, off_phase = a * cosine - b * sine, rest[1] * cosine - rest[2] * sine
    return rest[0] * still + rest[1] * sine + rest[2] * cosine, rest[PACE] * in_phase + w * off_phase


@kernel
def all_tip_changes(vary, tangent, u, v, clock):
    """The changes of tip displacement and velocity along all tangents at (u, v), those of the parameters
    whole."""
    columns, count = tangent.shape[1], len(vary.rest)
    reach, rate = np.empty(columns), np.empty(columns)
    tip_changes(vary.motion, vary.response, tangent, reach, rate)
    if count > 0:
        sine, cosine = drive_now(vary, clock)
        for p in range(count):
            y, y_rate = own_changes(vary, p, sine, cosine, 1.0)
            for k in range(u.size):
                y += vary.weight[p, k] * u[k]
                y_rate += vary.weight[p, k] * v[k]
            reach[columns - count + p] += y
            rate[columns - count + p] += y_rate
    return reach, rate


@kernel
def onset(vary, force, approach, tangent, before):
    """A touch at which the `force` jumps from zero: d -> d - phi F y(d)/v (saltation matrix of Aizerman and
    Gantmacher; R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004,
    ch. 7)."""
    motion = vary.motion
    if force == 0.0:
        return
    clock, u, v = before
    reach, _rate = all_tip_changes(vary, tangent, u, v, clock)
    for k in range(motion.size):
        for j in range(reach.size):
            tangent[motion.size + k, j] -= motion.modes[WEIGHT, k] * force * reach[j] / approach
