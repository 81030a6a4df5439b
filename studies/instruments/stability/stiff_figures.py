"""Figure of stiff contacts: error, cost and kick over the stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from contact.integrators import Exact
from studies.instruments.figures import (
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
    points,
    series,
)

__all__ = ["draw_stiff"]


@in_house_style
def draw_stiff(arrays: Mapping[str, np.ndarray]) -> Any:
    """Error with the law of its growth, steps per collision, and the kick with Newton's limit."""
    figure, (left, middle, right) = new_figure(1, 3, width=PAGE, height=0.072)
    stiffness = arrays["stiffness"]
    for i, n in enumerate(int(n) for n in arrays["counts"]):
        name = f"{n} mode{'s' if n > 1 else ''}"
        left.plot(stiffness, arrays[f"error_{n}"], **points(i), markerfacecolor="none", label=name)
        middle.plot(stiffness, arrays[f"cost_{n}"], **series(i), markerfacecolor="none", gid=name)
        left.plot(stiffness, arrays[f"lost_{n}"], color=PALETTE[i], linewidth=0.8, linestyle="--",
                  gid=f"{name}, ω$_c$ ε gap / v", label="ω$_c$ ε gap / v" if i == 0 else None)
        kick = arrays[f"kick_{n}"]
        right.plot(arrays["kick_stiffness"], kick, **{**series(i), "marker": ""}, gid=name)
        right.axhline(float(arrays[f"newton_{n}"][0]), color=PALETTE[i], linewidth=0.6, linestyle="--",
                      gid=f"{name}, Newton's law", label="Newton's law, 2 r$_N$" if i == 0 else None)
    left.axhline(Exact.accuracy, color="0.4", linewidth=0.8, linestyle=":",
                 label="stated accuracy")
    left.set_ylim(1e-16, 1e-9)
    for number, (axis, name, title) in enumerate((
        (left, "error of the state", "error"), (middle, "steps and flights", "cost"),
        (right, "kick of mode 1", "limit of Newton's law"),
    )):  # fmt: skip
        axis.set_xscale("log")
        label(axis.xaxis, "k / k$_{modal}$")
        label(axis.yaxis, name)
        panel(axis, number, title)
    left.set_yscale("log")
    middle.set_yscale("log")
    right.set_ylim(0.0, 2.1)
    right.legend(loc="center", bbox_to_anchor=(0.6, 0.75))
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure
