"""Figures of the work-precision study.

    work_precision    error against time for each method, one panel a problem, with the front
    other_errors      impact time, restitution, kick, fold and missed crossings against time
    model_error       error and cost against the number of modes: truncation beside the time step

Methods differ in colour and marker, families in the line: solid for fixed steps, dashed for outside solvers;
exact methods are single large points.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from studies.instruments.figures import (
    LINES,
    MARKERS,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
)
from studies.instruments.work_precision.front import front
from studies.instruments.work_precision.methods import EXACT, OUTSIDE, STEPPED
from studies.instruments.work_precision.model_error import ModelErrors
from studies.instruments.work_precision.problems import Problem

__all__ = ["model_figure", "other_errors_figure", "work_precision_figure"]

Row = Mapping[str, Any]

FLOOR = 1e-17
"""Errors that vanish are drawn here."""

COLOURS = (*PALETTE[1:7], "0.45")
"""Seven against eight markers: no two methods of a family look alike."""

AXES = {
    "error": "error of mode 1",
    "error_time": "error of impact time (periods)",
    "error_restitution": "error of restitution",
    "error_kick": "error of kick",
    "error_fold": "shift of fold (of $F_g$)",
    "missed": "crossings missed (share)",
}
"""Label of an axis by the measure."""


def styles_of(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Colour, marker and line of each method, the same in every panel."""
    families = (EXACT, STEPPED, OUTSIDE)
    pairs = dict.fromkeys((row["family"], row["method"]) for row in rows)
    labels = sorted(pairs, key=lambda pair: families.index(pair[0]))
    found: dict[str, dict[str, Any]] = {}
    counts: dict[str, int] = {}
    for family, name in labels:
        i = counts[family] = counts.get(family, -1) + 1
        if family == EXACT:
            marker = ("*", "P", "X")[i % 3]
            style = {
                "marker": marker, "color": PALETTE[0], "linestyle": "none", "markersize": 8, "zorder": 5,
            }  # fmt: skip
        else:
            colour, outside = COLOURS[i % len(COLOURS)], family == OUTSIDE
            style = {
                "marker": MARKERS[(i + 3 * outside) % len(MARKERS)], "color": colour,
                "linestyle": "--" if outside else "-",
                # methods that agree are drawn on top of each other, the larger ones first
                "linewidth": 0.8, "markersize": 3.2 if outside else 5.0 if i % 2 == 0 else 2.6,
                "markerfacecolor": "white" if outside else colour,
            }  # fmt: skip
        found[name] = style
    return found


def _draw(axes: Any, rows: Sequence[Row], styles: Mapping[str, Mapping[str, Any]], measure: str) -> None:
    """All methods of one problem in one panel."""
    for name, style in styles.items():
        points = [
            (row["us_per_period"], row[measure]) for row in rows
            if row["method"] == name and row[measure] is not None and row["us_per_period"] is not None
        ]  # fmt: skip
        if points:
            cost, error = np.array(points).T
            axes.plot(cost, error if measure == "missed" else np.maximum(error, FLOOR), label=name, **style)
    axes.set_xscale("log")
    if measure == "missed":
        axes.set_ylim(-0.05, 1.05)
    else:
        axes.set_yscale("log")


def _legend(figure: Figure, axes: Any, columns: int, order: Sequence[str] = ()) -> None:
    """One legend below all panels, in the order given, others first."""
    handles: dict[str, Any] = {}
    for axis in np.ravel(axes):
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(name, handle)
    place = {name: i for i, name in enumerate(order)}
    handles = dict(sorted(handles.items(), key=lambda item: place.get(item[0], -1)))
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=columns)


@in_house_style
def work_precision_figure(
    rows: Sequence[Row], problems: Sequence[Problem], reference: Mapping[str, Mapping[str, float]]
) -> Figure:
    """One panel a problem; `reference` holds the reference's own errors."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.175)
    styles = styles_of(rows)
    for number, (problem, axis) in enumerate(zip(problems, np.ravel(axes), strict=False)):
        here = [row for row in rows if row["problem"] == problem.name]
        _draw(axis, here, styles, "error")
        best = front(here)
        if best:
            # from the cheapest point straight up, from the most accurate one to the right
            cost, error = np.array([(row["us_per_period"], max(row["error"], FLOOR)) for row in best]).T
            (_left, right), (_low, top) = axis.get_xlim(), axis.get_ylim()
            axis.step(
                [cost[0], *cost, right], [top, *error, error[-1]], where="post", color="0.8", linewidth=4,
                zorder=0, label="front",
            )  # fmt: skip
            axis.set_xlim(_left, right)
            axis.set_ylim(_low, top)
        own = reference[problem.name]["error"]
        panel(axis, number, f"{problem.title}\nreference good to 10$^{{{math.log10(own):.0f}}}$")
        label(axis.xaxis, f"time per {problem.unit}", "µs")
        label(axis.yaxis, AXES["error"])
    _legend(figure, axes, 4, list(styles))
    return figure


@in_house_style
def other_errors_figure(rows: Sequence[Row], problems: Sequence[Problem]) -> Figure:
    """A row a measure, a column a driven problem."""
    measures = [name for name in AXES if name != "error"]
    driven = [problem for problem in problems if problem.oscillator.drive is not None]
    figure, axes = new_figure(
        len(measures), len(driven), width=PAGE, height=0.24, sharex="col", squeeze=False
    )
    styles = styles_of(rows)
    for j, problem in enumerate(driven):
        here = [row for row in rows if row["problem"] == problem.name]
        for i, measure in enumerate(measures):
            _draw(axes[i, j], here, styles, measure)
            title = re.sub(r", \d+ modes", "", problem.title) if i == 0 else ""
            panel(axes[i, j], i * len(driven) + j, title)
            if j == 0:
                label(axes[i, j].yaxis, AXES[measure])
        label(axes[-1, j].xaxis, f"time per {problem.unit}", "µs")
    _legend(figure, axes, 4, list(styles))
    return figure


@in_house_style
def model_figure(found: ModelErrors) -> Figure:
    """Errors on the left, costs on the right."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.085)
    left.plot(found.modes, found.model_error, color=PALETTE[0], marker="o", linewidth=1.8,
              label="too few modes (against 4 times as many)")
    right.plot(found.modes, found.default_cost, color=PALETTE[0], marker="*", markersize=7, linewidth=1.8,
               label="exact method")
    for j, h in enumerate(found.steps):
        style = {"color": PALETTE[1 + j % 6], "marker": MARKERS[1 + j % 6], "linestyle": LINES[1 + j % 6]}
        left.plot(found.modes, found.step_error[:, j], label=f"step {1e6 * h:.3g} µs", **style)
        right.plot(found.modes, found.step_cost[:, j], label=f"step {1e6 * h:.3g} µs", **style)
    shown = ((left, "error of mode 1", "1"), (right, "time per drive period", "µs"))
    for number, (axis, quantity, unit) in enumerate(shown):
        axis.set_xscale("log", base=2)
        axis.set_yscale("log")
        axis.set_xticks(found.modes, [str(n) for n in found.modes])
        axis.minorticks_off()
        panel(axis, number)
        label(axis.xaxis, "number of modes")
        label(axis.yaxis, quantity, unit)
    _legend(figure, [left, right], 3)
    return figure
