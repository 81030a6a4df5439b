"""Error against predicted cost for every model that was tried, the chosen one marked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from studies.instruments.figures import (
    BLUE,
    ORANGE,
    PAGE,
    VERMILION,
    in_house_style,
    label,
    new_figure,
    panel,
)

__all__ = ["columns_of", "draw_ladder"]

NAMES = {
    "single_mode": "Eq. (1)",
    "straight": "straight leg",
    "folded_u": "folded U",
    "modal_data": "measured modes",
}
LAWS = {"newton": ("^", ORANGE), "linear": ("s", BLUE), "hertz": ("o", VERMILION)}
"""Marker and colour of a contact law; the fill tells the rung."""
FILLS = {"single_mode": "bottom", "straight": "none", "folded_u": "full", "modal_data": "left"}
COSTS = (2, 3, 5, 10, 20, 30)
LEAST = 1e-7
"""Errors below this, exact agreement among them, are drawn here."""


def columns_of(tried: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """The models tried as columns of a table."""
    return {name: [row[name] for row in tried] for name in tried[0]} if tried else {}


@in_house_style
def draw_ladder(rows: Sequence[Mapping[str, Any]], tried: Sequence[Mapping[str, Any]]) -> Figure:
    """A panel for each row of the study, of the frequencies and born periods the two hardest.

    `tried` as in `columns_of`.
    """
    rows = [*_hardest(rows, "frequency"), *_hardest(rows, "born_period"), *_others(rows)]
    across = 3
    down = math.ceil(len(rows) / across)
    figure, axes = new_figure(down, across, width=PAGE, height=0.052 * down + 0.012, squeeze=False)
    for number, (ax, row) in enumerate(zip(axes.flat, rows, strict=False)):
        mine = [
            one for one in tried
            if one["quantity"] == row["quantity"] and one["frequency_hz"] == row["frequency_hz"]
        ]  # fmt: skip
        least = 0.0 if row["quantity"] == "born_period" else LEAST
        for (rung, law, residual), of in _groups(mine).items():
            name = f"{NAMES[rung]}, {law}" + (", residual mode" if residual else "")
            cost, error = [one["cost"] for one in of], [max(one["error"], least) for one in of]
            ax.plot(cost, error, **_look(rung, law), gid=name)
            if residual:
                ax.plot(cost, error, **RESIDUAL, gid=f"{name}, marked")
        chosen = [one for one in mine if one["chosen"] and math.isfinite(one["error"])]
        ax.plot([one["cost"] for one in chosen], [max(one["error"], least) for one in chosen], **CHOSEN,
                gid="chosen")
        if row["tolerance"] > 0:
            ax.axhline(row["tolerance"], color="black", lw=0.7, ls="--", gid="tolerance")
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(FixedLocator(COSTS))
        ax.xaxis.set_minor_locator(NullLocator())
        ax.xaxis.set_major_formatter(FixedFormatter([f"{cost:g}" for cost in COSTS]))
        counted = row["quantity"] == "born_period"
        if counted:
            ax.set_ylim(-0.2, 3.4)
        else:
            ax.set_yscale("log")
            ax.set_ylim(bottom=LEAST / 2)
        panel(ax, number, f"{row['quantity']}, {row['frequency_hz']:.2f} Hz".replace("_", " "))
        if number >= len(rows) - across:
            label(ax.xaxis, "predicted cost of a period", "µs")
        label(ax.yaxis, "error", row["unit"])
    for ax in axes.flat[len(rows) :]:
        ax.set_visible(False)
    handles = [
        Line2D([], [], **{**_look(rung, "linear"), "color": "0.35", "markerfacecoloralt": "white"},
               label=NAMES[rung])
        for rung in NAMES if any(one["rung"] == rung for one in tried)
    ]  # fmt: skip
    handles += [Line2D([], [], **_look("folded_u", law), label=f"{law.capitalize()} contact") for law in LAWS]
    handles += [
        Line2D([], [], **{**RESIDUAL, "markersize": 5.0}, label="with a residual mode"),
        Line2D([], [], **CHOSEN, label="chosen"),
        Line2D([], [], ls="--", color="black", lw=0.7, label="tolerance"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=5)
    return figure


RESIDUAL: dict[str, Any] = {"linestyle": "none", "marker": "+", "color": "black", "markersize": 3.6,
                            "markeredgewidth": 0.6}  # fmt: skip
CHOSEN: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 9.0, "markerfacecolor": "none",
                          "color": "black"}  # fmt: skip


def _look(rung: str, law: str) -> dict[str, Any]:
    marker, colour = LAWS[law]
    return {"linestyle": "none", "marker": marker, "color": colour, "fillstyle": FILLS[rung],
            "markersize": 3.8, "markeredgewidth": 0.7, "markerfacecoloralt": "white"}  # fmt: skip


def _groups(tried: Sequence[Mapping[str, Any]]) -> dict[tuple[str, str, bool], list[Mapping[str, Any]]]:
    """The models with a finite error, by rung, law and residual mode."""
    found: dict[tuple[str, str, bool], list[Mapping[str, Any]]] = {}
    for one in tried:
        if math.isfinite(one["error"]):
            found.setdefault((one["rung"], one["law"], bool(one["residual"])), []).append(one)
    return found


def _hardest(rows: Sequence[Mapping[str, Any]], name: str) -> list[Mapping[str, Any]]:
    """The two rows of a quantity that need most."""
    mine = [row for row in rows if row["quantity"].startswith(name)]
    return sorted(mine, key=lambda row: row["predicted_us_per_period"])[-2:]


def _others(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return [row for row in rows if not row["quantity"].startswith(("frequency", "born_period"))]


def as_points(asked: Any, tried: Mapping[Any, float], chosen: Any) -> list[dict[str, Any]]:
    """The models tried for one question, with cost and error."""
    return [
        {
            "quantity": asked.quantity, "frequency_hz": asked.frequency, "rung": choice.rung,
            "law": choice.law, "modes": choice.modes, "mesh": choice.mesh, "residual": choice.residual,
            "cost": choice.cost(), "error": float(np.float64(error)), "chosen": choice == chosen,
        }
        for choice, error in tried.items()
    ]  # fmt: skip
