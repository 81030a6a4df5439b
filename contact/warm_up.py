"""`python -m contact.warm_up`: compile the kernels once, so that the first study starts at once.

The machine code is kept (``contact.compiled``); without this the first run of a study takes some ten seconds
longer than the next.
"""

from __future__ import annotations

from beam.reduction import single_mode
from contact.drive import HarmonicDrive
from contact.laws import HertzContact
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap

__all__ = ["compile_kernels"]


def compile_kernels() -> None:
    """Run every compiled kernel once on a small problem."""
    oscillator = ImpactOscillator(
        model=single_mode(free_period=40.80e-3, decay_rate=3.56),
        stop=Stop(gap=0.01, law=HertzContact(stiffness=1e9)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)
    strobed = StroboscopicMap(oscillator=oscillator)
    strobed.orbit(strobed.steady(), 10)
    Shooting(oscillator=oscillator, period=5).at_speed(0.1)


if __name__ == "__main__":
    compile_kernels()
