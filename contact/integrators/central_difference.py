"""Central difference (leapfrog): the explicit method of most impact codes.

    q_{n+1} = q_n + h v_{n+1/2},   v_{n+1/2} = v_{n-1/2} + h ( f_n - c v - phi N(d_n, d'_{n-1/2}) ),
    f_n = g + P sin(w t_n) - omega^2 q_n

with the damping either centred, v = (v_{n-1/2} + v_{n+1/2})/2, solved mode by mode, or lagged, v = v_{n-1/2}.
The motion starts with v_{1/2} = v_0 + (h/2) a_0; the velocity at a grid point is the mean of its neighbours.

Order 2.  Stable in flight for h <= 2/omega with centred and h <= (2/omega)(sqrt(1 + zeta^2) - zeta), zeta =
c/(2 omega), with lagged damping (T. Belytschko, in Belytschko and Hughes, Computational Methods for Transient
Analysis, 1983, ch. 1).  In a lasting contact of stiffness k, stable if and only if h^2 (K + k phi phi^T) <=
4, with lagged damping h^2 (K + k phi phi^T) + 2 h C <= 4, as matrices: the quadratic of a step, (z - 1)^2 +
h c (z - 1) + h^2 kappa z = 0 with c = x*Cx and kappa = x*Kx for lagged damping, has its roots in the unit
disc then, and one at z = -1 at the limit,

    1/k = sum_k phi_k^2 / (4/h^2 - 2 c_k/h - omega_k^2)    (without the term in c_k for centred damping).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.compiled import kernel
from contact.flight.motion import Motion
from contact.integrators.equation import contact_force, tip_of
from contact.integrators.fixed_step import check_step, fixed_step_run
from contact.integrators.grid import DONE, begin_step, end_contact_step
from contact.integrators.method import Integrator
from contact.laws import HERTZ, LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

__all__ = ["CentralDifference"]


@kernel
def push_on(equation, grid, half, i, h, lagged):
    """From v_{n-1/2} to v_{n+1/2} by the force at grid point n = `i` over h [s]; v becomes their mean."""
    q, v = grid.q, grid.v
    swing = math.sin(equation.drive * (equation.clock + i * grid.step))
    depth, rate = tip_of(equation, q, half)
    push = contact_force(equation, depth, rate)
    grid.places[0].evaluations += 1
    for k in range(q.size):
        force = (
            equation.constant[k] + equation.push[k] * swing - equation.stiffness[k] * q[k]
            - equation.phi[k] * push
        )  # fmt: skip
        old, c = half[k], equation.decay[k] * h
        if lagged:
            half[k] = old + h * force - c * old
        else:
            half[k] = ((1.0 - 0.5 * c) * old + h * force) / (1.0 + 0.5 * c)
        v[k] = 0.5 * (old + half[k])


@kernel
def central_difference(equation, grid, half, lagged):
    """March from the grid point reached; `half`, shape (n_modes,), carries v_{n+1/2}."""
    place, h = grid.places[0], grid.step
    if place.evaluations == 0:
        begin_step(grid)
        half[:] = grid.v
        push_on(equation, grid, half, 0, 0.5 * h, True)
        grid.v[:] = grid.v0
    for i in range(place.step, grid.steps):
        begin_step(grid)
        for k in range(half.size):
            grid.q[k] += h * half[k]
        push_on(equation, grid, half, i + 1, h, lagged)
        status = end_contact_step(equation, grid)
        if status != DONE:
            return status
    return DONE


@dataclass(frozen=True, kw_only=True)
class CentralDifference(Integrator):
    """Central difference with a fixed step.

    Parameters
    ----------
    step : float
        Time step [s].
    lagged : bool
        Take the damping at the half step before instead of centring it.
    beyond_limit : bool
        Run even where the step is unstable, for a study of what happens there.
    """

    step: float
    lagged: bool = False
    beyond_limit: bool = False
    name: ClassVar[str] = "central-difference"
    order: ClassVar[float] = 2.0
    laws: ClassVar[tuple[int, ...]] = (LINEAR, HERTZ)
    limit: ClassVar[str] = "h omega_max <= 2, contact closed; 2 (sqrt(1 + zeta^2) - zeta) with lagged damping"
    source: ClassVar[str] = "T. Belytschko, Computational Methods for Transient Analysis (1983), ch. 1"

    def __post_init__(self) -> None:
        check_step(self.step)

    def critical_stiffness(self, motion: Motion) -> float:
        """Contact stiffness at which the highest frequency reaches the limit, below zero if a mode is beyond
        it [N/m]."""
        h = self.step
        squares = 4.0 / h**2 - (2.0 * motion.decay / h if self.lagged else 0.0)
        room = squares - motion.omega**2
        return float(1.0 / np.sum(motion.phi**2 / room)) if np.all(room > 0.0) else -1.0

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`."""
        critical = math.inf if self.beyond_limit else self.critical_stiffness(oscillator.motion())
        half = np.zeros(oscillator.n_modes)
        return fixed_step_run(
            oscillator, run, step=self.step, critical=critical,
            march=lambda equation, grid: central_difference(equation, grid, half, self.lagged),
        )  # fmt: skip
