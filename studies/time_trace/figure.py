"""The figures of a settled orbit: motion in time with one collision from close by, and the spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.plotting import BLUE, GUIDE, NOTE, PAGE, VERMILION, in_house_style, label, new_figure, panel
from studies.time_trace.close_up import CloseUp

__all__ = ["draw_spectrum", "draw_trace"]

Array = NDArray[np.float64]

NUMBER_WIDTH = 13.0
"""Room that the number of a mode takes, in dots of the screen."""

MOST_DRAWN = 4_000
"""Points of a line: more than a page has dots."""


@in_house_style
def draw_trace(
    motion: tuple[Array, Array, Array], impact_times: Array, near: CloseUp | None, gap: float, unit: str,
    title: str,
) -> Figure:  # fmt: skip
    """Time [s], tip [m] and read-out [m or rad], impacts marked, and one collision beside them."""
    times, tip, readout = motion
    figure, axes = new_figure(
        2,
        2,
        width=PAGE,
        height=0.090,
        sharex="col",
        gridspec_kw={"width_ratios": [2.3, 1.0]},
    )
    left, right = axes[:, 0], axes[:, 1]
    step = max(1, times.size // MOST_DRAWN)
    time = 1e3 * times[::step]
    for axis, shown, name in zip(left, (tip, readout), ("tip", "read-out"), strict=True):
        axis.plot(time, 1e3 * shown[::step], color=BLUE, linewidth=0.8, gid=name)
        axis.margins(x=0.0)
        if name == "tip":
            label(axis.yaxis, "tip displacement $ξ$", "mm")
        else:
            label(axis.yaxis, "read-out rotation" if unit == "mrad" else "read-out displacement", unit)
    left[0].axhline(1e3 * gap, **GUIDE)
    top = 1e3 * max(gap, float(tip.max()))
    left[0].set_ylim(1e3 * float(tip.min()) - 1.0, top * 1.25)
    left[0].plot(
        1e3 * impact_times,
        np.full(impact_times.size, 1.12 * top),
        linestyle="none",
        marker="v",
        color=VERMILION,
        markersize=4.0,
    )
    label(left[1].xaxis, "time", "ms")
    panel(left[0], 0, title)
    panel(left[1], 1, "read-out point")
    left[0].annotate(
        "plate",
        (0.005, 1e3 * gap),
        xycoords=left[0].get_yaxis_transform(),
        fontsize=NOTE,
        va="bottom",
        color="0.35",
    )
    if impact_times.size:
        left[0].annotate(
            "impact",
            (1e3 * impact_times[0], 1.12 * top),
            xytext=(5, 0),
            textcoords="offset points",
            fontsize=NOTE,
            va="center",
            color=VERMILION,
        )
    for at in impact_times:
        left[1].axvline(1e3 * at, color=VERMILION, linewidth=0.6, linestyle=":", zorder=1)
    if near is None:
        for axis in right:
            axis.set_visible(False)
        return figure
    _collision(right, near)
    return figure


def _collision(axes: Sequence[Axes], near: CloseUp) -> None:
    micro = 1e6 * near.time
    axes[0].plot(micro, 1e6 * near.height, color=BLUE, linewidth=1.0)
    axes[0].axhline(0.0, **GUIDE)
    if np.all(np.isfinite(near.force)):
        axes[1].plot(micro, near.force, color=VERMILION, linewidth=1.0)
    for axis in axes:
        for begin, end in near.spans:
            axis.axvspan(1e6 * begin, 1e6 * end, color="0.9", zorder=0, linewidth=0)
        axis.margins(x=0.0)
    panel(axes[0], 2, "collision, contact shaded")
    panel(axes[1], 3)
    label(axes[0].yaxis, "tip past the plate", "µm")
    label(axes[1].yaxis, "contact force", "N")
    label(axes[1].xaxis, "time from the first touch", "µs")
    axes[1].set_ylim(bottom=0.0)


@in_house_style
def draw_spectrum(frequency: Array, amplitude: Array, modes_hz: Array, drive_hz: float, unit: str) -> Figure:
    """Lines of the read-out, with the frequencies of the modes marked above."""
    figure, axis = new_figure(width=PAGE, height=0.070)
    shown = modes_hz[modes_hz <= 0.5 * frequency[-1]]
    limit = 1.25 * float(shown[-1])
    inside = (frequency > 0.0) & (frequency <= limit)
    axis.plot(
        frequency[inside],
        1e3 * amplitude[inside],
        color=BLUE,
        linewidth=0.5,
        marker="o",
        markersize=1.5,
        label="lines of the read-out",
    )
    axis.set_xscale("log")
    axis.set_yscale("log")
    top = 1e3 * float(amplitude[inside].max())
    floor = max(1e3 * float(amplitude[inside].min()), 1e-8 * top)
    axis.set_ylim(0.5 * floor, 30.0 * top)
    axis.set_xlim(0.9 * float(frequency[1]), limit)
    last = -math.inf
    for number, at in enumerate(shown, start=1):
        axis.axvline(at, color=VERMILION, linewidth=0.6, linestyle=":", zorder=1)
        x = float(axis.transData.transform((at, 1.0))[0])
        if x - last > NUMBER_WIDTH:
            _mode_number(axis, at, number)
            last = x
    axis.axvline(drive_hz, color="0.4", linewidth=0.7, linestyle="--", zorder=1, label="drive")
    axis.plot([], [], color=VERMILION, linewidth=0.6, linestyle=":", label="modes, numbered")
    label(axis.xaxis, "frequency", "Hz")
    label(axis.yaxis, "amplitude of the read-out", unit)
    figure.legend(loc="outside lower center", ncols=3, handlelength=2.5)
    return figure


def _mode_number(axis: Axes, at: float, number: int) -> None:
    axis.annotate(
        str(number),
        (at, 0.98),
        xycoords=axis.get_xaxis_transform(),
        ha="center",
        va="top",
        fontsize=NOTE,
        color=VERMILION,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
    )
