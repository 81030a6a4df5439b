"""The orbit diagrams of Fig. 5 below one another, and the born period as a map of labelled cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.patches import Rectangle

from contact.orbits.scan import OrbitDiagram
from studies.instruments.breakdown.plan import Plan
from studies.instruments.breakdown.scans import HIGHEST
from studies.instruments.figures import (
    EXCESS,
    GREEN,
    GUIDE,
    NOTE,
    ORANGE,
    PAGE,
    PALETTE,
    SKY,
    VERMILION,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
    tint,
)
from studies.instruments.scene import Scene
from studies.published import BREAKDOWN

__all__ = ["draw_born", "draw_scans"]


@in_house_style
def draw_scans(panels: Sequence[tuple[str, Mapping[str, OrbitDiagram[Any]], str, float | None]]) -> Any:
    """The scans below one another: steps below grazing on the left, the finer ones above it on the right."""
    figure, axes = new_figure(
        len(panels),
        2,
        width=PAGE,
        height=0.052 * len(panels) + 0.014,
        squeeze=False,
        sharey="row",
        width_ratios=[1.7, 1.0],
    )
    styles = {
        "down": (VERMILION, "none", 2.6, "downward scan", 2),
        "up": (PALETTE[1], PALETTE[1], 1.3, "upward scan", 3),
        "island": ("0.55", "0.55", 0.8, "island, followed upwards from its fold", 1),
    }
    letter = ["" for _ in panels]
    letter[-1], letter[0] = "letter: p$_6$ born here", "finer steps above grazing"
    lowest = min(float(d.excess.min()) for _, ways, _, _ in panels for d in ways.values())
    for i, (title, ways, quantity, fold) in enumerate(panels):
        for j, axis in enumerate(axes[i]):
            for way, diagram in ways.items():
                colour, face, size, name, order = styles[way]
                kept = diagram.excess >= -1e-12 if j else diagram.excess <= 1e-12
                x = np.repeat(diagram.excess[kept, None], diagram.points.shape[1], axis=1)
                axis.plot(
                    1e2 * x.ravel(),
                    1e3 * diagram.points[kept].ravel(),
                    linestyle="none",
                    marker="s" if way == "island" else "o",
                    markersize=size,
                    markerfacecolor=face,
                    markeredgecolor=colour,
                    markeredgewidth=0.4,
                    label=name,
                    zorder=order,
                    rasterized=True,
                )
            axis.axvline(0.0, **GUIDE, gid="grazing")
            axis.set_xlim(*((-0.03, 1e2 * HIGHEST + 0.03) if j else (1e2 * lowest - 0.3, 0.2)))
        panel(axes[i, 0], i, title)
        axes[i, 1].set_title(letter[i], loc="right")
        axes[i, 1].set_label(f"{chr(ord('a') + i)}, above grazing")
        if i == 0:
            mark_letter(axes[0, 0].xaxis, 1e2 * BREAKDOWN["chaos_at"], words="letter: chaos\nof Eq. (1)",
                        along=0.98, turn=True, level=True)
        label(axes[i, 0].yaxis, f"{quantity} displacement" if quantity == "read-out" else quantity, "mm")
        if fold is not None:
            room = fold > 0.85 * lowest  # on the left of the line
            axes[i, 0].axvline(1e2 * fold, color=GREEN, linestyle="-.", linewidth=0.9, zorder=0,
                               gid="fold of p$_3$")
            axes[i, 0].annotate(
                "fold of p$_3$",
                (1e2 * fold, 0.98 if room else 0.86),
                xycoords=("data", "axes fraction"),
                xytext=(-3 if room else 3, 0),
                textcoords="offset points",
                ha="right" if room else "left",
                va="top",
                fontsize=NOTE,
                color=GREEN,
            )
    for axis in axes[-1]:
        label(axis.xaxis, EXCESS, "%")
    handles, names = [], []
    for axis in axes.flat:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            if name not in names:
                handles.append(handle)
                names.append(name)
    figure.legend(handles, names, loc="outside lower center", ncols=3, markerscale=2.0)
    return figure


@in_house_style
def draw_born(
    cells: Sequence[Mapping[str, Any]], plan: Plan, scene: Scene, at: Mapping[str, Any] | None
) -> Any:
    """The born period as a map of labelled cells, one panel for each restitution of the contact."""
    figure, axes = new_figure(
        1, len(plan.local), width=PAGE, height=0.030 + 0.0058 * len(plan.masses), squeeze=False, sharey=True
    )
    colours = {3: SKY, 6: ORANGE, 12: tint(ORANGE, 0.4), 0: "0.87", None: "white"}
    for number, (axis, local) in enumerate(zip(axes[0], plan.local, strict=True)):
        for cell in (c for c in cells if c["local_restitution"] == local):
            i, j = plan.masses.index(cell["tip_mass_kg"]), plan.factors.index(cell["higher_damping"])
            period = cell["period"]
            name = "not computed" if period is None else f"period {period}" if period else "no period"
            axis.add_patch(_cell(j, i, colours.get(period, tint(GREEN, 0.2)), name))
            axis.text(
                j,
                i,
                "×" if period is None else str(period) if period else "–",
                ha="center",
                va="center",
                fontsize=NOTE,
                fontweight="bold" if period == 6 else "normal",
            )
            if at is not None and cell is at:
                axis.add_patch(_cell(j, i, "none", "scanned", edge="black", width=1.2))
        axis.set_xlim(-0.5, len(plan.factors) - 0.5)
        axis.set_ylim(-0.5, len(plan.masses) - 0.5)
        axis.set_xticks(range(len(plan.factors)), [f"{k:g}" for k in plan.factors])
        axis.tick_params(length=0)
        for side in axis.spines.values():
            side.set_visible(False)
        words = "elastic contact" if local == 1.0 else f"lossy contact, local restitution {local:g}"
        panel(axis, number, words)
        label(axis.xaxis, "damping of the higher modes / that of the strips")
    axes[0, 0].set_yticks(range(len(plan.masses)), [f"{1e3 * m:.2f}" for m in plan.masses])
    label(axes[0, 0].yaxis, "ball and mount", "g")
    framed = "; framed: scanned in panel (c) of the orbit diagrams" if at is not None else ""
    figure.supxlabel(
        "number: period of the orbit born at grazing, at excess 10$^{-3}$ (letter: 6); –: none up to 64"
        + f"{framed}\nthe calibrated ball and mount have {1e3 * scene.tip.mass_kg:.2f} g",
        fontsize=NOTE,
    )
    return figure


def _cell(x: float, y: float, face: str, name: str, edge: str = "white", width: float = 0.8) -> Rectangle:
    return Rectangle(
        (x - 0.5, y - 0.5),
        1.0,
        1.0,
        facecolor=face,
        edgecolor=edge,
        linewidth=width,
        gid=name,
        zorder=2 if face == "none" else 1,
    )
