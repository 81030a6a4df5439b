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
from contact.integrators.fixed_step import check_step, fixed_step_run
from contact.integrators.generalised_alpha import chung_hulbert, predict, start_rows
from contact.integrators.grid import DONE
from contact.integrators.method import Integrator
from contact.integrators.moreau_jean import end_impact_step, percussion_of
from contact.laws import NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

__all__ = ["NonsmoothGeneralisedAlpha"]


@kernel
def nonsmooth_generalised_alpha(equation, grid, numbers, rows):
    """March from the grid point reached; `rows`, shape (3, n_modes), carries a, f and D."""
    place, h, q, v, new = grid.places[0], grid.step, grid.q, grid.v, 1.0 - numbers.alpha_f
    if place.evaluations == 0:
        start_rows(equation, grid, numbers, rows)
        place.evaluations = 0
    a, f, inertia = rows[0], rows[1], rows[2]
    mobility = 0.0
    for k in range(q.size):
        y = h * h * equation.stiffness[k]
        share = (1.0 - numbers.alpha_m + new * (numbers.beta - 0.5 * numbers.gamma) * y) / inertia[k]
        mobility += share * equation.phi[k] ** 2
    for i in range(place.step, grid.steps):
        swing = math.sin(equation.drive * (equation.clock + (i + 1) * h))
        depth, before = tip_of(equation, q, v)
        predict(equation, grid, numbers, rows, swing)
        _d, after = tip_of(equation, q, v)
        place.evaluations += 1
        push = percussion_of(equation, h, depth, before, after, mobility)
        for k in range(q.size):
            jump = -equation.phi[k] * push
            change = -new * (equation.decay[k] + 0.5 * h * equation.stiffness[k]) * jump / inertia[k]
            a[k] += change
            q[k] += numbers.beta * h * h * change + 0.5 * h * jump
            v[k] += numbers.gamma * h * change + jump
            f[k] = force_in_flight(equation, k, swing, q, v)
        status = end_impact_step(equation, grid, push, 0.5)
        if status != DONE:
            return status
    return DONE


@dataclass(frozen=True, kw_only=True)
class NonsmoothGeneralisedAlpha(Integrator):
    """The nonsmooth generalised-alpha method with a fixed step.

    Parameters
    ----------
    step : float
        Time step [s].
    rho : float
        Factor by which a step damps infinite frequencies, from 0 to 1 [1]; 1 damps nothing.
    """

    step: float
    rho: float
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
        numbers, rows = chung_hulbert(self.rho), np.zeros((3, oscillator.n_modes))
        return fixed_step_run(
            oscillator, run, step=self.step,
            march=lambda equation, grid: nonsmooth_generalised_alpha(equation, grid, numbers, rows),
        )  # fmt: skip
