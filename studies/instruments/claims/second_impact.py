"""Claim b (letter 1996): the secondary bifurcations of the map lie at rho > 0, those of Eq. (1) not always.

"In the mapping these secondary bifurcations always occur at rho > 0. In Eq. (1) [they] may occur at values
rho < 0 that become smaller if collisions become more elastic": the first one above the fold against the
restitution tau at the frequencies of the scene, and the part of the (f, tau) plane in which it lies below
grazing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap

from contact.maximal_orbits import maximal_period, maximal_periods
from studies.instruments.claims.secondary_bifurcation import secondary, secondary_of_map
from studies.instruments.claims.single_mode_leaf import Leaf
from studies.instruments.claims.verdict import RESTITUTIONS, Claim, falls, frequencies_of
from studies.instruments.corresponding import corresponding
from studies.instruments.figures import (
    BLUE,
    GUIDE,
    LETTER_POINTS,
    ORANGE,
    PAGE,
    SKY,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
    series,
    tint,
)
from studies.instruments.scene import Scene
from studies.published import FREE_PERIOD_S, PERIODS, RESTITUTION

__all__ = ["secondary_claim"]

SCANNED_HZ = (19.62, 23.75)
"""Across the bands of p3 to p16, for the letter's spring."""


@in_house_style
def secondary_claim(scene: Scene, quick: bool) -> Claim:
    """b: the first secondary bifurcation against tau, and where it lies below grazing."""
    leaf = Leaf.of(scene)
    table: dict[str, list[Any]] = {
        n: [] for n in ("frequency_hz", "m", "restitution", "map", "eq1", "kind", "fold_eq1")
    }
    figure, axes = new_figure(1, 2, width=PAGE, height=0.084)
    numbers: dict[str, Any] = {}
    for number, f in enumerate(frequencies_of(scene)):
        m = leaf.period(f, 0.0)
        column = [secondary(leaf.family(f, tau, m)) for tau in RESTITUTIONS.tolist()]
        maps = [secondary_of_map(leaf.map(f, tau), m) for tau in RESTITUTIONS.tolist()]
        values = [math.nan if c is None or not c.admissible else c.excess for c in column]
        for tau, c, other in zip(RESTITUTIONS.tolist(), column, maps, strict=True):
            for name, value in zip(
                table,
                (
                    f,
                    m,
                    tau,
                    None if other is None else other.excess,
                    None if c is None else c.excess,
                    None if c is None else c.kind,
                    None if c is None else c.fold,
                ),
                strict=True,
            ):
                table[name].append(value)
        numbers[f"{f:g} Hz"] = {
            "m": m,
            "eq1": values,
            "falls_with_restitution": falls([v for v in values if math.isfinite(v)]),
        }
        axes[0].plot(
            RESTITUTIONS,
            1e2 * np.array(values),
            markevery=3,
            **series(number),
            label=f"{f:.2f} Hz, p$_{{{m}}}$",
        )
    # the (f, tau) plane: where the node p_m is lost below grazing
    low, high = (corresponding(scene, f) for f in SCANNED_HZ)
    across = np.linspace(low, high, 60 if quick else 240)
    upwards = np.linspace(0.0, 0.9, 10 if quick else 46)
    where, lowest = np.full((upwards.size, across.size), np.nan), math.inf
    for j, tau in enumerate(upwards.tolist()):
        for i, f in enumerate(across.tolist()):
            nordmark = leaf.map(f, tau)
            m = maximal_period(nordmark)
            other = secondary_of_map(nordmark, m)
            if other is not None and m in maximal_periods(nordmark):
                lowest = min(lowest, other.excess)
            found = secondary(leaf.family(f, tau, m))
            if found is not None:
                where[j, i] = 2.0 if not found.admissible else 1.0 if found.excess < 0.0 else 0.0
    below = np.nanmean(where > 0.0, axis=1)
    picture = axes[1].pcolormesh(
        across * leaf.free_period,
        upwards,
        where,
        cmap=_three(),
        vmin=-0.5,
        vmax=2.5,
        rasterized=True,
        shading="nearest",
        gid="0: above grazing; 1: below; 2: no simple p$_m$ at the fold",
    )
    numbers |= {
        "map_lowest_excess": lowest,
        "part_of_band_below_grazing": {
            f"tau {tau:g}": float(part) for tau, part in zip(upwards, below, strict=True)
        },
    }
    rises = bool(np.all(np.diff(below) >= -0.02))
    always = lowest > 0.0
    some, less = bool(below.max() > 0.0), bool(below[0] < below[-1])
    axes[0].axhline(0.0, **GUIDE, gid="grazing")
    panel(axes[0], 0, "Eq. (1)")
    mark_letter(axes[0].xaxis, RESTITUTION, along=0.02, turn=True, level=True)
    label(axes[0].xaxis, "restitution τ")
    label(axes[0].yaxis, "secondary bifurcation, excess", "%")
    for m in range(3, 11):
        entry = 2 * m / (2 * m + 1)
        if across[0] * leaf.free_period < entry < across[-1] * leaf.free_period:
            axes[1].axvline(entry, color="black", linewidth=0.5, gid=f"upper edge, m = {m}")
    places = np.array(list(PERIODS)) * FREE_PERIOD_S
    axes[1].plot(places, np.full(places.size, RESTITUTION), **LETTER_POINTS, gid="letter", label="letter")
    panel(axes[1], 1, "Eq. (1): the secondary bifurcation is")
    label(axes[1].xaxis, "f T")
    label(axes[1].yaxis, "restitution τ")
    figure.legend(loc="outside lower center", ncols=4)
    bar = figure.colorbar(
        picture, ax=axes[1], ticks=[0, 1, 2], location="bottom", aspect=40, drawedges=False
    )
    bar.ax.set_xticklabels(["above grazing", "below grazing", "no simple p$_m$"])
    bar.outline.set_visible(False)  # type: ignore[operator]
    monotone = [numbers[f"{f:g} Hz"]["falls_with_restitution"] for f in frequencies_of(scene)]
    numbers |= {"below_rises_with_restitution": rises, "excess_falls_at": sum(monotone)}
    holds = always and some and less and rises
    return Claim(
        holds=holds,
        numbers=numbers,
        table=table,
        figure=figure,
        sentence=(
            "In the map the node p_m keeps to one impact up to grazing at all frequencies and restitutions "
            f"(lowest secondary bifurcation at excess {lowest:.2g}); in Eq. (1) it does not in "
            f"{100 * below[0]:.0f} % of the scanned frequencies at tau = 0, "
            f"{100 * float(np.interp(0.1, upwards, below)):.0f} % at 0.1, {100 * below[-1]:.0f} % at 0.9; at "
            f"a fixed frequency the excess falls with tau throughout at {sum(monotone)} of {len(monotone)}."
        ),
    )


def _three() -> Any:
    return ListedColormap([tint(SKY, 0.3), BLUE, ORANGE])
