"""The letter's Fig. 3 with four of the descriptions, and the bands that the experiment crosses."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact import Band, NordmarkMap, frequency_band, plots
from studies import letter
from studies.experiment.hysteresis.model import FREQUENCIES_HZ, Folds, OnBranch
from studies.shell import plotting
from studies.shell.plotting import BLACK, BLUE, GREEN, GUIDE, LETTER, NOTE, PAGE, VERMILION
from studies.shell.scene import Scene, band_of, corresponding, nordmark_at, periods_of

CURVES = (
    "Where the orbits p_m end when the drive amplitude is lowered, against the drive frequency; below, the "
    "same on a logarithmic scale. Each m has its own curve; its hysteresis vanishes at the upper edge of "
    "a band. Crosses are folds of orbits that would touch the plate a second time."
)

BRANCH = (
    "One branch of orbits of the beam. When the amplitude is lowered, the stable orbit meets the unstable "
    "one at the fold and is gone; up to grazing the motion without impacts is stable as well."
)

BANDS = "Bands of p_m in the plane of α and γ as ρ goes to 0, and the path of the experiment through them."

THIN = np.array([1.0, 1.0005])  # width of a mark for an edge whose error is not known

EVENTS = {"grazing": "a second touch grazes", "undecided": "event not resolved"}
"""Event of a branch -> its name in the picture, where it is another one."""

STYLES: dict[str, dict[str, Any]] = {
    "map": {"label": "map", "color": BLACK, "linestyle": "-"},
    "single_mode": {"label": "Eq. (1)", "color": BLUE, "linestyle": "--"},
    "two_parameters": {"label": "two parameters", "color": GREEN, "linestyle": "-."},
    "beam": {"label": "beam", "color": VERMILION, "marker": "o", "markersize": 2.4, "mfc": "none"},
}
"""Descriptions in the figure like the letter's."""


@plotting.in_house_style
def draw_curves(scene: Scene, rows: Sequence[Folds], *, letters: bool) -> Figure:
    """Folds against frequency, linear and logarithmic."""
    figure, axes = plotting.new_figure(2, 1, width=PAGE, height=0.128, sharex=True)
    edges = [band_of(scene, m) for m in sorted({row.m for row in rows})]
    # f T at the edge is fixed: an error of T moves it by as much
    unsure = 1.0 + np.array([-1.0, 1.0]) * letter.FREE_PERIOD_ERROR_S / letter.FREE_PERIOD_S
    shade = {"color": "0.82", "linewidth": 0, "zorder": 0}
    for number, (axis, sign) in enumerate(zip(axes, (1.0, -1.0), strict=True)):
        curves(axis, rows, sign)
        for edge in edges:
            words = "upper edge of the band of p$_m$" + ", letter's error of T" * letters
            axis.axvspan(*(edge.upper * (unsure if letters else THIN)), **shade, label=words)
        for seen in periods_of(scene) if letters else ():
            axis.axvline(seen, **LETTER, label="letter's Fig. 2: p$_m$ named above")
        plotting.panel(axis, number, ("end of the orbits", "the same, logarithmic")[number])
    names_of_bands(axes, scene, edges, letters)
    axes[0].margins(y=0.14)
    axes[0].axhline(0.0, **GUIDE, label="grazing")
    axes[1].set_yscale("log")
    if letters:
        stable = "letter: stability of the drive amplitude"
        plotting.mark_letter(axes[1].yaxis, letter.AMPLITUDE_STABILITY, words=stable, along=0.01)
    plotting.label(axes[0].yaxis, "$F_m/F_g - 1$")
    plotting.label(axes[1].yaxis, plotting.HYSTERESIS)
    plotting.label(axes[1].xaxis, "drive frequency", "Hz")
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
    look: plotting.Style = {"markersize": 3.5, "color": VERMILION, "label": "beam, would touch a second time"}
    if crossed:
        axis.plot(*np.array(crossed).T, "x", **look)


