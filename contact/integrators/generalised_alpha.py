"""Newmark's method, that of Hilber, Hughes and Taylor, and the generalised-alpha method: one formula.

With f = g + P sin(w t) - c v - omega^2 q - phi N the force per modal mass, N as in ``contact.laws``,

    (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) f_{n+1} + alpha_f f_n
    q_{n+1} = q_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1})
    v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1})

(J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, with the forces of both ends weighted).
alpha_m = alpha_f = 0 is N. M. Newmark's method (J. Eng. Mech. Div. ASCE 85 (1959) 67), alpha_m = 0 that of
H. M. Hilber, T. J. R. Hughes and R. L. Taylor (Earthq. Eng. Struct. Dyn. 5 (1977) 283).  The acceleration a
is carried from step to step; it starts as f_0.

The step.  The modes are coupled by N alone.  With D = 1 - alpha_m + (1 - alpha_f)(c gamma h + omega^2 beta
h^2) per mode and q*, v* what the step gives without the contact force at its end, the tip has

    d = d* - B N,   d' = d'* - G N,   (B, G) = (beta h^2, gamma h) (1 - alpha_f) sum phi^2 / D,

so that one number is unknown: N = N(d* - B N, d'* - G N).  The right side falls as N grows, hence there is
one root; at the edge d = 0, where a dashpot makes the force jump, N takes the value in between that puts the
tip there.

Order 2 if gamma = 1/2 - alpha_m + alpha_f, else 1.  Stability: ``amplification``; without damping h omega <=
(gamma/2 - beta)^(-1/2) for Newmark's method, and no limit at all if 2 beta >= gamma >= 1/2.  This is linear
theory: a contact that opens and closes can feed energy to an unconditionally stable method, a finding of
``studies.stability`` and no ground to refuse a step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from beam.parameters import brief, is_number, require_within
from contact.compiled import inlined, kernel
from contact.flight.motion import Motion
from contact.integrators.amplification import AlphaNumbers, factors, limit, stable
from contact.integrators.equation import (
    contact_force,
    contact_tangent,
    force_in_flight,
    stiffness_at,
    tip_of,
)
from contact.integrators.fixed_step import check_step, fixed_step_run
from contact.integrators.grid import DONE, begin_step, end_contact_step, passes
from contact.integrators.method import Integrator
from contact.laws import HERTZ, LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

__all__ = ["GeneralisedAlpha", "chung_hulbert"]

ROUNDING = 16 * 2.220446049250313e-16
"""Relative change of the contact force at which the iteration ends: d* carries a rounding error of its own,
which moves the root by a few units in the last place."""

ITERATIONS = 130
"""Enough for the force.  Where the stop pushes, the residual is concave up to the root and Newton's steps
from zero never pass it; each cuts d (in a power of at most 5/2) to 3/5 or less until it converges
quadratically: 75 such steps span the digits of a double.  Where Hunt and Crossley's law pulls, each step
halves the bracket or the residual: 130 for the digits of both."""

@kernel
def force_at_end(equation, depth, rate, b, g):
    """The contact force N with N = N(depth - b N, rate - g N), and how often the law was evaluated."""
    start = contact_force(equation, depth, rate)
    if start == 0.0:
        return 0.0, 1
    low, high = 0.0, start
    if start < 0.0:
        low, high = (rate + 1.0 / equation.number1) / g, 0.0
    elif b > 0.0:
        high = min(high, depth / b)
    force, residual, before = 0.0, -start, math.inf
    for i in range(ITERATIONS):
        stiffness, damping = contact_tangent(equation, depth - b * force, rate - g * force)
        new = force - residual / (1.0 + b * stiffness + g * damping)
        if start > 0.0:
            if new >= high:
                return high, i + 1
        elif not low < new < high or abs(residual) > 0.5 * before:
            new = 0.5 * (low + high)
        if abs(new - force) <= ROUNDING * abs(new):
            return new, i + 1
        force, before = new, abs(residual)
        residual = force - contact_force(equation, depth - b * force, rate - g * force)
        if residual > 0.0:
            high = force
        else:
            low = force
    return force, ITERATIONS


@inlined
def predict(equation, grid, numbers, rows, swing):
    """The step without a contact force at its end; rows: a, f and D; `swing`: sin(w t) at the end."""
    a, f, inertia = rows[0], rows[1], rows[2]
    h, q, v, new = grid.step, grid.q, grid.v, 1.0 - numbers.alpha_f
    begin_step(grid)
    for k in range(q.size):
        q[k] += h * v[k] + h * h * (0.5 - numbers.beta) * a[k]
        v[k] += h * (1.0 - numbers.gamma) * a[k]
        rest = numbers.alpha_f * f[k] - numbers.alpha_m * a[k]
        a[k] = (rest + new * force_in_flight(equation, k, swing, q, v)) / inertia[k]
        q[k] += numbers.beta * h * h * a[k]
        v[k] += numbers.gamma * h * a[k]


@kernel
def start_rows(equation, grid, numbers, rows):
    """a and f of a start, and D."""
    h, new = grid.step, 1.0 - numbers.alpha_f
    swing = math.sin(equation.drive * equation.clock)
    depth, rate = tip_of(equation, grid.q, grid.v)
    push = contact_force(equation, depth, rate)
    grid.places[0].evaluations += 1
    for k in range(grid.q.size):
        rows[1, k] = force_in_flight(equation, k, swing, grid.q, grid.v) - equation.phi[k] * push
        rows[0, k] = rows[1, k]
        c, y = h * equation.decay[k], h * h * equation.stiffness[k]
        rows[2, k] = 1.0 - numbers.alpha_m + new * (numbers.gamma * c + numbers.beta * y)


@kernel
def generalised_alpha(equation, grid, numbers, rows):
    """March from the grid point reached; `rows`, shape (3, n_modes), carries a, f and D."""
    place, h, q, v, new = grid.places[0], grid.step, grid.q, grid.v, 1.0 - numbers.alpha_f
    if place.evaluations == 0:
        start_rows(equation, grid, numbers, rows)
    a, f, inertia = rows[0], rows[1], rows[2]
    b, g, mobility = numbers.beta * h * h, numbers.gamma * h, 0.0
    for k in range(q.size):
        mobility += new * equation.phi[k] ** 2 / inertia[k]
    for i in range(place.step, grid.steps):
        swing = math.sin(equation.drive * (equation.clock + (i + 1) * h))
        predict(equation, grid, numbers, rows, swing)
        depth, rate = tip_of(equation, q, v)
        push, used = force_at_end(equation, depth, rate, b * mobility, g * mobility)
        place.evaluations += used
        for k in range(q.size):
            jump = -new * equation.phi[k] * push / inertia[k]
            a[k] += jump
            q[k] += b * jump
            v[k] += g * jump
            f[k] = force_in_flight(equation, k, swing, q, v) - equation.phi[k] * push
        depth, rate = tip_of(equation, q, v)
        if not passes(grid, 1, depth, depth < 0.0):
            status = end_contact_step(equation, grid)
            if status != DONE:
                return status
    return DONE


def chung_hulbert(rho: float) -> AlphaNumbers:
    """The numbers of order 2 that damp infinite frequencies by the factor `rho` a step and low ones least
    (Chung and Hulbert 1993)."""
    if not (is_number(rho) and 0.0 <= rho <= 1.0):
        raise ValueError(f"rho is {brief(rho)}; it must lie between 0 and 1")
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + (1.0 - rho) / (1.0 + rho)
    return AlphaNumbers(alpha_m=alpha_m, alpha_f=alpha_f, beta=0.25 * (0.5 + gamma) ** 2, gamma=gamma)


@dataclass(frozen=True, kw_only=True)
class GeneralisedAlpha(Integrator):
    """The generalised-alpha method with a fixed step, contact force at the end of the step.

    ``newmark``, ``hht`` and ``with_dissipation`` choose its numbers.

    Parameters
    ----------
    step : float
        Time step [s].
    beta, gamma : float
        beta zero or more, gamma above zero [1].
    alpha_m, alpha_f : float
        Weights of the old acceleration and the old force, below 1 [1].
    beyond_limit : bool
        Run even where the step is unstable, for a study of what happens there.
    """

    step: float
    beta: float = 0.25
    gamma: float = 0.5
    alpha_m: float = 0.0
    alpha_f: float = 0.0
    beyond_limit: bool = False
    name: ClassVar[str] = "generalised-alpha"
    order: ClassVar[float] = 2.0
    laws: ClassVar[tuple[int, ...]] = (LINEAR, HERTZ)
    limit: ClassVar[str] = (
        "none in linear theory if alpha_m <= alpha_f <= 1/2 and beta >= 1/4 + (alpha_f - alpha_m)/2; else "
        "h omega_max <= (gamma/2 - beta)^(-1/2) (Newmark); contacts may feed it energy all the same"
    )
    source: ClassVar[str] = (
        "N. M. Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; H. M. Hilber, T. J. R. Hughes, R. L. Taylor, "
        "Earthq. Eng. Struct. Dyn. 5 (1977) 283; J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371"
    )

    def __post_init__(self) -> None:
        check_step(self.step)
        require_within("beta", self.beta, "[1]", low=0)
        require_within("gamma", self.gamma, "[1]", above=0)
        require_within("alpha_m", self.alpha_m, "[1]", below=1)
        require_within("alpha_f", self.alpha_f, "[1]", below=1)

    @staticmethod
    def newmark(
        *, step: float, beta: float = 0.25, gamma: float = 0.5, beyond_limit: bool = False
    ) -> GeneralisedAlpha:
        """Newmark's method: beta = 1/4 is the trapezoidal rule, 1/6 linear acceleration, 0 explicit."""
        return GeneralisedAlpha(step=step, beta=beta, gamma=gamma, beyond_limit=beyond_limit)

    @staticmethod
    def hht(*, step: float, alpha: float, beyond_limit: bool = False) -> GeneralisedAlpha:
        """The method of Hilber, Hughes and Taylor; `alpha` from 0 to 1/3 is minus that of their paper."""
        if not (is_number(alpha) and 0.0 <= alpha <= 1.0 / 3.0):
            raise ValueError(
                f"alpha is {brief(alpha)}; it must lie between 0 and 1/3 (that of the HHT-alpha paper with "
                "its sign turned)"
            )
        return GeneralisedAlpha(
            step=step, beta=0.25 * (1.0 + alpha) ** 2, gamma=0.5 + alpha, alpha_f=alpha,
            beyond_limit=beyond_limit,
        )  # fmt: skip

    @staticmethod
    def with_dissipation(*, step: float, rho: float, beyond_limit: bool = False) -> GeneralisedAlpha:
        """Chung and Hulbert's choice; `rho`, from 0 to 1, is the factor by which a step damps infinite
        frequencies."""
        return GeneralisedAlpha(step=step, beyond_limit=beyond_limit, **chung_hulbert(rho)._asdict())

    @property
    def numbers(self) -> AlphaNumbers:
        """alpha_m, alpha_f, beta and gamma."""
        return AlphaNumbers(
            alpha_m=self.alpha_m, alpha_f=self.alpha_f, beta=self.beta, gamma=self.gamma
        )

    def spectral_radius(self, frequency: float, decay: float = 0.0) -> float:
        """The largest factor by which a step multiplies a free motion of a mode, `frequency` in rad/s and
        `decay` = c in 1/s [1]."""
        return float(np.max(np.abs(factors(self.numbers, self.step * frequency, self.step * decay))))

    def stability_limit(self) -> float:
        """Largest h omega of an undamped mode; infinite if there is none, 0 if any is too large [1]."""
        return limit(self.numbers)

    def critical_stiffness(self, motion: Motion) -> float:
        """Contact stiffness at which the highest frequency reaches the limit, formed without damping; below
        zero if a mode is beyond it [N/m]."""
        largest = self.stability_limit()
        if not np.all(stable(self.numbers, self.step * motion.omega, self.step * motion.decay)):
            return -1.0
        return math.inf if largest == math.inf else stiffness_at(
            motion.omega, motion.phi, largest / self.step
        )  # fmt: skip

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`."""
        critical = math.inf if self.beyond_limit else self.critical_stiffness(oscillator.motion())
        rows, numbers = np.zeros((3, oscillator.n_modes)), self.numbers
        return fixed_step_run(
            oscillator, run, step=self.step, critical=critical,
            march=lambda equation, grid: generalised_alpha(equation, grid, numbers, rows),
        )  # fmt: skip
