"""Figure of long runs."""

from __future__ import annotations

from collections.abc import Mapping
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

__all__ = ["draw_long"]

FLOOR = 1e-17


@in_house_style
def draw_long(arrays: Mapping[str, np.ndarray]) -> Any:
    """Phase error and growth per radian of the methods with a step; error of the default over the periods."""
    figure, (left, middle, right) = new_figure(1, 3, width=PAGE, height=0.084)
    names = [key.removeprefix("phase_theory_") for key in arrays if key.startswith("phase_theory_")]
    step = arrays["drift_step"]
    for i, name in enumerate(names):
        for axis, part in ((left, "phase"), (middle, "growth")):
            theory = np.abs(arrays[f"{part}_theory_{name}"])
            if theory.max() > 1e-13:
                axis.plot(step, theory, color=PALETTE[i], linewidth=0.8, linestyle=series(i)["linestyle"],
                          gid=f"{name}, theory")
            axis.plot(step, np.maximum(np.abs(arrays[f"{part}_{name}"]), FLOOR), **points(i),
                      markerfacecolor="none", gid=name, label=name if axis is left else None)
    for number, (axis, name, title) in enumerate((
        (left, "phase error per radian", "phase, lines: theory"),
        (middle, "growth or decay per radian", "amplitude, lines: theory"),
    )):  # fmt: skip
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylim(FLOOR / 2.0, 1.0)
        axis.set_xticks(step, [f"{x:g}" for x in step])
        axis.minorticks_off()
        label(axis.xaxis, "h ω")
        label(axis.yaxis, name)
        panel(axis, number, title)
    count = arrays["flight_periods"]
    right.plot(count, np.maximum(arrays["flight_phase"], FLOOR), **series(0), markerfacecolor="none",
               label="phase")
    right.plot(count, np.maximum(arrays["flight_energy"], FLOOR), **series(1), markerfacecolor="none",
               label="energy, relative")
    right.plot(count, 2.0**-52 * count, color="0.5", linewidth=0.8, label="ε per period")
    right.set_xscale("log")
    right.set_yscale("log")
    label(right.xaxis, "number of drive periods")
    label(right.yaxis, "phase error (rad); energy error")
    panel(right, 2, "undamped flight")
    right.legend(loc="upper left")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
