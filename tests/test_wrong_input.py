"""Wrong input at every public entry: one sentence of our own, never a silent number, no traceback of others.

`ENTRIES` holds for each entry a call that is right and rows of one change each that makes it wrong, with the
words that the sentence must contain.  Beside the rows, every plain number of every right call is replaced by
each of `NO_NUMBERS`.  A public name without three rows fails `test_every_public_name_has_rows`.
"""

from __future__ import annotations

import dataclasses
import inspect
import math
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beam
import contact
import contact.integrators
from beam.parameters import LONGEST_SHOWN, SuspiciousValue, suspect
from contact.orbits import continuation, kick, lyapunov, shooting

ROOT = Path(__file__).resolve().parent.parent
NAN, INF = math.nan, math.inf

NO_NUMBERS = (NAN, INF, -INF, "1.0", True, 1j, [1.0], [], np.array([1.0, 2.0]), {}, 10**400, object())
"""In place of a number: not finite, texts, truth values, complex numbers, lists, arrays, empty, too large."""

# ---------------------------------------------------------------------------------------------- right objects


@cache
def strip() -> beam.StripSection:
    return beam.StripSection(material=beam.BRASS, width=0.012, thickness=0.00065)


@cache
def spring() -> beam.LeafSpring:
    return beam.folded_u(leg_length=0.13, bend_radius=0.0075, section=strip(), tip=beam.Tip(mass=0.004))


@cache
def mesh() -> beam.Discretization:
    return beam.assemble(spring(), 4)


@cache
def modes() -> beam.Modes:
    return beam.natural_modes(mesh(), 6)


@cache
def uniform() -> beam.UniformBeam:
    return beam.UniformBeam(length=0.13, bending_stiffness=0.03, mass_per_length=0.07)


@cache
def eq_1(law: contact.ContactLaw | None = None) -> contact.ImpactOscillator:
    return contact.ImpactOscillator(
        model=beam.single_mode(free_period=40.8e-3, decay_rate=3.56),
        stop=contact.Stop(gap=0.0107, law=law or contact.NewtonRestitution(local_restitution=0.1)),
        drive=contact.HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)


@cache
def nordmark() -> contact.NordmarkMap:
    return contact.NordmarkMap(alpha=0.5, gamma=0.8, restitution=0.1)


@cache
def family() -> shooting.Shooting:
    return shooting.Shooting(oscillator=eq_1(contact.HertzContact(stiffness=8e9)), period=5)


@cache
def orbit() -> shooting.PeriodicOrbit:
    return family().at_speed(0.1)


@cache
def system() -> Any:
    return dataclasses.replace(nordmark(), rho=0.01)


def fields_of(instance: Any) -> dict[str, Any]:
    return {entry.name: getattr(instance, entry.name) for entry in dataclasses.fields(instance)}


# ------------------------------------------------------------------------------------------------------ table


@dataclasses.dataclass(frozen=True)
class Entry:
    """A callable, the arguments of a right call, and wrong ones: (changes, words of the sentence)."""

    call: Callable[..., Any]
    right: Callable[[], dict[str, Any]]
    rows: tuple[tuple[dict[str, Any], tuple[str, ...]], ...]


def entry(call: Callable[..., Any], right: Any, *rows: tuple[dict[str, Any], str]) -> Entry:
    """An entry; the words of a row are divided by |."""
    arguments = right if callable(right) else lambda: dict(right)
    return Entry(call, arguments, tuple((changes, tuple(words.split("|"))) for changes, words in rows))


MODAL = dict(omega=[150.0, 900.0], decay_rate=[3.0, 9.0], phi=[10.0, 9.0], participation=[0.1, 0.05])
HERTZ_PAIR = dict(
    radius=0.0025, youngs_modulus=370e9, poissons_ratio=0.22, other_modulus=210e9, other_ratio=0.29
)
BAND = dict(free_period=40.8e-3, decay_rate=3.56, restitution=0.1)
FROM_F = dict(drive_frequency=22.2, **BAND)

