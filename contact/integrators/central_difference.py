"""Central difference (leapfrog): the explicit method of most impact codes.

    q_{n+1} = q_n + h v_{n+1/2},   v_{n+1/2} = v_{n-1/2} + h ( f_n - c v - phi N(d_n, d'_{n-1/2}) ),
    f_n = g + P sin(w t_n) - omega^2 q_n

with the damping either centred, v = (v_{n-1/2} + v_{n+1/2})/2, solved mode by mode, or lagged, v = v_{n-1/2}.
The motion starts with v_{1/2} = v_0 + (h/2) a_0; the velocity at a grid point is the mean of its neighbours.
Order 2.  A lasting contact is stable up to the stiffness k with

    1/k = sum_k phi_k^2 / (4/h^2 - 2 c_k/h - omega_k^2)    (without the term in c_k for centred damping)

(T. Belytschko, in Belytschko and Hughes, Computational Methods for Transient Analysis, 1983, ch. 1).
Derivation: ``docs/theory/steps.md``.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from beam.record import record
from contact.flight.numbers import DECAY, Numbers
from contact.flight.tip import push_on
from contact.integrators.fixed_step import FixedStep, stiffness_at
from contact.integrators.grid import (
    DONE,
    Grid,
    accelerations,
    contact_force,
    end_contact_step,
    force_in_flight,
    tip_of,
)
from contact.machine.compiled import kernel


@kernel
def central_difference(grid, memory):
    """Steps from the grid point reached; memory: v_{n+1/2}, shape (n_modes,), and whether damping lags."""
    half, lagged = memory
    progress, h, q, v, numbers = grid.progress[0], grid.step, grid.q, grid.v, grid.numbers
    while progress.step < grid.steps:
        for k in range(q.size):
            q[k] += h * half[k]
        sine = math.sin(numbers.drive * (grid.clock + (progress.step + 1) * h))
        depth, rate = tip_of(numbers, q, half)
        push = contact_force(numbers, depth, rate)
        for k in range(q.size):
            old = half[k]
            new = old + h * (force_in_flight(grid, k, sine, q, half) + push_on(numbers, k, push))
            if not lagged:
                c = 0.5 * h * numbers.modes[DECAY, k]
                new = (new + c * old) / (1.0 + c)
            half[k], v[k] = new, 0.5 * (old + new)
        status = end_contact_step(grid, None, 1, depth, depth < 0.0, None)
        if status != DONE:
            return status
    return DONE


@record(eq=True)
class CentralDifference(FixedStep):
    """Central difference with a fixed step, for contact forces.

    Parameters
    ----------
    step : float
        Time step, above zero [s].
    beyond_limit : bool
        Whether to run even where the step is unstable, to study what happens there.
    lagged : bool
        Whether the damping takes the velocity of the half step before instead of the mean of both.

    Raises
    ------
    ValueError
        If the step is no finite number above zero.
    """

    lagged: bool = False
    name: ClassVar[str] = "central-difference"
    order: ClassVar[float] = 2.0
    time_loop: ClassVar[Callable[..., int]] = staticmethod(central_difference)

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Contact stiffness at which the highest frequency reaches the limit [N/m]; below zero if a mode is
        beyond the limit."""
        lag = 2.0 * numbers.decay / self.step if self.lagged else 0.0
        return stiffness_at(numbers, 4.0 / self.step**2 - lag)

    def prepare(self, grid: Grid) -> tuple[np.ndarray, bool]:
        """v_{1/2}, and whether damping lags."""
        return grid.v + 0.5 * self.step * accelerations(grid), self.lagged