def names_of_bands(axes: Sequence[Axes], scene: Scene, edges: Sequence[Band], letters: bool) -> None:
    """p_m of the bands inside below, and of the letter's frequencies on top."""
    lowest, highest = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    axes[1].set_xlim(lowest, highest)
    at: plotting.Style = {"transform": axes[0].get_xaxis_transform(), "fontsize": NOTE, "ha": "center"}
    for seen, m in periods_of(scene).items() if letters else ():
        axes[0].text(seen, 1.01, f"p$_{{{m}}}$", **at)
    for edge in edges:
        middle = 0.5 * (max(edge.lower, lowest) + edge.upper)
        if middle < highest:
            axes[0].text(middle, 0.035, f"p$_{{{edge.m}}}$", **at)


@plotting.in_house_style
def draw_branch(rows: Sequence[OnBranch], frequency: float, m: int) -> Figure:
    """Approach speed against the excess, up to three times the depth of the fold, with the events."""
    shown = [row for row in rows if row.excess <= 3.0 * abs(min(one.excess for one in rows))]
    figure, axis = plotting.new_figure(height=0.072)
    excess, speed = np.array([(1e2 * row.excess, 1e3 * row.speed) for row in shown]).T
    stable, admissible = np.array([(row.stable, row.admissible) for row in shown]).T
    plots.branch(axis, excess, speed, stable, admissible)
    axis.axvline(0.0, **GUIDE, label="grazing")
    for place, row in enumerate(shown):
        if row.event:
            last = excess[place] > 0.5 * excess.max()
            at: plotting.Style = {"textcoords": "offset points", "fontsize": NOTE}
            at |= {"xytext": (-5.0 if last else 6.0, -9.0 if row.event == "grazing" else -2.0)}
            at["ha"] = "right" if last else "left"
            axis.plot(excess[place], speed[place], "o", color=BLACK, markersize=3.5)
            axis.annotate(EVENTS.get(row.event, row.event), (excess[place], speed[place]), **at)
    axis.set_yscale("log")
    axis.set_title(f"p$_{{{m}}}$ of the beam at {frequency:.2f} Hz", loc="left")
    plotting.label(axis.xaxis, plotting.EXCESS, "%")
    plotting.label(axis.yaxis, "approach speed", "mm/s")
    plotting.legend_below(figure, [axis], 2)
    return figure


@plotting.in_house_style
def draw_bands(scene: Scene, path: Sequence[NordmarkMap], *, letters: bool) -> Figure:
    """The bands as rho -> 0 and the path of the experiment."""
    figure, axis = plotting.new_figure(height=0.075)
    mode, rates = scene.single_mode, np.geomspace(100.0, 1e-3, 80)
    for m in range(3, 9):
        bands = partial(frequency_band, m, free_period=mode.free_period_s, restitution=mode.restitution)
        edges = [bands(decay_rate=mu) for mu in rates.tolist()]
        f = np.array([*(one.upper for one in edges), *(one.lower for one in edges[::-1])])
        gamma = np.exp(-np.concatenate([rates, rates[::-1]]) / f)
        alpha = 2.0 * np.sqrt(gamma) * np.cos(2.0 * np.pi / (f * mode.free_period_s))
        axis.fill(alpha, gamma, color=plotting.PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4)
        high = 1.055 if m == 7 else 1.015  # side by side they would touch
        axis.text(0.5 * (alpha[79] + alpha[80]), high, f"p$_{{{m}}}$", fontsize=NOTE, ha="center")
    low, high = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    words = f"path from {low:.4g} to {high:.4g} Hz"
    axis.plot([p.alpha for p in path], [p.gamma for p in path], color="black", linewidth=1.4, label=words)
    own = [nordmark_at(scene, f) for f in sorted(scene.drive.frequencies_hz)]
    look = plotting.LETTER_POINTS if letters else {**plotting.LETTER_POINTS, "marker": "o"}
    words = "letter's transitions" if letters else "drive frequencies of the scene"
    axis.plot([p.alpha for p in own], [p.gamma for p in own], **look, label=words)
    axis.set_ylim(bottom=0.02)
    plotting.label(axis.xaxis, "α of the map")
    plotting.label(axis.yaxis, "γ of the map")
    axis.set_title("bands of p$_m$", loc="left", pad=14.0)
    plotting.legend_below(figure, [axis], 2)
    return figure
