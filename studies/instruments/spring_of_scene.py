"""From a scene to the spring, its modes and the modal model that the impacts see.

    spring = spring_of(scene)        # beam.LeafSpring, read-out point included
    modes = modes_of(scene)          # up to the last coupled mode that is kept, uncoupled ones included
    model = model_of(scene)          # beam.ModalModel of `modes.count` coupled modes
    simple = single_mode_of(scene)   # Eq. (1) of the letter

Every model has one read-out named "readout": what the laser beam sees, displacement [m] or rotation [rad].
Modes that were measured (spring.kind modal_data) and Eq. (1) have no shape but at the tip, so that there the
read-out is the tip.

The damping tape covers each leg from its support outwards, by the part `spring.tape_coverage`; the bend stays
bare. With damping.kind strips the modes decay as the strain energies of sheet and tape say, all of them
scaled by one factor that gives mode 1 the rate `damping.decay_rate_per_s` (beam.MeasuredDecay); the factor
is 1 for a scene out of `calibration.calibrate_damping`.

Frequencies come from the strain energies of the mode shapes, omega^2 = 2 energy of the mass-normalised shape
(Rayleigh's quotient). The eigenvalue solver leaves 1e-8 of rounding on the first one, from the stiffness of
single elements; an error in the shape enters the quotient squared, and 1e-12 are left.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from beam import (
    ConstantLossFactor,
    ConstantRatio,
    Damping,
    Layer,
    LeafSpring,
    Material,
    MeasuredDecay,
    ModalModel,
    Modes,
    Rayleigh,
    Readout,
    StripDamping,
    StripSection,
    Support,
    Tip,
    assemble,
    cantilever,
    default_elements,
    folded_u,
    natural_modes,
    reduce,
    single_mode,
    straight_strip,
)
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene

READOUT = "readout"
"""Name of the read-out in every model."""


@dataclass(frozen=True, kw_only=True)
class MeasuredRates:
    """Decay rates c [1/s] as measured, one a coupled mode, lowest first; not a number for the other modes."""

    rates: tuple[float, ...]

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return c [1/s], shape (n_modes,)."""
        found = np.full(modes.omega.size, np.nan)
        places = np.flatnonzero(modes.coupled)[: len(self.rates)]
        found[places] = self.rates[: places.size]
        return found


def spring_of(scene: Scene) -> LeafSpring:
    """The leaf spring; SceneError for spring.kind modal_data, which has no shape."""
    keys = scene.spring
    bare, taped = sections_of(scene)
    shared: dict[str, Any] = {
        "section": bare,
        "tip": Tip(mass=scene.tip.mass_kg, rotary_inertia=scene.tip.rotary_inertia_kg_m2),
        "damped_section": taped,
        "damped_span": None if taped is None else (0.0, keys.tape_coverage * keys.leg_length_m),
        "readouts": {READOUT: _readout(scene)},
    }
    if keys.kind == "folded_u":
        return folded_u(leg_length=keys.leg_length_m, bend_radius=keys.bend_radius_m, **shared)
    if keys.kind == "cantilever":
        return cantilever(length=keys.leg_length_m, **shared)
    if keys.kind == "straight_strip":
        _refuse_held_tip(scene)
        return straight_strip(
            length=keys.leg_length_m,
            supports=(cast(Support, keys.start_support), cast(Support, keys.end_support)),
            tip_at=scene.tip.arc_fraction * keys.leg_length_m,
            **shared,
        )
    raise SceneError(
        f"spring.kind {keys.kind} gives modes without their shapes: this needs a spring that is drawn, "
        "folded_u, cantilever or straight_strip"
    )


def sections_of(scene: Scene) -> tuple[StripSection, StripSection | None]:
    """The bare sheet, and the sheet with its tape (None without tape)."""
    keys = scene.spring
    sheet = Material(
        youngs_modulus=keys.young_modulus_pa,
        poissons_ratio=keys.poisson_ratio,
        density=keys.density_kg_m3,
        loss_factor=keys.loss_factor,
    )
    bare = StripSection(material=sheet, width=keys.width_m, thickness=keys.thickness_m)
    if keys.tape_thickness_m == 0.0:
        return bare, None
    tape = Material(
        youngs_modulus=keys.tape_modulus_pa,
        poissons_ratio=keys.tape_poisson_ratio,
        density=keys.tape_density_kg_m3,
        loss_factor=keys.tape_loss_factor,
    )
    layer = Layer(material=tape, thickness=keys.tape_thickness_m, both_sides=keys.tape_sides == 2)
    return bare, dataclasses.replace(bare, layer=layer)


def elements_of(scene: Scene, spring: LeafSpring) -> tuple[int, ...]:
    """Number of elements on each piece: those asked for, shared by length on a leg, or the default."""
    keys, counts = scene.spring, []
    for piece, usual in zip(spring.centreline.pieces, default_elements(spring), strict=True):
        straight = piece.curvature == 0.0
        asked = keys.elements_per_leg if straight else keys.elements_on_arc
        share = piece.length / keys.leg_length_m if straight else 1.0
        counts.append(max(1, math.ceil(asked * share - 1e-9)) if asked else usual)
    return tuple(counts)


