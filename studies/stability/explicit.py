r"""Central difference: its limits in flight and in contact, and the energy it makes within them.

With y_n ~ z^n and a unit vector x, the step of M = 1, K, C obeys for centred damping

    (z - 1)^2 + (h c/2)(z^2 - 1) + h^2 kappa z = 0,      c = x*Cx,  kappa = x*Kx,

and for lagged damping (z - 1)^2 + h c (z - 1) + h^2 kappa z = 0. All roots lie in the unit disc if and only
if h^2 K <= 4 (centred) and h^2 K + 2 h C <= 4 (lagged), as matrices: sufficient by Schur's conditions on the
quadratics, necessary because the determinant changes sign between z = -1 and z = -infinity. So

    one mode, centred and lagged     h omega = 2,   h omega = 2 (sqrt(1 + zeta^2) - zeta)
    lasting contact, lagged          1/k = sum_k phi_k^2 / (4/h^2 - 2 c_k/h - omega_k^2)                   (a)

the latter with centred damping without the term in c_k. Source for one mode: T. Belytschko, Computational
Methods for Transient Analysis (1983), ch. 1; (a) is derived here.

Stable is not exact. A free mass meets a spring, x = h omega_c. While the force acts, E = v_{n+1/2}^2/2 +
omega_c^2 y_n y_{n+1}/2 is constant; with a part s of a step inside at the first grid point and a part s' at
the last one

    (v_out/v_in)^2 = (1 - x^2 s (1 - s)) / (1 - x^2 s' (1 - s')),                                          (b)

between 1 - x^2/4 and its inverse. With W = 2 arcsin(x/2) the grid points in contact are y_j = h v (s sin jW +
(1 - s) sin (j-1)W)/sin W, which gives the last of them above zero and the velocity out: one short contact
may make any energy as x -> 2. If it takes a whole number n of steps, x = 2 sin(pi/(2n)), then s' = 1 - s and
no step is wrong in its energy: a test of convergence with commensurate steps shows none of the error.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from beam import ModalModel
from contact import ContactError, ContactLaw, ImpactOscillator, LinearContact, State, Stop, simulate
from contact.integrators import CentralDifference
from studies import plotting
from studies.scene import Scene, hertz_of, model_of
from studies.stability import Findings, Limit, threshold
from studies.stability.lasting_contact import ROUNDED, SHARE, growth, refused, stiffest

__all__ = [
    "critical_stiffness", "draw", "flight", "free_body", "lasting", "measure", "rebound", "rebound_ratio",
]  # fmt: skip

HELD, FAR = 1e-3, LinearContact(stiffness=1e-12)
"""Place at which one mode of 1 rad/s is held [m], half a metre before a stop that it does not feel."""
MASS, SPEED, GAP = 0.005, 0.1, 1e-3
"""Mass of the free body that meets the stop [kg], its approach speed [m/s] and the gap before it [m]."""

Row = partial(Limit, family="explicit", method=CentralDifference.name)


def critical_stiffness(model: ModalModel, step: float, lagged: bool) -> float:
    """Equation (a) [N/m]."""
    room = 4.0 / step**2 - lagged * 2.0 * model.decay_rate / step - model.omega**2
    return 1.0 / float(np.sum(model.phi**2 / room))


def flight(ratio: float, lagged: bool) -> Limit:
    """Largest step of one mode in flight, held off its rest position."""
    one = np.ones(1)
    model = ModalModel(omega=one, decay_rate=2.0 * ratio * one, phi=one, participation=one)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.5, law=FAR), load=HELD * one)
    rest = State(displacement=HELD * one, velocity=0.0 * one)
    theory = 2.0 * (math.sqrt(1.0 + ratio**2) - ratio) if lagged else 2.0

    def fails(h: float) -> bool:
        return growth(oscillator, rest, CentralDifference(step=h, lagged=lagged)) > ROUNDED

    return Row(
        case=f"one mode in flight, {'lagged' if lagged else 'centred'} damping, zeta = {ratio:g}",
        parameter="h omega [1]", theory=theory,
        measured=threshold(fails, (0.2 * theory, 2.0 * theory), relative=1e-8),
        refused=refused(oscillator, rest, CentralDifference(step=(1 + SHARE) * theory, lagged=lagged)),
    )  # fmt: skip


def lasting(model: ModalModel, lagged: bool) -> Limit:
    """Largest stiffness of a lasting contact at h omega_N = 1."""
    method = CentralDifference(step=1.0 / float(model.omega[-1]), lagged=lagged)
    theory = critical_stiffness(model, method.step, lagged)
    measured, beyond_refused = stiffest(model, method, theory)
    return Row(
        case=f"lasting contact, modes: {model.n_modes}, {'lagged' if lagged else 'centred'} damping, "
        "h omega_N = 1",
        parameter="contact stiffness [N/m]", theory=theory, measured=measured, refused=beyond_refused,
    )  # fmt: skip


def free_body(law: ContactLaw) -> ImpactOscillator:
    """A body of `MASS`, a mode of zero frequency, before its stop."""
    none, phi = np.zeros(1), np.ones(1) / math.sqrt(MASS)
    model = ModalModel(omega=none, decay_rate=none, phi=phi, participation=none)
    return ImpactOscillator(model=model, stop=Stop(gap=GAP, law=law))


def rebound_ratio(frequency_step: float, part: float) -> float:
    """v_out/v_in of a free mass on a spring for h omega_c and the part s of a step, in closed form [1]."""
    turn = 2.0 * math.asin(0.5 * frequency_step)
    delay = math.atan2((1.0 - part) * math.sin(turn), part + (1.0 - part) * math.cos(turn))
    last = math.floor((math.pi + delay) / turn)

    def depth(j: int) -> float:
        return (part * math.sin(j * turn) + (1.0 - part) * math.sin((j - 1) * turn)) / math.sin(turn)

    return depth(last) - depth(last + 1)


def rebound(body: ImpactOscillator, step: float, part: float, lasts: float) -> float:
    """v_out/v_in of the body by the method, the first grid point `part` h v inside; infinite if it fails [1].

    `lasts` is the time that the contact takes [s]; twice that and eight steps are followed.
    """
    root = math.sqrt(MASS)
    place, speed = np.array([GAP - (3.0 - part) * step * SPEED]), np.array([SPEED])
    start = State(displacement=place * root, velocity=speed * root)
    method = CentralDifference(step=step, beyond_limit=True)
    try:
        run = simulate(body, start, duration=step * (8.0 + math.ceil(2.0 * lasts / step)), method=method)
    except ContactError:
        return math.inf
    return float(-run.end.velocity[0] / (SPEED * root))


def short_contacts(hertz: ContactLaw, lasts: float, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """Energy after one short contact that takes `lasts` [s], over the phases of the grid, for both laws."""
    omega_c = math.pi / lasts
    linear = free_body(LinearContact(stiffness=MASS * omega_c**2))
    parts = (np.arange(16 if quick else 96) + 0.5) / (16 if quick else 96)
    whole = [2.0 * math.sin(0.5 * math.pi / n) for n in range(2, 13)]
    grid = np.unique(np.concatenate([np.linspace(0.2, 1.98, 16 if quick else 72), whole]))

    def energies(body: ImpactOscillator, x: float) -> np.ndarray:
        return np.array([rebound(body, x / omega_c, float(s), lasts) for s in parts]) ** 2

    rows = [
        Row(
            case=f"one short linear contact, h omega_c = {x:.4g}{words}",
            parameter="largest E_out/E_in over the phases of the grid [1]",
            theory=max(rebound_ratio(x, float(s)) ** 2 for s in parts),
            measured=float(energies(linear, x).max()),
        )
        for x, words in ((1.2, ""), (1.8, ""), (whole[1], ", three steps"), (whole[6], ", eight steps"))
    ]  # fmt: skip
    arrays = {"frequency_step": grid}
    for name, body in (("linear", linear), ("Hertz", free_body(hertz))):
        change = np.array([energies(body, float(x)) for x in grid]) - 1.0
        arrays[f"{name}_loss"], arrays[f"{name}_gain"] = -change.min(axis=1), change.max(axis=1)
    return rows, arrays


def measure(scene: Scene, quick: bool) -> Findings:
    """Limits on the modes of the scene, and the energy of a short contact as long as Hertz's."""
    model, hertz = model_of(scene), hertz_of(scene)
    counts = sorted({min(n, model.n_modes) for n in ((1, 5) if quick else (1, 2, 5, 15))})
    ratios = (0.0, 0.1, 1.0) if quick else (0.0, 0.01, 0.1, 0.3, 1.0, 3.0)
    short, arrays = short_contacts(hertz, hertz.contact_time(MASS, SPEED), quick)
    single = [flight(ratio, lagged) for lagged in (False, True) for ratio in ratios]
    contacts = [lasting(model.truncated(n), lagged) for lagged in (False, True) for n in counts]
    return Findings(limits=[*single, *contacts, *short], arrays=arrays)


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Energy of one short contact."""
    figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.080)
    x, fine = arrays["frequency_step"], np.linspace(0.2, 1.985, 300)
    bounds = {"gain": 1.0 / (1.0 - 0.25 * fine**2) - 1.0, "loss": 0.25 * fine**2}
    for (part, bound), colour in zip(bounds.items(), (plotting.VERMILION, plotting.BLUE), strict=True):
        axes.plot(fine, bound, color=colour, label=f"bound of the {part}, linear")
        for law, marker in (("linear", "o"), ("Hertz", "x")):
            axes.plot(x, arrays[f"{law}_{part}"], color=colour, marker=marker, linestyle="none",
                      markersize=2.5, markerfacecolor="none", label=f"{part}, {law}")  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 1e2)
    plotting.label(axes.xaxis, "step × contact frequency h ω$_c$")
    plotting.label(axes.yaxis, "largest relative change of energy")
    figure.legend(loc="outside lower center", ncols=2)
    return figure, (
        "Central difference: energy made and lost in one short contact within the limit of stability, "
        "largest over the phases of the grid: none if a linear contact takes a whole number of steps."
    )