BEAM: dict[str, Entry] = {
    "Material": entry(
        beam.Material,
        dict(youngs_modulus=105e9, poissons_ratio=0.34, density=8500.0, loss_factor=1e-3),
        ({"youngs_modulus": -1.0}, "youngs_modulus is -1.0 Pa|above zero"),
        ({"poissons_ratio": 0.5}, "poissons_ratio is 0.5|above -1 and below 0.5"),
        ({"density": "8500"}, "density is '8500'|number in kg/m^3"),
        ({"loss_factor": -1e-3}, "loss_factor is -0.001|zero or more"),
    ),
    "StripSection": entry(
        beam.StripSection,
        dict(material=beam.BRASS, width=0.012, thickness=0.00065),
        ({"material": "brass"}, "material is 'brass'|a Material"),
        ({"width": 0.0}, "width is 0.0 m|above zero"),
        ({"thickness": 0.65}, "thickness is 0.65 m|width 0.012 m"),
        ({"layer": 0.00045}, "layer is 0.00045|a Layer or None"),
    ),
    "Layer": entry(
        beam.Layer,
        dict(material=beam.DAMPING_TAPE, thickness=0.00045),
        ({"material": None}, "material is None|a Material"),
        ({"thickness": -0.00045}, "thickness is -0.00045 m|above zero"),
        ({"both_sides": 2}, "both_sides is 2|True or False"),
    ),
    "Straight": entry(
        beam.Straight,
        dict(length=0.13),
        ({"length": -0.13}, "length is -0.13 m|above zero"),
        ({"length": "0.13"}, "length is '0.13'|number in m"),
        ({"length": NAN}, "length is nan m|finite"),
    ),
    "Arc": entry(
        beam.Arc,
        dict(radius=0.0075, angle=math.pi),
        ({"radius": 0.0}, "radius is 0.0 m|above zero"),
        ({"angle": 0.0}, "angle is 0.0 rad|not zero"),
        ({"angle": "pi"}, "angle is 'pi'|number in rad"),
    ),
    "Centreline": entry(
        beam.Centreline,
        dict(pieces=(beam.Straight(length=0.1),), start=(0.0, 0.0), heading=0.0),
        ({"pieces": ()}, "pieces is empty|at least one"),
        ({"pieces": 3}, "pieces is 3|Straight and Arc"),
        ({"pieces": (0.1,)}, "pieces is 0.1|Straight and Arc"),
        ({"start": (0.0,)}, "start has shape|two"),
        ({"start": ("a", "b")}, "start is|numbers"),
        ({"heading": "east"}, "heading is 'east'|rad"),
    ),
    "Tip": entry(
        beam.Tip,
        dict(mass=0.004, rotary_inertia=0.0),
        ({"mass": -0.004}, "mass is -0.004 kg|zero or more"),
        ({"mass": "4 g"}, "mass is '4 g'|number in kg"),
        ({"rotary_inertia": NAN}, "rotary_inertia is nan kg m^2|finite"),
    ),
    "Readout": entry(
        beam.Readout,
        dict(at=0.05),
        ({"at": -0.05}, "at is -0.05 m|zero or more"),
        ({"at": "middle"}, "at is 'middle'|number in m"),
        ({"quantity": "velocity"}, "quantity is 'velocity'|'displacement', 'rotation'"),
    ),
    "LeafSpring": entry(
        beam.LeafSpring,
        lambda: fields_of(spring()),
        ({"centreline": 0.28}, "centreline is 0.28|a Centreline"),
        ({"sections": ()}, "sections has 0 entries|3 pieces"),
        ({"sections": 3}, "sections is 3|StripSection"),
        ({"supports": "clamped"}, "supports is 'clamped'|two of"),
        ({"supports": ("clamped", ["free"])}, "supports is|two of"),
        ({"tip": 0.004}, "tip is 0.004|a Tip"),
        ({"tip_at": 1.0}, "tip_at is 1.0 m|between 0 and"),
        ({"tip_at": 0.0}, "tip_at is 0.0 m|clamped"),
        ({"drive": (0.0, 0.0)}, "drive is (0.0, 0.0)|positive length"),
        ({"drive": ("x", "y")}, "drive is ('x', 'y')|direction"),
        ({"readouts": {"laser": 0.1}}, "readouts['laser'] is 0.1|a Readout"),
    ),
    "folded_u": entry(
        beam.folded_u,
        lambda: dict(leg_length=0.13, bend_radius=0.0075, section=strip(), tip=beam.Tip(mass=0.004)),
        ({"leg_length": 0.0}, "length of the straight strip or leg is 0.0 m|above zero"),
        ({"bend_radius": "tight"}, "radius is 'tight'|number in m"),
        ({"bend_radius": 0.0003}, "radius is 0.0003 m|half the thickness, 0.000325 m"),
        ({"section": beam.BRASS}, "sections is Material|StripSection"),
        ({"tip": None}, "tip is None|a Tip"),
        ({"damped_span": (0.0, 0.1)}, "damped_span is|without a damped_section"),
        ({"damped_section": 0.45e-3}, "damped_section is 0.00045|StripSection"),
    ),
    "straight_strip": entry(
        beam.straight_strip,
        lambda: dict(length=0.13, section=strip(), supports=("clamped", "free"), tip_at=0.13),
        ({"length": -1.0}, "length of the straight strip or leg is -1.0 m"),
        ({"tip_at": 130.0}, "tip_at is 130.0 m|between 0 and 0.13"),
        ({"supports": ("glued", "free")}, "supports is|clamped, pinned, guided, free"),
        ({"damped_section": strip(), "damped_span": (0.1, 0.05)}, "damped_span is (0.1, 0.05) m|increase"),
        ({"damped_section": strip(), "damped_span": (0.0, "end")}, "damped_span is|its start and its end"),
    ),
    "cantilever": entry(
        beam.cantilever,
        lambda: dict(length=0.13, section=strip()),
        ({"length": 0}, "length of the straight strip or leg is 0 m|above zero"),
        ({"section": None}, "sections is None|StripSection"),
        ({"tip": 0.004}, "tip is 0.004|a Tip"),
        ({"readouts": [0.1]}, "readouts is [0.1]|mapping"),
    ),
    "assemble": entry(
        beam.assemble,
        lambda: dict(spring=spring(), elements=4),
        ({"spring": strip()}, "spring is StripSection|a LeafSpring"),
        ({"elements": 0}, "elements is 0|between 1 and|or one for each piece"),
        ({"elements": [4, 4]}, "elements is [4, 4]|3 pieces"),
        ({"elements": [4, 2.5, 4]}, "elements is 2.5|whole number"),
        ({"elements": 10**9}, "elements is 1000000000|100000"),
    ),
    "default_elements": entry(
        beam.default_elements,
        lambda: dict(spring=spring()),
        ({"spring": None}, "spring is None|a LeafSpring"),
        ({"spring": 3}, "spring is 3|a LeafSpring"),
        ({"spring": "folded_u"}, "spring is 'folded_u'|a LeafSpring"),
    ),
    "Discretization": entry(
        beam.Discretization,
        lambda: fields_of(mesh()),
        ({"spring": None}, "spring is None|a LeafSpring"),
        ({"tip": [NAN]}, "tip holds nan|finite"),
        ({"mass": np.eye(2)}, "mass has shape (2, 2)|matrix of shape"),
        ({"stiffness": 3.0}, "stiffness has shape None|matrix of shape"),
    ),
    "natural_modes": entry(
        beam.natural_modes,
        lambda: dict(discretization=mesh(), count=4),
        ({"discretization": spring()}, "discretization is LeafSpring|a Discretization"),
        ({"count": 0}, "count is 0 modes|between 1 and"),
        ({"count": 10**6}, "count is 1000000 modes|degrees of freedom"),
        ({"count": 2.5}, "count is 2.5 modes|whole number"),
    ),
    "Modes": entry(
        beam.Modes,
        lambda: fields_of(modes()),
        ({"discretization": None}, "discretization is None|a Discretization"),
        ({"omega": [[1.0]]}, "omega has shape (1, 1)|row of numbers"),
        ({"phi": [1.0]}, "phi has shape (1,)|of shape (6,)"),
        ({"participation": ["a"] * 6}, "participation is|numbers"),
    ),
    "StripDamping": entry(
        lambda modes: beam.StripDamping().decay_rates(modes),
        lambda: dict(modes=modes()),
        ({"modes": None}, "modes is None|natural_modes"),
        ({"modes": [24.5, 149.0]}, "modes is [24.5, 149.0]|natural_modes"),
        ({"modes": "all"}, "modes is 'all'|natural_modes"),
    ),
    "ConstantLossFactor": entry(
        beam.ConstantLossFactor,
        dict(loss_factor=0.02),
        ({"loss_factor": -0.02}, "loss_factor is -0.02|zero or more"),
        ({"loss_factor": NAN}, "loss_factor is nan|finite"),
        ({"loss_factor": "2 %"}, "loss_factor is '2 %'|number"),
    ),
    "ConstantRatio": entry(
        beam.ConstantRatio,
        dict(ratio=0.0116),
        ({"ratio": -0.1}, "ratio is -0.1|zero or more"),
        ({"ratio": INF}, "ratio is inf|finite"),
        ({"ratio": [0.01]}, "ratio is [0.01]|number"),
    ),
    "Rayleigh": entry(
        beam.Rayleigh,
        dict(mass_coefficient=3.56, stiffness_coefficient=1e-6),
        ({"mass_coefficient": -1.0}, "mass_coefficient is -1.0 1/s|zero or more"),
        ({"stiffness_coefficient": NAN}, "stiffness_coefficient is nan s|finite"),
        ({"stiffness_coefficient": None}, "stiffness_coefficient is None|number in s"),
    ),
    "MeasuredDecay": entry(
        beam.MeasuredDecay,
        dict(decay_rate=3.56),
        ({"decay_rate": -3.56}, "decay_rate is -3.56 1/s|zero or more"),
        ({"others": "strips"}, "others is 'strips'|StripDamping()"),
        ({"others": beam.StripDamping}, "others is|StripDamping()"),
        ({"scaled": 1}, "scaled is 1|True or False"),
    ),
    "reduce": entry(
        beam.reduce,
        lambda: dict(modes=modes(), damping=beam.ConstantRatio(ratio=0.01), count=2),
        ({"modes": mesh()}, "modes is Discretization|natural_modes"),
        ({"damping": 0.01}, "damping is 0.01|rule for decay rates"),
        ({"count": 0}, "count is 0 modes|between 1 and"),
        ({"count": 50}, "count is 50 modes|ask natural_modes for more"),
        ({"coupled_only": "yes"}, "coupled_only is 'yes'|True or False"),
    ),
    "ModalModel": entry(
        beam.ModalModel,
        MODAL | dict(static_compliance=1e-3, tip_mass=0.004),
        ({"omega": []}, "omega has shape (0,)|at least one mode"),
        ({"omega": "150"}, "omega is '150'|rad/s"),
        ({"omega": [150.0, 1j]}, "omega is|rad/s"),
        ({"omega": [True, False]}, "omega is [True, False]|rad/s"),
        ({"decay_rate": [-3.0, 9.0]}, "decay_rate holds -3.0 1/s|negative"),
        ({"phi": [10.0]}, "phi has shape (1,)|(2,)"),
        ({"participation": [NAN, 1.0]}, "participation holds nan|finite"),
        ({"tip_mass": -1.0}, "tip_mass is -1.0 kg|zero or more"),
        ({"readouts": [1.0, 2.0]}, "readouts is [1.0, 2.0]|mapping"),
    ),
    "single_mode": entry(
        beam.single_mode,
        dict(free_period=40.8e-3, decay_rate=3.56),
        ({"free_period": 0.0}, "free_period is 0.0 s|above zero"),
        ({"free_period": "40.8 ms"}, "free_period is '40.8 ms'|number in s"),
        ({"decay_rate": -3.56}, "decay_rate is -3.56 1/s|zero or more"),
    ),
    "UniformBeam": entry(
        beam.UniformBeam,
        lambda: fields_of(uniform()),
        ({"length": 0.0}, "length is 0.0 m|above zero"),
        ({"bending_stiffness": NAN}, "bending_stiffness is nan N m^2|finite"),
        ({"supports": ("clamped",)}, "supports is ('clamped',)|two of"),
        ({"supports": 2}, "supports is 2|two of"),
        ({"supports": ("free", "clamped"), "tip_mass": 1.0}, "tip_mass is 1.0 kg|must be 0"),
    ),
    "exact_modes": entry(
        beam.exact_modes,
        lambda: dict(beam=uniform(), count=2),
        ({"beam": spring()}, "beam is LeafSpring|a UniformBeam"),
        ({"count": 0}, "count is 0 modes|between 1 and 2000"),
        ({"count": 10**7}, "count is 10000000 modes|2000"),
    ),
    "frequency_function": entry(
        beam.frequency_function,
        lambda: dict(beam=uniform(), beta_length=[1.0, 2.0]),
        ({"beam": None}, "beam is None|a UniformBeam"),
        ({"beta_length": [-1.0]}, "beta_length holds -1|positive"),
        ({"beta_length": ["1"]}, "beta_length is ['1']|positive numbers"),
        ({"beta_length": [NAN]}, "beta_length holds nan|finite"),
    ),
    "as_one_spring": entry(
        beam.as_one_spring,
        lambda: dict(half=beam.ModalModel(**MODAL)),
        ({"half": None}, "half is None|a ModalModel"),
        ({"half": 0.5}, "half is 0.5|a ModalModel"),
        ({"half": "leg"}, "half is 'leg'|a ModalModel"),
    ),
    "straight_equivalent": entry(
        beam.straight_equivalent,
        lambda: dict(spring=spring()),
        ({"spring": None}, "spring is None|a LeafSpring"),
        ({"spring": strip()}, "spring is StripSection|a LeafSpring"),
        ({"spring": beam.cantilever(length=0.1, section=strip())}, "no folded U"),
    ),
}

