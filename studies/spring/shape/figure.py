"""Figures of the shape: twist modes of the readings, the flat U as a plate, and the periods that survive.

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

from beam.space import channel_centroid, spatial_modes
from studies.shell.plotting import (
    BLUE,
    GUIDE,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    legend_below,
    new_figure,
    panel,
    points,
    series,
    tint,
)
from studies.shell.scene import Scene
from studies.spring.shape.finite_amplitude import LEAVES, RADII, Survival
from studies.spring.shape.model_error import PLATES, OrbitEnds, PlateMode
from studies.spring.shape.shapes import MODES, TITLES, Reading, ReadingRow, Shape, kinds_of

Points = NDArray[np.float64]

SHAPES = (
    "First twist mode of four springs of one free period, enlarged; grey: outline at rest; dot: the ball; "
    "the left ends are clamped."
)
PLATE = "The flat U as a plate and as a beam: tip values of the symmetric modes, and the ends of the orbits."
SURVIVAL = (
    "How many of the letter's periods are born at 2.5e-4 and at 1e-3: of the folded strip with the scene's "
    "ball over bend radius and gap; of all springs against the shift of the frequency at the gap."
)

ACROSS = 5
"""Points across a strip or a web."""

LARGEST = 0.06
"""Largest step of a drawn mode over the length of the spring."""


def twisted(shape: Shape) -> tuple[Points, Points]:
    """Net at rest and in the first twist mode [m], each (n_along, n_across, 3)."""
    modes = spatial_modes(shape.spring(), MODES)
    mode = kinds_of(shape, modes).index("twist")
    s, centre, displacement, rotation = modes.along(1)
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
    step *= LARGEST * shape.length / np.linalg.norm(step, axis=2).max()
    rest = centre[:, None, :] + arm
    return rest, rest + step


@in_house_style
def draw_shapes(shapes: Mapping[Reading, Shape], rows: Mapping[Reading, ReadingRow]) -> Figure:
    """Each reading at rest (outline) and in its first twist mode."""
    flat = {"projection": "3d", "computed_zorder": False, "proj_type": "ortho"}
    figure, axes = new_figure(2, 2, width=PAGE, height=0.095, subplot_kw=flat)
    for number, (ax, (name, shape)) in enumerate(zip(axes.flat, shapes.items(), strict=True)):
        ball = shape.centreline.points(np.array(shape.tip_at))
        rest, moved, ball = (standing(name, net) for net in (*twisted(shape), ball))
        for edge in (rest[:, 0], rest[:, -1], rest[0], rest[-1]):
            ax.plot(*edge.T, color="0.6", linewidth=0.7, zorder=1)
        ax.plot_surface(*np.moveaxis(moved, -1, 0), color=PALETTE[5], rcount=60, ccount=10, zorder=2)
        ax.plot(*ball[:, None], marker="o", markersize=5.0, color=PALETTE[2], zorder=3)
        panel(ax, number, f"{TITLES[name]}: twist {rows[name].ratio_twist:.1f} times the first bending")
        ax.set_title(ax.get_title(loc="left"), loc="left", x=-0.3)
        ax.view_init(elev=24.0, azim=-58.0)
        ax.set_box_aspect([np.ptp(span) for span in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())], zoom=2.5)
        ax.set_axis_off()
        for artist in (*ax.lines, *ax.collections):
            artist.set_clip_on(False)  # axes in space are square, springs are long and reach beyond them
            artist.set_in_layout(False)
    return figure


def standing(reading: Reading, net: Points) -> Points:
    """Points [mm] turned so that the ball meets the stop along y and flanges are in sight."""
    if reading == "side_by_side":
        return 1e3 * net[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    return 1e3 * net * [1.0, -1.0 if reading == "channel" else 1.0, 1.0]


@in_house_style
def draw_plate(modes: Sequence[PlateMode], orbits: Sequence[OrbitEnds]) -> Figure:
    """Draw tip values against frequency, and the plates' orbit ends divided by the beam's."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.072)
    for number, name in enumerate(("beam", "point", "seat")):
        known = [(getattr(row, f"{name}_hz"), getattr(row, f"tip_value_{name}")) for row in modes]
        style = series(number) | ({} if name == "beam" else {"linestyle": "none"})
        left.plot(
            *zip(*(pair for pair in known if pair[0]), strict=True), **style, label=PLATES.get(name, name)
        )
    for number, (name, title) in enumerate(PLATES.items(), start=1):
        ratios = [(getattr(row, name) or np.nan) / (row.beam or np.nan) for row in orbits]
        right.plot(ratios, **points(number), label=title)
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


@in_house_style
def draw_survival(scene: Scene, rows: Sequence[Survival]) -> Figure:
    """Periods that survive: of the folded strip over bend radius and gap, of all against the shift."""
    figure, (chart, axis) = new_figure(1, 2, width=PAGE)
    for row in rows:
        if row.reading == "folded" and row.tip_mass_kg == scene.tip.mass_kg:
            place = 1e3 * row.bend_radius_m, 1e3 * row.gap_m
            chart.scatter(*place, s=120, color=tint(BLUE, row.survive / 6))
            chart.annotate(str(row.survive), place, ha="center", va="center")
    chart.set_xscale("log")
    ticks = [1e3 * radius for radius in (RADII[0], 7.5e-3, 15e-3, 25e-3, RADII[-1])]
    chart.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    chart.set_xticks([], minor=True)
    chart.margins(0.08, 0.12)
    label(chart.xaxis, "bend radius", "mm")
    label(chart.yaxis, "gap", "mm")
    for n, reading in enumerate(("folded", *LEAVES)):
        own = [row for row in rows if row.reading == reading]
        shift, survive = [abs(row.shift) for row in own], [row.survive for row in own]
        axis.plot(shift, survive, **points(n), label=reading.replace("_", " "))
    axis.set_xscale("log")
    label(axis.xaxis, "|kappa| (gap/L)^2")
    label(axis.yaxis, "letter's periods born at both")
    legend_below(figure, [axis], 4)
    return figure
