"""The chart as a figure: upward scan left, downward scan right; period above, impacts in a period below.

Colours are the seven of the house style, one after the other with the period, lighter for 8 to 14, darker for
15 to 21, darker still to 28, so that neighbouring periods and period doublings always differ; every region of
some size says its number as well.  The upright axis is that of the grid (``cells.sheared``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from scipy import ndimage

from contact import Band
from studies.chart.cells import Cells, Fold, sheared
from studies.plotting import PAGE, PALETTE, house_style, label, new_figure, panel

__all__ = ["colour_of_impacts", "colour_of_period", "draw"]

Colour = tuple[float, float, float]

REST: Colour = (1.0, 1.0, 1.0)
NONE: Colour = (0.33, 0.33, 0.33)
FAILED: Colour = (0.0, 0.0, 0.0)
LONG: Colour = (0.66, 0.66, 0.66)
"""No impact; no period; failed; a period beyond 28."""

SHADES = (0.0, 0.55, -0.45, -0.7)
"""Lightening (above 0) or darkening of periods 1-7, 8-14, 15-21, 22-28."""

LEAST_AREA = 0.0012
"""Part of a panel that a region must have to be given its number."""

EDGE = 0.002
"""Half the height of the marks for band edges, which hold at grazing [excess]."""

TICKS = (-0.1, -0.03, -0.01, -0.003, 0.0, 0.003, 0.01, 0.03, 0.1)
COUNTS = (0, 1, 2, 3, 4, 6, 9)
"""Lower ends of the classes of impacts in a period."""


def colour_of_period(period: int, impacts: int) -> Colour:
    """The colour of a cell in the upper panels."""
    if period < 0:
        return FAILED
    if period == 0:
        return NONE
    if impacts == 0:
        return REST
    tier, place = divmod(period - 1, 7)
    if tier >= len(SHADES):
        return LONG
    shade, base = SHADES[tier], np.array(to_rgb(PALETTE[1 + place]))
    mixed = base + (1.0 - base) * shade if shade > 0 else base * (1.0 + shade)
    return (float(mixed[0]), float(mixed[1]), float(mixed[2]))


def _class(impacts: int) -> int:
    return int(np.searchsorted(COUNTS, impacts, side="right")) - 1


def colour_of_impacts(period: int, impacts: int) -> Colour:
    """The colour of a cell in the lower panels."""
    if period < 0:
        return FAILED
    if period == 0:
        return NONE
    if impacts == 0:
        return REST
    red, green, blue, _ = matplotlib.colormaps["cividis"](1.0 - (_class(impacts) - 1) / (len(COUNTS) - 2))
    return (red, green, blue)


def class_name(number: int) -> str:
    """ "3", "4-5" or "9 or more"."""
    low = COUNTS[number]
    if number + 1 == len(COUNTS):
        return f"{low} or more"
    high = COUNTS[number + 1] - 1
    return str(low) if low == high else f"{low}\u2013{high}"


def _image(period: np.ndarray, impacts: np.ndarray, colour: Callable[[int, int], Colour]) -> np.ndarray:
    """RGB over (excess, frequency)."""
    pairs, place = np.unique(np.stack([period.ravel(), impacts.ravel()]), axis=1, return_inverse=True)
    table = np.array([colour(int(p), int(i)) for p, i in pairs.T])
    return np.swapaxes(table[place.ravel()].reshape(*period.shape, 3), 0, 1)


def _write_numbers(
    axis: Axes, values: np.ndarray, x: np.ndarray, y: np.ndarray, text: Callable[[int], str]
) -> None:
    """Each region of one value says it, at its place farthest from its border."""
    taken: list[tuple[float, float]] = []
    wide, high = x[-1] - x[0], y[-1] - y[0]
    regions = []
    for value in np.unique(values):
        if value <= 0:
            continue
        marks, _count = ndimage.label(values == value)
        sizes = np.bincount(marks.ravel())
        for mark in np.flatnonzero(sizes >= LEAST_AREA * values.size):
            if mark:
                regions.append((int(sizes[mark]), int(value), marks == mark))
    for _size, value, inside in sorted(regions, key=lambda region: -region[0]):
        depth = ndimage.distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
        i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
        spot = ((x[i] - x[0]) / wide, (y[j] - y[0]) / high)
        if any(abs(spot[0] - a) < 0.035 and abs(spot[1] - b) < 0.04 for a, b in taken):
            continue
        taken.append(spot)
        axis.text(
            x[i], y[j], text(value), fontsize=5.5, ha="center", va="center", clip_on=True,
            path_effects=[withStroke(linewidth=1.4, foreground="white")],
        )  # fmt: skip


def draw(cells: Cells, edges: Sequence[Band], folds: Sequence[Fold], *, title: str) -> Figure:
    """The figure."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.150, sharex=True, sharey=True)
    x, y = cells.frequencies, sheared(cells.excesses)
    dx, dy = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    extent = (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)
    with house_style():
        for k, way in enumerate(("upward scan", "downward scan")):
            period, impacts = cells.period[k], cells.impacts[k]
            hit = np.where((period > 0) & (impacts > 0), period, 0)
            classes = np.where(period > 0, np.searchsorted(COUNTS, impacts, side="right") - 1, 0)
            above, below = axes[0, k], axes[1, k]
            for axis, colour in ((above, colour_of_period), (below, colour_of_impacts)):
                axis.imshow(
                    _image(period, impacts, colour), origin="lower", extent=extent, aspect="auto",
                    interpolation="nearest",
                )  # fmt: skip
                _draw_theory(axis, edges, folds, extent)
                failed = np.argwhere(period < 0)
                axis.plot(x[failed[:, 0]], y[failed[:, 1]], "x", color=PALETTE[2], markersize=3)
            _write_numbers(above, hit, x, y, lambda value: f"p$_{{{value}}}$")
            _write_numbers(below, classes, x, y, class_name)
            panel(above, k, f"{way}: period")
            panel(below, 2 + k, f"{way}: impacts in a period")
            label(below.xaxis, "drive frequency", "Hz")
        for axis in axes[:, 0]:
            ticks = [t for t in TICKS if cells.excesses[0] <= t <= cells.excesses[-1]]
            axis.set_yticks([float(sheared(t)) for t in ticks], [f"{t:g}" for t in ticks])
            label(axis.yaxis, "excess F/F$_g$ − 1")
        figure.legend(handles=_legend(cells, edges, folds), loc="outside lower center", ncols=5)
        figure.suptitle(title, fontsize=8)
    return figure


