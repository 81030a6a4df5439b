"""Claim e (letter 1996): "an infinite series of period addings for the overdamped oscillator".

The windows of p_m and the chaos between them as rho -> 0+, by two independent routes: the limits of the
windows from the exact orbits, and the chaotic part of one turn of ln rho from Lyapunov exponents.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.ticker import NullFormatter

from studies.instruments.claims.overdamped_map import exponents, overdamped, overlap, switch, window
from studies.instruments.claims.verdict import Claim
from studies.instruments.figures import (
    BLUE,
    GUIDE,
    NOTE,
    PAGE,
    VERMILION,
    in_house_style,
    label,
    new_figure,
    panel,
)

__all__ = ["overdamped_claim"]


@in_house_style
def overdamped_claim(quick: bool) -> Claim:
    """e: windows of p_m, their overlap and the chaos between, for the overdamped map as rho -> 0+."""
    m = 16  # what the limit rho -> 0+ neglects is of the order l^m, 0.2 % here
    small = 0.01
    limits = {}
    for gamma in (0.0, small):
        least = 2.0 * math.sqrt(gamma) + 0.02

        def coexist(alpha: float, gamma: float = gamma) -> bool:
            return overlap(alpha, gamma, m) > 0.0

        def exists(alpha: float, gamma: float = gamma) -> bool:
            return window(overdamped(alpha, gamma), m) is not None

        halvings = 10 if quick else 14
        limits[f"gamma {gamma:g}"] = {
            "overlap_ends_at_alpha": switch(coexist, least, 0.6, halvings) if coexist(least) else None,
            "windows_end_at_alpha": switch(exists, 0.4, 0.95, halvings),
        }
    alphas = np.linspace(0.05, 0.95, 19 if quick else 46)
    count = 60 if quick else 120
    long = (
        (2000, 3000) if quick else (4000, 8000)
    )  # next to a window's end both chaos and its absence are slow
    middles = (np.arange(count) + 0.5) / count
    # one turn of the cascade, far enough down that the limit is reached
    rho = np.minimum(1e-8, alphas**14)[:, None] * alphas[:, None] ** (2.0 * middles)
    each = np.broadcast_to(alphas[:, None], rho.shape)
    part = np.mean(exponents(each, 0.0, rho, *long)[0] > 0.0, axis=1)
    predicted = np.clip(np.log(0.75 / (1.0 - alphas)) / (2.0 * np.log(1.0 / alphas)), 0.0, 1.0)
    predicted[alphas > 2.0 / 3.0] = 1.0
    numbers: dict[str, Any] = {
        "limits": limits,
        "chaotic_part": {f"alpha {a:.3g}": p for a, p in zip(alphas, part, strict=True)},
        "below_1/4": float(part[alphas < 0.25].max()),
        "above_2/3": float(part[alphas > 0.68].min()),
        "largest_difference_from_the_windows": float(np.max(np.abs(part - predicted))),
    }
    figure, axes = new_figure(2, 2, width=PAGE, height=0.105)
    for number, (axis, alpha) in enumerate(zip(axes.flat, (0.20, 0.45, 0.80), strict=False)):
        top = 1e-3
        rho = np.geomspace(top * alpha ** (4 if alpha < 0.7 else 16), top, 150 if quick else 500)
        found, x = exponents(alpha, 0.0, rho, 1000, 2000)
        seen = x[:: 1 if alpha < 0.7 else 4]
        for chaos, colour in ((False, BLUE), (True, VERMILION)):
            chosen = (found > 0.0) == chaos
            if not chosen.any():
                continue
            axis.plot(
                np.tile(rho[chosen], seen.shape[0]),
                (seen[:, chosen] / np.sqrt(rho[chosen])).ravel(),
                linestyle="none",
                marker="s" if chaos else ".",
                markersize=0.7 if chaos else 1.0,
                markeredgewidth=0.0,
                color=colour,
                rasterized=True,
                gid="exponent above 0" if chaos else "exponent below 0",
            )
        axis.set_xscale("log")
        axis.xaxis.set_minor_formatter(NullFormatter())
        regime = ("windows overlap", "chaos between windows", "chaos only")[number]
        panel(axis, number, f"α = {alpha:g}: {regime}")
        label(axis.yaxis, "$x$ / √ρ")
        label(axis.xaxis, "ρ")
    last = axes.flat[3]
    last.plot(alphas, predicted, color=VERMILION, linewidth=1.0, label="outside the windows of p$_m$")
    last.plot(
        alphas, part, color="black", marker="o", markersize=2.2, linestyle="none", label="exponent above 0"
    )
    for place, name in ((0.25, "1/4"), (2.0 / 3.0, "2/3")):
        last.axvline(place, **GUIDE, gid=f"α = {name}")
        last.text(place + 0.01, 0.06, name, fontsize=NOTE)
    panel(last, 3, "chaotic part of ln ρ")
    last.legend(loc="upper left")
    label(last.xaxis, "α")
    label(last.yaxis, "chaotic part")
    last.set_ylim(-0.03, 1.05)
    table = {"alpha": alphas.tolist(), "chaotic_part": part.tolist(), "outside_windows": predicted.tolist()}
    found_limits = limits["gamma 0"]
    ends = (found_limits["overlap_ends_at_alpha"] or 0.0, found_limits["windows_end_at_alpha"] or 0.0)
    close = 0.06 if quick else 0.03  # few values of rho
    holds = (
        abs(ends[0] - 0.25) < 0.002
        and abs(ends[1] - 2.0 / 3.0) < 0.002
        and numbers["below_1/4"] == 0.0
        and numbers["above_2/3"] == 1.0
        and numbers["largest_difference_from_the_windows"] < close
    )
    return Claim(
        holds=holds,
        numbers=numbers,
        table=table,
        figure=figure,
        sentence=(
            f"With gamma = 0 the windows of p_{m} and p_{m + 1} overlap for alpha below {ends[0]:.4f}, are "
            f"parted by chaos up to {ends[1]:.4f} and are gone above (1/4 and 2/3); the part of ln rho with "
            "a positive exponent is that outside the windows within "
            f"{numbers['largest_difference_from_the_windows']:.2g}. The period falls by one from "
            "window to window as rho rises: the cascade is reversed."
        ),
    )
