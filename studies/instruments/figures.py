"""House style of the figures.

Drawn without a display and without global state, at the width of a journal's column or page, so that the
letters have their printed size. Colours are those of Okabe and Ito (jfly.uni-koeln.de/color), which
colour-blind readers can tell apart; series differ in marker and line as well, so that a grey copy still
reads. The same data give the same bytes: neither format carries a date or a version.

    figure, axes = new_figure(height=0.06)
    axes.plot(excess, tip, **series(0), label="upward scan")
    label(axes.xaxis, "excess", "1")
    label(axes.yaxis, "tip displacement", "mm")
    save(figure, folder, "orbit_diagram")
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from studies.instruments.atomic_file import write_atomically

COLUMN = 0.086
PAGE = 0.178
"""Widths of a journal's column and page [m]."""

DOTS_PER_INCH = 200
INCH = 0.0254

PALETTE = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
"""Black, blue, vermilion, green, purple, orange, sky blue, yellow; yellow last, it is weak on white."""

MARKERS = ("o", "s", "^", "D", "v", "x", "P", "*")
LINES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 2)), (0, (8, 2)))

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "figure.labelsize": 8.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "pdf.fonttype": 42,
    "savefig.facecolor": "white",
}


def house_style() -> Any:
    """Context in which titles, legends and texts that are added to a figure get the house style."""
    return matplotlib.rc_context(STYLE)


def new_figure(
    rows: int = 1, columns: int = 1, *, width: float = COLUMN, height: float = 0.060, **subplots: Any
) -> tuple[Figure, Any]:
    """A figure of `width` by `height` [m] and its axes: one, or an array as from `Figure.subplots`."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width / INCH, height / INCH), layout="constrained")
        FigureCanvasAgg(figure)
        return figure, figure.subplots(rows, columns, **subplots)


def series(number: int) -> dict[str, Any]:
    """Colour, marker and line of the series with this number; distinct for the first eight."""
    if not 0 <= number < len(PALETTE):
        raise ValueError(f"the series of a figure are numbered 0 to {len(PALETTE) - 1}, not {number}")
    return {"color": PALETTE[number], "marker": MARKERS[number], "linestyle": LINES[number]}


def points(number: int) -> dict[str, Any]:
    """Like `series`, without a line."""
    return {**series(number), "linestyle": "none"}


def label(axis: Axis, quantity: str, unit: str = "1") -> None:
    """Name the quantity on an axis, its unit in brackets; "1", a pure number, is not written."""
    axis.set_label_text(quantity if unit == "1" else f"{quantity} ({unit})")


def save(figure: Figure, folder: Path, name: str) -> tuple[Path, Path]:
    """Write NAME.png and NAME.pdf into a folder; returns both paths."""
    paths = (folder / f"{name}.png", folder / f"{name}.pdf")
    without_traces: tuple[dict[str, None], ...] = (
        {"Software": None},
        {"Creator": None, "Producer": None, "CreationDate": None},
    )
    with matplotlib.rc_context(STYLE):
        for path, metadata in zip(paths, without_traces, strict=True):
            stream = io.BytesIO()
            figure.savefig(stream, format=path.suffix[1:], dpi=DOTS_PER_INCH, metadata=metadata)
            write_atomically(path, stream.getvalue())
    return paths
