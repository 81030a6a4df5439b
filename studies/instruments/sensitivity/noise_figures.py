"""Strobe points in noise, and against m: distance over width of the clouds, amplitudes beside the noise."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.sensitivity.answers import number
from studies.instruments.sensitivity.grazing_births import NOISE

__all__ = ["draw_noise", "draw_points"]


def draw_points(stored: Mapping[str, Any], panels: Sequence[Mapping[str, Any]]) -> Any:
    """Strobe points of the beam in noise: all of them, and the closest two clouds."""
    figure, axes = new_figure(2, len(panels), width=PAGE, height=0.105, squeeze=False)
    looks = {"jitter": (PALETTE[1], -0.16, "o"), "drift": ("#D55E00", 0.16, "^")}
    with house_style():
        for column, panel in enumerate(panels):
            top, bottom = axes[:, column]
            low, high = panel["jitter"]["closest"] or panel["drift"]["closest"] or (0, 1)
            edges = []
            for kind, (colour, shift, mark) in looks.items():
                y, phase = 1e3 * stored[f"{panel['stem']}_{kind}"], stored[f"{panel['stem']}_{kind}_phase"]
                inside = (phase >= 0) & (phase < panel["m"])
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
                looks_of = {"color": colour, "label": kind, "linewidth": 0.9}
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
                        **looks_of,
                    )
            top.set_title(
                f"({chr(ord('a') + column)}) {panel['frequency_hz']:.2f} Hz, p$_{{{panel['m']}}}$", loc="left"
            )
            top.locator_params(axis="x", integer=True)
            label(top.xaxis, "strobes since the impact")
            ratio = number(panel["jitter"]["told_apart"], ".2g")
            bottom.set_title(f"distance/width {ratio} (jitter)", fontsize=7)
            label(bottom.xaxis, f"strobes {low} and {high}, offset", "µm")
        label(axes[0, 0].yaxis, "read-out", "mm")
        label(axes[1, 0].yaxis, "points")
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=2, markerscale=2.5)
    return figure


def draw_noise(noise: Sequence[Mapping[str, Any]]) -> Any:
    """Against m: how far the strobe points stay apart, and the amplitudes of p_m beside the noise."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.066)
    m = np.array([row["m"] for row in noise])
    with house_style():
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
        axes[0].axhline(1.0, color="0.4", linewidth=0.7)
        axes[0].set_yscale("log")
        axes[0].axvline(10, color="0.6", linestyle=":", linewidth=0.8)
        axes[0].set_title("(a) strobe points told apart above 1", loc="left")
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
        axes[1].axhline(NOISE, color="0.4", linewidth=0.7)
        axes[1].annotate(
            "noise, 2.5·10$^{-4}$", (0.02, NOISE), xycoords=("axes fraction", "data"), va="top", fontsize=7
        )
        axes[1].axvline(10, color="0.6", linestyle=":", linewidth=0.8)
        axes[1].set_yscale("log")
        axes[1].set_title("(b) amplitudes beside the noise", loc="left")
        label(axes[1].yaxis, "|F/F$_g$ - 1|")
        for axis in axes:
            label(axis.xaxis, "m")
            axis.set_xticks(m)
            axis.legend(loc="best")
    return figure
