"""What "U shaped" means: four springs of one free period, their twist modes, and the error of strip theory.

Claim
    The letter's spring is "U shaped to suppress torsional modes". Of the three U's that the words allow, legs
    side by side in the plane of the sheet, a channel, and a strip folded into a U, the folded strip has its
    first twist mode highest above the first bending mode: that makes it the default reading. A plain strip of
    the same width and period has it higher still. In every reading the ball sees a twist mode only as far as
    it sits off the plane of symmetry. Against solids, strip theory gives the bending modes of the folded U
    1.2 to 1.5 % too low, those of the plain strip 0.6 to 1.2 %, and their twist modes within 1.5 %.

Equations
    Centreline r(s), displacements u t + w n + v z, twist phi about t, in plane and out of it:
        (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')
    as stiffness and strain (`beam.space.element`), tied to the ball; solids of quadratic hexahedra beside
    them (`studies.spring_shape_solids`). Each shape is brought to omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its
    sheet's thickness, the channel by its flanges (`studies.instruments.spring_shape.readings`).
    Printed: first bending, twist and sideways frequencies [Hz]; phi at the ball along the stop [kg^(-1/2)],
    also with ball and contact off the plane of symmetry; the turn of the ball in the twist mode
    [kg^(-1/2) m^(-1)]; f_strip/f_solid - 1 mode by mode.

Run time
    About 20 s on two cores, --quick 9 s.

Command
    python -m studies.spring_shape [--off-line 0.0005]

Outputs (results/spring_shape)
    readings.csv, variations.csv, channels.csv      the tables; variations of ball, mount, bend and width
    theory_error.csv, clamped_widths.csv            strip theory against solids, mode by mode and by width
    shapes.npz and shapes.png, .pdf                 the readings in their twist modes
    theory_error, channels, clamped_widths          .png, .pdf

The scene gives length, width, bend radius, sheet material, ball and period; its tape and its spring.kind play
no part, but for one line about the scene's own folded strip. The rotary inertia of ball and mount counts
about every axis; it is 0 in the letter's scene, and "compact mount" is the least that one body of the sheet's
material would have.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import Any

from beam.space import spatial_modes
from studies.instruments.command_line import Request, run_study
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene
from studies.instruments.spring_shape.checks import (
    COARSE,
    FINE,
    PLANE_MODES,
    WIDTHS,
    error_rows,
    plate_excess,
    solid_row,
    width_rows,
)
from studies.instruments.spring_shape.readings import (
    READINGS,
    Shape,
    angular_frequency_of,
    brought_to,
    kinds_of,
)
from studies.instruments.spring_shape.surfaces import net_of
from studies.instruments.spring_shape.table import (
    CHANNEL_SHEETS,
    VARIATIONS,
    channels_of,
    row_of,
    row_of_the_scene,
    shapes_of,
    varied,
)
from studies.instruments.spring_shape.words import (
    printed_errors,
    printed_readings,
    printed_solids,
    printed_variations,
    verdict_of,
    verdict_words,
)

OFF_LINE = 0.5e-3
"""How far the ball may sit off the plane of symmetry [m]: what careful gluing leaves."""

LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


def run(scene: Scene, request: Request) -> Mapping[str, Any]:
    record, off_line, quick = request.record, request.options.off_line, request.quick
    variations = VARIATIONS[1:2] if quick else VARIATIONS
    sheets = CHANNEL_SHEETS[::3] if quick else CHANNEL_SHEETS
    meshes = COARSE if quick else FINE
    checked = ("channel",) if quick else ("side_by_side", "channel")
    with request.progress("shapes", total=3 + len(variations) + len(sheets) + len(checked)) as progress:
        shapes = shapes_of(scene, READINGS)
        rows = {name: row_of(shape, off_line) for name, shape in shapes.items()}
        progress.advance()
        channels = []
        for sheet in sheets:
            (shape,) = channels_of(scene, shapes["plain"], (sheet,))
            channels.append(row_of(shape, off_line))
            progress.advance()
        tried, failed = [], []
        for name in variations:
            try:
                others = shapes_of(*_split(varied(scene, name)))
                tried += [{"variation": name, **row_of(shape, off_line)} for shape in others.values()]
            except SceneError as refusal:
                failed.append({"variation": name, "failure": str(refusal)})
            progress.advance()
        solids = {}
        for name in checked:
            solids[name] = solid_row(shapes[name], COARSE)
            progress.advance()
        errors = []
        for name in ("folded", "plain"):
            errors += error_rows(shapes[name], meshes)
            progress.advance()
    widths = width_rows(shapes["plain"], WIDTHS, COARSE[1])
    for name in ("folded", "plain"):
        solids[name] = _firsts(name, errors)
    for name, solid in solids.items():
        needed = brought_to(shapes[name], angular_frequency_of(scene) * (1.0 + solid["error_bending"]))
        solid |= {"thickness_needed_m": needed.thickness, "flange_needed_m": needed.flange}
    verdict = verdict_of(rows, tried, channels)
    scenes_own = row_of_the_scene(scene)
    tables = {"readings": list(rows.values()), "variations": tried, "channels": channels,
              "theory_error": errors, "clamped_widths": widths}
    for name, table in tables.items():
        record.write_table(name, _columns(table))
    _draw(request, shapes, tables)
    print(printed_readings(tables["readings"]))
    print(printed_solids(list(solids.values())))
    print(printed_variations(tried))
    print(printed_errors(errors))
    print(_widths_in_words(widths, plate_excess(shapes["plain"])))
    print(verdict_words(rows, verdict))
    if scenes_own is not None:
        print(
            f"The scene's own folded strip, {1e3 * scenes_own['thickness_m']:.3f} mm with its tape: bending "
            f"{scenes_own['first_bending_hz']:.2f} Hz, twist {scenes_own['first_twist_hz']:.1f} Hz, next to "
            f"a bending mode at {scenes_own['bending_mode_nearest_to_twist_hz']:.1f} Hz."
        )
    return {
        **tables,
        "solids": list(solids.values()),
        "verdict": verdict,
        "scene_with_tape": scenes_own,
        "plate_excess": plate_excess(shapes["plain"]),
        "failures": failed,
        "failed_cells": len(failed),
        "files": sorted(record.files),
    }


def _split(changed: tuple[Scene, Any]) -> tuple[Scene, tuple[Any, ...], Any]:
    scene, tip = changed
    return scene, READINGS, tip


def _firsts(name: str, errors: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """First bending and first twist as a solid, from the rows of errors."""
    found: dict[str, Any] = {"reading": name}
    for kind in ("bending", "twist"):
        row = next(row for row in errors if row["reading"] == name and row["kind"] == kind)
        found |= {f"first_{kind}_solid_hz": row["solid_hz"], f"error_{kind}": row["error"],
                  f"mesh_change_{kind}": row["mesh_change"]}
    return found


def _columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    return {key: [row[key] for row in rows] for key in rows[0]} if rows else {}


def _widths_in_words(rows: Sequence[Mapping[str, float]], limit: float) -> str:
    values = ", ".join(
        f"{100.0 * row['stiffness_excess']:.2f} % at {1e3 * row['width_m']:.3g} mm" for row in rows
    )
    return (
        f"A clamped strip is stiffer than 3 EI/L^3 because it cannot curl at the clamp: by {values}; a plate "
        f"by {100.0 * limit:.2f} %."
    )


def _draw(
    request: Request, shapes: Mapping[str, Shape], tables: Mapping[str, Sequence[Mapping[str, Any]]]
) -> None:
    """Arrays and figures."""
    from studies.instruments.spring_shape.figures import draw_channels, draw_errors, draw_shapes, draw_widths

    nets: dict[str, Any] = {}
    for name, shape in shapes.items():
        modes = spatial_modes(shape.spring(), PLANE_MODES)
        twist = kinds_of(shape, modes.displacement, modes.rotation).index("twist")
        nets[f"{name}_rest"], nets[f"{name}_moved"] = net_of(shape, modes, twist, LARGEST)
        nets[f"{name}_ball"] = shape.centreline.points(shape.tip_at)
    record, rows = request.record, {row["reading"]: row for row in tables["readings"]}
    record.write_arrays("shapes", **nets)
    record.write_figure(draw_shapes(nets, [rows[name] for name in READINGS]), "shapes")
    record.write_figure(draw_errors(_columns(tables["theory_error"])), "theory_error")
    others = {name: rows[name]["ratio_twist"] for name in ("folded", "side_by_side", "plain")}
    record.write_figure(draw_channels(_columns(tables["channels"]), others), "channels")
    limit = plate_excess(shapes["plain"])
    record.write_figure(draw_widths(_columns(tables["clamped_widths"]), limit), "clamped_widths")


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--off-line", type=_distance, default=OFF_LINE, metavar="METRES",
                        help=f"how far the ball sits off the plane of symmetry (default: {OFF_LINE:g} m)")


def _distance(text: str) -> float:
    try:
        distance = float(text)
    except ValueError:
        distance = math.nan
    if not (math.isfinite(distance) and distance > 0.0):
        raise argparse.ArgumentTypeError(f"must be a distance in m, greater than 0, not {text!r}")
    return distance


def main(argv: Sequence[str] | None = None) -> int:
    description = 'The readings of "U shaped", their twist modes, and the error of strip theory.'
    return run_study("spring_shape", description, run, argv, options=options)


if __name__ == "__main__":
    raise SystemExit(main())
