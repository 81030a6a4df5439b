"""Tangents through a touch: further columns of the law's own power series.

``contact.flight.variation`` has the equations.  With parameters the motion itself is one more column, with
the force r N; its sums are the sources of the parameters.
"""

from typing import NamedTuple

import numpy as np

from contact.flight.numbers import DECAY, LOAD, SQUARE, WEIGHT
from contact.flight.variation import DRIVE, NUMBER0, NUMBER1, drive_now, parameter_changes, tip_changes
from contact.machine.compiled import aligned, kernel
from contact.machine.vector_loops import LANES, weighted_rows
from contact.touch.series import powers_of


class Weights(NamedTuple):
    """Series that a law computes from the series of a step, each of shape (order + 1,)."""

    time: np.ndarray  # r = dt/ds
    depth: np.ndarray  # r dN/dd
    rate: np.ndarray  # r dN/dd'
    force: np.ndarray  # r N
    first: np.ndarray  # derivative of r N with respect to the first number of the law
    second: np.ndarray  # and to the second


class TangentWorkspace(NamedTuple):
    """Workspace for the series of all tangents.

    Row n of `rows` holds the coefficients of order n: the rows of the matrix one after the other, each filled
    up to a multiple of eight numbers, m.  The motion itself is the column behind the last tangent.
    """

    rows: np.ndarray  # shape (order + 1, (2 n_modes + 2) m)
    sums: np.ndarray  # shape ((2 n_modes + 2) m,)
    height: np.ndarray  # change of y along all tangents, shape (order + 1, m)
    rate: np.ndarray  # change of y', the same
    force: np.ndarray  # change of the force of this order, shape (m,)
    damping: np.ndarray  # its part from y', shape (m,)
    weights: Weights
    powers: np.ndarray  # shape (order + 1,)


@kernel
def new_tangent_workspace(order, size, columns):
    """Workspace for `columns` tangents of `size` = 2 n_modes + 2 numbers, and for the motion itself."""
    m, n = (columns + LANES) // LANES * LANES, order + 1
    rows, sums, height, rate = aligned(n, size * m), aligned(1, size * m)[0], aligned(n, m), aligned(n, m)
    weights = Weights(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n))
    force, damping = aligned(1, m)[0], aligned(1, m)[0]
    return TangentWorkspace(rows, sums, height, rate, force, damping, weights, np.zeros(n))


@kernel
def sums_of(weights, terms, order, rows, out):
    """out = sum of weights_(order - j) rows_j; only the first `terms` weights are not zero."""
    low = max(0, order + 1 - terms)
    weighted_rows(weights, order - low, -1, rows[low:], order + 1 - low, out)


@kernel
def add_law_changes(vary, space, order, columns):
    """Set the force of this order on the motion itself, and add the changes of the law's two numbers."""
    first, second = space.weights.first[order], space.weights.second[order]
    space.force[columns] = space.weights.force[order]
    start = columns - len(vary.scalars)
    for p in range(columns - start):
        space.force[start + p] += first * vary.scalars[p, NUMBER0] + second * vary.scalars[p, NUMBER1]


@kernel
def add_tip_changes(vary, space, order, columns):
    """Add the changes of y and y' of this order that come from the parameters directly."""
    n, m, count = vary.numbers.size, space.force.size, len(vary.scalars)
    for p in range(count):
        row = space.rows[order].reshape((2 * n + 2, m))[:, columns]  # the motion itself
        y, rate = parameter_changes(vary, p, row[2 * n], row[2 * n + 1], 1.0 if order == 0 else 0.0)
        for k in range(n):
            y += vary.weight[p, k] * row[k]
            rate += vary.weight[p, k] * row[n + k]
        space.height[order, columns - count + p] += y
        space.rate[order, columns - count + p] += rate


@kernel
def next_tangents(numbers, space, order):
    """Compute the next order of all tangents from the sums over all orders so far."""
    n, w, force, inverse = numbers.size, numbers.drive, space.force, 1.0 / (order + 1.0)
    shape = (2 * n + 2, force.size)
    sums, fresh = space.sums.reshape(shape), space.rows[order + 1].reshape(shape)
    for k in range(n):
        c, o2, phi = numbers.modes[DECAY, k], numbers.modes[SQUARE, k], numbers.modes[WEIGHT, k]
        ru, rv, u, v = sums[k], sums[n + k], fresh[k], fresh[n + k]
        for j in range(force.size):
            u[j] = inverse * rv[j]
            v[j] = -inverse * (o2 * ru[j] + c * rv[j] + phi * force[j])
    rs, rc, s, c = sums[2 * n], sums[2 * n + 1], fresh[2 * n], fresh[2 * n + 1]
    for j in range(force.size):
        s[j] = inverse * w * rc[j]
        c[j] = -inverse * w * rs[j]


@kernel
def add_sources(vary, space, order, columns):
    """Add the sources of the parameters to the next order, and a constant load to the motion itself."""
    n, m, inverse = vary.numbers.size, space.force.size, 1.0 / (order + 1.0)
    force, time = space.weights.force[order], space.weights.time[order]
    shape, start = (2 * n + 2, m), columns - len(vary.scalars)
    sums, fresh = space.sums.reshape(shape), space.rows[order + 1].reshape(shape)
    for k in range(n):
        fresh[n + k, columns] += inverse * vary.numbers.modes[LOAD, k] * time
        for p in range(columns - start):
            pull = vary.square[p, k] * sums[k, columns] + vary.decay[p, k] * sums[n + k, columns]
            fresh[n + k, start + p] -= inverse * (pull + vary.weight[p, k] * force)
    for p in range(columns - start):
        turn = inverse * vary.scalars[p, DRIVE]
        fresh[2 * n, start + p] += turn * sums[2 * n + 1, columns]
        fresh[2 * n + 1, start + p] -= turn * sums[2 * n, columns]


@kernel
def tangent_step(vary, space, terms, end, tangent, before):
    """Carry the tangents through a step up to s = `end`, given its start `before`, (drive time, u, v).

    The first `terms` terms of the weights of time, depth and rate are not zero.
    """
    numbers, response, (size, columns) = vary.numbers, vary.response, tangent.shape
    m, order, n = space.force.size, space.powers.size - 1, numbers.size
    start = space.rows[0].reshape((size, m))
    start[:, :columns] = tangent
    if len(vary.scalars) > 0:
        clock, u, v = before
        start[2 * n, columns], start[2 * n + 1, columns] = drive_now(vary, clock)
        start[:n, columns], start[n : 2 * n, columns] = u, v
    for i in range(order):
        tip_changes(numbers, response, space.rows[i].reshape((size, m)), space.height[i], space.rate[i])
        if len(vary.scalars) > 0:
            add_tip_changes(vary, space, i, columns)
        sums_of(space.weights.depth, terms, i, space.height, space.force)
        sums_of(space.weights.rate, terms, i, space.rate, space.damping)
        for j in range(m):
            space.force[j] += space.damping[j]
        if len(vary.scalars) > 0:
            add_law_changes(vary, space, i, columns)
        sums_of(space.weights.time, terms, i, space.rows, space.sums)
        next_tangents(numbers, space, i)
        if len(vary.scalars) > 0:
            add_sources(vary, space, i, columns)
    powers_of(end, space.powers)
    weighted_rows(space.powers, 0, 1, space.rows, order + 1, space.sums)
    tangent[:, :] = space.sums.reshape((size, m))[:, :columns]
