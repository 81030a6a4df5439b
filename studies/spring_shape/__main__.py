"""What "U shaped" means: four springs of one free period, their twist modes, and the error of strip theory.

Claim (letter 1996, Fig. 1 and text): the spring is U shaped to suppress torsional modes. Of the three U's
that the words allow, legs side by side in the plane of the sheet, a channel, and a strip folded into a U, the
folded strip has its first twist mode highest above the first bending mode: that makes it the default reading.
(A channel gets there only with flanges less than twice as high as its sheet is thick.) A plain strip of the
same width and period has it higher still. In every reading the ball sees a twist mode only as far as it sits
off the plane of symmetry. Against solids, strip theory gives the bending modes of the folded U 1.2 to 1.5 %
too low, those of the plain strip 0.6 to 1.2 %, and their twist modes within 1.5 %.

Centreline r(s), displacements u t + w n + v z, twist phi about t, in plane and out of it, tied to the ball:

    (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')

as stiffness and strain (beam.space); beside them solids of quadratic hexahedra. Each shape is brought to
omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its sheet's thickness, the channel by its flanges. The scene gives length,
width, bend radius, sheet material, ball and period; its tape and its spring.kind play no part. The rotary
inertia of ball and mount counts about every axis; it is 0 in the letter's scene, and "compact mount" is the
least that one body of the sheet's material would have.

Run:     python -m studies.spring_shape [--off-line 0.0005] [--quick]     20 s; --quick 7 s
Writes:  readings.csv, variations.csv (one row a shape), theory_error.csv (one row a mode), shapes.npz;
         figures shapes and theory_error
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np

from beam import ALUMINA, Tip
from beam.space import spatial_modes
from studies.run import Run, study
from studies.scene import Scene, SceneError
from studies.spring_shape.rows import MODES, ErrorRow, ReadingRow, error_rows, reading_row
from studies.spring_shape.shapes import (
    READINGS,
    TITLES,
    Mesh,
    Reading,
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

CHANNEL_SHEET = 0.25
"""Sheet of a channel over that of the plain strip."""

VARIATIONS = ("ball alone", "compact mount", "bend radius doubled", "width by 3/4", "width by 6/5")
SHEETS = {"channel of half the sheet": 0.5, "channel of 3/4 of the sheet": 0.75}
"""Other channels, beside the plain strip's sheet."""

LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


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
    varied: list[ReadingRow] = []
    for name in run.track(VARIATIONS[1:2] if run.quick else (*VARIATIONS, *SHEETS), "variations"):
        try:
            varied += [reading_row(shape, off_line, name) for shape in varied_shapes(scene, name).values()]
        except SceneError as refusal:
            run.failed(name, refusal)
    errors: list[ErrorRow] = []
    for reading in run.track(("channel", "folded", "plain") if run.quick else READINGS, "solids"):
        meshes = COARSE if run.quick or reading not in ("folded", "plain") else FINE
        errors += error_rows(shapes[reading], meshes, COUNTS[reading])
    run.table("readings", list(readings.values()), "Four springs of one free period.", show=(
        "reading", "thickness_m", "flange_m", "first_bending_hz", "first_twist_hz", "ratio_twist", "ratio",
        "tip_value_bending", "tip_value_twist_off_line", "turn_of_twist"))  # fmt: skip
    run.table("variations", varied, "The same, varied.",
              show=("variation", "reading", "thickness_m", "flange_m", "ratio_twist", "ratio"))  # fmt: skip
    run.table("theory_error", errors, "Strip theory against solids.", show=(
        "reading", "family", "number", "kind", "solid_hz", "error", "mesh_change", "error_bend_as_plate"))
    draw(run, shapes, readings, errors)
    ranks = {name: row.ratio_twist for name, row in readings.items() if name != "plain"}
    highest, plain = max(ranks, key=lambda name: ranks[name]), readings["plain"].ratio_twist
    run.verdict("torsion", "in part" if plain > ranks[highest] else "agrees",
                found=f"{ranks[highest]:.1f} times the first bending",
                note=f"Of the shapes that the words allow, \"{TITLES[highest]}\" has its twist highest; "
                f"a plain strip of the same period has it at {plain:.1f} times.")  # fmt: skip
    return {
        "default": highest, "variations_that_agree": agreeing(varied, highest),
        "plain_strip_is_higher": plain > ranks[highest],
    }  # fmt: skip


def shapes_of(scene: Scene, tip: Tip | None = None, sheet: float = CHANNEL_SHEET) -> dict[Reading, Shape]:
    """The readings with the sizes of the scene, or with another tip, at the period of the scene; the sheet of
    the channel is `sheet` times that of the plain strip."""
    omega, fitted = angular_frequency_of(scene), dict[Reading, Shape]()
    for name in ("side_by_side", "folded", "plain"):
        shape = shape_of(scene, name)
        fitted[name] = brought_to(replace(shape, tip=tip or shape.tip), omega)
    plain = fitted["plain"]
    fitted["channel"] = brought_to(
        replace(plain, reading="channel", thickness=sheet * plain.thickness), omega
    )
    return {name: fitted[name] for name in READINGS}


def varied_shapes(scene: Scene, name: str) -> dict[Reading, Shape]:
    """The readings after one of the `VARIATIONS`, or one of the `SHEETS`."""
    if name in SHEETS:
        return {"channel": shapes_of(scene, sheet=SHEETS[name])["channel"]}
    if name == "ball alone":
        volume = 4.0 / 3.0 * math.pi * scene.tip.ball_radius_m**3
        return shapes_of(scene, sphere(ALUMINA.density * volume, ALUMINA.density))
    if name == "compact mount":
        return shapes_of(scene, sphere(scene.tip.mass_kg, scene.spring.density_kg_m3))
    key = "spring.bend_radius_m" if name == "bend radius doubled" else "spring.width_m"
    factor = {"bend radius doubled": 2.0, "width by 3/4": 0.75, "width by 6/5": 1.2}[name]
    return shapes_of(scene.replace({key: factor * scene.number(key)}))


def sphere(mass: float, density: float) -> Tip:
    """A ball [kg, kg/m^3]: of all bodies of one material the one of least rotary inertia."""
    radius = (3.0 * mass / (4.0 * math.pi * density)) ** (1.0 / 3.0)
    return Tip(mass=mass, rotary_inertia=0.4 * mass * radius**2)


def agreeing(rows: Sequence[ReadingRow], chosen: str) -> list[str]:
    """The variations in which the chosen reading has its twist highest of the U shapes."""
    best: dict[str, ReadingRow] = {}
    for row in rows:
        if row.reading != "plain":
            best[row.variation] = max(row, best.get(row.variation, row), key=lambda row: row.ratio_twist)
    return [name for name, row in best.items() if row.reading == chosen]


def draw(
    run: Run,
    shapes: Mapping[Reading, Shape],
    readings: Mapping[Reading, ReadingRow],
    errors: Sequence[ErrorRow],
) -> None:
    """Store the nets of the twist modes and write the figures."""
    from studies.spring_shape.figures import draw_errors, draw_shapes, net_of

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


if __name__ == "__main__":
    raise SystemExit(spring_shape.main())
