"""From a scene to the spring, its modes and the modal model that the impacts see.

The names are public in `studies.shell.scene`.

Every model has one read-out, `READOUT`: what the laser sees, displacement [m] or rotation [rad]. Modes that
were measured and Eq. (1) have no shape but at the tip, so that their read-out is the tip. The tape covers
each leg from its support by the part `spring.tape_coverage`; with damping.kind strips the modes decay as the
strain energies of sheet and tape say, scaled by one factor that gives mode 1 `damping.decay_rate_per_s`.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import beam
from beam import LeafSpring, ModalModel, Modes, StripSection
from studies.shell.scene.key import OPEN, SceneError, shown
from studies.shell.scene.mode_lists import LISTS, RATES, RATIOS, RESIDUES, TIP, fault_of
from studies.shell.scene.values import Scene

SHORTEST = 1e-6
"""Free period [s] of Eq. (1), at least."""

READOUT = "readout"
"""Name of the read-out in every model."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasuredRates:
    """Decay rates c [1/s] as measured, one a coupled mode, lowest first; not a number for the other modes."""

    rates: tuple[float, ...]

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return c [1/s], shape (n_modes,)."""
        found = np.full_like(modes.omega, np.nan)
        places = np.flatnonzero(modes.coupled)[: len(self.rates)]
        found[places] = self.rates[: places.size]
        return found


RAYLEIGH = {"mass_coefficient": "damping.rayleigh_alpha_per_s"}
RAYLEIGH |= {"stiffness_coefficient": "damping.rayleigh_beta_s"}
DAMPING = {
    "strips": (beam.MeasuredDecay, {"decay_rate": "damping.decay_rate_per_s"}),
    "constant_ratio": (beam.ConstantRatio, {"ratio": "damping.ratio"}),
    "constant_loss_factor": (beam.ConstantLossFactor, {"loss_factor": "damping.loss_factor"}),
    "rayleigh": (beam.Rayleigh, RAYLEIGH),
    "measured": (MeasuredRates, {"rates": "damping.measured_rates_per_s"}),
}
"""damping.kind -> the rule, and its arguments, to which the rates are proportional, with their keys."""


def sections_of(scene: Scene) -> tuple[StripSection, StripSection | None]:
    """The bare sheet, and the sheet with its tape (None without tape)."""

    def material(*keys: str) -> beam.Material:
        """The material with the values of these keys of the spring."""
        names = ("youngs_modulus", "poissons_ratio", "density", "loss_factor")
        return scene.make(beam.Material, dict(zip(names, [f"spring.{key}" for key in keys], strict=True)))

    sheet = material("young_modulus_pa", "poisson_ratio", "density_kg_m3", "loss_factor")
    size = {"width": "spring.width_m", "thickness": "spring.thickness_m"}
    bare = scene.make(StripSection, size, material=sheet)
    if scene.spring.tape_thickness_m == 0.0:
        return bare, None
    tape = material("tape_modulus_pa", "tape_poisson_ratio", "tape_density_kg_m3", "tape_loss_factor")
    both = scene.spring.tape_sides == 2
    layer = scene.make(beam.Layer, {"thickness": "spring.tape_thickness_m"}, material=tape, both_sides=both)
    return bare, dataclasses.replace(bare, layer=layer)


def spring_of(scene: Scene) -> LeafSpring:
    """The leaf spring with its read-out; SceneError for spring.kind modal_data, which has no shape."""
    keys, tip = scene.spring, scene.tip
    if keys.kind == "modal_data":
        words = "modal_data gives modes without their shapes: this needs a spring that is drawn"
        raise SceneError("spring.kind", words)
    bare, taped = sections_of(scene)
    leg = keys.leg_length_m
    ball = scene.make(beam.Tip, {"mass": "tip.mass_kg", "rotary_inertia": "tip.rotary_inertia_kg_m2"})
    beyond = {"folded_u": leg + math.pi * keys.bend_radius_m, "flat_u": keys.bend_radius_m}
    seen_at = scene.readout.arc_fraction * (leg + beyond.get(keys.kind, 0.0))
    readout = scene.make(beam.Readout, {"quantity": "readout.quantity"}, at=seen_at)
    common: dict[str, Any] = {"section": bare, "tip": ball, "readouts": {READOUT: readout}}
    if taped:
        common |= {"damped_section": taped, "damped_span": (0.0, keys.tape_coverage * leg)}
    length = {"length": "spring.leg_length_m"}

    def bent(length: float, radius: float, bend_radius: float) -> LeafSpring:
        shape = beam.folded_u if keys.kind == "folded_u" else beam.flat_u
        return shape(leg_length=length, bend_radius=bend_radius, **common)

    if keys.kind in beyond:  # refusals name the bend's radius either way
        return scene.make(bent, length | dict.fromkeys(("radius", "bend_radius"), "spring.bend_radius_m"))
    if keys.kind == "cantilever":
        return scene.make(beam.cantilever, length, **common)
    held = {"supports": (keys.start_support, keys.end_support), "tip_at": tip.arc_fraction * leg}
    place = {"tip_at": "tip.arc_fraction times spring.leg_length_m"}
    return scene.make(beam.straight_strip, length | place, **common, **held)


def elements_of(scene: Scene, spring: LeafSpring) -> tuple[int, ...]:
    """Number of elements on each piece: as given, shared by length on a leg, or the default."""
    keys, counts = scene.spring, []
    for piece, usual in zip(spring.centreline.pieces, beam.default_elements(spring), strict=True):
        straight = piece.curvature == 0.0
        wanted = keys.elements_per_leg if straight else keys.elements_on_arc
        share = piece.length / keys.leg_length_m if straight else 1.0
        counts.append(max(1, math.ceil(wanted * share - 1e-9)) if wanted else usual)
    return tuple(counts)


def modes_of(scene: Scene, count: int | None = None) -> Modes:
    """The lowest modes up to the coupled one with number `count` (modes.count by default).

    Frequencies come from the strain energies of the shapes, omega^2 = 2 energy (Rayleigh's quotient): the
    solver leaves 1e-8 of rounding on the first, and an error of the shape enters the quotient squared.
    """
    wanted = scene.kept_modes if count is None else count
    spring = spring_of(scene)
    discretization = beam.assemble(spring, elements_of(scene, spring))
    tried = min(discretization.n_dofs, wanted if spring.centreline.is_straight else 2 * wanted + 1)
    while True:
        modes = beam.natural_modes(discretization, tried)
        coupled = np.flatnonzero(modes.coupled)
        if coupled.size >= wanted:
            break
        if tried == discretization.n_dofs:
            raise SceneError(
                f"modes.count must be at most {coupled.size}, the coupled modes of this mesh, not {wanted}: "
                "keep fewer or give spring.elements_per_leg and spring.elements_on_arc more elements"
            )
        tried = min(2 * tried, discretization.n_dofs)
    count = int(coupled[wanted - 1]) + 1
    shapes, omega = modes.shapes[:, :count], modes.omega[:count]
    energies = discretization.strain_energies(shapes).sum(axis=(0, 1))
    omega = np.where(omega > 0.0, np.sqrt(2.0 * energies), 0.0)
    readouts = {name: row[:count] for name, row in modes.readouts.items()}
    kept = {name: getattr(modes, name)[:count] for name in ("phi", "participation", "coupled")}
    return dataclasses.replace(modes, omega=omega, shapes=shapes, readouts=readouts, **kept)


def damping_of(scene: Scene) -> beam.Damping:
    """The rule that gives each mode its decay rate."""
    rule, keys = DAMPING[scene.damping.kind]
    return scene.make(rule, keys)


def model_of(scene: Scene) -> ModalModel:
    """The modal model: `modes.count` coupled modes, or at most as many of those that were measured."""
    if scene.spring.kind != "modal_data":
        model = beam.reduce(modes_of(scene), damping_of(scene), scene.kept_modes)
        require_drive_below(scene, model)
        return model
    return measured_model(scene)


def measured_model(scene: Scene) -> ModalModel:
    """The lowest `kept_modes` of the modes in [modal_data], however they are described."""
    data, names = scene.modal_data, {name: f"modal_data.{name}" for name in LISTS}
    given = {name: np.array(values) for name in LISTS if (values := scene[names[name]])}
    if fault := fault_of(given):
        raise SceneError("modal_data", f"{fault}; spring.kind modal_data needs lists, one entry a mode")
    if len({values.size for values in given.values()}) > 1:
        sizes = ", ".join(f"{name} {values.size}" for name, values in given.items())
        raise SceneError("modal_data", f"must have lists of equal length, not of {sizes} entries")
    order = np.argsort(data.frequencies_hz, kind="stable")[: scene.kept_modes]
    given = {name: values[order] for name, values in given.items()}
    omega = 2.0 * np.pi * given["frequencies_hz"]
    rates = 2.0 * omega * given["damping_ratios"] if RATIOS[0] in given else given[RATES[0]]
    keys = {
        "omega": names["frequencies_hz"],
        "decay_rate": names[(RATIOS if RATIOS[0] in given else RATES)[0]],
    }
    statics = {
        "static_compliance": data.static_compliance_m_per_n or None,
        "tip_mass": data.tip_mass_kg or None,
    }
    if TIP[0] in given:
        phi, participation = (given[name] for name in TIP)
        rows = {"omega": omega, "decay_rate": rates, "phi": phi, "participation": participation}
        model = scene.make(ModalModel, keys, **rows, **statics)
    else:
        poles = -0.5 * rates + 1j * np.sqrt(np.maximum(omega**2 - 0.25 * rates**2, 0.0))
        force, base = (given[re] + 1j * given[im] for re, im in (RESIDUES[:2], RESIDUES[2:]))
        keys = {"poles": "modal_data", "response": "modal_data.response"}
        keys |= {"force_residues": "modal_data.force_residues", "base_residues": "modal_data.base_residues"}
        rows = {"poles": poles, "force_residues": force, "base_residues": base}
        model = scene.make(ModalModel.from_residues, keys, **rows, **statics)
    points = {READOUT: beam.Point(row=model.phi)}
    return dataclasses.replace(model, points=points, dimensionless=data.dimensionless)


def require_drive_below(scene: Scene, model: ModalModel, frequency: float | None = None) -> None:
    """SceneError if a drive frequency, or `frequency` [Hz], lies above the highest mode of the model."""
    fastest, highest = frequency or max(scene.drive.frequencies_hz), float(model.frequencies_hz.max())
    if scene.drive.kind == "harmonic" and fastest > highest:
        words = f"above the highest of the modes kept ({highest:.6g} Hz)"
        remedy = "drive more slowly or raise modes.count"
        raise SceneError("drive.frequencies_hz", f"has {fastest:g} Hz, {words}: {remedy}")


def backbone_of(scene: Scene) -> beam.Backbone:
    """How mode 1 depends on its amplitude; measured modes bring one number, taken as elastic."""
    data = scene.modal_data
    if scene.spring.kind == "modal_data":
        return beam.Backbone(elastic=data.kappa, inertial=0.0, length=data.kappa_length_m)
    spring = spring_of(scene)
    if spring.rigid_motions:
        return beam.Backbone(elastic=0.0, inertial=0.0, length=spring.centreline.length)
    return scene.make(beam.backbone_coefficient, {}, spring=spring, elements=elements_of(scene, spring))


def shift_at_gap(scene: Scene) -> float:
    """What the amplitude of the gap changes in the free frequency, relative to small amplitudes [1]."""
    backbone = backbone_of(scene)
    return backbone.kappa * (scene.stop.gap_m / backbone.length) ** 2


def single_mode_of(scene: Scene) -> ModalModel:
    """Eq. (1) of the letter: one mode of unit mass with the period and the decay rate in [single_mode]."""
    keys = {"free_period": "single_mode.free_period_s", "decay_rate": "single_mode.decay_rate_per_s"}
    if not scene.single_mode.free_period_s >= SHORTEST:
        given, valid = shown(scene.single_mode.free_period_s), f"at least {SHORTEST:g} (unit s)"
        raise SceneError(f"{keys['free_period']} must be {valid}, or -1 for that of mode 1, not {given}")
    model = scene.make(beam.single_mode, keys)
    own = scene.modal_data.dimensionless
    return dataclasses.replace(model, points={READOUT: model.points["tip"]}, dimensionless=own)


def first_mode(scene: Scene) -> tuple[float, float]:
    """Damped period [s] and decay rate [1/s] of the first mode of the spring that is no rigid motion.

    The period is infinite if that mode does not oscillate.
    """
    if scene.spring.kind == "modal_data":
        model = model_of(scene)
        first = min(int(np.argmax(model.omega > 0.0)), model.n_modes - 1)
        rate, omega = float(model.decay_rate[first]), float(model.omega[first])
    else:
        modes = modes_of(scene, 1 + spring_of(scene).rigid_motions)
        rate, omega = float(damping_of(scene).decay_rates(modes)[-1]), float(modes.omega[-1])
    square = omega**2 - (0.5 * rate) ** 2
    return (2.0 * math.pi / math.sqrt(square) if square > 0.0 else math.inf), rate


def free_period(scene: Scene) -> float:
    """Damped period of the first mode of the spring [s]; infinite if it does not oscillate."""
    return first_mode(scene)[0]


def with_first_mode(scene: Scene) -> Scene:
    """The scene with period and decay rate of mode 1, to nine digits, where they are open."""
    names = ("single_mode.free_period_s", "single_mode.decay_rate_per_s")
    if not any(scene[name] == OPEN for name in names):
        return scene
    found = first_mode(scene)
    pairs = zip(names, found, strict=True)
    values = {name: float(f"{value:.9g}") for name, value in pairs if scene[name] == OPEN}
    if math.isinf(found[0]):
        both = f"{names[0]} (unit s) and {names[1]} (unit 1/s)"
        raise SceneError(f"mode 1 of the spring does not oscillate: give {both}")
    return scene.replace(values, provenance="mode 1")


def metal_of(material: beam.Material) -> str:
    """Brass or steel, if modulus and density are within a tenth of it, else ""."""
    found = [material.youngs_modulus, material.density]
    known = {"brass": beam.BRASS, "steel": beam.STEEL}
    like = [name for name, m in known.items() if np.allclose(found, [m.youngs_modulus, m.density], 0.1, 0.0)]
    return like[0] if like else ""


def spring_in_words(scene: Scene) -> str:
    """What the spring is, in a few words: steel cantilever, spring with measured modes."""
    if scene.spring.kind == "modal_data":
        return "spring with measured modes"
    kind = scene.spring.kind.replace("_u", " U-shaped spring").replace("_", " ")
    return f"{metal_of(sections_of(scene)[0].material)} {kind}".lstrip()


def size_in_words(scene: Scene) -> str:
    """Length, width and thickness of the strip, ball and gap, in mm and g."""
    spring, gap = scene.spring, f"a gap of {1e3 * scene.stop.gap_m:.3g} mm"
    if spring.kind == "modal_data":
        return gap
    sizes = (spring.leg_length_m, spring.width_m, spring.thickness_m)
    ball = f"a ball of {1e3 * scene.tip.mass_kg:.2g} g"
    return f"{' × '.join(f'{1e3 * size:.3g}' for size in sizes)} mm, {ball}, {gap}"
