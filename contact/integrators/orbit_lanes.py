"""Many orbits of one mode side by side: vector instructions for their impacts.

Periods without an impact cost a few nanoseconds, those with one ten times as much, most of it waiting for
one result before the next operation can begin.  Orbits do not depend on one another, so up to `LANES` of them
are carried together.  Each runs on alone to its next impact; there it waits until the others have come to
theirs, however many periods that takes them, and then the pieces of ``struck_period`` are computed for all
lanes at once: loops of fixed length over neighbouring numbers, which the compiler turns into vector
instructions.

Every lane goes through the operations of ``single_mode_loop`` in the same order, so that an orbit is the same
bit for bit, alone or in any company.  A lane stops at a period that these do not settle.

The workspace is one array of rows of LANES numbers: LoopNumbers first, then what the names below say.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.integrators.struck_period import (
    LoopNumbers,
    carried,
    free_near,
    guessed,
    is_settled,
    steady_near,
    tip_derivatives,
    zero_of,
)

__all__ = ["LANES", "carry_lanes"]

LANES = 16
"""Twice the doubles of the widest vector register: two at a time hide each other's waiting."""

NUMBERS = len(LoopNumbers._fields)
PERIOD, STRETCH, PER_SECOND = (
    LoopNumbers._fields.index(name) * LANES for name in ("period", "stretch", "per_second")
)
U, V, P, Q, HEIGHT, RHO, TIME, AFTER, WAITS, PROVED, NEXT_U, NEXT_V, ROW = (
    (NUMBERS + row) * LANES for row in range(13)
)
"""Deviation at the strobe; p, q and tip displacement at the steady peak; rho; guessed time of the crossing;
its distance from the next node; whether an impact waits, whether it was settled, and the deviation after it;
ten rows for the node: its swing, the flow to it and the flow from there to the end."""

SIZE = ROW + 10 * LANES


@kernel
def numbers_of(a, l):
    """The numbers of lane `l` of the workspace."""
    w = LANES
    return LoopNumbers(
        a[l], a[w + l], a[2 * w + l], a[3 * w + l], a[4 * w + l], a[5 * w + l], a[6 * w + l], a[7 * w + l],
        a[8 * w + l], a[9 * w + l], a[10 * w + l], a[11 * w + l], a[12 * w + l], a[13 * w + l],
        a[14 * w + l], a[15 * w + l], a[16 * w + l], a[17 * w + l], a[18 * w + l], a[19 * w + l],
        a[20 * w + l], a[21 * w + l], a[22 * w + l], a[23 * w + l], a[24 * w + l], a[25 * w + l],
        a[26 * w + l], a[27 * w + l], a[28 * w + l], a[29 * w + l],
    )  # fmt: skip


@kernel
def guess_lanes(a):
    """`guessed` in every lane."""
    for l in range(LANES):
        a[TIME + l] = guessed(numbers_of(a, l), a[P + l], a[Q + l], a[HEIGHT + l])


@kernel
def strike_lanes(a):
    """The period with an impact in every lane."""
    w = LANES
    for l in range(LANES):
        n, u, v, r = numbers_of(a, l), a[U + l], a[V + l], ROW + l
        u0, v0, s0, s1 = free_near(
            n, a[AFTER + l], a[r + 2 * w] * u + a[r + 3 * w] * v, a[r + 4 * w] * u + a[r + 5 * w] * v
        )
        swing, glide = steady_near(n, a[AFTER + l], a[r], a[r + w])
        y0, y1, y2, y3, y4 = tip_derivatives(n, u0, v0, swing, glide)
        d, rest, approach = zero_of(y0, y1, y2, y3, y4)
        u0, v0 = carried(n, u0, v0, d)
        s0, s1 = carried(n, s0, s1, -d)
        jump = n.kick * approach
        settled = is_settled(n, a[RHO + l], u0, v0 + jump, y1, d, rest, approach)
        un = n.f0 * u + n.f1 * v + jump * (a[r + 6 * w] * s0 + a[r + 7 * w] * s1)
        vn = n.f2 * u + n.f3 * v + jump * (a[r + 8 * w] * s0 + a[r + 9 * w] * s1)
        a[NEXT_U + l] = un
        a[NEXT_V + l] = vn
        a[PROVED + l] = 1.0 if settled else 0.0


