"""A frame of the film: the spring above, strobe points and trace below.

What does not change is drawn once; a frame adds the picture, the lines that grow and the numbers. Digits
have one width and every axis is fixed, so that nothing but the motion moves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.instruments.figures import PALETTE, house_style, label
from studies.instruments.motion.bench import Bench
from studies.instruments.motion.filmed_orbit import FilmedOrbit
from studies.instruments.motion.marks import Marks, Place
from studies.instruments.motion.scene_bodies import Moment
from studies.instruments.motion.view import View

__all__ = ["HEAD", "HEIGHT", "PICTURE", "WIDTH", "Panels"]

WIDTH, HEIGHT = 960, 720
"""Of a frame in points; both divide by 16, as video formats like it."""

HEAD, PICTURE = 62, 368
"""Heights of the lines on top and of the picture [points]."""

FOOT, CAPTION = 56, 30
"""Room below the axes of the panels and above them [points]."""

CLOSE, TOGETHER = 0.12, 1e-3
"""Spread of the strobe points over the extent of the orbit, below which they are drawn larger, and below
which they cannot be told apart anyway."""

DOTS = 120
"""Points per inch: letters of 8 pt are 13 points high."""


class Panels:
    """Draws the frames of one film."""

    def __init__(
        self,
        orbit: FilmedOrbit,
        view: View,
        bench: Bench,
        reach: NDArray[np.float64],
        title: str,
        scale: str,
    ) -> None:
        """`title` says what is seen, `scale` what is enlarged; the base moves by `reach` (3,) [m] at most."""
        self._orbit = orbit
        figure = Figure(figsize=(WIDTH / DOTS, HEIGHT / DOTS), dpi=DOTS, facecolor="white")
        self._figure, self._canvas = figure, FigureCanvasAgg(figure)
        below = HEIGHT - HEAD - PICTURE
        with house_style():
            self._place = Place(figure, view, (0.0, below / HEIGHT, 1.0, PICTURE / HEIGHT))
            self._marks = Marks(self._place, bench, reach)
            low, tall = FOOT / HEIGHT, (below - FOOT - CAPTION) / HEIGHT
            phase = figure.add_axes((0.075, low, 0.27, tall))
            trace = figure.add_axes((0.425, low, 0.56, tall))
            left = 12.0 / WIDTH
            top = 1.0 - 8.0 / HEIGHT
            figure.text(left, top, title, va="top", fontsize=10.0, fontweight="bold")
            second = 1.0 - 38.0 / HEIGHT
            figure.text(left, second, scale, va="top", fontsize=8.0, color="0.25")
            self._clock = self._number(top, 10.0)
            self._slow = self._number(second, 8.0)
            moving = [*self._phase(phase), *self._trace(trace)]
        marks = [*self._marks.names, *self._marks.moving]
        self._drawn: list[Artist] = [self._place.image, *marks, self._clock, self._slow, *moving]
        for artist in self._drawn:
            artist.set_animated(True)
        self._canvas.draw()
        self._still: Any = self._canvas.copy_from_bbox(figure.bbox)

    def frame(self, number: int, picture: NDArray[np.uint8], moment: Moment) -> NDArray[np.uint8]:
        """The whole frame around a picture of the spring at a moment."""
        orbit = self._orbit
        now = float(orbit.law.time[number])
        self._place.show(picture)
        self._marks.show(moment)
        self._clock.set_text(f"t = {now:.6f} s")
        self._slow.set_text(f"slowed {orbit.law.slowed[number]:>6g} times")
        passed = orbit.strobes.time <= now + 1e-12
        self._show_phase(number, passed)
        self._show_trace(number, now, passed)
        self._canvas.restore_region(self._still)
        for artist in self._drawn:
            self._figure.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()

    def _number(self, height: float, size: float) -> Any:
        """A text on the right whose digits all have the same width."""
        return self._figure.text(
            1.0 - 12.0 / WIDTH, height, "", va="top", ha="right", fontsize=size, family="DejaVu Sans Mono"
        )

    def _phase(self, axes: Axes) -> list[Artist]:
        line, strobes = self._orbit.line, self._orbit.strobes
        places = np.stack([1e3 * strobes.tip, strobes.velocity], axis=1)
        axes.plot(1e3 * line.tip, line.velocity, color="0.85", linewidth=0.8)
        self._gap(axes, upright=True)
        label(axes.xaxis, "tip displacement", "mm")
        label(axes.yaxis, "tip velocity", "m/s")
        middle, extent = self._look_at(axes, places)
        (self._there,) = axes.plot([], [], marker="o", markersize=4.0, color=PALETTE[1], linestyle="none")
        (self._points,) = axes.plot(
            [], [], marker="D", markersize=5.5, color=PALETTE[2], linestyle="none", markeredgecolor="white"
        )
        outwards = (places - middle) / extent
        outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-9)
        self._numbers = [
            axes.annotate(
                str(number), place, xytext=9.0 * away, textcoords="offset points", fontsize=8.0,
                fontweight="bold", color=PALETTE[2], ha="center", va="center",
            )
            for number, (place, away) in enumerate(zip(places, outwards, strict=True), start=1)
        ]  # fmt: skip
        return [self._there, self._points, *self._numbers]

    def _look_at(self, axes: Axes, places: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any]]:
        """Limits and title for strobe points at `places` (n, 2); their middle and the extent of the orbit."""
        line, title = self._orbit.line, "strobe points, one a drive period"
        middle, spread = 0.5 * (places.min(axis=0) + places.max(axis=0)), np.ptp(places, axis=0)
        extent = np.array([1e3 * np.ptp(line.tip), np.ptp(line.velocity)])
        low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
        low, high = low - 0.04 * extent, high + 0.04 * extent
        share = float(np.max(spread / extent))
        if TOGETHER < share < CLOSE:
            title = "strobe points, from close by"
            low, high = middle - 0.9 * share * extent, middle + 0.9 * share * extent
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_title(title, loc="left", fontsize=8.0)
        return middle, extent

    def _show_phase(self, number: int, passed: NDArray[np.bool_]) -> None:
        orbit = self._orbit
        self._there.set_data([1e3 * orbit.tip[number]], [orbit.velocity[number]])
        self._points.set_data(1e3 * orbit.strobes.tip[passed], orbit.strobes.velocity[passed])
        for text, seen in zip(self._numbers, passed.tolist(), strict=True):
            text.set_visible(seen)

    def _trace(self, axes: Axes) -> list[Artist]:
        line = self._orbit.line
        axes.plot(1e3 * line.time, 1e3 * line.tip, color="0.85", linewidth=0.8)
        self._gap(axes, upright=False)
        axes.set_xlim(0.0, 1e3 * self._orbit.duration)
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.16 * (high - low))
        self._impact_level = high + 0.08 * (high - low)
        label(axes.xaxis, "time", "ms")
        label(axes.yaxis, "tip displacement", "mm")
        axes.set_title("tip, seen from the base; triangle: impact", loc="left", fontsize=8.0)
        (self._past,) = axes.plot([], [], color=PALETTE[1], linewidth=1.1)
        self._cursor = axes.axvline(0.0, color="0.3", linewidth=0.8)
        (self._strobed,) = axes.plot(
            [], [], marker="D", markersize=4.5, color=PALETTE[2], linestyle="none", markeredgecolor="white",
            clip_on=False,
        )  # fmt: skip
        (self._impacts,) = axes.plot([], [], marker="v", markersize=5.0, color="black", linestyle="none")
        return [self._cursor, self._past, self._strobed, self._impacts]

    def _show_trace(self, number: int, now: float, passed: NDArray[np.bool_]) -> None:
        orbit = self._orbit
        before = orbit.line.time <= now
        times = np.append(orbit.line.time[before], now)
        self._past.set_data(1e3 * times, 1e3 * np.append(orbit.line.tip[before], orbit.tip[number]))
        self._cursor.set_xdata([1e3 * now, 1e3 * now])
        self._strobed.set_data(1e3 * orbit.strobes.time[passed], 1e3 * orbit.strobes.tip[passed])
        touched = [1e3 * first for first, _ in orbit.contacts if first <= now + 0.5 * orbit.law.step[number]]
        self._impacts.set_data(touched, [self._impact_level] * len(touched))

    def _gap(self, axes: Axes, *, upright: bool) -> None:
        gap = 1e3 * self._orbit.oscillator.stop.gap
        rule: Any = {"color": "0.35", "linewidth": 0.9, "linestyle": "--", "zorder": 1}
        words: Any = {"fontsize": 7.0, "va": "bottom", "color": "0.35"}
        if upright:
            axes.axvline(gap, **rule)
            axes.annotate("plate ", (gap, 0.01), xycoords=axes.get_xaxis_transform(), ha="right", **words)
        else:
            axes.axhline(gap, **rule)
            axes.annotate("plate", (0.005, gap), xycoords=axes.get_yaxis_transform(), **words)
