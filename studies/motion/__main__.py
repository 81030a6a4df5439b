"""The spring in motion: one period of a settled orbit as a film, slow at the collision, with its stills.

The orbit settles at F/F_g - 1 = 0.013 and 21.50 Hz (the letter's Fig. 4) or where --excess and --frequency
say. Higher modes are drawn enlarged, so that they show, the ball where the tip is: it meets the plate when
the computed tip does; the plate turns orange while they touch. Below, the tip against time.

Run:     python -m studies.motion [--excess E] [--frequency HZ] [--magnify M] [--seen-from base]     40 s
Writes:  motion.gif, motion.mp4 with the extra `video`, motion.png (stills), frames.csv, strobes.csv; for
ParaView
         motion.pvd with motion_frames (arrays `displacement`, true, and the points as they are drawn)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from beam import write_frames
from contact import ImpactOscillator, StroboscopicMap
from contact.orbits import born
from studies import letter
from studies.film import (
    NO_RENDERING,
    Moment,
    Picture,
    Scenery,
    can_encode,
    can_render,
    stage_of,
    write_gif,
    write_mp4,
)
from studies.motion.filmed_orbit import Drawn, FilmedOrbit, drawn_shapes, film_orbit
from studies.run import Run, study
from studies.scene import Scene, beam_at, corresponding, harmonic, model_of, modes_of, require_drive_below

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FrameRow", "StrobeRow", "motion"]

Array = NDArray[np.float64]

FREQUENCY = 21.50
"""Where the letter has the period 4 of its Fig. 4 [Hz]."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""

STILLS = 8
"""Pictures on the sheet of stills."""


@dataclass(frozen=True, kw_only=True)
class FrameRow:
    """One frame: time, how many times slower than life it is shown, tip, base, force, whether they touch."""

    frame: int
    time_s: float
    slowed: float
    tip_m: float
    tip_velocity_m_per_s: float
    base_m: float
    force_n: float
    contact: bool


@dataclass(frozen=True, kw_only=True)
class StrobeRow:
    """One strobe of the orbit."""

    time_s: float
    tip_m: float
    tip_velocity_m_per_s: float


@study(needs={"tip_trace": 2e-3}, quick={"frames": 60})
def motion(
    scene: Scene,
    run: Run,
    *,
    excess: Annotated[float, "F/F_g - 1 of the orbit, above -1"] = letter.TIME_TRACE_EXCESS,
    frequency: Annotated[
        float | None, "drive frequency (Hz); 21.5, other springs at the same f T, by default"
    ] = None,
    frames: Annotated[int, "frames of the film"] = 240,
    magnify: Annotated[float | None, "how many times the higher modes are drawn; so that they show"] = None,
    seen_from: Annotated[Literal["laboratory", "base"], "where the viewer stands"] = "laboratory",
    renderer: Annotated[Literal["auto", "vtk", "matplotlib"], "what draws"] = "auto",
) -> Mapping[str, object]:
    """Compute, store, draw."""
    drive_hz = corresponding(harmonic(scene), FREQUENCY) if frequency is None else frequency
    modes, model = modes_of(scene), model_of(scene)
    require_drive_below(scene, model, drive_hz)
    oscillator = beam_at(scene, drive_hz, model).with_excess(excess)
    settled = born(
        StroboscopicMap(oscillator=oscillator), excess, most_cycles=max(scene.scan.settle_cycles, 1)
    )
    orbit = film_orbit(oscillator, settled.end, settled.period, frames=frames, rate=RATE)
    tip = orbit.run.displacement @ model.phi
    scenery = Scenery.of(
        modes, ball_radius=scene.tip.ball_radius_m, gap=scene.stop.gap_m, swing=float(np.abs(tip).max())
    )
    shapes = drawn_shapes(scenery.mesh, modes, orbit.run.displacement, magnify)
    base = orbit.base[:, None] * scenery.drive * (seen_from == "laboratory")
    moments = [
        Moment(points=points, base=shift, touched=bool(touched))
        for points, shift, touched in zip(shapes.points, base, orbit.touched, strict=True)
    ]
    rows = frame_rows(orbit, model.phi)
    run.table("frames", rows, show=())
    strobes = strobe_rows(orbit, model.phi)
    run.table("strobes", strobes, "The orbit at its strobes.")
    true = drawn_shapes(scenery.mesh, modes, orbit.run.displacement, 1.0)
    write_frames(run.path("motion.pvd"), grids(scenery, moments, true, rows))
    run.path("motion_frames")
    name = f"p{settled.period}" if settled.period else "no period up to 64"
    words = f"{name}, {drive_hz:g} Hz, excess {excess:g}"
    pictures = write_film(run, orbit, scenery, moments, oscillator, renderer, words, shapes.magnification)
    moves = "the base moves" if seen_from == "laboratory" else "seen from the base"
    caption = f"{words}; higher modes drawn {shapes.magnification:g} times; {moves}."
    run.figure("motion", draw_sheet(pictures, rows, orbit), caption)
    slow = f"{orbit.slowed.min():.0f} to {orbit.slowed.max():.0f} times slower than life"
    run.say(f"{words}: {len(orbit.contacts)} contacts, {slow}")
    return {
        "frequency_hz": drive_hz,
        "excess": excess,
        "period": settled.period,
        "duration_s": orbit.duration,
        "impacts": len(orbit.contacts),
        "contacts_s": orbit.contacts,
        "magnification": shapes.magnification,
        "seen_from": seen_from,
        "frames": frames,
        "film_s": frames / RATE,
        "strobe_tip_m": [row.tip_m for row in strobes],
    }


