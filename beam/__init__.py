"""Linear vibration of thin leaf springs, down to the few numbers that an impact needs.

A strip of sheet metal follows a plane centreline, held at its ends by a moving base, and carries a ball that
can touch a stop. This package takes it from drawing to modal model:

>>> from beam import BRASS, MeasuredDecay, StripSection, Tip, assemble, folded_u, natural_modes, reduce
>>> strip = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
>>> spring = folded_u(leg_length=0.13, bend_radius=7.5e-3, section=strip, tip=Tip(mass=4e-3))
>>> modes = natural_modes(assemble(spring), count=10)
>>> modes.coupled.tolist()  # sway modes move the ball, breathing modes do not
[True, False, True, False, True, False, True, False, True, False]
>>> model = reduce(modes, MeasuredDecay(decay_rate=3.56))
>>> [round(f, 1) for f in model.frequencies_hz.tolist()]
[24.5, 148.9, 378.4, 718.4, 1169.7]

The steps are types: `Material`, `StripSection`, `Centreline`, `LeafSpring`, `Discretization` (finite elements
in the arc length), `Modes` (mass-normalised), `ModalModel`. Any of them may be made by hand: `single_mode` is
the classical oscillator with one degree of freedom, and a `ModalModel` of measured numbers is as good as a
computed one. `exact_modes` solves the frequency equation of the straight beam, to check the elements by.

SI units throughout; parameters are keyword-only and frozen, and `dataclasses.replace` varies them. Wrong
values raise `ValueError` or `TypeError` with a sentence that names the field, the value, the unit and what is
valid; valid ones that can hardly be meant bring a warning, `SuspiciousValue`. Every module opens with the
equations it solves.
"""

from .assembly import Discretization, assemble, default_elements
from .centreline import Arc, Centreline, Straight
from .damping import ConstantLossFactor, ConstantRatio, Damping, MeasuredDecay, Rayleigh, StripDamping
from .frequency_equation import ExactModes, UniformBeam, exact_modes, frequency_function
from .material import ALUMINA, BRASS, DAMPING_TAPE, STEEL, Material
from .modes import Modes, ShapesAlong, natural_modes
from .parameters import SuspiciousValue
from .reduction import ModalModel, reduce, single_mode
from .section import Layer, StripSection
from .spring import LeafSpring, Readout, Support, Tip
from .spring_shapes import cantilever, folded_u, straight_strip
from .straight_equivalent import as_one_spring, straight_equivalent

__all__ = [
    "ALUMINA",
    "Arc",
    "BRASS",
    "Centreline",
    "ConstantLossFactor",
    "ConstantRatio",
    "DAMPING_TAPE",
    "Damping",
    "Discretization",
    "ExactModes",
    "Layer",
    "LeafSpring",
    "Material",
    "MeasuredDecay",
    "ModalModel",
    "Modes",
    "Rayleigh",
    "Readout",
    "STEEL",
    "ShapesAlong",
    "Straight",
    "StripDamping",
    "StripSection",
    "Support",
    "SuspiciousValue",
    "Tip",
    "UniformBeam",
    "as_one_spring",
    "assemble",
    "cantilever",
    "default_elements",
    "exact_modes",
    "folded_u",
    "frequency_function",
    "natural_modes",
    "reduce",
    "single_mode",
    "straight_equivalent",
    "straight_strip",
]
