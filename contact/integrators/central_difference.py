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
from contact.integrators.grid import DONE, end_contact_step, passes
from contact.integrators.method import Integrator
from contact.laws import HERTZ, LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

__all__ = ["CentralDifference"]


@kernel
def central_difference(equation, grid, half, lagged):
    """March from the grid point reached; `half`, shape (n_modes,), carries v_{n+1/2}."""
    place, h, q, v, q0, v0 = grid.places[0], grid.step, grid.q, grid.v, grid.q0, grid.v0
    starts = place.evaluations == 0
    for i in range(-1 if starts else place.step, grid.steps):
        # step -1 is the half step before the first, which leaves the tip where it is
        first = i < 0
        length = 0.5 * h if first else h
        for k in range(q.size):
            q0[k], v0[k] = q[k], v[k]
            if first:
                half[k] = v[k]
            else:
                q[k] += h * half[k]
        swing = math.sin(equation.drive * (equation.clock + (i + 1) * h))
        depth, rate = tip_of(equation, q, half)
        push = contact_force(equation, depth, rate)
        place.evaluations += 1
        for k in range(q.size):
            force = (
                equation.constant[k] + equation.push[k] * swing - equation.stiffness[k] * q[k]
                - equation.phi[k] * push
            )  # fmt: skip
            old, c = half[k], equation.decay[k] * length
            if lagged or first:
                half[k] = old + length * force - c * old
            else:
                half[k] = ((1.0 - 0.5 * c) * old + length * force) / (1.0 + 0.5 * c)
            if not first:
                v[k] = 0.5 * (old + half[k])
        if not first and not passes(grid, 1, depth, depth < 0.0):
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