START = dict(displacement=[0.0], velocity=[0.0])

CONTACT: dict[str, Entry] = {
    "HarmonicDrive": entry(
        contact.HarmonicDrive,
        dict(frequency=22.2, amplitude=1e-3),
        ({"frequency": 0.0}, "frequency of the drive is 0.0 Hz|above zero"),
        ({"frequency": "22.2 Hz"}, "frequency of the drive is '22.2 Hz'|number in Hz"),
        ({"amplitude": -1e-3}, "amplitude of the drive is -0.001 m|zero or more"),
    ),
    "Stop": entry(
        contact.Stop,
        dict(gap=0.0107, law=contact.NewtonRestitution(local_restitution=0.1)),
        ({"gap": -0.01}, "gap is -0.01 m|zero or more"),
        ({"gap": "10.7 mm"}, "gap is '10.7 mm'|number in m"),
        ({"law": 0.1}, "law of the stop is 0.1|contact law"),
        ({"law": contact.HertzContact}, "law of the stop is|contact law"),
    ),
    "NewtonRestitution": entry(
        contact.NewtonRestitution,
        dict(local_restitution=0.1),
        ({"local_restitution": 1.1}, "local_restitution is 1.1|between 0 and 1"),
        ({"local_restitution": NAN}, "local_restitution is nan|between 0 and 1"),
        ({"local_restitution": "0.1"}, "local_restitution is '0.1'|between 0 and 1"),
    ),
    "DelayedRestitution": entry(
        contact.DelayedRestitution,
        dict(restitution=0.1, delay=1e-4),
        ({"restitution": 2.0}, "restitution runs from 2.0|between 0 and 1"),
        ({"delay": "late"}, "delay is 'late'|function of the approach speed"),
        ({"restitution": lambda v: "soft"}, "'soft'|it must give a number"),
        ({"speeds": (1.0,)}, "speeds has shape (1,)|two rising numbers"),
        ({"speeds": 3.0}, "speeds has shape ()|two rising numbers"),
    ),
    "LinearContact": entry(
        contact.LinearContact,
        dict(stiffness=1e6, damping=0.0),
        ({"stiffness": 0.0}, "stiffness of the contact is 0.0 N/m|above zero"),
        ({"stiffness": None}, "stiffness of the contact is None|above zero"),
        ({"damping": -1.0}, "damping of the contact is -1.0 N s/m|zero or more"),
    ),
    "HertzContact": entry(
        contact.HertzContact,
        dict(stiffness=8e9),
        ({"stiffness": -8e9}, "stiffness of the contact is|N/m^1.5|above zero"),
        ({"stiffness": "hard"}, "stiffness of the contact is 'hard'|above zero"),
        ({"stiffness": INF}, "stiffness of the contact is inf|finite"),
    ),
    "HertzContact.of_bodies": entry(
        contact.HertzContact.of_bodies,
        HERTZ_PAIR,
        ({"radius": 0.0}, "radius is 0.0 m|above zero"),
        ({"youngs_modulus": -1.0}, "youngs_modulus is -1.0 Pa|above zero"),
        ({"other_ratio": 0.6}, "other_ratio is 0.6|at most 0.5"),
    ),
    "HuntCrossley": entry(
        contact.HuntCrossley,
        dict(stiffness=8e9, dissipation=0.5),
        ({"stiffness": 0}, "stiffness of the contact is 0|above zero"),
        ({"dissipation": -0.5}, "dissipation of the contact is -0.5 s/m|zero or more"),
        ({"dissipation": NAN}, "dissipation of the contact is nan|finite"),
    ),
    "HuntCrossley.with_restitution": entry(
        contact.HuntCrossley.with_restitution,
        dict(stiffness=8e9, restitution=0.5, velocity=0.1),
        ({"restitution": 0.0}, "restitution is 0.0|above zero"),
        ({"velocity": -0.1}, "velocity is -0.1 m/s|above zero"),
        ({"restitution": "half"}, "restitution is 'half'|above zero"),
    ),
    "ImpactOscillator": entry(
        contact.ImpactOscillator,
        lambda: fields_of(eq_1()),
        ({"model": None}, "model is None|a ModalModel"),
        ({"stop": 0.0107}, "stop is 0.0107|a Stop"),
        ({"drive": 22.2}, "drive is 22.2|HarmonicDrive"),
        ({"drive": contact.HarmonicDrive(frequency=22200.0)}, "22200 Hz|highest"),
        ({"load": [1.0, 2.0]}, "load has shape (2,)|1 finite modal loads"),
        ({"load": ["a"]}, "load is ['a']|finite modal loads"),
        (
            {"stop": contact.Stop(gap=0.0, law=contact.HertzContact(stiffness=1e9))},
            "gap is 0.0 m|above zero",
        ),
    ),
    "ImpactOscillator.with_excess": entry(
        lambda excess: eq_1().with_excess(excess),
        dict(excess=1e-3),
        ({"excess": -1.0}, "excess is -1.0|above -1"),
        ({"excess": "0.1 %"}, "excess is '0.1 %'|number"),
        ({"excess": NAN}, "excess is nan|finite"),
    ),
    "ImpactOscillator.with_amplitude": entry(
        lambda amplitude: eq_1().with_amplitude(amplitude),
        dict(amplitude=1e-3),
        ({"amplitude": -1e-3}, "amplitude is -0.001 m|zero or more"),
        ({"amplitude": None}, "amplitude is None|number in m"),
        ({"amplitude": INF}, "amplitude is inf m|finite"),
    ),
    "State": entry(
        contact.State,
        START | dict(time=0.0, regime=0, wait=0.0, rebound=0.0),
        ({"displacement": []}, "displacement of the state|finite array"),
        ({"displacement": "rest"}, "displacement of the state|finite array"),
        ({"velocity": [0.0, 1.0]}, "velocity of the state has shape (2,)"),
        ({"regime": 7}, "regime of the state is 7|0, 1, 2, 3 or 4"),
        ({"time": NAN}, "time of the state is nan s|finite"),
    ),
    "State.rest": entry(
        contact.State.rest,
        dict(n_modes=2),
        ({"n_modes": 0}, "n_modes is 0|one or more"),
        ({"n_modes": 1.5}, "n_modes is 1.5|whole number"),
        ({"n_modes": "two"}, "n_modes is 'two'|whole number"),
    ),
    "simulate": entry(
        contact.simulate,
        lambda: dict(oscillator=eq_1(), periods=2),
        ({"oscillator": None}, "oscillator is None|an ImpactOscillator"),
        ({"state": [0.0, 0.0]}, "state is [0.0, 0.0]|a State"),
        ({"periods": 0}, "duration is 0.0 s|above zero"),
        ({"periods": 1.5}, "periods is 1.5|whole number"),
        ({"periods": None}, "both missing"),
        ({"periods": None, "duration": "1 s"}, "duration is '1 s'|number in s"),
        ({"periods": None, "duration": -1.0}, "duration is -1.0 s|above zero"),
        ({"periods": None, "duration": 1e12}, "duration is 1e+12 s|in pieces"),
        ({"times": [0.02, 0.01]}, "times must be a rising array"),
        ({"times": "now"}, "times is 'now'|rising array"),
        ({"method": "magic"}, "method is 'magic'|one of event-driven"),
        ({"method": 3}, "method is 3|an Integrator"),
        ({"state": contact.State.rest(3)}, "3 modes|the model has 1"),
    ),
    "StroboscopicMap": entry(
        lambda excess, name, time, oscillator, count: (
            contact.StroboscopicMap(oscillator=oscillator or eq_1()).at(excess),
            contact.StroboscopicMap(oscillator=eq_1()).orbit(contact.State(**START, time=time), count),
            name and contact.StroboscopicMap(oscillator=eq_1()).readout(np.zeros((1, 2)), name),
        ),
        dict(excess=1e-3, name="", time=0.0, oscillator=None, count=1),
        ({"count": -5}, "count is -5 drive periods|whole number"),
        ({"count": 2.5}, "count is 2.5 drive periods|whole number"),
        ({"oscillator": 3}, "oscillator is 3|an ImpactOscillator"),
        ({"excess": -2.0}, "excess is -2.0|above -1"),
        ({"name": "laser"}, "name is 'laser'|read-out points"),
        ({"time": 1e-3}, "time of the state is 0.001 s|strobe time"),
    ),
    "strobed_orbits": entry(
        lambda maps, states, workers: contact.strobed_orbits(
            [contact.StroboscopicMap(oscillator=eq_1())] * maps, [contact.State(**START)] * states, 1,
            workers=workers,
        ),
        dict(maps=2, states=2, workers=2),
        ({"workers": 0}, "workers is 0 threads|one or more"),
        ({"maps": 1}, "states has 2 entries|1 maps"),
        ({"states": 0}, "states has 0 entries|2 maps"),
        ({"states": 3}, "states has 3 entries|2 maps"),
    ),
    "NordmarkMap": entry(
        contact.NordmarkMap,
        dict(alpha=0.5, gamma=0.8, restitution=0.1, delay_term=0.0, whole_turns=1),
        ({"alpha": 1.9}, "alpha is 1.9|below 1 + gamma"),
        ({"gamma": 1.5}, "gamma is 1.5|between 0 and 1"),
        ({"restitution": "0.1"}, "restitution is '0.1'|number"),
        ({"y_line": "wrong"}, "y_line is 'wrong'|corrected"),
        ({"whole_turns": 0.5}, "whole_turns is 0.5|whole number"),
        ({"rho": NAN}, "rho is nan|finite"),
    ),
    "NordmarkMap.from_frequencies": entry(
        contact.NordmarkMap.from_frequencies,
        FROM_F,
        ({"drive_frequency": 25.0}, "drive_frequency is 25.0 Hz|between 0 and 1/2"),
        ({"free_period": 0.0}, "free_period is 0.0 s|above zero"),
        ({"decay_rate": "3.56"}, "decay_rate is '3.56'|1/s"),
    ),
    "NordmarkMap.from_mode": entry(
        contact.NordmarkMap.from_mode,
        dict(omega=154.0, decay_rate=3.56, drive_frequency=22.2, restitution=0.1, delay=0.0),
        ({"omega": -154.0}, "omega is -154.0 rad/s|above zero"),
        ({"delay": -1e-3}, "delay is -0.001 s|zero or more"),
        ({"restitution": NAN}, "restitution is nan|between 0 and 1"),
    ),
    "NordmarkMap.from_oscillator": entry(
        contact.NordmarkMap.from_oscillator,
        lambda: dict(oscillator=eq_1()),
        ({"oscillator": 3}, "oscillator is 3|an ImpactOscillator"),
        ({"oscillator": eq_1(contact.HertzContact(stiffness=8e9))}, "HertzContact|no restitution"),
        ({"oscillator": dataclasses.replace(eq_1(), drive=None)}, "drive is None|HarmonicDrive"),
    ),
    "NordmarkMap.orbit": entry(
        lambda state, rho, count: dataclasses.replace(nordmark(), rho=rho).orbit(state, count),
        dict(state=[0.0, 0.0], rho=0.01, count=3),
        ({"state": [0.0]}, "state has shape (1,)|(x, y)"),
        ({"state": [NAN, 0.0]}, "state is|finite"),
        ({"rho": "0.01"}, "rho is '0.01'|number"),
        ({"count": -1}, "count is -1 periods|zero or more"),
    ),
    "MapFamily": entry(
        lambda nordmark, period, speed, rho, excess: (
            contact.MapFamily(nordmark, period).orbit(speed),
            contact.MapFamily(nordmark, period).at_rho(rho),
            contact.MapFamily(nordmark, period).orbits(excess),
        ),
        lambda: dict(nordmark=nordmark(), period=4, speed=0.1, rho=0.01, excess=0.01),
        ({"nordmark": None}, "nordmark is None|a NordmarkMap"),
        ({"period": 0}, "period is 0 drive periods|1 and 100000"),
        ({"speed": 0.0}, "speed is 0.0|above zero"),
        ({"rho": NAN}, "rho is nan|finite"),
        ({"excess": "1"}, "excess is '1'|number"),
    ),
    "band": entry(
        contact.band,
        BAND | dict(period=4),
        ({"period": 1}, "period is 1 drive periods|2 and 100000"),
        ({"period": "p4"}, "period is 'p4'|whole number"),
        ({"free_period": -1.0}, "free_period is -1.0 s|above zero"),
        ({"whole_turns": -1}, "whole_turns is -1|zero or more"),
        ({"y_line": 3}, "y_line is 3|corrected"),
    ),
    "bands": entry(
        contact.bands,
        BAND | dict(periods=(3, 4)),
        ({"periods": 3}, "periods is 3|sequence of periods"),
        ({"periods": (3, 1)}, "period is 1 drive periods"),
        ({"restitution": 1.5}, "restitution is 1.5|between 0 and 1"),
    ),
    "fold": entry(
        contact.fold,
        lambda: dict(nordmark=nordmark(), period=4),
        ({"nordmark": None}, "nordmark is None|a NordmarkMap"),
        ({"period": 0}, "period is 0 drive periods|1 and 100000"),
        ({"period": 10**9}, "period is 1000000000 drive periods|100000"),
    ),
    "maximal_orbits": entry(
        contact.maximal_orbits,
        lambda: dict(nordmark=nordmark(), period=4, rho=0.01),
        ({"nordmark": 0.5}, "nordmark is 0.5|a NordmarkMap"),
        ({"period": 2.5}, "period is 2.5 drive periods|whole number"),
        ({"rho": NAN}, "rho is nan|finite"),
    ),
    "stable_range": entry(
        contact.stable_range,
        lambda: dict(nordmark=nordmark(), period=4),
        ({"nordmark": "map"}, "nordmark is 'map'|a NordmarkMap"),
        ({"period": -4}, "period is -4 drive periods"),
        ({"period": None}, "period is None|whole number"),
    ),
    "maximal_period": entry(
        contact.maximal_period,
        lambda: dict(nordmark=nordmark()),
        ({"nordmark": None}, "nordmark is None|a NordmarkMap"),
        ({"nordmark": 4}, "nordmark is 4|a NordmarkMap"),
        ({"nordmark": [nordmark()]}, "nordmark is [|a NordmarkMap"),
    ),
    "maximal_periods": entry(
        contact.maximal_periods,
        lambda: dict(nordmark=nordmark()),
        ({"nordmark": None}, "nordmark is None|a NordmarkMap"),
        ({"nordmark": 0.5}, "nordmark is 0.5|a NordmarkMap"),
        ({"nordmark": "map"}, "nordmark is 'map'|a NordmarkMap"),
    ),
    "collisions": entry(
        contact.collisions,
        lambda: dict(
            oscillator=eq_1(), trajectory=contact.simulate(eq_1(), periods=3), unfinished="drop"
        ),
        ({"oscillator": None}, "oscillator is None|an ImpactOscillator"),
        ({"trajectory": [0.1]}, "trajectory is [0.1]|a Trajectory"),
        ({"unfinished": "keep"}, "unfinished is 'keep'|refuse"),
    ),
    "before_collision": entry(
        contact.before_collision,
        lambda: dict(oscillator=eq_1()),
        ({"oscillator": dataclasses.replace(eq_1(), drive=None)}, "drive is None|give a state"),
        ({"oscillator": None}, "oscillator is None|an ImpactOscillator"),
        ({"oscillator": "beam"}, "oscillator is 'beam'|an ImpactOscillator"),
    ),
    "first_collision": entry(
        contact.first_collision,
        lambda: dict(oscillator=eq_1(), periods=64),
        ({"oscillator": 3}, "oscillator is 3|an ImpactOscillator"),
        ({"periods": 0}, "periods is 0 drive periods|one or more"),
        ({"state": "rest"}, "state is 'rest'|a State"),
        ({"oscillator": eq_1().with_excess(-0.5)}, "periods is 64|no collision"),
    ),
    "MaximalFamily": entry(
        lambda oscillator, period, restitution: contact.MaximalFamily.from_oscillator(
            oscillator, period=period, restitution=restitution
        ),
        lambda: dict(oscillator=eq_1(), period=3, restitution=0.1),
        ({"oscillator": None}, "oscillator is None|an ImpactOscillator"),
        ({"oscillator": dataclasses.replace(eq_1(), drive=None)}, "drive is None|HarmonicDrive"),
        ({"oscillator": dataclasses.replace(eq_1(), load=[1.0])}, "load is given|None"),
        (
            {"oscillator": eq_1(contact.HertzContact(stiffness=8e9)), "restitution": None},
            "HertzContact|no restitution",
        ),
        ({"period": 0}, "period is 0 drive periods|one or more"),
        ({"restitution": -0.1}, "restitution is -0.1|between 0 and 1"),
    ),
    "MaximalFamily.orbit": entry(
        lambda speed: contact.MaximalFamily.from_oscillator(eq_1(), period=5).orbit(speed),
        dict(speed=0.1),
        ({"speed": 0.0}, "speed is 0.0 m/s|above zero"),
        ({"speed": "fast"}, "speed is 'fast'|number in m/s"),
        ({"speed": NAN}, "speed is nan m/s|finite"),
    ),
    "MaximalFamily.orbits": entry(
        lambda excess: contact.MaximalFamily.from_oscillator(eq_1(), period=5).orbits(excess),
        dict(excess=1e-3),
        ({"excess": -1.0}, "excess is -1.0|above -1"),
        ({"excess": INF}, "excess is inf|finite"),
        ({"excess": [1e-3]}, "excess is [0.001]|number"),
    ),
}

