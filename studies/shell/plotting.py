"""House style of the figures.

Drawn without a display and without global state, at the width of a journal's column or page, so that the
letters have their printed size. The colours are by Okabe and Ito (jfly.uni-koeln.de/color), which
colour-blind readers can distinguish; series differ in marker and line as well, so that a grey copy still
reads. The same data give the same bytes: neither format carries a date or a version.

    @in_house_style
    def draw(rows):
        figure, axes = new_figure(height=0.06)
        axes.plot(excess, tip, **series(0), label="upward scan")
        mark_letter(axes.xaxis, 0.013)
        label(axes.xaxis, EXCESS)
        label(axes.yaxis, "tip displacement", "mm")
        return figure

    run.figure("orbit_diagram", draw(rows), "caption")
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.shell.files import write_atomically
from studies.shell.options import style

COLUMN = 0.086
PAGE = 0.178
"""Widths of a journal's column and page [m]."""

SLIDE, LARGEST_SLIDE = 0.067, 0.1
"""Heights of a slide of 16:9 [m], the least and the greatest: the smaller, the larger its letters. One that
is shown a metre wide has letters of 24 mm to 16 mm."""

DOTS_PER_INCH = {"paper": 200, "slide": 400}
INCH = 0.0254

PALETTE = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
"""Black, blue, vermilion, green, purple, orange, sky blue, yellow; yellow last, it is weak on white."""
BLACK, BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, YELLOW = PALETTE

MARKERS = ("o", "s", "^", "D", "v", "x", "P", "*")
LINES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 2)), (0, (8, 2)))

NOTE = 7.0
"""Size of ticks, legends and notes inside a panel [pt]."""

EXCESS, HYSTERESIS = "excess $F/F_g - 1$", "hysteresis $1 - F_m/F_g$"
"""Names of the two quantities that most axes show."""

Look = Any  # a property of what matplotlib draws
Style = dict[str, Look]
Array = NDArray[np.float64]

UP: Style = {"color": BLUE, "markersize": 1.3, "zorder": 3}
DOWN: Style = {"color": VERMILION, "markerfacecolor": "none", "markersize": 2.6, "zorder": 2}
"""Strobe points while the amplitude is raised and lowered."""

GUIDE: Style = {"color": "0.6", "linewidth": 0.6, "linestyle": "--", "zorder": 0}
LETTER: Style = {"color": "0.25", "linewidth": 0.9, "linestyle": (0, (1, 1)), "zorder": 1}
LETTER_POINTS: Style = {"color": "black", "marker": "*", "markersize": 6.5, "linestyle": "none", "zorder": 6}
LETTER_POINTS |= {"markeredgecolor": "white", "markeredgewidth": 0.4}
"""Lines that lead the eye; a value that the letter prints; its points."""

STYLE: Any = {
    "font.family": "DejaVu Sans",
    **dict.fromkeys(("font.size", "axes.labelsize", "axes.titlesize", "figure.labelsize"), 8.0),
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize", "legend.title_fontsize"), NOTE),
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    **dict.fromkeys(("legend.frameon", "axes.spines.top", "axes.spines.right"), False),
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "axes.prop_cycle": cycler(color=PALETTE[1:]),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "pdf.fonttype": 42,
    "savefig.facecolor": "white",
}


def house_style() -> AbstractContextManager[None]:
    """Context in which titles, legends and texts that are added to a figure get the house style."""
    return matplotlib.rc_context(STYLE)


P = ParamSpec("P")
R = TypeVar("R")


