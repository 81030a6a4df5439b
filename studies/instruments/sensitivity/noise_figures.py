"""Strobe points in noise, and against m: distance over width of the clouds, amplitudes beside the noise."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.figures import (
    BLUE,
    GUIDE,
    PAGE,
    PALETTE,
    VERMILION,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
)
from studies.instruments.sensitivity.answers import number
from studies.instruments.sensitivity.grazing_births import NOISE
from studies.published import PERIODS

__all__ = ["draw_noise", "draw_points"]


@in_house_style
def draw_points(stored: Mapping[str, Any], panels: Sequence[Mapping[str, Any]]) -> Any:
    """Strobe points of the beam in noise: all of them, and the closest two clouds."""
    figure, axes = new_figure(2, len(panels), width=PAGE, height=0.105, squeeze=False)
    looks = {"jitter": (BLUE, -0.16, "o"), "drift": (VERMILION, 0.16, "^")}
    for column, shown in enumerate(panels):
        top, bottom = axes[:, column]
        low, high = shown["jitter"]["closest"] or shown["drift"]["closest"] or (0, 1)
        edges = []
        for kind, (colour, shift, mark) in looks.items():
            y, phase = 1e3 * stored[f"{shown['stem']}_{kind}"], stored[f"{shown['stem']}_{kind}_phase"]
            inside = (phase >= 0) & (phase < shown["m"])
            top.plot(
                phase[inside] + shift,
                y[inside],
                linestyle="none",
                marker=mark,
                markersize=1.6,
                color=colour,
                markerfacecolor="none",
                markeredgewidth=0.4,
                label=kind,
                rasterized=True,
            )
            two = [y[phase == j] for j in (low, high)]
            edges += [q for group in two if group.size for q in np.quantile(group, (0.03, 0.97))]
            looks_of = {"color": colour, "linewidth": 0.9}
            span = (min(edges), max(edges)) if edges else (0.0, 1.0)
            for number_, group in enumerate(two):
                middle = 0.5 * (span[0] + span[1])
                bottom.hist(
                    1e3 * (group - middle),
                    bins=40,
                    range=(-0.9e3 * (span[1] - span[0]), 0.9e3 * (span[1] - span[0])),
                    histtype="step" if kind == "jitter" else "stepfilled",
                    linestyle="-" if number_ == 0 else "--",
                    alpha=1.0 if kind == "jitter" else 0.45,
                    gid=f"{kind}, strobe {(low, high)[number_]}",
                    **looks_of,
                )
        panel(top, column, f"{shown['frequency_hz']:.2f} Hz, p$_{{{shown['m']}}}$")
        top.locator_params(axis="x", integer=True)
        label(top.xaxis, "strobes since the impact")
        ratio = number(shown["jitter"]["told_apart"], ".2g")
        panel(bottom, column + len(panels), f"distance/width {ratio} (jitter)")
        label(bottom.xaxis, f"strobes {low} (solid) and {high}, offset", "µm")
    label(axes[0, 0].yaxis, "read-out displacement", "mm")
    label(axes[1, 0].yaxis, "number of points")
    handles, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=2, markerscale=2.5)
    return figure


@in_house_style
def draw_noise(noise: Sequence[Mapping[str, Any]]) -> Any:
    """Against m: how far the strobe points stay apart, and the amplitudes of p_m beside the noise."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.066)
    m = np.array([row["m"] for row in noise])
    for kind, number_ in (("jitter", 1), ("drift", 2)):
        y = np.array(
            [math.nan if row[kind]["told_apart"] is None else row[kind]["told_apart"] for row in noise]
        )
        axes[0].plot(
            m,
            y,
            color=PALETTE[number_],
            marker="o^"[number_ - 1],
            linestyle=("-", "--")[number_ - 1],
            markerfacecolor="none",
            label=kind,
        )
        lost = np.array([row[kind]["regular"] < 0.9 for row in noise])
        if not np.any(lost):
            continue
        axes[0].plot(
            m[lost],
            np.full(lost.sum(), (0.04, 0.03)[number_ - 1]),
            linestyle="none",
            marker="x",
            markersize=4,
            color=PALETTE[number_],
            label=f"{kind}: order of impacts lost",
        )
    axes[0].axhline(1.0, **GUIDE, gid="told apart above")
    axes[0].set_yscale("log")
    mark_letter(axes[0].xaxis, max(PERIODS.values()), words="letter: highest $m$", along=0.98, level=True)
    panel(axes[0], 0, "strobe points told apart above 1")
    label(axes[0].yaxis, "distance of neighbours / width of clouds")
    for key, name, number_ in (("fold", "hysteresis of p$_m$", 0), ("upper_end", "p$_m$ lives up to", 3)):
        y = np.array([math.nan if row[key] is None else abs(row[key]) for row in noise])
        axes[1].plot(
            m,
            y,
            color=PALETTE[number_],
            marker="sD"[number_ > 0],
            linestyle=("-", "--")[number_ > 0],
            markerfacecolor="none",
            label=name,
        )
    mark_letter(axes[1].yaxis, NOISE, words="letter: stability of the amplitude")
    mark_letter(axes[1].xaxis, max(PERIODS.values()), words="letter: highest $m$", along=0.98, level=True)
    axes[1].set_yscale("log")
    panel(axes[1], 1, "amplitudes beside the noise")
    label(axes[1].yaxis, "$|F/F_g - 1|$")
    for axis in axes:
        label(axis.xaxis, "period $m$")
        axis.set_xticks(m)
        axis.legend(loc="best")
    return figure
