"""Moreau and Jean's time stepping: impacts as percussions within a step, never located.

With f = g + P sin(w t) - c v - omega^2 q the force per modal mass, U = phi . v the velocity of the tip
towards the stop, d its penetration, p the percussion [N s] and e = e(U_n) the restitution of Newton's law,

    v_{n+1} = v_n + h (theta f_{n+1} + (1 - theta) f_n) - phi p
    q_{n+1} = q_n + h (theta v_{n+1} + (1 - theta) v_n)
    0 <= p  and  U_{n+1} + e U_n <= 0,  one of them zero,  if  d_n + (h/2) U_n >= 0;   p = 0 otherwise

(J. J. Moreau, in Nonsmooth Mechanics and Applications, CISM 302 (1988), 1; M. Jean, J. J. Moreau, Proc.
Contact Mechanics Int. Symp., Lausanne 1992, 31).  With D = 1 + theta h c + theta^2 h^2 omega^2 per mode and
v* the velocity without percussion, v_{n+1} = v* - phi p/D, and p = max(0, (U* + e U_n) / sum phi^2/D).

With a = f this is the ``nonsmooth_generalised_alpha`` method of alpha_m = alpha_f = 0, gamma = theta, beta =
theta^2, but for a weight eta = theta in place of the 1/2 in its positions.  Both have one time loop:

    q_{n+1} = q_n + h v_n + h^2 ((eta - beta) a_n + beta a_{n+1}) + h eta w,     w = -phi p.

The order is 1 after an impact; before one, 2 for theta = 1/2 and 1 otherwise.  The stop acts at velocity
level: a tip that is behind it stays behind.  A tip that leaves from there may be struck once more, by less
than a step's change of velocity: such a touch has an approach below zero.  Energy: ``docs/theory/steps.md``.

The path of the step has its corner at t_n + (1 - theta) h, where q = q_n + (1 - theta) h v_n: there the
impact is dated, from v_n to v_{n+1}, so that Newton's law holds for what is written down.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from beam.parameters import record, require_within
from contact.flight.numbers import DECAY, SQUARE, Numbers
from contact.flight.tip import push_on
from contact.integrators.fixed_step import FixedStep
from contact.integrators.generalised_alpha import AlphaParameters, AlphaState, alpha_state, predict, stable
from contact.integrators.grid import DONE, Grid, cubic_interpolation, force_in_flight, make_end_step, tip_of
from contact.laws import NEWTON
from contact.machine.compiled import inlined, kernel
from contact.state import IMPACT
from contact.touch.newton import restitution_at
from contact.touch.passage import add_exchange, close_touch, open_touch


@inlined
def path_with_corner(grid, corner, x, h, with_force):
    """The state at the fraction `x` of a step.

    Where the stop has struck, the path has a corner at the fraction `corner`: the old velocity before it, the
    new one after it.
    """
    if grid.recorder.marks[0].touching == 0:
        return cubic_interpolation(grid, corner, x, h, with_force)
    for k in range(grid.q.size):
        if x <= corner:
            grid.q_at[k], grid.v_at[k] = grid.q0[k] + x * h * grid.v0[k], grid.v0[k]
        else:
            grid.q_at[k], grid.v_at[k] = grid.q[k] - (1.0 - x) * h * grid.v[k], grid.v[k]
    return tip_of(grid.numbers, grid.q_at, grid.v_at)


@inlined
def write_percussion(grid, corner, span, _depth, push):
    """Write a touch at the corner if there was a percussion; it lasts while the stop acts in each step."""
    recorder, (start, h) = grid.recorder, span
    marks, opens = recorder.marks[0], recorder.marks[0].touching == 0
    marks.touching = 1 if push > 0.0 else 0
    if push > 0.0:
        _d, before = path_with_corner(grid, corner, corner, h, True)
        _d, after = tip_of(grid.numbers, grid.q_at, grid.v)
        if opens:
            open_touch(recorder, 0, grid.first, start + corner * h, before, IMPACT, grid.q_at, grid.v_at)
        loss = 0.5 * (before - after) * (before + after) / grid.numbers.inverse_mass
        add_exchange(recorder, 0, loss, push, math.nan)
        close_touch(recorder, 0, grid.first, start + corner * h, after, grid.q_at, grid.v)
        marks.touching = 1


end_step = make_end_step(path_with_corner, write_percussion)


def before_percussions(parameters: AlphaParameters, grid: Grid) -> tuple[AlphaState, float]:
    """The state before the first step, and sum E phi^2 [1/kg] (``nonsmooth_generalised_alpha``)."""
    alpha, y = alpha_state(parameters, grid), grid.step**2 * grid.numbers.row(SQUARE)
    alpha_m, alpha_f, beta, gamma, eta = parameters
    share = 1.0 - alpha_m + (1.0 - alpha_f) * (beta - gamma * eta) * y
    return alpha, grid.numbers.mobility(alpha.inertia / share)


@kernel
def through_percussions(grid, prepared):
    """Steps from the grid point reached, with `prepared` by `before_percussions`."""
    alpha, mobility = prepared
    parameters, a, f, inertia = alpha
    progress, h, q, v, numbers = grid.progress[0], grid.step, grid.q, grid.v, grid.numbers
    modes, new, eta = numbers.modes, 1.0 - parameters.alpha_f, parameters.eta
    while progress.step < grid.steps:
        sine = math.sin(numbers.drive * (grid.clock + (progress.step + 1) * h))
        depth, before = tip_of(numbers, q, v)
        predict(grid, alpha, sine)
        _d, after = tip_of(numbers, q, v)
        push = 0.0
        if depth + 0.5 * h * before >= 0.0:  # under Newton's law, the only law of methods by percussions
            push = max(0.0, (after + restitution_at(numbers, before)[0] * before) / mobility)
        for k in range(q.size if push > 0.0 else 0):
            jump = push_on(numbers, k, push)
            change = -new * (modes[DECAY, k] + eta * h * modes[SQUARE, k]) * jump / inertia[k]
            a[k] += change
            q[k] += parameters.beta * h * h * change + eta * h * jump
            v[k] += parameters.gamma * h * change + jump
        for k in range(q.size if parameters.alpha_f != 0.0 else 0):
            f[k] = force_in_flight(grid, k, sine, q, v)
        depth, _rate = tip_of(numbers, q, v)
        status = end_step(grid, 1.0 - eta, 1, depth, push == 0.0, push)
        if status != DONE:
            return status
    return DONE


@record(eq=True)
class MoreauJean(FixedStep):
    """Moreau and Jean's time stepping with a fixed step, for Newton's law.

    Parameters
    ----------
    step : float
        Time step, above zero [s].
    beyond_limit : bool
        Whether to run even where the step is unstable, to study what happens there.
    theta : float
        Weight of the end of the step, from 0 to 1 [1]; 1/2 keeps the energy, 1 damps most.

    Raises
    ------
    ValueError
        If the step is no finite number above zero, or `theta` lies outside 0 to 1.
    TypeError
        If `theta` is no number.
    """

    theta: float = 0.5
    name: ClassVar[str] = "moreau-jean"
    order: ClassVar[float] = 1.0
    laws: ClassVar[tuple[int, ...]] = (NEWTON,)
    time_loop: ClassVar[Callable[..., int]] = staticmethod(through_percussions)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within("theta", self.theta, "[1]", low=0, high=1)

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Infinite, or below zero if a mode grows in flight [N/m]; the method has no contact stiffness."""
        holds = stable(self.parameters, self.step * numbers.omega, self.step * numbers.decay)
        return math.inf if np.all(holds) else -1.0

    @property
    def parameters(self) -> AlphaParameters:
        """alpha_m = alpha_f = 0, beta = theta^2, gamma = eta = theta."""
        theta = float(self.theta)
        return AlphaParameters(0.0, 0.0, theta**2, theta, theta)

    def prepare(self, grid: Grid) -> object:
        """The state before the first step, and sum phi^2/D [1/kg]."""
        return before_percussions(self.parameters, grid)
