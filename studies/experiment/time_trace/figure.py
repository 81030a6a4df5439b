"""The figures of a settled orbit: motion in time with one collision from close by, and the spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.experiment.time_trace.model import CloseUp, Trace
from studies.shell import plotting

Array = NDArray[np.float64]

APART = 1.05
"""Least ratio of two frequencies whose modes are both numbered."""

MOST_DRAWN = 4_000
"""Points of a line: more than a page has dots."""

MARK = {"color": plotting.VERMILION, "linewidth": 0.6, "linestyle": ":", "zorder": 1}


@plotting.in_house_style
def draw_trace(trace: Trace, near: CloseUp | None, gap: float, unit: str, title: str) -> Figure:
    """Tip and read-out against time, impacts marked, and one collision beside them; `unit` is m or rad."""
    shared: plotting.Style = {"sharex": "col", "width_ratios": [2.3, 1.0]}
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.090, **shared)
    (tip, readout), step = axes[:, 0], max(1, trace.time.size // MOST_DRAWN)
    for number, (axis, shown) in enumerate(((tip, trace.tip), (readout, trace.readout))):
        axis.plot(1e3 * trace.time[::step], 1e3 * shown[::step], color=plotting.BLUE, linewidth=0.8)
        axis.margins(x=0.0)
        for at in 1e3 * trace.impact_times:
            axis.axvline(at, **MARK)
        plotting.panel(axis, number, (title, "read-out point; dotted: impacts")[number])
    plotting.label(tip.yaxis, "tip displacement $ξ$", "mm")
    plotting.label(readout.yaxis, f"read-out {'rotation' if unit == 'rad' else 'displacement'}", f"m{unit}")
    plotting.label(readout.xaxis, "time", "ms")
    tip.axhline(1e3 * gap, **plotting.GUIDE)
    across = tip.get_yaxis_transform()
    tip.annotate("plate", (0.005, 1e3 * gap), xycoords=across, fontsize=plotting.NOTE, va="bottom")
    if near is None:
        for axis in axes[:, 1]:
            axis.set_visible(False)
    else:
        _collision(axes[:, 1], near)
    return figure


def _collision(axes: Sequence[Axes], near: CloseUp) -> None:
    micro = 1e6 * near.time
    axes[0].plot(micro, 1e6 * near.height, color=plotting.BLUE, linewidth=1.0)
    axes[0].axhline(0.0, **plotting.GUIDE)
    if np.all(np.isfinite(near.force)):
        axes[1].plot(micro, near.force, color=plotting.VERMILION, linewidth=1.0)
    for axis in axes:
        for begin, end in near.spans:
            axis.axvspan(1e6 * begin, 1e6 * end, color="0.9", zorder=0, linewidth=0)
        axis.margins(x=0.0)
    plotting.panel(axes[0], 2, "collision, contact shaded")
    plotting.panel(axes[1], 3)
    plotting.label(axes[0].yaxis, "tip past the plate", "µm")
    plotting.label(axes[1].yaxis, "contact force", "N")
    plotting.label(axes[1].xaxis, "time from the first touch", "µs")
    axes[1].set_ylim(bottom=0.0)


@plotting.in_house_style
def draw_spectrum(frequency: Array, amplitude: Array, modes_hz: Array, drive_hz: float, unit: str) -> Figure:
    """Lines of the read-out, with the frequencies of the modes marked above."""
    figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.070)
    shown = modes_hz[modes_hz <= 0.5 * frequency[-1]]
    limit = 1.25 * float(shown[-1])
    inside = (frequency > 0.0) & (frequency <= limit)
    lines = 1e3 * amplitude[inside]
    axis.plot(frequency[inside], lines, "o-", color=plotting.BLUE, lw=0.5, ms=1.5, label="read-out")
    top = float(lines.max())
    floor = max(float(lines.min()), 1e-8 * top)
    axis.set(xscale="log", yscale="log", ylim=(0.5 * floor, 30.0 * top), xlim=(0.9 * frequency[1], limit))
    last = 0.0
    for number, at in enumerate(shown.tolist(), start=1):
        axis.axvline(at, **MARK, label="modes, numbered" if number == 1 else None)
        if at > APART * last:
            style = {"ha": "center", "va": "top", "fontsize": plotting.NOTE, "color": plotting.VERMILION}
            axis.text(at, 0.98, str(number), transform=axis.get_xaxis_transform(), **style)
            last = at
    axis.axvline(drive_hz, **plotting.GUIDE, label="drive")
    plotting.label(axis.xaxis, "frequency", "Hz")
    plotting.label(axis.yaxis, "amplitude of the read-out", f"m{unit}")
    plotting.legend_below(figure, [axis], 3)
    return figure