ORBITS: dict[str, Entry] = {
    "KickFamily": entry(
        kick.KickFamily,
        lambda: dict(oscillator=eq_1(), period=5),
        ({"oscillator": None}, "oscillator is None|an ImpactOscillator"),
        ({"period": 0}, "period is 0 drive periods|whole number"),
        ({"oscillator": dataclasses.replace(eq_1(), load=[1.0])}, "load is given|None"),
    ),
    "KickFamily.fold": entry(
        lambda speeds: kick.KickFamily(oscillator=eq_1(), period=5).fold(speeds),
        dict(speeds=(0.01, 0.5)),
        ({"speeds": (0.5, 0.01)}, "speeds is (0.5, 0.01)|rising"),
        ({"speeds": (0.0, 1.0)}, "speeds is (0.0, 1.0)|above zero"),
        ({"speeds": "all"}, "speeds is 'all'|two rising numbers"),
    ),
    "Shooting": entry(
        shooting.Shooting,
        lambda: dict(oscillator=family().oscillator, period=5),
        ({"oscillator": "eq_1"}, "oscillator is 'eq_1'|an ImpactOscillator"),
        ({"period": 1.5}, "period is 1.5 drive periods|whole number"),
        ({"impacts": 0}, "impacts is 0|whole number, one or more"),
    ),
    "Shooting.at_speed": entry(
        lambda **given: family().at_speed(**given),
        dict(speed=0.1),
        ({"speed": -0.1}, "speed is -0.1 m/s|above zero"),
        ({"speed": None}, "speed is None|number in m/s"),
        ({"near": 3}, "near is 3|a PeriodicOrbit"),
    ),
    "Shooting.at_excess": entry(
        lambda **given: family().at_excess(**given),
        lambda: dict(excess=orbit().excess * 1.01, near=orbit()),
        ({"excess": -1.5}, "excess is -1.5|above -1"),
        ({"excess": NAN}, "excess is nan|finite"),
        ({"near": None}, "near is None|a PeriodicOrbit"),
    ),
    "follow": entry(
        continuation.follow,
        lambda: dict(family=family(), start=orbit(), low=0.09, high=0.11, step=0.1),
        ({"family": None}, "family is None|Shooting"),
        ({"start": 0.1}, "start is 0.1|a PeriodicOrbit"),
        ({"low": 0.2}, "low and high are 0.2|enclose"),
        ({"step": 0.0}, "step is 0.0|between"),
    ),
    "first_event": entry(
        continuation.first_event,
        lambda: dict(family=family(), start=orbit(), lowest=-0.1),
        ({"family": None}, "family is None|Shooting"),
        ({"start": 0.1}, "start is 0.1|a PeriodicOrbit"),
        ({"lowest": -1.5}, "lowest is -1.5|above -1"),
    ),
    "fold_of": entry(
        continuation.fold_of,
        lambda: dict(family=family()),
        ({"family": None}, "family is None|Shooting"),
        ({"family": eq_1()}, "family is ImpactOscillator|Shooting"),
        ({"near": 0.1}, "near is 0.1|a PeriodicOrbit"),
    ),
    "folds_of": entry(
        continuation.folds_of,
        lambda: dict(family=family()),
        ({"family": None}, "family is None|Shooting"),
        ({"family": eq_1()}, "family is ImpactOscillator|Shooting"),
        ({"near": 0.1}, "near is 0.1|a PeriodicOrbit"),
    ),
    "lowest_of": entry(
        continuation.lowest_of,
        lambda: dict(family=family()),
        ({"family": None}, "family is None|Shooting"),
        ({"family": eq_1()}, "family is ImpactOscillator|Shooting"),
        ({"near": 0.1}, "near is 0.1|a PeriodicOrbit"),
    ),
    "orbits_at": entry(
        continuation.orbits_at,
        lambda: dict(family=family(), excess=0.01),
        ({"family": None}, "family is None|Shooting"),
        ({"excess": -1.5}, "excess is -1.5|above -1"),
        ({"excess": NAN}, "excess is nan|finite"),
    ),
    "fold_along_frequency": entry(
        continuation.fold_along_frequency,
        lambda: dict(family=family(), frequencies=[22.2]),
        ({"family": 5}, "family is 5|Shooting"),
        ({"frequencies": 22.2}, "frequencies has shape ()|drive frequencies"),
        ({"frequencies": ["22.2"]}, "frequencies is ['22.2']|Hz"),
        ({"frequencies": [NAN]}, "frequencies holds nan Hz|finite"),
    ),
    "map_exponents": entry(
        lyapunov.map_exponents,
        lambda: dict(strobed=system(), state=np.array([0.0, 0.0]), count=10, align=0),
        ({"strobed": eq_1()}, "strobed is ImpactOscillator|a strobed map"),
        ({"count": 1}, "count is 1 steps|2 or more"),
        ({"align": -1}, "align is -1 steps|zero or more"),
    ),
    "orbit_exponents": entry(
        lyapunov.orbit_exponents,
        lambda: dict(strobed=system(), state=np.array([0.0, 0.0]), period=1),
        ({"strobed": None}, "strobed is None|a strobed map"),
        ({"period": 0}, "period is 0 drive periods|one or more"),
        ({"period": 1.5}, "period is 1.5|whole number"),
    ),
    "divergence_rate": entry(
        lyapunov.divergence_rate,
        lambda: dict(strobed=system(), state=np.array([0.0, 0.0]), duration=5.0, align=0.0, seed=1),
        ({"strobed": 3}, "strobed is 3|a strobed map"),
        ({"duration": 0.0}, "duration is 0.0 s|above zero"),
        ({"align": -1.0}, "align is -1.0 s|zero or more"),
        ({"seed": -1}, "seed is -1|zero or more"),
    ),
}

