"""Tangents through a touch: further columns of the law's own power series; equations in
``contact.flight.variation``.

The motion itself is one more column if there are parameters: pushed by r N, it has the sums that their
sources are made of.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.flight.motion import DECAY, LOAD, SQUARE, WEIGHT
from contact.flight.variation import FIRST, FORCES, PACE, drive_now, own_changes, tip_changes
from contact.machine.compiled import kernel
from contact.machine.vector_loops import LANES, aligned, weighted_rows
from contact.touch.series import powers_of


class TangentRoom(NamedTuple):
    """Room for the series of all tangents.

    rows : ndarray, shape (order + 1, (2 n_modes + 2) m)
        Row n holds the coefficients of order n: the rows of the matrix one after the other, each filled up to
        a multiple of eight numbers, m; with parameters the motion itself is the column behind its last.
    sums : ndarray, shape ((2 n_modes + 2) m,)
    height, rate : ndarray, shape (order + 1, m)
        y and y' of all tangents.
    push, more : ndarray, shape (m,)
    weights : ndarray, shape (6, order + 1)
        Series of r, r N_d, r N_d', and of r N and its derivatives with respect to n_1 and n_2.
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
def new_room(order, size, columns):
    """Room for `columns` tangents of `size` = 2 n_modes + 2 numbers, and the motion itself."""
    m = (columns + LANES) // LANES * LANES
    return TangentRoom(
        aligned(order + 1, size * m),
        aligned(1, size * m)[0],
        aligned(order + 1, m),
        aligned(order + 1, m),
        aligned(1, m)[0],
        aligned(1, m)[0],
        np.zeros((FORCES + 3, order + 1)),
        np.zeros(order + 1),
    )


@kernel
def sums_of(weights, terms, order, rows, out):
    """out = sum of weights_(order - j) rows_j, of which the first `terms` weights are not zero."""
    low = max(0, order + 1 - terms)
    weighted_rows(weights, order - low, -1, rows[low:], order + 1 - low, out)


@kernel
def pushed(vary, room, order, columns):
    """The pushes of this order that are not the stop's answer to y and y': that on the motion itself, and the
    changes of the law."""
    first, second = room.weights[FORCES + 1, order], room.weights[FORCES + 2, order]
    room.push[columns] = room.weights[FORCES, order]
    start = columns - len(vary.rest)
    for p in range(columns - start):
        room.push[start + p] += first * vary.rest[p, FIRST] + second * vary.rest[p, FIRST + 1]


@kernel
def raised(vary, room, order, columns):
    """The changes y and y' of this order that are the parameters' own."""
    n, m, count = vary.motion.size, room.push.size, len(vary.rest)
    for p in range(count):
        row = room.rows[order].reshape((2 * n + 2, m))[:, columns]  # the motion itself
        y, rate = own_changes(vary, p, row[2 * n], row[2 * n + 1], 1.0 if order == 0 else 0.0)
        for k in range(n):
            y += vary.weight[p, k] * row[k]
            rate += vary.weight[p, k] * row[n + k]
        room.height[order, columns - count + p] += y
        room.rate[order, columns - count + p] += rate


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
def next_sources(vary, room, order, columns):
    """What the parameters add to it, and a constant load to the motion itself."""
    n, m, inverse, force = vary.motion.size, room.push.size, 1.0 / (order + 1.0), room.weights[FORCES, order]
    shape, start = (2 * n + 2, m), columns - len(vary.rest)
    sums, fresh = room.sums.reshape(shape), room.rows[order + 1].reshape(shape)
    for k in range(n):
        fresh[n + k, columns] += inverse * vary.motion.modes[LOAD, k] * room.weights[0, order]
        for p in range(columns - start):
            pull = vary.square[p, k] * sums[k, columns] + vary.decay[p, k] * sums[n + k, columns]
            fresh[n + k, start + p] -= inverse * (pull + vary.weight[p, k] * force)
    for p in range(columns - start):
        turn = inverse * vary.rest[p, PACE]
        fresh[2 * n, start + p] += turn * sums[2 * n + 1, columns]
        fresh[2 * n + 1, start + p] -= turn * sums[2 * n, columns]


@kernel
def tangent_step(vary, room, terms, end, tangent, before):
    """Carry the tangents through a step up to s = `end` that starts at `before`, (drive time, u, v); `terms`
    terms of the first rows of room.weights count."""
    motion, response, (size, columns) = vary.motion, vary.response, tangent.shape
    m, order, n = room.push.size, room.powers.size - 1, motion.size
    start = room.rows[0].reshape((size, m))
    start[:, :columns] = tangent
    if len(vary.rest) > 0:
        clock, u, v = before
        start[2 * n, columns], start[2 * n + 1, columns] = drive_now(vary, clock)
        start[:n, columns], start[n : 2 * n, columns] = u, v
    for i in range(order):
        tip_changes(motion, response, room.rows[i].reshape((size, m)), room.height[i], room.rate[i])
        if len(vary.rest) > 0:
            raised(vary, room, i, columns)
        sums_of(room.weights[1], terms, i, room.height, room.push)
        sums_of(room.weights[2], terms, i, room.rate, room.more)
        for j in range(m):
            room.push[j] += room.more[j]
        if len(vary.rest) > 0:
            pushed(vary, room, i, columns)
        sums_of(room.weights[0], terms, i, room.rows, room.sums)
        next_tangents(motion, room, i)
        if len(vary.rest) > 0:
            next_sources(vary, room, i, columns)
    powers_of(end, room.powers)
    weighted_rows(room.powers, 0, 1, room.rows, order + 1, room.sums)
    tangent[:, :] = room.sums.reshape((size, m))[:, :columns]
