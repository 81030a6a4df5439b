"""Figure of Newton's law over the number of modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from studies.instruments.figures import (
    MARKERS,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
    series,
)

__all__ = ["draw_newton"]


@in_house_style
def draw_newton(arrays: Mapping[str, np.ndarray]) -> Any:
    """One impact with its limit; the whole collision; the number of impacts in it."""
    figure, (left, middle, right) = new_figure(1, 3, width=PAGE, height=0.076)
    count = arrays["count"]
    for i, mass in enumerate(arrays["masses"]):
        name = "bare tip" if mass == 0.0 else f"tip mass {mass:g} of the beam"
        left.plot(count, arrays[f"kick_{mass:g}"], **series(i), markerfacecolor="none", label=name)
        if arrays["limit"][i] > 0.0:
            left.axhline(arrays["limit"][i], color=PALETTE[i], linewidth=0.7, linestyle=":",
                         gid=f"{name}, limit")
        for j, e in enumerate(arrays["restitutions"]):
            key = f"{mass:g}_{e:g}"
            if f"whole_kick_{key}" not in arrays:
                continue
            style = {"color": PALETTE[i], "marker": MARKERS[i], "markerfacecolor": "none" if j % 2 else None,
                     "linestyle": ("--", "-", ":")[j], "linewidth": 0.8}  # fmt: skip
            shown = f"e = {e:g}" if i == 0 else None
            middle.plot(count, arrays[f"whole_kick_{key}"], **style, label=shown, gid=f"{name}, e = {e:g}")
            right.plot(count, arrays[f"whole_impacts_{key}"], **style, gid=f"{name}, e = {e:g}")
    left.plot(count, 1.5 / count, color="0.5", linewidth=0.8, label="(1 + e)/N")
    for number, (axis, name, title) in enumerate((
        (left, "kick of one impact, e = 0.5", "one impact"),
        (middle, "kick of the whole collision", "whole collision"),
        (right, "impacts in one collision", "impacts"),
    )):  # fmt: skip
        axis.set_xscale("log")
        label(axis.xaxis, "number of modes N")
        label(axis.yaxis, name)
        panel(axis, number, title)
    left.set_yscale("log")
    right.set_yscale("log")
    middle.set_ylim(0.0, 2.1)
    middle.legend(loc="upper right")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure
