"""What "U shaped" means: four springs of one free period, their twist modes, and the error of strip theory.

Claim (letter 1996, Fig. 1 and text): the spring is U shaped to suppress torsional modes. Of the three U's
that the words allow, legs side by side in the plane of the sheet, a channel, and a strip folded into a U, the
folded strip has its first twist mode highest above the first bending mode: that makes it the default reading.
A plain strip of the same width and period has it higher still. In every reading the ball sees a twist mode
only as far as it sits off the plane of symmetry. Against solids, strip theory gives the bending modes of the
folded U 1.2 to 1.5 % too low, those of the plain strip 0.6 to 1.2 %, and their twist modes within 1.5 %.

Centreline r(s), displacements u t + w n + v z, twist phi about t, in plane and out of it, tied to the ball:

    (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')

as stiffness and strain (beam.space); beside them solids of quadratic hexahedra. Each shape is brought to
omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its sheet's thickness, the channel by its flanges. The scene gives length,
width, bend radius, sheet material, ball and period; its tape and its spring.kind play no part, but for one
line about its own folded strip. The rotary inertia of ball and mount counts about every axis; it is 0 in the
letter's scene, and "compact mount" is the least that one body of the sheet's material would have.

Run:     python -m studies.spring_shape [--off-line 0.0005] [--quick]     20 s on two cores, --quick 9 s
Writes:  readings.csv, variations.csv, channels.csv (one row a shape), theory_error.csv (one row a mode),
solids.csv, clamped_widths.csv, shapes.npz, shapes.png, theory_error.png, channels.png
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np

from beam import ALUMINA, Tip
from beam.space import spatial_modes, upright
from studies.run import Run, study
from studies.scene import Scene, SceneError, spring_of
from studies.spring_shape.rows import (
    MODES,
    ErrorRow,
    ReadingRow,
    error_rows,
    nearest_bending,
    plate_excess,
    reading_row,
    width_rows,
)
from studies.spring_shape.shapes import (
    READINGS,
    TITLES,
    Mesh,
    Shape,
    angular_frequency_of,
    brought_to,
    kinds_of,
    shape_of,
)

__all__ = ["spring_shape"]

FINE = (Mesh(legs=60, bend=24, across=2, halvings=4), Mesh(legs=120, bend=48, across=2, halvings=5))
COARSE = (Mesh(legs=20, bend=24, across=1, halvings=3), Mesh(legs=40, bend=32, across=1, halvings=4))
"""From coarse to fine: each pair halves the length of the elements."""

COUNTS = {"folded": (10, 5), "plain": (10, 5), "side_by_side": (2, 3), "channel": (2, 3)}
"""Modes compared with solids in the plane of symmetry and out of it, first bending and twist among them."""

CHANNEL_SHEETS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9)
CHANNEL_SHEET = 0.25
"""Sheet of a channel over that of the plain strip; the latter is the one among the readings."""

VARIATIONS = ("ball alone", "compact mount", "bend radius doubled", "width by 3/4", "width by 6/5")
WIDTHS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Widths of the clamped strip over the scene's."""

LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


@dataclass(frozen=True, kw_only=True)
class SolidRow:
    """First bending and twist of a reading as a solid, and the size that would give it the free period."""

    reading: str
    first_bending_solid_hz: float
    error_bending: float
    first_twist_solid_hz: float
    error_twist: float
    thickness_needed_m: float
    flange_needed_m: float


