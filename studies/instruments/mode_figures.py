"""Pictures of mode shapes: in the plane of the strip, and as solids in space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studies.instruments.off_screen import prepare_off_screen

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


def draw_in_space(mesh_file: Path, names: Sequence[str], picture: Path) -> None:
    """The first modes as solids, from the mesh that was written."""
    prepare_off_screen()
    import pyvista

    rows = math.ceil(len(names) / 2)
    grid: Any = pyvista.read(mesh_file)
    size = [1600, 330 * rows]
    plotter: Any = pyvista.Plotter(off_screen=True, shape=(rows, 2), window_size=size, border=False)
    colours = ["#D8B24A", "#505050", "#F2F2F2"]  # brass, tape, ceramic
    at_rest = grid.extract_cells(np.flatnonzero(grid.cell_data["part"] != 2))
    for number, name in enumerate(names):
        plotter.subplot(number // 2, number % 2)
        _, ordinal, frequency = name.split("_")
        title = f"mode {int(ordinal)}: {frequency.removesuffix('Hz')} Hz"
        plotter.add_text(title, font_size=11, color="black")
        plotter.add_mesh(at_rest, color="lightgrey", opacity=0.2)
        warped = grid.warp_by_vector(name)
        for part, colour in enumerate(colours):
            body = warped.extract_cells(np.flatnonzero(warped.cell_data["part"] == part))
            if body.n_cells:
                plotter.add_mesh(body, color=colour, ambient=0.35, smooth_shading=part == 2)
        plotter.set_background("white")
        plotter.camera_position = [(0.25, -0.35, 0.30), (0.07, 0.0, 0.0), (0.0, 0.0, 1.0)]
        plotter.reset_camera()
        plotter.camera.zoom(1.9)
    plotter.screenshot(str(picture))
    plotter.close()