def in_house_style(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorator of a function that draws: sizes of lines, marks and letters are set as they are made."""

    @wraps(draw)
    def styled(*arguments: P.args, **named: P.kwargs) -> R:
        with house_style():
            return draw(*arguments, **named)

    return styled


def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = COLUMN, height: float = 0.060, **subplots: Any
) -> tuple[Figure, Any]:
    """A figure of `width` by `height` [m] and its axes: one, or an array as from `Figure.subplots`.

    A slide has its own size; a large figure on paper is larger there, too.
    """
    if style.get() == "slide":
        height = min(max(SLIDE, 0.7 * height, 0.4 * width), LARGEST_SLIDE)
        width = height * 16.0 / 9.0
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width / INCH, height / INCH), layout="constrained")
        FigureCanvasAgg(figure)
        return figure, figure.subplots(rows, columns, **subplots)


def series(number: int) -> Style:
    """Colour, marker and line of the series with this number; distinct for the first eight."""
    if not 0 <= number < len(PALETTE):
        raise ValueError(f"the series of a figure are numbered 0 to {len(PALETTE) - 1}, not {number}")
    return {"color": PALETTE[number], "marker": MARKERS[number], "linestyle": LINES[number]}


def points(number: int) -> Style:
    """Like `series`, without a line."""
    return {**series(number), "linestyle": "none"}


def tint(colour: str, share: float) -> str:
    """The colour with so much of it left in white, for areas."""
    red, green, blue = (1.0 - share * (1.0 - part) for part in to_rgb(colour))
    return to_hex((red, green, blue))


def label(axis: Axis, quantity: str, unit: str = "1") -> None:
    """Name the quantity on an axis, its unit in brackets; "1", a pure number, is not written."""
    axis.set_label_text(quantity if unit == "1" else f"{quantity} ({unit})")


def panel(axes: Axes, number: int, words: str) -> None:
    """Letter of a panel, (a) for number 0, and what it shows."""
    axes.set_title(f"({chr(ord('a') + number)}) {words}", loc="left")


def legend_below(
    figure: Figure, axes: Iterable[Axes], columns: int, *, order: Sequence[str] = (), **looks: Any
) -> None:
    """One legend below all panels, each name once; names in `order` come first."""
    named: dict[str, Any] = {}
    for axis in axes:
        named |= dict(zip(*axis.get_legend_handles_labels()[::-1], strict=True))
    names = sorted(named, key=lambda name: (*order, name).index(name))
    marks = [named[name] for name in names]
    figure.legend(marks, names, loc="outside lower center", ncols=columns, **looks)


def mark_letter(axis: Axis, value: float, *, words: str = "letter", along: float = 0.99) -> None:
    """A value that the letter prints, as a line across the panel, and the words beside it.

    The words stand at `along` of the line, from 0 to 1, above it or right of an upright one.
    """
    axes, end = axis.axes, along > 0.5
    if isinstance(axis, XAxis):
        axes.axvline(value, **LETTER)
        place, offset, across = (value, along), (2.0, 0.0), axes.get_xaxis_transform()
        sides = ("left", "top" if end else "bottom")
    else:
        axes.axhline(value, **LETTER)
        place, offset, across = (along, value), (0.0, 2.0), axes.get_yaxis_transform()
        sides = ("right" if end else "left", "bottom")
    look: Style = {"ha": sides[0], "va": sides[1], "fontsize": NOTE, "color": LETTER["color"]}
    axes.annotate(words, place, xycoords=across, xytext=offset, textcoords="offset points", **look)


def save(figure: Figure, folder: Path, name: str) -> tuple[Path, Path]:
    """Write NAME.png and NAME.pdf into a folder; returns both paths."""
    paths, dots = (folder / f"{name}.png", folder / f"{name}.pdf"), DOTS_PER_INCH[style.get()]
    traces = ("Software",), ("Creator", "Producer", "CreationDate")
    with matplotlib.rc_context(STYLE):
        if layout := figure.get_layout_engine():  # once for both
            figure.set_dpi(dots)
            layout.execute(figure)
            figure.set_layout_engine(None)
        for path, names in zip(paths, traces, strict=True):
            stream, without = io.BytesIO(), dict.fromkeys(names)
            figure.savefig(stream, format=path.suffix[1:], dpi=dots, metadata=without)
            write_atomically(path, stream.getvalue())
    return paths
