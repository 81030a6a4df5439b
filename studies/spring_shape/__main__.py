"""What "U shaped" means: four springs of one free period, their twist modes, and the error of strip theory.

Claim (letter 1996, Fig. 1 and text): the spring is U shaped to suppress torsional modes. Of the three U's
that the words allow, legs side by side in the plane of the sheet, a channel, and a strip folded into a U, the
folded strip has its first twist mode highest above the first bending mode. (A channel gets there only with
flanges less than twice as high as its sheet is thick, --channel-sheet.) A plain strip of the same width and
period has it higher still. With legs side by side it is low, but the ball turns least in it, a tenth of what
it does on a plain strip. In every reading the ball sees a twist mode only as far as it sits off the plane of
symmetry. So torsion leaves the reading open. What decides is how far each spring, calibrated, is from linear
at its gap against what the bands of the p_m allow: legs side by side a fifth of it, a folded strip with a
bend of 40 mm nine tenths, tighter ones more than it. Against solids, strip theory gives the bending modes of
the folded U 1.2 to 1.5 % too low, those of the plain strip 0.6 to 1.2 %, and their twist modes within 1.5 %.

Centreline r(s), displacements u t + w n + v z, twist phi about t, in plane and out of it, tied to the ball:

    (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')

as stiffness and strain (beam.space); beside the two strips solids of quadratic hexahedra. Each shape is
brought to omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its sheet's thickness, the channel by its flanges. The scene
gives length, width, bend radius, sheet material, ball and period; its tape and its spring.kind play no part.
The rotary inertia of ball and mount counts about every axis; it is 0 in the letter's scene.

Run:     python -m studies.spring_shape [--off-line 0.0005] [--channel-sheet 0.25] [--quick]
Writes:  readings.csv (one row a shape), theory_error.csv (one row a mode), candidates.csv (one row a spring,
         calibrated), shapes.npz; figures shapes and theory_error
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated

import numpy as np

from beam import InvalidValue
from beam.space import spatial_modes
from studies.run import Run, study
from studies.scene import Scene, single_mode_of
from studies.spring_shape.candidates import Drawn, drawn_springs
from studies.spring_shape.rows import MODES, ErrorRow, ReadingRow, error_rows, reading_row
from studies.spring_shape.shapes import (
    READINGS,
    TITLES,
    Mesh,
    Reading,
    Shape,
    brought_to,
    kinds_of,
    shape_of,
)

FINE = (Mesh(legs=60, bend=24, across=2, halvings=4), Mesh(legs=120, bend=48, across=2, halvings=5))
COARSE = (Mesh(legs=20, bend=24, across=1, halvings=3), Mesh(legs=40, bend=32, across=1, halvings=4))
"""From coarse to fine: each pair halves the length of the elements."""

COUNTS = (10, 5)
"""Modes compared with solids in the plane of symmetry and out of it, first bending and twist among them."""

SOLIDS: tuple[Reading, ...] = ("folded", "plain")
LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


@study()
def spring_shape(
    scene: Scene,
    run: Run,
    *,
    off_line: Annotated[float, "distance of the ball off the plane of symmetry [m]"] = 0.5e-3,
    channel_sheet: Annotated[float, "sheet of the channel over that of the plain strip"] = 0.25,
) -> Mapping[str, object]:
    """Compute, store and draw; by default the ball is as far off as careful gluing leaves it."""
    if off_line <= 0.0:
        raise InvalidValue(f"--off-line must be a distance in m, greater than 0, not {off_line:g}")
    if channel_sheet <= 0.0:
        raise InvalidValue(f"--channel-sheet must be greater than 0, not {channel_sheet:g}")
    shapes = shapes_of(scene, channel_sheet)
    readings = {name: reading_row(shape, off_line) for name, shape in shapes.items()}
    errors: list[ErrorRow] = []
    for reading in run.track(SOLIDS, "solids"):
        errors += error_rows(shapes[reading], COARSE if run.quick else FINE, COUNTS)
    run.table("readings", list(readings.values()), "Four springs of one free period.", show=(
        "reading", "thickness_m", "flange_m", "first_bending_hz", "first_twist_hz", "ratio_twist", "ratio",
        "tip_value_bending", "tip_value_twist_off_line", "turn_of_twist"))  # fmt: skip
    run.table("theory_error", errors, "Strip theory against solids.", show=(
        "reading", "family", "number", "kind", "solid_hz", "error", "mesh_change"))  # fmt: skip
    draw(run, shapes, readings, errors)
    springs = drawn_springs(scene, off_line, run.quick)
    found = run.attempt(partial(Drawn.calibrated, scene=scene), springs, "candidates")
    run.table("candidates", [row for row in found if row],
              "Springs calibrated alike, and how far each is from linear at its gap.")  # fmt: skip
    ranks = {name: row.ratio_twist for name, row in readings.items() if name != "plain"}
    highest, plain = max(ranks, key=lambda name: ranks[name]), readings["plain"].ratio_twist
    turns = {name: row.turn_of_twist / readings["plain"].turn_of_twist for name, row in readings.items()}
    least = min(turns, key=lambda name: turns[name])
    run.verdict("torsion", "in part" if plain > ranks[highest] else "agrees",
                found=f"{ranks[highest]:.1f} times the first bending",
                note=f"Of the shapes that the words allow, \"{TITLES[highest]}\" has its twist highest; "
                f"a plain strip of the same period has it at {plain:.1f} times; in that of "
                f"\"{TITLES[least]}\" the ball turns least, {turns[least]:.2f} of this.")  # fmt: skip
    return {"highest_twist": highest, "least_turn": least, "plain_strip_is_higher": plain > ranks[highest]}


def shapes_of(scene: Scene, sheet: float = 0.25) -> dict[Reading, Shape]:
    """The readings with the sizes of the scene, at its period; the sheet of the channel is `sheet` times that
    of the plain strip."""
    omega, fitted = float(single_mode_of(scene).omega[0]), dict[Reading, Shape]()
    for name in ("side_by_side", "folded", "plain"):
        fitted[name] = brought_to(shape_of(scene, name), omega)
    plain = fitted["plain"]
    fitted["channel"] = brought_to(
        replace(plain, reading="channel", thickness=sheet * plain.thickness), omega
    )
    return {name: fitted[name] for name in READINGS}


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
        twist = kinds_of(shape, modes).index("twist")
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
