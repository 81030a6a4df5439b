"""Natural modes of the spring: what they look like, and what an impact sees of them.

Claim
    The folded strip has two kinds of modes. Sway modes move the ball towards the stop; breathing modes move
    it along the legs at most, and take no part in the impacts.

Equations
    K x = omega^2 M x for the elements of `beam.assembly`, shapes of unit modal mass. Of each mode the impacts
    see the frequency f = omega/(2 pi) [Hz], the decay rate c [1/s], the tip value phi [kg^(-1/2)] and the
    participation Gamma [kg^(1/2)] in a motion of the base. For straight strips of one section the frequencies
    are set beside the zeros of the frequency equation (`beam.frequency_equation`).

Run time
    Ten seconds; a few with --quick.

Command
    python -m studies.modes [--mode 3] [--at-rest] [--frames 24]

Outputs (results/modes)
    modes.csv         the table; modes.npz with the shapes along the strip
    modes.vtu         all shapes as vectors on one mesh, frequencies and decay rates as field data
    motion.pvd        one period of one mode, its frames in motion_frames
    mode_1.gif, ...   one period of each of the first modes, repeated without a seam
    modes.png, .pdf   the first modes in the plane of the strip
    modes_3d.png, .pdf   the same in space

In ParaView open modes.vtu, apply Warp By Vector and choose a mode. Or open motion.pvd and press play: the
points move by themselves; with --at-rest they stay, and Warp By Vector by `displacement` moves them. Where
the machine cannot draw in space, matplotlib does, and one sentence names the packages that are missing.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import LeafSpring, Modes, UniformBeam, exact_modes
from beam.export import write_mode_motion, write_modes
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, WrongUse, run_study
from studies.instruments.mode_figures import DRAWN, LARGEST, draw, draw_in_space
from studies.instruments.motion.film import write_gif
from studies.instruments.motion.scene_bodies import choose_stage
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import damping_of, model_of, modes_of

FILMED, QUICK_FILMED = 6, 2
"""Modes with a film, lowest first."""

RATE = 20.0
"""Frames a second of the films."""


def exact_frequencies(spring: LeafSpring, count: int) -> NDArray[np.float64] | None:
    """Frequencies of the first `count` modes from the frequency equation [Hz]; None where it does not apply.

    It applies to a straight strip of one section that carries its tip at a free far end, or a tip without
    mass anywhere. Rigid motions have 0.
    """
    sections, tip, line = set(spring.sections), spring.tip, spring.centreline
    at_free_end = spring.supports[1] == "free" and spring.tip_at >= line.length * (1.0 - 1e-12)
    massless = tip.mass == tip.rotary_inertia == 0.0
    if not line.is_straight or len(sections) > 1 or not (at_free_end or massless):
        return None
    section = spring.sections[0]
    beam = UniformBeam(
        length=line.length,
        bending_stiffness=section.bending_stiffness,
        mass_per_length=section.mass_per_length,
        supports=spring.supports,
        tip_mass=tip.mass,
        tip_rotary_inertia=tip.rotary_inertia,
    )
    rigid = np.zeros(spring.rigid_motions)
    bent = exact_modes(beam, max(1, count - rigid.size)).omega / (2.0 * math.pi)
    return np.concatenate([rigid, bent])[:count]


def table_of(scene: Scene, modes: Modes | None) -> dict[str, NDArray[Any]]:
    """The columns of the table, one entry for each mode; without shapes, those of the modal data."""
    if modes is None:
        model = model_of(scene)
        frequencies, rates, values = model.frequencies_hz, model.decay_rate, model.phi
        participation, coupled = model.participation, (model.phi != 0.0) | (model.participation != 0.0)
        exact = None
    else:
        frequencies, rates, values = modes.frequencies_hz, damping_of(scene).decay_rates(modes), modes.phi
        participation, coupled = modes.participation, modes.coupled
        exact = exact_frequencies(modes.discretization.spring, frequencies.size)
    return {
        "frequency_hz": frequencies,
        "exact_hz": np.full(frequencies.size, np.nan) if exact is None else exact,
        "decay_rate_per_s": rates,
        "tip_value_kg^-1/2": values,
        "participation_kg^1/2": participation,
        "coupled": coupled,
    }


def printed(table: Mapping[str, NDArray[Any]]) -> str:
    """The table for a person."""
    heads = ("mode", "f (Hz)", "exact (Hz)", "error", "decay (1/s)", "damping (%)", "tip (kg^-1/2)",
             "participation (kg^1/2)", "coupled")
    rows = [heads]
    for number, row in enumerate(zip(*table.values(), strict=True), start=1):
        f, exact, rate, tip, participation, coupled = row
        compared, damped = math.isfinite(exact), math.isfinite(rate)
        rows.append((
            str(number),
            f"{f:.4f}",
            f"{exact:.4f}" if compared else "-",
            f"{f / exact - 1.0:+.0e}" if compared and exact > 0.0 else "-",
            f"{rate:.4g}" if damped else "-",
            f"{100.0 * rate / (4.0 * math.pi * f):.4f}" if damped and f > 0.0 else "-",
            f"{tip:.5g}",
            f"{participation:.5g}",
            "yes" if coupled else "no",
        ))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)) for row in rows
    )


def run(scene: Scene, request: Request) -> Mapping[str, Any]:
    modes = None if scene.spring.kind == "modal_data" else modes_of(scene)
    table = table_of(scene, modes)
    count = table["frequency_hz"].size
    mode = request.options.mode - 1
    if mode >= count:
        raise WrongUse(f"--mode must be at most {count}, the modes of this scene, not {mode + 1}")
    if request.options.frames < 2 or request.options.frames % 2:
        raise WrongUse(f"--frames must be an even number of at least 2, not {request.options.frames}")
    record, folder = request.record, request.record.folder
    columns: dict[str, Any] = {"mode": np.arange(1, count + 1), **table}
    record.write_table("modes", columns)
    print(printed(table))
    if modes is None:
        print("measured modes have no shapes: nothing to draw or to look at in ParaView")
    else:
        _write_shapes(scene, request, modes, table, mode)
        print(
            f"ParaView: open {folder / 'modes.vtu'}, apply Warp By Vector and choose a mode; or open "
            f"{folder / 'motion.pvd'} (mode {mode + 1}) and press play"
            + (", with Warp By Vector by displacement" if request.options.at_rest else "")
        )
    return {
        "frequencies_hz": table["frequency_hz"],
        "exact_hz": table["exact_hz"],
        "tip_values": table["tip_value_kg^-1/2"],
        "participation": table["participation_kg^1/2"],
        "coupled": table["coupled"],
        "decay_rates": table["decay_rate_per_s"],
        "files": sorted(record.files),
    }


def _write_shapes(
    scene: Scene, request: Request, modes: Modes, table: Mapping[str, NDArray[Any]], mode: int
) -> None:
    """Arrays, meshes and figures."""
    record, spring, along = request.record, modes.discretization.spring, modes.displacement_along(2)
    radius = scene.tip.ball_radius_m
    shapes = {
        "frequencies_hz": modes.frequencies_hz,
        "coupled": modes.coupled,
        "arc_length_m": along.s,
        "points_m": along.points,
        "displacement": along.displacement,
        "rotation": along.rotation,
        "tip_at_m": spring.tip_at,
    }
    record.write_arrays("modes", **shapes)
    largest = LARGEST * float(np.ptp(along.points, axis=0).max())
    rates = np.nan_to_num(table["decay_rate_per_s"])
    drawing = {"largest": largest, "ball_radius": radius}
    mesh = write_modes(record.folder / "modes.vtu", modes, decay_rates=rates, **drawing)
    motion, *_ = write_mode_motion(
        record.folder / "motion.pvd",
        modes,
        mode,
        frames=request.options.frames,
        moved=not request.options.at_rest,
        **drawing,
    )
    record.files += [mesh.name, motion.name, f"{motion.stem}_frames"]
    record.write_figure(draw(shapes, radius), "modes")
    _write_films(request, modes, largest, radius)


def _write_films(request: Request, modes: Modes, largest: float, radius: float) -> None:
    """The first modes in space, and their films."""
    from studies.instruments.motion.mode_film import frames_of, mode_film  # matplotlib is slow to import
    from studies.instruments.motion.orbit_film import stage_of

    record, frames = request.record, request.options.frames
    renderer, sentence = choose_stage("matplotlib" if request.quick else "auto")
    if sentence:
        print(sentence)
    film = mode_film(modes, min(DRAWN, modes.omega.size), largest=largest, ball_radius=radius)
    filmed = min(QUICK_FILMED if request.quick else FILMED, modes.omega.size)
    stage = stage_of(renderer, film.bodies, film.view)
    try:
        record.write_figure(draw_in_space(film, stage), "modes_3d")
        with request.progress("frames of the modes", total=filmed * frames) as progress:
            for mode in range(filmed):
                pictures = []
                for picture in frames_of(film, stage, mode, frames):
                    pictures.append(picture)
                    progress.advance()
                file = write_gif(record.folder / f"mode_{mode + 1}.gif", pictures, RATE)
                record.files.append(file.name)
    finally:
        stage.close()


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--mode", type=_number, default=1, metavar="K", help="mode to animate (default: 1)")
    parser.add_argument("--frames", type=_number, default=24, metavar="N",
                        help="frames in one period, an even number (default: 24)")
    parser.add_argument("--at-rest", action="store_true",
                        help="leave the points of motion.pvd at rest, for Warp By Vector by displacement")


def _number(text: str) -> int:
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number of at least 1, not {text!r}")
    return number


NEEDS = (Need(quantity="frequency 10", tolerance=1e-3),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    return run_study("modes", "Natural modes of the spring: table, ParaView files and figure.", run, argv,
                     options=options, needs=NEEDS)


if __name__ == "__main__":
    raise SystemExit(main())
