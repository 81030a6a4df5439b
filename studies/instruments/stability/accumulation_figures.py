"""Figure of accumulating impacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

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

__all__ = ["draw_accumulation"]

SHOWN = 0.7
"""Restitution of the events shown one by one."""


@in_house_style
def draw_accumulation(arrays: Mapping[str, np.ndarray], rest_time: Callable[[float], float]) -> Any:
    """Time of rest and number of impacts over 1 - e; time left to the accumulation over the events."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.072)
    lost = 1.0 - arrays["restitution"]
    fine = np.geomspace(lost.min(), lost.max(), 100)
    left.plot(fine, [rest_time(1.0 - x) for x in fine], color=PALETTE[1], linestyle="-",
              label="time of rest, theory (s)")
    left.plot(lost, arrays["rest"], **points(1), markerfacecolor="none",
              label="time of rest, measured (s)")
    left.plot(lost, arrays["count"], **points(2), markerfacecolor="none", label="impacts computed")
    error = np.abs(arrays["rest"] / [rest_time(1.0 - x) for x in lost] - 1.0)
    left.plot(lost, np.maximum(error, 1e-17), **points(0), markerfacecolor="none",
              label="relative error of the time of rest")
    left.set_xscale("log")
    left.set_yscale("log")
    label(left.xaxis, "1 − e")
    label(left.yaxis, "time of rest (s); number; relative error")
    panel(left, 0, "the default: hops summed")
    left.legend(loc="center right", bbox_to_anchor=(1.0, 0.47))
    for i, (key, name) in enumerate((
        (f"left_closed_{SHOWN:g}", "closed form, no sum"),
        (f"left_ivp_1e-12_{SHOWN:g}", "solve_ivp restarted, tolerance 1e-12"),
        (f"left_ivp_1e-06_{SHOWN:g}", "solve_ivp restarted, tolerance 1e-6"),
    )):  # fmt: skip
        values = np.abs(arrays[key])
        n = np.arange(1, values.size + 1)
        style = {**series(i), "linewidth": 0.6}
        right.plot(n, np.maximum(values, 1e-16), **style, markevery=(i, 5), markerfacecolor="none",
                   label=name)
        right.plot(n[-1:], np.maximum(values[-1:], 1e-16), marker="Xdv"[i], markersize=8, color=PALETTE[i],
                   linestyle="none", gid=f"{name}: last event",
                   label="large: last event before it fails" if i == 0 else None)
    right.set_yscale("log")
    label(right.xaxis, "number of the event")
    label(right.yaxis, "time left to the accumulation", "s")
    panel(right, 1, f"loops without a sum, e = {SHOWN:g}")
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower right", ncols=2)
    return figure
