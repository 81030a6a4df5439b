"""The hysteresis against the energy lost in a collision: fold of p_m against the restitution tau.

The hysteresis is 1 - F_m/F_g at the fold of p_m, in closed form for the map and for Eq. (1); less energy is
lost at a larger tau. A fold of Eq. (1) counts where its orbit has no second impact. What falls with the loss
is the hysteresis in the drive amplitude; |rho_m| itself rises in the map, because rho per F falls faster.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from contact import fold, maximal_period
from studies import letter, plotting
from studies.claims.equation_one import RESTITUTIONS, falls, family_at, map_at, secondary_of
from studies.record import Verdict
from studies.run import Run
from studies.scene import Scene

__all__ = ["Fold", "fold_at", "loss", "trends"]


@dataclass(frozen=True, kw_only=True)
class Fold:
    """Folds of p_m at one frequency and restitution.

    `map`, `eq1`: F_m/F_g - 1; `rho`: rho_m of the map; NaN without a fold. `admissible`: whether the orbit of
    Eq. (1) at its fold has one impact only.
    """

    frequency_hz: float
    period: int
    restitution: float
    map: float
    rho: float
    eq1: float
    admissible: bool


def fold_at(scene: Scene, frequency: float, restitution: float) -> Fold:
    """Both folds of the period that the band of tau = 0 has."""
    m = maximal_period(map_at(scene, frequency, 0.0))
    nordmark = map_at(scene, frequency, restitution)
    end, found = fold(nordmark, m), secondary_of(family_at(scene, frequency, restitution, m))
    return Fold(
        frequency_hz=frequency, period=m, restitution=restitution,
        map=math.nan if end is None else nordmark.excess(end.rho), rho=math.nan if end is None else end.rho,
        eq1=math.nan if found is None else found.fold, admissible=found is not None and found.admissible,
    )  # fmt: skip


def trends(rows: Sequence[Fold]) -> Mapping[str, bool]:
    """Whether the size of each quantity falls with the energy lost, at every frequency."""
    good = {"map": True, "eq1": True, "rho": True}
    for frequency in {row.frequency_hz for row in rows}:
        mine = sorted((r for r in rows if r.frequency_hz == frequency), key=lambda row: -row.restitution)
        good["map"] &= falls([-row.map for row in mine])
        good["rho"] &= falls([-row.rho for row in mine])
        good["eq1"] &= falls([-row.eq1 for row in mine if row.admissible])
    return good


def loss(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    cells = [(f, tau) for f in sorted(scene.drive.frequencies_hz) for tau in RESTITUTIONS]
    rows = [fold_at(scene, *cell) for cell in run.track(cells, "folds against loss")]
    run.table("loss", rows, "Fold of p_m, F_m/F_g - 1, against the restitution.", show=())
    run.figure(
        "loss",
        draw(rows),
        "Hysteresis against restitution at the six frequencies: a smaller restitution,"
        " more energy lost, less hysteresis, in the map and in Eq. (1).",
    )
    found = trends(rows)
    both = found["map"] and found["eq1"]
    verdict: Verdict = "differs" if not both else "agrees" if found["rho"] else "in part"
    parts = ", ".join(f"{name} {'yes' if good else 'no'}" for name, good in found.items())
    note = "" if found["rho"] else "the hysteresis in F falls; |rho_m| rises, for rho per F falls faster"
    run.verdict("loss", verdict, found=f"falls with the loss: {parts}", note=note)
    return {"falls": found, "holds": both}


@plotting.in_house_style
def draw(rows: Sequence[Fold]) -> Figure:
    """Hysteresis against tau, the map and Eq. (1)."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.072)
    for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
        mine = [row for row in rows if row.frequency_hz == frequency]
        tau, style = [row.restitution for row in mine], plotting.series(number % 8)
        name = f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$"
        axes[0].plot(tau, [-1e2 * row.map for row in mine], markevery=3, **style, label=name)
        exact = [-1e2 * row.eq1 if row.admissible else math.nan for row in mine]
        axes[1].plot(tau, exact, markevery=3, **style, gid=name)
    for place, (axis, title) in enumerate(zip(axes, ("Nordmark map", "Eq. (1)"), strict=True)):
        axis.set_yscale("log")
        axis.set_ylim(4e-3, 30.0)
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.98, turn=True, level=True)
        plotting.label(axis.xaxis, "restitution τ")
    plotting.label(axes[0].yaxis, plotting.HYSTERESIS, "%")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
