"""The chart as a figure: upward scan left, downward scan right; period above, impacts in a period below.

Colours are the seven of the house style, one after the other with the period, lighter for 8 to 14, darker for
15 to 21, darker still to 28, so that neighbouring periods and period doublings always differ; every region of
some size says its number as well.  The upright axis is that of the grid (``cells.sheared``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from scipy import ndimage

from contact import Band
from studies.experiment.chart.cells import Fold, Plane, sheared
from studies.shell.plotting import PAGE, PALETTE, house_style, label, new_figure, panel, tint

REST, NONE, FAILED, LONG = "white", "0.33", "black", "0.66"
"""No impact; no period; failed; a period beyond 28."""

LEAST_AREA = 0.0012
"""Part of a panel that a region must have to be given its number."""

EDGE = 0.002
"""Half the height of the marks for band edges, which hold at grazing [excess]."""

TICKS = (-0.1, -0.03, -0.01, -0.003, 0.0, 0.003, 0.01, 0.03, 0.1)

CLASSES = {1: "1", 2: "2", 3: "3", 4: "4\u20135", 6: "6\u20138", 9: "9 or more"}
"""Classes of impacts in a period: lower end and name."""

Integers = NDArray[np.int32]


def _darker(colour: str, share: float) -> str:
    red, green, blue = ((1.0 - share) * part for part in to_rgb(colour))
    return to_hex((red, green, blue))


PERIODS = [REST, *PALETTE[1:8], *(tint(one, 0.45) for one in PALETTE[1:8])]
PERIODS += [_darker(one, share) for share in (0.45, 0.7) for one in PALETTE[1:8]]
"""Colours of no impact and of the periods 1 to 28."""

IMPACTS = [REST, *map(to_hex, matplotlib.colormaps["cividis"](np.linspace(1.0, 0.0, len(CLASSES))))]


def _colours(table: Sequence[str], place: NDArray[np.int_], period: Integers) -> NDArray[np.float64]:
    """RGB of cells from their `place` in a table of colours."""
    colours = np.array([to_rgb(one) for one in (*table, NONE, FAILED)])
    return colours[np.where(period < 0, -1, np.where(period == 0, -2, place))]


def _write_numbers(
    axis: Axes, values: np.ndarray, x: np.ndarray, y: np.ndarray, text: Callable[[int], str]
) -> None:
    """Each region of one value says it, at its place farthest from its border; the largest first."""
    taken, regions = list[tuple[float, float]](), []
    for value in np.unique(values[values > 0]):
        marks, _count = ndimage.label(values == value)
        sizes = np.bincount(marks.ravel())
        large = 1 + np.flatnonzero(sizes[1:] >= LEAST_AREA * values.size)
        regions += [(int(sizes[mark]), int(value), marks == mark) for mark in large]
    for _size, value, inside in sorted(regions, key=lambda region: -region[0]):
        depth = ndimage.distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
        i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
        spot = (i / x.size, j / y.size)
        if any(abs(spot[0] - a) < 0.035 and abs(spot[1] - b) < 0.04 for a, b in taken):
            continue
        taken.append(spot)
        outline = [withStroke(linewidth=1.4, foreground="white")]
        axis.text(x[i], y[j], text(value), size=5.5, ha="center", va="center", path_effects=outline)


def draw(
    plane: Plane, cells: Mapping[str, Integers], edges: Sequence[Band], folds: Sequence[Fold], title: str
) -> Figure:
    """The figure."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.150, sharex=True, sharey=True)
    x, y = plane.frequencies(), sheared(plane.rising_excesses())
    dx, dy = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    extent = (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)
    names = list(CLASSES.values())
    with house_style():
        for k, way in enumerate(("upward scan", "downward scan")):
            period, impacts = cells["period"][k], cells["impacts"][k]
            classes = np.searchsorted(list(CLASSES), impacts, side="right")
            of_period = np.where(impacts == 0, 0, np.minimum(period, len(PERIODS)))
            images = (_colours([*PERIODS, LONG], of_period, period), _colours(IMPACTS, classes, period))
            for axis, image in zip(axes[:, k], images, strict=True):
                axis.imshow(
                    image.swapaxes(0, 1),
                    origin="lower",
                    extent=extent,
                    aspect="auto",
                    interpolation="nearest",
                )
                _draw_theory(axis, edges, folds)
                axis.set(xlim=extent[:2], ylim=extent[2:])
            hit = np.where((period > 0) & (impacts > 0), period, 0)
            _write_numbers(axes[0, k], hit, x, y, lambda value: f"p$_{{{value}}}$")
            _write_numbers(axes[1, k], np.where(hit, classes, 0), x, y, lambda n: names[n - 1])
            panel(axes[0, k], k, f"{way}: period")
            panel(axes[1, k], 2 + k, f"{way}: impacts in a period")
            label(axes[1, k].xaxis, "drive frequency", "Hz")
        for axis in axes[:, 0]:
            ticks = [t for t in TICKS if plane.excesses[0] <= t <= plane.excesses[1]]
            axis.set_yticks([float(sheared(t)) for t in ticks], [f"{t:g}" for t in ticks])
            label(axis.yaxis, "excess F/F$_g$ − 1")
        known = {
            "p$_1$ without impact": REST,
            "no period found": NONE,
            "period 29 to 64": LONG,
            "failed": FAILED,
        }
        known |= {f"impacts: {name}": colour for name, colour in zip(names, IMPACTS[1:], strict=True)}
        boxes = [Patch(fc=colour, ec="0.3", lw=0.4, label=name) for name, colour in known.items()]
        lines, _ = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles=[*boxes, *lines], loc="outside lower center", ncols=5)
        figure.suptitle(title, fontsize=8)
    return figure


def _draw_theory(axis: Axes, edges: Sequence[Band], folds: Sequence[Fold]) -> None:
    """Grazing, the band edges there, and the folds."""
    axis.axhline(0.0, color="0.5", linewidth=0.4)
    around = sheared([-EDGE, EDGE])
    for name, style in (("upper", "-"), ("lower", (0, (1.5, 1.0)))):
        told = f"{name} band edge, map"
        for band in edges:
            axis.plot([getattr(band, name)] * 2, around, color="black", lw=0.7, ls=style, label=told)
            told = ""
    told = "exact fold of p$_m$"
    for period in sorted({fold.period for fold in folds}):
        curve = [fold for fold in folds if fold.period == period]
        f, excess = [fold.frequency_hz for fold in curve], sheared([fold.excess for fold in curve])
        axis.plot(f, excess, color="white", linewidth=1.8)
        axis.plot(f, excess, color=PALETTE[2], linewidth=0.9, label=told)
        told = ""
