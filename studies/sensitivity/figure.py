"""Folds after each change, strobe points in noise, and how far they stay apart."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from studies import letter, plotting
from studies.plotting import BLUE, NOTE, PAGE, PALETTE, VERMILION
from studies.sensitivity.changes import NAMES, Row
from studies.sensitivity.noise import KINDS, Clouds, Points

TORNADO = (
    "Factor on the hysteresis at each frequency after each change of one parameter; written: the period that "
    "is born instead."
)
NOISE = (
    "(a) Distance of neighbouring strobe points over the width of their clouds against the period; below one "
    "they merge. (b) Hysteresis and upper end of p_m beside the noise."
)
POINTS = (
    "Strobe points of the beam in amplitude noise at three of the letter's frequencies, and the two clouds "
    "closest to each other."
)
BARS = {"beam": (0.23, {-1: 0.03, 1: 0.27}), "single_mode": (0.2, {-1: -0.24, 1: -0.24})}
"""Description -> height of its bars, and their place by direction of the change."""
COLOURS, CROSSES, WAYS = {-1: BLUE, 1: VERMILION}, {-1: "+", 1: "x"}, {-1: "lowered", 1: "raised"}


@plotting.in_house_style
def draw_tornado(rows: Sequence[Row]) -> Figure:
    """The fold after a change over the fold without it, one panel for each frequency."""
    frequencies = sorted({row.frequency_hz for row in rows})
    parameters = list(dict.fromkeys(row.parameter for row in rows if row.sign))[::-1]
    columns = min(3, len(frequencies))
    lines = math.ceil(len(frequencies) / columns)
    height = (0.016 + 0.0044 * len(parameters)) * lines + 0.012
    figure, axes = plotting.new_figure(
        lines, columns, width=PAGE, height=height, squeeze=False, sharey=True, sharex=True
    )
    for axis in axes.flat[len(frequencies) :]:
        axis.set_visible(False)
    for number, (axis, frequency) in enumerate(zip(axes.flat, frequencies, strict=False)):
        tornado(axis, [row for row in rows if row.frequency_hz == frequency], parameters, number)
    for axis in axes[-1]:
        plotting.label(axis.xaxis, "hysteresis / (hysteresis before)")
    for axis in axes[:, 0]:
        plotting.label(axis.yaxis, "what is changed")
    handles: list[Any] = [
        Patch(**look(name, sign), label=f"{WAYS[sign]}, {NAMES[name]}") for name in BARS for sign in WAYS
    ]
    handles += [
        Line2D([], [], linestyle="none", marker=CROSSES[sign], color=COLOURS[sign], markersize=3.5,
               label=f"{way}: none left")
        for sign, way in WAYS.items()
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", ncols=6, columnspacing=1.2)
    return figure


def tornado(axis: Axes, rows: Sequence[Row], parameters: Sequence[str], number: int) -> None:
    """One frequency."""
    base = next(row for row in rows if not row.sign)
    for row in rows:
        if not row.sign:
            continue
        place = parameters.index(row.parameter)
        for name, (height, shifts) in BARS.items():
            now, then, y = row.fold(name), base.fold(name), place + shifts[row.sign]
            if now is None and then is not None:
                axis.plot(0.23, y, CROSSES[row.sign], markersize=3.5, color=COLOURS[row.sign], clip_on=False)
            elif now is not None and then is not None and now * then > 0.0 and abs(now / then - 1.0) > 1e-9:
                axis.barh(y, now / then - 1.0, height, left=1.0, zorder=2, **look(name, row.sign))
        if row.born_beam != base.born_beam:
            words = f"p$_{{{row.born_beam}}}$" if row.born_beam else "no period"
            axis.annotate(
                f"{words} at {row.change}", (0.99, place), xycoords=("axes fraction", "data"), ha="right",
                va="top" if row.sign > 0 else "center", fontsize=NOTE,
            )  # fmt: skip
    axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3)
    axis.set_xscale("log")
    axis.set_xlim(0.22, 4.5)
    axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
    axis.minorticks_off()
    axis.set_yticks(range(len(parameters)), parameters)
    axis.set_ylim(-0.6, len(parameters) - 0.4)
    digits, _, power = f"{-base.fold_beam:.1e}".partition("e") if base.fold_beam else ("none", "", "")
    words = f"{digits}·10$^{{{int(power)}}}$" if power else digits
    plotting.panel(axis, number, f"{base.frequency_hz:.2f} Hz, p$_{{{base.m}}}$ ({words})")


def look(name: str, sign: int) -> dict[str, Any]:
    """Fill and hatch by description and direction: a grey copy tells them apart."""
    colour = COLOURS[sign]
    if name == "beam":
        face = plotting.tint(colour, 0.4) if sign > 0 else colour
        return {"facecolor": face, "edgecolor": colour, "linewidth": 0.6}
    hatch = "\\\\" * 3 if sign > 0 else "/" * 6
    return {"facecolor": "white", "edgecolor": colour, "linewidth": 0.6, "hatch": hatch}


@plotting.in_house_style
def draw_noise(noise: Sequence[Clouds]) -> Figure:
    """Against m: how far the strobe points stay apart, and the amplitudes of p_m beside the noise."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.066)
    for number, kind in enumerate(KINDS, 1):
        found = [row for row in noise if row.noise == kind]
        m = [row.m for row in found]
        axes[0].plot(m, values(found, "told_apart"), **plotting.series(number), mfc="none", label=kind)
    axes[0].axhline(1.0, **plotting.GUIDE)
    plotting.panel(axes[0], 0, "strobe points told apart above 1")
    plotting.label(axes[0].yaxis, "distance of neighbours / width of clouds")
    for name, words, number in (("fold", "hysteresis of p$_m$", 0), ("upper_end", "p$_m$ lives up to", 3)):
        axes[1].plot(m, np.abs(values(found, name)), **plotting.series(number), mfc="none", label=words)
    stable = "letter: stability of the amplitude"
    plotting.mark_letter(axes[1].yaxis, letter.AMPLITUDE_STABILITY, words=stable)
    plotting.panel(axes[1], 1, "amplitudes beside the noise")
    plotting.label(axes[1].yaxis, "$|F/F_g - 1|$")
    for axis in axes:
        highest = max(letter.PERIODS.values())
        plotting.mark_letter(axis.xaxis, highest, words="letter: highest $m$", along=0.98, level=True)
        axis.set_yscale("log")
        plotting.label(axis.xaxis, "period $m$")
        axis.set_xticks(m)
        axis.legend(loc="best")
    return figure


