"""Central difference: its limits in flight and in contact, and the energy it makes within them.

``CentralDifference.critical_stiffness`` is the limit of a lasting contact.  A free mass meets a spring in one
short contact, x = h omega_c.  With a part s of a step inside at the first grid point and a part s' at the
last one

    (v_out/v_in)^2 = (1 - x^2 s (1 - s)) / (1 - x^2 s' (1 - s')).

With W = 2 arcsin(x/2) the grid points in contact are y_j = h v (s sin jW + (1 - s) sin (j-1)W)/sin W, which
gives the last of them above zero.  If the contact takes a whole number n of steps, x = 2 sin(pi/(2n)), no
step is wrong in its energy.  Derivation: ``docs/theory/steps.md``.
"""

import math
from functools import partial

import numpy as np

from beam import ModalModel
from contact.integrators import CentralDifference
from studies.methods.stability.model import Findings, Limit, energy_after, limit, stiffest
from studies.shell.scene import Scene, model_of

SOFT = 1e-12  # stiffness of a stop that a mode of 1 rad/s, 1 kg^-0.5 does not feel: it is in flight [N/m]

entry = partial(Limit, family="explicit")


def flight(ratio: float, lagged: bool) -> Limit:
    """Largest step of one mode in flight, held off its rest position by 1 N."""
    one = np.ones(1)
    model = ModalModel(omega=one, decay_rate=2.0 * ratio * one, phi=one, participation=one)
    case = f"one mode in flight, {'lagged' if lagged else 'centred'} damping, ζ = {ratio:g}"
    return limit(
        partial(entry, case=case, parameter="h ω"),
        model,
        2.0 * (math.sqrt(1.0 + ratio**2) - ratio) if lagged else 2.0,
        lambda h: (SOFT, CentralDifference(step=h, lagged=lagged)),
    )


def lasting(model: ModalModel, lagged: bool) -> Limit:
    """Largest stiffness of a lasting contact at h omega_N = 1."""
    damping = "lagged" if lagged else "centred"
    return stiffest(
        model,
        CentralDifference(step=1.0 / float(model.omega[-1]), lagged=lagged),
        family="explicit",
        case=f"lasting contact, modes: {model.n_modes}, {damping} damping, h ω_N = 1",
    )


def rebound_ratio(frequency_step: float, part: float) -> float:
    """v_out/v_in of a free mass on a spring for h omega_c and the part s of a step, in closed form [1]."""
    turn = 2.0 * math.asin(0.5 * frequency_step)
    delay = math.atan2((1.0 - part) * math.sin(turn), part + (1.0 - part) * math.cos(turn))
    last = math.floor((math.pi + delay) / turn)

    def depth(j: int) -> float:
        return (part * math.sin(j * turn) + (1.0 - part) * math.sin((j - 1) * turn)) / math.sin(turn)

    return depth(last) - depth(last + 1)


def energies(x: float, parts: np.ndarray) -> np.ndarray:
    """Energy after one contact that takes pi/x steps over that before it, the first grid point `parts` of a
    step inside [1]."""
    return energy_after(CentralDifference(step=1.0, beyond_limit=True), x, 1.0 - parts)


def measure(scene: Scene, quick: bool) -> Findings:
    """Limits on the modes of the scene, and the energy after one short contact over its phases."""
    model = model_of(scene)
    counts = sorted({min(n, model.n_modes) for n in ((1, 5) if quick else (1, 2, 5, 15))})
    ratios = (0.0, 0.1, 1.0) if quick else (0.0, 0.01, 0.1, 0.3, 1.0, 3.0)
    parts = (np.arange(16 if quick else 96) + 0.5) / (16 if quick else 96)
    whole = [2.0 * math.sin(0.5 * math.pi / n) for n in (3, 8)]
    short = [
        entry(
            method=CentralDifference.name,
            case=f"one short linear contact, h ω_c = {x:.4g}{words}",
            parameter="largest energy after/before over the phases",
            theory=max(rebound_ratio(x, float(s)) ** 2 for s in parts),
            measured=float(energies(x, parts).max()),
        )
        for x, words in ((1.2, ""), (1.8, ""), (whole[0], ", three steps"), (whole[1], ", eight steps"))
    ]
    single = [flight(ratio, lagged) for lagged in (False, True) for ratio in ratios]
    contacts = [lasting(model.truncated(n), lagged) for lagged in (False, True) for n in counts]
    return [*single, *contacts, *short], {}
