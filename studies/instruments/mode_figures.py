"""Pictures of mode shapes: in the plane of the strip, and as solids in space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from studies.instruments.motion.mode_film import ModeFilm
    from studies.instruments.motion.scene_bodies import Stage

DRAWN = 8
"""Modes in the figure, lowest first."""

LARGEST = 0.05
"""Largest displacement of a drawn shape over the greatest extent of the strip; legs do not cross yet."""


def draw(shapes: Mapping[str, Any], ball_radius: float) -> Any:
    """The first modes in the plane of the strip, from the stored arrays."""
    from studies.instruments.figures import PAGE, PALETTE, label, new_figure  # matplotlib is slow to import

    points, s = 1e3 * shapes["points_m"], shapes["arc_length_m"]
    frequencies, coupled = shapes["frequencies_hz"], shapes["coupled"]
    count = min(DRAWN, frequencies.size)
    extent = np.ptp(points[:, :2], axis=0)
    swing = LARGEST * extent.max()
    ball = int(np.argmin(np.abs(s - shapes["tip_at_m"])))
    margin = 1.2 * swing + 2e3 * ball_radius
    columns = min(2, count)
    rows = math.ceil(count / columns)
    tall = (extent[1] + 2.0 * margin) / (extent[0] + 2.0 * margin)
    height = 0.014 + rows * (0.007 + tall * (PAGE - 0.014) / columns)
    figure, axes = new_figure(
        rows, columns, width=PAGE, height=height, sharex=True, sharey=True, squeeze=False
    )
    for mode, ax in enumerate(axes.flat):
        if mode >= count:
            ax.set_visible(False)
            continue
        shape = shapes["displacement"][mode]
        step = shape * (swing / np.linalg.norm(shape, axis=1).max())
        ax.plot(points[:, 0], points[:, 1], color="0.75", linewidth=0.8)
        strong = PALETTE[1 if coupled[mode] else 2]
        for sign, style, colour in ((-1.0, (0, (4, 2)), "0.45"), (1.0, "-", strong)):
            place = points + sign * step
            ax.plot(place[:, 0], place[:, 1], color=colour, linestyle=style, linewidth=1.1)
            ax.plot(*place[ball, :2], marker="o", color=colour, markersize=4.5,
                    markerfacecolor=colour if sign > 0 else "white")
        kind = "" if coupled[mode] else ", uncoupled"
        ax.set_title(f"mode {mode + 1}: {frequencies[mode]:.2f} Hz{kind}", loc="left", pad=2.0, fontsize=8.0)
        ax.set_aspect("equal")
        ax.set_xlim(points[:, 0].min() - 0.3 * margin, points[:, 0].max() + margin)
        ax.set_ylim(points[:, 1].min() - margin, points[:, 1].max() + margin)
        if mode % columns == 0:
            label(ax.yaxis, "y", "mm")
        if mode + columns >= count:
            label(ax.xaxis, "x", "mm")
            ax.tick_params(labelbottom=True)
    figure.supxlabel(
        "grey: at rest; solid and dashed: half a period apart, enlarged; orange: the ball stays at y = 0"
        if not np.all(coupled[:count])
        else "grey: at rest; solid and dashed: half a period apart, enlarged",
        fontsize=7.0,
    )
    return figure


def draw_in_space(film: ModeFilm, stage: Stage) -> Any:
    """The modes of a film as solids, at their largest displacement."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from studies.instruments.figures import INCH, PAGE, house_style
    from studies.instruments.motion.marks import Place

    count, view = len(film.names), film.view
    columns = min(2, count)
    rows, wide = math.ceil(count / columns), PAGE / columns
    tall = wide * view.height / view.width
    head, foot = 0.005, 0.006
    height = foot + rows * (head + tall)
    figure = Figure(figsize=(PAGE / INCH, height / INCH), facecolor="white")
    FigureCanvasAgg(figure)
    with house_style():
        for mode, name in enumerate(film.names):
            row, column = divmod(mode, columns)
            bottom = height - (row + 1) * (head + tall)
            box = (column * wide / PAGE, bottom / height, wide / PAGE, tall / height)
            place = Place(figure, view, box)
            place.show(stage.picture(film.moment(mode, 0.0)))
            film.mark(place, 5.5)
            figure.text(box[0] + 0.01, box[1] + box[3], name, va="bottom", fontsize=8.0)
        words = "dashed: at rest; all modes drawn with the same largest displacement"
        figure.text(0.5, 0.3 * foot / height, words, ha="center", va="bottom", fontsize=7.0)
    return figure
