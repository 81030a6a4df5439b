"""Linear vibration of thin leaf springs, from the drawing to a modal model.

A strip of sheet metal follows a plane centreline. A moving base holds its ends, and it carries a ball that
can touch a stop:

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
in the arc length), `Modes` (mass-normalised), `ModalModel`. Each of them may be made by hand, for instance a
`ModalModel` of measured numbers. `single_mode` is the oscillator with one degree of freedom.
`ModalModel.from_residues` takes poles and residues of a modal test, `ModalModel.from_matrices` mass and
stiffness matrices of any other program. `exact_modes` solves the frequency equation of the straight beam, as
a check of the elements. At finite rotations, `backbone_coefficient` gives the frequency over the amplitude,
and `periodic_motion` the motion itself.

All units are SI. Parameters are keyword-only and frozen, and `dataclasses.replace` varies them. Wrong values
raise `ValueError` or `TypeError` with one sentence (see `beam.parameters`). Values that can hardly be meant
bring a warning, `SuspiciousValue`. A name is imported at its first use, so that a `ModalModel` of measured
modes loads no finite elements.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

__version__ = "0.9.0"

if TYPE_CHECKING:
    from .assembly import Discretization, assemble, default_elements
    from .centreline import Arc, Centreline, Straight
    from .damping import ConstantLossFactor, ConstantRatio, Damping, MeasuredDecay, Rayleigh, StripDamping
    from .derivatives import (
        ModalChange,
        decay_rate_change,
        free_period_change,
        tip_mass_change,
        with_tip_mass,
    )
    from .export import write_frames, write_mode_motion, write_modes
    from .frequency_equation import ExactModes, UniformBeam, exact_modes
    from .large_amplitude import (
        Backbone,
        FiniteRotation,
        PeriodicMotion,
        backbone_coefficient,
        periodic_motion,
    )
    from .material import ALUMINA, BRASS, DAMPING_TAPE, STEEL, Material
    from .modal_model import ModalModel
    from .modes import Modes, ShapesAlong, natural_modes
    from .one_mode import single_mode
    from .parameters import InvalidType, InvalidValue, Refusal, SuspiciousValue, suspect
    from .point import Point
    from .reduction import reduce
    from .section import BeamSection, Layer, StripSection
    from .spring import LeafSpring, Readout, Support, Tip
    from .spring_mesh import BALL, LAYER, STRIP, SpringMesh, solid_spring
    from .spring_shapes import cantilever, flat_u, folded_u, straight_strip
else:

    def __getattr__(name):
        """Return the public name from the module that defines it."""
        if name not in _MODULES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
        return globals()[name]


_MODULES = {
    alias.name: node.module
    for node in ast.walk(ast.parse(Path(__file__).read_text(encoding="utf-8")))
    if isinstance(node, ast.ImportFrom) and node.level == 1
    for alias in node.names
}
"""Module of each public name, read from the imports above, so that each name stands once."""

__all__ = sorted(_MODULES)


def __dir__() -> list[str]:
    return __all__
