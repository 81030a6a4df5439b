r"""What a fixed step does to the energy in one short contact: central difference.

A free mass meets a spring, h omega_c = h sqrt(k/m). While the force acts,
E = v_{n+1/2}^2/2 + omega_c^2 y_n y_{n+1}/2 is constant; with a part s of a step inside at the first grid
point and a part s' at the last one

    (v_out/v_in)^2 = (1 - (h omega_c)^2 s (1 - s)) / (1 - (h omega_c)^2 s' (1 - s')),                      (a)

between 1 - (h omega_c/2)^2 and its inverse. With W = 2 arcsin(h omega_c/2) the grid points in contact are
y_j = h v (s sin jW + (1 - s) sin (j-1)W)/sin W, which gives the last of them above zero, y_n, and v_out =
(y_n - y_{n+1})/h. So the gain in one short contact has no bound as h omega_c -> 2.
If the contact takes a whole number n of steps, h omega_c =
2 sin(pi/(2n)), the motion is symmetric, s' = 1 - s, and no step is wrong in its energy: a test of
convergence with commensurate steps shows none of the error.

Under Hertz's law there is no such invariant; the same runs show the same picture.  Units: SI.
"""

from __future__ import annotations

import math

import numpy as np

from beam import ModalModel
from contact.errors import ContactError
from contact.integrators import CentralDifference
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.oscillators import hertz_of
from studies.instruments.scene import Scene
from studies.instruments.stability.findings import Limit

__all__ = ["MASS", "NAME", "collisions", "free_body", "rebound_of", "rebound_ratio"]

NAME = CentralDifference.name
MASS = 0.005
"""Mass of the free body that meets the stop [kg]."""


def free_body() -> ModalModel:
    """A body of `MASS` as a mode of zero frequency."""
    none = np.zeros(1)
    return ModalModel(
        omega=none, decay_rate=none, phi=np.ones(1) / math.sqrt(MASS), participation=none
    )


def rebound_ratio(frequency_step: float, part: float) -> float:
    """v_out/v_in of a free mass on a spring for h omega_c and the part s of (b), in closed form [1]."""
    turn = 2.0 * math.asin(0.5 * frequency_step)
    delay = math.atan2((1.0 - part) * math.sin(turn), part + (1.0 - part) * math.cos(turn))
    last = math.floor((math.pi + delay) / turn)

    def depth(j: int) -> float:
        return (part * math.sin(j * turn) + (1.0 - part) * math.sin((j - 1) * turn)) / math.sin(turn)

    return depth(last) - depth(last + 1)


def rebound_of(
    oscillator: ImpactOscillator, speed: float, lasts: float, step: float, part: float
) -> float:
    """v_out/v_in of the body of `MASS` by the method itself, the first grid point `part` h v inside [1].

    `lasts` is the time that the contact takes [s]; twice that and eight steps are followed.
    """
    root = math.sqrt(MASS)
    gap = oscillator.stop.gap
    start = State(
        displacement=np.array([gap - (3.0 - part) * step * speed]) * root, velocity=np.array([speed]) * root
    )
    method = CentralDifference(step=step, beyond_limit=True)
    length = step * (8.0 + math.ceil(2.0 * lasts / step))
    try:
        run = simulate(oscillator, start, duration=length, method=method)
    except ContactError:
        return math.inf
    return float(-run.end.velocity[0] / (speed * root))


def _default_gain(oscillator: ImpactOscillator, speed: float) -> float:
    """Relative energy change of the body with the exact method of the law."""
    root = math.sqrt(MASS)
    start = State(
        displacement=np.array([0.5 * oscillator.stop.gap]) * root, velocity=np.array([speed]) * root
    )
    run = simulate(oscillator, start, duration=4.0 * oscillator.stop.gap / speed)
    return float(abs((run.end.velocity[0] / (speed * root)) ** 2 - 1.0))


def collisions(scene: Scene, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """One short contact of a free body: what the step does to its energy."""
    speed = 0.1
    body = free_body()
    hertz = hertz_of(scene)
    lasts = hertz.contact_time(MASS, speed)
    linear = ImpactOscillator(
        model=body, stop=Stop(gap=1e-3, law=LinearContact(stiffness=MASS * (math.pi / lasts) ** 2))
    )
    ball = ImpactOscillator(model=body, stop=Stop(gap=1e-3, law=hertz))
    omega_c = math.pi / lasts
    parts = (np.arange(24 if quick else 96) + 0.5) / (24 if quick else 96)
    # a grid of steps that includes the commensurate ones
    whole = [2.0 * math.sin(0.5 * math.pi / n) for n in range(2, 13)]
    grid = np.unique(np.concatenate([np.linspace(0.2, 1.98, 24 if quick else 72), whole]))
    table = {"frequency_step": grid, "commensurate": np.array(whole)}
    for name, oscillator in (("linear", linear), ("hertz", ball)):
        ratios = np.array(
            [[rebound_of(oscillator, speed, lasts, x / omega_c, s) for s in parts] for x in grid]
        )
        energy = ratios**2 - 1.0
        table[f"{name}_lowest"], table[f"{name}_highest"] = energy.min(axis=1), energy.max(axis=1)
    limits = []
    for x in (1.2, 1.8):
        ratios = np.array([rebound_of(linear, speed, lasts, x / omega_c, s) for s in parts])
        scheme = np.array([rebound_ratio(x, s) for s in parts])
        limits.append(
            Limit(
                method=NAME, case=f"energy after one short linear contact, h omega_c = {x:g}",
                knob="largest E_out/E_in over the phase of the grid [1]", theory=float(np.max(scheme**2)),
                measured=float(np.max(ratios**2)), refused=None,
                note=f"theory in closed form at the same phases, bound (a) {1.0 / (1.0 - 0.25 * x * x):.4g}; "
                "stable and accepted, yet energy is made; the exact default changes it by "
                f"{_default_gain(linear, speed):.0e}",
            )
        )  # fmt: skip
    for n in (3, 8):
        x = 2.0 * math.sin(0.5 * math.pi / n)
        ratios = np.array([rebound_of(linear, speed, lasts, x / omega_c, s) for s in parts])
        limits.append(
            Limit(
                method=NAME, case=f"energy after one linear contact of exactly {n} steps (commensurate)",
                knob="largest E_out/E_in over the phase of the grid [1]", theory=1.0,
                measured=float(np.max(ratios**2)), refused=None,
                note="a commensurate step hides the error of energy that its neighbours have",
            )
        )  # fmt: skip
    return limits, table
