"""Figures of the implicit methods on a stop: energy against contacts, growth in the plane of step and
stiffness, and growth of a single contact.

In the plane the dashed line is h w = pi, w = omega_max sqrt(k/k_modal): above it a contact lasts less than a
step.  Beyond h omega_max = 10 the first mode of the beam has fewer than 30 steps a period, and the motion
locks into patterns that gain or lose at every contact alike, which shows as upright stripes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.colors import TwoSlopeNorm

from studies.instruments.figures import (
    COLUMN,
    GUIDE,
    NOTE,
    PAGE,
    in_house_style,
    label,
    new_figure,
    panel,
    series,
)
from studies.instruments.record import Record
from studies.instruments.stability.findings import Findings

__all__ = ["draw"]

PLANES = ("trapezoidal", "HHT 0.1", "generalised-alpha 0.8", "generalised-alpha 0")
SPRINGS = ("trapezoidal", "HHT 0.1", "generalised-alpha 0.8", "generalised-alpha 0")
SCHEMES = ("Moreau-Jean 1/2", "nonsmooth 1", "nonsmooth 0.8", "Moreau-Jean 1")
WORDS = {"generalised-alpha 0.8": "gen.-α, ρ = 0.8", "generalised-alpha 0": "gen.-α, ρ = 0",
         "HHT 0.1": "HHT, α = 0.1", "trapezoidal": "trapezoidal rule",
         "Moreau-Jean 1/2": "Moreau-Jean, θ = 1/2", "Moreau-Jean 1": "Moreau-Jean, θ = 1",
         "nonsmooth 1": "nonsmooth gen.-α, ρ = 1", "nonsmooth 0.8": "nonsmooth gen.-α, ρ = 0.8"}  # fmt: skip
FLOOR = -30.0
"""log10 of the energy below which a curve has left the figure."""


@in_house_style
def _energy(arrays: Any) -> Any:
    """Energy against contact number, spring stop on the left, Newton's law on the right."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.075, sharey=True)
    for number, (axis, names, title) in enumerate((
        (axes[0], SPRINGS, "linear stop, $k = 100\\,k_\\mathrm{modal}$"),
        (axes[1], SCHEMES, "Newton's law, e = 1"),
    )):  # fmt: skip
        for i, name in enumerate(names):
            for size, filled in ((0.1, True), (1.0, False)):
                contacts, logarithm = arrays[f"history_{name}, {size:g}"]
                seen = (contacts > 0) & (logarithm / math.log(10.0) > FLOOR)
                place = np.flatnonzero(seen)[:: max(1, int(seen.sum()) // 9)]
                style = series(i)
                axis.plot(
                    contacts[seen], logarithm[seen] / math.log(10.0), color=style["color"],
                    linestyle="-" if filled else "--", linewidth=0.9, gid=f"{WORDS[name]}, h ω = {size:g}",
                )  # fmt: skip
                axis.plot(
                    contacts[place], logarithm[place] / math.log(10.0), linestyle="none",
                    marker=style["marker"], color=style["color"],
                    markerfacecolor=style["color"] if filled else "white",
                    label=WORDS[name] if filled else None, gid=f"{WORDS[name]}, h ω = {size:g}",
                )  # fmt: skip
        axis.set_xscale("log")
        axis.set_ylim(FLOOR, 40.0)
        panel(axis, number, title)
        axis.axhline(0.0, **GUIDE, gid="energy kept")
        axis.legend(loc="upper left")
        label(axis.xaxis, "contacts", "1")
    label(axes[0].yaxis, "$\\log_{10}$ of energy / energy at the start", "1")
    axes[1].text(
        0.98, 0.62,
        "filled, solid: $h\\,\\omega_\\mathrm{max} = 0.1$\nopen, dashed: $h\\,\\omega_\\mathrm{max} = 1$",
        transform=axes[1].transAxes,
        fontsize=NOTE, ha="right",
    )  # fmt: skip
    return figure


@in_house_style
def _plane(arrays: Any) -> Any:
    """Growth of ln(energy) per contact: colour, dots where it grows, and the line of h w = pi."""
    figure, axes = new_figure(2, 2, width=PAGE, height=0.125, sharex=True, sharey=True)
    sizes, ratios = arrays["plane_size"], arrays["plane_ratio"]
    norm = TwoSlopeNorm(0.0, -0.4, 0.4)
    for number, (axis, name) in enumerate(zip(axes.flat, PLANES, strict=True)):
        growth = arrays[f"plane_{name}"]
        image = axis.pcolormesh(sizes, ratios, np.clip(growth, -0.4, 0.4), norm=norm, cmap="PuOr_r",
                                shading="nearest", rasterized=True, gid="growth per contact")  # fmt: skip
        rows, columns = np.nonzero(growth > 1e-3)
        axis.plot(sizes[columns], ratios[rows], ".", color="black", markersize=2.0,
                  gid="growth above 0.001")
        (line,) = axis.plot(
            sizes, (math.pi / sizes) ** 2, color="black", linewidth=0.9, linestyle="--",
            label="a contact lasts one step",
        )  # fmt: skip
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlim(sizes[0] / 1.1, sizes[-1] * 1.1)
        axis.set_ylim(ratios[0] / 1.4, ratios[-1] * 1.4)
        panel(axis, number, WORDS[name])
    for axis in axes[1]:
        label(axis.xaxis, "$h\\,\\omega_\\mathrm{max}$", "1")
    for axis in axes[:, 0]:
        label(axis.yaxis, "$k / k_\\mathrm{modal}$", "1")
    figure.legend(handles=[line], loc="outside lower center")
    bar = figure.colorbar(image, ax=axes, extend="both", shrink=0.8)
    label(bar.ax.yaxis, "growth of ln(energy) per contact; dots: above 0.001", "1")
    return figure


@in_house_style
def _single(arrays: Any) -> Any:
    """Growth of a free mass's energy in one contact against the resolution of that contact."""
    figure, axes = new_figure(width=COLUMN, height=0.066)
    for i, name in enumerate(SPRINGS):
        axes.plot(
            arrays["single_h_w"], arrays[f"single_growth_{name}"], **series(i), label=WORDS[name],
            markevery=3,
        )  # fmt: skip
    axes.axhline(2.5 * math.log(3.0) - 2.0, color="0.5", linewidth=0.8, linestyle=":", gid="(5/2) ln 3 - 2")
    axes.text(0.1, 2.5 * math.log(3.0) - 1.96, "(5/2) ln 3 - 2", fontsize=NOTE)
    axes.axhline(0.0, **GUIDE, gid="energy kept")
    axes.set_xscale("log")
    axes.legend(loc="center right", bbox_to_anchor=(1.0, 0.42))
    label(axes.xaxis, "step × contact frequency, h ω", "1")
    label(axes.yaxis, "mean of ln(energy after/before)", "1")
    return figure


def draw(findings: Findings, record: Record) -> None:
    """Three figures from what ``implicit_contact.measure`` has found."""
    arrays = findings.arrays
    record.write_figure(_energy(arrays), "implicit_energy")
    record.write_figure(_plane(arrays), "implicit_plane")
    record.write_figure(_single(arrays), "implicit_single_contact")
