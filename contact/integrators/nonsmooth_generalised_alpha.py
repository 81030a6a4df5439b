"""The nonsmooth generalised-alpha method: smooth motion of order 2, impacts as percussions within a step.

The velocity is split into a smooth part, followed by the generalised-alpha method (``generalised_alpha``),
and the jump w of the step.  With f = g + P sin(w t) - c v - omega^2 q, U = phi . v, percussion p [N s] and
Newton's restitution e,

    (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) f_{n+1} + alpha_f f_n
    v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1}) + w,                     w = -phi p
    q_{n+1} = q_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1}) + (h/2) w
    0 <= p  and  U_{n+1} + e U_n <= 0,  one of them zero,  if  d_n + (h/2) U_n >= 0;   p = 0 otherwise

(Q.-Z. Chen, V. Acary, G. Virlez, O. Bruls, Int. J. Numer. Meth. Engng 96 (2013) 487; the variant with the
constraint at velocity level, the whole contact force in the percussion, the constraint switched on by the
position predicted at mid-step as in ``moreau_jean``).  The acceleration a is the smooth one and is carried
across impacts.  With D as in ``generalised_alpha``, v_{n+1} = v* - E phi p,

    E = 1 - (1 - alpha_f) gamma h (c + h omega^2/2) / D
      = (1 - alpha_m + (1 - alpha_f) (beta - gamma/2) h^2 omega^2) / D > 0,

and p = max(0, (U* + e U_n) / sum E phi^2) in closed form.

alpha_m, alpha_f, beta, gamma follow from rho, the factor by which a step damps infinite frequencies
(``chung_hulbert``).  rho = 1 is the scheme of Moreau and Jean with theta = 1/2, and keeps the energy when
e = 1; on the energy for smaller rho see V. Acary, Z. Angew. Math. Mech. 96 (2016) 585.  Order 2 in smooth
motion, 1 after an impact, whose instant is known to half a step; stable for any step.  A tip that is behind
the stop stays behind, as with ``moreau_jean``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.compiled import kernel
from contact.integrators.equation import force_in_flight, tip_of
from contact.integrators.generalised_alpha import chung_hulbert
from contact.integrators.grid import (
    DIVERGED,
    EVALUATIONS,
    FINISHED,
    FULL,
    LOGGED,
    STEP,
)
from contact.integrators.grid_run import check_step, grid_trajectory
from contact.integrators.method import Integrator, Run
from contact.integrators.moreau_jean import end_step, percussion_of
from contact.laws import NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory

__all__ = ["NonsmoothGeneralisedAlpha"]


@kernel
def nonsmooth_generalised_alpha(
    equation, grid, q, v, carried, steps, h, alpha_m, alpha_f, beta, gamma
):  # fmt: skip
    """March from the step reached to `steps`; rows of `carried`: a, f, D, E and room to work in."""
    n = q.size
    a, f, inertia, share = carried[0], carried[1], carried[2], carried[3]
    q0, v0, place = carried[4], carried[5], carried[6]
    new = 1.0 - alpha_f
    if grid.integers[STEP] == 0:
        swing = math.sin(equation.drive * equation.clock)
        for k in range(n):
            a[k] = force_in_flight(equation, k, swing, q, v)
            f[k] = a[k]
            c, y = h * equation.decay[k], h * h * equation.stiffness[k]
            inertia[k] = 1.0 - alpha_m + new * (gamma * c + beta * y)
            share[k] = (1.0 - alpha_m + new * (beta - 0.5 * gamma) * y) / inertia[k]
    mobility = 0.0
    for k in range(n):
        mobility += share[k] * equation.phi[k] ** 2
    for i in range(grid.integers[STEP], steps):
        if grid.integers[LOGGED] >= grid.log.shape[0] - 1:
            grid.integers[STEP] = i
            return FULL
        swing = math.sin(equation.drive * (equation.clock + (i + 1) * h))
        depth, before = tip_of(equation, q, v)
        for k in range(n):
            q0[k], v0[k] = q[k], v[k]
            q[k] += h * v[k] + h * h * (0.5 - beta) * a[k]
            v[k] += h * (1.0 - gamma) * a[k]
            rest = alpha_f * f[k] - alpha_m * a[k]
            a[k] = (rest + new * force_in_flight(equation, k, swing, q, v)) / inertia[k]
            q[k] += beta * h * h * a[k]
            v[k] += gamma * h * a[k]
        _d, after = tip_of(equation, q, v)
        grid.integers[EVALUATIONS] += 1
        push = percussion_of(equation, h, depth, before, after, mobility)
        for k in range(n):
            jump = -equation.phi[k] * push
            change = -new * (equation.decay[k] + 0.5 * h * equation.stiffness[k]) * jump / inertia[k]
            a[k] += change
            q[k] += beta * h * h * change + 0.5 * h * jump
            v[k] += gamma * h * change + jump
            f[k] = force_in_flight(equation, k, swing, q, v)
        if not end_step(equation, grid, i, h, push, 0.5, q0, v0, q, v, place):
            return DIVERGED
    grid.integers[STEP] = steps
    return FINISHED


@dataclass(frozen=True, kw_only=True)
class NonsmoothGeneralisedAlpha(Integrator):
    """The nonsmooth generalised-alpha method with a fixed step.

    Parameters
    ----------
    step : float
        Time step [s].
    rho : float
        Factor by which a step damps infinite frequencies, from 0 to 1 [1]; 1 damps nothing.
    beyond_limit : bool
        Without effect, since no step is unstable; here because every method with a step has it.
    """

    step: float
    rho: float
    beyond_limit: bool = False
    name: ClassVar[str] = "nonsmooth-generalised-alpha"
    order: ClassVar[float] = 2.0
    laws: ClassVar[tuple[int, ...]] = (NEWTON,)
    limit: ClassVar[str] = "none"
    source: ClassVar[str] = (
        "Q.-Z. Chen, V. Acary, G. Virlez, O. Bruls, Int. J. Numer. Meth. Engng 96 (2013) 487, velocity level"
    )

    def __post_init__(self) -> None:
        check_step(self.step)
        chung_hulbert(self.rho)

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`."""
        numbers = chung_hulbert(self.rho)
        return grid_trajectory(
            oscillator,
            run,
            step=self.step,
            march=lambda equation, grid, q, v, carried, steps: nonsmooth_generalised_alpha(
                equation, grid, q, v, carried, steps, self.step, numbers["alpha_m"], numbers["alpha_f"],
                numbers["beta"], numbers["gamma"],
            ),
            carried=np.zeros((7, oscillator.n_modes)),
        )  # fmt: skip
