"""Figure of Newton's law over the number of modes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure, series

__all__ = ["draw_newton"]


def draw_newton(arrays: Mapping[str, np.ndarray]) -> Any:
    """One impact with its limit; the whole collision; the number of impacts in it."""
    figure, (left, middle, right) = new_figure(1, 3, width=PAGE, height=0.076)
    count = arrays["count"]
    with house_style():
        for i, mass in enumerate(arrays["masses"]):
            name = "bare tip" if mass == 0.0 else f"tip mass {mass:g} of the beam"
            left.plot(count, arrays[f"kick_{mass:g}"], **series(i), markerfacecolor="none", label=name)
            if arrays["limit"][i] > 0.0:
                left.axhline(arrays["limit"][i], color=PALETTE[i], linewidth=0.7, linestyle=":")
            for j, e in enumerate(arrays["restitutions"]):
                key = f"{mass:g}_{e:g}"
                if f"whole_kick_{key}" not in arrays:
                    continue
                style = {"color": PALETTE[i], "marker": ("v", "o", "^")[j], "markerfacecolor": "none",
                         "linestyle": ("--", "-", ":")[j], "linewidth": 0.8}  # fmt: skip
                shown = f"e = {e:g}" if i == 0 else None
                middle.plot(count, arrays[f"whole_kick_{key}"], **style, label=shown)
                right.plot(count, arrays[f"whole_impacts_{key}"], **style)
        left.plot(count, 1.5 / count, color="0.5", linewidth=0.8, label="(1 + e)/N")
        for axis, name, title in (
            (left, "kick of one impact, e = 0.5", "(a) one impact"),
            (middle, "kick of the whole collision", "(b) whole collision"),
            (right, "impacts in one collision", "(c) impacts"),
        ):  # fmt: skip
            axis.set_xscale("log")
            label(axis.xaxis, "number of modes N")
            label(axis.yaxis, name)
            axis.set_title(title, loc="left")
        left.set_yscale("log")
        right.set_yscale("log")
        middle.set_ylim(0.0, 2.1)
        middle.legend(loc="upper right")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure
