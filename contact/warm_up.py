"""`python -m contact.warm_up`: compile the kernels once, so that the first study starts at once.

The machine code is kept (``contact.compiled``); without this the first run of a study takes some ten seconds
longer than the next.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from beam.reduction import ModalModel
from contact.drive import HarmonicDrive
from contact.laws import HertzContact, NewtonRestitution
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap, strobed_orbits

__all__ = ["compile_kernels"]


def compile_kernels() -> None:
    """Run every compiled kernel once on a small problem."""
    one = np.ones(1)
    oscillator = ImpactOscillator(
        model=ModalModel(
            omega=2 * math.pi / 40.80e-3 * one, decay_rate=3.56 * one, phi=one, participation=one
        ),
        stop=Stop(gap=0.01, law=HertzContact(stiffness=1e9)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)
    strobed = StroboscopicMap(oscillator=oscillator)
    strobed.orbit(strobed.steady(), 10)
    newton = replace(oscillator, stop=Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.1)))
    single = StroboscopicMap(oscillator=newton)
    strobed_orbits([single, single], [single.steady()] * 2, 10, workers=1)
    single.orbit(single.steady(), 10)
    Shooting(oscillator=oscillator, period=5).at_speed(0.1)


if __name__ == "__main__":
    compile_kernels()
