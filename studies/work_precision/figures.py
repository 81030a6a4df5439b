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

from studies.plotting import LINES, MARKERS, PAGE, PALETTE, in_house_style, label, new_figure, panel
from studies.work_precision.measures import Reference, Row, front
from studies.work_precision.methods import EXACT, OUTSIDE, STEPPED
from studies.work_precision.model_error import ModelError

__all__ = ["draw_errors", "draw_model", "draw_other_errors"]

FLOOR = 1e-17
"""Errors that vanish are drawn here."""

COLOURS = (*PALETTE[1:7], "0.45")
"""Seven against eight markers: no two methods of a family look alike."""

AXES = {
    "error": "error of mode 1",
    "error_time": "error of impact time (periods)",
    "missed": "crossings missed (share)",
}
"""Label of an axis by the measure."""

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
            cost, error = np.array(points).T
            axes.plot(cost, error if measure == "missed" else np.maximum(error, FLOOR), label=name, **style)
    axes.set_xscale("log")
    if measure == "missed":
        axes.set_ylim(-0.05, 1.05)
    else:
        axes.set_yscale("log")


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
    """Error of mode 1 against time, one panel a problem, with the front."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.175, squeeze=False)
    styles = styles_of(rows)
    for number, (reference, axis) in enumerate(zip(references, axes.flat, strict=False)):
        problem = reference.problem
        mine = [row for row in rows if row.problem == problem.name]
        draw_methods(axis, mine, styles, "error")
        best = front(mine)
        if best:
            # from the cheapest point straight up, from the most accurate one to the right
            cost, error = np.array([(row.us_per_period, max(row.error or 0.0, FLOOR)) for row in best]).T
            (left, right), (low, top) = axis.get_xlim(), axis.get_ylim()
            corners = [cost[0], *cost, right], [top, *error, error[-1]]
            axis.step(*corners, where="post", color="0.8", linewidth=4, zorder=0, label="front")
            axis.set(xlim=(left, right), ylim=(low, top))
        own = math.ceil(math.log10(reference.own_error))
        panel(axis, number, f"{problem.title}\nreference good to 10$^{{{own}}}$")
        label(axis.xaxis, f"time per {problem.unit}", "µs")
        label(axis.yaxis, AXES["error"])
    legend(figure, axes.flat, 4, list(styles))
    return figure


@in_house_style
def draw_other_errors(rows: Sequence[Row], references: Sequence[Reference]) -> Figure:
    """Impact time and missed crossings against time: a row a measure, a column a driven problem."""
    measures = [name for name in AXES if name != "error"]
    driven = [one.problem for one in references if one.crossings]
    figure, axes = new_figure(
        len(measures), len(driven), width=PAGE, height=0.135, sharex="col", squeeze=False
    )
    styles = styles_of(rows)
    for j, problem in enumerate(driven):
        for i, measure in enumerate(measures):
            draw_methods(axes[i, j], [row for row in rows if row.problem == problem.name], styles, measure)
            panel(axes[i, j], i * len(driven) + j, problem.title.replace("beam, ", "") if i == 0 else "")
            if j == 0:
                label(axes[i, j].yaxis, AXES[measure])
        label(axes[-1, j].xaxis, f"time per {problem.unit}", "µs")
    legend(figure, axes.flat, 4, list(styles))
    return figure


@in_house_style
def draw_model(found: Sequence[ModelError]) -> Figure:
    """Errors on the left, costs on the right, against the number of modes."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.085)
    modes = [one.modes for one in found]
    axes[0].plot(modes, [one.error for one in found], color=PALETTE[0], marker="o", linewidth=1.8,
                 label="too few modes (against 4 times as many)")  # fmt: skip
    axes[1].plot(modes, [one.us_per_period for one in found], color=PALETTE[0], marker="*", markersize=7,
                 linewidth=1.8, label="exact method")  # fmt: skip
    for j, one in enumerate(found[0].steps):
        style = {"color": PALETTE[1 + j % 6], "marker": MARKERS[1 + j % 6], "linestyle": LINES[1 + j % 6]}
        name = f"step {1e6 * one.step_s:.3g} µs"
        errors, costs = zip(*((row.steps[j].error, row.steps[j].us_per_period) for row in found), strict=True)
        for axis, values in zip(axes, (errors, costs), strict=True):
            axis.plot(modes, np.array(values, dtype=float), label=name, **style)
    for number, (axis, (quantity, unit)) in enumerate(
        zip(axes, (("error of mode 1", "1"), ("time per drive period", "µs")), strict=True)
    ):
        axis.set_xscale("log", base=2)
        axis.set_yscale("log")
        axis.set_xticks(modes, [str(n) for n in modes])
        axis.minorticks_off()
        panel(axis, number)
        label(axis.xaxis, "number of modes")
        label(axis.yaxis, quantity, unit)
    legend(figure, axes, 3)
    return figure
