"""The generalised-alpha method, with Newmark's and Hilber, Hughes and Taylor's methods as members.

With f = g + P sin(w t) - c v - omega^2 q - phi N the force per modal mass, N as in ``contact.laws``,

    (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) f_{n+1} + alpha_f f_n
    q_{n+1} = q_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1})
    v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1})

(J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, with the forces of both ends weighted).  The
acceleration a is carried from step to step and starts as f_0.  A method with percussions may put a weight eta
in place of the 1/2 in the positions (``moreau_jean``).  The modes are coupled by N alone: with D = 1 -
alpha_m + (1 - alpha_f)(c gamma h + omega^2 beta h^2) per mode, and d*, d'* the end of the step without the
contact force there, one equation N = N(d* - B N, d'* - G N) remains,

    (B, G) = (beta h^2, gamma h) (1 - alpha_f) sum phi^2 / D.

A dashpot makes the force jump at d = 0; there N takes the value between that leaves the tip at d = 0.
Order 2 if gamma = 1/2 - alpha_m + alpha_f, else 1.

Stability of a mode, y = h^2 omega^2.  With A = 1 - 2 alpha_m, F = 1 - 2 alpha_f, g = 2 gamma - 1,
e = g + 2 eta - 1, b = 4 beta - 2 gamma - 2 eta + 1 and X = 2 c h, none of

    p3 = 4 A + F (b y + X g),   p2 = 4 + b y + X g + F (e y + X),   p1 = (e + F) y + X,   p2 p1 - p3 y

may be negative.  For eta = 1/2 and c = 0 they are linear in y, with 4 (g + F - A) + g (b + F g + F^2) y for
the last: `limit`.  Derivation: ``docs/theory/steps.md``.  This is linear theory: a contact that opens and
closes can feed energy even to an unconditionally stable method (``studies.methods.stability``).  No step is
refused for that.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ClassVar, NamedTuple

import numpy as np

from beam.parameters import record, require_within
from contact.flight.numbers import Numbers
from contact.flight.tip import push_on
from contact.integrators.fixed_step import FixedStep, stiffness_at
from contact.integrators.grid import (
    DONE,
    LEAST_DEPTH,
    Grid,
    accelerations,
    contact_force,
    contact_tangent,
    end_contact_step,
    force_in_flight,
    tip_of,
)
from contact.machine.compiled import inlined, kernel

MARGIN = 1e-12  # slack of the conditions of stability, relative to their terms, which cancel on the limit

ROUNDING = 16 * 2.220446049250313e-16
"""Relative change of the contact force at which the iteration ends: d* carries a rounding error of its own,
which moves the root by a few units in the last place."""

CLOSED = 1e-12  # relative width of a bracket in which rounding decides over the sign of the residual

ITERATIONS = 130
"""Enough for the force.  Where the stop pushes with a power of d above one, the residual is concave up to the
root, and Newton's steps from zero never pass it; each cuts the residual to 1/e or less until they converge
quadratically.  Under any other law a step that leaves the bracket halves it.  Where the stop pulls, each step
halves the bracket or the residual: 130 for the digits of both."""


class AlphaParameters(NamedTuple):
    """The numbers of a member of the family [1]."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    eta: float = 0.5

    def letters(self) -> tuple[float, float, float, float, float]:
        """A, F, g, b and e."""
        alpha_m, alpha_f, beta, gamma, eta = self
        g, late = 2.0 * gamma - 1.0, 2.0 * eta - 1.0
        return 1.0 - 2.0 * alpha_m, 1.0 - 2.0 * alpha_f, g, 4.0 * beta - 2.0 * gamma - late, g + late


def limit(parameters: AlphaParameters) -> float:
    """Largest stable h omega without damping for eta = 1/2 [1]; infinite if all are stable, 0 if none is."""
    a, f, g, b, _e = parameters.letters()
    constant = np.array([4.0 * a, 4.0, 0.0, 4.0 * (g + f - a)])
    slope = np.array([f * b, b + f * g, g + f, g * (b + f * g + f * f)])
    falls = slope < -MARGIN
    if np.any((constant < -MARGIN) | (falls & (constant < MARGIN))):
        return 0.0
    return math.sqrt(np.min(-constant[falls] / slope[falls], initial=math.inf))


