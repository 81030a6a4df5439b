"""Figures of the readings of "U shaped": twist modes, errors of strip theory, channels.

A sheet at rest and in one mode is a net of points of its middle line, c = y n + z e_z from the centroid;
sections move as wholes,

    x = r(s) + c,      x + d + theta x c      [m],

d and theta of the mode scaled so that no point moves farther than a given part of the length.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from beam.space import SpatialModes, channel_centroid
from studies.plotting import GUIDE, NOTE, PAGE, PALETTE, in_house_style, label, new_figure, panel, series
from studies.spring_shape.rows import ErrorRow, ReadingRow
from studies.spring_shape.shapes import READINGS, TITLES, Shape

Points = NDArray[np.float64]

TURN, TILT = math.radians(-58.0), math.radians(24.0)
"""The drawings are seen from the side of the ball, so far round z, and so far from above."""

SCALE = 0.02
"""Length of the bar in the drawings [m]."""

BRASS = "#D8B24A"
"""Colour of the metal in the drawings."""

COLOURS = {"bending": 1, "breathing": 4, "lengthwise": 5, "sideways": 3, "twist": 2}
"""Series of each kind of mode."""


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
    """Each reading at rest (outline) and in its first twist mode, in parallel projection."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.118)
    for number, (ax, reading, row) in enumerate(zip(axes.flat, READINGS, rows, strict=True)):
        rest, moved = (_standing(reading, nets[f"{reading}_{kind}"]) for kind in ("rest", "moved"))
        for edge in (rest[:, 0], rest[:, -1], rest[0], rest[-1]):
            ax.plot(*_seen(edge)[0].T, color="0.6", linewidth=0.7, zorder=1)
        corners = np.stack([moved[:-1, :-1], moved[1:, :-1], moved[1:, 1:], moved[:-1, 1:]], axis=2)
        quads = corners.reshape(-1, 4, 3)
        flat, depth = _seen(quads)
        order = np.argsort(depth.mean(axis=1))
        normal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
        lit = np.abs(normal @ np.array([0.35, 0.55, 0.75])) / np.linalg.norm(normal, axis=1)
        brass = np.array(to_rgb(BRASS))
        faces = np.clip((0.45 + 0.55 * lit[:, None]) * brass, 0.0, 1.0)
        ax.add_collection(
            PolyCollection(
                list(flat[order]),
                facecolors=faces[order],
                edgecolors=faces[order],
                linewidths=0.3,
                zorder=2,
            )
        )
        ball = _seen(_standing(reading, nets[f"{reading}_ball"]))[0]
        ax.plot(*ball, marker="o", markersize=5.0, color=PALETTE[2], markeredgecolor="white", zorder=3)
        seen = _seen(np.concatenate([rest, moved]).reshape(-1, 3))[0]
        low = seen.min(axis=0)
        bar = np.array([[low[0], low[1]], [low[0] + 1e3 * SCALE, low[1]]])
        ax.plot(*bar.T, color="black", linewidth=1.4)
        ax.annotate(
            f"{1e3 * SCALE:.0f} mm",
            bar.mean(axis=0),
            xytext=(0.0, 3.0),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=NOTE,
        )
        size = f"sheet {1e3 * row.thickness_m:.2f} mm"
        if row.flange_m:
            size += f", flanges {1e3 * row.flange_m:.2f} mm"
        found = f"twist {row.first_twist_hz:.0f} Hz, {row.ratio_twist:.1f} times the first bending"
        panel(ax, number, f"{TITLES[reading]}: {size}\n{found}")
        ax.set_aspect("equal")
        ax.margins(0.04)
        ax.axis("off")
    figure.supxlabel(
        "grey: outline at rest; solid: first twist mode, enlarged; dot: the ball; the left ends are clamped",
        fontsize=NOTE,
    )
    return figure


@in_house_style
def draw_errors(rows: Sequence[ErrorRow]) -> Figure:
    """Error of strip theory against frequency, each mode with its number in its family."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.072, sharey=True)
    for place, (ax, reading) in enumerate(zip(axes, ("folded", "plain"), strict=True)):
        ax.axhline(0.0, **GUIDE)
        own = [row for row in rows if row.reading == reading]
        for kind, number in COLOURS.items():
            chosen = [row for row in own if row.kind == kind]
            if not chosen:
                continue
            f, error = [row.solid_hz for row in chosen], [100.0 * row.error for row in chosen]
            bars = [100.0 * abs(row.mesh_change) for row in chosen]
            ax.errorbar(f, error, yerr=bars, **series(number), linewidth=0.8, capsize=1.5, label=kind)
            for row, x, y in zip(chosen, f, error, strict=True):
                ax.annotate(
                    str(row.number), (x, y), xytext=(2.5, 3.0), textcoords="offset points", fontsize=NOTE
                )
        if reading == "folded":
            bent = [row for row in own if row.family == "in plane"]
            ax.plot([row.solid_hz for row in bent], [100.0 * row.error_bend_as_plate for row in bent],
                    color="0.45", marker=".", linestyle=":", lw=0.8, label="bend as plate")  # fmt: skip
        ax.set_xscale("log")
        panel(ax, place, f"{TITLES[reading]}; numbers: modes in and out of the plane")
        label(ax.xaxis, "frequency of the solid", "Hz")
        ax.legend(loc="upper left")
    label(axes[0].yaxis, "error of strip theory in frequency", "%")
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(low, high + 0.30 * (high - low))
    return figure


@in_house_style
def draw_channels(rows: Sequence[ReadingRow], others: Mapping[str, float]) -> Figure:
    """Flange and lowest modes out of the plane of channels against the sheet; ratios of other readings."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.060)
    sheet = [1e3 * row.thickness_m for row in rows]
    left.plot(sheet, [1e3 * row.flange_m for row in rows], **series(0))
    left.plot(sheet, [2.0 * t for t in sheet], color="0.6", linestyle=":", linewidth=0.8)
    left.annotate("twice the sheet", (sheet[-1], 2.0 * sheet[-1]), xytext=(-10.0, 2.0),
                  textcoords="offset points", fontsize=NOTE, color="0.4", ha="right")  # fmt: skip
    label(left.yaxis, "flange needed", "mm")
    right.plot(sheet, [row.ratio for row in rows], **series(0), label="lowest out of the plane")
    right.plot(sheet, [row.ratio_twist for row in rows], **series(1), label="first mode named twist")
    for (name, value), number in zip(others.items(), (2, 3, 4), strict=True):
        right.axhline(value, color=PALETTE[number], linestyle=series(number)["linestyle"], linewidth=0.9)
        right.annotate(f"{TITLES[name]}, twist", (sheet[-1], value), xytext=(0.0, 2.0), ha="right",
                       textcoords="offset points", fontsize=NOTE, color=PALETTE[number])  # fmt: skip
    label(right.yaxis, "twist / first bending frequency")
    right.legend(loc="lower right")
    for place, ax in enumerate((left, right)):
        panel(ax, place)
        label(ax.xaxis, "sheet of the channel", "mm")
        ax.set_ylim(bottom=0.0)
    return figure


def _standing(reading: str, points: Points) -> Points:
    """Points [mm] turned so that the ball meets the stop along y and flanges are in sight."""
    if reading == "side_by_side":
        return 1e3 * points[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    return 1e3 * points * [1.0, -1.0 if reading == "channel" else 1.0, 1.0]


def _seen(points: Points) -> tuple[Points, Points]:
    """Places on the page, and nearness to the eye."""
    x, y, z = np.moveaxis(points, -1, 0)
    right = -math.sin(TURN) * x + math.cos(TURN) * y
    away = math.cos(TURN) * x + math.sin(TURN) * y
    up = math.cos(TILT) * z - math.sin(TILT) * away
    return np.stack([right, up], axis=-1), math.cos(TILT) * away + math.sin(TILT) * z
