"""Claim a (letter 1996): "The magnitude of the hysteresis |rho_m| decreases with increasing energy loss".

The hysteresis is F_m/F_g - 1, excess of the fold of p_m: in closed form for the Nordmark map and for Eq. (1),
against the restitution tau at each frequency of the scene.  Less energy is lost at a larger tau.  A fold of
Eq. (1) counts where its orbit has no second impact.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contact.maximal_orbits import fold
from studies.instruments.claims.secondary_bifurcation import secondary
from studies.instruments.claims.single_mode_leaf import Leaf
from studies.instruments.claims.verdict import RESTITUTIONS, Claim, falls, frequencies_of
from studies.instruments.figures import (
    HYSTERESIS,
    PAGE,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
    series,
)
from studies.instruments.scene import Scene
from studies.published import RESTITUTION

__all__ = ["hysteresis_claim"]


@in_house_style
def hysteresis_claim(scene: Scene) -> Claim:
    """a: F_m/F_g - 1 against tau."""
    leaf = Leaf.of(scene)
    table: dict[str, list[Any]] = {
        n: [] for n in ("frequency_hz", "m", "restitution", "map", "rho", "eq1", "admissible")
    }
    figure, axes = new_figure(1, 2, width=PAGE, height=0.072)
    numbers: dict[str, Any] = {}
    good = {"map": True, "eq1": True, "rho": True}
    for number, f in enumerate(frequencies_of(scene)):
        m = leaf.period(f, 0.0)
        ends, rhos, exact, real = [], [], [], []
        for tau in RESTITUTIONS.tolist():
            nordmark, family = leaf.map(f, tau), leaf.family(f, tau, m)
            end, found = fold(nordmark, m), secondary(family)
            ends.append(math.nan if end is None else -nordmark.excess(end.rho))
            rhos.append(math.nan if end is None else -end.rho)
            exact.append(math.nan if found is None else -found.fold)
            real.append(found is not None and found.admissible)
        for name, column in zip(
            table,
            (
                [f] * len(ends),
                [m] * len(ends),
                RESTITUTIONS.tolist(),
                [-v for v in ends],
                [-v for v in rhos],
                [-v for v in exact],
                real,
            ),
            strict=True,
        ):
            table[name] += column
        # less energy lost, more hysteresis: in order of falling tau the values fall
        good["map"] &= falls(ends[::-1])
        good["rho"] &= falls(rhos[::-1])
        mask = np.array(real)
        good["eq1"] &= falls(np.array(exact)[mask][::-1].tolist())
        numbers[f"{f:g} Hz"] = {
            "m": m,
            "map": [-ends[0], -ends[-1]],
            "rho": [-rhos[0], -rhos[-1]],
            "eq1": [-exact[0], -exact[-1]],
            "largest_restitution_of_a_real_fold": float(RESTITUTIONS[mask].max()) if mask.any() else None,
        }
        style = series(number)
        axes[0].plot(
            RESTITUTIONS, 1e2 * np.array(ends), markevery=3, **style, label=f"{f:.2f} Hz, p$_{{{m}}}$"
        )
        axes[1].plot(RESTITUTIONS, np.where(mask, 1e2 * np.array(exact), np.nan), markevery=3, **style,
                     gid=f"{f:.2f} Hz, p$_{{{m}}}$")
    for place, (axis, title) in enumerate(zip(axes, ("Nordmark map", "Eq. (1)"), strict=True)):
        axis.set_yscale("log")
        panel(axis, place, title)
        mark_letter(axis.xaxis, RESTITUTION, along=0.98, turn=True, level=True)
        label(axis.xaxis, "restitution τ")
        axis.set_ylim(4e-3, 30.0)
    label(axes[0].yaxis, HYSTERESIS, "%")
    figure.legend(loc="outside lower center", ncols=3)
    sentence = (
        "The hysteresis in the drive amplitude falls with rising energy loss in the map and in Eq. (1)"
        if good["map"] and good["eq1"]
        else "The hysteresis does not fall with rising energy loss everywhere"
    ) + (
        ", and so does |rho_m| of the map."
        if good["rho"]
        else "; |rho_m| of the map itself rises instead; the trend is that of rho per F."
    )
    return Claim(
        holds=good["map"] and good["eq1"],
        numbers={**numbers, "falls": good},
        sentence=sentence,
        table=table,
        figure=figure,
    )
