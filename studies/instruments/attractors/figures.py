"""Figures of the settled motions: strobe points and exponents of a scan, and basins on the strobe plane.

The exponent of the flow is drawn as lyapunov_flow / f, on that of the map: one number by two routes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D

from studies.instruments.attractors.basins import Basins
from studies.instruments.attractors.kinds import CHAOTIC, NOT_SETTLED, PERIODIC, UNDECIDED, WITHOUT
from studies.instruments.attractors.scan import TITLES, Start
from studies.instruments.figures import (
    BLUE,
    COLUMN,
    EXCESS,
    GUIDE,
    ORANGE,
    PAGE,
    SKY,
    STYLE,
    VERMILION,
    in_house_style,
    label,
    new_figure,
    panel,
    tint,
)

__all__ = ["SHAPES", "draw_basins", "draw_scan"]

COLOURS = {
    WITHOUT: SKY,
    PERIODIC: BLUE,
    CHAOTIC: VERMILION,
    NOT_SETTLED: ORANGE,
    UNDECIDED: "0.5",
}
SHAPES = {WITHOUT: "v", PERIODIC: "o", CHAOTIC: "s", NOT_SETTLED: "^", UNDECIDED: "x"}


@in_house_style
def draw_scan(
    starts: Sequence[Start], rows: Sequence[Mapping[str, Any]], frequency: float, quantity: str
) -> Any:
    """Strobe points and exponents against the excess, a column for each model."""
    names = [name for name in TITLES if any(row["model"] == name for row in rows)]
    figure, axes = new_figure(
        2, len(names), width=PAGE if len(names) > 1 else COLUMN, height=0.112, squeeze=False, sharex="col"
    )
    for column, name in enumerate(names):
        upper, lower = axes[:, column]
        for direction, colour, face, size in (
            ("down", VERMILION, "none", 2.6),
            ("up", BLUE, BLUE, 1.4),
        ):
            chosen = [start for start in starts if start.model == name and start.direction == direction]
            across = np.concatenate([np.full(start.tip.size, start.excess) for start in chosen])
            upper.plot(
                1e2 * across,
                1e3 * np.concatenate([start.tip for start in chosen]),
                linestyle="none",
                marker="o",
                markersize=size,
                markeredgewidth=0.4,
                markeredgecolor=colour,
                markerfacecolor=face,
                gid=f"{direction}ward scan",
                rasterized=True,
                zorder=2 if direction == "down" else 3,
            )
        mine = [row for row in rows if row["model"] == name and row["lyapunov_map"] is not None]
        lower.axhline(0.0, **GUIDE, gid="no growth")
        for kind in SHAPES:
            alike = [row for row in mine if row["kind"] == kind]
            lower.plot(
                [1e2 * row["excess"] for row in alike],
                [row["lyapunov_map"] for row in alike],
                linestyle="none",
                marker=SHAPES[kind],
                markersize=3.4,
                markerfacecolor="none",
                markeredgewidth=0.7,
                markeredgecolor=COLOURS[kind],
                gid=kind,
            )
        lower.plot(
            [1e2 * row["excess"] for row in mine],
            [row["lyapunov_flow"] / frequency for row in mine],
            linestyle="none",
            marker=".",
            markersize=1.6,
            color="black",
            zorder=4,
            gid="from two motions",
        )
        for axis in (upper, lower):
            axis.axvline(0.0, **GUIDE, gid="grazing")
        panel(upper, column, f"{TITLES[name]}, {frequency:.2f} Hz")
        panel(lower, column + len(names))
        label(lower.xaxis, EXCESS, "%")
        if column == 0:
            label(
                upper.yaxis, *(("rotation", "mrad") if quantity == "rotation" else ("displacement", "mm"))
            )
            label(lower.yaxis, "exponent per drive period")
    kinds = [kind for kind in SHAPES if any(row["kind"] == kind for row in rows)]
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=SHAPES[kind],
            markersize=3.8,
            markerfacecolor="none",
            markeredgecolor=COLOURS[kind],
            label=kind,
        )
        for kind in kinds
    ] + [Line2D([], [], linestyle="none", marker=".", markersize=3, color="black", label="from two motions")]
    scans = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=3,
            markerfacecolor=face,
            markeredgecolor=colour,
            label=f"{way}ward scan",
        )
        for way, colour, face in (("up", BLUE, BLUE), ("down", VERMILION, "none"))
    ]
    figure.legend(
        handles=[*scans, *handles], loc="outside lower center", ncols=3 if len(names) > 1 else 2
    )
    return figure


@in_house_style
def draw_basins(planes: Sequence[Basins], frequency: float, excess: float, gap: float) -> Any:
    """The strobe plane and a part of it, coloured by where the points lead."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.082)
    period = planes[0].period
    codes = {1: 0, period: 1, 0: 2}
    colours = (tint(SKY, 0.3), BLUE, ORANGE)
    speed = 2.0 * np.pi * frequency * gap
    for number, (axis, found) in enumerate(zip(axes, planes, strict=True)):
        picture = np.full(found.leads.shape, np.nan)
        for code, place in codes.items():
            picture[found.leads == code] = place
        x, y = found.x / gap, found.velocity / speed
        axis.pcolormesh(x, y, picture, shading="nearest", vmin=-0.5, vmax=2.5, cmap=ListedColormap(colours),
                        rasterized=True, gid="0: to p$_1$; 1: to p$_m$; 2: to something else")
        marks = {"white": found.orbit / (gap, speed), VERMILION: np.array([found.rest]) / (gap, speed)}
        for colour, places in marks.items():
            inside = (abs(places[:, 0] - x.mean()) < np.ptp(x) / 2) & (
                abs(places[:, 1] - y.mean()) < np.ptp(y) / 2
            )
            axis.plot(
                places[inside, 0],
                places[inside, 1],
                linestyle="none",
                marker="o" if colour == "white" else "D",
                markersize=4,
                markerfacecolor=colour,
                markeredgecolor="black",
                markeredgewidth=0.7,
                gid=f"points of p$_{{{period}}}$" if colour == "white" else "p$_1$",
            )
        parts = found.parts()
        where = "the strobe plane" if number == 0 else "around p$_1$"
        panel(axis, number, f"{where}: {100 * parts['p1 without impacts']:.1f} % lead to p$_1$")
        label(axis.xaxis, "$ξ$ / gap at the strobe")
        if number == 0:
            label(axis.yaxis, "$\\dot{ξ}$ / (2π f gap) at the strobe")
    names = {1: "to p$_1$ without impacts", period: f"to p$_{{{period}}}$", 0: "to something else"}
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker="s",
            markersize=5,
            markerfacecolor=colours[place],
            markeredgecolor="0.4",
            markeredgewidth=0.4,
            label=names[code],
        )
        for code, place in codes.items()
        if any(np.any(found.leads == code) for found in planes)
    ]
    for marker, colour, name in (("o", "white", f"points of p$_{{{period}}}$"), ("D", VERMILION, "p$_1$")):
        handles.append(
            Line2D(
                [],
                [],
                linestyle="none",
                marker=marker,
                markersize=4,
                markerfacecolor=colour,
                markeredgecolor="black",
                label=name,
            )
        )
    figure.suptitle(f"Eq. (1), {frequency:.2f} Hz, $F/F_g - 1$ = {excess:g}", fontsize=STYLE["font.size"])
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure
