"""The figure of a settled orbit: motion in time, one collision from close by, and the spectrum."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.settled_trace import CloseUp, Trace

__all__ = ["draw_spectrum", "draw_trace"]

NUMBER_WIDTH = 13.0
"""Room that the number of a mode takes, in dots of the screen."""

MOST_DRAWN = 20_000
"""Points of a line: more than a page has dots."""


def draw_trace(trace: Trace, near: CloseUp | None, gap: float, unit: str, title: str) -> Any:
    """Tip and read-out point against time, impacts marked, and one collision beside them."""
    figure, axes = new_figure(
        2, 2, width=PAGE, height=0.090, sharex="col", gridspec_kw={"width_ratios": [2.3, 1.0]},
    )
    left, right = axes[:, 0], axes[:, 1]
    step = max(1, trace.time.size // MOST_DRAWN)
    time = 1e3 * trace.time[::step]
    for axis, motion, name in zip(left, (trace.tip, trace.readout), ("tip", "read-out point"), strict=True):
        axis.plot(time, 1e3 * motion[::step], color=PALETTE[1], linewidth=0.8)
        axis.margins(x=0.0)
        with house_style():
            label(axis.yaxis, name, "mm" if name == "tip" else unit)
    left[0].axhline(1e3 * gap, color="0.5", linewidth=0.7, linestyle="--", zorder=1)
    top = 1e3 * max(gap, float(trace.tip.max()))
    left[0].set_ylim(1e3 * float(trace.tip.min()) - 1.0, top * 1.25)
    left[0].plot(
        1e3 * trace.impact_times, np.full(trace.impact_times.size, 1.12 * top), linestyle="none", marker="v",
        color=PALETTE[2], markersize=4.0,
    )
    with house_style():
        label(left[1].xaxis, "time", "ms")
        left[0].set_title(title, loc="left")
        left[0].annotate("plate", (0.005, 1e3 * gap), xycoords=left[0].get_yaxis_transform(), fontsize=6.5,
                         va="bottom", color="0.4")
    if trace.impact_times.size:
        with house_style():
            left[0].annotate("impact", (1e3 * trace.impact_times[0], 1.12 * top), xytext=(5, 0),
                             textcoords="offset points", fontsize=6.5, va="center", color=PALETTE[2])
    for at in trace.impact_times:
        left[1].axvline(1e3 * at, color=PALETTE[2], linewidth=0.6, linestyle=":", zorder=1)
    if near is None:
        for axis in right:
            axis.set_visible(False)
        return figure
    _collision(right, near)
    return figure


def _collision(axes: np.ndarray, near: CloseUp) -> None:
    micro = 1e6 * near.time
    axes[0].plot(micro, 1e6 * near.height, color=PALETTE[1], linewidth=1.0)
    axes[0].axhline(0.0, color="0.5", linewidth=0.7, linestyle="--", zorder=1)
    if np.all(np.isfinite(near.force)):
        axes[1].plot(micro, near.force, color=PALETTE[2], linewidth=1.0)
    for axis in axes:
        for begin, end in near.spans:
            axis.axvspan(1e6 * begin, 1e6 * end, color="0.9", zorder=0, linewidth=0)
        axis.margins(x=0.0)
    with house_style():
        axes[0].set_title("one collision, contact shaded", loc="left")
        label(axes[0].yaxis, "tip past the plate", "µm")
        label(axes[1].yaxis, "contact force", "N")
        label(axes[1].xaxis, "time from the first touch", "µs")
    axes[1].set_ylim(bottom=0.0)


def draw_spectrum(
    frequency: np.ndarray, amplitude: np.ndarray, modes_hz: np.ndarray, drive_hz: float, unit: str
) -> Any:
    """Lines of the read-out, with the frequencies of the modes marked above."""
    figure, axis = new_figure(width=PAGE, height=0.070)
    shown = modes_hz[modes_hz <= 0.5 * frequency[-1]]
    limit = 1.25 * float(shown[-1])
    inside = (frequency > 0.0) & (frequency <= limit)
    axis.plot(
        frequency[inside],
        1e3 * amplitude[inside],
        color=PALETTE[1],
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
        axis.axvline(at, color=PALETTE[2], linewidth=0.6, linestyle=":", zorder=1)
        x = float(axis.transData.transform((at, 1.0))[0])
        if x - last > NUMBER_WIDTH:
            _mode_number(axis, at, number)
            last = x
    axis.axvline(drive_hz, color="0.4", linewidth=0.7, linestyle="--", zorder=1, label="drive")
    axis.plot([], [], color=PALETTE[2], linewidth=0.6, linestyle=":", label="modes, numbered")
    with house_style():
        label(axis.xaxis, "frequency", "Hz")
        label(axis.yaxis, "amplitude at the read-out point", unit)
        figure.legend(loc="outside lower center", ncols=3, handlelength=2.5)
    return figure


def _mode_number(axis: Axes, at: float, number: int) -> None:
    with house_style():
        axis.annotate(
            str(number), (at, 0.98), xycoords=axis.get_xaxis_transform(), ha="center", va="top", fontsize=6.5,
            color=PALETTE[2], bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
        )
