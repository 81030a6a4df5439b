"""The curves along which one approach to the plate is varied, each a list of `Approach`.

speed        excess, hence approach speed v = 2 pi f gap sqrt((1 + excess)^2 - 1)
modes        number of modes kept, for the spring of the scene and for a bare cantilever
mass         tip mass over leaf, at fixed period and drive amplitude (tip_mass_family), at several excesses
orbit        the same, but the collision of the orbit that settles at the letter's Fig. 4
stiffness    linear contact of 1e2 ... 1e7 times the static stiffness of the tip, and Hertz of materials
damping      rates of the modes above the first, times a factor, for three rules with the same mode 1
loss         restitution of the contact itself, Hunt-Crossley's law or Newton's
search       tip mass and local restitution together; hardness: tip mass and stiffness together
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from beam import ALUMINA, BRASS, STEEL, Material
from contact.laws import ContactLaw, HertzContact, LinearContact, NewtonRestitution
from studies.instruments.effective_impact.approaches import Approach
from studies.instruments.effective_impact.grid import Grid
from studies.instruments.effective_impact.specimen import Specimen
from studies.instruments.oscillators import contact_law_of
from studies.published import TIME_TRACE_EXCESS

__all__ = ["PLASTIC", "SCENE_MASS", "all_curves", "contacts"]

PLASTIC = Material(youngs_modulus=0.2e9, poissons_ratio=0.45, density=920.0, loss_factor=0.1)
"""Low-density polyethylene: a ball of it on steel is the softest contact considered."""

BALLS: Mapping[str, Material] = {
    "alumina on steel": ALUMINA,
    "steel on steel": STEEL,
    "brass on steel": BRASS,
    "polyethylene on steel": PLASTIC,
}

SCENE_MASS, LIGHTEST = "tip mass of the scene", 0.05
"""Of the stiffness curves: name of the first, and tip mass over leaf of the last."""

ORBIT_FREQUENCY = 21.50
"""The letter's Fig. 4 [Hz]."""


def all_curves(
    scene: Specimen, masses: list[Specimen], fine: Mapping[str, Specimen], grid: Grid
) -> list[Approach]:
    """Every cell of the study.

    Parameters
    ----------
    scene : the spring as it is, with `grid.modes` modes.
    masses : the family of tip masses, by rising mass, the bare tip first.
    fine : "scene", "light tip" and "bare cantilever" with `grid.check_modes` modes.
    """
    bare = masses[0]
    return [
        *_speed(scene, bare, grid),
        *_modes(fine, grid),
        *_masses(masses, grid),
        *_stiffness(scene, masses, grid),
        *_damping(scene, grid),
        *_loss(scene, grid),
    ]


def contacts(scene: Specimen) -> list[tuple[str, Specimen, ContactLaw]]:
    """The contact of the scene, named so where it is not Hertz's, and Hertz's."""
    law = contact_law_of(scene.scene)
    own = [] if law == scene.hertz else [("scene", scene, law)]
    return [*own, ("hertz", scene, scene.hertz)]


def _speed(scene: Specimen, bare: Specimen, grid: Grid) -> list[Approach]:
    lines = [*contacts(scene), ("bare tip", bare, bare.hertz)]
    return [
        Approach(
            curve="speed", series=name, varied="excess", value=excess, oscillator=specimen.with_law(law),
            excess=excess, mass_ratio=specimen.mass_ratio,
        )
        for name, specimen, law in lines
        for excess in grid.excesses
    ]


def _modes(fine: Mapping[str, Specimen], grid: Grid) -> list[Approach]:
    newton = NewtonRestitution(local_restitution=1.0)
    scene, light, cantilever = fine["scene"], fine["light tip"], fine["bare cantilever"]
    lines = [
        *contacts(scene),
        ("newton", scene, newton),
        ("light tip, hertz", light, light.hertz),
        ("bare cantilever, hertz", cantilever, cantilever.hertz),
        ("bare cantilever, newton", cantilever, newton),
    ]
    return [
        Approach(
            curve="modes", series=name, varied="modes", value=float(count),
            oscillator=specimen.with_law(law, specimen.model.truncated(count)), excess=TIME_TRACE_EXCESS,
            mass_ratio=specimen.mass_ratio,
        )
        for name, specimen, law in lines
        for count in [*range(1, grid.modes + 1), grid.check_modes]
    ]


