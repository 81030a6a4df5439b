"""The readings of "U shaped", each as a strip in space, brought to one period.

    side_by_side   a U cut out of the sheet: the legs lie side by side in its plane, the ball sits at the bend
                   and moves across the sheet
    channel        a straight strip with two flanges, the ball at its free end moves across the web
    folded         a strip folded into a U, both ends clamped, the ball at the bend moves across the legs
    plain          a straight strip, not U shaped at all: what the others are measured by

All have the length, width, sheet and ball of the scene, without its tape. What is left free, the thickness of
the sheet (of the channel: how far the flanges stand out, for a given sheet), is fitted to the damped period
T [s] with the decay rate c [1/s],

    omega_1^2 = (2 pi/T)^2 + (c/2)^2,        omega_1 of the first mode that moves the ball along the stop.

Vectors: x along the legs, from the clamp to the ball; e the direction of the stop; f across both, sideways.
A mode is named by what the section at the ball does most: it moves along e (bending), along f (sideways),
along x (breathing of two legs, else lengthwise), or it turns about x so that the edges, b/2 off, move most
(twist).

With ball and contact off the plane of symmetry by d [m], a twist mode that turns the ball by theta has

    phi = d theta + what a bending mode close by in frequency lends,

computed with the ball where it is, not to first order.
"""

import math
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from scipy.optimize import brentq

from beam import Arc, Centreline, Material, Straight, StripSection, Support, Tip
from beam.space import (
    SpatialModes,
    SpatialSection,
    SpatialSpring,
    Vector,
    channel,
    flat,
    spatial_modes,
    upright,
)
from studies.shell.scene import Scene, SceneError, sections_of, single_mode_of

Reading = Literal["side_by_side", "channel", "folded", "plain"]
TITLES: dict[Reading, str] = {
    "side_by_side": "legs side by side",
    "channel": "channel",
    "folded": "folded",
    "plain": "plain strip",
}

THINNEST, THICKEST = 5e-4, 0.05  # the sheet is looked for between these parts of the length

FLANGE_REACH = 1.0  # flanges are looked for up to this part of the width

ACCURACY = 1e-12  # of the fitted size [m]

CHANNEL_SHEET = 0.25  # sheet of the channel over that of the plain strip

OFF_LINE = 0.5e-3  # distance of the ball off the plane of symmetry, as careful gluing leaves it [m]

MODES = 14  # modes looked through for the first of each kind


@dataclass(frozen=True, kw_only=True)
class Shape:
    """One reading with its sizes [m]; `flange`: how far flanges stand out of the web of a channel, else 0."""

    reading: Reading
    material: Material
    length: float
    width: float
    bend_radius: float
    thickness: float
    flange: float = 0.0
    tip: Tip

    @property
    def bent(self) -> bool:
        """Whether the centreline is a U."""
        return self.reading in ("side_by_side", "folded")

    @property
    def stop(self) -> Vector:
        """e, the direction in which the ball meets the stop."""
        return (0.0, 0.0, 1.0) if self.reading == "side_by_side" else (0.0, 1.0, 0.0)

    @property
    def sideways(self) -> Vector:
        """f, across the plane of symmetry."""
        return (0.0, 1.0, 0.0) if self.reading == "side_by_side" else (0.0, 0.0, 1.0)

    @property
    def centreline(self) -> Centreline:
        """From clamp to clamp, or from the clamp to the free end."""
        leg = Straight(length=self.length)
        if not self.bent:
            return Centreline(pieces=(leg,))
        bend = Arc(radius=self.bend_radius, angle=math.pi)
        return Centreline(pieces=(leg, bend, leg), start=(0.0, -self.bend_radius))

    @property
    def tip_at(self) -> float:
        """Arc length of the ball [m]."""
        return self.length + (0.5 * math.pi * self.bend_radius if self.bent else 0.0)

    @property
    def section(self) -> SpatialSection:
        """Of the strip or channel."""
        if self.reading == "channel":
            return channel(
                material=self.material, width=self.width, flange=self.flange, thickness=self.thickness
            )
        strip = StripSection(material=self.material, width=self.width, thickness=self.thickness)
        return flat(strip) if self.reading == "side_by_side" else upright(strip)

    def spring(self, off_line: float = 0.0) -> SpatialSpring:
        """The strip in space, the ball off the plane of symmetry by `off_line` [m]."""
        line = self.centreline
        supports: tuple[Support, Support] = ("clamped", "clamped" if self.bent else "free")
        x, y, z = (off_line * part for part in self.sideways)
        return SpatialSpring(
            centreline=line,
            sections=(self.section,) * len(line.pieces),
            supports=supports,
            tip=self.tip,
            tip_at=self.tip_at,
            tip_offset=(x, y, z),
            drive=self.stop,
        )


