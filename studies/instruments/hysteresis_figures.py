"""Figures of the hysteresis: the letter's Fig. 3 with all descriptions, their ratios, and the causes.

Rows are those of ``studies.hysteresis``: F_m/F_g - 1 by description, m and frequency [Hz], and the share of
each cause as a natural logarithm.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contact.maximal_orbits import bands
from studies.instruments.corresponding import corresponding, periods_of
from studies.instruments.figures import (
    BLACK,
    BLUE,
    GREEN,
    GUIDE,
    LETTER,
    NOTE,
    PAGE,
    PALETTE,
    VERMILION,
    in_house_style,
    label,
    mark_letter,
    new_figure,
)
from studies.instruments.hysteresis_causes import CAUSES
from studies.instruments.scene import Scene
from studies.published import (
    AMPLITUDE_STABILITY_M,
    DRIVE_AMPLITUDE_M,
    FREE_PERIOD_ERROR_S,
    FREE_PERIOD_S,
)

__all__ = ["draw_causes", "draw_curves", "draw_ratios"]

PERIODS_DRAWN, FREQUENCIES_DRAWN_HZ = range(3, 11), (19.6, 23.8)

NAMES = {
    "map_printed": "map, y-line as printed",
    "map_measured_kick": "map, measured kick for 1 + τ",
    "map": "map",
    "single_mode": "Eq. (1)",
    "measured_kick": "one mode, measured kick",
    "kick_of_velocity": "one mode, kick against velocity",
    "two_parameters": "one mode, loss and delay",
    "all_mode_kick": "kick of all modes",
    "beam": "beam",
}


STYLES: dict[str, dict[str, Any]] = {
    "map": {"color": BLACK, "linestyle": "-"},
    "single_mode": {"color": BLUE, "linestyle": "--"},
    "two_parameters": {"color": GREEN, "linestyle": "-."},
    "beam": {"color": VERMILION, "linestyle": "-", "marker": "o", "markersize": 2.4, "mfc": "none"},
}
"""Descriptions in the figure like the letter's."""


