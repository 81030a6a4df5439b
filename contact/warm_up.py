"""`python -m contact.warm_up`: compile the kernels once, so that the first study starts at once.

The machine code is kept (``contact.compiled``); without this the first run of a study takes half a minute
longer than the next.  Two processes share the work: one what a motion needs, the other what an orbit needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.laws import HertzContact, NewtonRestitution
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap

__all__ = ["compile_kernels"]


def _oscillator() -> ImpactOscillator:
    one = np.ones(1)
    return ImpactOscillator(
        model=ModalModel(
            omega=2 * math.pi / 40.80e-3 * one, decay_rate=3.56 * one, phi=one, participation=one
        ),
        stop=Stop(gap=0.01, law=HertzContact(stiffness=1e9)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)


def _motions() -> None:
    oscillator = _oscillator()
    strobed = StroboscopicMap(oscillator=oscillator)
    strobed.orbit(strobed.steady(), 10)
    newton = replace(oscillator, stop=Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.1)))
    single = StroboscopicMap(oscillator=newton)
    single.orbit(single.steady(), 10)


def _orbits() -> None:
    Shooting(oscillator=_oscillator(), period=5).at_speed(0.1)


def _run(task: Callable[[], None]) -> None:
    task()


def compile_kernels() -> None:
    """Run every compiled kernel once on a small problem."""
    with ProcessPoolExecutor(max_workers=2, mp_context=get_context("spawn")) as pool:
        list(pool.map(_run, (_motions, _orbits)))


if __name__ == "__main__":
    compile_kernels()
