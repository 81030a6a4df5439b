"""The energy of an undamped beam that meets a stop again and again, contact after contact.

The beam is struck at its tip, off the stop, and left alone; the stop has gap 0.  Under a linear contact the
motion can then be scaled at will, so that growth over any number of contacts fits into numbers: the blow is
`SMALL`, and 200 decades of speed lie between it and a motion that counts as diverged or has vanished.  The
energy E = sum (v^2 + omega^2 q^2)/2 + k max(0, d)^2/2 is taken at grid points, where no interpolation enters;
for a method that keeps it, it stays.

Stiffnesses are given in units of k_modal = omega_max^2 / sum phi^2, so that the closed contact vibrates at
about w = omega_max sqrt(k/k_modal).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from beam import ModalModel
from contact.errors import Diverged
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.method import Integrator
from contact.laws import LINEAR, ContactLaw, LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State, Trajectory
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of

__all__ = [
    "History",
    "Maker",
    "conservative",
    "evenly",
    "history",
    "modal_stiffness",
    "rigid_contact",
    "single_contact",
]

SMALL = 2.0**-332
"""Speed of the tip after the blow, 1.1e-100 [m/s]: a power of two, so that the scaled motion rounds alike."""

Maker = Callable[[float], Integrator]
"""A method for a step [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class History:
    """Energy over that at the start, as a logarithm, at grid points; `contacts` have begun until then.

    Parameters
    ----------
    contacts : ndarray of int, shape (n,)
    log_energy : ndarray, shape (n,)
        Minus infinity where nothing is left [1].
    diverged : bool
        Whether the energy left the range of numbers; the history then ends short of that.
    """

    contacts: np.ndarray
    log_energy: np.ndarray
    diverged: bool

    @property
    def growth(self) -> float:
        """Mean growth of ln(energy) per contact [1]."""
        return float(self.log_energy[-1]) / max(1, int(self.contacts[-1]))

    def contacts_to(self, factor: float) -> float:
        """Contacts until the energy first reaches `factor` times that at the start; NaN if it never does."""
        reached = np.flatnonzero(self.log_energy >= math.log(factor))
        return float(self.contacts[reached[0]]) if reached.size else math.nan


def conservative(scene: Scene, modes: int) -> ModalModel:
    """The beam of the scene without its damping."""
    model = model_of(scene.replace({"modes.count": modes}))
    return ModalModel(
        omega=model.omega, decay_rate=np.zeros(modes), phi=model.phi, participation=model.participation
    )


def modal_stiffness(model: ModalModel) -> float:
    """k_modal [N/m]."""
    return float(model.omega.max() ** 2 / (model.phi @ model.phi))


def history(
    model: ModalModel, law: ContactLaw, make: Maker, size: float, contacts: int, samples: int = 400
) -> History:
    """About `contacts` contacts, two in each period of the first mode, with h omega_max = `size`."""
    h = size / float(model.omega.max())
    beam = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law))
    compliance = float(model.phi @ model.phi)
    start = State(displacement=np.zeros(model.omega.size), velocity=-SMALL / compliance * model.phi)
    steps = max(2, math.ceil(contacts * math.pi / float(model.omega.min()) / h))

    def run(steps: int) -> tuple[np.ndarray, Trajectory]:
        every = np.unique(np.round(np.geomspace(1, steps, samples))).astype(int)
        return every, simulate(beam, start, duration=steps * h, times=every * h, method=make(h))

    diverged = False
    try:
        every, motion = run(steps)
    except Diverged as error:
        diverged = True
        every, motion = run(max(1, int(0.98 * error.time / h) - 1))
    q, v = motion.displacement / SMALL, motion.velocity / SMALL
    energy = beam.energy(q, v)
    if law.code == LINEAR:
        energy = energy + 0.5 * law.numbers[0] * np.maximum(q @ model.phi, 0.0) ** 2
    with np.errstate(divide="ignore"):
        log_energy = np.log(2.0 * compliance * energy)
    begun = np.searchsorted(motion.impacts.start, every * h, side="right")
    return History(contacts=begun, log_energy=log_energy, diverged=diverged)


def single_contact(make: Maker, stiffness: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Energy after over energy before one contact of a free mass of 1 kg, step 1 s, speed 1 m/s, for pairs of
    (h w)^2 and place u of the touch in its step, w the frequency of the mass on the contact."""
    model = ModalModel(omega=np.zeros(1), decay_rate=np.zeros(1), phi=np.ones(1), participation=np.ones(1))
    start = State(displacement=np.zeros(1), velocity=np.ones(1))
    left = []
    for k, u in zip(stiffness, places, strict=True):
        mass = ImpactOscillator(
            model=model, stop=Stop(gap=2.0 + float(u), law=LinearContact(stiffness=float(k)))
        )
        duration = 10.0 + math.ceil(1.5 * math.pi / math.sqrt(k))
        left.append(float(simulate(mass, start, duration=duration, method=make(1.0)).end.velocity[0]) ** 2)
    return np.array(left)


def evenly(product: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """`count` pairs for ``single_contact`` around h w = `product`: the touch evenly distributed in its step,
    and so the release, by contact times pi/w that spread over one step, or over a third of themselves if that
    is less."""
    index = np.arange(count)
    place = (index * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0 - 0.5
    steps = math.pi / product + place * min(1.0, math.pi / (3.0 * product))
    return (math.pi / steps) ** 2, (index + 0.5) / count


def rigid_contact(method: GeneralisedAlpha, places: np.ndarray, steps: int = 60) -> np.ndarray:
    """The same as ``single_contact`` for h w -> infinity, where penetration d and force N of a step obey

        N >= 0,  d <= 0,  one of them zero,   d = d* - beta (1 - alpha_f)/(1 - alpha_m) N   (h = 1, m = 1),

    solved for all places at once; after 60 steps the acceleration has faded unless rho is close to 1."""
    new = (1.0 - method.alpha_f) / (1.0 - method.alpha_m)
    depth, speed = -places, np.ones(places.size)
    a, push = np.zeros(places.size), np.zeros(places.size)
    for _ in range(steps):
        free = -(method.alpha_m * a + method.alpha_f * push) / (1.0 - method.alpha_m)
        reached = depth + speed + (0.5 - method.beta) * a + method.beta * free
        push = np.maximum(0.0, reached / (method.beta * new))
        after = free - new * push
        depth = reached - method.beta * new * push
        speed = speed + (1.0 - method.gamma) * a + method.gamma * after
        a = after
    return speed**2
