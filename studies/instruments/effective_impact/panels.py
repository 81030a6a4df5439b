"""Panels of the figures of one approach to the plate: series, guides and legend in one manner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from studies.instruments.effective_impact.approaches import select
from studies.instruments.figures import (
    EXCESS,
    LINES,
    MARKERS,
    PAGE,
    PALETTE,
    label,
    mark_letter,
    new_figure,
    panel,
)
from studies.published import RESTITUTION

__all__ = ["PANELS", "QUANTITIES", "Rows", "drawn", "guide", "legend", "name_letter", "plot", "three"]

Rows = Sequence[dict[str, Any]]

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
    "speed": (EXCESS, "1"),
    "modes": ("modes kept", "1"),
    "mass": ("tip mass / mass of the leaf", "1"),
    "stiffness": ("contact stiffness / tip stiffness", "1"),
    "damping": ("factor on the higher rates", "1"),
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
    for number, name in enumerate(drawn(rows, curve, series)):
        found = select(rows, curve, name)
        every = max(1, len(found) // 12)
        for axis, (quantity, scale) in zip(axes, PANELS, strict=True):
            plot(axis, found, quantity, number, scale, every)
    for axis, (quantity, unit) in zip(
        axes, (("restitution τ", "1"), ("delay", "ms"), ("kick", "1")), strict=True
    ):
        if log:
            axis.set_xscale("log")
        label(axis.xaxis, *QUANTITIES[curve])
        label(axis.yaxis, quantity, unit)
        axis.set_ylim(bottom=0.0)
    for place, axis in enumerate(axes):
        panel(axis, place)
    return figure, axes


def drawn(rows: Rows, curve: str, series: Sequence[str]) -> list[str]:
    """The series that are there."""
    return [name for name in series if select(rows, curve, name)]


def guide(axis: Axes, x: Sequence[float], y: Sequence[float], name: str, style: str = "--") -> None:
    axis.plot(x, y, color="0.45", linewidth=0.8, linestyle=style, zorder=1, label=name)


def legend(figure: Any, axes: Any, columns: int = 4, *, left: bool = False) -> None:
    """One legend below, every name once; the letter's restitution is the dotted line in the first panel."""
    found: dict[str, Any] = {}
    for axis in axes:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            found.setdefault(name, handle)
    figure.legend(
        list(found.values()), list(found), loc="outside lower center", ncols=columns, handlelength=3.0,
        columnspacing=1.5,
    )
    name_letter(axes[0], left)


def name_letter(axis: Axes, left: bool = False) -> None:
    """The restitution that the letter estimates."""
    mark_letter(axis.yaxis, RESTITUTION, words="letter, τ ≈ 0.1", along=0.02 if left else 0.99)