@study()
def spring_shape(
    scene: Scene,
    run: Run,
    *,
    off_line: Annotated[float, "distance of the ball off the plane of symmetry [m]"] = 0.5e-3,
) -> Mapping[str, object]:
    """Compute, store and draw; by default the ball is as far off as careful gluing leaves it."""
    if off_line <= 0.0:
        raise ValueError(f"--off-line must be a distance in m, greater than 0, not {off_line:g}")
    shapes = shapes_of(scene)
    readings = {name: reading_row(shape, off_line) for name, shape in shapes.items()}
    sheets = CHANNEL_SHEETS[::3] if run.quick else CHANNEL_SHEETS
    channels = [
        reading_row(channel_of(scene, shapes["plain"], sheet), off_line)
        for sheet in run.track(sheets, "channels")
    ]
    varied: list[ReadingRow] = []
    for name in run.track(VARIATIONS[1:2] if run.quick else VARIATIONS, "variations"):
        try:
            varied += [
                reading_row(shape, off_line, name) for shape in shapes_of(*variation_of(scene, name)).values()
            ]
        except SceneError as refusal:
            run.failed(name, refusal)
    checked = ("channel", "folded", "plain") if run.quick else READINGS
    errors: list[ErrorRow] = []
    for name in run.track(checked, "solids"):
        meshes = COARSE if run.quick or name not in ("folded", "plain") else FINE
        errors += error_rows(shapes[name], meshes, COUNTS[name])
    solids = [solid_row(scene, shapes[name], errors) for name in checked]
    widths = width_rows(shapes["plain"], WIDTHS, COARSE[1])
    shown = ("reading", "thickness_m", "flange_m", "first_bending_hz", "first_twist_hz", "ratio_twist",
             "ratio", "tip_value_bending", "tip_value_twist_off_line", "turn_of_twist")  # fmt: skip
    run.table("readings", list(readings.values()), "Four springs of one free period.", show=shown)
    compared = ("variation", "reading", "ratio_twist", "ratio")
    run.table("variations", varied, "The same, varied.", show=compared)
    run.table("channels", channels, "Channels of other sheets.", show=())
    run.table("solids", solids, "As solids; strip theory's errors, and the size that gives the period.")
    told = ("reading", "family", "number", "kind", "solid_hz", "error", "mesh_change", "error_bend_as_plate")
    run.table("theory_error", errors, "Strip theory against solids.", show=told)
    run.table(
        "clamped_widths",
        widths,
        f"Stiffness beyond 3 EI/L^3; a plate has {plate_excess(shapes['plain']):.4f}.",
    )
    draw(run, shapes, readings, errors, channels)
    ranks = {name: readings[name].ratio_twist for name in READINGS if name != "plain"}
    highest = max(ranks, key=lambda name: ranks[name])
    plain = readings["plain"].ratio_twist
    run.verdict("torsion", "in part" if plain > ranks[highest] else "agrees",
                found=f"{ranks[highest]:.1f} times the first bending",
                note=f"Of the shapes that the words allow, \"{TITLES[highest]}\" has its twist highest; "
                f"a plain strip of the same period has it at {plain:.1f} times.")  # fmt: skip
    sheet, flange = crossing(channels, ranks[highest])
    return {
        "default": highest,
        "variations_that_agree": agreeing(varied, highest, "ratio_twist"),
        "variations_that_agree_on_the_lowest": agreeing(varied, highest, "ratio"),
        "plain_strip_is_higher": plain > ranks[highest],
        "channel_is_higher_from_sheet_m": sheet,
        "channel_flange_there_m": flange,
        "twist_to_nearest_bending": readings[highest].first_twist_hz
        / readings[highest].bending_mode_nearest_to_twist_hz
        - 1.0,
        "plate_excess": plate_excess(shapes["plain"]),
        "scene_with_tape": frequencies_with_tape(scene),
    }


def shapes_of(scene: Scene, tip: Tip | None = None) -> dict[str, Shape]:
    """The readings with the sizes of the scene, or with another tip, at the period of the scene."""
    omega = angular_frequency_of(scene)
    found = {name: shape_of(scene, name) for name in READINGS}
    found = {name: replace(shape, tip=tip or shape.tip) for name, shape in found.items()}
    fitted: dict[str, Shape] = {
        name: brought_to(shape, omega) for name, shape in found.items() if name != "channel"
    }
    fitted["channel"] = channel_of(scene, fitted["plain"], CHANNEL_SHEET)
    return {name: fitted[name] for name in READINGS}


def channel_of(scene: Scene, strip: Shape, factor: float) -> Shape:
    """The channel of a sheet thinner than the plain strip's by this factor, at the period of the scene."""
    sheet = replace(strip, reading="channel", thickness=factor * strip.thickness)
    return brought_to(sheet, angular_frequency_of(scene))


def variation_of(scene: Scene, name: str) -> tuple[Scene, Tip | None]:
    """The scene, or its tip, with one of the `VARIATIONS`."""
    if name == "ball alone":
        volume = 4.0 / 3.0 * math.pi * scene.tip.ball_radius_m**3
        return scene, sphere(ALUMINA.density * volume, ALUMINA.density)
    if name == "compact mount":
        return scene, sphere(scene.tip.mass_kg, scene.spring.density_kg_m3)
    key = "spring.bend_radius_m" if name == "bend radius doubled" else "spring.width_m"
    factor = {"bend radius doubled": 2.0, "width by 3/4": 0.75, "width by 6/5": 1.2}[name]
    return scene.replace({key: factor * scene.number(key)}), None