STEPS = (({"step": 0.0}, "step is 0.0 s|above zero"), ({"step": NAN}, "step is nan s|finite"),
         ({"step": "1 us"}, "step is 1 us s|above zero"))  # fmt: skip

METHODS: dict[str, Entry] = {
    "CentralDifference": entry(contact.integrators.CentralDifference, dict(step=1e-6), *STEPS),
    "Splitting": entry(
        contact.integrators.Splitting, dict(step=1e-6), *STEPS, ({"order": 3}, "order is 3|2 or 4")
    ),
    "GeneralisedAlpha": entry(
        contact.integrators.GeneralisedAlpha, dict(step=1e-6, beta=0.25), *STEPS,
        ({"beta": -1.0}, "beta is -1.0|zero or more"),
    ),
    "MoreauJean": entry(
        contact.integrators.MoreauJean, dict(step=1e-6, theta=0.5), *STEPS,
        ({"theta": 2.0}, "theta is 2.0|between 0 and 1"),
    ),
    "NonsmoothGeneralisedAlpha": entry(
        contact.integrators.NonsmoothGeneralisedAlpha, dict(step=1e-6, rho=0.8), *STEPS,
        ({"rho": 1.5}, "rho is 1.5"),
    ),
    "SampledFlight": entry(
        contact.integrators.SampledFlight,
        dict(points=100),
        ({"points": 0}, "points is 0|whole number"),
        ({"points": 1.5}, "points is 1.5|whole number"),
        ({"points": "many"}, "points is 'many'|whole number"),
    ),
}

