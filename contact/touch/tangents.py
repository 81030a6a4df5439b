"""How a motion in touch changes with its start: further columns of the contact's own series.

The drive is carried along as two more coordinates, S = Z sin(w t) and C = Z cos(w t), so that the motion is
an autonomous flow of e = (u, v, S, C), 2 N + 2 numbers.  The tip is at

    y(e) = phi . u + a S + b C + level,      a + i b the tip response per unit base amplitude.

A tangent d = de(t)/de(0) is a column of a (2 N + 2) x (2 N + 2) matrix.  In the variable s of the law's
series

    du = r v,   dv = r (-c v - omega^2 u) - phi (r N_d y(d) + r N_d' y'(d)),   dS = r w C,   dC = -r w S

with r = dt/ds: the sums over earlier orders, sum_j r_(n-j) x_j, are those of the motion itself, and the
series of r, r N_d and r N_d' are all that a law has to give (`slopes`).
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.flight.modal_flow import flow_over
from contact.flight.motion import DECAY, SQUARE, WEIGHT
from contact.touch.series import powers_of
from contact.vector_loops import LANES, aligned, weighted_rows

__all__ = ["TangentRoom", "new_room", "onset", "tangent_flight", "tangent_step", "tip_changes"]


class TangentRoom(NamedTuple):
    """Room for the series of all tangents.

    rows : ndarray, shape (order + 1, (2 n_modes + 2) m)
        Row n holds the coefficients of order n: the rows of the matrix one after the other, each filled up to
        a multiple of eight numbers, m.
    sums : ndarray, shape ((2 n_modes + 2) m,)
    height, rate : ndarray, shape (order + 1, m)
        y and y' of all tangents.
    push, more : ndarray, shape (m,)
    weights : ndarray, shape (3, order + 1)
        Series of r, r N_d and r N_d'.
    powers : ndarray, shape (order + 1,)
    """

    rows: np.ndarray
    sums: np.ndarray
    height: np.ndarray
    rate: np.ndarray
    push: np.ndarray
    more: np.ndarray
    weights: np.ndarray
    powers: np.ndarray


@kernel
def new_room(order, size):
    """Room for the tangents, `size` = 2 n_modes + 2 of them."""
    m = (size + LANES - 1) // LANES * LANES
    return TangentRoom(
        aligned(order + 1, size * m), aligned(1, size * m)[0], aligned(order + 1, m), aligned(order + 1, m),
        aligned(1, m)[0], aligned(1, m)[0], np.zeros((3, order + 1)), np.zeros(order + 1),
    )  # fmt: skip


@kernel
def tangent_flight(motion, tangent, time):
    """Carry the tangents through a free flight of length `time` [s]."""
    n, flows = motion.size, flow_over(motion, time)
    for k in range(n):
        for j in range(2 * n + 2):
            x, y = tangent[k, j], tangent[n + k, j]
            tangent[k, j] = flows[k, 0] * x + flows[k, 1] * y
            tangent[n + k, j] = flows[k, 2] * x + flows[k, 3] * y
    s, c = math.sin(motion.drive * time), math.cos(motion.drive * time)
    for j in range(2 * n + 2):
        a, b = tangent[2 * n, j], tangent[2 * n + 1, j]
        tangent[2 * n, j], tangent[2 * n + 1, j] = c * a + s * b, c * b - s * a


@kernel
def tip_changes(motion, response, tangent, reach, rate):
    """Fill `reach`, `rate` with the changes y and y' of tip displacement and velocity along all tangents."""
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


@kernel
def onset(motion, response, force, approach, tangent):
    """A touch at which the `force` jumps from zero: d -> d - phi F y(d)/v (saltation matrix of Aizerman and
    Gantmacher; R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004,
    ch. 7)."""
    n = motion.size
    if force == 0.0:
        return
    reach, rate = np.empty(2 * n + 2), np.empty(2 * n + 2)
    tip_changes(motion, response, tangent, reach, rate)
    for k in range(n):
        for j in range(reach.size):
            tangent[n + k, j] -= motion.modes[WEIGHT, k] * force * reach[j] / approach


@kernel
def sums_of(weights, terms, order, rows, out):
    """out = sum of weights_(order - j) rows_j, of which the first `terms` weights are not zero."""
    low = max(0, order + 1 - terms)
    weighted_rows(weights, order - low, -1, rows[low:], order + 1 - low, out)


@kernel
def next_tangents(motion, room, order):
    """The order after this one of all tangents, from the sums over all before it."""
    n, w, push, inverse = motion.size, motion.drive, room.push, 1.0 / (order + 1.0)
    shape = (2 * n + 2, push.size)
    sums, fresh = room.sums.reshape(shape), room.rows[order + 1].reshape(shape)
    for k in range(n):
        c, o2, phi = motion.modes[DECAY, k], motion.modes[SQUARE, k], motion.modes[WEIGHT, k]
        ru, rv, u, v = sums[k], sums[n + k], fresh[k], fresh[n + k]
        for j in range(push.size):
            u[j] = inverse * rv[j]
            v[j] = -inverse * (o2 * ru[j] + c * rv[j] + phi * push[j])
    rs, rc, s, c = sums[2 * n], sums[2 * n + 1], fresh[2 * n], fresh[2 * n + 1]
    for j in range(push.size):
        s[j] = inverse * w * rc[j]
        c[j] = -inverse * w * rs[j]


@kernel
def tangent_step(motion, response, room, terms, end, tangent):
    """Carry the tangents through a step up to s = `end`; `terms` terms of room.weights count."""
    size, m, order = tangent.shape[0], room.push.size, room.powers.size - 1
    for i in range(size):
        for j in range(size):
            room.rows[0, i * m + j] = tangent[i, j]
    for n in range(order):
        tip_changes(motion, response, room.rows[n].reshape((size, m)), room.height[n], room.rate[n])
        sums_of(room.weights[1], terms, n, room.height, room.push)
        sums_of(room.weights[2], terms, n, room.rate, room.more)
        for j in range(m):
            room.push[j] += room.more[j]
        sums_of(room.weights[0], terms, n, room.rows, room.sums)
        next_tangents(motion, room, n)
    powers_of(end, room.powers)
    weighted_rows(room.powers, 0, 1, room.rows, order + 1, room.sums)
    for i in range(size):
        for j in range(size):
            tangent[i, j] = room.sums[i * m + j]
