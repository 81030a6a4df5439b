"""The grid points of a run with a time step, and what is written down between them.

A touch is seen if the penetration is positive at a grid point: whatever lies between two of them is missed,
as the method misses it.  What lies between two grid points is told by the method (`recording`); most take a
mode there for the cubic through its displacements and velocities at both ends of the step,

    q(s) = H00 q0 + H10 h v0 + H01 q1 + H11 h v1,

whose error, h^4/384 q'''', is below their own.  Touch and release are roots of the penetration on it.  Times
count from the strobe before the run's start.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from contact.compiled import inlined, kernel
from contact.integrators.equation import contact_force, contact_tangent, tip_of
from contact.recorder import (
    Recorder,
    add_loss,
    close_touch,
    is_full,
    open_touch,
    put_sample,
    put_strobe,
    sample_due,
)
from contact.trajectory import IMPACT

__all__ = ["DIVERGED", "DONE", "FULL", "PLACE", "TOO_LARGE", "Grid", "begin_step", "end_contact_step",
           "end_step", "passes", "record_times", "recording"]  # fmt: skip

DONE, FULL, TOO_LARGE, DIVERGED = 0, 1, 2, 3
"""How a step or a run ends: well; with a full log; at a contact too stiff for the step; with a motion that is
no longer finite."""

PLACE = np.dtype([("step", "i8"), ("evaluations", "i8"), ("touching", "i8"), ("due", "f8")])
"""Grid point reached; evaluations of the force so far; whether the tip touched there; when the next strobe or
sample is due, since the strobe `first` [s]."""

UNBOUNDED = 1e12
"""Penetration [m] beyond which a motion counts as diverged."""

ON_THE_GRID = 1e-9
"""Part of a step by which a time may miss a grid point and be taken for it."""


class Grid(NamedTuple):
    """A run on its way.

    places : record array of `PLACE`, shape (1,)
    step, clock, period : float
        h, time of the first grid point since the strobe `first`, drive period [s].
    first, steps : int
        Number of the drive period in which the run starts; steps in all.
    critical : float
        Contact stiffness beyond which the run ends [N/m].
    q, v, q0, v0, q_at, v_at : ndarray, shape (n_modes,)
        The modal state that the method carries, now, at the last grid point, and somewhere between.
    recorder : Recorder
    """

    places: np.ndarray
    step: float
    clock: float
    period: float
    first: int
    steps: int
    critical: float
    q: np.ndarray
    v: np.ndarray
    q0: np.ndarray
    v0: np.ndarray
    q_at: np.ndarray
    v_at: np.ndarray
    recorder: Recorder


@inlined
def begin_step(grid):
    """Keep the state at the grid point reached."""
    for k in range(grid.q.size):
        grid.q0[k], grid.v0[k] = grid.q[k], grid.v[k]


@inlined
def passes(grid, count, depth, apart):
    """Whether `count` steps that end with penetration `depth` need no word; they are then behind the run.

    `apart` tells that the stop has not acted in them.
    """
    place = grid.places[0]
    end = grid.clock + (place.step + count) * grid.step
    quiet = apart and place.touching == 0 and abs(depth) < UNBOUNDED
    if quiet and end + ON_THE_GRID * grid.step < place.due:
        place.step += count
        return True
    return False


@kernel
def cubic_between(equation, grid, x, h, acting):
    """The state at the fraction `x` of a step of length h: penetration and its rate; (q, v) in q_at, v_at."""
    z = 1.0 - x
    for k in range(grid.q.size):
        rise = grid.q[k] - grid.q0[k]
        a, b = h * grid.v0[k] - rise, h * grid.v[k] - rise
        grid.q_at[k] = z * grid.q0[k] + x * grid.q[k] + x * z * (z * a - x * b)
        grid.v_at[k] = (rise + (1.0 - 2.0 * x) * (z * a - x * b) - x * z * (a + b)) / h
    return tip_of(equation, grid.q_at, grid.v_at)


def recording(between: Callable[..., Any]) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The end of a step under a force law, and the strobes and samples in one, for a method's own `between`.

    between(numbers, grid, x, h, acting) puts the state at the fraction x of the step just made, of length h,
    into q_at and v_at, and returns penetration and its rate; at a touch the force is not `acting` yet.
    """

    @inlined
    def crossing(numbers, grid, h, depth0, depth1):  # type: ignore[no-untyped-def]
        """Where in the step the penetration, of opposite signs at both ends, vanishes; and its rate there.

        Regula falsi with halved end values (M. Dowell, P. Jarratt, BIT 11 (1971) 168), bisection every third
        time.
        """
        low, high, at_low, at_high, x, rate, side = 0.0, 1.0, depth0, depth1, 0.5, 0.0, 0
        for i in range(100):
            x = 0.5 * (low + high) if i % 3 == 2 else (low * at_high - high * at_low) / (at_high - at_low)
            if not low < x < high:
                x = 0.5 * (low + high)
            depth, rate = between(numbers, grid, x, h, False)
            if depth == 0.0 or high - low <= 1e-14:
                break
            if (depth > 0.0) == (at_high > 0.0):
                high, at_high = x, depth
                at_low *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                low, at_low = x, depth
                at_high *= 0.5 if side == -1 else 1.0
                side = -1
        return x, rate

    @inlined
    def record_times(numbers, grid, start, h):  # type: ignore[no-untyped-def]
        """Strobes and samples up to the end of a step of length h that began at the clock `start`."""
        recorder = grid.recorder
        marks, slack = recorder.marks[0], ON_THE_GRID * h
        while True:
            samples, strobe = sample_due(recorder, grid.first, start + h + slack), math.inf
            more = marks.sampled < recorder.sample_clock.size
            if marks.strobed < recorder.counts.size:
                strobe = (marks.strobed + 1) * grid.period
            if samples and recorder.sample_clock[marks.sampled] <= strobe:
                time = recorder.sample_clock[marks.sampled]
            elif strobe <= start + h + slack:
                time, samples = strobe, False
            else:
                grid.places[0].due = min(strobe, recorder.sample_clock[marks.sampled] if more else math.inf)
                return
            x = max(0.0, (time - start) / h)
            between(numbers, grid, 1.0 if x > 1.0 - ON_THE_GRID else x, h, True)
            if samples:
                put_sample(recorder, grid.q_at, grid.v_at)
            else:
                put_strobe(recorder, grid.q_at, grid.v_at)

    @inlined
    def record_step(numbers, grid, count, depths, taken, met):  # type: ignore[no-untyped-def]
        """The end of `count` steps at once under a force law, between the penetrations `depths`.

        `taken` is the energy that the stop has taken in a step [J], `met` whether the tip has met it within.
        """
        depth0, depth1 = depths
        recorder, h = grid.recorder, count * grid.step
        start = grid.clock + grid.places[0].step * grid.step
        touching = recorder.marks[0].touching == 1
        opens = not touching and (depth1 > 0.0 or met)
        closes = depth1 <= 0.0 and (touching or opens)
        x = rate = 0.0
        if opens or closes:
            # a touch that begins and ends between two grid points lasts the whole step
            if (depth0 > 0.0) != (depth1 > 0.0):
                x, rate = crossing(numbers, grid, h, depth0, depth1)
            else:
                _depth, rate = between(numbers, grid, 0.0, h, False)
        if opens:
            open_touch(recorder, grid.first, start + x * h, rate, IMPACT, grid.q_at, grid.v_at)
        if touching or opens:
            add_loss(recorder, taken)
        if closes:
            if opens:
                x = 1.0
                _depth, rate = between(numbers, grid, x, h, True)
            close_touch(recorder, grid.first, start + x * h, rate, grid.q_at, grid.v_at)
        record_times(numbers, grid, start, h)
        return end_step(numbers, grid, count, depth1)

    return record_step, record_times


@kernel
def end_step(numbers, grid, count, depth):
    """Go on to the grid point `count` further; DONE, or why the run has to leave the loop there."""
    grid.places[0].step += count
    grid.places[0].touching = grid.recorder.marks[0].touching
    if not abs(depth) < UNBOUNDED:
        return DIVERGED
    stiffness, _damping = contact_tangent(numbers, depth, 0.0)
    if stiffness > grid.critical:
        return TOO_LARGE
    return FULL if is_full(grid.recorder) else DONE


_record_contact, record_times = recording(cubic_between)


@kernel
def end_contact_step(equation, grid):
    """The end of a step under a force law, the state between its ends on the cubic."""
    d0, r0 = tip_of(equation, grid.q0, grid.v0)
    d1, r1 = tip_of(equation, grid.q, grid.v)
    power = r0 * contact_force(equation, d0, r0) + r1 * contact_force(equation, d1, r1)
    return _record_contact(equation, grid, 1, (d0, d1), 0.5 * grid.step * power, False)