TABLES = {"beam": BEAM, "contact": CONTACT, "orbits": ORBITS, "integrators": METHODS}
ENTRIES = {f"{package}.{name}": found for package, table in TABLES.items() for name, found in table.items()}

RESULTS = {
    "beam": {"ExactModes", "ShapesAlong", "SpringMesh"},
    "contact": {"Band", "Collision", "Impacts", "MaximalOrbit", "SingleImpactOrbit", "StrobedOrbit",
                "Trajectory"},
}  # fmt: skip
"""What entries return; nobody has to make one by hand."""

NO_ENTRIES = {
    "beam": {"Damping", "Support", "SuspiciousValue",  # in tests/beam/test_paraview_files.py:
             "solid_spring", "write_frames", "write_mode_motion", "write_modes"},
    "contact": {"Chatter", "ContactError", "ContactLaw", "ContactTooStiff", "Diverged", "ImpactKind",
                "NotPeriodic", "Regime", "StepTooLarge", "StrobedMap", "UnresolvedCrossing"},
}  # fmt: skip
"""Protocols, abstract classes, types, enumerations and errors."""


# ------------------------------------------------------------------------------------------------------ tests


def our_sentence(error: BaseException) -> str:
    """The message, if it is one sentence and was raised in one of our packages."""
    text = str(error)
    assert text.isprintable() and 0 < len(text) < 400 and not text.endswith("."), text
    trace = error.__traceback__
    assert trace is not None
    while trace.tb_next is not None:
        trace = trace.tb_next
    place = Path(trace.tb_frame.f_code.co_filename)
    assert place.is_relative_to(ROOT / "beam") or place.is_relative_to(ROOT / "contact"), f"{place}: {text}"
    return text


