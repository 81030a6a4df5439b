"""Period adding of the overdamped oscillator: windows of p_m and the chaos between them as rho -> 0+.

The eigenvalues of the overdamped map without impact are 1 > l > l' >= 0. For gamma = 0 (l' = 0, l = alpha)
p_m has, as rho -> 0+,

    x_0 = l^(2m-2) z^2,   rho = l^(2m-2) (1 - l) z (z + 1),   1/2 < z < (1 - l)/l,

stable above the lower end, without a second impact below the upper one. The windows of rho are empty for
l > 2/3, overlap for l < 1/4, and leave gaps in between, ln((3/4)/(1 - l)) / (2 ln(1/l)) of ln rho, that chaos
fills; the period falls by one from window to window as rho rises. The chaotic part of one turn of ln rho is
also found from Lyapunov exponents: an impact leaves x = -sqrt(x) + rho (tau = 0), a step without one
alpha x + rho, which is one dimension, so that the exponent is the mean of log |slope|.
Source: W. Chin, E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from studies.shell import plotting
from studies.shell.study import Run

KEPT = 120
"""Last iterates that `exponents` returns."""

SHOWN, TOP, TURNS = 0.45, 1e-3, 4
"""The cascade drawn: its alpha, its largest rho, and how many windows lie below that."""


@dataclass(frozen=True, kw_only=True)
class Share:
    """Parts of ln rho: where the exponent is above 0, and what lies outside the windows of all p_m."""

    alpha: float
    chaotic_part: float
    outside_windows: float


def outside_windows(alpha: float) -> float:
    """Part of ln rho outside all windows for gamma = 0 as rho -> 0+."""
    if alpha > 2.0 / 3.0:
        return 1.0
    return min(max(math.log(0.75 / (1.0 - alpha)) / (2.0 * math.log(1.0 / alpha)), 0.0), 1.0)


def exponents(
    alpha: ArrayLike, rho: NDArray[np.float64], settle_steps: int, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Exponents of the map with gamma = 0 = tau at each rho, and its last `KEPT` x."""
    x, total, kept = rho.copy(), np.zeros_like(rho), []
    factor = np.broadcast_to(np.asarray(alpha, dtype=float), rho.shape)
    for n in range(settle_steps + steps):
        hit = x > 0.0
        root = np.sqrt(np.where(hit, x, 1.0))
        if n >= settle_steps:
            total += np.log(np.where(hit, 0.5 / root, factor))
        x = np.where(hit, -root, factor * x) + rho
        if n >= settle_steps + steps - KEPT:
            kept.append(x)
    return total / steps, np.array(kept)


def shares(alphas: NDArray[np.float64], count: int, settle_steps: int, steps: int) -> list[Share]:
    """One turn of the cascade at each alpha, far enough down that the limit is reached."""
    middles = (np.arange(count) + 0.5) / count
    rho = np.minimum(1e-8, alphas**14)[:, None] * alphas[:, None] ** (2.0 * middles)
    part = np.mean(exponents(alphas[:, None], rho, settle_steps, steps)[0] > 0.0, axis=1)
    return [
        Share(alpha=alpha, chaotic_part=chaotic, outside_windows=outside_windows(alpha))
        for alpha, chaotic in zip(alphas.tolist(), part.tolist(), strict=True)
    ]


def overdamped(run: Run, *, alphas: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    # next to a window's end both chaos and its absence are slow
    count, *steps = (60, 2000, 3000) if run.quick else (120, 4000, 8000)
    rows = shares(np.linspace(0.05, 0.95, alphas), count, *steps)
    run.table("overdamped", rows, "Chaotic part of ln rho, by exponents and by windows.", show=())
    run.figure(
        "overdamped",
        draw(rows, 150 if run.quick else 500),
        "The overdamped map: periods fall by one "
        "from window to window as rho rises, blue, with chaos between them, red; its part of ln rho "
        "as alpha grows.",
    )
    off = max(abs(row.chaotic_part - row.outside_windows) for row in rows)
    holds = off < (0.06 if run.quick else 0.03)  # a turn has few values of rho
    run.verdict(
        "period_adding",
        "agrees" if holds else "differs",
        found="windows of periods overlap for alpha below 1/4, are parted by chaos up to 2/3 and are gone"
        " above; the period falls by one from window to window as rho rises",
        note=f"the chaotic part of ln rho by exponents is that outside the windows within {off:.2g}",
    )
    return {"holds": holds, "largest_difference_from_the_windows": off}


@plotting.in_house_style
def draw(rows: Sequence[Share], drawn: int) -> Figure:
    """One cascade at `drawn` values of rho, coloured by the sign of the exponent, and the chaotic part."""
    figure, (first, last) = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.066)
    rho = np.geomspace(TOP * SHOWN**TURNS, TOP, drawn)
    exponent, x = exponents(SHOWN, rho, 1000, 2000)
    for chosen, look in ((exponent <= 0.0, plotting.BLUE), (exponent > 0.0, plotting.VERMILION)):
        first.plot(
            np.tile(rho[chosen], KEPT),
            (x[:, chosen] / np.sqrt(rho[chosen])).ravel(),
            ".",
            markersize=1.0,
            color=look,
            markeredgewidth=0.0,
            rasterized=True,
        )
    first.set_xscale("log")
    plotting.panel(first, 0, f"α = {SHOWN:g}: chaos between windows")
    plotting.label(first.yaxis, "$x$ / √ρ")
    plotting.label(first.xaxis, "ρ")
    alphas = [row.alpha for row in rows]
    last.plot(
        alphas,
        [row.outside_windows for row in rows],
        color=plotting.VERMILION,
        label="outside the windows of p$_m$",
    )
    last.plot(
        alphas,
        [row.chaotic_part for row in rows],
        color="black",
        marker="o",
        markersize=2.2,
        linestyle="none",
        label="exponent above 0",
    )
    for place, name in ((0.25, "1/4"), (2.0 / 3.0, "2/3")):
        last.axvline(place, **plotting.GUIDE)
        last.text(place + 0.01, 0.06, name, fontsize=plotting.NOTE)
    plotting.panel(last, 1, "chaotic part of ln ρ")
    last.legend(loc="upper left")
    plotting.label(last.xaxis, "α")
    plotting.label(last.yaxis, "chaotic part")
    last.set_ylim(-0.03, 1.05)
    return figure