def stable(parameters: AlphaParameters, size: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """Whether a mode with h omega = `size` and h c = `decay` does not grow, elementwise."""
    a, f, g, b, e = parameters.letters()
    y, x = size**2, 2.0 * decay
    p3, p2, p1 = 4.0 * a + f * (b * y + x * g), 4.0 + b * y + x * g + f * (e * y + x), (e + f) * y + x
    scale = MARGIN * (4.0 + y + x) * (1.0 + abs(b) + abs(e) + abs(f))
    least = np.minimum(np.minimum(p3, p2), p1)
    return np.asarray((least >= -scale) & (p2 * p1 - p3 * y >= -scale * (y + x)))


@kernel
def force_at_end(numbers, depth, rate, b, g):
    """The contact force N with N = N(depth - b N, rate - g N), for a law that pulls only while the tip
    leaves: the pull is then weaker than rate/g, which would stop the tip."""
    start = contact_force(numbers, depth, rate)
    if start == 0.0:
        return 0.0
    low, high = (0.0, start) if start > 0.0 else (rate / g, 0.0)
    if b * start > depth:
        high = depth / b
    force, before = 0.0, math.inf
    for _ in range(ITERATIONS):
        residual = force - contact_force(numbers, depth - b * force, rate - g * force)
        low, high = (low, force) if residual > 0.0 else (force, high)
        stiffness, damping = contact_tangent(numbers, depth - b * force, rate - g * force)
        new = force - residual / (1.0 + b * stiffness + g * damping)
        if start > 0.0 and new >= high:
            if high - low <= CLOSED * high or contact_force(numbers, LEAST_DEPTH, rate - g * high) >= high:
                return high
        if not low <= new <= high or (start < 0.0 and abs(residual) > 0.5 * before):
            new = 0.5 * (low + high)
        if abs(new - force) <= ROUNDING * abs(new):
            return new
        force, before = new, abs(residual)
    return force


class AlphaState(NamedTuple):
    """The numbers of the method, and per mode a, f and D, each of shape (n_modes,)."""

    parameters: AlphaParameters
    a: np.ndarray
    f: np.ndarray
    inertia: np.ndarray


def alpha_state(parameters: AlphaParameters, grid: Grid) -> AlphaState:
    """The state of the method before its first step, where a = f."""
    (alpha_m, alpha_f, beta, gamma, _eta), h, start = parameters, grid.step, accelerations(grid)
    implicit = gamma * (h * grid.numbers.decay) + beta * (h * grid.numbers.omega) ** 2
    return AlphaState(parameters, start, start.copy(), 1.0 - alpha_m + (1.0 - alpha_f) * implicit)


@inlined
def predict(grid, alpha, sine):
    """The step without a contact force at its end; `sine` is sin(w t)."""
    parameters, a, f, inertia = alpha
    h, q, v, new = grid.step, grid.q, grid.v, 1.0 - parameters.alpha_f
    for k in range(q.size):
        q[k] += h * v[k] + h * h * (parameters.eta - parameters.beta) * a[k]
        v[k] += h * (1.0 - parameters.gamma) * a[k]
        rest = parameters.alpha_f * f[k] - parameters.alpha_m * a[k]
        a[k] = (rest + new * force_in_flight(grid, k, sine, q, v)) / inertia[k]
        q[k] += parameters.beta * h * h * a[k]
        v[k] += parameters.gamma * h * a[k]


@kernel
def generalised_alpha(grid, prepared):
    """Steps from the grid point reached; prepared: the `AlphaState`, and sum phi^2/D [1/kg]."""
    alpha, mobility = prepared
    parameters, a, f, inertia = alpha
    progress, h, q, v, numbers = grid.progress[0], grid.step, grid.q, grid.v, grid.numbers
    new, b, g = 1.0 - parameters.alpha_f, parameters.beta * h * h, parameters.gamma * h
    while progress.step < grid.steps:
        sine = math.sin(numbers.drive * (grid.clock + (progress.step + 1) * h))
        predict(grid, alpha, sine)
        depth, rate = tip_of(numbers, q, v)
        push = force_at_end(numbers, depth, rate, b * new * mobility, g * new * mobility)
        for k in range(q.size):
            jump = new * push_on(numbers, k, push) / inertia[k]
            a[k] += jump
            q[k] += b * jump
            v[k] += g * jump
            f[k] = force_in_flight(grid, k, sine, q, v) + push_on(numbers, k, push)
        depth, _rate = tip_of(numbers, q, v)
        status = end_contact_step(grid, None, 1, depth, depth < 0.0, None)
        if status != DONE:
            return status
    return DONE


def chung_hulbert(rho: float) -> AlphaParameters:
    """The numbers of order 2 that damp infinite frequencies by the factor `rho` a step, and low frequencies
    least (Chung and Hulbert 1993)."""
    require_within("rho", rho, "[1]", low=0, high=1)
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 + (1.0 - rho) / (1.0 + rho)
    return AlphaParameters(alpha_m=alpha_m, alpha_f=alpha_f, beta=0.25 * (0.5 + gamma) ** 2, gamma=gamma)


@record(eq=True)
class GeneralisedAlpha(FixedStep):
    """The generalised-alpha method with a fixed step, for contact forces.

    It takes the contact force at the end of the step.  ``newmark``, ``hht`` and ``with_dissipation`` make the
    known members of the family.

    Parameters
    ----------
    step : float
        Time step, above zero [s].
    beyond_limit : bool
        Whether to run even where the step is unstable, to study what happens there.
    beta : float
        Weight of the new acceleration in the displacement, zero or more [1].
    gamma : float
        Weight of the new acceleration in the velocity, above zero [1].
    alpha_m, alpha_f : float
        Weights of the old acceleration and the old force, below 1 [1].

    Raises
    ------
    ValueError
        If the step is no finite number above zero, or a weight is out of its range.
    TypeError
        If a weight is no number.
    """

    beta: float = 0.25
    gamma: float = 0.5
    alpha_m: float = 0.0
    alpha_f: float = 0.0
    name: ClassVar[str] = "generalised-alpha"
    order: ClassVar[float] = 2.0
    time_loop: ClassVar[Callable[..., int]] = staticmethod(generalised_alpha)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("beta", self.beta, "[1]", low=0)
        require_within("gamma", self.gamma, "[1]", above=0)
        require_within("alpha_m", self.alpha_m, "[1]", below=1)
        require_within("alpha_f", self.alpha_f, "[1]", below=1)

    @staticmethod
    def newmark(
        *, step: float, beta: float = 0.25, gamma: float = 0.5, beyond_limit: bool = False
    ) -> GeneralisedAlpha:
        """Return Newmark's method: beta 1/4 is the trapezoidal rule, 1/6 linear acceleration, 0 explicit."""
        return GeneralisedAlpha(step=step, beta=beta, gamma=gamma, beyond_limit=beyond_limit)

    @staticmethod
    def hht(*, step: float, alpha: float, beyond_limit: bool = False) -> GeneralisedAlpha:
        """Return Hilber, Hughes and Taylor's method; `alpha`, from 0 to 1/3, is minus that of their paper."""
        require_within("alpha of HHT-alpha, its sign turned,", alpha, "[1]", low=0, high=1.0 / 3.0)
        beta, gamma = 0.25 * (1.0 + alpha) ** 2, 0.5 + alpha
        return GeneralisedAlpha(step=step, beta=beta, gamma=gamma, alpha_f=alpha, beyond_limit=beyond_limit)

    @staticmethod
    def with_dissipation(*, step: float, rho: float, beyond_limit: bool = False) -> GeneralisedAlpha:
        """Return Chung and Hulbert's method; a step damps infinite frequencies by `rho`, from 0 to 1 [1]."""
        alpha_m, alpha_f, beta, gamma, _eta = chung_hulbert(rho)
        return GeneralisedAlpha(
            step=step, beta=beta, gamma=gamma, alpha_m=alpha_m, alpha_f=alpha_f, beyond_limit=beyond_limit
        )

    @property
    def parameters(self) -> AlphaParameters:
        """alpha_m, alpha_f, beta and gamma, with eta = 1/2."""
        return AlphaParameters(self.alpha_m, self.alpha_f, self.beta, self.gamma)

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Contact stiffness at which the highest frequency reaches the limit without damping; below zero if a
        mode is beyond the limit [N/m]."""
        if not np.all(stable(self.parameters, self.step * numbers.omega, self.step * numbers.decay)):
            return -1.0
        largest = limit(self.parameters)
        return math.inf if largest == math.inf else stiffness_at(numbers, (largest / self.step) ** 2)

    def prepare(self, grid: Grid) -> tuple[AlphaState, float]:
        """The state before the first step, and sum phi^2/D [1/kg]."""
        alpha = alpha_state(self.parameters, grid)
        return alpha, grid.numbers.mobility(alpha.inertia)