def rows() -> Iterator[Any]:
    for name, found in ENTRIES.items():
        for number, (changes, words) in enumerate(found.rows):
            yield pytest.param(found, changes, words, id=f"{name}-{number}-{'-'.join(changes)}")


@pytest.mark.parametrize("name", ENTRIES)
def test_the_right_call_is_right_and_raises_no_eyebrow(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", SuspiciousValue)
        ENTRIES[name].call(**ENTRIES[name].right())


@pytest.mark.parametrize(("found", "changes", "words"), list(rows()))
def test_wrong_input_is_one_sentence(found: Entry, changes: dict[str, Any], words: tuple[str, ...]) -> None:
    with pytest.raises((ValueError, TypeError)) as caught:
        found.call(**found.right() | changes)
    text = our_sentence(caught.value)
    for word in words:
        assert word in text, text


def numbers_of(found: Entry) -> list[str]:
    return [name for name, value in found.right().items() if type(value) in (float, int)]


@pytest.mark.parametrize("name", ENTRIES)
def test_no_number_is_taken_for_one(name: str) -> None:
    found = ENTRIES[name]
    for field in numbers_of(found):
        if name in ("beam.assemble", "contact.strobed_orbits"):
            continue  # a list of counts is a right use of the first; the second's numbers are of this table
        for value in NO_NUMBERS:
            with pytest.raises((ValueError, TypeError)) as caught:
                found.call(**found.right() | {field: value})
            text = our_sentence(caught.value)
            assert field.split("_")[-1] in text or "duration" in text, (field, value, text)


@pytest.mark.parametrize("package", ["beam", "contact"])
def test_every_public_name_has_rows(package: str) -> None:
    module = {"beam": beam, "contact": contact}[package]
    for name in module.__all__:
        if not callable(getattr(module, name)) or name in RESULTS[package] | NO_ENTRIES[package]:
            continue
        assert name in TABLES[package], f"{package}.{name} needs rows of wrong input in this table"
    for name, found in ENTRIES.items():
        assert len(found.rows) >= 3, f"{name} needs three rows of wrong input or more"


def test_every_method_with_parameters_has_rows() -> None:
    for method in contact.integrators.INTEGRATORS.values():
        if inspect.signature(method).parameters:
            assert method.__name__ in METHODS, f"{method.__name__} needs rows of wrong input in this table"


def test_every_documented_function_of_the_orbits_has_rows() -> None:
    results = {"Branch", "Event", "Exponents", "Kick", "PeriodicOrbit"}
    for module in (kick, shooting, continuation, lyapunov):
        for name in module.__all__:
            assert name in set(ORBITS) | results, f"{name} needs rows of wrong input"


# --------------------------------------------------------------------------------------------------- warnings


def warned(make: Callable[[], object]) -> list[str]:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        make()
    assert all(warning.category is SuspiciousValue for warning in found)
    assert all(Path(warning.filename) == Path(__file__) for warning in found), [w.filename for w in found]
    return [str(warning.message) for warning in found]


def oscillator(*, gap: float = 0.0107, frequency: float = 22.2, amplitude: float = 1e-3) -> object:
    return contact.ImpactOscillator(
        model=beam.single_mode(free_period=40.8e-3, decay_rate=3.56),
        stop=contact.Stop(gap=gap, law=contact.NewtonRestitution(local_restitution=0.1)),
        drive=contact.HarmonicDrive(frequency=frequency, amplitude=amplitude),
    )


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: beam.Material(youngs_modulus=105.0, poissons_ratio=0.34, density=8500.0), "speed of sound"),
        (lambda: beam.Material(youngs_modulus=105e9, poissons_ratio=0.34, density=8.5), "speed of sound"),
        (lambda: beam.cantilever(length=0.13, section=strip(), tip=beam.Tip(mass=4.0)), "heavier than"),
        (
            lambda: beam.cantilever(
                length=0.13, section=beam.StripSection(material=beam.BRASS, width=0.012, thickness=0.006)
            ),
            "a bar rather than a strip",
        ),
        (lambda: beam.cantilever(length=0.005, section=strip()), "of the strip's length 0.005 m"),
        (lambda: beam.cantilever(length=0.01, section=strip()), "it is a plate"),
        (lambda: beam.cantilever(length=4.0, section=strip()), "hangs under its own weight"),
        (
            lambda: beam.cantilever(
                length=0.13, section=strip(), tip=beam.Tip(mass=0.004, rotary_inertia=1e-4)
            ),
            "rotary_inertia of the tip is 0.0001",
        ),
        (
            lambda: beam.folded_u(leg_length=0.13, bend_radius=0.2, section=strip(), tip=beam.Tip()),
            "bend_radius is 0.2 m",
        ),
        (
            lambda: beam.Material(youngs_modulus=1e9, poissons_ratio=0.4, density=1400.0, loss_factor=4.0),
            "loss_factor is 4",
        ),
        (lambda: beam.single_mode(free_period=0.04, decay_rate=500.0), "it hardly swings"),
        (lambda: oscillator(amplitude=1.5), "amplitude of the drive is 1.5 m"),
        (lambda: oscillator(gap=10.7), "gap is 10.7 m"),
        (lambda: oscillator(frequency=0.0222), "frequency of the drive is 0.0222 Hz"),
        (lambda: contact.HertzContact.of_bodies(**HERTZ_PAIR | {"youngs_modulus": 370.0}), "370 Pa"),
    ],
)
def test_a_suspicious_value_is_taken_with_a_warning_that_says_why(
    make: Callable[[], object], words: str
) -> None:
    sentences = warned(make)
    assert any(words in sentence for sentence in sentences), sentences
    assert all(sentence.isprintable() and len(sentence) < 250 for sentence in sentences)


def test_usual_values_bring_no_warning() -> None:
    for material in (beam.BRASS, beam.STEEL, beam.ALUMINA, beam.DAMPING_TAPE):
        assert not warned(lambda material=material: dataclasses.replace(material))
    assert not warned(lambda: dataclasses.replace(spring()))
    assert not warned(oscillator)


def test_what_a_sentence_quotes_is_short_and_on_one_line() -> None:
    for value in (np.arange(1000.0), "a\nb" * 100, 10**5000, {"deep": [1] * 500}):
        with pytest.raises((ValueError, TypeError)) as caught:
            beam.Straight(length=value)  # type: ignore[arg-type]
        assert len(str(caught.value)) < LONGEST_SHOWN + 80
        assert str(caught.value).isprintable()


def test_the_warning_points_at_the_line_that_gave_the_value() -> None:
    with pytest.warns(SuspiciousValue) as found:
        suspect("a ball of lead on a leaf of paper")
    assert found[0].filename == __file__
