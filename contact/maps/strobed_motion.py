"""The motion from strobe to strobe as compiled code, for any oscillator.

One mode under Newton's law has a loop of its own (``contact.one_mode.loop``), which proves most periods
free without a sine; everything else goes through ``event_loop.advance``.  The strobes of both agree within
rounding.

A point holds phi_k q_k and phi_k q_k'/omega_k of all modes, contributions to the tip motion [m].  A mode of
zero frequency has phi_k q_k'/(2 pi f) instead, and a mode with its node at the tip has the largest phi.
"""

from typing import NamedTuple

import numpy as np

from contact.engine.event_loop import DONE, advance
from contact.engine.recorder import strobes_only
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import COSINE, OFFSET, SINE, Numbers, with_drive
from contact.machine.compiled import inlined, kernel
from contact.one_mode.loop import one_mode_periods
from contact.one_mode.period_table import PeriodTable, period_table, table_at
from contact.oscillator import ImpactOscillator


class StrobedSystem(NamedTuple):
    """The numbers of an oscillator for the loops over its drive periods."""

    numbers: Numbers
    table: PeriodTable | None  # of one mode under Newton's law; None for any other oscillator
    mean: np.ndarray  # steady displacements and velocities at a strobe, shape (2 n_modes,)
    weight: np.ndarray  # factors by which the points multiply displacements and velocities, (2 n_modes,)


def strobed_system(oscillator: ImpactOscillator) -> StrobedSystem:
    """The numbers of an oscillator, made once for many orbits."""
    numbers = oscillator.numbers()
    phi = np.where(numbers.phi != 0, numbers.phi, np.abs(numbers.phi).max())
    slow = numbers.drive or 1.0
    return StrobedSystem(
        numbers=numbers,
        table=period_table(numbers),
        mean=np.concatenate(steady_motion(numbers, 0.0)),
        weight=np.concatenate([phi, phi / np.where(numbers.omega > 0, numbers.omega, slow)]),
    )


@kernel
def at_amplitude(system, factor):
    """The system at `factor` times its own base amplitude."""
    numbers, n = with_drive(system.numbers, factor), system.numbers.size
    mean = np.empty(2 * n)
    for k in range(n):
        mean[k] = numbers.modes[OFFSET, k] + numbers.modes[COSINE, k]
        mean[n + k] = numbers.drive * numbers.modes[SINE, k]
    return StrobedSystem(numbers, table_at(system.table, system.numbers, factor), mean, system.weight)


@kernel
def strobed_motion(table, system, factors, u, v, runs, points, counts):
    """Advance the deviation (u, v) from a strobe by as many drive periods as `counts` has places.

    Parameters
    ----------
    table, system : PeriodTable or None, StrobedSystem
        The type of the system's table selects the loop; the other loop is not compiled.
    factors : ndarray, shape (periods,) or (0,)
        The amplitude of each period over that of the system [1]; an empty array leaves it as it is.  The
        physical state is continuous at the strobe where the amplitude changes, so that (u, v) jumps.
    u, v : ndarray, shape (n_modes,)
        Deviation from the steady motion of the system, before and after; overwritten.
    runs : record array of ``contact.touch.passage.STATE``, shape (1,)
        State of the run; overwritten.
    points, counts : ndarray, shapes (periods, 2 n_modes) and (periods,)
        Filled with the points and with the impacts of each period.

    Returns the status of ``event_loop.advance``. After a failure (u, v) counts from the steady motion of that
    period.
    """
    if table is None:
        return any_periods(system, factors, u, v, runs, points, counts)
    else:
        return one_mode_periods(table, system, factors, u, v, runs, points, counts)[0]


@kernel
def any_periods(system, factors, u, v, runs, points, counts):
    """`strobed_motion` of an oscillator without a table."""
    local, run, status, factor, at = system, runs[0], DONE, 1.0, 0
    while at < counts.size and status == DONE:
        end = counts.size
        if factors.size > 0:
            end = at + 1
            while end < counts.size and factors[end] == factors[at]:
                end += 1
            add_steady(system.numbers, factor - factors[at], u, v)
            factor, run.memory0, run.memory1 = factors[at], -1.0, -1.0
            local = at_amplitude(system, factor)
        recorder = strobes_only(points[at:end], counts[at:end])
        status = advance(local.numbers, u, v, runs, run.stretch + end - at, 0.0, recorder, None, None)
        for i in range(at, end):
            for k in range(points.shape[1]):
                points[i, k] = (points[i, k] + local.mean[k]) * system.weight[k]
        at = end
    if status == DONE:
        add_steady(system.numbers, factor - 1.0, u, v)
    return status


@inlined
def add_steady(numbers, factor, u, v):
    """Add `factor` times the driven part of the steady motion at a strobe to (u, v)."""
    if factor != 0.0:
        for k in range(numbers.size):
            u[k] += factor * numbers.modes[COSINE, k]
            v[k] += factor * numbers.drive * numbers.modes[SINE, k]
