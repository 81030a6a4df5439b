"""The letter's Fig. 3 with four of the descriptions, and the bands that the experiment crosses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact import Band, NordmarkMap, band
from studies import letter
from studies.experiment.hysteresis.model import FREQUENCIES_HZ, Folds
from studies.shell import plotting
from studies.shell.plotting import BLACK, BLUE, GREEN, GUIDE, LETTER, NOTE, PAGE, VERMILION
from studies.shell.scene import Scene, band_of, corresponding, nordmark_at, periods_of

CURVES = (
    "The letter's Fig. 3, computed: where the p_m orbits end when the amplitude is lowered, against the "
    "drive frequency, for m = 3 to 10; below the same on a logarithmic scale. The beam follows the bands of "
    "the map, at another size and bent by the ringing of its second mode; crosses: folds of the equations "
    "alone, whose orbit would touch the plate elsewhere too."
)

BANDS = (
    "Bands of p_m in the plane of alpha and gamma as rho goes to 0; line: the path of the experiment, "
    "points: its six transitions."
)

STYLES: dict[str, dict[str, Any]] = {
    "map": {"label": "map", "color": BLACK, "linestyle": "-"},
    "single_mode": {"label": "Eq. (1)", "color": BLUE, "linestyle": "--"},
    "two_parameters": {"label": "one mode, loss and delay", "color": GREEN, "linestyle": "-."},
    "beam": {"label": "beam", "color": VERMILION, "marker": "o", "markersize": 2.4, "mfc": "none"},
}
"""Descriptions in the figure like the letter's."""


@plotting.in_house_style
def draw_curves(scene: Scene, rows: Sequence[Folds]) -> Figure:
    """Folds against frequency, linear and logarithmic."""
    figure, axes = plotting.new_figure(2, 1, width=PAGE, height=0.128, sharex=True)
    edges = [band_of(scene, m) for m in sorted({row.m for row in rows})]
    # f T at the edge is fixed: an error of T moves it by as much
    unsure = 1.0 + np.array([-1.0, 1.0]) * letter.FREE_PERIOD_ERROR_S / letter.FREE_PERIOD_S
    shade = {"color": "0.82", "linewidth": 0, "zorder": 0}
    for number, (axis, sign) in enumerate(zip(axes, (1.0, -1.0), strict=True)):
        curves(axis, rows, sign)
        for edge in edges:
            axis.axvspan(*(edge.upper * unsure), **shade, label="upper edge of a band, letter's error of T")
        for seen in periods_of(scene):
            axis.axvline(seen, **LETTER, label="letter's Fig. 2: p$_m$ seen here")
        plotting.panel(axis, number)
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
    plotting.legend_below(figure, axes[:1], 3)
    return figure


def curves(axis: Axes, rows: Sequence[Folds], sign: float) -> None:
    """The descriptions, a line for each period, the beam last; crosses on its folds not admissible."""
    for name, style in STYLES.items():
        ends = [(row, sign * (getattr(row, name) or 0.0)) for row in rows]
        for m in sorted({row.m for row in rows}):
            shown = [(row.frequency_hz, end) for row, end in ends if row.m == m and sign * end < 0.0]
            axis.plot(*np.array(shown).reshape(-1, 2).T, **style, linewidth=0.9)
    crossed = [(row.frequency_hz, end) for row, end in ends if sign * end < 0.0 and not row.beam_admissible]
    look: plotting.Style = {"markersize": 3.5, "color": VERMILION, "label": "beam, not admissible"}
    axis.plot(*np.array(crossed).reshape(-1, 2).T, "x", **look)


def names_of_bands(axes: Sequence[Axes], scene: Scene, edges: Sequence[Band]) -> None:
    """m of the bands on top, and at the letter's frequencies below."""
    lowest, highest = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    axes[1].set_xlim(lowest, highest)
    for seen, m in periods_of(scene).items():
        at: plotting.Style = {"transform": axes[1].get_xaxis_transform(), "fontsize": NOTE}
        at |= {"ha": "right", "va": "bottom"}
        axes[1].text(seen, 0.02, f"p$_{{{m}}}$ ", **at)
    for edge in edges:
        middle = 0.5 * (max(edge.lower, lowest) + edge.upper)
        if middle < highest:
            at = {"transform": axes[0].get_xaxis_transform(), "fontsize": NOTE, "ha": "center"}
            axes[0].text(middle, 1.01, f"$m$ = {edge.period}" if edge.period < 6 else f"{edge.period}", **at)


@plotting.in_house_style
def draw_bands(scene: Scene, path: Sequence[NordmarkMap]) -> Figure:
    """The bands as rho -> 0 and the path of the experiment."""
    figure, axis = plotting.new_figure(height=0.075)
    mode, rates = scene.single_mode, np.geomspace(100.0, 1e-3, 80)
    for m in range(3, 9):
        bands = partial(band, m, free_period=mode.free_period_s, restitution=mode.restitution)
        edges = [bands(decay_rate=mu) for mu in rates.tolist()]
        f = np.array([*(one.upper for one in edges), *(one.lower for one in edges[::-1])])
        gamma = np.exp(-np.concatenate([rates, rates[::-1]]) / f)
        alpha = 2.0 * np.sqrt(gamma) * np.cos(2.0 * np.pi / (f * mode.free_period_s))
        axis.fill(alpha, gamma, color=plotting.PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4)
        axis.text(0.5 * (alpha[79] + alpha[80]), 1.015, f"{m}", fontsize=NOTE, ha="center")
    axis.plot([p.alpha for p in path], [p.gamma for p in path], color="black", linewidth=1.4)
    low, high = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    line = {"arrowstyle": "-", "linewidth": 0.6}
    place = path[60].alpha, path[60].gamma
    axis.annotate(f"{low:g} to {high:g} Hz", place, xytext=(0.05, 0.62), fontsize=NOTE, arrowprops=line)
    own = [nordmark_at(scene, f) for f in sorted(scene.drive.frequencies_hz)]
    axis.plot([p.alpha for p in own], [p.gamma for p in own], **plotting.LETTER_POINTS, label="letter")
    axis.set_ylim(bottom=0.02)
    plotting.label(axis.xaxis, "α")
    plotting.label(axis.yaxis, "γ")
    axis.legend(loc="lower right")
    return figure
