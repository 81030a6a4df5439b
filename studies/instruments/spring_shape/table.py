"""What each reading of "U shaped" does, from its modes with the ball on.

Of the first bending mode (number 1), the first twist mode and the first sideways mode: frequencies [Hz],
values phi at the ball along the stop [kg^(-1/2)] and the turn theta of the section there about x
[kg^(-1/2) m^(-1)]. On the plane of symmetry phi = 0 in twist. With ball and contact off it by d [m],

    phi = d theta + what a bending mode close by in frequency lends,

computed with the ball where it is, not to first order. What a slow force at the contact sees of a mode is its
compliance phi^2/omega^2 [m/N]; its share is that of the twist mode over that of the first bending mode.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from beam import ALUMINA, Tip
from beam.space import SpatialModes, spatial_modes, upright
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import spring_of
from studies.instruments.spring_shape.readings import (
    Reading,
    Shape,
    angular_frequency_of,
    brought_to,
    first_bending,
    kinds_of,
    shape_of,
)

MODES = 14
"""Modes looked through for the first of each kind."""

CHANNEL_SHEETS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9)
CHANNEL_SHEET = 0.25
"""Thickness of the sheet of a channel over that of the plain strip; the latter is the one in the table."""


def row_of(shape: Shape, off_line: float) -> dict[str, Any]:
    """One row of the table for a shape that has been brought to its period."""
    modes = spatial_modes(shape.spring(), MODES)
    kinds = kinds_of(shape, modes.displacement, modes.rotation)
    bending, twist, frequencies = first_bending(modes), kinds.index("twist"), modes.frequencies_hz
    sideways = frequencies[kinds.index("sideways")] if "sideways" in kinds else math.nan
    with_ball = frequencies[[kind == "bending" for kind in kinds]]
    nearest = with_ball[np.argmin(np.abs(with_ball / frequencies[twist] - 1.0))]
    off = spatial_modes(shape.spring(off_line), MODES)
    moved = _turning_near(off, float(frequencies[twist]))
    first = first_bending(off)
    share = (off.phi[moved] / off.omega[moved]) ** 2 / (off.phi[first] / off.omega[first]) ** 2
    return {
        "reading": shape.reading,
        "thickness_m": shape.thickness,
        "flange_m": shape.flange,
        "first_bending_hz": frequencies[bending],
        "first_twist_hz": frequencies[twist],
        "first_sideways_hz": sideways,
        "first_twist_or_sideways_hz": float(np.fmin(frequencies[twist], sideways)),
        "ratio_twist": frequencies[twist] / frequencies[bending],
        "ratio_sideways": sideways / frequencies[bending],
        "ratio": float(np.fmin(frequencies[twist], sideways)) / frequencies[bending],
        "tip_value_bending": abs(modes.phi[bending]),
        "tip_value_twist": abs(modes.phi[twist]),
        "off_line_m": off_line,
        "tip_value_twist_off_line": abs(off.phi[moved]),
        "compliance_share_off_line": share,
        "turn_of_twist": abs(modes.rotation[twist, 0]),
        "bending_mode_nearest_to_twist_hz": nearest,
    }


def shapes_of(scene: Scene, readings: Iterable[Reading], tip: Tip | None = None) -> dict[str, Shape]:
    """The readings with the sizes of the scene, or with another tip, at the period of the scene."""
    omega = angular_frequency_of(scene)
    found: dict[str, Shape] = {}
    for reading in readings:
        shape = shape_of(scene, reading)
        shape = shape if tip is None else dataclasses.replace(shape, tip=tip)
        if reading == "channel":
            strip = found.get("plain") or brought_to(dataclasses.replace(shape, reading="plain"), omega)
            shape = dataclasses.replace(shape, thickness=CHANNEL_SHEET * strip.thickness)
        found[reading] = brought_to(shape, omega)
    return found


VARIATIONS = ("ball alone", "compact mount", "bend radius doubled", "width by 3/4", "width by 6/5")


def varied(scene: Scene, name: str) -> tuple[Scene, Tip | None]:
    """The scene, or its tip, with one of the `VARIATIONS`."""
    if name in ("ball alone", "compact mount"):
        return scene, (ball_alone if name == "ball alone" else compact_mount)(scene)
    key, factor = {
        "bend radius doubled": ("spring.bend_radius_m", 2.0),
        "width by 3/4": ("spring.width_m", 0.75),
        "width by 6/5": ("spring.width_m", 1.2),
    }[name]
    return scene.replace({key: factor * scene[key]}), None


def channels_of(scene: Scene, strip: Shape, sheets: Iterable[float]) -> list[Shape]:
    """Channels of sheets thinner than the plain strip's, by these factors, at the period of the scene."""
    omega, shape = angular_frequency_of(scene), dataclasses.replace(strip, reading="channel")
    return [
        brought_to(dataclasses.replace(shape, thickness=factor * strip.thickness), omega) for factor in sheets
    ]


def row_of_the_scene(scene: Scene) -> dict[str, Any] | None:
    """Frequencies [Hz] of the folded strip of the scene itself, its tape on; None for other springs."""
    if scene.spring.kind != "folded_u":
        return None
    spring, shape = spring_of(scene), shape_of(scene, "folded")
    taped = dataclasses.replace(
        shape.spring(),
        centreline=spring.centreline,
        sections=tuple(upright(section) for section in spring.sections),
    )
    modes = spatial_modes(taped, MODES)
    kinds, frequencies = kinds_of(shape, modes.displacement, modes.rotation), modes.frequencies_hz
    with_ball = frequencies[[kind == "bending" for kind in kinds]]
    twist = frequencies[kinds.index("twist")]
    return {
        "thickness_m": shape.thickness,
        "tape_thickness_m": scene.spring.tape_thickness_m,
        "first_bending_hz": with_ball[0],
        "first_twist_hz": twist,
        "first_sideways_hz": frequencies[kinds.index("sideways")],
        "ratio_twist": twist / with_ball[0],
        "bending_mode_nearest_to_twist_hz": with_ball[np.argmin(np.abs(with_ball / twist - 1.0))],
    }


def ball_alone(scene: Scene) -> Tip:
    """The ball without a mount, of alumina."""
    radius = scene.tip.ball_radius_m
    mass = ALUMINA.density * 4.0 / 3.0 * math.pi * radius**3
    return Tip(mass=mass, rotary_inertia=0.4 * mass * radius**2)


def compact_mount(scene: Scene) -> Tip:
    """The scene's tip as one sphere of the sheet's material: the least rotary inertia of such a body."""
    mass = scene.tip.mass_kg
    radius = (3.0 * mass / (4.0 * math.pi * scene.spring.density_kg_m3)) ** (1.0 / 3.0)
    return Tip(mass=mass, rotary_inertia=0.4 * mass * radius**2)


def _turning_near(modes: SpatialModes, frequency: float) -> int:
    """Number of the mode within a tenth of this frequency [Hz] that turns the ball most."""
    near = np.abs(modes.frequencies_hz / frequency - 1.0) < 0.1
    return int(np.argmax(np.abs(modes.rotation[:, 0]) * near))
