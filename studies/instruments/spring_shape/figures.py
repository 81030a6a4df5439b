"""Figures of the readings of "U shaped": twist modes, errors of strip theory, channels, clamped widths."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.instruments.figures import (
    GUIDE,
    LINES,
    MARKERS,
    NOTE,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
)
from studies.instruments.spring_shape.readings import READINGS, TITLES

TURN, TILT = math.radians(-58.0), math.radians(24.0)
"""The drawings are seen from the side of the ball, so far round z, and so far from above."""

SCALE = 0.02
"""Length of the bar in the drawings [m]."""

BRASS = "#D8B24A"
"""Colour of the metal in the drawings."""

COLOURS = {"bending": 1, "breathing": 4, "lengthwise": 5, "sideways": 3, "twist": 2}
"""Series of each kind of mode."""


@in_house_style
def draw_shapes(nets: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> Any:
    """Each reading at rest (outline) and in its first twist mode, in parallel projection."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    figure, axes = new_figure(2, 2, width=PAGE, height=0.118)
    for number, (ax, reading, row) in enumerate(zip(axes.flat, READINGS, rows, strict=True)):
        rest, moved = (_standing(reading, nets[f"{reading}_{kind}"]) for kind in ("rest", "moved"))
        for edge in (rest[:, 0], rest[:, -1], rest[0], rest[-1]):
            ax.plot(*_seen(edge)[0].T, color="0.6", linewidth=0.7, zorder=1, gid="outline at rest")
        corners = np.stack([moved[:-1, :-1], moved[1:, :-1], moved[1:, 1:], moved[:-1, 1:]], axis=2)
        quads = corners.reshape(-1, 4, 3)
        flat, depth = _seen(quads)
        order = np.argsort(depth.mean(axis=1))
        normal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
        lit = np.abs(normal @ np.array([0.35, 0.55, 0.75])) / np.linalg.norm(normal, axis=1)
        brass = np.array(to_rgb(BRASS))
        faces = np.clip((0.45 + 0.55 * lit[:, None]) * brass, 0.0, 1.0)
        ax.add_collection(PolyCollection(
            list(flat[order]), facecolors=faces[order], edgecolors=faces[order], linewidths=0.3, zorder=2,
            gid="first twist mode",
        ))
        ball = _seen(_standing(reading, nets[f"{reading}_ball"]))[0]
        ax.plot(*ball, marker="o", markersize=5.0, color=PALETTE[2], markeredgecolor="white", zorder=3,
                gid="ball")
        seen = _seen(np.concatenate([rest, moved]).reshape(-1, 3))[0]
        low = seen.min(axis=0)
        bar = np.array([[low[0], low[1]], [low[0] + 1e3 * SCALE, low[1]]])
        ax.plot(*bar.T, color="black", linewidth=1.4, gid=f"{1e3 * SCALE:.0f} mm")
        ax.annotate(f"{1e3 * SCALE:.0f} mm", bar.mean(axis=0), xytext=(0.0, 3.0), textcoords="offset points",
                    ha="center", va="bottom", fontsize=NOTE)
        size = f"sheet {1e3 * row['thickness_m']:.2f} mm"
        if row["flange_m"]:
            size += f", flanges {1e3 * row['flange_m']:.2f} mm"
        found = f"twist {row['first_twist_hz']:.0f} Hz, {row['ratio_twist']:.1f} times the first bending"
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
def draw_errors(rows: Mapping[str, Sequence[Any]]) -> Any:
    """Error of strip theory against frequency, each mode with its number in its family."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.072, sharey=True)
    table = {key: np.asarray(column) for key, column in rows.items()}
    for place, (ax, reading) in enumerate(zip(axes, ("folded", "plain"), strict=True)):
        ax.axhline(0.0, **GUIDE, gid="no error")
        for kind, number in COLOURS.items():
            chosen = (table["reading"] == reading) & (table["kind"] == kind)
            if not chosen.any():
                continue
            f, error = table["solid_hz"][chosen], 100.0 * table["error"][chosen]
            bar = 100.0 * np.abs(table["mesh_change"][chosen])
            ax.errorbar(f, error, yerr=bar, color=PALETTE[number], marker=MARKERS[number],
                        linestyle=LINES[number], linewidth=0.8, capsize=1.5, label=kind)
            for x, y, name in zip(f, error, table["number"][chosen], strict=True):
                ax.annotate(str(name), (x, y), xytext=(2.5, 3.0), textcoords="offset points", fontsize=NOTE)
        bent = (table["reading"] == reading) & (table["family"] == "in plane")
        as_plate = 100.0 * table["error_bend_as_plate"][bent]
        if np.abs(as_plate - 100.0 * table["error"][bent]).max() > 1e-6:
            ax.plot(table["solid_hz"][bent], as_plate, color="0.45", marker=".", linestyle=":", linewidth=0.8,
                    label="in plane, bend as a plate")
        ax.set_xscale("log")
        panel(ax, place, f"{TITLES[reading]}; numbers: modes in and out of the plane")
        label(ax.xaxis, "frequency of the solid", "Hz")
        ax.legend(loc="upper left")
    label(axes[0].yaxis, "error of strip theory in frequency", "%")
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(low, high + 0.30 * (high - low))
    return figure


@in_house_style
def draw_channels(rows: Mapping[str, Sequence[float]], others: Mapping[str, float]) -> Any:
    """Flange and lowest torsional or sideways frequency of channels against the thickness of their sheet."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.060)
    sheet = 1e3 * np.asarray(rows["thickness_m"])
    left.plot(sheet, 1e3 * np.asarray(rows["flange_m"]), color=PALETTE[0], marker=MARKERS[0], gid="flange")
    left.plot(sheet, 2.0 * sheet, color="0.6", linestyle=":", linewidth=0.8, gid="twice the sheet")
    left.annotate("twice the sheet", (sheet[-1], 2.0 * sheet[-1]), xytext=(-10.0, 2.0),
                  textcoords="offset points", fontsize=NOTE, color="0.4", ha="right")
    label(left.yaxis, "flange needed", "mm")
    right.plot(sheet, rows["ratio"], color=PALETTE[0], marker=MARKERS[0], label="lowest out of the plane")
    right.plot(sheet, rows["ratio_twist"], color=PALETTE[1], marker=MARKERS[1], linestyle=LINES[1],
               label="first mode named twist")
    for (name, value), number in zip(others.items(), (2, 3, 4), strict=False):
        right.axhline(value, color=PALETTE[number], linestyle=LINES[number], linewidth=0.9,
                      gid=f"{TITLES[name]}, twist")
        right.annotate(f"{TITLES[name]}, twist", (sheet[-1], value), xytext=(0.0, 2.0), ha="right",
                       textcoords="offset points", fontsize=NOTE, color=PALETTE[number])
    label(right.yaxis, "twist / first bending frequency")
    right.legend(loc="lower right")
    for place, ax in enumerate((left, right)):
        panel(ax, place)
        label(ax.xaxis, "sheet of the channel", "mm")
        ax.set_ylim(bottom=0.0)
    return figure


