"""Impacts of a modal spring on a stop: exact flights, certified impacts, contact laws, maps and collisions.

    from beam import single_mode
    from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate

    oscillator = ImpactOscillator(
        model=single_mode(free_period=40.80e-3, decay_rate=3.56),
        stop=Stop(gap=0.0107, law=NewtonRestitution(local_restitution=0.1)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)
    trajectory = simulate(oscillator, periods=1000)
    trajectory.strobe_impacts[-10:]          # one impact in every fifth period

The equation of motion is in ``contact.oscillator``; flights in closed form and their bounds in
``contact.flight``; the certified search for the next touch in ``contact.crossing``; motion in contact in
``contact.series`` and ``contact.hertz_series``; what a collision does to the first mode in
``contact.collision``; the letter's map in ``contact.nordmark`` and ``contact.maximal_orbits``; periodic
orbits in ``contact.orbits``.  Units are SI throughout; modes are mass-normalised (q in m kg^0.5).
"""

from contact.collision import Collision, collisions, first_collision
from contact.drive import HarmonicDrive
from contact.errors import Chatter, ContactError, ContactTooStiff, NotPeriodic, UnresolvedCrossing
from contact.laws import (
    ContactLaw,
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.maximal_orbits import (
    Band,
    MaximalOrbit,
    band,
    bands,
    fold,
    maximal_orbits,
    maximal_period,
    maximal_periods,
    stable_range,
)
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily, SingleImpactOrbit
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.strobed_nordmark import StrobedNordmarkMap
from contact.stroboscope import StrobedMap, StrobedOrbit, StroboscopicMap, strobed_orbits
from contact.trajectory import Impacts, State, Trajectory

__all__ = [
    "Band",
    "Chatter",
    "Collision",
    "ContactError",
    "ContactLaw",
    "ContactTooStiff",
    "DelayedRestitution",
    "HarmonicDrive",
    "HertzContact",
    "HuntCrossley",
    "ImpactOscillator",
    "Impacts",
    "LinearContact",
    "MaximalFamily",
    "MaximalOrbit",
    "NewtonRestitution",
    "NordmarkMap",
    "NotPeriodic",
    "SingleImpactOrbit",
    "State",
    "Stop",
    "StrobedMap",
    "StrobedNordmarkMap",
    "StrobedOrbit",
    "StroboscopicMap",
    "Trajectory",
    "UnresolvedCrossing",
    "band",
    "bands",
    "collisions",
    "first_collision",
    "fold",
    "maximal_orbits",
    "maximal_period",
    "maximal_periods",
    "simulate",
    "stable_range",
    "strobed_orbits",
]
