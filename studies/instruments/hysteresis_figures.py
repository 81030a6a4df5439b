"""Figures of the hysteresis: the letter's Fig. 3 with all descriptions, their ratios, and the causes.

Rows are those of ``studies.hysteresis``: F_m/F_g - 1 by description, m and frequency [Hz], and the share of
each cause as a natural logarithm.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contact.maximal_orbits import bands
from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.hysteresis_causes import CAUSES
from studies.instruments.scene import Scene
from studies.published import PERIODS

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


def draw_curves(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> Any:
    """The letter's Fig. 3 with the descriptions in it, linear and logarithmic."""
    figure, axes = new_figure(2, 1, width=PAGE, height=0.125, sharex=True)
    styles: dict[str, dict[str, Any]] = {
        "map": {"color": PALETTE[0], "linestyle": "-"},
        "single_mode": {"color": PALETTE[1], "linestyle": "--"},
        "two_parameters": {"color": PALETTE[3], "linestyle": "-."},
        "beam": {
            "color": PALETTE[2],
            "linestyle": "-",
            "marker": "o",
            "markersize": 2.2,
            "markerfacecolor": "none",
        },
    }
    keys = scene.single_mode
    edges = bands(
        PERIODS_DRAWN,
        free_period=keys.free_period_s,
        decay_rate=keys.decay_rate_per_s,
        restitution=keys.restitution,
    )
    with house_style():
        for axis, logarithmic in zip(axes, (False, True), strict=True):
            for m in PERIODS_DRAWN:
                for name, style in styles.items():
                    chosen = [
                        row for row in rows if row["m"] == m and row[name] is not None and row[name] < 0
                    ]
                    f = np.array([row["frequency_hz"] for row in chosen])
                    y = np.array([row[name] for row in chosen])
                    axis.plot(
                        f,
                        -y if logarithmic else y,
                        **style,
                        linewidth=0.9,
                        label=NAMES[name] if m == 3 else None,
                    )
            for band in edges:
                axis.axvline(band.upper, color="0.7", linestyle=":", linewidth=0.7)
            for seen, m in PERIODS.items():
                axis.axvline(seen, color="#56B4E9", linewidth=0.7, alpha=0.7, zorder=0)
                if logarithmic:
                    axis.annotate(
                        f"{m}",
                        (seen, 0.02),
                        xycoords=("data", "axes fraction"),
                        ha="center",
                        va="bottom",
                        fontsize=6,
                        color="#0072B2",
                    )
        for band in edges:
            if band.lower < FREQUENCIES_DRAWN_HZ[1]:
                axes[0].annotate(
                    f"$m$ = {band.period}" if band.period < 6 else f"{band.period}",
                    (0.5 * (max(band.lower, FREQUENCIES_DRAWN_HZ[0]) + band.upper), 1.01),
                    xycoords=("data", "axes fraction"), ha="center", va="bottom", fontsize=7,
                )
        axes[0].set_ylim(-0.16, 0.005)
        axes[0].axhline(0.0, color="0.5", linewidth=0.6)
        axes[1].set_yscale("log")
        axes[1].set_ylim(1e-6, 0.3)
        axes[1].set_xlim(FREQUENCIES_DRAWN_HZ[0], FREQUENCIES_DRAWN_HZ[1])
        label(axes[0].yaxis, "F$_m$/F$_g$ - 1")
        label(axes[1].yaxis, "1 - F$_m$/F$_g$")
        label(axes[1].xaxis, "excitation frequency", "Hz")
        axes[0].legend(
            loc="lower right", title="blue lines: the letter's frequencies and m", title_fontsize=7
        )
    return figure


def draw_ratios(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Every description over the beam, against frequency."""
    figure, axis = new_figure(width=PAGE, height=0.075)
    names = ("map", "map_measured_kick", "single_mode", "two_parameters", "all_mode_kick")
    marks = ("o", "s", "^", "D", "x")
    with house_style():
        for number, (name, mark) in enumerate(zip(names, marks, strict=True)):
            chosen = [
                row for row in rows if row[name] is not None and row["beam"] is not None and row["beam"] < 0
            ]
            chosen = [row for row in chosen if row[name] < 0]
            axis.plot(
                [row["frequency_hz"] for row in chosen],
                [row[name] / row["beam"] for row in chosen],
                linestyle="none",
                marker=mark,
                markersize=3.0,
                markerfacecolor="none",
                color=PALETTE[number],
                label=NAMES[name],
            )
        axis.axhline(1.0, color="0.4", linewidth=0.8)
        axis.set_yscale("log")
        axis.set_ylim(0.1, 20.0)
        axis.set_yticks([0.1, 0.3, 1.0, 3.0, 10.0], ["0.1", "0.3", "1", "3", "10"])
        label(axis.xaxis, "excitation frequency", "Hz")
        label(axis.yaxis, "hysteresis / that of the beam")
        figure.legend(loc="outside upper center", ncols=3)
    return figure


def draw_causes(letter: Sequence[Mapping[str, Any]]) -> Any:
    """From the map to the beam, cause by cause, at the letter's frequencies."""
    figure, axis = new_figure(width=PAGE, height=0.075)
    width = 0.8 / len(CAUSES)
    hatches = ("", "///", "...", "xxx", "\\\\\\", "++")
    with house_style():
        for number, cause in enumerate(CAUSES):
            heights = [row["causes"][cause] or 0.0 for row in letter]
            places = np.arange(len(letter)) + (number - 0.5 * (len(CAUSES) - 1)) * width
            axis.bar(
                places,
                np.exp(heights) - 1.0,
                width,
                bottom=1.0,
                color=PALETTE[number + 1],
                edgecolor="white",
                hatch=hatches[number],
                linewidth=0.3,
                label=cause,
            )
        axis.axhline(1.0, color="0.3", linewidth=0.8)
        axis.set_yscale("log")
        ticks = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
        axis.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axis.minorticks_off()
        axis.set_xticks(
            np.arange(len(letter)), [f"{row['frequency_hz']:.2f} Hz, p$_{{{row['m']}}}$" for row in letter]
        )
        label(axis.yaxis, "factor on the hysteresis")
        figure.legend(loc="outside upper center", ncols=3)
    return figure
