"""Folds after each change."""

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.experiment.last_period.changes import Transition
from studies.physics.descriptions import word
from studies.shell import plotting
from studies.shell.digits import written
from studies.shell.plotting import BLUE, NOTE, PAGE, VERMILION

TORNADO = (
    "Factor on the hysteresis of the beam at each frequency after each change of one parameter; a period in "
    "words is born instead."
)
WAYS = {-1: ("lowered", BLUE, 0.2), 1: ("raised", plotting.tint(VERMILION, 0.6), -0.2)}
"""Direction of a change -> its name, colour and place of its bar."""
LEFT, RIGHT = 0.22, 4.5  # where the axis of the factors ends


@plotting.in_house_style
def draw_tornado(rows: Sequence[Transition]) -> Figure:
    """The hysteresis after a change over that without it, one panel for each frequency."""
    rows = [row for row in rows if row.description == "beam"]
    before = {row.frequency_hz: row for row in rows if not row.sign}
    after = [row for row in rows if row.sign]
    moved = [row for row in after if (row.fold, row.born) != (before[row.frequency_hz].fold, row.m)]
    parameters = list(dict.fromkeys(row.parameter for row in moved))[::-1]
    changes = {(row.parameter, row.sign): row.change for row in after}
    columns = min(3, len(before))
    lines = math.ceil(len(before) / columns)
    height = max((0.019 + 0.0044 * len(parameters)) * lines + 0.014, 0.145)  # a slide needs the width
    shared = {"squeeze": False, "sharey": True, "sharex": True}
    figure, axes = plotting.new_figure(lines, columns, width=PAGE, height=height, **shared)
    for axis in axes.flat[len(before) :]:
        axis.set_visible(False)
    for number, (axis, base) in enumerate(zip(axes.flat, before.values(), strict=False)):
        deep = base.fold is not None and base.fold < 0.0
        for row in after:
            if row.frequency_hz == base.frequency_hz and row.parameter in parameters:
                draw_change(axis, row, base.fold if deep else None, parameters.index(row.parameter))
        plotting.panel(axis, number, f"{base.frequency_hz:.2f} Hz, {word(base.m)}")
        words = f"hysteresis {written(-(base.fold or 0.0), 2)}" if deep else "no hysteresis to change"
        note: plotting.Style = {"ha": "right", "va": "center", "fontsize": NOTE}
        axis.text(0.99, -0.95, words, transform=axis.get_yaxis_transform(), **note)
        axis.vlines(1.0, -0.5, len(parameters) - 0.4, color="0.3", linewidth=0.7, zorder=3)
        axis.set(xscale="log", xlim=(LEFT, RIGHT), ylim=(-1.4, len(parameters) - 0.4))
        axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
        axis.minorticks_off()
        both = [", ".join(changes[p, way] for way in WAYS if (p, way) in changes) for p in parameters]
        names = [f"{name} {sizes}" for name, sizes in zip(parameters, both, strict=True)]
        axis.set_yticks(range(len(parameters)), names)
    for axis in axes[-1]:
        plotting.label(axis.xaxis, "factor on the hysteresis")
    figure.supylabel("changed parameter")
    plotting.legend_below(figure, axes.flat, 5)
    return figure


def draw_change(axis: Axes, row: Transition, before: float | None, place: int) -> None:
    """One change at one frequency; `before` is the fold without, None where that is no hysteresis."""
    way, colour, shift = WAYS[row.sign]
    high, factor = place + shift, 0.0 if row.fold is None or before is None else row.fold / before
    mark: plotting.Style = {"linestyle": "none", "markersize": 3.0, "color": "black", "clip_on": False}
    if factor > 0.0:
        axis.barh(high, factor - 1.0, 0.34, left=1.0, color=colour, zorder=2, label=way)
    elif before is not None:
        gone = "no fold" if row.fold is None else "no hysteresis left"
        axis.plot(LEFT, high, marker="x" if row.fold is None else "o", label=gone, **mark)
    if 0.0 < factor < LEFT or factor > RIGHT:
        end, tip = (LEFT, "<") if factor < LEFT else (RIGHT, ">")
        axis.plot(end, high, marker=tip, label="bar goes on beyond the axis", **mark)
    if row.born != row.m:
        words = {None: "failed", 0: "no period"}.get(row.born, f"p{row.born} instead")
        side, ha = (0.01, "left") if factor > 1.0 else (0.99, "right")  # where the bar is not
        at: plotting.Style = {"xycoords": ("axes fraction", "data"), "ha": ha, "va": "center"}
        axis.annotate(words, (side, high), **at, fontsize=NOTE)
