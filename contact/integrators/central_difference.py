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
from contact.integrators.equation import contact_force, contact_tangent, tip_of
from contact.integrators.grid import (
    DIVERGED,
    EVALUATIONS,
    FINISHED,
    FULL,
    LOGGED,
    STEP,
    TOO_LARGE,
    UNBOUNDED,
    record_step,
)
from contact.integrators.grid_run import check_step, grid_trajectory
from contact.integrators.method import Integrator, Run
from contact.laws import HERTZ, LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory

__all__ = ["CentralDifference"]


@kernel
def central_difference(equation, grid, q, v, carried, steps, h, lagged, critical):
    """March from the step reached to `steps`; `carried`, shape (3, n_modes), holds v_{n-1/2} in row 0."""
    n = q.size
    half, q0, v0 = carried[0], carried[1], carried[2]
    for i in range(grid.integers[STEP], steps + 1):
        # the force at grid point i completes step i - 1, whose end velocity needs it
        s = i * h
        swing = math.sin(equation.drive * (equation.clock + s))
        depth, rate = tip_of(equation, q, half if i > 0 else v)
        push = contact_force(equation, depth, rate)
        grid.integers[EVALUATIONS] += 1
        length = h if i > 0 else 0.5 * h
        for k in range(n):
            force = (
                equation.constant[k] + equation.push[k] * swing - equation.stiffness[k] * q[k]
                - equation.phi[k] * push
            )  # fmt: skip
            old = half[k] if i > 0 else v[k]
            c = equation.decay[k] * length
            if lagged or i == 0:
                new = old + length * force - c * old
            else:
                new = ((1.0 - 0.5 * c) * old + length * force) / (1.0 + 0.5 * c)
            v[k] = 0.5 * (old + new) if i > 0 else old
            half[k] = new
        if i > 0:
            depth = record_step(equation, grid, s - h, h, q0, v0, q, v)
            if not abs(depth) < UNBOUNDED:
                grid.integers[STEP] = i
                return DIVERGED
            if contact_tangent(equation, depth, 0.0)[0] > critical:
                grid.integers[STEP] = i
                return TOO_LARGE
        if i == steps:
            break
        for k in range(n):
            q0[k], v0[k] = q[k], v[k]
            q[k] += h * half[k]
        if grid.integers[LOGGED] >= grid.log.shape[0] - 1:
            grid.integers[STEP] = i + 1
            return FULL
    grid.integers[STEP] = steps
    return FINISHED


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
        return grid_trajectory(
            oscillator,
            run,
            step=self.step,
            march=lambda equation, grid, q, v, carried, steps: central_difference(
                equation, grid, q, v, carried, steps, self.step, self.lagged, critical
            ),
            carried=np.zeros((3, oscillator.n_modes)),
            critical=critical,
        )
