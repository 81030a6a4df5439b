"""Contact under Hertz's law, all modes side by side.

The equations of ``contact.hertz_series``: with r = sqrt(d) and a variable sigma that runs slowly while the
contact is shallow,

    dt/dsigma = r,  dr/dsigma = d'/2,  du/dsigma = r v,  dv/dsigma = r (g - c v - omega^2 u) - phi r N,
    dd/dsigma = r d',  r N = k (r^4 + chi r^4 d'),  d' = sum phi v + x_s'(t).

Every right-hand side is r times something, so that the coefficients of one order follow from one set of sums
over the orders before,

    sum_j r_(n-j) x_j    for x = d', d, r d, sin(w t), cos(w t), all u and all v,

which fill the columns of one array and are taken eight columns at a time (``contact.lanes``).  The term with
the newest x_n is added apart: nothing waits for it.  Cost per step: modes times the square of the order.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.flight import tip_state
from contact.lanes import LANES, aligned, next_modes, weighted_rows
from contact.modal_flow import SQUARE, WEIGHT

__all__ = [
    "LANE_ORDER",
    "contact_work",
    "depth_root",
    "lane_arrays",
    "lane_series",
    "lane_state",
    "speed_scale",
]

LANE_ORDER = 20
"""Order of the series in sigma; even."""

SPEED, DEPTH, CUBE, SINE, COSINE = 0, 1, 2, 3, 4
"""Columns of the series before the modes: d', d, r d, sin and cos of the drive."""

