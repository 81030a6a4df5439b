r"""A scan of the drive amplitude as one compiled loop: settle, tell the period, carry the state on.

At each amplitude of a column the motion starts from the physical state (q, q') in which the amplitude before
has left it, and is followed in blocks of `BLOCK` drive periods until it is known, at most for `most_cycles`:

- **No impact any more.**  The free motion left over can only shrink (``contact.flight``), so that with

      |x_steady| + sum_k |phi_k| sqrt(u_k^2 + (u_k'/omega_k)^2)  <  gap

  the tip never meets the stop again: period 1 without impacts, and the state is set on the steady motion.
- **A periodic orbit** of period p <= L, for L = 16, 32, 64 as soon as 2 L strobes are there: all coordinates
  phi_k u_k and phi_k u_k'/omega_k of the last L strobes repeat those p before to `TOLERANCE` of the gap and
  the impacts of each period repeat exactly.  This is `contact.orbits.period_of` with `largest_period` L on
  the last 2 L strobes; the next state follows from the last one alone, so that one whole period that repeats
  is all that can be asked, and short periods need not wait for the longest.
- **Nearly periodic at the bound.**  Next to a fold the motion comes to rest on its orbit as slowly as one
  likes.  After `most_cycles` a repetition to `ROUGH` of the gap is taken for the period too; such cells have
  cycles >= most_cycles in the store.
- Otherwise **period 0**: chaos, a period above 64, or a transient longer than `most_cycles`.  Its impacts are
  those of the last 128 strobes.

The amplitude enters the motion linearly, so that the loop scales the steady motion at grazing.  The state
is carried as (q, q') from amplitude to amplitude, so that a column may be cut after any.  One mode under
Newton's law is carried by its own loop (``contact.integrators.single_mode_loop``), everything else by
``event_loop``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contact.compiled import kernel
from contact.event_loop import DONE, STATE
from contact.flight.modal_flow import tip_rounding, tip_state
from contact.flight.motion import OMEGA, WEIGHT
from contact.strobed_motion import at_amplitude, strobed_motion
from contact.trajectory import OUTSIDE

__all__ = ["BEHIND", "EXTRA", "LARGEST_PERIOD", "repetition", "settled_column"]

LARGEST_PERIOD = 64
"""Longest period told, as in the other studies."""

SHORTEST = 16
"""Strobes that have to repeat at least: a quarter of LARGEST_PERIOD, twice the letter's common periods."""

ROUGH = 1e4
"""Tolerance at the bound over the usual one, i.e. 1e-5 of the gap: after 512 drive periods an orbit of period
3 whose multiplier is 0.97 still changes by 1e-6 per period."""

BLOCK = 32
"""Drive periods between two looks: the least that tells a period, 2 SHORTEST."""

BEHIND = -1
"""Status of a state that the amplitude before has left behind the stop, where no flight can start."""

EXTRA = 3
"""Numbers of a state beside (q, q'): regime, wait, rebound."""


@kernel
def repetition(points: Any, impacts: Any, rows: Any, stretch: Any, tolerance: Any) -> Any:
    """The smallest p <= `stretch` with which the last `stretch` of `rows` strobes repeat, or 0.

    Parameters
    ----------
    points : ndarray, shape (capacity, n_coordinates)
    impacts : ndarray of int, shape (capacity,)
    rows : int
        Rows in use, at least 2 `stretch`.
    """
    for period in range(1, stretch + 1):
        same = True
        i = rows - 1
        while same and i >= rows - stretch:
            same = impacts[i] == impacts[i - period]
            for k in range(points.shape[1]):
                if not abs(points[i, k] - points[i - period, k]) <= tolerance:
                    same = False
            i -= 1
        if same:
            return period
    return 0


@kernel
def returns(points: Any, rows: Any, tolerance: Any) -> Any:
    """Whether a strobe before the last of `rows` is as close to it as a repetition asks for."""
    close = 0
    last = points[rows - 1, 0]
    for i in range(max(0, rows - 1 - LARGEST_PERIOD), rows - 1):
        close += 1 if abs(points[i, 0] - last) <= tolerance else 0
    return close > 0


@kernel
def free_for_good(motion: Any, u: Any, v: Any) -> Any:
    """Whether the free motion left over can never bring the tip to the stop."""
    left = math.hypot(motion.tip_sine, motion.tip_cosine)
    for k in range(motion.size):
        if not motion.modes[OMEGA, k] > 0.0:
            return False
        left += abs(motion.modes[WEIGHT, k]) * math.hypot(u[k], v[k] / motion.modes[OMEGA, k])
    return left < -motion.level * (1.0 - 1e-12)


