"""A contact that lasts: the tip pressed on the stop, and whether a method lets a disturbance grow there.

    q'' + C q' + K q = F phi - phi N(d),   d = phi . q (gap zero),   K = diag(omega_k^2),   N = k d

The rest position solves (K + k phi phi^T) q = F phi. Its penetration is above zero, and as long as a
disturbance is small against it the motion is linear. The state that a step of the method leaves as it is may
differ from that by the error of the method; about it, a method is called unstable if a disturbance of the
displacements by 1e-9 of the state, in (omega q, q'), has grown 1e5-fold within the run, or has opened the
contact. At a limit where two amplification factors meet at -1 a disturbance grows only in proportion to the
steps; beyond it, at h omega = 2 (1 + e) for central difference, as exp(sqrt(8 e) n): the test tells the two
apart from e = 5e-8 on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes

from beam import ModalModel
from contact import Diverged, ImpactOscillator, LinearContact, State, StepTooLarge, Stop, simulate
from contact.integrators import CentralDifference, Splitting
from studies import plotting
from studies.stability import threshold

__all__ = [
    "SHARE", "STEPS", "Stepped", "growth", "grows", "modal_stiffness", "plane", "pressed", "refused",
    "settled", "show_plane", "stiffest",
]  # fmt: skip

Stepped = CentralDifference | Splitting
"""Methods with a fixed step and a limit that can be overridden."""

STEPS = 20_000
DISTURBANCE, GROWTH = 1e-9, 1e5
SHORTER = (20, 150, 1000)
"""Steps of the runs that go before a long one: what grows fast is seen early and not followed further."""
IN_PLANE = 3000
"""Steps of a run in a plane: growth by less than 0.4 % a step is not seen there."""
SHARE = 0.01
"""How far beyond a limit a refusal is tried, relative."""
SLOPE = 1e-4
"""Size of the displacements from which the slopes of a step are taken, relative to the state."""


def modal_stiffness(model: ModalModel) -> float:
    """Stiffness of mode 1 at the tip, omega_1^2/phi_1^2 [N/m]."""
    return float(model.omega[0] ** 2 / model.phi[0] ** 2)


def pressed(model: ModalModel, stiffness: float) -> tuple[ImpactOscillator, State]:
    """The tip pressed on a linear stop of `stiffness` [N/m] by 1 N, and its state at rest."""
    stop = Stop(gap=0.0, law=LinearContact(stiffness=stiffness))
    matrix = np.diag(model.omega**2) + stiffness * np.outer(model.phi, model.phi)
    rest = np.linalg.solve(matrix, model.phi)
    oscillator = ImpactOscillator(model=model, stop=stop, load=model.phi)
    return oscillator, State(displacement=rest, velocity=np.zeros_like(rest))


def settled(oscillator: ImpactOscillator, rest: State, method: Stepped) -> State:
    """The state that a step leaves as it is, by Newton's method from the state at rest.

    The slopes are differences of steps, exact where the map is piecewise affine. The rounding of the tip's
    place, 1e-16 of its deflection by the load alone, limits both: the deflection is up to 1e6 of the
    penetration here. If the iteration does not end, the last state is given.
    """
    n = oscillator.n_modes
    weight = np.concatenate([oscillator.model.omega, np.ones(n)])

    def after(x: np.ndarray) -> np.ndarray:
        start = State(displacement=x[:n], velocity=x[n:])
        end = simulate(oscillator, start, duration=method.step, method=method).end
        return np.concatenate([end.displacement, end.velocity])

    x = np.concatenate([rest.displacement, rest.velocity])
    for _ in range(8):
        here = after(x)
        residual = weight * (here - x)
        if np.abs(residual).max() <= 1e-11 * np.abs(weight * x).max():
            break
        size = SLOPE * np.abs(weight * x).max()
        slope = np.array([weight * (after(row) - here) / size for row in x + size * np.diag(1.0 / weight)]).T
        x = x + np.linalg.solve(np.eye(2 * n) - slope, residual) / weight
    return State(displacement=x[:n], velocity=x[n:])


def growth(oscillator: ImpactOscillator, rest: State, method: Stepped, steps: int = STEPS) -> float:
    """Logarithm of the growth of a disturbance per step, infinite if it opens the contact at once [1].

    Taken where the disturbance grows from the root of `GROWTH` to `GROWTH` (what is there at the start need
    not be the mode that grows), or between the halves of a run in which it does not get there.
    """
    free = replace(method, beyond_limit=True)
    still = settled(oscillator, rest, free)
    weight = np.concatenate([oscillator.model.omega, np.ones(oscillator.n_modes)])
    place = np.concatenate([still.displacement, still.velocity])
    first = DISTURBANCE * float(np.abs(weight * place).max())
    signs = np.where(np.arange(oscillator.n_modes) % 2 == 0, 1.0, -1.0)
    start = replace(still, displacement=still.displacement + first * signs / oscillator.model.omega)
    touching = bool(oscillator.model.phi @ rest.displacement > oscillator.stop.gap)
    for count in (*SHORTER, steps):
        marks = np.unique(np.geomspace(1, count, 400).astype(int))
        times = free.step * marks
        try:
            run = simulate(oscillator, start, duration=free.step * count, times=times, method=free)
        except Diverged:
            return math.inf
        states = np.concatenate([run.displacement, run.velocity], axis=1)
        away = np.abs(weight * (states - place)).max(axis=1)
        large = np.flatnonzero(away > GROWTH * first)
        if large.size:
            late, early = large[0], np.flatnonzero(away > math.sqrt(GROWTH) * first)[0]
            if late > early:
                return float(np.log(away[late] / away[early]) / (marks[late] - marks[early]))
            return float(np.log(away[late] / first) / marks[late])
        if touching and not (len(run.impacts) == 1 and np.isnan(run.impacts.end[0])):
            return math.inf
    early, late = away[marks <= steps // 2].max(), away[marks > steps // 2].max()
    return float(np.log(max(late, np.finfo(float).tiny) / early) / (steps / 2))


def grows(oscillator: ImpactOscillator, rest: State, method: Stepped, steps: int = STEPS) -> bool:
    """Whether a disturbance grows, the method's own check of its step left out."""
    return growth(oscillator, rest, method, steps) > math.log(GROWTH) / steps