ROOT, CLOCK, PUSH, POWERS = 0, 1, 2, 3
"""Rows of the scalar series: r, time since the step's start, r N, and powers of the sigma of a state."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(LANES)
NODE_POWERS = (0.5 * (1.0 + _NODES)) ** np.arange(LANE_ORDER + 1.0)[:, None]
WEIGHTS = 0.5 * _WEIGHTS
"""Gauss's rule on [0, 1], and powers of its nodes.  If the series converges up to sigma = R and the step is
s, its error falls as rho^-16, rho = q + sqrt(q^2 - 1), q = 2 R/s - 1: faster than the (s/R)^p of the
series."""

INVERSE = 1.0 / np.maximum(1.0, np.arange(64.0))
"""1/n."""


@kernel
def lane_arrays(numbers):
    """Room for a step: the series of all columns, the sums, and the scalar series."""
    columns = LANES + 2 * numbers.shape[1]
    return (
        aligned(LANE_ORDER + 1, columns), aligned(1, columns)[0], np.zeros((4, LANE_ORDER + 1))
    )  # fmt: skip


@kernel
def speed_scale(fixed, numbers, u, v):
    """The square root of twice the modal energy, of the deviation and of the steady motion [m kg^0.5/s]."""
    energy, square = fixed.still, numbers[SQUARE]
    for k in range(u.size):
        energy += v[k] * v[k] + square[k] * u[k] * u[k]
    return math.sqrt(energy)


@kernel
def lane_series(fixed, numbers, base, u, v, series, sums, scalars):
    """Fill the Taylor coefficients in sigma of a contact that is at (u, v) at time `base` after the strobe.

    Parameters
    ----------
    fixed : Scalars
        stiffness = k [N/m^1.5], damping = chi [s/m].
    numbers : ndarray, shape (9, m)
        As in ``contact.modal_flow``; m is the number of modes, filled up to a multiple of eight.
    base : float
        [s]
    u, v : ndarray, shape (n_modes,)
    series : ndarray, shape (LANE_ORDER + 1, 8 + 2 m)
        Results, row n holding order n: five scalars, u from column 8 on, v from 8 + m on.
    sums : ndarray, shape (8 + 2 m,)
        Work space.
    scalars : ndarray, shape (4, LANE_ORDER + 1)
        Results: r, time, r N.  On entry scalars[0, 0] holds r, which the caller carries along: computed anew
        from the tip displacement it would lose its digits at shallow depth.
    """
    w, stiffness, chi = fixed.drive, fixed.stiffness, fixed.damping
    r, clock, push = scalars[ROOT], scalars[CLOCK], scalars[PUSH]
    at_v = LANES + numbers.shape[1]
    sine, cosine = math.sin(w * base), math.cos(w * base)
    speed = w * (fixed.sine * cosine - fixed.cosine * sine)
    for k in range(u.size):
        series[0, LANES + k] = u[k]
        series[0, at_v + k] = v[k]
        speed += numbers[WEIGHT, k] * v[k]
    r0 = r[0]
    series[0, SPEED], series[0, DEPTH] = speed, r0 * r0
    series[0, SINE], series[0, COSINE] = sine, cosine
    clock[0] = 0.0
    for n in range(LANE_ORDER):
        rn, inverse = r[n], INVERSE[n + 1]
        weighted_rows(r, n, -1, series, n, sums)
        r[n + 1] = 0.5 * inverse * speed
        clock[n + 1] = inverse * rn
        depth = inverse * (sums[SPEED] + r0 * speed)
        cube = sums[DEPTH] + r0 * series[n, DEPTH]
        series[n, CUBE] = cube
        push[n] = sums[CUBE] + r0 * cube  # r^4 for now
        total = push[n]
        if chi != 0.0:
            for i in range(n + 1):
                total += chi * push[i] * series[n - i, SPEED]
        tip = next_modes(numbers, sums, r0, inverse, rn, stiffness * inverse * total, n, series)
        sine, cosine = (
            w * inverse * (sums[COSINE] + r0 * cosine), -w * inverse * (sums[SINE] + r0 * sine)
        )  # fmt: skip
        speed = w * (fixed.sine * cosine - fixed.cosine * sine) + tip
        series[n + 1, SPEED], series[n + 1, DEPTH] = speed, depth
        series[n + 1, SINE], series[n + 1, COSINE] = sine, cosine
    push[LANE_ORDER] = 0.0
    # r N from r^4
    if chi != 0.0:
        for n in range(LANE_ORDER - 1, -1, -1):
            total = push[n]
            for i in range(n + 1):
                total += chi * push[i] * series[n - i, SPEED]
            push[n] = stiffness * total
    else:
        for n in range(LANE_ORDER):
            push[n] *= stiffness


@kernel
def lane_state(s, series, sums, scalars, u, v):
    """Deviations of all modes at sigma = `s`, in `u` and `v`."""
    powers, power = scalars[POWERS], 1.0
    for n in range(LANE_ORDER + 1):
        powers[n] = power
        power *= s
    weighted_rows(powers, 0, 1, series, LANE_ORDER + 1, sums)
    at_v = LANES + (series.shape[1] - LANES) // 2
    for k in range(u.size):
        u[k] = sums[LANES + k]
        v[k] = sums[at_v + k]


@kernel
def contact_work(s, series, scalars):
    """Work that the tip does on the stop up to sigma = `s`, the integral of r N d' [J]."""
    powers, push = scalars[POWERS], scalars[PUSH]
    force, rate, power = np.empty(LANES), np.empty(LANES), 1.0
    for n in range(LANE_ORDER + 1):
        powers[n] = power * push[n]
        power *= s
    weighted_rows(powers, 0, 1, NODE_POWERS, LANE_ORDER + 1, force)
    power = 1.0
    for n in range(LANE_ORDER + 1):
        powers[n] = power * series[n, SPEED]
        power *= s
    weighted_rows(powers, 0, 1, NODE_POWERS, LANE_ORDER + 1, rate)
    done = 0.0
    for i in range(LANES):
        done += WEIGHTS[i] * s * force[i] * rate[i]
    return done


@kernel
def depth_root(motion, base, u, v):
    """r = sqrt(d) of a contact that is under way at (u, v)."""
    return math.sqrt(max(0.0, tip_state(motion, base, u, v)[0]))
