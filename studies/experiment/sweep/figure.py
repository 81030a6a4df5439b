"""The numbers of a sweep: lines over one axis with the periods as colours, or maps over two."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis as Ruler
from matplotlib.axis import XAxis
from matplotlib.figure import Figure

from studies.experiment.period_colours import (
    FAILED,
    LAST,
    NAMES,
    NONE,
    PERIODS,
    key_of_periods,
    paint_periods,
)
from studies.experiment.sweep.model import ALL, DRIVE, WITHOUT, Axis
from studies.shell import plotting

PANELS = {
    "peak_force": ("peak force", "N"),
    "approach": ("approach speed", "m/s"),
    "energy_lost": ("energy lost per drive period", "J"),
}
"""Quantity -> its words and unit."""

ENDS = {"kg/m^3": "kg_m3", "kg m^2": "kg_m2", "N s/m": "ns_per_m", "1/s": "per_s"}
"""How keys spell units, where they do not write them as they are, with per for a stroke."""

LEAST_WIDTH = 0.09  # part of a small panel's sides that a region must have to be given its number


@plotting.in_house_style
def draw(axes: Sequence[Axis], cells: Mapping[str, np.ndarray], title: str) -> Figure:
    """The figure: maps where both axes have more than one value."""
    long = [axis for axis in axes if len(axis.values) > 1]
    if len(long) == 2:
        figure = _maps(long, cells)
    else:
        figure = _lines((long or axes)[0], {name: values.ravel() for name, values in cells.items()})
    figure.suptitle(title, fontsize=plotting.STYLE["axes.titlesize"])
    return figure


def _lines(axis: Axis, cells: Mapping[str, np.ndarray]) -> Figure:
    """Impacts, force, speed and energy over one axis, marked by period."""
    figure, panels = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.115, sharex=True)
    x, period, impacts = np.array(axis.values), cells["m"], cells["impacts"]
    kinds = np.where(impacts == 0, 0, np.minimum(period, LAST))
    words = ["no impact", *(f"period {NAMES[k]}" for k in range(1, LAST + 1))]
    looks = {words[k]: ((period > 0) & (kinds == k), PERIODS[k]) for k in range(LAST + 1)}
    looks["no period up to 64"] = period == 0, NONE
    shown = {"impacts": ("impacts per drive period", "1"), **PANELS}
    values = {**cells, "impacts": impacts / np.where(period > 0, period, WITHOUT)}
    for number, (panel, (name, (what, unit))) in enumerate(zip(panels.flat, shown.items(), strict=True)):
        y = np.where(period < 0, np.nan, values[name])
        panel.plot(x, y, color="0.75", linewidth=0.7, zorder=1)
        for text, (where, colour) in looks.items():
            mark: plotting.Style = {"mfc": colour, "mec": "0.25", "mew": 0.4, "clip_on": False}
            if where.any():
                panel.plot(x[where], y[where], "o", **mark, label=text)
        for at in x[period < 0]:
            panel.axvline(at, color=FAILED, linewidth=0.6, zorder=0, label="failed")
        _name(panel, number, what, y)
        plotting.label(panel.yaxis, what.partition(" per ")[0], unit)
        panel.set_ylim(bottom=0.0)
    for panel in panels[1]:
        _name_axis(panel.xaxis, axis)
    plotting.legend_below(figure, panels.flat, 6)
    return figure


def _maps(axes: Sequence[Axis], cells: Mapping[str, np.ndarray]) -> Figure:
    """Period, force, speed and energy over two axes."""
    figure, panels = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.135, sharex=True, sharey=True)
    x, y = (np.array(axis.values) for axis in axes)
    paint_periods(panels[0, 0], x, y, cells["m"].T, cells["impacts"].T, LEAST_WIDTH)
    plotting.panel(panels[0, 0], 0, "period")
    for number, (panel, (name, (what, unit))) in enumerate(zip(panels.flat[1:], PANELS.items(), strict=True)):
        _name(panel, 1 + number, what, cells[name])
        panel.set_facecolor("0.85")  # where there is no number
        if np.any(cells[name] > 0.0):
            image = panel.pcolormesh(x, y, cells[name], shading="nearest", vmin=0.0, rasterized=True)
            plotting.label(figure.colorbar(image, ax=panel).ax.yaxis, what.partition(" per ")[0], unit)
    for panel in panels[1]:
        _name_axis(panel.xaxis, axes[0])
    for panel in panels[:, 0]:
        _name_axis(panel.yaxis, axes[1])
    key_of_periods(figure, cells["m"], cells["impacts"], loc="outside lower center", ncols=8)
    return figure


def _name(panel: Axes, number: int, what: str, values: np.ndarray) -> None:
    """Name a panel, and say so where it shows nothing."""
    plotting.panel(panel, number, what)
    if not np.any(values > 0.0):
        style: plotting.Style = {"ha": "center", "fontsize": plotting.NOTE, "transform": panel.transAxes}
        panel.text(0.5, 0.5, "nowhere above zero", **style)


def _name_axis(ruler: Ruler, axis: Axis) -> None:
    """Name what is swept, without the unit at the end of its key."""
    unit = axis.unit or "1"
    end = ENDS.get(unit, unit.lower().replace("/", "_per_"))
    words = axis.name.removesuffix(f"_{end}").replace(".", ": ").replace("_", " ")
    words = {name: ALL[name].meaning for name in DRIVE}.get(axis.name, words)
    plotting.label(ruler, plotting.EXCESS if axis.name == "excess" else words, unit)
    scale = ruler.axes.set_xscale if isinstance(ruler, XAxis) else ruler.axes.set_yscale
    scale("linear" if axis.even else "log")
