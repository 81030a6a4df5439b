"""The spring in motion: one period of a settled orbit as a film, slow at the collision.

Higher modes are drawn enlarged, so that they show.  The ball is where the tip is: it meets the plate when the
computed tip does, and the plate turns orange while they touch.  Below, the tip against time.  For ParaView
motion.pvd with motion_frames has the arrays `displacement`, true, and the points as they are drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from beam import write_frames
from contact import ImpactOscillator
from contact.orbits import Settled
from studies.experiment.time_trace.filmed_orbit import FilmedOrbit, drawn_shapes, film_orbit
from studies.experiment.time_trace.model import Trace
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

LARGEST_SHIFT = 0.01
"""Relative change of the free frequency with amplitude [1]; a linear film above this bound is misleading."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""


def film(
    scene: Scene,
    run: Run,
    oscillator: ImpactOscillator,
    settled: Settled,
    trace: Trace,
    words: str,
    *,
    frames: int,
) -> Mapping[str, object]:
    """Film one period of a settled orbit; returns what the summary keeps of it."""
    modes = modes_of(scene)
    orbit = film_orbit(oscillator, settled.end, settled.period, frames=frames, rate=RATE)
    gap, swing, radius = scene.stop.gap_m, float(np.abs(orbit.tip).max()), scene.tip.ball_radius_m
    if (shift := abs(shift_at_gap(scene)) * (swing / gap) ** 2) > LARGEST_SHIFT:
        off = f"would change its free frequency by {100.0 * shift:.2g} %"
        run.warn(f"the model is linear, but the tip moves by {swing:.3g} m, which {off}")
    scenery = Scenery.of(modes, ball_radius=radius, gap=gap, swing=swing)
    drawn, magnification = drawn_shapes(scenery.mesh, modes, orbit.coordinates)
    true, _ = drawn_shapes(scenery.mesh, modes, orbit.coordinates, 1.0)
    moments = [
        Moment(points=points, base=base * DRIVE, touched=bool(touched))
        for points, base, touched in zip(drawn, orbit.base, orbit.touched, strict=True)
    ]

    def grids() -> Iterator[tuple[float, Any]]:
        """Time [s] and pyvista.UnstructuredGrid of every frame, the points as they are drawn."""
        for time, moment, displacement in zip(orbit.time.tolist(), moments, true, strict=True):
            grid = scenery.mesh.grid(scenery.mesh.points + moment.points + moment.base)
            grid.point_data["displacement"] = displacement
            yield time, grid

    write_frames(run.path("motion.pvd"), grids())
    run.path("motion_frames")
    slow = f"{orbit.slowed.min():.0f} to {orbit.slowed.max():.0f} times slower than life"
    run.say(f"{words}: {len(orbit.contacts)} contacts, {slow}")
    texts = words, f"higher modes x {magnification:g}"
    with stage_of(scenery, simple=run.quick) as stage:
        # one picture after the other, so that memory does not grow with the film

        def pictured(chosen: Iterable[int]) -> Iterator[Picture]:
            return composed(orbit, trace, ((i, stage(moments[i])) for i in chosen), gap, texts)

        samples = list(pictured([0, frames // 2, frames - 1]))
        pictures = pictured(run.track(range(frames), "frames"))
        if can_encode():
            pictures = written_as_mp4(run.path("motion.mp4"), pictures, RATE)
        else:
            run.say("no mp4: it needs imageio-ffmpeg (pip install -e '.[video]')")
        write_gif(run.path("motion.gif"), pictures, RATE, samples=samples)
    return {"contacts_s": orbit.contacts, "magnification": magnification}


def composed(
    orbit: FilmedOrbit, trace: Trace, shown: Iterable[tuple[int, Picture]], gap: float, texts: tuple[str, str]
) -> Iterator[Picture]:
    """The frames: what is seen, the time and how it is slowed, and the tip against time with a mark."""
    from PIL import Image, ImageDraw, ImageFont

    from studies.shell.plotting import BLUE, GUIDE, house_style, label, new_figure

    with house_style():
        figure, axes = new_figure(width=WIDTH / 110 * 0.0254, height=150 / 110 * 0.0254)
        axes.plot(1e3 * trace.time, 1e3 * trace.tip, color=BLUE)
        axes.axhline(1e3 * gap, **GUIDE)
        axes.set_xlim(0.0, 1e3 * orbit.duration)
        label(axes.xaxis, "time", "ms")
        label(axes.yaxis, "tip", "mm")
        figure.set(dpi=110)
        figure.canvas.draw()
    below = np.asarray(figure.canvas.buffer_rgba(), dtype=np.uint8)[..., :3]  # type: ignore[attr-defined]
    font = ImageFont.load_default(size=18)
    for i, picture in shown:
        place = axes.transData.transform((1e3 * orbit.time[i], 1e3 * orbit.tip[i]))
        image = Image.fromarray(np.concatenate([picture, below]))
        pen = ImageDraw.Draw(image)
        at = place[0], image.height - place[1]
        pen.circle(at, 5, fill="#FF7A1A" if orbit.touched[i] else "black")
        pen.text((12, 8), texts[0], fill="black", font=font)
        slowed = f"{1e3 * orbit.time[i]:.2f} ms, {orbit.slowed[i]:.0f} times slower; {texts[1]}"
        pen.text((12, 32), slowed, fill="#5A5A5A", font=font)
        yield np.asarray(image, dtype=np.uint8)
