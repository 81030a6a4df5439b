"""What "U shaped" means: springs of one free period and their twist modes; the flat U as a plate.

Claim (letter 1996, Fig. 1 and text): the spring is U shaped to suppress torsional modes. The words allow
three shapes: legs side by side in the plane of the sheet, a channel, and a strip folded into a U. A plain
strip of the same width and period is their measure. In every shape the ball moves in a twist mode only as far
as it sits off the plane of symmetry. Torsion leaves the reading open. What decides is how far each spring is
from linear at its gap (`finite_amplitude`): a folded U with a tight bend softens so much that it loses the
letter's periods; a single leaf, legs side by side or a wide bend keep them.

Strip theory, of centreline r(s), displacements u t + w n + v z and twist phi about t, tied to the ball, has

    (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')

as stiffness and strain (beam.space). Each shape is brought to omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its sheet's
thickness, the channel by its flanges. The scene gives length, width, bend radius, sheet material, ball and
period; its tape plays no part. The rotary inertia of ball and mount counts about every axis.

The beam of the scene simplifies the flat U, which is a sheet. As a Kirchhoff plate its deflection w obeys

    int D ((1 - nu) w_ij v_ij + nu lap w lap v) + m (w.. + y..) v dA + M (w.. + y..) v (tip) = F v (tip)

(symbols in `plate`), and in some of its modes the legs twist. Question: does the plate change the born
periods and the ends of the orbits? This part needs spring.kind = "flat_u" and a harmonic drive.

Run:     python -m studies shape [--off-line 0.0005] [--channel-sheet 0.25] [--quick]
Writes:  readings.csv (a row a shape), shapes.npz; of a flat U plate_modes.csv, plate_collisions.csv (a row a
         spring), plate_ends.csv (a row a frequency); springs.csv (a row a reading, bend radius, gap and
         ball), frame.csv (effective periods); figures shapes, plate and finite_amplitude
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated

import numpy as np

from beam import InvalidValue
from beam.space import spatial_modes
from studies.shell.scene import Scene, model_of, single_mode_of
from studies.shell.study import Run, study
from studies.spring.shape.finite_amplitude import finite_amplitude
from studies.spring.shape.model_error import (
    OrbitEnds,
    collision_row,
    mode_rows,
    orbit_rows,
    plates_of,
    springs_of,
)
from studies.spring.shape.rows import MODES, ReadingRow, reading_row
from studies.spring.shape.shapes import READINGS, TITLES, Reading, Shape, brought_to, kinds_of, shape_of

FINE, COARSE = (2, 3), (1, 2)
"""Cells over the radius of the seat and over the rim beside it, in the coarsest of three meshes."""

LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


@study()
def shape(
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
    run.table(
        "readings",
        list(readings.values()),
        "Four springs of one free period.",
        show=(
            "reading",
            "thickness_m",
            "flange_m",
            "first_bending_hz",
            "first_twist_hz",
            "ratio_twist",
            "ratio",
            "tip_value_bending",
            "tip_value_twist_off_line",
            "turn_of_twist",
        ),
    )
    draw(run, shapes, readings)
    orbits, survivals = compare_plate(scene, run), finite_amplitude(scene, run)
    ranks = {name: row.ratio_twist for name, row in readings.items() if name != "plain"}
    highest, plain = max(ranks, key=lambda name: ranks[name]), readings["plain"].ratio_twist
    turns = {name: row.turn_of_twist / readings["plain"].turn_of_twist for name, row in readings.items()}
    least = min(turns, key=lambda name: turns[name])
    run.verdict(
        "torsion",
        "in part" if plain > ranks[highest] else "agrees",
        found=f"{ranks[highest]:.1f} times the first bending",
        note=f'Of the shapes that the words allow, "{TITLES[highest]}" has its twist highest; '
        f"a plain strip of the same period has it at {plain:.1f} times; in that of "
        f'"{TITLES[least]}" the ball turns least, {turns[least]:.2f} of this.',
    )
    return {
        "highest_twist": highest,
        "least_turn": least,
        "plain_strip_is_higher": plain > ranks[highest],
        "rows": list(readings.values()),
        "plate_ends": orbits,
        "springs": survivals,
    }


def compare_plate(scene: Scene, run: Run) -> list[OrbitEnds]:
    """Tables and figure of the flat U as a plate; none for another spring or drive."""
    from studies.spring.shape.figures import draw_plate

    if (scene.spring.kind, scene.drive.kind) != ("flat_u", "harmonic"):
        run.say("The part on the plate is left out: it needs a flat U with a harmonic drive.")
        return []
    beam, plates = model_of(scene), plates_of(scene, COARSE if run.quick else FINE)
    modes, springs = mode_rows(plates, beam), springs_of(scene, run, plates, beam)
    run.table("plate_modes", modes, "Symmetric modes of the flat U as a plate, and of its beam.")
    collisions = [collision_row(scene, spring) for spring in springs]
    run.table("plate_collisions", collisions, "First collision of beam and plates.")
    orbits = orbit_rows(scene, run, springs, scene.drive.frequencies_hz[:: 2 if run.quick else 1])
    run.table("plate_ends", orbits, "Ends of the orbits on the way down, by beam and plates.")
    run.figure(
        "plate",
        draw_plate(modes, orbits),
        "The flat U as a plate and as a beam: tip values of the symmetric modes, and the ends of the orbits.",
    )
    same = all(row.same_period for row in orbits)
    words = [f"As a plate the spring {'keeps every' if same else 'changes a'} period that is born."]
    if factors := [max(row.most, 1.0 / row.least) for row in orbits if row.most and row.least]:
        words.append(f"Beam theory moves the ends of the orbits by a factor of up to {max(factors):.1f}.")
    if doubtful := [row for row in orbits if row.beam and row.point and row.least is None]:
        words.append(f"At {doubtful[0].frequency_hz:.2f} Hz plates and beam differ in the sign of the end.")
    run.answer("hysteresis", " ".join(words))
    return orbits


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


def draw(run: Run, shapes: Mapping[Reading, Shape], readings: Mapping[Reading, ReadingRow]) -> None:
    """Store the nets of the twist modes and draw them."""
    from studies.spring.shape.figures import draw_shapes, net_of

    nets: dict[str, np.ndarray] = {}
    for name, shape in shapes.items():
        modes = spatial_modes(shape.spring(), MODES)
        twist = kinds_of(shape, modes).index("twist")
        nets[f"{name}_rest"], nets[f"{name}_moved"] = net_of(shape, modes, twist, LARGEST)
        nets[f"{name}_ball"] = shape.centreline.points(np.array(shape.tip_at))
    run.arrays("shapes", **nets)
    run.figure(
        "shapes",
        draw_shapes(nets, list(readings.values())),
        "First twist mode of four springs of one free period, enlarged; grey, at rest; the left ends "
        "are clamped.",
    )
