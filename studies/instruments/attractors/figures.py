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
from studies.instruments.figures import COLUMN, PAGE, house_style, label, new_figure

__all__ = ["SHAPES", "draw_basins", "draw_scan"]

COLOURS = {
    WITHOUT: "#56B4E9",
    PERIODIC: "#0072B2",
    CHAOTIC: "#D55E00",
    NOT_SETTLED: "#E69F00",
    UNDECIDED: "0.5",
}
SHAPES = {WITHOUT: "v", PERIODIC: "o", CHAOTIC: "s", NOT_SETTLED: "^", UNDECIDED: "x"}


def draw_scan(
    starts: Sequence[Start], rows: Sequence[Mapping[str, Any]], frequency: float, quantity: str
) -> Any:
    """Strobe points and exponents against the excess, a column for each model."""
    names = [name for name in TITLES if any(row["model"] == name for row in rows)]
    figure, axes = new_figure(
        2, len(names), width=PAGE if len(names) > 1 else COLUMN, height=0.105, squeeze=False, sharex="col"
    )
    for column, name in enumerate(names):
        upper, lower = axes[:, column]
        for direction, colour, face, size in (
            ("down", "#D55E00", "none", 2.6),
            ("up", "#0072B2", "#0072B2", 1.4),
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
                label=f"{direction}ward scan",
                rasterized=True,
                zorder=2 if direction == "down" else 3,
            )
        mine = [row for row in rows if row["model"] == name and row["lyapunov_map"] is not None]
        lower.axhline(0.0, color="0.6", linewidth=0.6)
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
            )
        lower.plot(
            [1e2 * row["excess"] for row in mine],
            [row["lyapunov_flow"] / frequency for row in mine],
            linestyle="none",
            marker=".",
            markersize=1.6,
            color="black",
            zorder=4,
        )
        for axis in (upper, lower):
            axis.axvline(0.0, color="0.6", linewidth=0.6, linestyle="--", zorder=1)
        with house_style():
            upper.set_title(f"({chr(ord('a') + column)}) {TITLES[name]}, {frequency:.2f} Hz")
            label(lower.xaxis, "excess F/F$_g$ - 1", "%")
            if column == 0:
                label(
                    upper.yaxis, *(("rotation", "mrad") if quantity == "rotation" else ("displacement", "mm"))
                )
                label(lower.yaxis, "largest exponent per drive period")
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
        for way, colour, face in (("up", "#0072B2", "#0072B2"), ("down", "#D55E00", "none"))
    ]
    with house_style():
        figure.legend(
            handles=[*scans, *handles], loc="outside lower center", ncols=3 if len(names) > 1 else 2
        )
    return figure


def draw_basins(planes: Sequence[Basins], frequency: float, excess: float, gap: float) -> Any:
    """The strobe plane and a part of it, coloured by where the points lead."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.082)
    period = planes[0].period
    codes = {1: 0, period: 1, 0: 2}
    colours = ("#CFE8F7", "#0072B2", "#E69F00")
    speed = 2.0 * np.pi * frequency * gap
    for number, (axis, found) in enumerate(zip(axes, planes, strict=True)):
        picture = np.full(found.leads.shape, np.nan)
        for code, place in codes.items():
            picture[found.leads == code] = place
        x, y = found.x / gap, found.velocity / speed
        axis.imshow(
            picture,
            origin="lower",
            aspect="auto",
            interpolation="nearest",
            vmin=-0.5,
            vmax=2.5,
            cmap=ListedColormap(colours),
            extent=(x[0], x[-1], y[0], y[-1]),
        )
        marks = {"white": found.orbit / (gap, speed), "#D55E00": np.array([found.rest]) / (gap, speed)}
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
            )
        parts = found.parts()
        with house_style():
            where = "the strobe plane" if number == 0 else "around p$_1$"
            axis.set_title(
                f"({'ab'[number]}) {where}: {100 * parts['p1 without impacts']:.1f} % lead to p$_1$"
            )
            label(axis.xaxis, "x / gap at the strobe")
            if number == 0:
                label(axis.yaxis, "x′ / (2π f gap) at the strobe")
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
    for marker, colour, name in (("o", "white", f"points of p$_{{{period}}}$"), ("D", "#D55E00", "p$_1$")):
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
    with house_style():
        figure.suptitle(f"Eq. (1), {frequency:.2f} Hz, F/F$_g$ - 1 = {excess:g}", fontsize=8)
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure
