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

__all__ = ["draw_errors"]

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


def draw_methods(axes: Axes, rows: Sequence[Row], styles: Styles) -> None:
    """All methods of one problem in one panel."""
    for name, style in styles.items():
        values = [(row.us_per_period, row.error) for row in rows if row.method == name]
        points = [point for point in values if None not in point]
        if points:
            cost, found = np.array(points).T
            axes.plot(cost, np.maximum(found, FLOOR), label=name, **style)
    axes.set_xscale("log")


@in_house_style
def draw_errors(rows: Sequence[Row], references: Sequence[Reference]) -> Figure:
    """Error of mode 1 against time, one panel a problem."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.175, squeeze=False)
    styles = styles_of(rows)
    for number, (reference, axis) in enumerate(zip(references, axes.flat, strict=False)):
        problem = reference.problem
        mine = [row for row in rows if row.problem == problem.name]
        draw_methods(axis, mine, styles)
        axis.set_yscale("log")
        own = math.ceil(math.log10(reference.own_error))
        panel(axis, number, f"{problem.title}\nreference good to 10$^{{{own}}}$")
        label(axis.xaxis, f"time per {problem.unit}", "µs")
        label(axis.yaxis, "error of mode 1")
    handles: dict[str, Any] = {}
    for axis in axes.flat:
        handles |= dict(reversed(pair) for pair in zip(*axis.get_legend_handles_labels(), strict=True))
    names = [name for name in styles if name in handles]
    figure.legend([handles[name] for name in names], names, loc="outside lower center", ncols=4)
    return figure
