"""Folds after each change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.experiment.last_period.changes import Transition
from studies.shell import plotting
from studies.shell.plotting import BLACK, BLUE, NOTE, PAGE, VERMILION

TORNADO = (
    "Factor on the hysteresis at each frequency after each change of one parameter, of the beam (bars) and "
    "of Eq. (1) (triangles); the period in words is born instead."
)
WAYS: dict[int, tuple[str, str, str, float]] = {
    -1: ("lowered", BLUE, "v", 0.2),
    1: ("raised", plotting.tint(VERMILION, 0.6), "^", -0.2),
}
"""Direction of a change -> its name, colour and place of its bar; marker of Eq. (1)."""
LEFT, RIGHT = 0.22, 4.5
"""Where the axis of the factors ends."""


@plotting.in_house_style
def draw_tornado(rows: Sequence[Transition]) -> Figure:
    """The fold after a change over the fold without it, one panel for each frequency."""
    before = [row for row in rows if not row.sign and row.description == "beam"]
    parameters = list(dict.fromkeys(row.parameter for row in rows if row.sign))[::-1]
    columns = min(3, len(before))
    lines = math.ceil(len(before) / columns)
    figure, axes = plotting.new_figure(
        lines,
        columns,
        width=PAGE,
        height=(0.016 + 0.0044 * len(parameters)) * lines + 0.012,
        squeeze=False,
        sharey=True,
        sharex=True,
    )
    for axis in axes.flat[len(before) :]:
        axis.set_visible(False)
    for number, (axis, base) in enumerate(zip(axes.flat, before, strict=False)):
        here = [row for row in rows if row.frequency_hz == base.frequency_hz]
        folds = {row.description: row.fold for row in here if not row.sign}
        for row in (row for row in here if row.sign):
            draw_change(axis, row, folds[row.description], parameters.index(row.parameter))
        digits, _, power = f"{-base.fold:.1e}".partition("e") if base.fold else ("none", "", "")
        words = f"{digits}·10$^{{{int(power)}}}$" if power else digits
        plotting.panel(axis, number, f"{base.frequency_hz:.2f} Hz, p$_{{{base.m}}}$ ({words})")
        axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3)
        axis.set_ylim(-0.6, len(parameters) - 0.4)
        axis.set_xscale("log")
        axis.set_xlim(LEFT, RIGHT)
        axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
        axis.minorticks_off()
        axis.set_yticks(range(len(parameters)), parameters)
    for axis in axes[-1]:
        plotting.label(axis.xaxis, "hysteresis / (hysteresis before)")
    for axis in axes[:, 0]:
        plotting.label(axis.yaxis, "changed parameter")
    plotting.legend_below(figure, axes.flat, 3)
    return figure


def draw_change(axis: Axes, row: Transition, before: float | None, place: int) -> None:
    """One change at one frequency: a bar (beam) or a triangle (Eq. (1)); `before` is the fold without."""
    way, colour, marker, shift = WAYS[row.sign]
    look: dict[str, Any] = {"markersize": 3.0, "markeredgecolor": BLACK, "markerfacecolor": "white"}
    y, factor = place + shift, row.fold / before if row.fold is not None and before else None
    if row.description == "Eq. (1)" and factor is not None:
        look |= {"linestyle": "none", "zorder": 4, "clip_on": False, "label": f"{way}, Eq. (1)"}
        axis.plot(min(max(factor, LEFT), RIGHT), y, marker, **look)
    if row.description != "beam":
        return
    if row.fold is None and before is not None:
        axis.plot(LEFT, y, "x", **look, clip_on=False, label=f"{way}: none left in the beam")
    elif factor is not None and factor > 0.0:
        axis.barh(y, factor - 1.0, 0.34, left=1.0, color=colour, zorder=2, label=f"{way}, beam")
    if row.born != row.m:
        words = f"p$_{{{row.born}}}$" if row.born else "no period"
        axis.annotate(
            f"{words} at {row.change}",
            (0.99, y),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="center",
            fontsize=NOTE,
        )
