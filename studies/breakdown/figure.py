"""The orbit diagrams of Fig. 5 below one another, and the born period as a map of labelled cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from contact.orbits import OrbitDiagram
from studies import plotting
from studies.breakdown.beam import Cell
from studies.breakdown.scans import CHAOS_AT, HIGHEST, Outcome, periods
from studies.plotting import BLUE, EXCESS, GREEN, GUIDE, NOTE, ORANGE, PAGE, SKY, VERMILION, tint

__all__ = ["draw_born", "draw_scans"]

STYLES = {
    "down": (VERMILION, "none", 2.6, "downward scan", 2),
    "up": (BLUE, BLUE, 1.3, "upward scan", 3),
    "island": ("0.55", "0.55", 0.8, "island, followed upwards from its fold", 1),
}
"""Way -> colour of edge and face, size, name, order."""

PALE = 0.35
"""Share of the colour that is left where a motion did not settle: its points are those of a moment."""


def title_of(outcome: Outcome) -> str:
    """What a panel shows."""
    if outcome.tip_mass_kg is None:
        return outcome.description
    words = f"beam, {1e3 * outcome.tip_mass_kg:.2f} g"
    if outcome.description == "beam":
        return f"{words}, as calibrated"
    if outcome.higher_damping != 1.0:
        words += f", damping of the higher modes × {outcome.higher_damping:g}"
    if outcome.local_restitution not in (None, 1.0):
        words += f", local restitution {outcome.local_restitution:g}"
    return words


@plotting.in_house_style
def draw_scans(panels: Sequence[tuple[Outcome, Mapping[str, OrbitDiagram[Any]]]]) -> Figure:
    """The scans below one another: steps below grazing on the left, the finer ones above it on the right."""
    figure, axes = plotting.new_figure(
        len(panels), 2, width=PAGE, height=0.052 * len(panels) + 0.014, squeeze=False, sharey="row",
        width_ratios=[1.7, 1.0],
    )  # fmt: skip
    lowest = min(float(d.excess.min()) for _, ways in panels for d in ways.values())
    for number, (pair, (outcome, ways)) in enumerate(zip(axes, panels, strict=True)):
        for above, axis in enumerate(pair):
            for way, diagram in ways.items():
                colour, face, size, name, order = STYLES[way]
                side = diagram.excess >= -1e-12 if above else diagram.excess <= 1e-12
                for settled in (True, False):
                    kept = side & ((periods(diagram) > 0) == settled)
                    share = 1.0 if settled or way == "island" else PALE
                    x = np.repeat(diagram.excess[kept, None], diagram.points.shape[1], axis=1)
                    axis.plot(
                        1e2 * x.ravel(), 1e3 * diagram.points[kept].ravel(), linestyle="none", marker="o",
                        markersize=size, markeredgewidth=0.4, rasterized=True, zorder=order * share,
                        markerfacecolor=face if face == "none" else tint(face, share) if share < 1 else face,
                        markeredgecolor=tint(colour, share) if share < 1 else colour,
                        label=name if settled or way == "island" else f"_{name}",
                    )  # fmt: skip
            axis.axvline(0.0, **GUIDE)
            axis.set_xlim(*((-0.03, 1e2 * HIGHEST + 0.03) if above else (1e2 * lowest - 0.3, 0.2)))
        plotting.panel(pair[0], number, title_of(outcome))
        plotting.label(pair[0].yaxis, "tip displacement" if number == 0 else "read-out", "mm")
        if outcome.fold_p3 is not None:
            pair[0].axvline(1e2 * outcome.fold_p3, color=GREEN, linestyle="-.", linewidth=0.9, zorder=0,
                            label="fold of p$_3$")  # fmt: skip
    axes[0, 1].set_title("finer steps above grazing", loc="right")
    axes[-1, 1].set_title("letter: p$_6$ born here", loc="right")
    plotting.mark_letter(axes[0, 0].xaxis, 1e2 * CHAOS_AT, words="letter: chaos\nof Eq. (1)", along=0.98,
                         turn=True, level=True)  # fmt: skip
    for axis in axes[-1]:
        plotting.label(axis.xaxis, EXCESS, "%")
    named: dict[str, Any] = {}
    for axis in axes.flat:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            named.setdefault(name, handle)
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=4, markerscale=2.0)
    return figure


@plotting.in_house_style
def draw_born(cells: Sequence[Cell], mass: float, framed: int | None) -> Figure:
    """The born period as a map of labelled cells, one panel for each restitution of the contact."""
    local = sorted({cell.local_restitution or 1.0 for cell in cells}, reverse=True)
    masses = sorted({cell.tip_mass_kg for cell in cells})
    factors = sorted({cell.higher_damping for cell in cells})
    figure, axes = plotting.new_figure(
        1, len(local), width=PAGE, height=0.030 + 0.0058 * len(masses), squeeze=False, sharey=True
    )
    colours = {3: SKY, 6: ORANGE, 12: tint(ORANGE, 0.4), 0: "0.87", None: "white"}
    for place, cell in enumerate(cells):
        axis = axes[0, local.index(cell.local_restitution or 1.0)]
        x, y = factors.index(cell.higher_damping), masses.index(cell.tip_mass_kg)
        corner, colour = (x - 0.5, y - 0.5), colours.get(cell.period, tint(GREEN, 0.2))
        axis.add_patch(Rectangle(corner, 1.0, 1.0, facecolor=colour, edgecolor="white", linewidth=0.8))
        if place == framed:
            frame = Rectangle(corner, 1.0, 1.0, facecolor="none", edgecolor="black", linewidth=1.2, zorder=2)
            axis.add_patch(frame)
        axis.text(x, y, "×" if cell.period is None else str(cell.period or "–"), ha="center", va="center",
                  fontsize=NOTE, fontweight="bold" if cell.period == 6 else "normal")  # fmt: skip
    for number, (axis, restitution) in enumerate(zip(axes[0], local, strict=True)):
        axis.set(xlim=(-0.5, len(factors) - 0.5), ylim=(-0.5, len(masses) - 0.5))
        axis.set_xticks(range(len(factors)), [f"{k:g}" for k in factors])
        axis.tick_params(length=0)
        axis.spines[:].set_visible(False)
        lossy = f"lossy contact, local restitution {restitution:g}"
        plotting.panel(axis, number, "elastic contact" if restitution == 1.0 else lossy)
        plotting.label(axis.xaxis, "damping of the higher modes / that of the strips")
    axes[0, 0].set_yticks(range(len(masses)), [f"{1e3 * m:.2f}" for m in masses])
    plotting.label(axes[0, 0].yaxis, "ball and mount", "g")
    figure.supxlabel("number: period born at excess 10$^{-3}$ (letter: 6); –: none up to 64; "
                     f"the calibrated ball and mount have {1e3 * mass:.2f} g", fontsize=NOTE)  # fmt: skip
    return figure
