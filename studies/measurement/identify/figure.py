"""Each record with its fit, residuals and trade-off."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.measurement.identify.fit.profiles import Profile
from studies.measurement.identify.fit.result import Fit
from studies.physics.parameters import parameters_of
from studies.shell import plotting
from studies.shell.digits import minus

CAPTION = (
    "Each record with its fit (left), residuals (middle), and the profile likelihood of the two parameters "
    "that trade off most, or the correlations of all (right)."
)
SHOWN = 6  # drive periods of a displacement
DEPTH = 2.71  # rise of chi^2 at the ends of a 90 % interval
DARK, SMALL = 0.6, 5.5  # correlation from which on its cell is dark; size of its digits [pt]
FITTED: plotting.Style = {"linestyle": "none", "marker": "_", "color": "black", "zorder": 5, "label": "fit"}
DOTS: plotting.Style = {"linestyle": "none", "marker": ".", "markersize": 2, "rasterized": True}


@plotting.in_house_style
def draw(found: Mapping[str, Fit], profiles: Mapping[str, Sequence[Profile]]) -> Figure:
    """Three panels a record."""
    height = 0.055 * len(found) + 0.005
    figure, axes = plotting.new_figure(len(found), 3, width=plotting.PAGE, height=height, squeeze=False)
    for i, ((name, one), row) in enumerate(zip(found.items(), axes, strict=True)):
        _record(row[0], row[1], one)
        _trade(row[2], one, profiles[name])
        shown = "trade-off" if profiles[name] else "correlations"
        for k, words in enumerate((f"record {name}", "residuals", shown)):
            plotting.panel(row[k], 3 * i + k, words)
    plotting.legend_below(figure, figure.axes, 5)
    return figure


def _record(left: Any, middle: Any, one: Fit) -> None:
    """Record and fit, and residuals below the same axis."""
    kind, rows = one.record.kind, one.record.rows
    table = kind == "transitions"
    unit, fine, words = (1e2, 1e2, "end of $p_m$") if table else (1e3, 1e6, "tip")
    seen, residuals = one.record.observed[:, 0], one.residuals[:, 0]
    fitted = seen - residuals
    if kind == "motion":
        place, across = 1e3 * rows[:, 0], ("time", "ms")
        left.plot(place, unit * seen, **DOTS, color=plotting.BLUE, label="record")
        left.plot(place, unit * fitted, color=plotting.BLACK, linewidth=0.6, label="fit")
        left.set_xlim(place[0], place[0] + 1e3 * SHOWN * one.oscillator.period)
    else:
        place, across, errors = np.arange(len(seen), dtype=float), ("strobe", "1"), None
        if table:
            place, across = rows[:, 0], ("drive frequency", "Hz")
            errors = unit * one.record.units(one.noise)[:, 0]
        left.errorbar(place, unit * seen, errors, **plotting.points(1))[0].set_label("record")
        left.plot(place, unit * fitted, **FITTED)
    middle.plot(place, fine * residuals, **DOTS, color=plotting.BLUE)
    middle.axhline(0.0, **plotting.GUIDE)
    for axis in (left, middle):
        plotting.label(axis.xaxis, *across)
    left.margins(y=0.1)
    plotting.label(left.yaxis, words, "%" if table else "mm")
    plotting.label(middle.yaxis, "residual", "%" if table else "\u00b5m")


def _trade(axis: Any, one: Fit, rows: Sequence[Profile]) -> None:
    """The profile of the most correlated pair, else all correlations."""
    if not rows:
        image = axis.imshow(one.correlations, vmin=-1.0, vmax=1.0, cmap="RdBu", aspect="auto")
        axis.figure.colorbar(image, cax=axis.inset_axes([1.04, 0.0, 0.06, 1.0]), ticks=[-1.0, 0.0, 1.0])
        names = [name.replace("_", "\n") for name in one.names]
        axis.set_xticks(range(len(names)), names, rotation=90)
        axis.set_yticks(range(len(names)), names)
        for (i, j), number in np.ndenumerate(one.correlations):
            colour = "white" if abs(number) > DARK else "black"
            axis.text(j, i, minus(f"{number:.2f}"), ha="center", va="center", color=colour, fontsize=SMALL)
        return
    own = [row for row in rows if row.parameter == rows[0].parameter]
    other, known = axis.twinx(), parameters_of(one.oscillator)

    def shown(along: Any, name: str, values: Sequence[float]) -> NDArray[np.float64]:
        unit = known[name].unit
        scale, unit = (1e3, f"m{unit}") if unit in ("s", "m") else (1.0, unit)
        plotting.label(along, name.replace("_", " "), unit)
        return scale * np.array(values)

    value = shown(axis.xaxis, own[0].parameter, [row.value for row in own])
    lines = axis.plot(value, [row.depth for row in own], **plotting.series(1), label="rise of $\\chi^2$")
    axis.axhline(DEPTH, **plotting.GUIDE, label="90 % interval")
    axis.locator_params(axis="x", nbins=3)
    axis.margins(y=0.1)
    plotting.label(axis.yaxis, "rise of $\\chi^2$")
    fitted = shown(other.yaxis, own[0].other, [row.other_value for row in own])
    lines += other.plot(value, fitted, **plotting.series(2), label="other parameter, fitted again")
    for side, line in zip((axis, other), lines, strict=True):
        side.tick_params(axis="y", colors=line.get_color())
        side.yaxis.label.set_color(line.get_color())
    other.spines["right"].set_visible(True)
