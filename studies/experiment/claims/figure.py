"""Hysteresis and secondary bifurcation against restitution; born periods over the bands of the map."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies import letter
from studies.experiment.claims.model import SPAN, Born, Node
from studies.shell import plotting
from studies.shell.scene import Scene, band_of


def curves(axis: Axes, rows: Sequence[Node], value: Callable[[Node], float]) -> None:
    """A value in percent against tau at each frequency."""
    for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
        mine = [row for row in rows if row.frequency_hz == frequency]
        axis.plot(
            [row.restitution for row in mine],
            [1e2 * value(row) for row in mine],
            markevery=3,
            **plotting.series(number % 8),
            label=f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$",
        )
    plotting.label(axis.xaxis, "restitution τ")


@plotting.in_house_style
def draw_loss(rows: Sequence[Node]) -> Figure:
    """Hysteresis against tau, the map and Eq. (1)."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.072)
    curves(axes[0], rows, lambda row: -row.fold_of_map)
    curves(axes[1], rows, lambda row: -row.fold if row.admissible else math.nan)
    for place, (axis, title) in enumerate(zip(axes, ("Nordmark map", "Eq. (1)"), strict=True)):
        axis.set_yscale("log")
        axis.set_ylim(4e-3, 30.0)
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.98)
    plotting.label(axes[0].yaxis, plotting.HYSTERESIS, "%")
    plotting.legend_below(figure, axes[:1], 3)
    return figure


@plotting.in_house_style
def draw_secondary(rows: Sequence[Node], tau: NDArray[np.float64], below: NDArray[np.float64]) -> Figure:
    """The bifurcation against tau at each frequency, and at which part of the band it is below grazing."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.072)
    curves(axes[0], rows, lambda row: row.secondary if row.admissible else math.nan)
    axes[0].axhline(0.0, **plotting.GUIDE)
    axes[1].plot(tau, 1e2 * below, color=plotting.BLUE)
    plotting.label(axes[0].yaxis, "secondary bifurcation, excess", "%")
    plotting.label(axes[1].yaxis, "part of the frequencies", "%")
    plotting.label(axes[1].xaxis, "restitution τ")
    for place, (axis, title) in enumerate(zip(axes, ("Eq. (1)", "Eq. (1): below grazing"), strict=True)):
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.02)
    plotting.legend_below(figure, axes[:1], 3)
    return figure


@plotting.in_house_style
def draw_born(scene: Scene, rows: Sequence[Born]) -> Figure:
    """Born periods over the bands of the map; what has no period from 2 to 12 lies in the lowest row."""
    figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.085)
    names, period = list(dict.fromkeys(row.spring for row in rows)), scene.single_mode.free_period_s
    for number, name in enumerate(names):
        mine = [row for row in rows if row.spring == name]
        shift, style = 0.1 * (number - 0.5 * (len(names) - 1)), plotting.points(number)
        heights = [row.period if row.period and 1 < row.period <= 12 else 1 for row in mine]
        axis.plot(
            [row.f_times_t for row in mine],
            [height + shift for height in heights],
            **style,
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
            label=name,
        )
    for m in range(2, 13):
        edges = band_of(scene, m)
        axis.fill_between(
            [edges.lower * period, edges.upper * period],
            m - 0.42,
            m + 0.42,
            color="0.88",
            linewidth=0.0,
            zorder=0,
            gid=f"band of the map, m = {m}",
        )
    axis.set_xlim(SPAN[0] - 0.003, SPAN[1] + 0.003)
    axis.set_ylim(0.4, 12.6)
    axis.set_yticks([1, *range(2, 13)], ["other", *(str(m) for m in range(2, 13))])
    axis.errorbar(
        [f * letter.FREE_PERIOD_S for f in letter.PERIODS],
        list(letter.PERIODS.values()),
        xerr=[f * letter.FREE_PERIOD_ERROR_S for f in letter.PERIODS],
        **plotting.LETTER_POINTS,
        elinewidth=0.7,
        ecolor="black",
        label="letter, error of T",
    )
    plotting.label(axis.xaxis, "$f T$")
    plotting.label(axis.yaxis, f"period $m$ born, excess {scene.scan.born_excess:g}")
    figure.legend(
        loc="outside lower center",
        ncols=3,
        title="grey: bands of the Nordmark map",
        title_fontsize=plotting.NOTE,
    )
    return figure
