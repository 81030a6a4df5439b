"""The letter's spring and other leaf springs of this experiment, built from plain numbers with `beam`.

The lengths, the mass and the losses come from studies/scenes/letter.toml, which says whether each of them is
the letter's, assumed or calibrated.  Folds of the letter's orbits need 10 modes and kicks of a collision need
12: studies/physics/least_model.py finds these numbers.  tests/studies/test_scene.py compares spring and
scene.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from beam import (
    BRASS,
    DAMPING_TAPE,
    Layer,
    LeafSpring,
    MeasuredDecay,
    ModalModel,
    StripSection,
    Tip,
    assemble,
    cantilever,
    flat_u,
    folded_u,
    natural_modes,
    reduce,
)
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


def model_of(spring: LeafSpring, modes: int) -> ModalModel:
    """The lowest modes that move the ball, mode 1 with the letter's decay rate of 3.56 1/s."""
    found = natural_modes(assemble(spring), modes if spring.centreline.is_straight else 2 * modes + 1)
    return reduce(found, MeasuredDecay(decay_rate=3.56), modes)


def sections(thickness: float, loss_factor: float, both_sides: bool) -> dict[str, StripSection]:
    """The bare brass sheet of this thickness [m], and the sheet with tape."""
    bare = StripSection(material=BRASS, width=WIDTH, thickness=thickness)
    layer = Layer(
        material=replace(DAMPING_TAPE, loss_factor=loss_factor), thickness=TAPE, both_sides=both_sides
    )
    return dict(section=bare, damped_section=replace(bare, layer=layer))


@cache
def letters_spring(modes: int = FOLD_MODES) -> ModalModel:
    """A U cut out of a sheet, its legs side by side: free period 40.80 ms."""
    sheet = sections(0.0011760560469233, 0.53907109242132, both_sides=True)
    spring = flat_u(leg_length=LEG, bend_radius=0.009, tip=Tip(mass=0.0068341900547184), **sheet)
    return model_of(spring, modes)


@cache
def folded_strip(modes: int) -> ModalModel:
    """A strip folded into a U with a tight bend, the ball on the bend: free period 40.80 ms too."""
    sheet = sections(0.00069683709067, 0.49481929798, both_sides=False)
    spring = folded_u(leg_length=LEG, bend_radius=0.0075, tip=Tip(mass=0.006161452904), **sheet)
    return model_of(spring, modes)


@cache
def straight_leaf(modes: int) -> ModalModel:
    """A cantilever with a ball of 2 g at its end: free period 40.80 ms too."""
    sheet = sections(0.9439314446e-3, 0.49481929798, both_sides=False)
    spring = cantilever(length=LEG, tip=Tip(mass=0.002), **sheet)
    return model_of(spring, modes)
