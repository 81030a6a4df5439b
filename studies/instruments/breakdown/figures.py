"""The orbit diagrams of Fig. 5 below one another, and the born period as a map of labelled cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.breakdown.plan import Plan
from studies.instruments.breakdown.scans import HIGHEST
from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.orbit_scan import OrbitDiagram
from studies.instruments.scene import Scene

__all__ = ["draw_born", "draw_scans"]


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
        "down": ("#D55E00", "none", 2.6, "downward scan", 2),
        "up": (PALETTE[1], PALETTE[1], 1.3, "upward scan", 3),
        "island": ("0.55", "none", 1.2, "island, followed upwards from its fold", 1),
    }
    lowest = min(float(d.excess.min()) for _, ways, _, _ in panels for d in ways.values())
    with house_style():
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
                        marker="o",
                        markersize=size,
                        markerfacecolor=face,
                        markeredgecolor=colour,
                        markeredgewidth=0.4,
                        label=name,
                        zorder=order,
                        rasterized=True,
                    )
                axis.axvline(0.0, color="0.6", linestyle="--", linewidth=0.6, zorder=0)
                axis.set_xlim(*((-0.03, 1e2 * HIGHEST + 0.03) if j else (1e2 * lowest - 0.3, 0.2)))
            axes[i, 0].set_title(f"({chr(ord('a') + i)}) {title}", loc="left")
            label(axes[i, 0].yaxis, quantity, "mm")
            if fold is not None:
                room = fold > 0.85 * lowest  # on the left of the line
                axes[i, 0].axvline(1e2 * fold, color="#009E73", linestyle=":", linewidth=0.9, zorder=0)
                axes[i, 0].annotate(
                    "fold of p$_3$",
                    (1e2 * fold, 0.98 if room else 0.86),
                    xycoords=("data", "axes fraction"),
                    xytext=(-3 if room else 3, 0),
                    textcoords="offset points",
                    ha="right" if room else "left",
                    va="top",
                    fontsize=7,
                    color="#00704F",
                )
        axes[0, 1].set_title("finer steps above grazing", loc="right")
        for axis in axes[-1]:
            label(axis.xaxis, "excess F/F$_g$ - 1", "%")
        handles, names = [], []
        for axis in axes.flat:
            for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
                if name not in names:
                    handles.append(handle)
                    names.append(name)
        figure.legend(handles, names, loc="outside lower center", ncols=3, markerscale=2.0)
    return figure


def draw_born(
    cells: Sequence[Mapping[str, Any]], plan: Plan, scene: Scene, at: Mapping[str, Any] | None
) -> Any:
    """The born period as a map of labelled cells, one panel for each restitution of the contact."""
    figure, axes = new_figure(
        1, len(plan.local), width=PAGE, height=0.030 + 0.0058 * len(plan.masses), squeeze=False, sharey=True
    )
    colours = {3: "#56B4E9", 6: "#E69F00", 12: "#F5D9A0", 0: "#DDDDDD", None: "#FFFFFF"}
    with house_style():
        for axis, local in zip(axes[0], plan.local, strict=True):
            for cell in (c for c in cells if c["local_restitution"] == local):
                i, j = plan.masses.index(cell["tip_mass_kg"]), plan.factors.index(cell["higher_damping"])
                period = cell["period"]
                axis.add_patch(_cell(j, i, colours.get(period, "#CFE8D5")))
                axis.text(
                    j,
                    i,
                    "×" if period is None else str(period) if period else "–",
                    ha="center",
                    va="center",
                    fontsize=7,
                    fontweight="bold" if period == 6 else "normal",
                )
                if at is not None and cell is at:
                    axis.add_patch(_cell(j, i, "none", edge="black", width=1.2))
            axis.set_xlim(-0.5, len(plan.factors) - 0.5)
            axis.set_ylim(-0.5, len(plan.masses) - 0.5)
            axis.set_xticks(range(len(plan.factors)), [f"{k:g}" for k in plan.factors])
            axis.tick_params(length=0)
            for side in axis.spines.values():
                side.set_visible(False)
            words = "elastic contact" if local == 1.0 else f"lossy contact, local restitution {local:g}"
            axis.set_title(words)
            label(axis.xaxis, "damping of the higher modes / that of the strips")
        axes[0, 0].set_yticks(range(len(plan.masses)), [f"{1e3 * m:.2f}" for m in plan.masses])
        label(axes[0, 0].yaxis, "ball and mount", "g")
        framed = "; framed: scanned in panel (c) of the orbit diagrams" if at is not None else ""
        figure.supxlabel(
            "number: period of the orbit born at grazing, at excess 10$^{-3}$; –: none up to 64"
            + f"{framed}\nthe calibrated ball and mount have {1e3 * scene.tip.mass_kg:.2f} g",
            fontsize=7,
        )
    return figure


def _cell(x: float, y: float, face: str, edge: str = "white", width: float = 0.8) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle(
        (x - 0.5, y - 0.5),
        1.0,
        1.0,
        facecolor=face,
        edgecolor=edge,
        linewidth=width,
        zorder=2 if face == "none" else 1,
    )
