"""Period adding of the overdamped oscillator: windows of p_m and the chaos between them as rho -> 0+.

By two independent routes: the limits of the windows from the exact orbits, and the chaotic part of one turn
of ln rho from Lyapunov exponents. The period falls by one from window to window as rho rises.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from studies import plotting
from studies.claims.overdamped_map import (
    exponents,
    outside_windows,
    overdamped_map,
    overlap,
    switch,
    window,
)
from studies.record import Verdict
from studies.run import Run

__all__ = ["Cascade", "Limits", "Share", "cascade_at", "limits_at", "overdamped", "shares"]

FAR = 16
"""m at which the windows are in their limit: what rho -> 0+ neglects is of the order l^m, 0.2 % here."""

SHOWN = {0.20: "windows overlap", 0.45: "chaos between windows", 0.80: "chaos only"}
"""alpha of the panels."""


@dataclass(frozen=True, kw_only=True)
class Share:
    """Parts of ln rho: where the exponent is above 0, and what lies outside the windows of all p_m."""

    alpha: float
    chaotic_part: float
    outside_windows: float


@dataclass(frozen=True, kw_only=True)
class Limits:
    """alpha up to which neighbouring windows overlap (None: nowhere), and up to which there are windows."""

    gamma: float
    overlap_ends_at_alpha: float | None
    windows_end_at_alpha: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Cascade:
    """Exponents, shape (n_rho,), and iterates x, shape (n, n_rho), along rho."""

    alpha: float
    rho: NDArray[np.float64]
    exponent: NDArray[np.float64]
    x: NDArray[np.float64]


def limits_at(gamma: float, halvings: int) -> Limits:
    """The limits of the windows."""
    least = 2.0 * float(np.sqrt(gamma)) + 0.02

    def coexist(alpha: float) -> bool:
        return overlap(alpha, gamma, FAR) > 0.0

    def exists(alpha: float) -> bool:
        return window(overdamped_map(alpha, gamma), FAR) is not None

    return Limits(
        gamma=gamma, windows_end_at_alpha=switch(exists, 0.4, 0.95, halvings),
        overlap_ends_at_alpha=switch(coexist, least, 0.6, halvings) if coexist(least) else None,
    )  # fmt: skip


def shares(alphas: NDArray[np.float64], count: int, settle_steps: int, steps: int) -> list[Share]:
    """One turn of the cascade at each alpha, far enough down that the limit is reached."""
    middles = (np.arange(count) + 0.5) / count
    rho = np.minimum(1e-8, alphas**14)[:, None] * alphas[:, None] ** (2.0 * middles)
    part = np.mean(exponents(alphas[:, None], rho, settle_steps, steps)[0] > 0.0, axis=1)
    return [
        Share(alpha=alpha, chaotic_part=chaotic, outside_windows=outside_windows(alpha))
        for alpha, chaotic in zip(alphas.tolist(), part.tolist(), strict=True)
    ]


def cascade_at(alpha: float, count: int) -> Cascade:
    """Iterates over a few turns of the cascade below rho = 1e-3."""
    top, turns = 1e-3, 4 if alpha < 0.7 else 16
    rho = np.geomspace(top * alpha**turns, top, count)
    found, x = exponents(alpha, rho, 1000, 2000)
    return Cascade(alpha=alpha, rho=rho, exponent=found, x=x[:: 1 if alpha < 0.7 else 4])


def overdamped(run: Run, *, alphas: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    # next to a window's end both chaos and its absence are slow
    count, *steps = (60, 2000, 3000) if run.quick else (120, 4000, 8000)
    rows = shares(np.linspace(0.05, 0.95, alphas), count, *steps)
    limits = [limits_at(gamma, 10 if run.quick else 14) for gamma in (0.0, 0.01)]
    cascades = [cascade_at(alpha, 150 if run.quick else 500) for alpha in SHOWN]
    run.table("overdamped", rows, "Chaotic part of ln rho, by exponents and by windows.", show=())
    run.arrays("overdamped_cascade", **{
        f"{name}_{100 * one.alpha:.0f}": getattr(one, name)
        for one in cascades for name in ("rho", "exponent", "x")
    })  # fmt: skip
    run.figure(
        "overdamped",
        draw(rows, cascades),
        "The overdamped map: windows of periods that overlap, are parted"
        " by chaos, or are gone, as alpha grows.",
    )
    off = max(abs(row.chaotic_part - row.outside_windows) for row in rows)
    ends = limits[0].overlap_ends_at_alpha or 0.0, limits[0].windows_end_at_alpha
    few = 0.06 if run.quick else 0.03  # a turn has few values of rho
    holds = abs(ends[0] - 0.25) < 0.002 and abs(ends[1] - 2.0 / 3.0) < 0.002 and off < few
    verdict: Verdict = "agrees" if holds else "differs"
    run.verdict(
        "period_adding", verdict,
        found=f"windows of p{FAR} and p{FAR + 1} overlap for alpha below {ends[0]:.4f}, are parted by chaos"
        f" up to {ends[1]:.4f} and are gone above (1/4 and 2/3)",
        note=f"the chaotic part of ln rho is that outside the windows within {off:.2g}; the period falls"
        " by one from window to window as rho rises",
    )  # fmt: skip
    return {"holds": holds, "limits": limits, "largest_difference_from_the_windows": off}


@plotting.in_house_style
def draw(rows: Sequence[Share], cascades: Sequence[Cascade]) -> Figure:
    """Three cascades and the chaotic part."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.105)
    for number, (axis, one) in enumerate(zip(axes.flat, cascades, strict=False)):
        _cascade(axis, one)
        plotting.panel(axis, number, f"α = {one.alpha:g}: {SHOWN[one.alpha]}")
    last, alphas = axes.flat[3], [row.alpha for row in rows]
    last.plot(alphas, [row.outside_windows for row in rows], color=plotting.VERMILION,
              label="outside the windows of p$_m$")  # fmt: skip
    last.plot(alphas, [row.chaotic_part for row in rows], color="black", marker="o", markersize=2.2,
              linestyle="none", label="exponent above 0")  # fmt: skip
    for place, name in ((0.25, "1/4"), (2.0 / 3.0, "2/3")):
        last.axvline(place, **plotting.GUIDE, gid=f"α = {name}")
        last.text(place + 0.01, 0.06, name, fontsize=plotting.NOTE)
    plotting.panel(last, 3, "chaotic part of ln ρ")
    last.legend(loc="upper left")
    plotting.label(last.xaxis, "α")
    plotting.label(last.yaxis, "chaotic part")
    last.set_ylim(-0.03, 1.05)
    return figure


def _cascade(axis: Axes, one: Cascade) -> None:
    """Iterates over rho, coloured by the sign of the exponent."""
    for chaos, colour in ((False, plotting.BLUE), (True, plotting.VERMILION)):
        chosen = (one.exponent > 0.0) == chaos
        axis.plot(
            np.tile(one.rho[chosen], one.x.shape[0]), (one.x[:, chosen] / np.sqrt(one.rho[chosen])).ravel(),
            linestyle="none", marker="s" if chaos else ".", markersize=0.7 if chaos else 1.0, color=colour,
            markeredgewidth=0.0, rasterized=True, gid="exponent above 0" if chaos else "exponent below 0",
        )  # fmt: skip
    axis.set_xscale("log")
    axis.xaxis.set_minor_formatter(NullFormatter())
    plotting.label(axis.yaxis, "$x$ / √ρ")
    plotting.label(axis.xaxis, "ρ")
