"""Splitting: exact flight, contact force in kicks, composed symmetrically with a fixed step.

    order 2:  K(h/2) F(h) K(h/2)
    order 4:  K(b_0 h) F(a_1 h) K(b_1 h) F(a_2 h) ... F(a_6 h) K(b_6 h),   a_(7-i) = a_i,  b_(6-i) = b_i

F is the flow of the driven spring without the stop, K the contact acting on velocities alone; both are exact
(``contact.integrators.splitting_step``), so that the error is that of the composition and vanishes off the
stop.  Sources: G. Strang, SIAM J. Numer. Anal. 5 (1968) 506; S. Blanes, P. C. Moan, J. Comput. Appl. Math.
142 (2002) 313, the six-stage method of order 4 for second-order equations that begins with a kick.
A step over a touch at which the force grows as d^p adds an error of order h^(p + 1), whatever the method.

Limit of stability of a contact that stays closed, N = k d + c d'.  A step is then a linear map M(k) of (u,
v), and det(M + I) and det(M - I) are polynomials in k of degree s, the number of sub-flows, known from s + 1
values.  At their lowest positive root an eigenvalue passes -1 or 1.  Derivation: ``docs/theory/steps.md``.
Order 4 first fails in a narrow band, h sqrt(k Phi) = 3.163 to 3.169 for a free body, by a growth of 1.0024 a
step, and then from 5.03 on.  The lower value is the limit.

With damping, and beyond omega h = pi, pairs may leave the circle below that root: beyond pi near the
resonances of step and contact, theta_j + theta_k = 2 pi m.  A search finds the first k there at which the
spectral radius exceeds one; it may miss narrower resonances.  In flight there is no limit.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import InvalidValue, record
from contact.flight.modal_flow import flow_over
from contact.flight.numbers import DAMPED, Numbers, numbers_of
from contact.integrators.fixed_step import FixedStep
from contact.integrators.grid import Grid, first_tangent
from contact.integrators.splitting_step import Composition, split_steps, sub_flows
from contact.laws import LinearContact

SEARCH, SEARCH_BEYOND_PI, EACH = 1, 6, 100
"""Decades of k below the lowest root that are searched, for omega h < pi and beyond, and values in each."""

JUST_BEYOND = 1e-5  # how far beyond a root its instability is looked for, relative

EXCEEDS = 1e-7  # least excess of the spectral radius over one: rounding makes 1e-8 at a double eigenvalue

_A1, _A2 = 0.245298957184271, 0.604872665711080
_B0, _B1, _B2 = 0.0829844064174052, 0.3963098014983681, -0.0390563049223486
_A3, _B3 = 0.5 - (_A1 + _A2), 1.0 - 2.0 * (_B0 + _B1 + _B2)

COMPOSITIONS = {
    2: Composition(flows=np.array([1.0]), kicks=np.array([0.5, 0.5])),
    4: Composition(np.array([_A1, _A2, _A3, _A3, _A2, _A1]), np.array([_B0, _B1, _B2, _B3, _B2, _B1, _B0])),
}
"""The coefficients of one step by order: G. Strang; S. Blanes and P. C. Moan."""


def step_matrix(
    numbers: Numbers, composition: Composition, step: float, stiffness: ArrayLike, damping: float = 0.0
) -> np.ndarray:
    """The map (u, v) -> (u, v) of one step with the contact closed, shape (..., 2 n_modes, 2 n_modes).

    `stiffness` may be an array, of the shape (...) [N/m].
    """
    n, phi, rate = numbers.size, numbers.phi, damping * numbers.inverse_mass
    stiff = np.asarray(stiffness, dtype=float)[..., None]
    upper = np.broadcast_to(np.eye(n, 2 * n), (*stiff.shape[:-1], n, 2 * n))
    lower = np.broadcast_to(np.eye(n, 2 * n, n), upper.shape)
    for j, part in enumerate(composition.kicks * step):
        acts = -math.expm1(-rate * part) / rate if rate > 0.0 else part  # with its initial force [s]
        pull = acts * (stiff * (phi @ upper) + damping * (phi @ lower))
        lower = lower - phi[:, None] * pull[..., None, :]
        if j < composition.flows.size:
            a, b, c, d = flow_over(numbers, composition.flows[j] * step)[:, :4, None].swapaxes(0, 1)
            upper, lower = a * upper + b * lower, c * upper + d * lower
    return np.concatenate([upper, lower], axis=-2)


def spectral_radius(
    numbers: Numbers, composition: Composition, step: float, stiffness: ArrayLike, damping: float = 0.0
) -> np.ndarray:
    """Largest modulus of an eigenvalue of `step_matrix`, of the shape of `stiffness`."""
    speed = np.where(numbers.omega > 0, numbers.omega, 1.0 / step)
    scale = np.concatenate([speed, np.ones(numbers.size)])  # (omega u, v): the flow is then a rotation
    matrix = step_matrix(numbers, composition, step, stiffness, damping)
    return np.abs(np.linalg.eigvals(scale[:, None] * matrix / scale)).max(axis=-1)


def first_instability(numbers: Numbers, composition: Composition, step: float, damping: float = 0.0) -> float:
    """The lowest contact stiffness at which a lasting contact is unstable [N/m].

    A root of det(M + I) or det(M - I) counts if the step is unstable just beyond it, since rounding may add a
    root to the second.  Each is found anew from values closer to it.
    """
    degree = composition.flows.size
    nodes = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    width, passages = 4.0 * degree**2 / (step**2 * numbers.inverse_mass), []

    def unstable(stiffness: ArrayLike) -> np.ndarray:
        return spectral_radius(numbers, composition, step, stiffness, damping) > 1.0 + EXCEEDS

    def roots(sign: float, width: float) -> np.ndarray:
        matrices = step_matrix(numbers, composition, step, width * nodes, damping)
        values = np.linalg.det(matrices + sign * np.eye(2 * numbers.size))
        found = np.polynomial.Polynomial.fit(nodes, values, degree, domain=[0.0, 1.0]).roots()
        return width * found.real[(np.abs(found.imag) <= 1e-9 * np.abs(found)) & (found.real > 0.0)]

    for sign in (1.0, -1.0):
        for coarse in roots(sign, width):
            near = roots(sign, 2.0 * coarse)
            root = float(near[np.argmin(np.abs(near - coarse))]) if near.size else float(coarse)
            if unstable((1.0 + JUST_BEYOND) * root):
                passages.append(root)
    first = min(passages, default=10.0 * width)
    under = numbers.omega > 0.5 * numbers.decay
    decades = SEARCH_BEYOND_PI if np.any(numbers.row(DAMPED)[under] * step >= math.pi) else SEARCH
    values = first * 10.0 ** np.linspace(-decades, 0.0, decades * EACH + 1)
    found = np.flatnonzero(unstable(values[:-1]))
    if found.size == 0:
        return first
    low, high = float(values[max(found[0] - 1, 0)]), float(values[found[0]])
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return low


@lru_cache(maxsize=256)
def _limit(rows: tuple[tuple[float, ...], ...], order: int, step: float, damping: float) -> float:
    """`first_instability`, cached since the search takes some hundredths of a second."""
    numbers = numbers_of(*np.array(rows), law=LinearContact(stiffness=1.0), gap=0.0)
    return first_instability(numbers, COMPOSITIONS[order], step, damping)


@record(eq=True)
class Splitting(FixedStep):
    """Symmetric splitting into exact flights and kicks of the contact force, with a fixed step.

    The step may be longer than the periods of high modes.

    Parameters
    ----------
    step : float
        Time step, above zero [s].
    beyond_limit : bool
        Whether to run even where the step is unstable, to study what happens there.
    order : {2, 4}
        Order of the method in smooth motion [1].

    Raises
    ------
    ValueError
        If the step is no finite number above zero, or `order` is neither 2 nor 4.
    """

    order: int = 2  # type: ignore[misc]
    name: ClassVar[str] = "splitting"
    time_loop: ClassVar[Callable[..., int]] = staticmethod(split_steps)
    deviations: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.order not in COMPOSITIONS:
            raise InvalidValue(f"order is {self.order!r}; it must be 2 or 4")

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Return the lowest stiffness of a lasting contact at which a step is unstable [N/m].

        It is a tangent stiffness, with the damping of the first touch.  Under Hunt and Crossley's law the
        damping grows with the depth; it raises the limit and is left out.
        """
        rows = tuple(tuple(row) for row in (numbers.omega, numbers.decay, numbers.phi))
        return _limit(rows, self.order, self.step, first_tangent(numbers)[1])

    def prepare(self, grid: Grid) -> tuple[Composition, np.ndarray]:
        """The composition, and its sub-flows over a step."""
        composition = COMPOSITIONS[self.order]
        return composition, sub_flows(grid.numbers, composition, self.step)
