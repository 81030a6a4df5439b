"""Error against predicted cost for every model that was tried, the chosen one marked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FixedLocator, NullLocator

from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure

__all__ = ["columns_of", "draw_ladder"]

MARKERS = {"single_mode": "*", "straight": "s", "folded_u": "o", "modal_data": "D"}
NAMES = {
    "single_mode": "Eq. (1)",
    "straight": "straight leg",
    "folded_u": "folded U",
    "modal_data": "measured modes",
}
COLOURS = {"newton": PALETTE[5], "linear": PALETTE[1], "hertz": PALETTE[2]}
COSTS = (2, 3, 5, 10, 20, 30)
LEAST = 1e-7
"""Errors below this, exact agreement among them, are drawn here."""


def columns_of(tried: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """The models tried as columns of a table."""
    return {name: [row[name] for row in tried] for name in tried[0]} if tried else {}


def draw_ladder(rows: Sequence[Mapping[str, Any]], tried: Sequence[Mapping[str, Any]]) -> Figure:
    """A panel for each row of the study, of the frequencies and born periods the two hardest.

    `tried` as in `columns_of`.
    """
    rows = [*_hardest(rows, "frequency"), *_hardest(rows, "born_period"), *_others(rows)]
    across = 3
    down = math.ceil(len(rows) / across)
    with house_style():
        figure, axes = new_figure(down, across, width=PAGE, height=0.052 * down + 0.012, squeeze=False)
        for ax, row in zip(axes.flat, rows, strict=False):
            mine = [
                one for one in tried
                if one["quantity"] == row["quantity"] and one["frequency_hz"] == row["frequency_hz"]
            ]  # fmt: skip
            least = 0.0 if row["quantity"] == "born_period" else LEAST
            for one in mine:
                if not math.isfinite(one["error"]):
                    continue
                ax.plot(
                    one["cost"], max(one["error"], least), MARKERS[one["rung"]], color=COLOURS[one["law"]],
                    mfc="none" if one["residual"] else COLOURS[one["law"]], ms=3.5, mew=0.7, alpha=0.8,
                )  # fmt: skip
                if one["chosen"]:
                    ax.plot(one["cost"], max(one["error"], least), "o", ms=9, mfc="none", mec="black")
            if row["tolerance"] > 0:
                ax.axhline(row["tolerance"], color="black", lw=0.7, ls="--")
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
            ax.set_title(f"{row['quantity']}, {row['frequency_hz']:.2f} Hz".replace("_", " "))
            label(ax.xaxis, "predicted cost per drive period", "us")
            label(ax.yaxis, "error", row["unit"])
        for ax in axes.flat[len(rows) :]:
            ax.set_axis_off()
        handles = [
            Line2D([], [], ls="", marker=MARKERS[rung], color="0.4", label=NAMES[rung])
            for rung in NAMES if any(one["rung"] == rung for one in tried)
        ]  # fmt: skip
        handles += [
            Line2D([], [], ls="", marker="o", color=COLOURS[law], label=f"{law} contact") for law in COLOURS
        ]
        handles += [
            Line2D([], [], ls="", marker="o", mfc="none", color="0.4", label="residual mode"),
            Line2D([], [], ls="", marker="o", ms=9, mfc="none", color="black", label="chosen"),
            Line2D([], [], ls="--", color="black", lw=0.7, label="tolerance"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=5)
    return figure


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
