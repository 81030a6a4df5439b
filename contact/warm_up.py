"""`python -m contact.warm_up [--all]`: compile kernels once, so that the first study starts at once.

The machine code is kept (``contact.machine.compiled``).  Otherwise the first run of a study takes half a
minute longer than the next.  Two processes share the work: kernels of a motion, and kernels of an orbit.  The
option adds the kernels of several stops, which the tests need as well.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

from beam import single_mode
from contact.drive import HarmonicDrive
from contact.hertz import HertzContact
from contact.laws import ContactLaw, NewtonRestitution
from contact.maps.stroboscope import StroboscopicMap
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop


def _oscillator(law: ContactLaw) -> ImpactOscillator:
    return ImpactOscillator(
        model=single_mode(free_period=40.80e-3, decay_rate=3.56),
        stop=Stop(gap=0.01, law=law),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)


def _motions() -> None:
    for law in (HertzContact(stiffness=1e9), NewtonRestitution(local_restitution=0.1)):
        strobed = StroboscopicMap(oscillator=_oscillator(law))
        strobed.orbit(strobed.steady(), 10)


def _orbits() -> None:
    Shooting(oscillator=_oscillator(HertzContact(stiffness=1e9)), m=5).at_speed(0.1)


def _several() -> None:
    one = _oscillator(NewtonRestitution(local_restitution=0.1))
    simulate(replace(one, stops=(*one.stops, Stop(gap=0.01, law=one.stop.law, side=-1))), periods=2)


if __name__ == "__main__":
    with ProcessPoolExecutor(max_workers=2, mp_context=get_context("spawn")) as pool:
        more = [_several] if "--all" in sys.argv else []
        for task in [pool.submit(kernels) for kernels in (*more, _orbits, _motions)]:
            task.result()
