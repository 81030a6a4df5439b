"""A beam swung on a spring: case SDNL32 of the code_aster test base.

A square bar, pinned at one end, turns as a rigid body at -3.8 rad/s; at t = 0 its free end meets a spring.
Modes: the rotation, w = phi_0 s/L with phi_0 = sqrt(3/(rho A L)), and bending modes of the pinned-free bar
(``beam.frequency_equation``) with 1 % damping.
"""

from __future__ import annotations

import math

import numpy as np

from beam import ModalModel, UniformBeam, exact_modes
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.trajectory import State

__all__ = ["LENGTH", "SDNL32", "TURNING", "swung_beam"]

LENGTH, TURNING = 0.783, 3.8
"""Length of the beam [m] and its first rate of turning [rad/s]."""

SDNL32 = {
    18000.0: [-2.66, -4.33, -4.92, -4.78, -3.82, -2.87, -2.71, -3.09, -3.41, -3.36, -2.64, -0.742],
    45000.0: [-2.25, -2.66, -1.96, -1.15, -0.124, -0.364, -2.01, -2.74, -1.89, -0.352, 1.70, 4.99],
}
"""Tip displacement at 1 ... 12 ms [mm], for each stiffness [N/m]."""


def swung_beam(
    stiffness: float, bending_modes: int = 9, damping_ratio: float = 0.01
) -> tuple[ImpactOscillator, State]:
    """The beam of SDNL32, pinned at one end and turning at -3.8 rad/s, as its free end meets the spring.

    The stop lies where the tip moves to, so that the model counts positive what the source counts negative.
    """
    side, modulus, density = 0.014, 6.7e10, 2400.0
    line = density * side**2
    beam = UniformBeam(
        length=LENGTH,
        bending_stiffness=modulus * side**4 / 12,
        mass_per_length=line,
        supports=("pinned", "free"),
    )
    bending = exact_modes(beam, bending_modes)
    phi = np.append(math.sqrt(3 / (line * LENGTH)), bending.phi)  # turning as a whole: w = s phi_0 / L
    model = ModalModel(
        omega=np.append(0.0, bending.omega), decay_rate=np.append(0.0, 2 * damping_ratio * bending.omega),
        phi=phi, participation=np.zeros(phi.size),
    )  # fmt: skip
    velocity = np.zeros(phi.size)
    velocity[0] = TURNING * LENGTH / phi[0]
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=stiffness)))
    return oscillator, State(displacement=np.zeros(phi.size), velocity=velocity)