def sphere(mass: float, density: float) -> Tip:
    """A ball [kg, kg/m^3]: of all bodies of one material the one of least rotary inertia."""
    radius = (3.0 * mass / (4.0 * math.pi * density)) ** (1.0 / 3.0)
    return Tip(mass=mass, rotary_inertia=0.4 * mass * radius**2)


def solid_row(scene: Scene, shape: Shape, errors: Iterable[ErrorRow]) -> SolidRow:
    """First bending and first twist from the errors mode by mode."""
    own = sorted((row for row in errors if row.reading == shape.reading), key=lambda row: row.strip_hz)
    bending, twist = (next(row for row in own if row.kind == kind) for kind in ("bending", "twist"))
    needed = brought_to(shape, angular_frequency_of(scene) * (1.0 + bending.error))
    return SolidRow(
        reading=shape.reading,
        first_bending_solid_hz=bending.solid_hz,
        error_bending=bending.error,
        first_twist_solid_hz=twist.solid_hz,
        error_twist=twist.error,
        thickness_needed_m=needed.thickness,
        flange_needed_m=needed.flange,
    )


def agreeing(rows: Sequence[ReadingRow], chosen: str, ratio: str) -> list[str]:
    """The variations in which the chosen reading has this ratio highest of the U shapes."""
    best: dict[str, ReadingRow] = {}
    for row in rows:
        if row.reading != "plain":
            best[row.variation] = max(row, best.get(row.variation, row), key=lambda row: getattr(row, ratio))
    return [name for name, row in best.items() if row.reading == chosen]


def crossing(channels: Iterable[ReadingRow], ratio: float) -> tuple[float, float]:
    """Sheet and flange [m] of the channel whose twist mode reaches this ratio; nan if none does."""
    for thin, thick in pairwise(channels):
        if thin.ratio_twist <= ratio < thick.ratio_twist:
            part = (ratio - thin.ratio_twist) / (thick.ratio_twist - thin.ratio_twist)
            sheet = thin.thickness_m + part * (thick.thickness_m - thin.thickness_m)
            return sheet, thin.flange_m + part * (thick.flange_m - thin.flange_m)
    return math.nan, math.nan


def frequencies_with_tape(scene: Scene) -> Mapping[str, float] | None:
    """Frequencies [Hz] of the folded strip of the scene itself, its tape on; None for other springs."""
    if scene.spring.kind != "folded_u":
        return None
    spring, shape = spring_of(scene), shape_of(scene, "folded")
    sections = tuple(upright(section) for section in spring.sections)
    modes = spatial_modes(replace(shape.spring(), centreline=spring.centreline, sections=sections), MODES)
    kinds, f = kinds_of(shape, modes.displacement, modes.rotation), modes.frequencies_hz
    first = {kind: float(f[kinds.index(kind)]) for kind in ("bending", "twist", "sideways")}
    return {
        **{f"first_{kind}_hz": value for kind, value in first.items()},
        "ratio_twist": first["twist"] / first["bending"],
        "bending_mode_nearest_to_twist_hz": nearest_bending(f, kinds, first["twist"]),
    }


def draw(
    run: Run,
    shapes: Mapping[str, Shape],
    readings: Mapping[str, ReadingRow],
    errors: Sequence[ErrorRow],
    channels: Sequence[ReadingRow],
) -> None:
    """Store the nets of the twist modes and write the figures."""
    from studies.spring_shape.figures import draw_channels, draw_errors, draw_shapes, net_of

    nets: dict[str, np.ndarray] = {}
    for name, shape in shapes.items():
        modes = spatial_modes(shape.spring(), MODES)
        twist = kinds_of(shape, modes.displacement, modes.rotation).index("twist")
        nets[f"{name}_rest"], nets[f"{name}_moved"] = net_of(shape, modes, twist, LARGEST)
        nets[f"{name}_ball"] = shape.centreline.points(np.array(shape.tip_at))
    run.arrays("shapes", **nets)
    run.figure("shapes", draw_shapes(nets, list(readings.values())),
               "First twist mode of four springs of one free period, enlarged; grey, at rest; the left ends "
               "are clamped.")  # fmt: skip
    run.figure(
        "theory_error", draw_errors(errors), "Error of strip theory in the frequencies, against solids."
    )
    others = {name: readings[name].ratio_twist for name in ("folded", "side_by_side", "plain")}
    run.figure("channels", draw_channels(channels, others),
               "Channels of other sheets: flange that the free period needs, and where their lowest modes "
               "out of the plane lie.")  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(spring_shape.main())
