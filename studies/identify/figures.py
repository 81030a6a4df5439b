"""The figure: each record with its fit, what is left of it, and where two parameters trade off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from studies import plotting
from studies.identify.fit import Fit, Profile
from studies.parameters import parameters_of

__all__ = ["CAPTION", "draw"]

CAPTION = (
    "Each record with its fit (left), residuals (middle), and the profile likelihood of the two parameters "
    "that trade off most (blue: chi^2, dashed the 90 % interval; red: the other, fitted again), or the "
    "correlations of all (right)."
)
SHOWN = 6
"""Drive periods of a displacement that are shown."""

FITTED: plotting.Style = {"linestyle": "none", "marker": "_", "color": "black", "zorder": 5, "label": "fit"}
DOTS: plotting.Style = {"linestyle": "none", "marker": ".", "markersize": 2, "rasterized": True}

DEPTH = 2.71
"""Rise of chi^2 at the ends of a 90 % interval."""


@plotting.in_house_style
def draw(found: Mapping[str, Fit], profiles: Mapping[str, Sequence[Profile]]) -> Figure:
    """Three panels a record."""
    height = 0.055 * len(found) + 0.005
    figure, axes = plotting.new_figure(len(found), 3, width=plotting.PAGE, height=height, squeeze=False)
    for i, ((name, one), row) in enumerate(zip(found.items(), axes, strict=True)):
        _record(row[0], row[1], one)
        _trade(row[2], one, profiles[name])
        for k, words in enumerate((name, "residuals", "")):
            plotting.panel(row[k], 3 * i + k, words)
    return figure


def _record(left: Any, middle: Any, one: Fit) -> None:
    """Record and fit, and residuals below the same axis."""
    kind, rows = one.record.kind, one.record.rows
    seen, unit, words = one.record.observed[:, 0], 1e3, "tip displacement"
    fitted, residuals = seen - one.residuals[:, 0], 1e6 * one.residuals[:, 0]
    if kind == "displacement":
        place, across = 1e3 * rows[:, 0], ("time", "ms")
        end = 1e3 * (rows[0, 0] + SHOWN * one.oscillator.period)
        left.plot(place, unit * seen, **DOTS, color=plotting.SKY, label="record")
        left.plot(place, unit * fitted, color=plotting.BLACK, linewidth=0.6, label="fit")
        left.set_xlim(place[0], end)
    elif kind == "strobe":
        place, across = np.arange(len(seen), dtype=float), ("strobe", "1")
        left.plot(place, unit * seen, **plotting.points(1), label="record")
        left.plot(place, unit * fitted, **FITTED)
    else:
        place, across, unit, words = rows[:, 0], ("drive frequency", "Hz"), 1e2, "end of $p_m$, excess"
        residuals = 1e2 * one.residuals[:, 0]
        errors = unit * one.record.units(one.noise)[:, 0]
        left.errorbar(place, unit * seen, errors, **plotting.points(1), label="record")
        left.plot(place, unit * fitted, **FITTED)
    middle.plot(place, residuals, **DOTS, color=plotting.BLUE)
    middle.axhline(0.0, **plotting.GUIDE)
    for axis in (left, middle):
        plotting.label(axis.xaxis, *across)
    plotting.label(left.yaxis, words, "%" if kind == "transitions" else "mm")
    plotting.label(middle.yaxis, "observed less fitted", "%" if kind == "transitions" else "um")
    left.margins(y=0.25)
    left.legend(loc="upper right", ncols=2)


def _trade(axis: Any, one: Fit, rows: Sequence[Profile]) -> None:
    """The profile of the most correlated pair, else all correlations."""
    if not rows:
        n = len(one.names)
        axis.imshow(one.correlations, vmin=-1.0, vmax=1.0, cmap="RdBu")
        names = [name.replace("_", "\n") for name in one.names]
        axis.set_xticks(range(n), names)
        axis.set_yticks(range(n), names)
        for i in range(n):
            for j in range(n):
                axis.text(j, i, f"{one.correlations[i, j]:.2f}", ha="center", va="center")
        return
    first = rows[0].parameter
    own, unit = [row for row in rows if row.parameter == first], parameters_of(one.oscillator)[first].unit
    scale, shown = (1e3, f"m{unit}") if unit in ("s", "m") else (1.0, unit)
    value = scale * np.array([row.value for row in own])
    axis.plot(value, [row.depth for row in own], **plotting.series(1))
    axis.axhline(DEPTH, **plotting.GUIDE)
    axis.locator_params(axis="x", nbins=5)
    plotting.label(axis.xaxis, first.replace("_", " "), shown)
    plotting.label(axis.yaxis, "rise of chi^2")
    other = axis.twinx()
    known = parameters_of(one.oscillator)[own[0].other]
    scale, shown = (1e3, f"m{known.unit}") if known.unit in ("s", "m") else (1.0, known.unit)
    other.plot(value, scale * np.array([row.other_value for row in own]), **plotting.series(2))
    plotting.label(other.yaxis, own[0].other.replace("_", " "), shown)
    other.spines["right"].set_visible(True)
