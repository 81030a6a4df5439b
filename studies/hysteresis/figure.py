"""The letter's Fig. 3 with four of the descriptions, all of them over the beam, and the causes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact import Band, bands
from studies import letter, plotting
from studies.hysteresis.columns import FREQUENCIES_HZ
from studies.hysteresis.descriptions import CAUSES, Row
from studies.plotting import BLACK, BLUE, GREEN, GUIDE, LETTER, NOTE, PAGE, PALETTE, VERMILION
from studies.scene import Scene, corresponding, periods_of

NAMES = {
    "map": "map",
    "map_measured_kick": "map, measured kick for 1 + τ",
    "single_mode": "Eq. (1)",
    "two_parameters": "one mode, loss and delay",
    "all_mode_kick": "kick of all modes",
    "beam": "beam",
}
CURVES = (
    "The letter's Fig. 3, computed: where the p_m orbits end when the amplitude is lowered, against the "
    "drive frequency, for m = 3 to 10; below the same on a logarithmic scale. The beam follows the bands of "
    "the map, at another size and bent by the ringing of its second mode; crosses: folds of the equations "
    "alone, whose orbit would touch the plate elsewhere too."
)
BARS = (
    "Factor of each cause at the letter's frequencies; above one it enlarges the hysteresis. Truncation of "
    "the map and size of the kick oppose each other everywhere; delay and ringing decide where the "
    "hysteresis is small."
)
RATIOS = "Hysteresis of each description over the beam's. Only the kick of all modes stays at one throughout."
"""Captions."""

STYLES: dict[str, dict[str, Any]] = {
    "map": {"color": BLACK, "linestyle": "-"},
    "single_mode": {"color": BLUE, "linestyle": "--"},
    "two_parameters": {"color": GREEN, "linestyle": "-."},
    "beam": {"color": VERMILION, "linestyle": "-", "marker": "o", "markersize": 2.4, "mfc": "none"},
}
"""Descriptions in the figure like the letter's."""


@plotting.in_house_style
def draw_curves(scene: Scene, rows: Sequence[Row]) -> Figure:
    """Folds against frequency, linear and logarithmic."""
    figure, axes = plotting.new_figure(2, 1, width=PAGE, height=0.128, sharex=True)
    keys, periods = scene.single_mode, sorted({row.m for row in rows})
    edges = bands(periods, free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s,
                  restitution=keys.restitution)  # fmt: skip
    for axis, logarithmic in zip(axes, (False, True), strict=True):
        curves(axis, rows, periods, logarithmic)
        # f T at the edge is fixed: an error of T moves it by as much
        unsure = letter.FREE_PERIOD_ERROR_S / letter.FREE_PERIOD_S
        for place, edge in enumerate(edges):
            name = "_" if place else "upper edge of a band, letter's error of T"
            low, high = edge.upper * (1.0 - unsure), edge.upper * (1.0 + unsure)
            axis.axvspan(low, high, color="0.82", linewidth=0, zorder=0, label=name)
        letters_frequencies(axis, scene, "letter's Fig. 2: p$_m$ seen here")
    names_of_bands(axes, scene, edges)
    axes[0].set_ylim(-0.16, 0.005)
    axes[0].axhline(0.0, **GUIDE)
    axes[1].set_yscale("log")
    axes[1].set_ylim(1e-6, 0.3)
    stable = "letter: stability of the amplitude"
    plotting.mark_letter(axes[1].yaxis, letter.AMPLITUDE_STABILITY, words=stable, along=0.01)
    plotting.label(axes[0].yaxis, "$F_m/F_g - 1$")
    plotting.label(axes[1].yaxis, plotting.HYSTERESIS)
    plotting.label(axes[1].xaxis, "excitation frequency", "Hz")
    for place, axis in enumerate(axes):
        plotting.panel(axis, place)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def curves(axis: Axes, rows: Sequence[Row], periods: Sequence[int], logarithmic: bool) -> None:
    """The descriptions, a line for each period; crosses on folds of the beam that are not admissible."""
    sign = -1.0 if logarithmic else 1.0
    for m in periods:
        for name, style in STYLES.items():
            found = [row for row in rows if row.m == m and (row.excess(name) or 0.0) < 0.0]
            y = [sign * (row.excess(name) or 0.0) for row in found]
            words = NAMES[name] if m == periods[0] else "_"
            axis.plot([row.frequency_hz for row in found], y, **style, linewidth=0.9, label=words)
    crossed = [row for row in rows if (row.beam or 0.0) < 0.0 and not row.beam_admissible]
    y = [sign * (row.beam or 0.0) for row in crossed]
    looks: dict[str, Any] = {"linestyle": "none", "marker": "x", "markersize": 3.5, "color": VERMILION}
    axis.plot([row.frequency_hz for row in crossed], y, **looks, label="beam, not admissible")


