"""The numbers of a sweep: lines over one axis with the periods as colours, or maps over two."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from studies.experiment.period_colours import FAILED, colours_of, key_of_periods, paint
from studies.experiment.sweep.model import ALL, DRIVE, WITHOUT, Axis
from studies.shell import plotting

PANELS = {
    "impacts": ("impacts per drive period", "1"),
    "peak_force": ("peak force", "N"),
    "approach": ("approach speed", "m/s"),
    "energy_lost": ("energy lost per drive period", "J"),
}
"""Quantity -> its words and unit; a map has the periods in place of the impacts."""

LEAST_WIDTH = 0.09  # part of a small panel's sides that a region must have to be given its number


@plotting.in_house_style
def draw(axes: Sequence[Axis], cells: Mapping[str, np.ndarray], title: str) -> Figure:
    """The figure: maps where there are two axes."""
    x, *others = (np.array(axis.values) for axis in axes)
    size: plotting.Style = {"width": plotting.PAGE, "height": 0.135 if others else 0.115}
    figure, panels = plotting.new_figure(2, 2, **size, sharex=True, sharey=bool(others))
    period, impacts = cells["m"], cells["impacts"]
    struck = np.where(impacts > 0, period, 0)
    rate = impacts / np.where(period > 0, period, WITHOUT)
    shown = {**cells, "impacts": np.where(period < 0, np.nan, rate)}
    for number, (panel, (name, (what, unit))) in enumerate(zip(panels.flat, PANELS.items(), strict=True)):
        is_period = bool(others) and name == "impacts"
        plotting.panel(panel, number, "period" if is_period else what)
        if is_period:
            paint(panel, x, others[0], period.T, struck.T, least=LEAST_WIDTH)
        elif not np.any(shown[name] > 0.0):
            panel.text(0.5, 0.5, "nowhere above zero", ha="center", transform=panel.transAxes)
        elif others:
            panel.set_facecolor("0.85")  # where there is no number
            image = panel.pcolormesh(x, others[0], shown[name], shading="nearest", vmin=0.0, rasterized=True)
            plotting.label(figure.colorbar(image, ax=panel).ax.yaxis, what.partition(" per ")[0], unit)
        else:
            y, colours = shown[name][0], colours_of(period, struck)[0]
            panel.plot(x, y, color="0.75", linewidth=0.7, zorder=1)
            panel.scatter(x, y, 12.0, colours, edgecolors="0.25", linewidths=0.4, clip_on=False, zorder=2)
            panel.vlines(x[period[0] < 0], 0.0, 1.0, FAILED, transform=panel.get_xaxis_transform())
            plotting.label(panel.yaxis, what.partition(" per ")[0], unit)
            panel.set_ylim(bottom=0.0)
    for way, axis, row in zip("xy", axes, (panels[1], panels[:, 0]), strict=False):
        known, scale = ALL[axis.name], "log" if axis.log else "linear"
        for panel in row:
            panel.set(**{f"{way}scale": scale})
            if not axis.log:
                panel.locator_params(axis=way, nbins=5)
                panel.ticklabel_format(axis=way, scilimits=(-2, 4))
            ruler, words = getattr(panel, f"{way}axis"), known.meaning if axis.name in DRIVE else axis.name
            plotting.label(ruler, words, known.unit)
    key_of_periods(figure, period, struck, loc="outside lower center", ncols=8)
    figure.suptitle(title, fontsize=plotting.STYLE["axes.titlesize"])
    return figure