def values(rows: Sequence[Clouds], column: str) -> Points:
    """A column, not a number where there is none."""
    return np.array([math.nan if getattr(row, column) is None else getattr(row, column) for row in rows])


@plotting.in_house_style
def draw_points(beam: Sequence[Clouds], arrays: Mapping[str, Points]) -> Figure:
    """Strobe points of the beam in noise: all of them, and the closest two clouds."""
    frequencies = list(dict.fromkeys(row.frequency_hz for row in beam))
    figure, axes = plotting.new_figure(2, len(frequencies), width=PAGE, height=0.105, squeeze=False)
    for column, frequency in enumerate(frequencies):
        jitter, drift = (row for row in beam if row.frequency_hz == frequency)
        closest = jitter.closest or drift.closest or (0, 1)
        top, bottom = axes[:, column]
        stem = f"beam_{frequency:.2f}_hz".replace(".", "p")
        clouds = {kind: (1e3 * arrays[f"{stem}_{kind}"], arrays[f"{stem}_{kind}_phase"]) for kind in KINDS}
        for kind, shift, colour, mark in (("jitter", -0.16, BLUE, "o"), ("drift", 0.16, VERMILION, "^")):
            y, phase = clouds[kind]
            inside = (phase >= 0) & (phase < jitter.m)
            top.plot(phase[inside] + shift, y[inside], mark, markersize=1.6, color=colour, mfc="none",
                     markeredgewidth=0.4, label=kind, rasterized=True)  # fmt: skip
        histograms(bottom, clouds, closest)
        plotting.panel(top, column, f"{frequency:.2f} Hz, p$_{{{jitter.m}}}$")
        top.locator_params(axis="x", integer=True)
        plotting.label(top.xaxis, "strobes since the impact")
        ratio = "-" if jitter.told_apart is None else f"{jitter.told_apart:.2g}"
        plotting.panel(bottom, column + len(frequencies), f"distance/width {ratio} (jitter)")
        plotting.label(bottom.xaxis, f"strobes {closest[0]} (solid), {closest[1]}: offset", "µm")
    plotting.label(axes[0, 0].yaxis, "read-out displacement", "mm")
    plotting.label(axes[1, 0].yaxis, "number of points")
    handles = axes[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=2, markerscale=2.5)
    return figure


def histograms(axis: Axes, clouds: Mapping[str, tuple[Any, Any]], closest: tuple[int, int]) -> None:
    """The two closest clouds [um], from the middle between their outer ends."""
    groups = {kind: [y[phase == j] for j in closest] for kind, (y, phase) in clouds.items()}
    filled = [group for two in groups.values() for group in two if group.size]
    edges = [q for group in filled for q in np.quantile(group, (0.03, 0.97))]
    low, high = (min(edges), max(edges)) if edges else (0.0, 1.0)
    reach = 0.9e3 * (high - low)
    for number, (kind, two) in enumerate(groups.items(), 1):
        for group, line in zip(two, ("-", "--"), strict=True):
            axis.hist(
                1e3 * (group - 0.5 * (low + high)), bins=40, range=(-reach, reach), linestyle=line,
                histtype="step" if kind == "jitter" else "stepfilled", linewidth=0.9, color=PALETTE[number],
                alpha=1.0 if kind == "jitter" else 0.45,
            )  # fmt: skip
