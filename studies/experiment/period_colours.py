"""Periods as colours and numbers, in a plane or along a line.

Colours are the seven of the house style, one after the other with the period, lighter for 8 to 14, so that
neighbouring periods and period doublings always differ; every region that is large enough has its number.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from scipy import ndimage

from studies.shell import plotting

SEVEN = plotting.PALETTE[1:8]
PERIODS = ["white", *SEVEN, *(plotting.tint(one, 0.45) for one in SEVEN), "#A0785A"]
"""Colours of no impact, of the periods 1 to 14, and of a longer one."""

LAST = len(PERIODS) - 1  # place of the colour of all longer periods
NAMES = {m: f"p$_{{{m}}}$" for m in range(LAST)} | {LAST: f"{LAST} to 64"}
NONE, FAILED = "0.33", "red"

LEAST_WIDTH = 0.04  # part of a panel's sides that a region must have in any direction to be given its number


def paint(
    axis: Axes,
    x: np.ndarray,
    y: np.ndarray,
    period: np.ndarray,
    values: np.ndarray,
    *,
    colours: Sequence[str] = PERIODS,
    words: Callable[[int], str] = "p$_{{{}}}$".format,
    least: float = LEAST_WIDTH,
) -> None:
    """A plane in `colours` by `values`, shape (n_x, n_y), with the `words` of the value in large regions."""
    image = colours_of(period, values, colours)
    axis.pcolormesh(x, y, image.swapaxes(0, 1), shading="nearest", rasterized=True)
    outline, sides = [withStroke(linewidth=1.4, foreground="white")], [1.0 / count for count in period.shape]
    values = np.where(period > 0, values, 0)
    for value in np.unique(values[values > 0]):
        marks, _count = ndimage.label(values == value)
        sizes = np.bincount(marks.ravel())
        for mark in 1 + np.flatnonzero(sizes[1:] >= least**2 * values.size):
            depth = ndimage.distance_transform_edt(np.pad(marks == mark, 1), sampling=sides)[1:-1, 1:-1]
            i, j = np.unravel_index(int(np.argmax(depth)), depth.shape)
            if depth[i, j] - 0.5 * min(sides) >= 0.5 * least:
                axis.text(x[i], y[j], words(value), size=5.5, ha="center", va="center", path_effects=outline)


def colours_of(period: np.ndarray, values: np.ndarray, colours: Sequence[str] = PERIODS) -> np.ndarray:
    """The colours by `values`, the last one for all larger ones; a period of 0 is none, -1 a failure."""
    table = np.array([to_rgb(one) for one in (*colours, NONE, FAILED)])
    places = np.minimum(values, len(colours) - 1)
    found: np.ndarray = table[np.where(period < 0, -1, np.where(period == 0, -2, places))]
    return found


def key_of_periods(on: Axes | Figure, period: np.ndarray, struck: np.ndarray, **place: plotting.Look) -> None:
    """The colours of the periods that occur; `struck` is 0 without impacts, otherwise the period."""
    colours = {NAMES[m]: PERIODS[m] for m in np.unique(np.minimum(struck[struck > 0], LAST)).tolist()}
    key(on, "period m", colours, bool(np.any(period < 0)), **place)


def key(
    on: Axes | Figure, title: str, colours: Mapping[str, str], failed: bool, **place: plotting.Look
) -> None:
    """The colours of a row of panels, by default right of it; with what all rows have in common."""
    known = {**colours, "no impact": "white", "no period": NONE, **({"failed": FAILED} if failed else {})}
    marks = [Patch(facecolor=colour, edgecolor="0.3", linewidth=0.4) for colour in known.values()]
    usual = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5), "ncols": 2 if len(marks) > 9 else 1}
    on.legend(marks, list(known), title=title, handlelength=1.0, **(place or usual))