def _masses(masses: list[Specimen], grid: Grid) -> list[Approach]:
    cells = []
    for specimen in masses:
        ratio = specimen.mass_ratio
        shared: dict[str, Any] = {"varied": "mass_ratio", "value": ratio, "mass_ratio": ratio}
        for excess in grid.mass_excesses:
            cells.append(
                Approach(
                    curve="mass", series=f"excess {excess:g}", oscillator=specimen.with_law(specimen.hertz),
                    excess=excess, **shared,
                )
            )
        oscillator = specimen.with_law(specimen.hertz, frequency=ORBIT_FREQUENCY)
        cells.append(
            Approach(
                curve="orbit",
                series=f"{ORBIT_FREQUENCY:g} Hz",
                oscillator=oscillator,
                excess=TIME_TRACE_EXCESS,
                orbit=True,
                **shared,
            )
        )
        for restitution in grid.restitutions:
            law = specimen.lossy(restitution, TIME_TRACE_EXCESS)
            cells.append(
                Approach(
                    curve="search", series=f"{restitution:g}", oscillator=specimen.with_law(law),
                    excess=TIME_TRACE_EXCESS, local_restitution=restitution, **shared,
                )
            )
        for factor in grid.hardnesses if ratio > 0.0 else ():
            cells.append(
                Approach(
                    curve="hardness", series=f"{factor:g}", excess=TIME_TRACE_EXCESS,
                    oscillator=specimen.with_law(specimen.as_hard_as(factor, TIME_TRACE_EXCESS)), **shared,
                )
            )
    return cells


def _stiffness(scene: Specimen, masses: list[Specimen], grid: Grid) -> list[Approach]:
    lines = [(SCENE_MASS, scene)]
    lines += [
        ("no tip mass" if m.mass_ratio == 0.0 else f"tip mass {m.mass_ratio:.2g} of the leaf", m)
        for m in masses
        if m.mass_ratio == 0.0 or math.isclose(m.mass_ratio, LIGHTEST, rel_tol=1e-6)
    ]
    cells = [
        Approach(
            curve="stiffness", series=name, varied="stiffness_over_tip_stiffness", value=value,
            oscillator=specimen.with_law(LinearContact(stiffness=value * specimen.tip_stiffness)),
            excess=TIME_TRACE_EXCESS, mass_ratio=specimen.mass_ratio,
        )
        for name, specimen in lines
        for value in grid.stiffnesses
    ]
    tip, speed = scene.scene.tip, scene.speed(TIME_TRACE_EXCESS)
    for name, ball in BALLS.items():
        law = HertzContact.of_bodies(
            radius=tip.ball_radius_m, youngs_modulus=ball.youngs_modulus, poissons_ratio=ball.poissons_ratio,
            other_modulus=STEEL.youngs_modulus, other_ratio=STEEL.poissons_ratio,
        )
        # the linear contact of equal contact time, so that both stand on one axis
        mass = tip.mass_kg
        equal = mass * (math.pi / law.contact_time(mass, speed)) ** 2 if mass > 0.0 else math.nan
        cells.append(
            Approach(
                curve="materials", series=name, varied="stiffness_over_tip_stiffness",
                value=equal / scene.tip_stiffness, oscillator=scene.with_law(law), excess=TIME_TRACE_EXCESS,
                mass_ratio=scene.mass_ratio,
            )
        )
    return cells


def _damping(scene: Specimen, grid: Grid) -> list[Approach]:
    model = scene.model
    omega, first = model.omega, float(model.decay_rate[0])
    rules = {
        "as in the scene": model.decay_rate,
        "constant ratio": first * omega / omega[0],
        "proportional to stiffness": first * (omega / omega[0]) ** 2,
    }
    return [
        Approach(
            curve="damping", series=name, varied="factor", value=factor, excess=TIME_TRACE_EXCESS,
            oscillator=scene.with_law(
                scene.hertz, replace(model, decay_rate=np.concatenate([rates[:1], factor * rates[1:]]))
            ),
            mass_ratio=scene.mass_ratio,
        )
        for name, rates in rules.items()
        for factor in grid.factors
    ]


def _loss(scene: Specimen, grid: Grid) -> list[Approach]:
    cells = []
    for restitution in grid.restitutions:
        lines: list[tuple[str, ContactLaw, int]] = [
            ("Hunt-Crossley", scene.lossy(restitution, TIME_TRACE_EXCESS), grid.modes)
        ]
        lines += [
            (f"Newton, {count} modes", NewtonRestitution(local_restitution=restitution), count)
            for count in (grid.modes // 4, grid.modes // 2, grid.modes)
        ]
        cells += [
            Approach(
                curve="loss", series=name, varied="local_restitution", value=restitution,
                oscillator=scene.with_law(law, scene.model.truncated(count)), excess=TIME_TRACE_EXCESS,
                mass_ratio=scene.mass_ratio, local_restitution=restitution,
            )
            for name, law, count in lines
        ]
    return cells
