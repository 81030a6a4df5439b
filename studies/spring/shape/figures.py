"""Figures of the readings of "U shaped": twist modes, and the flat U as a plate beside its beam.

A sheet at rest and in one mode is a net of points of its middle line, c = y n + z e_z from the centroid;
sections move as wholes,

    x = r(s) + c,      x + d + theta x c      [m],

d and theta of the mode scaled so that no point moves farther than a given part of the length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from beam.space import SpatialModes, channel_centroid
from studies.shell.plotting import (
    GUIDE,
    NOTE,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
    series,
)
from studies.spring.shape.model_error import PLATES, OrbitEnds, PlateMode
from studies.spring.shape.rows import ReadingRow
from studies.spring.shape.shapes import TITLES, Shape

Points = NDArray[np.float64]

BRASS = "#D8B24A"
"""Colour of the metal in the drawings."""

ACROSS = 5
"""Points across a strip or a web."""


def net_of(shape: Shape, modes: SpatialModes, mode: int, largest: float) -> tuple[Points, Points]:
    """Net at rest and moved [m], each (n_along, n_across, 3), the largest step `largest` times the length."""
    s, points, displacement, rotation = modes.along(1)
    _, n = shape.centreline.frame(s)
    z = np.linspace(-0.5 * shape.width, 0.5 * shape.width, ACROSS)
    across = np.stack([np.zeros_like(z), z], axis=1)
    if shape.reading == "side_by_side":
        across = across[:, ::-1]
    elif shape.reading == "channel":
        across[:, 0] = -channel_centroid(**shape.channel_sizes)
        edge = across[0, 0] + 0.5 * shape.thickness + shape.flange
        across = np.concatenate(([[edge, z[0]]], across, [[edge, z[-1]]]))
    arm = across[None, :, :1] * n[:, None, :] + across[None, :, 1:] * np.array([0.0, 0.0, 1.0])
    step = displacement[mode][:, None, :] + np.cross(rotation[mode][:, None, :], arm)
    step *= largest * shape.length / np.linalg.norm(step, axis=2).max()
    rest = points[:, None, :] + arm
    return rest, rest + step


@in_house_style
def draw_shapes(nets: Mapping[str, Points], rows: Sequence[ReadingRow]) -> Figure:
    """Each reading at rest (outline) and in its first twist mode."""
    figure, axes = new_figure(
        2, 2, width=PAGE, height=0.095, subplot_kw={"projection": "3d", "computed_zorder": False}
    )
    for number, (ax, row) in enumerate(zip(axes.flat, rows, strict=True)):
        rest, moved, ball = (
            standing(row.reading, nets[f"{row.reading}_{kind}"]) for kind in ("rest", "moved", "ball")
        )
        for edge in (rest[:, 0], rest[:, -1], rest[0], rest[-1]):
            ax.plot(*edge.T, color="0.6", linewidth=0.7, zorder=1)
        ax.plot_surface(
            *np.moveaxis(moved, -1, 0),
            color=BRASS,
            rcount=60,
            ccount=10,
            shade=False,
            edgecolor="0.35",
            linewidth=0.15,
            zorder=2,
        )
        ax.plot(
            *ball[:, None], marker="o", markersize=5.0, color=PALETTE[2], markeredgecolor="white", zorder=3
        )
        size = f"sheet {1e3 * row.thickness_m:.2f} mm"
        if row.flange_m:
            size += f", flanges {1e3 * row.flange_m:.2f} mm"
        found = f"twist {row.first_twist_hz:.0f} Hz, {row.ratio_twist:.1f} times the first bending"
        panel(ax, number, f"{TITLES[row.reading]}: {size}\n{found}")
        ax.set_title(ax.get_title(loc="left"), loc="left", x=-0.3)
        ax.set_proj_type("ortho")
        ax.view_init(elev=24.0, azim=-58.0)
        ax.set_box_aspect([np.ptp(span) for span in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())], zoom=2.5)
        ax.set_axis_off()
        for artist in (*ax.lines, *ax.collections):
            artist.set_clip_on(False)  # axes in space are square, springs are long and reach beyond them
            artist.set_in_layout(False)
    length = 1e3 * np.ptp(nets["plain_rest"][..., 0])
    figure.supxlabel(
        f"grey: outline at rest, {length:.0f} mm long; net: first twist mode, enlarged; dot: the ball; "
        "the left ends are clamped",
        fontsize=NOTE,
    )
    return figure


@in_house_style
def draw_plate(modes: Sequence[PlateMode], orbits: Sequence[OrbitEnds]) -> Figure:
    """Draw tip values against frequency, and the plates' orbit ends divided by the beam's."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.072)
    for number, (name, title) in enumerate({"beam": "beam", **PLATES}.items()):
        style = series(number) | ({} if name == "beam" else {"linestyle": "none"})
        own = [vars(row) for row in modes if vars(row).get(f"{name}_hz")]
        if own:
            left.plot(
                [row[f"{name}_hz"] for row in own],
                [row[f"tip_value_{name}"] for row in own],
                **style,
                label=title,
            )
        if name != "beam":
            ratios = [(vars(row)[name] or np.nan) / (row.beam or np.nan) for row in orbits]
            right.plot(ratios, **style, label=title)
    left.set_xscale("log")
    panel(left, 0, "symmetric modes")
    label(left.xaxis, "frequency", "Hz")
    label(left.yaxis, "tip value", "kg$^{-1/2}$")
    right.axhline(1.0, **GUIDE)
    right.set_xticks(range(len(orbits)), [f"p{row.period}\n{row.frequency_hz:.2f}" for row in orbits])
    panel(right, 1, "ends of the orbits on the way down")
    label(right.xaxis, "orbit, and drive frequency", "Hz")
    label(right.yaxis, "end of plate over end of beam")
    for ax in (left, right):
        ax.legend(loc="lower left")
    return figure


def standing(reading: str, points: Points) -> Points:
    """Points [mm] turned so that the ball meets the stop along y and flanges are in sight."""
    if reading == "side_by_side":
        return 1e3 * points[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    return 1e3 * points * [1.0, -1.0 if reading == "channel" else 1.0, 1.0]
