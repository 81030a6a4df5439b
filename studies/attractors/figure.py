"""Figures of the settled motions: strobe points and exponents of a scan, and basins on the strobe plane.

The exponent of the flow is drawn as lyapunov_flow / f, on that of the map: one number by two routes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies import plotting
from studies.attractors.basins import Basins
from studies.attractors.kinds import CHAOTIC, NOT_SETTLED, PERIODIC, UNDECIDED, WITHOUT, Row
from studies.attractors.scan import TITLES, Start
from studies.plotting import BLUE, COLUMN, EXCESS, GUIDE, ORANGE, PAGE, SKY, VERMILION, tint

__all__ = ["draw_basins", "draw_scan"]

LOOKS = {
    WITHOUT: ("v", SKY), PERIODIC: ("o", BLUE), CHAOTIC: ("s", VERMILION), NOT_SETTLED: ("^", ORANGE),
    UNDECIDED: ("x", "0.5"),
}  # fmt: skip
"""Marker and colour of a kind."""

WAYS = {"down": (VERMILION, "none", 2.6), "up": (BLUE, BLUE, 1.4)}
"""Edge, face and size of a scan's points."""

PALE = 0.35
"""Share of the colour that is left where the motion is not periodic: its points are those of a moment."""


def mark(marker: str, colour: str, label: str, *, face: str = "none", size: float = 3.6) -> Line2D:
    """An entry of a legend."""
    return Line2D([], [], linestyle="none", marker=marker, markersize=size, markerfacecolor=face,
                  markeredgecolor=colour, label=label)  # fmt: skip


@plotting.in_house_style
def draw_scan(starts: Sequence[Start], rows: Sequence[Row], frequency: float, quantity: str) -> Figure:
    """Strobe points and exponents against the excess, a column for each model."""
    names = {key: name for key, name in TITLES.items() if any(row.model == key for row in rows)}
    figure, axes = plotting.new_figure(
        2, max(1, len(names)), width=PAGE if len(names) > 1 else COLUMN, height=0.112, squeeze=False,
        sharex="col",
    )  # fmt: skip
    periodic = {(row.model, row.direction, row.excess) for row in rows if row.period}
    for column, (name, title) in enumerate(names.items()):
        upper, lower = axes[:, column]
        for start in starts:
            if start.model == name:
                draw_points(upper, start, (name, start.direction, start.excess) in periodic)
        mine = [row for row in rows if row.model == name]
        lower.axhline(0.0, **GUIDE)
        for kind, (marker, colour) in LOOKS.items():
            alike = [(1e2 * row.excess, row.lyapunov_map) for row in mine if row.kind == kind]
            lower.plot(*np.array(alike).reshape(-1, 2).T, linestyle="none", marker=marker, markersize=3.4,
                       markerfacecolor="none", markeredgewidth=0.7, markeredgecolor=colour)  # fmt: skip
        lower.plot([1e2 * row.excess for row in mine], [row.lyapunov_flow / frequency for row in mine],
                   linestyle="none", marker=".", markersize=1.6, color="black", zorder=4)  # fmt: skip
        for axis in (upper, lower):
            axis.axvline(0.0, **GUIDE)
        plotting.panel(upper, column, f"{title}, {frequency:.2f} Hz")
        plotting.panel(lower, column + len(names))
        plotting.label(lower.xaxis, EXCESS, "%")
    unit = "mrad" if quantity == "rotation" else "mm"
    plotting.label(axes[0, 0].yaxis, quantity, unit)
    plotting.label(axes[1, 0].yaxis, "exponent per drive period")
    there = {row.kind for row in rows}
    figure.legend(
        handles=[
            *(mark("o", WAYS[way][0], f"{way}ward scan", face=WAYS[way][1]) for way in ("up", "down")),
            *(mark(*look, kind) for kind, look in LOOKS.items() if kind in there),
            mark(".", "black", "from two motions", face="black", size=3),
        ],
        loc="outside lower center", ncols=3 if len(names) > 1 else 2,
    )  # fmt: skip
    return figure


def draw_points(axis: Axes, start: Start, periodic: bool) -> None:
    """The strobe points at one amplitude, pale where they are those of a moment."""
    colour, face, size = WAYS[start.direction]
    edge = colour if periodic else tint(colour, PALE)
    axis.plot(
        np.full(start.points.size, 1e2 * start.excess), 1e3 * start.points, linestyle="none", marker="o",
        markersize=size, markeredgewidth=0.4, markeredgecolor=edge, rasterized=True,
        markerfacecolor=edge if face != "none" else "none", zorder=2 if start.direction == "down" else 3,
    )  # fmt: skip


@plotting.in_house_style
def draw_basins(planes: Sequence[Basins], frequency: float) -> Figure:
    """The strobe plane and a part of it, coloured by where the points lead."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.082)
    first = planes[0].plane
    gap, period = first.strobed.oscillator.stop.gap, first.period
    unit = np.array([gap, 2.0 * np.pi * frequency * gap])
    colours = {1: tint(SKY, 0.3), period: BLUE, 0: ORANGE}
    for number, (axis, found) in enumerate(zip(axes, planes, strict=True)):
        plane, picture = found.plane, np.full(found.leads.shape, np.nan)
        for place, code in enumerate(colours):
            picture[found.leads == code] = place
        x, y = plane.x / unit[0], plane.velocity / unit[1]
        axis.pcolormesh(x, y, picture, shading="nearest", vmin=-0.5, vmax=2.5, rasterized=True,
                        cmap=ListedColormap(list(colours.values())))  # fmt: skip
        axis.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        marks: dict[str, Any] = {"o": ("white", plane.orbit), "D": (VERMILION, np.array([plane.rest]))}
        for marker, (colour, places) in marks.items():
            axis.plot(*(places / unit).T, linestyle="none", marker=marker, markersize=4,
                      markerfacecolor=colour, markeredgecolor="black", markeredgewidth=0.7)  # fmt: skip
        where, share = ("the strobe plane", "around p$_1$")[number], found.parts()["p1 without impacts"]
        plotting.panel(axis, number, f"{where}: {100 * share:.1f} % lead to p$_1$")
        plotting.label(axis.xaxis, "$ξ$ / gap at the strobe")
    plotting.label(axes[0].yaxis, "$\\dot{ξ}$ / (2π f gap) at the strobe")
    names = {1: "to p$_1$ without impacts", period: f"to p$_{{{period}}}$", 0: "to something else"}
    handles = [
        mark("s", "0.4", names[code], face=colour, size=5) for code, colour in colours.items()
        if any(np.any(found.leads == code) for found in planes)
    ]  # fmt: skip
    handles += [mark("o", "black", f"points of p$_{{{period}}}$", face="white", size=4),
                mark("D", "black", "p$_1$", face=VERMILION, size=4)]  # fmt: skip
    figure.suptitle(f"Eq. (1), {frequency:.2f} Hz, $F/F_g - 1$ = {first.excess:g}", fontsize="medium")
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure
