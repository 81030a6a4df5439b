"""Figure of the study: methods differ in colour and marker, families in the line, the exact one is a star."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from studies.methods.work_precision.methods import EXACT, OUTSIDE, PERIODIC, STEPPED
from studies.methods.work_precision.model import Measured, Reference
from studies.shell import plotting
from studies.shell.plotting import MARKERS, PALETTE

FLOOR = 1e-17  # errors that vanish are drawn here

COLOURS = (*PALETTE[1:7], "0.45")  # seven against eight markers: no two methods of a family look alike


def styles_of(rows: Sequence[Measured]) -> dict[str, dict[str, Any]]:
    """Colour, marker and line of each method, the same in every panel, by family."""
    found: dict[str, dict[str, Any]] = {
        row.method: {"marker": "*", "color": PALETTE[0], "linestyle": "none", "markersize": 9, "zorder": 5}
        for row in rows
        if row.family == EXACT
    }
    for family, line in ((STEPPED, "-"), (OUTSIDE, "--"), (PERIODIC, ":")):
        for i, name in enumerate(dict.fromkeys(row.method for row in rows if row.family == family)):
            colour, outside = COLOURS[i % len(COLOURS)], family == OUTSIDE
            found[name] = {
                "marker": MARKERS[(i + 3 * outside) % len(MARKERS)],
                "color": colour,
                "linestyle": line,
                "linewidth": 0.8,
                # methods that agree are drawn on top of each other, the larger ones first
                "markersize": 3.2 if outside else 6.4 - 0.5 * i,
                "markerfacecolor": "white" if outside else colour,
            }
    return found


@plotting.in_house_style
def draw_errors(rows: Sequence[Measured], references: Sequence[Reference]) -> Figure:
    """Error of mode 1 against time, one panel a problem; the legend is in the order of families."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.185, squeeze=False)
    styles = styles_of(rows)
    for number, (reference, axis) in enumerate(zip(references, axes.flat, strict=False)):
        problem = reference.problem
        for name, style in styles.items():
            mine = [row for row in rows if (row.problem, row.method) == (problem.name, name)]
            points = [(row.time_per_period_us, row.error) for row in mine if row.error is not None]
            if points:
                cost, error = np.array(points).T
                axis.plot(cost, np.maximum(error, FLOOR), label=name, clip_on=False, **style)
        axis.set_xscale("log")
        axis.set_yscale("log")
        low, high = np.log10(axis.get_xlim())
        axis.set_xlim(10.0 ** math.floor(low), 10.0 ** math.ceil(high))  # a label at both ends
        plotting.panel(axis, number, problem.title)
        plotting.label(axis.xaxis, f"time per {problem.unit}", "µs")
        plotting.label(axis.yaxis, "error of mode 1")
    for axis in axes.flat[len(references) :]:
        axis.set_axis_off()
    plotting.legend_below(figure, axes.flat, 4, order=list(styles))
    return figure
