"""What the families share: the row of a limit, the search for it, a lasting contact, a short one.

**A contact that lasts.**  The tip is pressed on the stop; does a method let a disturbance grow there?

    q'' + C q' + K q = F phi - phi N(d),   d = phi . q (gap zero),   K = diag(omega_k^2),   N = k d

The rest position solves (K + k phi phi^T) q = F phi.  Its penetration is above zero, and as long as a
disturbance is small against it the motion is linear; with k -> 0 it is a flight.  A step of the method is a
map of the state (q, q') that leaves a state near to the rest position as it is.  The slopes of the map about
it are taken by differences of steps, which are exact where the map is piecewise affine.  Disturbances grow by
the largest modulus of the slopes' eigenvalues in each step.  A method is called unstable if that exceeds 1 by
more than the rounding of the differences.  Two eigenvalues that meet at -1, at h omega = 2 (1 + e) for
central difference, leave the circle by sqrt(8 e): the limit is found to e = 1e-15.

Theory is the limit by which the method itself refuses a step (``critical_stiffness``, derived in
its file); tests hold that against the frequencies of the closed contact and against closed forms.

**One short contact** of a free mass with a linear stop (`energy_after`).  Nothing depends on the units: with
mass 1 kg and step 1 s a contact is given by its duration in steps, pi/x with x = h omega_c, and by the place
u of the touch in its step.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from itertools import pairwise
from types import ModuleType
from typing import Annotated

import numpy as np

from beam import ModalModel
from contact import ImpactOscillator, LinearContact, State, StepTooLarge, Stop, simulate
from contact.integrators import CentralDifference, GeneralisedAlpha, Integrator, Splitting
from studies.shell.scene import Scene

FAMILIES = (
    "explicit",
    "splitting",
    "implicit_energy",
    "false_restitution",
    "missed_crossings",
    "accumulation",
)
"""In the order of the table."""

IMPLICIT: Mapping[str, Callable[[float], Integrator]] = {
    "trapezoidal rule": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, α = 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "HHT, α = 0.3": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.3),
    "gen.-α, ρ = 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "gen.-α, ρ = 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
"""The implicit methods that take the stop as a spring, for a step [s]."""


@dataclass(frozen=True, kw_only=True)
class Limit:
    """One quantity of one method: what theory gives for it and what was found."""

    family: Annotated[str, "family of failures; as in the option families"]
    method: Annotated[str, "method"]
    case: Annotated[str, "case"]
    parameter: Annotated[str, "what is limited or measured"]
    unit: Annotated[str, "unit of theory and measurement"] = "1"
    theory: Annotated[float | None, "theory; none where it gives no number"]
    measured: Annotated[float | None, "measured; none where the failure did not appear"]
    refused: Annotated[bool | None, "refused just beyond; none if there is nothing to refuse"] = None


Findings = tuple[Sequence[Limit], Mapping[str, np.ndarray]]
"""The rows of a family, and the arrays that its figure is drawn from; without arrays it has none."""


def family(name: str) -> ModuleType:
    """The file of a family."""
    return import_module(f"{__package__}.{name}")


def findings(name: str, scene: Scene, quick: bool) -> Findings:
    """What a family finds."""
    found: Findings = family(name).measure(scene, quick)
    return found


def threshold(fails: Callable[[float], bool], ladder: Sequence[float], relative: float) -> float | None:
    """Where `fails` turns true on a `ladder` of values above zero, to a part `relative`.

    The first interval whose end fails is halved at its geometric mean. None if nothing fails, or the first
    value does: a limit that was not seen on both sides is not a measured one.
    """
    if fails(ladder[0]):
        return None
    found = next(((low, high) for low, high in pairwise(ladder) if fails(high)), None)
    if found is None:
        return None
    low, high = found
    while abs(high - low) > relative * max(low, high):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    return math.sqrt(low * high)


SPEED = 2.0**-10
"""Of the approach [m/s]: a power of two, so that the scaled motion rounds alike and the stop lies within a
metre."""


def energy_after(method: Integrator, x: float, places: np.ndarray) -> np.ndarray:
    """Energy after over energy before, for each place of the touch in its step [1]."""
    one, law = np.ones(1), LinearContact(stiffness=x**2)
    model = ModalModel(omega=0.0 * one, decay_rate=0.0 * one, phi=one, participation=one)
    start = State(displacement=0.0 * one, velocity=SPEED * one)
    speeds = []
    for place in places.tolist():
        mass = ImpactOscillator(model=model, stop=Stop(gap=SPEED * (2.0 + place), law=law))
        end = simulate(mass, start, duration=10.0 + math.ceil(1.5 * math.pi / x), method=method).end
        speeds.append(float(end.velocity[0]) / SPEED)
    return np.array(speeds) ** 2


Stepped = CentralDifference | Splitting  # methods with a fixed step and a limit that can be overridden

ROUNDED = 1e-6
"""Growth per step below this is rounding: differences of 1e-4 of the state are good to 1e-11, of which two
eigenvalues that have met show the root."""
SHARE = 0.01  # how far beyond a limit a refusal is tried, relative
SLOPE = 1e-4  # size of the displacements from which the slopes of a step are taken, relative to the state


def pressed(model: ModalModel, stiffness: float) -> tuple[ImpactOscillator, State]:
    """The tip pressed on a linear stop of `stiffness` [N/m] by 1 N, and its state at rest."""
    stop = Stop(gap=0.0, law=LinearContact(stiffness=stiffness))
    matrix = np.diag(model.omega**2) + stiffness * np.outer(model.phi, model.phi)
    rest = np.linalg.solve(matrix, model.phi)
    oscillator = ImpactOscillator(model=model, stop=stop, load=model.phi)
    return oscillator, State(displacement=rest, velocity=np.zeros_like(rest))


def growth(oscillator: ImpactOscillator, rest: State, method: Stepped) -> float:
    """Logarithm of the growth of a disturbance per step about the state that a step leaves as it is, infinite
    if a contact opens there; the method's own check of its step is left out [1].

    The slopes, in (omega q, q'), lead from the states after the first step to those after the second, since a
    method may carry on more than it shows. Newton's method finds the start from which both are the same. The
    rounding of the tip's place, 1e-16 of its deflection by the load alone, limits it: the deflection is up to
    1e6 of the penetration here. If the iteration does not end, the last state is taken.
    """
    n, free, phi = oscillator.n_modes, replace(method, beyond_limit=True), oscillator.model.phi
    weight, times = np.concatenate([oscillator.model.omega, np.ones(n)]), free.step * np.array([1.0, 2.0])

    def two_steps(x: np.ndarray) -> np.ndarray:
        start = State(displacement=x[:n] / weight[:n], velocity=x[n:])
        run = simulate(oscillator, start, duration=times[1], times=times, method=free)
        return np.concatenate([run.displacement * weight[:n], run.velocity], axis=1)

    x = np.concatenate([weight[:n] * rest.displacement, rest.velocity])
    for _ in range(8):
        here, size = two_steps(x), SLOPE * np.abs(x).max()
        moved = np.array([two_steps(row) - here for row in x + size * np.eye(2 * n)]) / size
        first, second, residual = moved[:, 0].T, moved[:, 1].T, here[1] - here[0]
        if np.abs(residual).max() <= 1e-11 * np.abs(x).max():
            break
        x = x - np.linalg.solve(second - first, residual)
    gap, place = oscillator.stop.gap, phi @ (here[0, :n] / weight[:n])
    if phi @ rest.displacement > gap >= place:
        return math.inf
    return math.log(np.abs(np.linalg.eigvals(np.linalg.solve(first.T, second.T))).max())


def refused(oscillator: ImpactOscillator, rest: State, method: Stepped) -> bool:
    """Whether the method says within 40 steps from the state that its step is too large."""
    try:
        simulate(oscillator, rest, duration=40 * method.step, method=method)
    except StepTooLarge:
        return True
    return False


def limit(
    row: Callable[..., Limit], model: ModalModel, theory: float, at: Callable[[float], tuple[float, Stepped]]
) -> Limit:
    """The `row` of a parameter that is limited; `at` gives the stiffness [N/m] and the method at a value."""

    def fails(value: float) -> bool:
        stiffness, method = at(value)
        return growth(*pressed(model, stiffness), method) > ROUNDED

    stiffness, method = at((1.0 + SHARE) * theory)
    return row(
        method=method.name,
        theory=theory,
        measured=threshold(fails, (0.5 * theory, 1.5 * theory), 1e-8),
        refused=refused(*pressed(model, stiffness), method),
    )


def stiffest(model: ModalModel, method: Stepped, *, family: str, case: str) -> Limit:
    """The largest stiffness of a lasting contact."""
    row = partial(Limit, family=family, case=case, parameter="contact stiffness", unit="N/m")
    theory = method.critical_stiffness(pressed(model, 1.0)[0].numbers())
    return limit(row, model, theory, lambda stiffness: (stiffness, method))
