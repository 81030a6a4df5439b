"""What a run with a time step writes down: impacts, strobes and samples between its grid points.

Between two grid points a step h apart a mode is the cubic through its displacements and velocities there,

    q(s) = H00 q0 + H10 h v0 + H01 q1 + H11 h v1,

whose error, h^4/384 q'''', is below that of the methods that use it.  A touch is seen if the penetration is
positive at a grid point: whatever lies between two of them is missed, as the method misses it.  Times s count
from the start of the run.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.integrators.equation import contact_force, tip_of

__all__ = ["DIVERGED", "FINISHED", "FULL", "TOO_LARGE", "Grid", "record_impulse", "record_step"]

FINISHED, FULL, TOO_LARGE, DIVERGED = 0, 1, 2, 3
"""How a march ends: at the end of the run; because the log is full; at a contact too stiff for the step; with
a motion that is no longer finite."""

STEP, LOGGED, SAMPLED, STROBED, COUNT, TOUCHING, EVALUATIONS = 0, 1, 2, 3, 4, 5, 6
START, END, IN, OUT, LOST = 0, 1, 2, 3, 4
GRID_FIELDS = 5
UNBOUNDED = 1e12
"""Penetration [m] beyond which a motion counts as diverged."""


class Grid(NamedTuple):
    """Where a march writes.

    Parameters
    ----------
    integers : ndarray of int64, shape (7,)
        Step reached, rows logged, samples and strobes taken, impacts since the last strobe, whether the tip
        touches, evaluations.
    log, log_state : ndarray, shapes (capacity, 5) and (capacity, 4 n_modes)
        Touches: start, end, both tip velocities, energy lost; modal states (q, v) at both ends.
    strobe, strobes, counts : ndarray, shapes (n_strobes,), (n_strobes, 2 n_modes), (n_strobes,)
    sample, samples : ndarray, shapes (n_times,), (n_times, 2 n_modes)
        Times wanted [s], and the states there.
    """

    integers: np.ndarray
    log: np.ndarray
    log_state: np.ndarray
    strobe: np.ndarray
    strobes: np.ndarray
    counts: np.ndarray
    sample: np.ndarray
    samples: np.ndarray


@kernel
def cubic(x, h, y0, r0, y1, r1):
    """Value and rate at the fraction `x` of a step of the cubic with values `y` and rates `r` at its ends."""
    z = 1.0 - x
    rise = y1 - y0
    value = z * y0 + x * y1 + x * z * (z * (h * r0 - rise) - x * (h * r1 - rise))
    a, b = h * r0 - rise, h * r1 - rise
    rate = (rise + (1.0 - 2.0 * x) * (z * a - x * b) - x * z * (a + b)) / h
    return value, rate


@kernel
def crossing_of(h, d0, r0, d1, r1):
    """Fraction of the step at which the cubic changes sign, by bisection; the ends have opposite signs."""
    low, high = 0.0, 1.0
    for _ in range(60):
        x = 0.5 * (low + high)
        d, _rate = cubic(x, h, d0, r0, d1, r1)
        if (d > 0.0) == (d1 > 0.0):
            high = x
        else:
            low = x
    return high


@kernel
def state_between(x, h, q0, v0, q1, v1, row, at):
    """Put the state at the fraction `x` of a step into `row` from column `at` on."""
    n = q0.size
    for k in range(n):
        row[at + k], row[at + n + k] = cubic(x, h, q0[k], v0[k], q1[k], v1[k])


@kernel
def open_touch(grid, s, rate):
    """A new row of the log, its state still to be filled; returns its number."""
    i = grid.integers[LOGGED]
    grid.integers[LOGGED] += 1
    grid.integers[COUNT] += 1
    grid.integers[TOUCHING] = 1
    grid.log[i, START] = s
    grid.log[i, END] = np.nan
    grid.log[i, IN] = rate
    grid.log[i, OUT] = np.nan
    grid.log[i, LOST] = 0.0
    for k in range(grid.log_state.shape[1] // 2, grid.log_state.shape[1]):
        grid.log_state[i, k] = np.nan
    return i


@kernel
def record_times(grid, s0, h, q0, v0, q1, v1):
    """Strobes and samples in (s0, s0 + h]."""
    slack = 1e-9 * h
    while (
        grid.integers[SAMPLED] < grid.sample.size and grid.sample[grid.integers[SAMPLED]] <= s0 + h + slack
    ):
        i = grid.integers[SAMPLED]
        x = min(1.0, max(0.0, (grid.sample[i] - s0) / h))
        if x > 1.0 - 1e-9:
            x = 1.0
        state_between(x, h, q0, v0, q1, v1, grid.samples[i], 0)
        grid.integers[SAMPLED] += 1
    while (
        grid.integers[STROBED] < grid.strobe.size and grid.strobe[grid.integers[STROBED]] <= s0 + h + slack
    ):
        i = grid.integers[STROBED]
        x = min(1.0, max(0.0, (grid.strobe[i] - s0) / h))
        if x > 1.0 - 1e-9:
            x = 1.0
        state_between(x, h, q0, v0, q1, v1, grid.strobes[i], 0)
        grid.counts[i] = grid.integers[COUNT]
        grid.integers[COUNT] = 0
        grid.integers[STROBED] += 1


@kernel
def record_step(equation, grid, s0, h, q0, v0, q1, v1):
    """Write down what happened under a force law in the step from (q0, v0) at `s0` to (q1, v1).

    Returns the penetration at its end.
    """
    d0, r0 = tip_of(equation, q0, v0)
    d1, r1 = tip_of(equation, q1, v1)
    n = q0.size
    if grid.integers[TOUCHING] == 0 and d1 > 0.0:
        x = crossing_of(h, d0, r0, d1, r1)
        _d, rate = cubic(x, h, d0, r0, d1, r1)
        i = open_touch(grid, s0 + x * h, rate)
        state_between(x, h, q0, v0, q1, v1, grid.log_state[i], 0)
    if grid.integers[TOUCHING] == 1:
        i = grid.integers[LOGGED] - 1
        grid.log[i, LOST] += (
            0.5 * h * (r0 * contact_force(equation, d0, r0) + r1 * contact_force(equation, d1, r1))
        )
        if d1 <= 0.0:
            x = crossing_of(h, d0, r0, d1, r1)
            _d, rate = cubic(x, h, d0, r0, d1, r1)
            grid.log[i, END] = s0 + x * h
            grid.log[i, OUT] = rate
            state_between(x, h, q0, v0, q1, v1, grid.log_state[i], 2 * n)
            grid.integers[TOUCHING] = 0
    record_times(grid, s0, h, q0, v0, q1, v1)
    return d1


@kernel
def record_impulse(equation, grid, s, q, v_before, v_after):
    """Write down that the stop has acted at `s`, in a method whose impacts are jumps of the velocity there.

    One touch lasts as long as the stop acts at every grid point.
    """
    n = q.size
    _d, before = tip_of(equation, q, v_before)
    _d, after = tip_of(equation, q, v_after)
    if grid.integers[TOUCHING] == 0:
        i = open_touch(grid, s, before)
        for k in range(n):
            grid.log_state[i, k], grid.log_state[i, n + k] = q[k], v_before[k]
    i = grid.integers[LOGGED] - 1
    grid.log[i, END] = s
    grid.log[i, OUT] = after
    grid.log[i, LOST] += 0.5 * (before - after) * (before + after) / equation.compliance
    for k in range(n):
        grid.log_state[i, 2 * n + k], grid.log_state[i, 3 * n + k] = q[k], v_after[k]
