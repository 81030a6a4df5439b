"""Natural modes of the spring: shapes, films, and share in an impact.

Claim: with legs side by side every bending mode moves the ball towards the stop. A folded strip has two kinds
of modes: sway modes do, breathing modes move the ball along the legs at most, and take no part in impacts.

    K x = omega^2 M x      for the elements of the strip, shapes of unit modal mass

Of each mode the impacts see the frequency f = omega/(2 pi) [Hz], the decay rate c [1/s], the tip value phi
[kg^(-1/2)] and the participation Gamma [kg^(1/2)] in a motion of the base.

Run:     python -m studies modes [--mode 3] [--frames 24]
Writes:  modes.csv (the table), modes.npz (shapes along the strip), modes.png; for ParaView modes.vtu (Warp By
         Vector, choose a mode) and motion.pvd with motion_frames (one period of one mode: press play);
         mode_1.gif ... (films of the first)
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from beam import Modes, write_mode_motion, write_modes
from studies import letter
from studies.shell.film import MOST_FRAMES, Moment, Scenery, stage_of, write_gif
from studies.shell.options import Within
from studies.shell.scene import Scene, SceneError, damping_of, free_period, model_of, modes_of
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FILMED, DRAWN = 6, 8
"""Modes with a film, and in the figure; lowest first."""

RATE = 20.0
"""Frames a second of the films."""

LARGEST = 0.05
"""Largest displacement of a drawn shape over the greatest extent of the strip; legs do not cross yet."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One mode."""

    mode: int
    frequency_hz: float
    decay_rate_per_s: float
    tip_value: float
    participation: float
    coupled: bool


