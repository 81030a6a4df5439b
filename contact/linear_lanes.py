"""Contact under a linear law, and stays on or behind the wall, all modes side by side.

The power series in time of ``contact.series``,

    u[n+2] = ( g - c (n+1) u[n+1] - omega^2 u[n] - phi N[n] ) / ((n+1)(n+2))      (g for n = 0 only),

with the modes in columns that are filled eight at a time (``contact.lanes``): cost per step, modes times the
order.  The order is chosen such that a step takes some three radians of the fastest mode.  Terms then reach
e^3 times the sum, which costs a digit in a mode that fast and nothing in the others; a higher order would
take longer steps for less work and lose more.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.flight import EPS
from contact.lanes import aligned, next_order, weighted_rows
from contact.modal_flow import SQUARE, WEIGHT
from contact.series import INSIDE, SUSTAINED

__all__ = ["LINEAR_ORDER", "linear_arrays", "linear_series", "linear_state", "linear_step", "linear_work"]

LINEAR_ORDER = 30
"""Order of the series in time."""

DEPTH, FORCE, POWERS, SLOPES = 0, 1, 2, 3
"""Rows of the scalar series: d, N, powers of the time of a state and their slopes."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
NODE_POWERS = (0.5 * (1.0 + _NODES)) ** np.arange(LINEAR_ORDER + 1.0)[:, None]
WEIGHTS = 0.5 * _WEIGHTS
"""Gauss's rule on [0, 1]: for N d', which turns by some six radians in a step, its error is below 1e-20."""


@kernel
def linear_arrays(numbers):
    """Room for a step: the series of all modes, sums over it, and the scalar series."""
    m = numbers.shape[1]
    return aligned(LINEAR_ORDER + 1, m), aligned(1, m)[0], np.zeros((4, LINEAR_ORDER + 1))


@kernel
def linear_series(fixed, numbers, regime, base, u, v, series, scalars):
    """Fill the coefficients of the modes, the penetration and the contact force.

    Parameters
    ----------
    fixed : Scalars
        stiffness = k [N/m], damping = c [N s/m].
    numbers : ndarray, shape (9, m)
        As in ``contact.modal_flow``.
    regime : int
        CONTACT (linear law), INSIDE (no force; N then holds k d + c d') or SUSTAINED.
    base : float
        Time since the strobe [s].
    u, v : ndarray, shape (n_modes,)
        Deviations at the start.
    series : ndarray, shape (LINEAR_ORDER + 1, m)
    scalars : ndarray, shape (4, LINEAR_ORDER + 1)
        Results: d and N; the last two coefficients of N are left zero.
    """
    w, depth, force = fixed.drive, scalars[DEPTH], scalars[FORCE]
    s, c = math.sin(w * base), math.cos(w * base)
    x0 = fixed.sine * s + fixed.cosine * c
    x1 = w * (fixed.sine * c - fixed.cosine * s)
    depth[0], depth[1] = fixed.level + x0, x1
    for k in range(u.size):
        series[0, k] = u[k]
        series[1, k] = v[k]
        depth[0] += numbers[WEIGHT, k] * u[k]
        depth[1] += numbers[WEIGHT, k] * v[k]
    for n in range(LINEAR_ORDER - 1):
        divisor = (n + 1.0) * (n + 2.0)
        scale, lift = 1.0 / divisor, 1.0 if n == 0 else 0.0
        x2 = -w * w * x0 * scale
        if regime == SUSTAINED:
            # the force that keeps the tip where it is, d'' = 0
            free = next_order(numbers, n + 1.0, scale, 0.0, lift, n, series)
            force[n] = divisor * (x2 + free) / fixed.compliance
        else:
            force[n] = fixed.stiffness * depth[n] + fixed.damping * (n + 1.0) * depth[n + 1]
        push = 0.0 if regime == INSIDE else force[n]
        depth[n + 2] = x2 + next_order(numbers, n + 1.0, scale, push, lift, n, series)
        x0, x1 = x1, x2
    force[LINEAR_ORDER - 1] = 0.0
    force[LINEAR_ORDER] = 0.0


@kernel
def largest(row):
    """The largest absolute value of a row."""
    a, b = 0.0, 0.0
    for k in range(0, row.size, 2):
        a, b = max(a, abs(row[k])), max(b, abs(row[k + 1]))
    return max(a, b)


@kernel
def linear_step(fixed, numbers, stored, u, v, series):
    """Longest time over which the neglected terms stay below rounding [s].

    `stored` is what the stop holds at the start of the step, k d^2 [J].
    """
    energy, square = fixed.still + stored, numbers[SQUARE]
    for k in range(u.size):
        energy += v[k] * v[k] + square[k] * u[k] * u[k]
    top, below = largest(series[LINEAR_ORDER]), largest(series[LINEAR_ORDER - 1])
    speed = 0.1 * EPS * math.sqrt(energy)
    h = fixed.period
    if top > 0.0:
        h = min(h, (speed / (LINEAR_ORDER * top)) ** (1.0 / (LINEAR_ORDER - 1)))
    if below > 0.0:
        h = min(h, (speed / ((LINEAR_ORDER - 1.0) * below)) ** (1.0 / (LINEAR_ORDER - 2)))
    return h


@kernel
def linear_state(h, series, sums, scalars, u, v):
    """Deviations of all modes a time `h` [s] into the step, in `u` and `v`."""
    powers, slopes, power = scalars[POWERS], scalars[SLOPES], 1.0
    slopes[0] = 0.0
    for n in range(LINEAR_ORDER):
        powers[n] = power
        slopes[n + 1] = (n + 1.0) * power
        power *= h
    powers[LINEAR_ORDER] = power
    weighted_rows(powers, 0, 1, series, LINEAR_ORDER + 1, sums)
    for k in range(u.size):
        u[k] = sums[k]
    weighted_rows(slopes, 0, 1, series, LINEAR_ORDER + 1, sums)
    for k in range(u.size):
        v[k] = sums[k]


@kernel
def linear_work(h, scalars):
    """Work that the tip does on the stop during the step, the integral of N d' [J]."""
    depth, powers, rate_powers, power = scalars[DEPTH], scalars[POWERS], scalars[SLOPES], 1.0
    force, rate = np.empty(WEIGHTS.size), np.empty(WEIGHTS.size)
    for n in range(LINEAR_ORDER):
        powers[n] = power * scalars[FORCE, n]
        rate_powers[n] = power * (n + 1.0) * depth[n + 1]
        power *= h
    weighted_rows(powers, 0, 1, NODE_POWERS, LINEAR_ORDER, force)
    weighted_rows(rate_powers, 0, 1, NODE_POWERS, LINEAR_ORDER, rate)
    done = 0.0
    for i in range(WEIGHTS.size):
        done += WEIGHTS[i] * h * force[i] * rate[i]
    return done