def refused(oscillator: ImpactOscillator, rest: State, method: Stepped) -> bool:
    """Whether the method says within 40 steps from the state that its step is too large."""
    try:
        simulate(oscillator, rest, duration=40 * method.step, method=method)
    except StepTooLarge:
        return True
    return False


def stiffest(
    model: ModalModel, method: Stepped, theory: float, beyond: Sequence[float] = (3.0,), steps: int = STEPS
) -> tuple[float | None, bool]:
    """The largest stiffness of a lasting contact [N/m], and whether one beyond `theory` is refused.

    Parts `beyond` of the limit by theory are tried until one fails, and the motion is bisected up to it.
    """

    def fails(k: float) -> bool:
        return grows(*pressed(model, k), method, steps)

    end = next((part for part in beyond if fails(part * theory)), beyond[-1])
    found = threshold(fails, 0.5 * theory, end * theory, relative=1e-7)
    return found, refused(*pressed(model, (1 + SHARE) * theory), method)


def plane(
    model: ModalModel, make: Callable[[float], Stepped], angles: np.ndarray, parts: np.ndarray
) -> np.ndarray:
    """Growth per step for steps h omega_N in `angles` and stiffnesses `parts` of that of mode 1, as rows and
    columns; infinite or above ln(1e5)/3000 is growth."""
    highest, modal = float(model.omega[-1]), modal_stiffness(model)
    return np.array([
        [growth(*pressed(model, float(k) * modal), make(float(x) / highest), IN_PLANE) for k in parts]
        for x in angles
    ])  # fmt: skip


def show_plane(axes: Axes, angles: np.ndarray, parts: np.ndarray, rate: np.ndarray) -> None:
    """Points where the pressed modes stay bounded or not, over contact stiffness and step."""
    k, h = np.meshgrid(parts, angles)
    unstable = rate > math.log(GROWTH) / IN_PLANE
    axes.plot(k[~unstable], h[~unstable], linestyle="none", marker=".", markersize=2.5, color=plotting.BLUE,
              label="motion: bounded")  # fmt: skip
    axes.plot(k[unstable], h[unstable], linestyle="none", marker="x", markersize=2.8, markeredgewidth=0.6,
              color=plotting.VERMILION, label="motion: grows or opens")  # fmt: skip
    axes.set_xscale("log")
    plotting.label(axes.xaxis, "contact stiffness / modal stiffness")
