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
from contact.compiled import kernel
from contact.flight.motion import Motion
from contact.integrators.amplification import Amplification
from contact.integrators.equation import (
    contact_force,
    contact_tangent,
    force_in_flight,
    stiffness_at,
    tip_of,
)
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


@kernel
def generalised_alpha(equation, grid, q, v, carried, steps, h, alpha_m, alpha_f, beta, gamma, critical):
    """March from the step reached to `steps`; rows of `carried`: a, f, D and the state before the step."""
    n = q.size
    a, f, inertia, q0, v0 = carried[0], carried[1], carried[2], carried[3], carried[4]
    new = 1.0 - alpha_f
    if grid.integers[STEP] == 0:
        swing = math.sin(equation.drive * equation.clock)
        depth, rate = tip_of(equation, q, v)
        push = contact_force(equation, depth, rate)
        grid.integers[EVALUATIONS] += 1
        for k in range(n):
            f[k] = force_in_flight(equation, k, swing, q, v) - equation.phi[k] * push
            a[k] = f[k]
            inertia[k] = 1.0 - alpha_m + new * h * (
                gamma * equation.decay[k] + beta * h * equation.stiffness[k]
            )  # fmt: skip
    mobility = 0.0
    for k in range(n):
        mobility += new * equation.phi[k] ** 2 / inertia[k]
    for i in range(grid.integers[STEP], steps):
        if grid.integers[LOGGED] >= grid.log.shape[0] - 1:
            grid.integers[STEP] = i
            return FULL
        swing = math.sin(equation.drive * (equation.clock + (i + 1) * h))
        for k in range(n):
            q0[k], v0[k] = q[k], v[k]
            q[k] += h * v[k] + h * h * (0.5 - beta) * a[k]
            v[k] += h * (1.0 - gamma) * a[k]
            rest = alpha_f * f[k] - alpha_m * a[k]
            a[k] = (rest + new * force_in_flight(equation, k, swing, q, v)) / inertia[k]
            q[k] += beta * h * h * a[k]
            v[k] += gamma * h * a[k]
        depth, rate = tip_of(equation, q, v)
        push, used = force_at_end(equation, depth, rate, beta * h * h * mobility, gamma * h * mobility)
        grid.integers[EVALUATIONS] += used
        for k in range(n):
            jump = -new * equation.phi[k] * push / inertia[k]
            a[k] += jump
            q[k] += beta * h * h * jump
            v[k] += gamma * h * jump
            f[k] = force_in_flight(equation, k, swing, q, v) - equation.phi[k] * push
        depth = record_step(equation, grid, i * h, h, q0, v0, q, v)
        if not abs(depth) < UNBOUNDED:
            grid.integers[STEP] = i + 1
            return DIVERGED
        if contact_tangent(equation, depth, 0.0)[0] > critical:
            grid.integers[STEP] = i + 1
            return TOO_LARGE
    grid.integers[STEP] = steps
    return FINISHED


def chung_hulbert(rho: float) -> dict[str, float]:
    """alpha_m, alpha_f, beta and gamma of order 2 that damp infinite frequencies by the factor `rho` a step
    and low ones least (Chung and Hulbert 1993)."""
    if not (is_number(rho) and 0.0 <= rho <= 1.0):
        raise ValueError(f"rho is {brief(rho)}; it must lie between 0 and 1")
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + (1.0 - rho) / (1.0 + rho)
    return {"alpha_m": alpha_m, "alpha_f": alpha_f, "beta": 0.25 * (0.5 + gamma) ** 2, "gamma": gamma}


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
                f"alpha is {brief(alpha)}; it must lie between 0 and 1/3 (that of the paper of 1977 with "
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
        return GeneralisedAlpha(step=step, beyond_limit=beyond_limit, **chung_hulbert(rho))

    @property
    def second_order(self) -> bool:
        """Whether the numbers give order 2, not 1."""
        return abs(self.gamma - 0.5 + self.alpha_m - self.alpha_f) <= 1e-12

    @property
    def amplification(self) -> Amplification:
        """The linear theory of these numbers."""
        return Amplification(
            alpha_m=self.alpha_m, alpha_f=self.alpha_f, beta=self.beta, gamma=self.gamma
        )

    def spectral_radius(self, frequency: float, decay: float = 0.0) -> float:
        """The largest factor by which a step multiplies a free motion of a mode, `frequency` in rad/s and
        `decay` = c in 1/s [1]."""
        return float(np.max(np.abs(self.amplification.factors(self.step * frequency, self.step * decay))))

    def stability_limit(self) -> float:
        """Largest h omega of an undamped mode; infinite if there is none, 0 if any is too large [1]."""
        return self.amplification.limit()

    def critical_stiffness(self, motion: Motion) -> float:
        """Contact stiffness at which the highest frequency reaches the limit, formed without damping; below
        zero if a mode is beyond it [N/m]."""
        largest = self.stability_limit()
        if not np.all(self.amplification.stable(self.step * motion.omega, self.step * motion.decay)):
            return -1.0
        return math.inf if largest == math.inf else stiffness_at(
            motion.omega, motion.phi, largest / self.step
        )  # fmt: skip

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`."""
        critical = math.inf if self.beyond_limit else self.critical_stiffness(oscillator.motion())
        return grid_trajectory(
            oscillator,
            run,
            step=self.step,
            march=lambda equation, grid, q, v, carried, steps: generalised_alpha(
                equation, grid, q, v, carried, steps, self.step, self.alpha_m, self.alpha_f, self.beta,
                self.gamma, critical,
            ),
            carried=np.zeros((5, oscillator.n_modes)),
            critical=critical,
        )  # fmt: skip
