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
computed one. `exact_modes` solves the frequency equation of the straight beam, to check the elements by; and
`backbone_coefficient` says how the frequency depends on the amplitude, `periodic_motion` how a spring swings
at finite rotations.

SI units throughout; parameters are keyword-only and frozen, and `dataclasses.replace` varies them. Wrong
values raise `ValueError` or `TypeError` with a sentence that names the field, the value, the unit and what is
valid; valid ones that can hardly be meant bring a warning, `SuspiciousValue`. Every module opens with the
equations it solves. A name is imported where it is first used: one who brings a `ModalModel` of measured
modes loads no finite elements.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .assembly import Discretization, assemble, default_elements
    from .backbone import Backbone, backbone_coefficient
    from .centreline import Arc, Centreline, Straight
    from .damping import ConstantLossFactor, ConstantRatio, Damping, MeasuredDecay, Rayleigh, StripDamping
    from .export import write_frames, write_mode_motion, write_modes
    from .finite_rotation import FiniteRotation
    from .frequency_equation import ExactModes, UniformBeam, exact_modes, frequency_function
    from .harmonic_balance import PeriodicMotion, periodic_motion
    from .material import ALUMINA, BRASS, DAMPING_TAPE, STEEL, Material
    from .modal_change import (
        damping_ratio_change,
        decay_rate_change,
        free_period_change,
        frequency_change,
        mode_changes,
        tip_mass_change,
    )
    from .modal_model import ModalChange, ModalModel, single_mode
    from .modes import Modes, ShapesAlong, natural_modes
    from .parameters import InvalidType, InvalidValue, Refusal, SuspiciousValue
    from .reduction import reduce
    from .section import Layer, StripSection
    from .spring import LeafSpring, Readout, Support, Tip
    from .spring_mesh import BALL, LAYER, STRIP, SpringMesh, solid_spring
    from .spring_shapes import cantilever, flat_u, folded_u, straight_strip
else:

    def __getattr__(name):
        """The public name, from the module that defines it."""
        for module, names in _NAMES.items():
            if name in names:
                globals()[name] = getattr(import_module(f"{__name__}.{module}"), name)
                return globals()[name]
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


_RULES = ("ConstantLossFactor", "ConstantRatio", "Damping", "MeasuredDecay", "Rayleigh", "StripDamping")
_CHANGES = ("damping_ratio_change", "decay_rate_change", "free_period_change", "frequency_change")
_NAMES = {
    "assembly": ("Discretization", "assemble", "default_elements"),
    "backbone": ("Backbone", "backbone_coefficient"),
    "centreline": ("Arc", "Centreline", "Straight"),
    "damping": _RULES,
    "export": ("write_frames", "write_mode_motion", "write_modes"),
    "finite_rotation": ("FiniteRotation",),
    "frequency_equation": ("ExactModes", "UniformBeam", "exact_modes", "frequency_function"),
    "harmonic_balance": ("PeriodicMotion", "periodic_motion"),
    "material": ("ALUMINA", "BRASS", "DAMPING_TAPE", "Material", "STEEL"),
    "modal_change": (*_CHANGES, "mode_changes", "tip_mass_change"),
    "modal_model": ("ModalChange", "ModalModel", "single_mode"),
    "modes": ("Modes", "ShapesAlong", "natural_modes"),
    "parameters": ("InvalidType", "InvalidValue", "Refusal", "SuspiciousValue"),
    "reduction": ("reduce",),
    "section": ("Layer", "StripSection"),
    "spring": ("LeafSpring", "Readout", "Support", "Tip"),
    "spring_mesh": ("BALL", "LAYER", "STRIP", "SpringMesh", "solid_spring"),
    "spring_shapes": ("cantilever", "flat_u", "folded_u", "straight_strip"),
}
"""Module -> its public names."""

__all__ = sorted(name for names in _NAMES.values() for name in names)


def __dir__() -> list[str]:
    return __all__
