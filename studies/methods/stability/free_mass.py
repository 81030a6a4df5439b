"""One contact of a free mass with a linear stop, by a method with a step: energy after it over before it.

Nothing depends on the units: with mass 1 kg and step 1 s a contact is given by its duration in steps, pi/x
with x = h omega_c, and by the place u of the touch in its step.
"""

from __future__ import annotations

import math

import numpy as np

from beam import ModalModel
from contact import ImpactOscillator, LinearContact, State, Stop, simulate
from contact.integrators import Integrator

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