def letters_frequencies(axis: Axes, scene: Scene, name: str) -> None:
    """A line at each of the letter's frequencies."""
    for place, seen in enumerate(periods_of(scene)):
        axis.axvline(seen, **LETTER, label="_" if place else name)


def names_of_bands(axes: Sequence[Axes], scene: Scene, edges: Sequence[Band]) -> None:
    """m of the bands on top, and at the letter's frequencies below."""
    lowest, highest = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    axes[1].set_xlim(lowest, highest)
    for seen, m in periods_of(scene).items():
        axes[1].annotate(
            f"p$_{{{m}}}$", (seen, 0.02), xytext=(-1.5, 0), textcoords="offset points", ha="right",
            xycoords=("data", "axes fraction"), va="bottom", fontsize=NOTE,
        )  # fmt: skip
    for edge in edges:
        middle = 0.5 * (max(edge.lower, lowest) + edge.upper)
        words = f"$m$ = {edge.period}" if edge.period < 6 else f"{edge.period}"
        if middle < highest:
            axes[0].annotate(words, (middle, 1.01), xycoords=("data", "axes fraction"), ha="center",
                             va="bottom", fontsize=NOTE)  # fmt: skip


@plotting.in_house_style
def draw_ratios(scene: Scene, rows: Sequence[Row]) -> Figure:
    """Every description over the beam, against frequency."""
    figure, axis = plotting.new_figure(width=PAGE, height=0.075)
    for number, name in enumerate(name for name in NAMES if name != "beam"):
        found = [row for row in rows if row.ratio(name) is not None and (row.beam or 0.0) < 0.0]
        axis.plot([row.frequency_hz for row in found], [row.ratio(name) for row in found],
                  **plotting.points(number), markersize=3.0, mfc="none", label=NAMES[name])  # fmt: skip
    axis.axhline(1.0, color="0.4", linewidth=0.8)
    letters_frequencies(axis, scene, "letter's frequencies")
    axis.set_yscale("log")
    axis.set_ylim(0.1, 20.0)
    axis.set_yticks([0.1, 0.3, 1.0, 3.0, 10.0], ["0.1", "0.3", "1", "3", "10"])
    axis.minorticks_off()
    plotting.label(axis.xaxis, "excitation frequency", "Hz")
    plotting.label(axis.yaxis, "hysteresis / that of the beam")
    figure.legend(loc="outside lower center", ncols=3)
    return figure


@plotting.in_house_style
def draw_causes(rows: Sequence[Row]) -> Figure:
    """From the map to the beam, cause by cause, at the letter's frequencies; crosses: there is no fold."""
    figure, axis = plotting.new_figure(width=PAGE, height=0.075)
    width, hatches = 0.8 / len(CAUSES), ("", "///", "...", "xxx", "\\\\\\", "++")
    for number, cause in enumerate(CAUSES):
        places = np.arange(len(rows)) + (number - 0.5 * (len(CAUSES) - 1)) * width
        heights = np.array([row.factor(cause) or np.nan for row in rows])
        known = np.isfinite(heights)
        axis.bar(
            places[known], heights[known] - 1.0, width, bottom=1.0, color=PALETTE[number + 1],
            edgecolor="white", hatch=hatches[number], linewidth=0.3, label=cause.replace("_", " "),
        )  # fmt: skip
        missing = places[~known]
        axis.plot(missing, np.ones(missing.size), "x", markersize=4.0, color=BLACK)
    axis.axhline(1.0, color="0.3", linewidth=0.8)
    axis.set_yscale("log")
    ticks = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
    axis.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.minorticks_off()
    axis.set_xticks(np.arange(len(rows)), [f"{row.frequency_hz:.2f} Hz, p$_{{{row.m}}}$" for row in rows])
    plotting.label(axis.xaxis, "drive frequency and period of the orbit (×: no fold below grazing)")
    plotting.label(axis.yaxis, "factor on the hysteresis")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