def modes_of(scene: Scene, count: int | None = None) -> Modes:
    """The lowest modes up to the coupled mode number `count` (modes.count by default).

    Twice as many are asked for until enough of them couple, at most all that the elements have.
    """
    wanted = scene.kept_modes if count is None else count
    if wanted < 1:
        raise SceneError(f"modes.count must be at least 1, not {wanted}")
    spring = spring_of(scene)
    discretization = assemble(spring, elements_of(scene, spring))
    size = discretization.n_dofs
    asked = min(size, wanted if spring.centreline.is_straight else 2 * wanted + 1)
    while True:
        modes = natural_modes(discretization, asked)
        coupled = np.flatnonzero(modes.coupled)
        if coupled.size >= wanted:
            return _sharpened(first_modes(modes, int(coupled[wanted - 1]) + 1))
        if asked == size:
            raise SceneError(
                f"modes.count must be at most {coupled.size}, the coupled modes of this mesh, not {wanted}: "
                "keep fewer modes or give spring.elements_per_leg and spring.elements_on_arc more elements"
            )
        asked = min(2 * asked, size)


def first_modes(modes: Modes, count: int) -> Modes:
    """The `count` lowest of these modes."""
    return dataclasses.replace(
        modes,
        omega=modes.omega[:count],
        shapes=modes.shapes[:, :count],
        phi=modes.phi[:count],
        participation=modes.participation[:count],
        coupled=modes.coupled[:count],
        readouts={name: row[:count] for name, row in modes.readouts.items()},
    )


def _sharpened(modes: Modes) -> Modes:
    """The modes with frequencies from their strain energies; 0 stays 0."""
    energies = modes.discretization.strain_energies(modes.shapes).sum(axis=(0, 1))
    return dataclasses.replace(modes, omega=np.where(modes.omega > 0.0, np.sqrt(2.0 * energies), 0.0))


def damping_of(scene: Scene) -> Damping:
    """The rule that gives each mode its decay rate."""
    keys = scene.damping
    if keys.kind == "constant_ratio":
        return ConstantRatio(ratio=keys.ratio)
    if keys.kind == "constant_loss_factor":
        return ConstantLossFactor(loss_factor=keys.loss_factor)
    if keys.kind == "rayleigh":
        return Rayleigh(
            mass_coefficient=keys.rayleigh_alpha_per_s, stiffness_coefficient=keys.rayleigh_beta_s
        )
    if keys.kind == "measured":
        return MeasuredRates(rates=keys.measured_rates_per_s)
    return MeasuredDecay(decay_rate=keys.decay_rate_per_s, others=StripDamping(), scaled=True)


def model_of(scene: Scene) -> ModalModel:
    """The modal model: `modes.count` coupled modes, or at most as many of those that were measured."""
    if scene.spring.kind == "modal_data":
        return _measured_model(scene)
    model = reduce(modes_of(scene), damping_of(scene), scene.kept_modes)
    scene.refuse_drive_above(float(model.frequencies_hz[-1]))
    return model


def single_mode_of(scene: Scene) -> ModalModel:
    """Eq. (1) of the letter: one mode of unit mass with the period and the decay rate in [single_mode]."""
    keys = scene.single_mode
    model = single_mode(free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s)
    return dataclasses.replace(model, readouts={READOUT: model.phi})


def _measured_model(scene: Scene) -> ModalModel:
    data = scene.modal_data
    order = np.argsort(data.frequencies_hz, kind="stable")[: scene.kept_modes]
    tip_values = np.array(data.tip_values)[order]
    return ModalModel(
        omega=2.0 * np.pi * np.array(data.frequencies_hz)[order],
        decay_rate=np.array(data.decay_rates_per_s)[order],
        phi=tip_values,
        participation=np.array(data.participation)[order],
        static_compliance=data.static_compliance_m_per_n or None,
        tip_mass=data.tip_mass_kg or None,
        readouts={READOUT: tip_values},
    )


def _readout(scene: Scene) -> Readout:
    """The laser spot, at a part of the whole strip."""
    keys = scene.spring
    bend = math.pi * keys.bend_radius_m
    length = 2.0 * keys.leg_length_m + bend if keys.kind == "folded_u" else keys.leg_length_m
    at = scene.readout.arc_fraction * length
    return Readout(at=at, quantity="rotation" if scene.readout.quantity == "rotation" else "displacement")


def _refuse_held_tip(scene: Scene) -> None:
    """SceneError if the tip sits on a support that does not let it move towards the stop."""
    place = scene.tip.arc_fraction
    supports = {0.0: ("start", scene.spring.start_support), 1.0: ("end", scene.spring.end_support)}
    if place in supports and supports[place][1] in ("clamped", "pinned"):
        end, support = supports[place]
        raise SceneError(
            f"tip.arc_fraction must not be {place:g} while spring.{end}_support is {support}: the tip could "
            "not move there"
        )
