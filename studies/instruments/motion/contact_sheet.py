"""Stills of a film on one page, and where in the trace they were taken."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.instruments.figures import INCH, PAGE, PALETTE, house_style, label
from studies.instruments.motion.marks import Marks, Place
from studies.instruments.motion.orbit_film import OrbitFilm

__all__ = ["draw_sheet"]

COLUMNS = 2

TITLE, TRACE = 0.0055, 0.046
"""Heights of the line above a still and of the trace [m]."""


def draw_sheet(
    film: OrbitFilm, numbers: Sequence[int], pictures: Sequence[NDArray[np.uint8]], title: str, scale: str
) -> Any:
    """A figure with a picture for each of these frames, in their order."""
    view, orbit = film.view, film.orbit
    rows = math.ceil(len(numbers) / COLUMNS)
    wide = (PAGE - 0.002) / COLUMNS
    tall = wide * view.height / view.width
    height = 0.0125 + rows * (tall + TITLE) + TRACE
    figure = Figure(figsize=(PAGE / INCH, height / INCH), facecolor="white")
    FigureCanvasAgg(figure)
    with house_style():
        figure.text(0.01, 1.0 - 0.0015 / height, title, va="top", fontsize=9.0, fontweight="bold")
        figure.text(0.01, 1.0 - 0.0065 / height, scale, va="top", fontsize=7.0, color="0.25")
        for place, (number, picture) in enumerate(zip(numbers, pictures, strict=True)):
            row, column = divmod(place, COLUMNS)
            bottom = height - 0.0115 - (row + 1) * (tall + TITLE)
            box = (column * (wide + 0.002) / PAGE, bottom / height, wide / PAGE, tall / height)
            frame = Place(figure, view, box)
            frame.show(picture)
            marks = Marks(frame, film.bodies.bench, film.reach, size=5.5)
            marks.show(film.moment(number))
            now, slowed = 1e3 * orbit.law.time[number], orbit.law.slowed[number]
            words = f"{place + 1}:  {now:.3f} ms, slowed {slowed:g} times"
            figure.text(box[0] + 0.02 * box[2], box[1] + box[3], words, va="bottom", fontsize=7.0)
        trace = figure.add_axes((0.075, 0.0105 / height, 0.915, (TRACE - 0.0155) / height))
        _trace(trace, film, numbers)
    return figure


def _trace(axes: Axes, film: OrbitFilm, numbers: Sequence[int]) -> None:
    orbit, gap = film.orbit, 1e3 * film.orbit.oscillator.stop.gap
    axes.plot(1e3 * orbit.line.time, 1e3 * orbit.line.tip, color=PALETTE[1], linewidth=0.9, gid="tip")
    axes.axhline(gap, color="0.35", linewidth=0.8, linestyle="--", zorder=1, gid="plate")
    axes.annotate("plate", (0.004, gap), xycoords=axes.get_yaxis_transform(), fontsize=6.5, va="bottom",
                  color="0.35")
    axes.plot(1e3 * orbit.strobes.time, 1e3 * orbit.strobes.tip, color=PALETTE[2], marker="D",
              linestyle="none", markersize=3.5, label="strobe points", clip_on=False)
    axes.set_xlim(0.0, 1e3 * orbit.duration)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.42 * (high - low))
    touches = [1e3 * first for first, _ in orbit.contacts]
    axes.plot(touches, [high + 0.06 * (high - low)] * len(touches), color="black", marker="v",
              linestyle="none", markersize=3.5, label="impacts")
    times = [1e3 * float(orbit.law.time[number]) for number in numbers]
    for group in _together(times, 25.0 * orbit.duration):
        for place, now in group.items():
            axes.axvline(now, color="0.6", linewidth=0.5, linestyle=":", zorder=0, gid=f"still {place}")
        places = list(group)
        words = str(places[0]) if len(places) == 1 else f"{places[0]}–{places[-1]}"
        axes.annotate(words, (group[places[-1]], high + 0.34 * (high - low)), fontsize=6.5, xytext=(2.0, 0.0),
                      textcoords="offset points", va="center")
    label(axes.xaxis, "time", "ms")
    label(axes.yaxis, "tip displacement", "mm")
    axes.legend(loc="lower left", ncols=2, bbox_to_anchor=(0.0, 0.98), borderaxespad=0.0)


def _together(times: Sequence[float], near: float) -> list[dict[int, float]]:
    """Number of each still -> time, stills closer than `near` to the one before in one group."""
    groups: list[dict[int, float]] = []
    for place, now in enumerate(times, start=1):
        if groups and now - max(groups[-1].values()) < near:
            groups[-1][place] = now
        else:
            groups.append({place: now})
    return groups