@kernel
def carry_lanes(numbers, rows, first_row, u, v, orbits, done, mean, weight, points, counts):
    """Carry orbits until each has reached the end or a period that has to be left.

    Parameters
    ----------
    numbers : ndarray, shape (lanes, 30)
    rows : ndarray, shape (sum of the nodes, 6)
        Those of all lanes, one below the other; `first_row`, shape (lanes + 1,), tells where each begins.
    u, v : ndarray, shape (lanes,)
        Deviations; overwritten.
    orbits : ndarray of int, shape (lanes,)
        Which of the orbits a lane carries: places in the arrays that follow.
    done : ndarray of int, shape (n_orbits,)
        Periods behind each; overwritten.
    mean, weight : ndarray, shape (lanes, 2)
    points, counts : ndarray, shapes (n_orbits, periods, 2) and (n_orbits, periods)
        As in ``strobed_motion``, for each orbit.
    """
    lanes, periods = u.size, counts.shape[1]
    a = np.zeros(SIZE)
    for l in range(LANES):
        for j in range(NUMBERS):
            a[j * LANES + l] = numbers[min(l, lanes - 1), j]
    running = True
    while running:
        running = False
        for l in range(lanes):
            # on to the next impact, or to a period that has to be left, or to the end
            n, o, un, vn = numbers_of(a, l), orbits[l], u[l], v[l]
            i, waits = done[o], 0.0
            q, q_rate, weight_u, weight_v = mean[l, 0], mean[l, 1], weight[l, 0], weight[l, 1]
            while i < periods:
                square = n.square_u * un * un + n.square_v * vn * vn
                if not square < n.most:
                    break
                rho = math.sqrt(square)
                p, slope = n.g0 * un + n.g1 * vn, n.g2 * un + n.g3 * vn
                room = n.gap - n.detuning * rho
                z, room = n.above + p + room, room - n.margin
                if not z * z + n.slow * slope * slope < room * room:
                    a[U + l], a[V + l], a[RHO + l] = un, vn, rho
                    a[P + l], a[Q + l], a[HEIGHT + l] = p, slope, n.above + p
                    waits = 1.0
                    break
                un, vn = n.f0 * un + n.f1 * vn, n.f2 * un + n.f3 * vn
                points[o, i, 0] = (un + q) * weight_u
                points[o, i, 1] = (vn + q_rate) * weight_v
                counts[o, i] = 0
                i += 1
            u[l], v[l], done[o], a[WAITS + l] = un, vn, i, waits
        guess_lanes(a)
        for l in range(lanes):
            t = a[TIME + l]
            if not (a[WAITS + l] > 0.0 and 0.0 <= t <= a[PERIOD + l]):
                a[WAITS + l] = 0.0
                continue
            k = np.int64(t * a[PER_SECOND + l] + 0.5)
            a[AFTER + l] = t - k * a[STRETCH + l]
            here, there = first_row[l] + k, first_row[l + 1] - 1 - k
            for j in range(6):
                a[ROW + j * LANES + l] = rows[here, j]
            for j in range(4):
                a[ROW + (6 + j) * LANES + l] = rows[there, 2 + j]
        strike_lanes(a)
        for l in range(lanes):
            if a[WAITS + l] * a[PROVED + l] > 0.0:
                o = orbits[l]
                i = done[o]
                u[l], v[l] = a[NEXT_U + l], a[NEXT_V + l]
                points[o, i, 0] = (u[l] + mean[l, 0]) * weight[l, 0]
                points[o, i, 1] = (v[l] + mean[l, 1]) * weight[l, 1]
                counts[o, i] = 1
                done[o] = i + 1
                running = True