@study(needs={"frequency 10": 1e-3}, quick={"filmed": 2})
def modes(
    scene: Scene,
    run: Run,
    *,
    mode: Annotated[int, "mode to animate"] = 1,
    frames: Annotated[int, "frames in one period, an even number", Within(2, MOST_FRAMES)] = 24,
    filmed: Annotated[int, "modes with a film, lowest first"] = FILMED,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if frames % 2:
        raise SceneError(f"frames is {frames}; it must be an even number")
    solved = None if scene.spring.kind == "modal_data" else modes_of(scene)
    rows = rows_of(scene, solved)
    if mode > len(rows):
        raise SceneError(f"--mode must be at most {len(rows)}, the modes of this scene, not {mode}")
    run.table("modes", rows, "Natural modes: f, c, phi [kg^(-1/2)], Gamma [kg^(1/2)].", of=Row)
    if solved is None:
        run.say("measured modes have no shapes: nothing to draw or to look at in ParaView")
    else:
        write_shapes(scene, run, solved, mode - 1, frames)
        write_films(run, solved, scene.tip.ball_radius_m, min(filmed, len(rows)), frames)
        judge(scene, run)
    return {"rows": rows, "free_period_s": None if solved is None else free_period(scene)}


def rows_of(scene: Scene, solved: Modes | None) -> list[Row]:
    """The table; without shapes, of the modal data."""
    if solved is None:
        model = model_of(scene)
        coupled = (model.phi != 0.0) | (model.participation != 0.0)
        columns = (model.frequencies_hz, model.decay_rate, model.phi, model.participation, coupled)
    else:
        rates = damping_of(scene).decay_rates(solved)
        columns = (solved.frequencies_hz, rates, solved.phi, solved.participation, solved.coupled)
    return [
        Row(
            mode=number,
            frequency_hz=float(f),
            decay_rate_per_s=float(c),
            tip_value=float(phi),
            participation=float(gamma),
            coupled=bool(moves),
        )
        for number, (f, c, phi, gamma, moves) in enumerate(zip(*columns, strict=True), start=1)
    ]


def largest_of(solved: Modes) -> float:
    """Largest displacement of a drawn shape [m]."""
    return LARGEST * float(np.ptp(solved.displacement_along(2).points, axis=0).max())


def write_shapes(scene: Scene, run: Run, solved: Modes, mode: int, frames: int) -> None:
    """Arrays, meshes and the figure."""
    along, radius, largest = solved.displacement_along(2), scene.tip.ball_radius_m, largest_of(solved)
    run.arrays(
        "modes",
        frequencies_hz=solved.frequencies_hz,
        coupled=solved.coupled,
        arc_length_m=along.s,
        points_m=along.points,
        displacement=along.displacement,
        rotation=along.rotation,
        tip_at_m=solved.discretization.spring.tip_at,
    )
    rates = np.nan_to_num(damping_of(scene).decay_rates(solved))
    write_modes(run.path("modes.vtu"), solved, decay_rates=rates, largest=largest, ball_radius=radius)
    write_mode_motion(
        run.path("motion.pvd"), solved, mode, frames=frames, largest=largest, ball_radius=radius
    )
    run.path("motion_frames")
    caption = "Shapes in the plane of the strip, enlarged; grey: at rest, dashed: half a period later."
    run.figure("modes", draw(solved), caption)


def write_films(run: Run, solved: Modes, radius: float, count: int, frames: int) -> None:
    """One period of each of the first modes, in space, repeated without a seam."""
    largest = largest_of(solved)
    scenery = Scenery.of(solved, ball_radius=radius, swing=largest)
    with stage_of(scenery, simple=run.quick) as stage:
        for number in run.track(range(count), "films of modes"):
            shape = scenery.mesh.normalised(largest)[number]
            phases = 2.0 * math.pi * np.arange(frames) / frames
            moments = [Moment(points=math.cos(phase) * shape, base=np.zeros(3)) for phase in phases]
            pictures = [stage(moment) for moment in moments]
            write_gif(run.path(f"mode_{number + 1}.gif"), pictures, RATE, samples=pictures[:: frames // 2])


def judge(scene: Scene, run: Run) -> None:
    """Verdict on the free period: the thickness was fitted to it."""
    period, told = free_period(scene), scene.provenance()["spring.thickness_m"]
    same = abs(period - letter.FREE_PERIOD_S) <= letter.FREE_PERIOD_ERROR_S
    verdict = "fitted" if same and told == "calibrated" else "agrees" if same else "differs"
    run.verdict("free_period", verdict, found=f"{1e3 * period:.2f} ms")  # type: ignore[arg-type]


def draw(solved: Modes) -> Figure:
    """The first modes in the plane of the strip."""
    from studies.shell.plotting import PAGE, PALETTE, label, new_figure  # matplotlib is slow to import

    along = solved.displacement_along(2)
    points, count = 1e3 * along.points, min(DRAWN, solved.omega.size)
    ball = int(np.argmin(np.abs(along.s - solved.discretization.spring.tip_at)))
    swing, columns = 1e3 * largest_of(solved), min(2, count)
    rows, extent = math.ceil(count / columns), np.ptp(points, axis=0) + 3.0 * swing
    height = 0.014 + rows * (0.007 + extent[1] / extent[0] * (PAGE - 0.014) / columns)
    shared = {"sharex": True, "sharey": True, "squeeze": False}
    figure, axes = new_figure(rows, columns, width=PAGE, height=height, **shared)
    for axis in axes.flat[count:]:
        axis.set_visible(False)
    for number, axis in enumerate(axes.flat[:count]):
        shape = along.displacement[number]
        step = shape * (swing / np.linalg.norm(shape, axis=1).max())
        axis.plot(points[:, 0], points[:, 1], color="0.75", linewidth=0.8)
        strong = PALETTE[1 if solved.coupled[number] else 2]
        for sign, style, colour, face in ((-1.0, (0, (4, 2)), "0.45", "white"), (1.0, "-", strong, strong)):
            place = points + sign * step
            axis.plot(place[:, 0], place[:, 1], color=colour, linestyle=style, linewidth=1.1)
            axis.plot(*place[ball, :2], "o", color=colour, markersize=4.5, markerfacecolor=face)
        kind = "" if solved.coupled[number] else ", uncoupled"
        words = f"mode {number + 1}: {solved.frequencies_hz[number]:.2f} Hz{kind}"
        axis.set_title(words, loc="left", pad=2.0, fontsize=8.0)
        axis.set_aspect("equal")
        axis.margins(0.05, 0.2)
    for axis in axes[:, 0]:
        label(axis.yaxis, "y", "mm")
    for axis in axes.flat[:count][-columns:]:
        label(axis.xaxis, "x", "mm")
        axis.tick_params(labelbottom=True)
    return figure