def _draw_theory(axis: Axes, edges: Sequence[Band], folds: Sequence[Fold], extent: tuple[float, ...]) -> None:
    grazing = float(sheared(0.0))
    axis.axhline(grazing, color="0.5", linewidth=0.4)
    around = [float(sheared(-EDGE)), float(sheared(EDGE))]
    for band in edges:
        axis.plot([band.upper] * 2, around, color="black", linewidth=0.7)
        axis.plot([band.lower] * 2, around, color="black", linewidth=0.7, linestyle=(0, (1.5, 1.0)))
    for period in sorted({fold.period for fold in folds}):
        curve = [fold for fold in folds if fold.period == period]
        f = np.array([fold.frequency_hz for fold in curve])
        excess = sheared([fold.excess for fold in curve])
        axis.plot(f, excess, color="white", linewidth=1.8)
        axis.plot(f, excess, color=PALETTE[2], linewidth=0.9)
    axis.set_xlim(extent[0], extent[1])
    axis.set_ylim(extent[2], extent[3])


def _legend(cells: Cells, edges: Sequence[Band], folds: Sequence[Fold]) -> list[Patch | Line2D]:
    def box(colour: Colour, name: str) -> Patch:
        return Patch(facecolor=colour, edgecolor="0.3", linewidth=0.4, label=name)

    handles: list[Patch | Line2D] = [box(REST, "p$_1$ without impact")]
    if np.any(cells.period == 0):
        handles.append(box(NONE, "no period found"))
    if np.any(cells.period > 7 * len(SHADES)):
        handles.append(box(LONG, f"period {7 * len(SHADES) + 1} to 64"))
    if folds:
        handles.append(Line2D([], [], color=PALETTE[2], linewidth=0.9, label="exact fold of p$_m$"))
    if edges:
        handles.append(Line2D([], [], color="black", linewidth=0.7, label="upper band edge, map"))
        dotted = (0, (1.5, 1.0))
        handles.append(
            Line2D([], [], color="black", linewidth=0.7, linestyle=dotted, label="lower band edge, map")
        )
    hit = cells.impacts[(cells.period > 0) & (cells.impacts > 0)]
    for number in sorted({_class(int(value)) for value in np.unique(hit)}):
        handles.append(box(colour_of_impacts(1, COUNTS[number]), f"impacts: {class_name(number)}"))
    if np.any(cells.period < 0):
        handles.append(
            Line2D([], [], color=PALETTE[2], marker="x", linestyle="none", markersize=3, label="failed")
        )
    return handles
