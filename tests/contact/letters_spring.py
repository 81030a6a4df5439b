"""The letter's spring and other leaf springs of this experiment, built from plain numbers with `beam`.

The lengths, the mass and the losses come from studies/scenes/letter.toml, which says whether each of them is
the letter's, assumed or calibrated.  Folds of the letter's orbits need 10 modes and kicks of a collision need
12: studies/physics/least_model.py finds these numbers.  tests/studies/test_scene.py compares spring and
scene.
"""

from dataclasses import replace
from functools import cache

import beam
from contact import HertzContact

GAP = 0.011883925614219
"""Distance of the stop from the ball at rest [m]."""

FOLDED_GAP = 0.0106993324
"""The same for the folded strip and the straight leaf [m]."""

FOLD_MODES, KICK_MODES = 10, 12
"""Numbers of modes that folds and kicks need."""

HERTZ = HertzContact.of_bodies(
    radius=0.0025, youngs_modulus=370e9, poissons_ratio=0.22, other_modulus=210e9, other_ratio=0.29
)
"""An alumina ball on a steel plate."""

LEG, WIDTH, TAPE = 0.13, 0.012, 0.00045
"""Length and width of a leg, thickness of the damping tape [m]."""


def model_of(spring: beam.LeafSpring, modes: int) -> beam.ModalModel:
    """The lowest modes that move the ball, mode 1 with the letter's decay rate of 3.56 1/s."""
    found = beam.natural_modes(
        beam.assemble(spring), modes if spring.centreline.is_straight else 2 * modes + 1
    )
    return beam.reduce(found, beam.MeasuredDecay(decay_rate=3.56), modes)


def sections(thickness: float, loss_factor: float, both_sides: bool) -> dict[str, beam.StripSection]:
    """The bare brass sheet of this thickness [m], and the sheet with tape."""
    bare = beam.StripSection(material=beam.BRASS, width=WIDTH, thickness=thickness)
    layer = beam.Layer(
        material=replace(beam.DAMPING_TAPE, loss_factor=loss_factor), thickness=TAPE, both_sides=both_sides
    )
    return dict(section=bare, damped_section=replace(bare, layer=layer))


@cache
def letters_spring(modes: int = FOLD_MODES) -> beam.ModalModel:
    """A U cut out of a sheet, its legs side by side: free period 40.80 ms."""
    sheet = sections(0.0011760560469233, 0.53907109242132, both_sides=True)
    spring = beam.flat_u(leg_length=LEG, bend_radius=0.009, tip=beam.Tip(mass=0.0068341900547184), **sheet)
    return model_of(spring, modes)


@cache
def folded_strip(modes: int) -> beam.ModalModel:
    """A strip folded into a U with a tight bend, the ball on the bend: free period 40.80 ms too."""
    sheet = sections(0.00069683709067, 0.49481929798, both_sides=False)
    spring = beam.folded_u(leg_length=LEG, bend_radius=0.0075, tip=beam.Tip(mass=0.006161452904), **sheet)
    return model_of(spring, modes)


@cache
def straight_leaf(modes: int) -> beam.ModalModel:
    """A cantilever with a ball of 2 g at its end: free period 40.80 ms too."""
    sheet = sections(0.9439314446e-3, 0.49481929798, both_sides=False)
    spring = beam.cantilever(length=LEG, tip=beam.Tip(mass=0.002), **sheet)
    return model_of(spring, modes)


def steel_leaf() -> beam.ModalModel:
    """Four modes of a steel cantilever with a light ball."""
    section = beam.StripSection(material=beam.STEEL, width=0.012, thickness=0.00079)
    spring = beam.cantilever(length=0.206, section=section, tip=beam.Tip(mass=0.00072))
    return beam.reduce(beam.natural_modes(beam.assemble(spring), 4), beam.ConstantRatio(ratio=0.00701))
