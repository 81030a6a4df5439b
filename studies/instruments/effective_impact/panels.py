"""Panels of the figures of one approach to the plate: series, guides and legend in one manner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from studies.instruments.effective_impact.approaches import select
from studies.instruments.figures import LINES, MARKERS, PAGE, PALETTE, house_style, label, new_figure
from studies.published import RESTITUTION

__all__ = ["DOTTED", "PANELS", "QUANTITIES", "Rows", "guide", "legend", "name_letter", "plot", "three"]

Rows = Sequence[dict[str, Any]]
DOTTED: dict[str, Any] = {"color": "0.55", "linewidth": 0.7, "zorder": 0, "linestyle": ":"}

PANELS = (("restitution", 1.0), ("delay_s", 1e3), ("kick", 1.0))
"""Column of the rows and factor to the unit of its axis."""

TITLES = {
    "scene": "contact of the scene",
    "hertz": "Hertz",
    "newton": "Newton, e = 1",
    "bare tip": "bare tip, Hertz",
    "light tip, hertz": "light tip, Hertz",
    "bare cantilever, hertz": "bare cantilever, Hertz",
    "bare cantilever, newton": "bare cantilever, Newton, e = 1",
    "as in the scene": "as in the scene",
}
QUANTITIES = {
    "speed": ("excess F/F$_g$ - 1", "1"),
    "modes": ("modes kept", "1"),
    "mass": ("tip mass / mass of the leaf", "1"),
    "stiffness": ("contact stiffness / tip stiffness", "1"),
    "damping": ("factor on the rates of higher modes", "1"),
    "loss": ("local restitution", "1"),
    "search": ("tip mass / mass of the leaf", "1"),
}


def plot(axis: Axes, rows: Rows, quantity: str, number: int, scale: float = 1.0, every: int = 1) -> None:
    name = str(rows[0]["series"])
    axis.plot(
        [r["value"] for r in rows],
        [scale * r[quantity] for r in rows],
        color=PALETTE[number],
        linestyle=LINES[number],
        marker=MARKERS[number],
        markevery=every,
        markersize=2.8,
        markerfacecolor="white",
        markeredgewidth=0.7,
        label=TITLES.get(name, name),
    )


def three(
    rows: Rows, curve: str, series: Sequence[str], *, log: bool, height: float = 0.066
) -> tuple[Any, Any]:
    """Restitution, delay and kick of some series of a curve."""
    figure, axes = new_figure(1, 3, width=PAGE, height=height)
    for number, name in enumerate(series):
        found = select(rows, curve, name)
        if not found:
            continue
        every = max(1, len(found) // 12)
        for axis, (quantity, scale) in zip(axes, PANELS, strict=True):
            plot(axis, found, quantity, number, scale, every)
    for axis, (quantity, unit) in zip(
        axes, (("restitution τ", "1"), ("delay", "ms"), ("kick", "1")), strict=True
    ):
        if log:
            axis.set_xscale("log")
        with house_style():
            label(axis.xaxis, *QUANTITIES[curve])
            label(axis.yaxis, quantity, unit)
        axis.set_ylim(bottom=0.0)
    axes[0].axhline(RESTITUTION, **DOTTED)
    return figure, axes


def guide(axis: Axes, x: Sequence[float], y: Sequence[float], name: str, style: str = "--") -> None:
    axis.plot(x, y, color="0.45", linewidth=0.8, linestyle=style, zorder=1, label=name)


def legend(figure: Any, axes: Any, columns: int = 4, *, left: bool = False) -> None:
    """One legend below, every name once; the letter's restitution is the dotted line in the first panel."""
    found: dict[str, Any] = {}
    for axis in axes:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            found.setdefault(name, handle)
    with house_style():
        figure.legend(
            list(found.values()), list(found), loc="outside lower center", ncols=columns, handlelength=3.0,
            columnspacing=1.5,
        )
        name_letter(axes[0], left)


def name_letter(axis: Axes, left: bool = False) -> None:
    axis.annotate(
        "letter", (0.02 if left else 0.99, RESTITUTION), xycoords=axis.get_yaxis_transform(),
        ha="left" if left else "right", va="bottom", fontsize=6.5, color="0.4",
    )
