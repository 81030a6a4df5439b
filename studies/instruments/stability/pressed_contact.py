"""A contact that lasts: the tip pressed on the stop, and whether a method lets a disturbance grow there.

    q'' + C q' + K q = F phi - phi N(d),   d = phi . q (gap zero),   K = diag(omega_k^2)

With N = k d the rest position solves (K + k phi phi^T) q = F phi; its penetration d is above zero, and as
long as the disturbance is small against it the motion is linear.  A method is called unstable there if a
disturbance of 1e-9 of the rest position has grown 1e5-fold after `STEPS` steps, or has opened the contact.
At the limit itself, where two amplification factors meet at -1, it grows only in proportion to the steps;
slightly beyond, at h omega = 2 (1 + e) for central difference, as exp(sqrt(8 e) n): the test tells the two
apart from e = 5e-8 on.
"""

from __future__ import annotations

import math

import numpy as np

from beam import ModalModel
from contact.errors import Diverged
from contact.integrators.method import Integrator
from contact.laws import ContactLaw, HertzContact, LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State

__all__ = ["STEPS", "combined_frequency", "disturbed", "grows", "growth_rate", "pressed", "pressed_hertz"]

STEPS = 20_000
DISTURBANCE = 1e-9
GROWTH = 1e5
SEEN = 16
"""Grid points at the end of a run whose largest disturbance counts."""


def combined_frequency(model: ModalModel, stiffness: float) -> float:
    """The highest frequency with the contact closed, from the eigenvalues of K + k phi phi^T [rad/s]."""
    matrix = np.diag(model.omega**2) + stiffness * np.outer(model.phi, model.phi)
    return float(np.sqrt(np.linalg.eigvalsh(matrix)[-1]))


def pressed(model: ModalModel, stiffness: float, force: float = 1.0) -> tuple[ImpactOscillator, np.ndarray]:
    """The tip pressed on a linear stop by `force` [N], and the rest position."""
    return _at_rest(model, LinearContact(stiffness=stiffness), stiffness, force)


def pressed_hertz(
    model: ModalModel, stiffness: float, depth: float
) -> tuple[ImpactOscillator, np.ndarray, float]:
    """The tip pressed `depth` [m] into a Hertz contact, the rest position, and the force [N] it takes.

    At rest N = k d^(3/2) is that of a linear contact with the secant k d^(1/2).
    """
    secant = stiffness * np.sqrt(depth)
    _oscillator, unit = _at_rest(model, LinearContact(stiffness=secant), secant, 1.0)
    force = depth / float(model.phi @ unit)
    oscillator, rest = _at_rest(model, HertzContact(stiffness=stiffness), secant, force)
    return oscillator, rest, force


def _at_rest(
    model: ModalModel, law: ContactLaw, secant: float, force: float
) -> tuple[ImpactOscillator, np.ndarray]:
    matrix = np.diag(model.omega**2) + secant * np.outer(model.phi, model.phi)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law), load=force * model.phi)
    return oscillator, np.linalg.solve(matrix, force * model.phi)


def disturbed(rest: np.ndarray, size: float = DISTURBANCE) -> State:
    """Every mode off its place by the part `size` of the largest, with signs that alternate."""
    signs = np.where(np.arange(rest.size) % 2 == 0, 1.0, -1.0)
    return State(displacement=rest + size * np.abs(rest).max() * signs, velocity=np.zeros(rest.size))


def growth_rate(
    oscillator: ImpactOscillator, rest: np.ndarray, method: Integrator, step: float, steps: int
) -> float:
    """Logarithm of the growth of a disturbance over `steps` steps, infinite if the contact opens."""
    times = step * np.arange(steps - SEEN + 1, steps + 1)
    try:
        run = simulate(oscillator, disturbed(rest), duration=step * steps, times=times, method=method)
    except Diverged:
        return math.inf
    touching = oscillator.model.phi @ rest > oscillator.stop.gap
    if touching and not (len(run.impacts) == 1 and np.isnan(run.impacts.end[0])):
        return math.inf
    size = float(np.abs(run.displacement - rest).max())
    if size == 0.0:
        return -math.inf
    return math.log(size / (DISTURBANCE * float(np.abs(rest).max())))


def grows(
    oscillator: ImpactOscillator, rest: np.ndarray, method: Integrator, step: float, steps: int = STEPS
) -> bool:
    """Whether a disturbance of the pressed contact grows under the method."""
    return growth_rate(oscillator, rest, method, step, steps) > math.log(GROWTH)
