"""The spring in motion: one period of a settled orbit as a film, slow at the collision.

Higher modes are drawn enlarged, so that they show.  The ball is where the tip is: it meets the plate when the
computed tip does, and the plate turns orange while they touch.  Below, the tip against time.  For ParaView
motion.pvd with motion_frames has the arrays `displacement`, true, and the points as they are drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beam import write_frames
from contact import ImpactOscillator
from contact.orbits import Settled
from studies.experiment.time_trace.filmed_orbit import FilmedOrbit, FrameRow, drawn_shapes, film_orbit
from studies.shell.film import (
    DRIVE,
    WIDTH,
    Moment,
    Picture,
    Scenery,
    can_encode,
    stage_of,
    write_gif,
    written_as_mp4,
)
from studies.shell.scene import Scene, modes_of, shift_at_gap
from studies.shell.study import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

LARGEST_SHIFT = 0.01
"""Relative change of the free frequency with amplitude [1]; a linear film above this bound is misleading."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""


def film(
    scene: Scene,
    run: Run,
    oscillator: ImpactOscillator,
    settled: Settled,
    words: str,
    *,
    frames: int,
    magnify: float | None,
    seen_from: str,
) -> Mapping[str, object]:
    """Film one period of a settled orbit; returns what the summary keeps of it."""
    modes = modes_of(scene)
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
    slowed = [row.slowed for row in orbit.rows]
    slow = f"{min(slowed):.0f} to {max(slowed):.0f} times slower than life"
    run.say(f"{words}: {len(orbit.contacts)} contacts, {slow}")
    found = {
        "duration_s": orbit.duration,
        "impacts": len(orbit.contacts),
        "contacts_s": orbit.contacts,
        "magnification": magnification,
        "film_s": frames / RATE,
    }
    caption = f"The tip along the film, {words}; dashed: the plate."
    run.figure("motion", draw_tip(orbit, scene.stop.gap_m)[0], caption)
    enlarged, most = f"higher modes x {magnification:g}", len(moments)
    with stage_of(scenery, simple=run.quick) as stage:
        # one picture after the other, so that memory does not grow with the film

        def pictured(chosen: Iterable[int]) -> Iterator[Picture]:
            shown = ((orbit.rows[i], stage(moments[i])) for i in chosen)
            return composed(orbit, shown, scene.stop.gap_m, words, enlarged)

        samples = list(pictured([0, most // 2, most - 1]))
        pictures = pictured(run.track(range(most), "frames"))
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
    orbit: FilmedOrbit, shown: Iterable[tuple[FrameRow, Picture]], gap: float, words: str, enlarged: str
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
        slowed = f"{1e3 * row.time_s:.2f} ms, {row.slowed:.0f} times slower; {enlarged}"
        pen.text((12, 32), slowed, fill="#5A5A5A", font=font)
        yield np.asarray(image, dtype=np.uint8)
