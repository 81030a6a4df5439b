"""Hysteresis and secondary bifurcation against restitution."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies import letter
from studies.experiment.claims.model import Node
from studies.shell import plotting

LOSS = (
    "Hysteresis against restitution at each frequency, for the map and Eq. (1): with a smaller restitution "
    "more energy is lost, and the hysteresis is less. Below: excess of the secondary bifurcation of Eq. (1), "
    "and the share of the drive frequencies at which it lies below grazing."
)


@plotting.in_house_style
def draw_loss(
    rows: Sequence[Node], tau: NDArray[np.float64], below: NDArray[np.float64], *, letters: bool
) -> Figure:
    """Hysteresis and secondary bifurcation against tau."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.130, sharex=True)
    panels: dict[str, Callable[[Node], float]] = {
        "map: hysteresis": lambda row: -row.fold_of_map,
        "Eq. (1): hysteresis": lambda row: -row.fold if row.admissible else math.nan,
        "Eq. (1): secondary bifurcation": lambda row: row.secondary if row.admissible else math.nan,
    }
    for axis, value in zip(axes.flat, panels.values(), strict=False):
        for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
            mine = [row for row in rows if row.frequency_hz == frequency]
            curve = [row.restitution for row in mine], [1e2 * value(row) for row in mine]
            name = f"{frequency:.2f} Hz, p$_{{{mine[0].m}}}$"
            axis.plot(*curve, markevery=3, **plotting.series(number % 8), label=name)
    axes[1, 1].plot(tau, 1e2 * below, color=plotting.BLUE)
    axes[1, 0].axhline(0.0, **plotting.GUIDE, label="grazing")
    axes[0, 1].sharey(axes[0, 0])
    if any(not row.admissible for row in rows):
        at: plotting.Style = {"transform": axes[0, 1].transAxes, "fontsize": plotting.NOTE, "ha": "right"}
        axes[0, 1].text(0.99, 0.02, "a curve ends at a second impact", **at)
    for axis in axes[0]:
        axis.set_yscale("log")
        plotting.label(axis.yaxis, "$1 - F_m/F_g$", "%")
    plotting.label(axes[1, 0].yaxis, plotting.EXCESS, "%")
    plotting.label(axes[1, 1].yaxis, "frequencies", "%")
    titles = *panels, "Eq. (1): share below grazing"
    for place, (axis, title) in enumerate(zip(axes.flat, titles, strict=True)):
        plotting.panel(axis, place, title)
        if letters:
            plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.02 if place == 2 else 0.98)
    for axis in axes[1]:
        plotting.label(axis.xaxis, "restitution τ")
    plotting.legend_below(figure, (axes[0, 0], axes[1, 0]), 3)
    return figure
