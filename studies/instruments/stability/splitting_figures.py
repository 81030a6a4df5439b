"""Figures of the limits of splitting: the plane of step and contact stiffness, and its resonances."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from studies.instruments.figures import PAGE, PALETTE, in_house_style, label, new_figure, panel, points

__all__ = ["draw_planes", "draw_tongues"]

SEEN = np.log(1e5) / 3000
"""Growth per step that a march of 3000 steps shows."""


@in_house_style
def draw_planes(arrays: Mapping[str, np.ndarray]) -> Any:
    """Where the pressed contact is unstable, by theory (shaded, line) and in the motion (points)."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.086, sharey=True)
    for axis, order in zip(axes, (2, 4), strict=True):
        get = {
            name: arrays[f"order_{order}_{name}"]
            for name in ("step", "stiffness", "rate", "fine_step", "fine_stiffness", "theory", "limit")
        }
        level = (get["theory"] > 1e-6).astype(float) + (get["theory"] > SEEN)
        axis.pcolormesh(
            get["fine_stiffness"], get["fine_step"], level,
            cmap=ListedColormap(["white", "0.55", "0.86"]), vmin=0.0, vmax=2.0,
            shading="nearest", rasterized=True, zorder=0, gid="0: bounded; 1: grows slowly; 2: grows",
        )  # fmt: skip
        grows = get["rate"] > SEEN
        k, h = np.meshgrid(get["stiffness"], get["step"])
        bounded = axis.plot(k[~grows], h[~grows], linestyle="none", marker=".", markersize=2.5,
                            color=PALETTE[1], label="motion: bounded")  # fmt: skip
        growing = axis.plot(k[grows], h[grows], linestyle="none", marker="x", markersize=2.8,
                            markeredgewidth=0.6, color=PALETTE[2],
                            label="motion: grows or opens")  # fmt: skip
        inside = get["limit"] <= get["fine_stiffness"][-1]
        line = axis.plot(get["limit"][inside], get["fine_step"][inside], color="black", linewidth=1.1,
                         label="limit by which a step is refused")  # fmt: skip
        pi = axis.axhline(np.pi, color="black", linewidth=0.6, linestyle=":", label="h ω$_N$ = π")
        axis.set_xscale("log")
        axis.set_xlim(get["fine_stiffness"][0], get["fine_stiffness"][-1])
        axis.set_ylim(0.0, 7.05)
        label(axis.xaxis, "contact stiffness / modal stiffness")
        panel(axis, (2, 4).index(order), f"order {order}")
    label(axes[0].yaxis, "h ω$_N$, step × highest free frequency")
    shades = [
        Patch(color="0.86", label="spectral radius: grows by > 0.4 % a step"),
        Patch(color="0.55", label="spectral radius: grows more slowly"),
    ]
    handles = [*bounded, *growing, *line, pi, *shades]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


@in_house_style
def draw_tongues(arrays: Mapping[str, np.ndarray]) -> Any:
    """Growth per step of order 2 along one contact stiffness, without and with damping."""
    figure, axes = new_figure(2, 1, width=PAGE, height=0.100, sharex=True)
    for number, (axis, name, title) in enumerate(zip(
        axes, ("undamped", "damped"), ("without damping", "with the damping of the spring"), strict=True,
    )):  # fmt: skip
        axis.plot(arrays["tongue_fine"], np.maximum(arrays[f"tongue_{name}_theory"], 1e-5), color="black",
                  linewidth=0.9, label="ln spectral radius of a step")  # fmt: skip
        rate = arrays[f"tongue_{name}_rate"]
        shown = np.isfinite(rate) & (rate > np.log(1e5) / 20_000)
        axis.plot(arrays["tongue_step"][shown], rate[shown], **points(2), markerfacecolor="none",
                  label="motion: growth per step")  # fmt: skip
        still = ~shown & np.isfinite(rate)
        axis.plot(arrays["tongue_step"][still], np.full(still.sum(), 2e-4), linestyle="none", marker=".",
                  markersize=2.5, color=PALETTE[1], label="motion: bounded")  # fmt: skip
        axis.axvline(np.pi, color="black", linewidth=0.6, linestyle=":", label="h ω$_N$ = π")
        axis.set_yscale("log")
        axis.set_ylim(1e-4, 5.0)
        panel(axis, number, title)
        label(axis.yaxis, "growth per step")
    label(axes[1].xaxis, "h ω$_N$, step × highest free frequency")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