@in_house_style
def draw_curves(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> Any:
    """The letter's Fig. 3 with the descriptions in it, linear and logarithmic."""
    figure, axes = new_figure(2, 1, width=PAGE, height=0.128, sharex=True)
    keys = scene.single_mode
    edges = bands(
        PERIODS_DRAWN,
        free_period=keys.free_period_s,
        decay_rate=keys.decay_rate_per_s,
        restitution=keys.restitution,
    )
    unsure = FREE_PERIOD_ERROR_S / FREE_PERIOD_S
    periods = periods_of(scene)
    lowest, highest = (corresponding(scene, f) for f in FREQUENCIES_DRAWN_HZ)
    for axis, logarithmic in zip(axes, (False, True), strict=True):
        for m in PERIODS_DRAWN:
            for name, style in STYLES.items():
                chosen = [row for row in rows if row["m"] == m and row[name] is not None and row[name] < 0]
                f = np.array([row["frequency_hz"] for row in chosen])
                y = np.array([row[name] for row in chosen])
                axis.plot(f, -y if logarithmic else y, **style, linewidth=0.9, gid=f"{NAMES[name]}, m = {m}",
                          label=NAMES[name] if m == 3 else None)
        for band in edges:
            # f T at the edge is fixed: an error of T moves it by as much
            axis.axvspan(band.upper * (1.0 - unsure), band.upper * (1.0 + unsure), color="0.82", linewidth=0,
                         zorder=0, gid=f"upper edge, m = {band.period}",
                         label="upper edge of a band, letter's error of T" if band.period == 3 else None)
        for seen, m in periods.items():
            axis.axvline(seen, **LETTER, gid=f"letter, m = {m}",
                         label="letter's Fig. 2: p$_m$ seen here" if seen == min(periods) else None)
    for seen, m in periods.items():
        axes[1].annotate(
            f"p$_{{{m}}}$", (seen, 0.02), xytext=(-1.5, 0), textcoords="offset points", ha="right",
            xycoords=("data", "axes fraction"), va="bottom", fontsize=NOTE,
        )  # fmt: skip
    for band in edges:
        if band.lower < highest:
            axes[0].annotate(
                f"$m$ = {band.period}" if band.period < 6 else f"{band.period}",
                (0.5 * (max(band.lower, lowest) + band.upper), 1.01),
                xycoords=("data", "axes fraction"), ha="center", va="bottom", fontsize=NOTE,
            )  # fmt: skip
    axes[0].set_ylim(-0.16, 0.005)
    axes[0].axhline(0.0, **GUIDE, gid="grazing")
    axes[1].set_yscale("log")
    axes[1].set_ylim(1e-6, 0.3)
    axes[1].set_xlim(lowest, highest)
    mark_letter(axes[1].yaxis, AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M,
                words="letter: stability of the amplitude", along=0.01)
    label(axes[0].yaxis, "$F_m/F_g - 1$")
    label(axes[1].yaxis, "hysteresis $1 - F_m/F_g$")
    label(axes[1].xaxis, "excitation frequency", "Hz")
    for axis, letter in zip(axes, "ab", strict=True):
        axis.set_title(f"({letter})", loc="left")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@in_house_style
def draw_ratios(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> Any:
    """Every description over the beam, against frequency."""
    figure, axis = new_figure(width=PAGE, height=0.075)
    names = ("map", "map_measured_kick", "single_mode", "two_parameters", "all_mode_kick")
    marks = ("o", "s", "^", "D", "x")
    for number, (name, mark) in enumerate(zip(names, marks, strict=True)):
        chosen = [row for row in rows if row[name] is not None and row["beam"] is not None]
        chosen = [row for row in chosen if row[name] < 0 and row["beam"] < 0]
        axis.plot(
            [row["frequency_hz"] for row in chosen], [row[name] / row["beam"] for row in chosen],
            linestyle="none", marker=mark, markersize=3.0, markerfacecolor="none", color=PALETTE[number],
            label=NAMES[name],
        )  # fmt: skip
    axis.axhline(1.0, color="0.4", linewidth=0.8, gid="the beam itself")
    periods = periods_of(scene)
    for seen, m in periods.items():
        axis.axvline(seen, **LETTER, gid=f"letter, m = {m}",
                     label="letter's frequencies" if seen == min(periods) else None)
    axis.set_yscale("log")
    axis.set_ylim(0.1, 20.0)
    axis.set_yticks([0.1, 0.3, 1.0, 3.0, 10.0], ["0.1", "0.3", "1", "3", "10"])
    axis.minorticks_off()
    label(axis.xaxis, "excitation frequency", "Hz")
    label(axis.yaxis, "hysteresis / that of the beam")
    figure.legend(loc="outside lower center", ncols=3)
    return figure


@in_house_style
def draw_causes(letter: Sequence[Mapping[str, Any]]) -> Any:
    """From the map to the beam, cause by cause, at the letter's frequencies; × where there is no fold."""
    figure, axis = new_figure(width=PAGE, height=0.075)
    width = 0.8 / len(CAUSES)
    hatches = ("", "///", "...", "xxx", "\\\\\\", "++")
    middle = 0.5 * (len(CAUSES) - 1)
    for number, cause in enumerate(CAUSES):
        places = np.arange(len(letter)) + (number - middle) * width
        known = np.array([row["causes"][cause] is not None for row in letter])
        heights = np.exp([row["causes"][cause] or 0.0 for row in letter])
        axis.bar(
            places[known], heights[known] - 1.0, width, bottom=1.0, color=PALETTE[number + 1],
            edgecolor="white", hatch=hatches[number], linewidth=0.3, label=cause,
        )  # fmt: skip
        axis.plot(places[~known], np.ones(int((~known).sum())), linestyle="none", marker="x", markersize=4.0,
                  color=BLACK, gid=f"{cause}, no fold")
    axis.axhline(1.0, color="0.3", linewidth=0.8, gid="no change")
    axis.set_yscale("log")
    ticks = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
    axis.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.minorticks_off()
    axis.set_xticks(
        np.arange(len(letter)), [f"{row['frequency_hz']:.2f} Hz, p$_{{{row['m']}}}$" for row in letter]
    )
    label(axis.xaxis, "drive frequency and period of the orbit (×: no fold below grazing)")
    label(axis.yaxis, "factor on the hysteresis")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