def shape_of(scene: Scene, reading: Reading) -> Shape:
    """The reading with the sizes of the scene, its sheet still as thick as the scene's."""
    keys = scene.spring
    if reading == "side_by_side" and 2.0 * keys.bend_radius_m <= keys.width_m:
        raise SceneError(
            "spring.bend_radius_m must be greater than half of spring.width_m, "
            f"{keys.width_m / 2:g} (unit m), for legs side by side, not {keys.bend_radius_m}"
        )
    bare, _ = sections_of(scene)
    return Shape(
        reading=reading,
        material=bare.material,
        length=keys.leg_length_m,
        width=bare.width,
        bend_radius=keys.bend_radius_m,
        thickness=bare.thickness,
        tip=Tip(mass=scene.tip.mass_kg, rotary_inertia=scene.tip.rotary_inertia_kg_m2),
    )


def brought_to(shape: Shape, omega: float) -> Shape:
    """The shape whose first bending mode has the angular frequency `omega` [rad/s].

    The flanges of a channel are fitted, the sheet of the others.

    Raises
    ------
    SceneError
        If no size within reach does it.
    """
    if shape.reading == "channel":
        fitted, low, high = "flange", 0.0, FLANGE_REACH * shape.width
    else:
        fitted, low, high = "thickness", THINNEST * shape.length, min(THICKEST * shape.length, shape.width)

    def with_size(size: float) -> Shape:
        return replace(shape, flange=size) if fitted == "flange" else replace(shape, thickness=size)

    def excess(size: float) -> float:
        modes = spatial_modes(with_size(size).spring(), 6)
        return float(modes.omega[kinds_of(shape, modes).index("bending")]) - omega

    if not excess(low) < 0.0 < excess(high):
        raise SceneError(
            f"no {fitted} between {low:.4g} and {high:.4g} (unit m) brings the reading {shape.reading} to "
            f"{omega / (2.0 * math.pi):.4g} Hz: its other sizes must change"
        )
    return with_size(float(brentq(excess, low, high, xtol=ACCURACY)))


def kinds_of(shape: Shape, modes: SpatialModes) -> list[str]:
    """The name of each mode, from the motion of the section at the ball."""
    names = ("bending", "sideways", "twist", "breathing" if shape.bent else "lengthwise")
    moved, turned = modes.displacement, 0.5 * shape.width * modes.rotation[:, 0]
    moves = (moved @ np.array(shape.stop), moved @ np.array(shape.sideways), turned, moved[:, 0])
    return [names[place] for place in np.argmax(np.abs(moves), axis=0)]


def shapes_of(scene: Scene) -> dict[Reading, Shape]:
    """The readings with the sizes of the scene, at its period."""
    omega, fitted = float(single_mode_of(scene).omega[0]), dict[Reading, Shape]()
    for name in ("side_by_side", "folded", "plain"):
        fitted[name] = brought_to(shape_of(scene, name), omega)
    plain = fitted["plain"]
    channel = replace(plain, reading="channel", thickness=CHANNEL_SHEET * plain.thickness)
    fitted["channel"] = brought_to(channel, omega)
    return {name: fitted[name] for name in TITLES}


@dataclass(frozen=True, kw_only=True)
class ReadingRow:
    """A reading of "U shaped", brought to the free period of the scene."""

    reading: Annotated[str, "shape"]
    thickness_m: Annotated[float, "thickness of the sheet [m]"]
    flange_m: Annotated[float, "width of the flanges [m]; 0 without flanges"]
    first_bending_hz: Annotated[float, "first bending mode [Hz]"]
    first_twist_hz: Annotated[float, "first twist mode [Hz]"]
    ratio_twist: Annotated[float, "first twist over first bending frequency"]
    tip_value_bending: Annotated[float, "tip value of the bending mode [kg^(-1/2)]"]
    tip_value_twist_off_line: Annotated[
        float, "tip value of the twist mode [kg^(-1/2)]; with the ball 0.5 mm off the plane of symmetry"
    ]
    turn_of_twist: Annotated[float, "turn of the ball in the twist mode [kg^(-1/2) m^(-1)]"]


def reading_row(shape: Shape) -> ReadingRow:
    """The row of a shape that has been brought to its period."""
    modes = spatial_modes(shape.spring(), MODES)
    kinds, f = kinds_of(shape, modes), modes.frequencies_hz
    bending, twist = kinds.index("bending"), kinds.index("twist")
    off = spatial_modes(shape.spring(OFF_LINE), MODES)
    near = np.abs(off.frequencies_hz / f[twist] - 1.0) < 0.1  # mixed, it may be named bending
    return ReadingRow(
        reading=TITLES[shape.reading],
        thickness_m=shape.thickness,
        flange_m=shape.flange,
        first_bending_hz=float(f[bending]),
        first_twist_hz=float(f[twist]),
        ratio_twist=float(f[twist] / f[bending]),
        tip_value_bending=abs(float(modes.phi[bending])),
        tip_value_twist_off_line=abs(float(off.phi[np.argmax(np.abs(off.rotation[:, 0]) * near)])),
        turn_of_twist=abs(float(modes.rotation[twist, 0])),
    )