def write_film(
    run: Run,
    orbit: FilmedOrbit,
    scenery: Scenery,
    moments: Sequence[Moment],
    oscillator: ImpactOscillator,
    renderer: str,
    words: str,
    magnified: float,
) -> list[Picture]:
    """Draw every frame once and write the films; returns the pictures without time and trace."""
    if renderer == "auto" and not can_render():
        run.say(NO_RENDERING)
    with stage_of(scenery, renderer) as stage:
        pictures = [stage(moment) for moment in run.track(moments, "frames")]
    framed = list(composed(orbit, pictures, oscillator.model.phi, oscillator.stop.gap, words, magnified))
    write_gif(run.path("motion.gif"), framed, RATE)
    if can_encode():
        write_mp4(run.path("motion.mp4"), framed, RATE)
    else:
        run.say("no mp4: it needs imageio-ffmpeg (pip install -e '.[video]')")
    return pictures


def frame_rows(orbit: FilmedOrbit, phi: Array) -> list[FrameRow]:
    """The numbers behind the film."""
    tip, velocity = orbit.run.displacement @ phi, orbit.run.velocity @ phi
    columns = (orbit.run.time - orbit.begin, orbit.slowed, tip, velocity, orbit.base, orbit.force)
    return [
        FrameRow(frame=number + 1, time_s=t, slowed=slow, tip_m=x, tip_velocity_m_per_s=v, base_m=b,
                 force_n=n, contact=bool(orbit.touched[number]))
        for number, (t, slow, x, v, b, n) in enumerate(np.array(columns).T.tolist())
    ]  # fmt: skip


def strobe_rows(orbit: FilmedOrbit, phi: Array) -> list[StrobeRow]:
    """The orbit at its strobes."""
    run = orbit.strobes
    columns = (run.time - orbit.begin, run.displacement @ phi, run.velocity @ phi)
    return [StrobeRow(time_s=t, tip_m=x, tip_velocity_m_per_s=v) for t, x, v in np.array(columns).T.tolist()]


def grids(
    scenery: Scenery, moments: Sequence[Moment], true: Drawn, rows: Sequence[FrameRow]
) -> Iterator[tuple[float, Any]]:
    """Time [s] and pyvista.UnstructuredGrid of every frame, the points as they are drawn."""
    for moment, displacement, row in zip(moments, true.points, rows, strict=True):
        grid = scenery.mesh.grid(scenery.mesh.points + moment.points + moment.base)
        grid.point_data["displacement"] = displacement
        for name in ("tip_m", "base_m", "force_n", "slowed"):
            grid.field_data[name] = [getattr(row, name)]
        yield row.time_s, grid


def composed(
    orbit: FilmedOrbit, pictures: Sequence[Picture], phi: Array, gap: float, words: str, magnified: float
) -> Iterator[Picture]:
    """The frames: what is seen, the time and how it is slowed, and the tip against time with a mark."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from PIL import Image, ImageDraw, ImageFont

    from studies.plotting import BLUE, GUIDE, house_style

    width, dots = pictures[0].shape[1], 110
    with house_style():
        figure = Figure(figsize=(width / dots, 150 / dots), dpi=dots)
        canvas, axes = FigureCanvasAgg(figure), figure.add_axes((0.075, 0.30, 0.91, 0.62))
        begin = orbit.begin
        axes.plot(1e3 * (orbit.line.time - begin), 1e3 * (orbit.line.displacement @ phi), color=BLUE)
        axes.axhline(1e3 * gap, **GUIDE)
        axes.set_xlim(0.0, 1e3 * orbit.duration)
        axes.set_xlabel("time (ms)")
        axes.set_ylabel("tip (mm)")
        canvas.draw()
    below = np.asarray(canvas.buffer_rgba(), dtype=np.uint8)[..., :3]
    tip = orbit.run.displacement @ phi
    places = axes.transData.transform(np.column_stack([1e3 * (orbit.run.time - begin), 1e3 * tip]))
    font = ImageFont.load_default(size=18)
    for number, picture in enumerate(pictures):
        image = Image.fromarray(np.concatenate([picture, below]))
        pen = ImageDraw.Draw(image)
        column, row = places[number, 0], picture.shape[0] + below.shape[0] - places[number, 1]
        pen.ellipse(
            (column - 5, row - 5, column + 5, row + 5), fill="#FF7A1A" if orbit.touched[number] else "black"
        )
        time = 1e3 * float(orbit.run.time[number] - begin)
        pen.text((12, 8), words, fill="black", font=font)
        told = f"{time:.2f} ms, {orbit.slowed[number]:.0f} times slower; higher modes x {magnified:g}"
        pen.text((12, 32), told, fill="#5A5A5A", font=font)
        yield np.asarray(image, dtype=np.uint8)


def draw_sheet(pictures: Sequence[Picture], rows: Sequence[FrameRow], orbit: FilmedOrbit) -> Figure:
    """Stills with their times, one of them with the contact."""
    from studies.plotting import PAGE, house_style, new_figure

    stills = np.linspace(0, len(rows) - 1, STILLS).round().astype(int)
    if orbit.touched.any():
        touch = int(np.flatnonzero(orbit.touched)[0])
        stills[1 + np.argmin(np.abs(stills[1:-1] - touch))] = touch
    with house_style():
        lines = -(-STILLS // 2)
        figure, axes = new_figure(lines, 2, width=PAGE, height=0.046 * lines, squeeze=False)
        for axis, number in zip(axes.flat, stills.tolist(), strict=True):
            axis.imshow(pictures[number])
            axis.axis("off")
            row = rows[number]
            axis.set_title(f"{1e3 * row.time_s:.2f} ms" + (", contact" if row.contact else ""), loc="left")
    return figure


if __name__ == "__main__":
    raise SystemExit(motion.main())
