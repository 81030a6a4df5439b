"""The figures of a settled orbit: motion in time with one collision from close by, and the spectrum."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from contact import Stop, plots
from studies.experiment.trace import CloseUp, Trace
from studies.shell import plotting
from studies.shell.scene import READOUT

Array = NDArray[np.float64]

APART = 8.0  # least distance of two modes that are both numbered [pt]

MOST_DRAWN = 4_000  # points of a line: more than a page has dots

MARK = {"color": plotting.VERMILION, "linewidth": 0.6, "linestyle": ":", "zorder": 1}


@plotting.in_house_style
def draw_trace(trace: Trace, near: CloseUp | None, stops: Sequence[Stop], unit: str, title: str) -> Figure:
    """Tip and read-out against time, impacts marked, and one collision beside them; `unit` is m or rad."""
    shared: plotting.Style = {
        "sharex": "col",
        "squeeze": False,
        "width_ratios": [2.0, 1.0] if near else [1.0],
    }
    figure, axes = plotting.new_figure(2, 2 if near else 1, width=plotting.PAGE, height=0.095, **shared)
    (tip, readout), step = axes[:, 0], max(1, trace.time.size // MOST_DRAWN)
    hits = [(at, touch.stop) for at, touch in zip(1e3 * trace.impact_times, trace.impacts, strict=True)]
    time, sides = 1e3 * trace.time[::step], [("tip", tip, trace.tip), (READOUT, readout, trace.readout)]
    for number, (at, axis, shown) in enumerate(sides):
        places = {k: 1e3 * stop.side * stop.gap for k, stop in enumerate(stops) if stop.at == at}
        plots.motion(axis, time, 1e3 * shown[::step], places, hits, linewidth=0.8)
        plotting.panel(axis, number, (f"ball: {title}", "read-out point")[number])
    plotting.label(tip.yaxis, "ball", "mm")
    plotting.label(readout.yaxis, "rotation" if unit == "rad" else "read-out", f"m{unit}")
    plotting.label(readout.xaxis, "time", "ms")
    if near:
        _collision(axes[:, 1], near)
    plotting.legend_below(figure, axes.flat, 5)
    return figure


def _collision(axes: Sequence[Axes], near: CloseUp) -> None:
    micro = 1e6 * near.time
    axes[0].plot(micro, 1e6 * near.height, color=plotting.BLUE, linewidth=1.0)
    axes[0].axhline(0.0, **plotting.GUIDE)
    if np.all(np.isfinite(near.force)):
        axes[1].plot(micro, near.force, color=plotting.VERMILION, linewidth=1.0, label="contact force")
    else:
        axes[1].text(0.5, 0.5, "an impact law\nhas no force", transform=axes[1].transAxes, ha="center")
        axes[1].set_yticks([])
    for axis in axes:
        for begin, end in near.spans:
            axis.axvspan(1e6 * begin, 1e6 * end, color="0.9", zorder=0, linewidth=0, label="in contact")
        axis.margins(x=0.0)
    plotting.panel(axes[0], 2, "ball past the plate")
    plotting.panel(axes[1], 3, "contact force")
    plotting.label(axes[0].yaxis, "depth", "µm")
    plotting.label(axes[1].yaxis, "force", "N")
    plotting.label(axes[1].xaxis, "time from touch", "µs")
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
    axis.set(xscale="log", yscale="log", ylim=(0.5 * floor, 2.0 * top), xlim=(0.9 * frequency[1], limit))
    last, apart = 0.0, (limit / frequency[1]) ** (APART / (72.0 * 0.85 * figure.get_figwidth()))
    for number, at in enumerate(shown.tolist(), start=1):
        axis.axvline(at, **MARK, label="modes, numbered" if number == 1 else None)
        if at > apart * last:
            style = {"ha": "center", "va": "bottom", "fontsize": plotting.NOTE, "color": plotting.VERMILION}
            axis.text(at, 1.0, str(number), transform=axis.get_xaxis_transform(), **style)
            last = at
    axis.axvline(drive_hz, **plotting.GUIDE, label="drive")
    plotting.label(axis.xaxis, "frequency", "Hz")
    plotting.label(axis.yaxis, "amplitude of the read-out", f"m{unit}")
    plotting.legend_below(figure, [axis], 3)
    return figure
