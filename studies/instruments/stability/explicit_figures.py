"""Figures of the limits of central difference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from studies.instruments.figures import PAGE, PALETTE, in_house_style, label, new_figure, panel, points

__all__ = ["draw_contacts", "draw_limits"]

SLOW = 1e-3
"""Growth per step that counts as growth in the plane: e^2 in its 2000 steps."""


@in_house_style
def draw_limits(arrays: Mapping[str, np.ndarray]) -> Any:
    """Limit over the damping ratio, and the plane of step and contact stiffness."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.070, width_ratios=[1.0, 1.25])
    ratio = np.linspace(0.0, max(3.0, float(arrays["ratio"].max())), 200)
    left.plot(ratio, 2.0 + 0.0 * ratio, color=PALETTE[1], linestyle="--", label="centred, theory")
    left.plot(arrays["ratio"], arrays["centred"], **points(1), markerfacecolor="none",
              label="centred, bisected")
    left.plot(ratio, 2.0 * (np.sqrt(1.0 + ratio**2) - ratio), color=PALETTE[2], label="lagged, theory")
    left.plot(arrays["ratio"], arrays["lagged"], **points(2), markerfacecolor="none",
              label="lagged, bisected")
    label(left.xaxis, "damping ratio ζ of the mode")
    label(left.yaxis, "largest stable step h ω")
    left.set_ylim(0.0, 2.6)
    left.legend(loc="center right")
    panel(left, 0, "one mode in flight")
    grows = arrays["plane_rate"] > SLOW
    k, h = np.meshgrid(arrays["plane_stiffness"], arrays["plane_step"])
    right.plot(k[~grows], h[~grows], linestyle="none", marker=".", markersize=2.5, color=PALETTE[1],
               label="measured: bounded")
    right.plot(k[grows], h[grows], linestyle="none", marker="x", markersize=2.5, markeredgewidth=0.6,
               color=PALETTE[2], label="measured: grows or opens")
    right.plot(arrays["limit_stiffness"], arrays["limit_step"], color="black", linewidth=1.4,
               label="theory, h ω$_{max}$ = 2")
    right.set_xscale("log")
    label(right.xaxis, "contact stiffness / modal stiffness")
    label(right.yaxis, "step × highest free frequency")
    panel(right, 1, "five modes pressed on the stop")
    figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@in_house_style
def draw_contacts(arrays: Mapping[str, np.ndarray]) -> Any:
    """Energy that one short contact makes or loses, over the phases of the grid."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.066, sharey=True)
    x = arrays["frequency_step"]
    fine = np.linspace(x[0], 1.985, 300)
    for number, (axis, name, title) in enumerate(zip(
        axes, ("linear", "hertz"), ("linear contact", "Hertz contact of the same duration"), strict=True,
    )):  # fmt: skip
        axis.plot(x, arrays[f"{name}_highest"], **points(2), markerfacecolor="none",
                  label="largest gain over the phase of the grid")
        axis.plot(x, -arrays[f"{name}_lowest"], **points(1), markerfacecolor="none",
                  label="largest loss")
        if name == "linear":
            axis.plot(fine, 1.0 / (1.0 - 0.25 * fine**2) - 1.0, color=PALETTE[2], linestyle="-",
                      label="bound of the gain, 1/(1 - (h ω$_c$/2)$^2$) - 1")
            axis.plot(fine, 0.25 * fine**2, color=PALETTE[1], linestyle="--",
                      label="bound of the loss, (h ω$_c$/2)$^2$")
        for i, place in enumerate(arrays["commensurate"] if name == "linear" else ()):
            axis.axvline(place, color="0.6", linewidth=0.5, linestyle=":", zorder=0,
                         gid="contact of a whole number of steps",
                         label="contact of a whole number of steps" if i == 0 else None)
        axis.set_yscale("log")
        axis.set_ylim(1e-4, 1e2)
        label(axis.xaxis, "h ω$_c$, with ω$_c$ = π / contact time")
        panel(axis, number, title)
    label(axes[0].yaxis, "relative change of energy")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure
