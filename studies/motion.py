"""The spring in motion: one period of a settled orbit as a film, slow where the ball meets the plate.

Claim (letter 1996, Fig. 4): at impact "a multitude of high-order modes is excited in the beam", and still the
motion repeats after four drive periods.

Shown, at 21.50 Hz and F/F_g - 1 = 0.013 unless other values are given:

    in space     spring, ball, plate and clamp on the table that the exciter shakes; the plate flashes
                 (colour, outline, rays and a word) in every frame in which the ball touches it
    enlarged     the departure from the shape of mode 1 at the same tip displacement, by a round number that
                 is written in every frame; tip, ball and gap are to scale: contacts are where they seem to be
    slowed       by round numbers that rise towards each contact and are written in every frame
    beside it    the strobe points, which appear one by one, and the tip against time

With --seen-from base the viewer rides on the exciter; otherwise he stands in the laboratory. Where the
machine cannot draw in space by itself, matplotlib draws the same pictures, and one sentence names the
packages that are missing.

Run time: half a minute; 10 s with --quick.
Command: python -m studies.motion [--excess E] [--frequency HZ] [--frames N] [--magnify M] [--seen-from base].

Outputs (results/motion)
    motion.gif, .mp4   the film; mp4 with the extra `video`
    motion.pvd         the same frames for ParaView, in motion_frames: points moved as drawn, the array
                       `displacement` as computed
    frames.csv         every frame: time, slow motion, tip, base, force, contact
    motion.png, .pdf   stills on one page
    strobes.csv        the strobe points
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from beam.export import write_frames
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, run_study
from studies.instruments.corresponding import corresponding
from studies.instruments.motion.film import NO_VIDEO, can_encode, write_gif, write_mp4
from studies.instruments.motion.filmed_orbit import FilmedOrbit, film_orbit
from studies.instruments.motion.orbit_film import OrbitFilm, orbit_film, stage_of
from studies.instruments.motion.paraview import grids_of
from studies.instruments.motion.scene_bodies import choose_stage
from studies.instruments.motion.words import closing_lines, slow_motion, words_of
from studies.instruments.options import above, positive
from studies.instruments.oscillators import beam_of
from studies.instruments.progress import Progress
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene
from studies.instruments.settled_trace import settled_state
from studies.instruments.spring_of_scene import model_of, modes_of
from studies.published import TIME_TRACE_EXCESS

Step = TypeVar("Step")

FREQUENCY = 21.50
"""Where the letter has the period 4 of its Fig. 4 [Hz]."""

FRAMES, QUICK_FRAMES = 240, 60
"""Of the film; a film of 12 s stays below 5 MB."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""

STILLS = 8
"""Pictures on the contact sheet."""


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store, draw."""
    if scene.drive.kind != "harmonic":
        raise SceneError(f"drive.kind is {scene.drive.kind}; a settled orbit needs a harmonic drive")
    asked, record = request.options, request.record
    frequency = corresponding(scene, FREQUENCY) if asked.frequency is None else asked.frequency
    renderer, sentence = choose_stage(asked.renderer)
    modes, model = modes_of(scene), model_of(scene)
    scene.replace({"drive.frequencies_hz": (frequency,)}).refuse_drive_above(
        float(model.frequencies_hz.max())
    )
    oscillator = beam_of(scene, frequency, model).with_excess(asked.excess)
    period, state = settled_state(oscillator, max(scene.scan.settle_cycles, 1))
    frames = asked.frames or (QUICK_FRAMES if request.quick else FRAMES)
    orbit = film_orbit(oscillator, state, period, frames=frames, rate=RATE)
    from studies.instruments.motion.panels import PICTURE, WIDTH  # matplotlib is slow to import

    film = orbit_film(
        orbit, modes, ball_radius=scene.tip.ball_radius_m, width=WIDTH, height=PICTURE,
        shaken=asked.seen_from == "laboratory", magnification=asked.magnify,
    )  # fmt: skip
    stills = film.stills(STILLS)
    _write_tables(request, orbit, stills)
    with request.progress("meshes", total=film.count) as progress:
        written = write_frames(record.folder / "motion.pvd", told(grids_of(film), progress))
    record.files += [written[0].name, "motion_frames"]
    if sentence:
        print(sentence, flush=True)
    _write_film(request, film, frequency, renderer, stills)
    if not can_encode():
        print(NO_VIDEO, flush=True)
    lines = closing_lines(film, frequency, asked.excess, record.folder)
    for line in lines:
        print(line, flush=True)
    return {
        "frequency_hz": frequency,
        "excess": asked.excess,
        "period": period,
        "duration_s": orbit.duration,
        "impacts": len(orbit.contacts),
        "contacts_s": orbit.contacts,
        "magnification": film.shape.magnification,
        "seen_from": asked.seen_from,
        "renderer": renderer,
        "frames": film.count,
        "film_s": film.count / RATE,
        "slow_motion": slow_motion(orbit),
        "strobe_tip_m": orbit.strobes.tip,
        "stills": [number + 1 for number in stills],
        "files": sorted(record.files),
        "closing": lines,
    }


def told(steps: Iterator[Step], progress: Progress) -> Iterator[Step]:
    """The same steps, each counted when it has been dealt with."""
    for step in steps:
        yield step
        progress.advance()


def _write_tables(request: Request, orbit: FilmedOrbit, stills: Sequence[int]) -> None:
    """The numbers behind the film, before anything is drawn."""
    law, numbers = orbit.law, np.arange(orbit.law.time.size)
    columns: dict[str, NDArray[Any]] = {
        "frame": numbers + 1,
        "time_s": law.time,
        "slowed": law.slowed,
        "tip_m": orbit.tip,
        "tip_velocity_m_per_s": orbit.velocity,
        "base_m": orbit.base,
        "force_n": orbit.force,
        "contact": orbit.touching.astype(int),
        "on_sheet": np.isin(numbers, stills).astype(int),
    }
    request.record.write_table("frames", columns)  # type: ignore[arg-type]
    strobes = {
        "time_s": orbit.strobes.time,
        "tip_m": orbit.strobes.tip,
        "tip_velocity_m_per_s": orbit.strobes.velocity,
    }
    request.record.write_table("strobes", strobes)  # type: ignore[arg-type]


def _write_film(
    request: Request, film: OrbitFilm, frequency: float, renderer: str, stills: Sequence[int]
) -> None:
    """Draw every frame once; the pictures of the stills serve the contact sheet, too."""
    from studies.instruments.motion.contact_sheet import draw_sheet
    from studies.instruments.motion.panels import Panels

    record, asked = request.record, request.options
    title, scale = words_of(film, frequency, asked.excess)
    panels = Panels(film.orbit, film.view, film.bodies.bench, film.reach, title, scale)
    stage = stage_of(renderer, film.bodies, film.view)
    frames: list[NDArray[np.uint8]] = []
    kept: list[NDArray[np.uint8]] = []
    try:
        with request.progress("frames", total=film.count) as progress:
            for number in range(film.count):
                moment = film.moment(number)
                picture = stage.picture(moment)
                frames.append(panels.frame(number, picture, moment))
                if number in stills:
                    kept.append(picture)
                progress.advance()
    finally:
        stage.close()
    record.write_figure(draw_sheet(film, stills, kept, title, scale), "motion")
    record.files.append(write_gif(record.folder / "motion.gif", frames, RATE, stills).name)
    if can_encode():
        record.files.append(write_mp4(record.folder / "motion.mp4", frames, RATE).name)


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own options."""
    parser.add_argument(
        "--excess", type=above(-1.0, "a number above -1"), default=TIME_TRACE_EXCESS, metavar="E",
        help=f"F/F_g - 1 of the orbit (default: {TIME_TRACE_EXCESS:g}, the letter's Fig. 4)",
    )
    parser.add_argument(
        "--frequency", type=above(0.0, "a frequency above 0 Hz"), metavar="HZ",
        help=f"drive frequency (default: {FREQUENCY:g} Hz, the letter's p4; other springs at the same f T)",
    )
    parser.add_argument("--frames", type=positive, default=None, metavar="N",
                        help=f"frames at most (default: {FRAMES}, with --quick {QUICK_FRAMES})")
    parser.add_argument("--magnify", type=above(0.0, "a number above 0"), default=None, metavar="M",
                        help="how many times the higher modes are drawn (default: so that they show)")
    parser.add_argument("--seen-from", choices=("laboratory", "base"), default="laboratory",
                        help="where the viewer stands (default: laboratory, in which the exciter moves)")
    parser.add_argument("--renderer", choices=("auto", "vtk", "matplotlib"), default="auto",
                        help="what draws (default: auto, VTK where it can draw off the screen)")


NEEDS = (Need(quantity="tip_trace", tolerance=2e-3),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "motion",
        "The spring in motion through one period of a settled orbit: film, frames for ParaView, stills.",
        run,
        argv,
        options=add_options,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
