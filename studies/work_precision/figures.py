"""Figures of the work-precision study.

Methods differ in colour and marker, families in the line: solid for fixed steps, dashed for outside solvers;
the exact method is one large point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.plotting import MARKERS, PAGE, PALETTE, in_house_style, label, new_figure, panel
from studies.work_precision.measures import Reference, Row
from studies.work_precision.methods import EXACT, OUTSIDE, STEPPED
from studies.work_precision.problems import Problem

__all__ = ["draw_errors", "draw_missed"]

FLOOR = 1e-17
"""Errors that vanish are drawn here."""

COLOURS = (*PALETTE[1:7], "0.45")
"""Seven against eight markers: no two methods of a family look alike."""

Styles = Mapping[str, Mapping[str, Any]]


def styles_of(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Colour, marker and line of each method, the same in every panel, by family."""
    found: dict[str, dict[str, Any]] = {}
    for family in (EXACT, STEPPED, OUTSIDE):
        for i, name in enumerate(dict.fromkeys(row.method for row in rows if row.family == family)):
            colour, outside = COLOURS[i % len(COLOURS)], family == OUTSIDE
            found[name] = {
                "marker": MARKERS[(i + 3 * outside) % len(MARKERS)], "color": colour,
                "linestyle": "--" if outside else "-", "linewidth": 0.8,
                # methods that agree are drawn on top of each other, the larger ones first
                "markersize": 3.2 if outside else 5.0 if i % 2 == 0 else 2.6,
                "markerfacecolor": "white" if outside else colour,
            } if family != EXACT else {
                "marker": "*", "color": PALETTE[0], "linestyle": "none", "markersize": 9, "zorder": 5,
            }  # fmt: skip
    return found


def draw_methods(axes: Axes, rows: Sequence[Row], styles: Styles, measure: str) -> None:
    """All methods of one problem in one panel."""
    for name, style in styles.items():
        values = [(row.us_per_period, getattr(row, measure)) for row in rows if row.method == name]
        points = [point for point in values if None not in point]
        if points:
            cost, found = np.array(points).T
            axes.plot(cost, found if measure == "missed" else np.maximum(found, FLOOR), label=name, **style)
    axes.set_xscale("log")


def legend(figure: Figure, axes: Sequence[Axes], columns: int, order: Sequence[str] = ()) -> None:
    """One legend below all panels, in the order given, others first."""
    handles: dict[str, Any] = {}
    for axis in axes:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(name, handle)
    names = sorted(handles, key=lambda name: order.index(name) if name in order else -1)
    figure.legend([handles[name] for name in names], names, loc="outside lower center", ncols=columns)


@in_house_style
def draw_errors(rows: Sequence[Row], references: Sequence[Reference]) -> Figure:
    """Error of mode 1 against time, one panel a problem."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.175, squeeze=False)
    styles = styles_of(rows)
    for number, (reference, axis) in enumerate(zip(references, axes.flat, strict=False)):
        problem = reference.problem
        mine = [row for row in rows if row.problem == problem.name]
        draw_methods(axis, mine, styles, "error")
        axis.set_yscale("log")
        own = math.ceil(math.log10(reference.own_error))
        panel(axis, number, f"{problem.title}\nreference good to 10$^{{{own}}}$")
        label(axis.xaxis, f"time per {problem.unit}", "µs")
        label(axis.yaxis, "error of mode 1")
    legend(figure, axes.flat, 4, list(styles))
    return figure


@in_house_style
def draw_missed(rows: Sequence[Row], problems: Sequence[Problem]) -> Figure:
    """Missed crossings against time, a panel a driven problem."""
    driven, styles = [one for one in problems if one.oscillator.drive is not None], styles_of(rows)
    figure, axes = new_figure(1, len(driven), width=PAGE, height=0.085, sharey=True)
    for number, (problem, axis) in enumerate(zip(driven, axes, strict=True)):
        draw_methods(axis, [row for row in rows if row.problem == problem.name], styles, "missed")
        panel(axis, number, problem.title.replace("beam, ", ""))
        label(axis.xaxis, f"time per {problem.unit}", "µs")
    label(axes[0].yaxis, "crossings missed (share)")
    legend(figure, axes, 4, list(styles))
    return figure