@in_house_style
def draw_widths(rows: Mapping[str, Sequence[float]], limit: float) -> Any:
    """Stiffness of the clamped strip beyond strip theory, against its width over its length."""
    figure, ax = new_figure()
    ax.plot(rows["width_over_length"], 100.0 * np.asarray(rows["stiffness_excess"]), color=PALETTE[0],
            marker=MARKERS[0], gid="clamped strip")
    ax.axhline(100.0 * limit, color=PALETTE[2], linestyle="--", linewidth=0.9, gid="plate")
    ax.annotate("plate, 1/(1 - ν²)", (rows["width_over_length"][0], 100.0 * limit), xytext=(0.0, -3.0),
                textcoords="offset points", va="top", fontsize=NOTE, color=PALETTE[2])
    label(ax.xaxis, "width over length")
    label(ax.yaxis, "stiffness beyond 3 EI/L³", "%")
    ax.set_ylim(bottom=0.0)
    return figure


def _standing(reading: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points [mm] turned so that the ball meets the stop along y and flanges are in sight."""
    if reading == "side_by_side":
        return 1e3 * points[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    return 1e3 * points * [1.0, -1.0 if reading == "channel" else 1.0, 1.0]


def _seen(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places on the page, and nearness to the eye."""
    x, y, z = np.moveaxis(points, -1, 0)
    right = -math.sin(TURN) * x + math.cos(TURN) * y
    away = math.cos(TURN) * x + math.sin(TURN) * y
    up = math.cos(TILT) * z - math.sin(TILT) * away
    return np.stack([right, up], axis=-1), math.cos(TILT) * away + math.sin(TILT) * z
