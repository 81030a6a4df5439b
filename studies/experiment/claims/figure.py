"""Hysteresis and secondary bifurcation against restitution; born periods over the bands of the map."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies import letter
from studies.experiment.claims.model import SPAN, Born, Node
from studies.shell import plotting
from studies.shell.scene import Scene, band_of

LOSS = (
    "Hysteresis against restitution at each frequency, map and Eq. (1): a smaller restitution, more "
    "energy lost, less hysteresis; excess of the secondary bifurcation of Eq. (1), and at which part of the "
    "frequencies it lies below grazing."
)
BORN = (
    "Period born at grazing for seven springs and contact laws; grey, the bands of the map. Near the upper "
    "edge of a band all agree with it."
)


@plotting.in_house_style
def draw_loss(rows: Sequence[Node], tau: NDArray[np.float64], below: NDArray[np.float64]) -> Figure:
    """Hysteresis and secondary bifurcation against tau."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.130, sharex=True)
    panels: dict[str, Callable[[Node], float]] = {
        "Nordmark map": lambda row: -row.fold_of_map,
        "Eq. (1)": lambda row: -row.fold if row.admissible else math.nan,
        "Eq. (1), secondary": lambda row: row.secondary if row.admissible else math.nan,
    }
    for axis, value in zip(axes.flat, panels.values(), strict=False):
        for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
            mine = [row for row in rows if row.frequency_hz == frequency]
            curve = [row.restitution for row in mine], [1e2 * value(row) for row in mine]
            name = f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$"
            axis.plot(*curve, markevery=3, **plotting.series(number % 8), label=name)
    axes[1, 1].plot(tau, 1e2 * below, color=plotting.BLUE)
    axes[1, 0].axhline(0.0, **plotting.GUIDE)
    for axis in axes[0]:
        axis.set(yscale="log", ylim=(4e-3, 30.0))
        plotting.label(axis.yaxis, plotting.HYSTERESIS, "%")
    plotting.label(axes[1, 0].yaxis, "secondary bifurcation, excess", "%")
    plotting.label(axes[1, 1].yaxis, "part of the frequencies", "%")
    for place, (axis, title) in enumerate(zip(axes.flat, (*panels, "Eq. (1): below grazing"), strict=True)):
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.98)
    for axis in axes[1]:
        plotting.label(axis.xaxis, "restitution τ")
    plotting.legend_below(figure, axes.flat[:1], 3)
    return figure


@plotting.in_house_style
def draw_born(scene: Scene, rows: Sequence[Born]) -> Figure:
    """Born periods over the bands of the map; what has no period from 2 to 12 lies in the lowest row."""
    figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.085)
    names, period = list(dict.fromkeys(row.spring for row in rows)), scene.single_mode.free_period_s
    for number, name in enumerate(names):
        mine = [row for row in rows if row.spring == name]
        shift, style = 0.1 * (number - 0.5 * (len(names) - 1)), plotting.points(number)
        heights = [shift + (row.period if row.period and 1 < row.period <= 12 else 1) for row in mine]
        look = style | {"markersize": 2.6, "markeredgewidth": 0.7}
        axis.plot([row.f_times_t for row in mine], heights, **look, label=name)
    for m in range(2, 13):
        edges = band_of(scene, m)
        span = [edges.lower * period, edges.upper * period]
        axis.fill_between(span, m - 0.42, m + 0.42, color="0.88", linewidth=0.0, zorder=0)
    axis.set_xlim(SPAN[0] - 0.003, SPAN[1] + 0.003)
    axis.set_ylim(0.4, 12.6)
    axis.set_yticks(range(1, 13), ["other", *map(str, range(2, 13))])
    f = np.array(list(letter.PERIODS))
    errors = {"xerr": f * letter.FREE_PERIOD_ERROR_S, "elinewidth": 0.7, "ecolor": "black"}
    place = f * letter.FREE_PERIOD_S, list(letter.PERIODS.values())
    axis.errorbar(*place, **errors, **plotting.LETTER_POINTS, label="letter, error of T")
    plotting.label(axis.xaxis, "$f T$")
    plotting.label(axis.yaxis, f"period $m$ born, excess {scene.scan.born_excess:g}")
    plotting.legend_below(figure, [axis], 3)
    return figure
