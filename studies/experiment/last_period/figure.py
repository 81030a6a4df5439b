"""Folds after each change."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.experiment.last_period.changes import Transition
from studies.physics.descriptions import word
from studies.shell import plotting
from studies.shell.plotting import BLUE, NOTE, PAGE, VERMILION

TORNADO = (
    "Factor on the hysteresis of the beam at each frequency after each change of one parameter; a period in "
    "words is born instead."
)
WAYS = {-1: ("lowered", BLUE, 0.2), 1: ("raised", plotting.tint(VERMILION, 0.6), -0.2)}
"""Direction of a change -> its name, colour and place of its bar."""
LEFT, RIGHT = 0.22, 4.5
"""Where the axis of the factors ends."""


@plotting.in_house_style
def draw_tornado(rows: Sequence[Transition]) -> Figure:
    """The fold after a change over the fold without it, one panel for each frequency."""
    rows = [row for row in rows if row.description == "beam"]
    before = [row for row in rows if not row.sign]
    parameters = list(dict.fromkeys(row.parameter for row in rows if row.sign))[::-1]
    columns = min(3, len(before))
    lines = math.ceil(len(before) / columns)
    height = (0.016 + 0.0044 * len(parameters)) * lines + 0.012
    shared = {"squeeze": False, "sharey": True, "sharex": True}
    figure, axes = plotting.new_figure(lines, columns, width=PAGE, height=height, **shared)
    for axis in axes.flat[len(before) :]:
        axis.set_visible(False)
    for number, (axis, base) in enumerate(zip(axes.flat, before, strict=False)):
        for row in rows:
            if row.sign and row.frequency_hz == base.frequency_hz:
                draw_change(axis, row, base.fold, parameters.index(row.parameter))
        depth = "none" if base.fold is None else f"{-base.fold:.1e}"
        plotting.panel(axis, number, f"{base.frequency_hz:.2f} Hz, p$_{{{base.m}}}$ ({depth})")
        axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3)
        axis.set(xscale="log", xlim=(LEFT, RIGHT), ylim=(-0.6, len(parameters) - 0.4))
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
    """One change at one frequency; `before` is the fold without."""
    way, colour, shift = WAYS[row.sign]
    factor = row.fold / before if row.fold is not None and before else None
    if row.fold is None and before is not None:
        axis.plot(LEFT, place + shift, "kx", markersize=3.0, clip_on=False, label=f"{way}: none left")
    elif factor is not None and factor > 0.0:
        axis.barh(place + shift, factor - 1.0, 0.34, left=1.0, color=colour, zorder=2, label=way)
    if row.born != row.m:
        words = f"{word(row.born)} at {row.change}"
        at: plotting.Style = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "center"}
        axis.annotate(words, (0.99, place + shift), **at, fontsize=NOTE)