@kernel
def settled_column(
    system: Any, amplitudes: Any, state: Any, most_cycles: Any, tolerance: Any, ends: Any, found: Any,
    place: Any,
) -> Any:  # fmt: skip
    """Settle at each of `amplitudes` in turn, or until one fails.

    Parameters
    ----------
    system : StrobedSystem
        At grazing.
    amplitudes : ndarray, shape (n,)
        Base amplitudes over that at grazing [1].
    state : ndarray, shape (2 n_modes + 3,)
        Start; overwritten by the last state that was reached.
    most_cycles : int
    tolerance : float
        Of a repetition, in the unit of the coordinates [m].
    ends, found : ndarray, shapes (n, 2 n_modes + 3) and (n, 3) of int
        States; period, impacts and drive periods spent; overwritten.
    place : ndarray, shape (2 n_modes + 2,)
        Deviations, drive period and time since its strobe where a failure happened; overwritten.

    Returns
    -------
    done, status : int
        Amplitudes done; DONE, or why the next one failed.
    """
    n = system.motion.size
    capacity = 2 * LARGEST_PERIOD
    points, impacts = np.empty((capacity, 2 * n)), np.zeros(capacity, dtype=np.int64)
    strobes, counts = np.empty((BLOCK, 2 * n)), np.zeros(BLOCK, dtype=np.int64)
    u, v = np.empty(n), np.empty(n)
    for a in range(amplitudes.size):
        local = at_amplitude(system, amplitudes[a])
        here, mean = local.motion, local.mean.copy()
        local.mean[:] = 0.0  # the points are those of the deviations
        for k in range(n):
            u[k] = state[k] - mean[k]
            v[k] = state[n + k] - mean[n + k]
        runs = np.zeros(1, dtype=STATE)
        run = runs[0]
        run.regime, run.wait, run.rebound = int(state[2 * n]), state[2 * n + 1], state[2 * n + 2]
        run.root, run.speed = -1.0, -1.0
        rows, cycles, period, hits = 0, np.int64(0), 0, 0
        status, known = DONE, False
        height, _velocity, _acceleration = tip_state(here, 0.0, u, v)
        if run.regime == OUTSIDE and height > tip_rounding(here, u, v):
            status = BEHIND
        while status == DONE and not known:
            if run.regime == OUTSIDE and free_for_good(here, u, v):
                for k in range(n):
                    u[k], v[k] = 0.0, 0.0
                period, hits, known = 1, 0, True
                break
            if cycles >= most_cycles:
                period = repetition(points, impacts, rows, np.int64(LARGEST_PERIOD), ROUGH * tolerance)
                for i in range(rows - period if period > 0 else 0, rows):
                    hits += impacts[i]
                break
            status = strobed_motion(local, u, v, runs, strobes, counts)
            if status != DONE:
                break
            cycles += BLOCK
            if rows == capacity:
                for i in range(capacity - BLOCK):
                    impacts[i] = impacts[i + BLOCK]
                    for k in range(2 * n):
                        points[i, k] = points[i + BLOCK, k]
                rows -= BLOCK
            for i in range(BLOCK):
                impacts[rows + i] = counts[i]
                for k in range(2 * n):
                    points[rows + i, k] = strobes[i, k]
            rows += BLOCK
            stretch = np.int64(SHORTEST)
            back = returns(points, rows, tolerance)
            while back and not known and 2 * stretch <= rows:
                period = repetition(points, impacts, rows, stretch, tolerance)
                known = period > 0
                stretch *= 2
            if known:
                for i in range(rows - period, rows):
                    hits += impacts[i]
        if status != DONE:
            for k in range(n):
                place[k], place[n + k] = u[k], v[k]
            place[2 * n], place[2 * n + 1] = run.period, run.clock
            return a, status
        for k in range(n):
            state[k] = u[k] + mean[k]
            state[n + k] = v[k] + mean[n + k]
        state[2 * n], state[2 * n + 1], state[2 * n + 2] = run.regime, run.wait, run.rebound
        for k in range(2 * n + EXTRA):
            ends[a, k] = state[k]
        found[a, 0], found[a, 1], found[a, 2] = period, hits, cycles
    return amplitudes.size, DONE
