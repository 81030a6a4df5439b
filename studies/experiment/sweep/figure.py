"""The numbers of a sweep: lines over one axis with the periods as colours, or maps over two."""

from collections.abc import Mapping, Sequence

import numpy as np
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
from studies.experiment.sweep.model import DRIVE, Axis
from studies.shell import plotting

PANELS = {
    "peak_force": ("peak force", "N"),
    "approach": ("approach speed", "m/s"),
    "energy_lost": ("energy lost in a drive period", "J"),
}
"""Quantity -> its words and unit."""

ENDS = {"kg/m^3": "kg_m3", "kg m^2": "kg_m2", "N s/m": "ns_per_m", "1/s": "per_s"}
"""How keys spell units, where they do not write them as they are, with per for a stroke."""


def name_axis(ruler: Ruler, axis: Axis) -> None:
    """Name what is swept, without the unit at the end of its key."""
    unit = axis.unit or "1"
    end = ENDS.get(unit, unit.lower().replace("/", "_per_"))
    words = DRIVE[axis.name].meaning if axis.name in DRIVE else axis.name.removesuffix(f"_{end}")
    plotting.label(ruler, words.replace(".", ": ").replace("_", " "), unit)
    scale = ruler.axes.set_xscale if isinstance(ruler, XAxis) else ruler.axes.set_yscale
    scale("linear" if axis.even else "log")


@plotting.in_house_style
def draw(axes: Sequence[Axis], cells: Mapping[str, np.ndarray], title: str) -> Figure:
    """The figure: maps where both axes have more than one value."""
    long = [axis for axis in axes if len(axis.values) > 1]
    if len(long) == 2:
        return _maps(long, cells, title)
    return _lines((long or list(axes))[0], {name: values.ravel() for name, values in cells.items()}, title)


def _lines(axis: Axis, cells: Mapping[str, np.ndarray], title: str) -> Figure:
    """Impacts, force, speed and energy over one axis, marked by period."""
    figure, panels = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.110, sharex=True)
    x, period, impacts = np.array(axis.values), cells["m"], cells["impacts"]
    kinds = np.where(impacts == 0, 0, np.minimum(period, LAST))
    words = {**NAMES, 0: "no impact"}
    looks = {f"period {words[k]}" if k else words[k]: (kinds == k, PERIODS[k]) for k in range(1, LAST + 1)}
    looks = {words[0]: ((period > 0) & (kinds == 0), PERIODS[0]), **looks}
    looks = {name: (where & (period > 0), colour) for name, (where, colour) in looks.items()}
    looks["no period up to 64"] = (period == 0, NONE)
    quantities = {"impacts": ("impacts in a period", "1"), **PANELS}
    for number, (panel, (name, (what, unit))) in enumerate(zip(panels.flat, quantities.items(), strict=True)):
        y = np.where(period < 0, np.nan, cells[name].astype(float))
        panel.plot(x, y, color="0.75", linewidth=0.7, zorder=1)
        for text, (where, colour) in looks.items():
            if where.any():
                mark: plotting.Style = {"mfc": colour, "mec": "0.25", "mew": 0.4, "markersize": 3.8}
                panel.plot(x[where], y[where], "o", **mark, label=text)
        for at in x[period < 0]:
            panel.axvline(at, color=FAILED, linewidth=0.6, zorder=0, label="failed")
        plotting.panel(panel, number, f"{what}{f': {title}' * (number == 0)}")
        plotting.label(panel.yaxis, what, unit)
        panel.set_ylim(bottom=0.0)
    for panel in panels[1]:
        name_axis(panel.xaxis, axis)
    plotting.legend_below(figure, panels.flat, 6)
    return figure


def _maps(axes: Sequence[Axis], cells: Mapping[str, np.ndarray], title: str) -> Figure:
    """Period, force, speed and energy over two axes."""
    figure, panels = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.130, sharex=True, sharey=True)
    x, y = (np.array(axis.values) for axis in axes)
    paint_periods(panels[0, 0], x, y, cells["m"].T, cells["impacts"].T)
    plotting.panel(panels[0, 0], 0, f"period: {title}")
    key_of_periods(panels[0, 0], cells["m"], cells["impacts"])
    for number, (panel, (name, (what, unit))) in enumerate(zip(panels.flat[1:], PANELS.items(), strict=True)):
        image = panel.pcolormesh(x, y, cells[name], shading="nearest", cmap="viridis", rasterized=True)
        panel.set_facecolor("0.85")  # where there is no number
        plotting.panel(panel, 1 + number, what)
        plotting.label(figure.colorbar(image, ax=panel).ax.yaxis, what, unit)
    for panel in panels[1]:
        name_axis(panel.xaxis, axes[0])
    for panel in panels[:, 0]:
        name_axis(panel.yaxis, axes[1])
    return figure
