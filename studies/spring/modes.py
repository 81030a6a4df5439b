"""Natural modes of the spring: shapes, films, and share in an impact.

Claim: with legs side by side every bending mode moves the ball towards the stop. A folded strip has two kinds
of modes: sway modes do, breathing modes move the ball along the legs at most, and take no part in impacts.

    K x = omega^2 M x      for the elements of the strip, shapes of unit modal mass

Of each mode the impacts see the frequency f = omega/(2 pi) [Hz], the decay rate c [1/s], the tip value phi
[kg^(-1/2)] and the participation Gamma [kg^(1/2)] in a motion of the base.

Run:     python -m studies modes [--mode 3] [--frames 24] [--filmed 6]
Writes:  modes.csv (the table), modes.npz (shapes along the strip), modes.png; for ParaView modes.vtu (Warp By
         Vector, choose a mode) and motion.pvd with motion_frames (one period of one mode: press play);
         mode_1.gif ... (films of the lowest modes, --filmed of them)
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from beam import Modes, write_mode_motion, write_modes
from studies import letter
from studies.shell.digits import written
from studies.shell.film import MOST_FRAMES, write_film
from studies.shell.options import Within
from studies.shell.painter import Moment, Scenery, draw_rig, stage_of
from studies.shell.scene import Scene, SceneError, damping_of, free_period, model_of, modes_of
from studies.shell.scene.spring import size_in_words, spring_in_words
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FILMED, DRAWN = 6, 8  # modes with a film, and in the figure; lowest first

LARGEST = 0.05
"""Largest displacement of a drawn shape over the greatest extent of the strip; legs do not cross yet."""


@dataclass(frozen=True)
class NaturalMode:
    """One mode."""

    mode: Annotated[int, "mode"]
    frequency_hz: Annotated[float, "frequency [Hz]"]
    decay_rate_per_s: Annotated[float, "decay rate c [1/s]; amplitudes fall as exp(−c t/2)"]
    tip_value: Annotated[float, "tip value φ [kg^(-1/2)]"]
    participation: Annotated[float, "participation Γ in a motion of the base [kg^(1/2)]"]
    coupled: Annotated[bool, "takes part in impacts"]


@study(needs={"frequency 10": 1e-3}, quick={"filmed": 2})
def modes(
    scene: Scene,
    run: Run,
    *,
    mode: Annotated[int, "mode of motion.pvd, for ParaView"] = 1,
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
    run.table("modes", rows, "The natural modes of the spring, lowest first.", of=NaturalMode)
    run.finding(f"The lowest mode of the spring has a frequency of {written(rows[0].frequency_hz)} Hz.")
    every = "Every mode of the spring moves the ball towards the plate, so impacts excite all of them."
    some = "Some modes of the spring move the ball along the legs at most; impacts do not excite them."
    run.finding(every if all(row.coupled for row in rows) else some)
    if solved is None:
        run.say("measured modes have no shapes: nothing to draw or to look at in ParaView")
    else:
        write_shapes(scene, run, solved, mode - 1, frames)
        write_films(run, solved, scene.tip.ball_radius_m, min(filmed, len(rows)), frames)
        judge(scene, run)
    return {"rows": rows, "free_period_s": None if solved is None else free_period(scene)}


def rows_of(scene: Scene, solved: Modes | None) -> list[NaturalMode]:
    """The table; without shapes, of the modal data."""
    if solved is None:
        model = model_of(scene)
        coupled = (model.phi != 0.0) | (model.participation != 0.0)
        columns = (model.frequencies_hz, model.decay_rate, model.phi, model.participation, coupled)
    else:
        rates = damping_of(scene).decay_rates(solved)
        columns = (solved.frequencies_hz, rates, solved.phi, solved.participation, solved.coupled)
    return [
        NaturalMode(number, float(f), float(c), float(phi), float(gamma), bool(moves))
        for number, (f, c, phi, gamma, moves) in enumerate(zip(*columns, strict=True), start=1)
    ]


def largest_of(solved: Modes) -> float:
    """Largest displacement of a drawn shape [m]."""
    return LARGEST * float(np.ptp(solved.displacement_along(2).points, axis=0).max())


def write_shapes(scene: Scene, run: Run, solved: Modes, mode: int, frames: int) -> None:
    """Arrays, meshes and the figure."""
    from studies.shell.plotting import house_style, new_figure  # matplotlib is slow to import

    along, radius, largest = solved.displacement_along(2), scene.tip.ball_radius_m, largest_of(solved)
    run.arrays(
        "modes",
        "Shapes along the strip, of unit modal mass: arc_length_m, points_m at rest (x, y), displacement "
        "[kg^(-1/2)], rotation [kg^(-1/2) m^(-1)], frequencies_hz, whether impacts excite it, tip_at_m.",
        frequencies_hz=solved.frequencies_hz,
        coupled=solved.coupled,
        arc_length_m=along.s,
        points_m=along.points,
        displacement=along.displacement,
        rotation=along.rotation,
        tip_at_m=solved.discretization.spring.tip_at,
    )
    rates = np.nan_to_num(damping_of(scene).decay_rates(solved))
    meshes = run.path("modes.vtu", "The modes for ParaView: Warp By Vector.")
    write_modes(meshes, solved, decay_rates=rates, largest=largest, ball_radius=radius)
    motion = run.path("motion.pvd", f"One period of mode {mode + 1} for ParaView.")
    write_mode_motion(motion, solved, mode, frames=frames, largest=largest, ball_radius=radius)
    run.path("motion_frames", "Frames of motion.pvd: points of the spring [m].")
    words = f"The rig at rest, in true scale: {spring_in_words(scene)}, {size_in_words(scene)}."
    with house_style():
        figure, axes = new_figure(height=0.055)
        draw_rig(axes, scene, solved, [np.zeros(int(np.sum(solved.coupled)))])
        shapes = draw(solved)
    run.figure("rig", figure, words)
    caption = "Shapes of the lowest modes in the plane of the strip, enlarged to one largest displacement."
    run.figure("modes", shapes, caption)


def write_films(run: Run, solved: Modes, radius: float, count: int, frames: int) -> None:
    """One period of each of the first modes, in space, repeated without a seam."""
    largest = largest_of(solved)
    scenery = Scenery.of(solved, ball_radius=radius, amplitude=largest)
    stage = stage_of(scenery)
    for number in run.track(range(count), "films of modes"):
        shape = scenery.mesh.normalised(largest)[number]
        phases = 2.0 * math.pi * np.arange(frames) / frames
        name = f"mode {number + 1}: {solved.frequencies_hz[number]:.1f} Hz"
        displaced = [math.cos(phase) * shape for phase in phases]
        moments = [Moment(points=points, base=np.zeros(3), lines=[name]) for points in displaced]
        write_film(run, f"mode_{number + 1}", f"One period of {name}, enlarged.", stage, moments)


def judge(scene: Scene, run: Run) -> None:
    """Verdict on the free period: the thickness was fitted to it."""
    period, origin = free_period(scene), scene.provenance()["spring.thickness_m"]
    same = abs(period - letter.FREE_PERIOD_S) <= letter.FREE_PERIOD_ERROR_S
    verdict = "fitted" if same and origin == "calibrated" else "agrees" if same else "differs"
    run.verdict("free_period", verdict, found=f"{1e3 * period:.2f} ms")  # type: ignore[arg-type]


def draw(solved: Modes) -> Figure:
    """The first modes in the plane of the strip."""
    from studies.shell import plotting

    along = solved.displacement_along(2)
    points, count = 1e3 * along.points, min(DRAWN, solved.omega.size)
    ball = int(np.argmin(np.abs(along.s - solved.discretization.spring.tip_at)))
    largest, columns = 1e3 * largest_of(solved), min(2, count)
    rows, extent = math.ceil(count / columns), np.ptp(points, axis=0) + 3.0 * largest
    height = 0.022 + rows * (0.007 + extent[1] / extent[0] * (plotting.PAGE - 0.014) / columns)
    shared = {"sharex": True, "sharey": True, "squeeze": False}
    figure, axes = plotting.new_figure(rows, columns, width=plotting.PAGE, height=height, **shared)
    for axis in axes.flat[count:]:
        axis.set_visible(False)
    for number, axis in enumerate(axes.flat[:count]):
        shape = along.displacement[number]
        step = shape * (largest / np.linalg.norm(shape, axis=1).max())
        axis.plot(points[:, 0], points[:, 1], color="0.75", linewidth=0.8, label="at rest")
        colour = plotting.BLUE if solved.coupled[number] else plotting.VERMILION
        words = "mode that impacts excite" if solved.coupled[number] else "mode that impacts do not excite"
        look = {"color": colour, "linewidth": 1.1, "marker": "o", "markersize": 4.5, "markevery": [ball]}
        axis.plot(*(points + step)[:, :2].T, **look, label=f"{words}; circle: ball")
        look |= {"color": "0.45", "markerfacecolor": "white", "linestyle": (0, (4, 2))}
        axis.plot(*(points - step)[:, :2].T, **look, zorder=1.9, label="half a period later")
        plotting.panel(axis, number, f"mode {number + 1}: {solved.frequencies_hz[number]:.4g} Hz")
        axis.margins(0.05, 0.15)
    for axis in axes[:, 0]:
        plotting.label(axis.yaxis, "y", "mm")
    for axis in axes.flat[:count][-columns:]:
        plotting.label(axis.xaxis, "x", "mm")
        axis.tick_params(labelbottom=True)
    title = f"largest displacement drawn as {largest:.1f} mm"
    plotting.legend_below(figure, axes.flat[:count], 2, title=title)
    return figure
