"""Time per drive period against the number of modes, with the floor and the outside solver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from studies.instruments.figures import COLUMN, in_house_style, label, new_figure, series

__all__ = ["draw_costs"]

DRAWN = (
    ("beam, hertz contact", "grazing-spring", "Hertz contact"),
    ("beam, linear contact", "grazing-spring", "linear contact"),
    ("beam, hertz contact, no touch", "grazing-spring", "no touch"),
    ("beam, hertz contact", "floor", "floor: carrying the modes"),
    ("beam, hertz contact", "heyoka", "heyoka, Hertz contact"),
)


@in_house_style
def draw_costs(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """The figure."""
    figure, ax = new_figure(width=COLUMN, height=0.075)
    for number, (case, tool, words) in enumerate(DRAWN):
        mine = sorted(
            (row["modes"], row["us_per_period"])
            for row in rows
            if row["case"] == case and row["tool"] == tool
        )
        if mine:
            modes, cost = zip(*mine, strict=True)
            ax.plot(modes, cost, **series(number), label=words)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ticks = sorted({row["modes"] for row in rows})
    ax.set_xticks(ticks, [str(tick) for tick in ticks])
    ax.minorticks_off()
    label(ax.xaxis, "number of modes")
    label(ax.yaxis, "time per drive period", "µs")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
