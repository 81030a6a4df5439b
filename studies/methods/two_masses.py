"""Two masses and a one-sided spring: example 03 of NLvib (M. Krack and J. Gross, Harmonic Balance for
Nonlinear Vibration Problems, Springer 2019; maltekrack/NLvib at 69598c5).

Masses 1 and 1, springs 0, 1, 1 with dampers 0.03 times these, a one-sided spring of 100 at gap 1 on mass 1, a
force f cos(W t) on mass 2 (0.1 in the source; SI units).  A constant force on coordinate j is participation_k
= phi_k(j) with the base amplitude Z = f/W^2.
"""

from __future__ import annotations

import numpy as np

from beam import ModalModel
from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop


def two_masses(w: float, force: float = 0.1) -> ImpactOscillator:
    """The system driven at W = `w` [rad/s] by `force` [N]; the read-out is mass 2, which the source plots."""
    squares, shapes = np.linalg.eigh(np.array([[1.0, -1.0], [-1.0, 2.0]]))
    model = ModalModel(
        omega=np.sqrt(squares),
        decay_rate=0.03 * squares,
        phi=shapes[0],
        participation=shapes[1],
        readouts={"mass 2": shapes[1]},
    )
    drive = HarmonicDrive(frequency=w / (2.0 * np.pi), amplitude=force / w**2)
    return ImpactOscillator(model=model, stop=Stop(gap=1.0, law=LinearContact(stiffness=100.0)), drive=drive)
