"""The spring in motion: one period of a settled orbit as a film, slow at the collision.

The orbit settles at F/F_g - 1 = 0.013 and 21.50 Hz (the letter's Fig. 4) or where --excess and --frequency
say. Higher modes are drawn enlarged, so that they show, the ball where the tip is: it meets the plate when
the computed tip does; the plate turns orange while they touch. Below, the tip against time.

Run:     python -m studies motion [--excess E] [--frequency HZ] [--magnify M] [--seen-from base]
Writes:  motion.gif, motion.mp4 with the extra `video`, motion.png (the tip), frames.csv; for ParaView
         motion.pvd with motion_frames (arrays `displacement`, true, and the points as they are drawn)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue, write_frames
from contact import StroboscopicMap
from contact.orbits import born
from studies import letter
from studies.experiment.motion.filmed_orbit import FilmedOrbit, FrameRow, drawn_shapes, film_orbit
from studies.shell.film import (
    DRIVE,
    MOST_FRAMES,
    WIDTH,
    Moment,
    Picture,
    Scenery,
    can_encode,
    stage_of,
    write_gif,
    written_as_mp4,
)
from studies.shell.scene import (
    Scene,
    beam_at,
    corresponding,
    harmonic,
    model_of,
    modes_of,
    require_drive_below,
    shift_at_gap,
)
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

FREQUENCY = 21.50
"""Where the letter has the period 4 of its Fig. 4 [Hz]."""

LARGEST_SHIFT = 0.01
"""Relative change of the free frequency with amplitude [1]; a linear film above this bound is misleading."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""


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
) -> Mapping[str, object]:
    """Compute, store, draw."""
    if frames > MOST_FRAMES:
        raise InvalidValue(f"frames is {frames}; a film has at most {MOST_FRAMES}")
    drive_hz = corresponding(harmonic(scene), FREQUENCY) if frequency is None else frequency
    modes, model = modes_of(scene), model_of(scene)
    require_drive_below(scene, model, drive_hz)
    oscillator = beam_at(scene, drive_hz, model).with_excess(excess)
    strobed, most = StroboscopicMap(oscillator=oscillator), max(scene.scan.settle_cycles, 1)
    settled = born(strobed, excess, most_cycles=most)
    orbit = film_orbit(oscillator, settled.end, settled.period, frames=frames, rate=RATE)
    swing, radius = max(abs(row.tip_m) for row in orbit.rows), scene.tip.ball_radius_m
    if (shift := abs(shift_at_gap(scene)) * (swing / scene.stop.gap_m) ** 2) > LARGEST_SHIFT:
        off = f"would change its free frequency by {100.0 * shift:.2g} %"
        run.warn(f"the model is linear, but the tip moves by {swing:.3g} m, which {off}")
    scenery = Scenery.of(modes, ball_radius=radius, gap=scene.stop.gap_m, swing=swing)
    drawn, magnification = drawn_shapes(scenery.mesh, modes, orbit.coordinates, magnify)
    carried = DRIVE * (seen_from == "laboratory")
    moments = [
        Moment(points=points, base=row.base_m * carried, touched=row.contact)
        for points, row in zip(drawn, orbit.rows, strict=True)
    ]
    run.table("frames", orbit.rows, show=())
    true, _ = drawn_shapes(scenery.mesh, modes, orbit.coordinates, 1.0)
    write_frames(run.path("motion.pvd"), grids(scenery, moments, true, orbit.rows))
    run.path("motion_frames")
    name = f"p{settled.period}" if settled.period else "no period up to 64"
    words = f"{name}, {drive_hz:g} Hz, excess {excess:g}"
    slowed = [row.slowed for row in orbit.rows]
    slow = f"{min(slowed):.0f} to {max(slowed):.0f} times slower than life"
    run.say(f"{words}: {len(orbit.contacts)} contacts, {slow}")
    found = {
        "frequency_hz": drive_hz,
        "excess": excess,
        "period": settled.period,
        "duration_s": orbit.duration,
        "impacts": len(orbit.contacts),
        "contacts_s": orbit.contacts,
        "magnification": magnification,
        "film_s": frames / RATE,
    }
    caption = f"The tip along the film, {words}; dashed: the plate."
    run.figure("motion", draw_tip(orbit, scene.stop.gap_m)[0], caption)
    told, most = f"higher modes x {magnification:g}", len(moments)
    with stage_of(scenery, simple=run.quick) as stage:
        # one picture after the other, so that memory does not grow with the film

        def film(chosen: Iterable[int]) -> Iterator[Picture]:
            shown = ((orbit.rows[i], stage(moments[i])) for i in chosen)
            return composed(orbit, shown, scene.stop.gap_m, words, told)

        samples = list(film([0, most // 2, most - 1]))
        pictures = film(run.track(range(most), "frames"))
        if can_encode():
            pictures = written_as_mp4(run.path("motion.mp4"), pictures, RATE)
        else:
            run.say("no mp4: it needs imageio-ffmpeg (pip install -e '.[video]')")
        write_gif(run.path("motion.gif"), pictures, RATE, samples=samples)
    return found


def grids(
    scenery: Scenery, moments: Sequence[Moment], true: Array, rows: Sequence[FrameRow]
) -> Iterator[tuple[float, Any]]:
    """Time [s] and pyvista.UnstructuredGrid of every frame, the points as they are drawn."""
    for moment, displacement, row in zip(moments, true, rows, strict=True):
        grid = scenery.mesh.grid(scenery.mesh.points + moment.points + moment.base)
        grid.point_data["displacement"] = displacement
        for name in ("tip_m", "base_m", "force_n", "slowed"):
            grid.field_data[name] = [getattr(row, name)]
        yield row.time_s, grid


def draw_tip(orbit: FilmedOrbit, gap: float) -> tuple[Figure, Any]:
    """The tip against time, and its axes."""
    from studies.shell.plotting import BLUE, GUIDE, PAGE, house_style, label, new_figure

    figure, axes = new_figure(width=PAGE, height=0.05)
    with house_style():
        axes.plot(1e3 * orbit.line_time, 1e3 * orbit.line_tip, color=BLUE)
        axes.axhline(1e3 * gap, **GUIDE)
        axes.set_xlim(0.0, 1e3 * orbit.duration)
        label(axes.xaxis, "time", "ms")
        label(axes.yaxis, "tip", "mm")
    return figure, axes


def composed(
    orbit: FilmedOrbit, shown: Iterable[tuple[FrameRow, Picture]], gap: float, words: str, told: str
) -> Iterator[Picture]:
    """The frames: what is seen, the time and how it is slowed, and the tip against time with a mark."""
    from PIL import Image, ImageDraw, ImageFont

    figure, axes = draw_tip(orbit, gap)
    figure.set(dpi=110, size_inches=(WIDTH / 110, 150 / 110))
    figure.canvas.draw()
    below = np.asarray(figure.canvas.buffer_rgba(), dtype=np.uint8)[..., :3]  # type: ignore[attr-defined]
    font = ImageFont.load_default(size=18)
    for row, picture in shown:
        place = axes.transData.transform((1e3 * row.time_s, 1e3 * row.tip_m))
        image = Image.fromarray(np.concatenate([picture, below]))
        pen = ImageDraw.Draw(image)
        at = place[0], image.height - place[1]
        pen.circle(at, 5, fill="#FF7A1A" if row.contact else "black")
        pen.text((12, 8), words, fill="black", font=font)
        slowed = f"{1e3 * row.time_s:.2f} ms, {row.slowed:.0f} times slower; {told}"
        pen.text((12, 32), slowed, fill="#5A5A5A", font=font)
        yield np.asarray(image, dtype=np.uint8)
