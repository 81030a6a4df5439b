"""Figure of odd modes: three ways to the flow of a mode, and collisions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from contact.integrators import Exact
from studies.instruments.figures import NOTE, PAGE, PALETTE, in_house_style, label, new_figure, panel, series

__all__ = ["draw_odd"]

FLOOR = 1e-17
EPS = 2.0**-52
NAMES = {"package": "closed form of the package", "eig": "through eigenvectors", "expm": "scipy.linalg.expm"}


@in_house_style
def draw_odd(arrays: Mapping[str, np.ndarray]) -> Any:
    """Errors over the distance from critical damping, over the damping ratio, and of collisions by name."""
    figure, (left, middle, right) = new_figure(1, 3, width=PAGE, height=0.078, width_ratios=[1.0, 1.0, 0.9])
    distance = np.maximum(arrays["distance"], FLOOR)
    for i, (key, name) in enumerate(NAMES.items()):
        style = {**series(i), "markerfacecolor": "none"}
        near = np.maximum(arrays[f"near_{key}"], FLOOR)
        left.plot(distance, near, **style, label=name)
        middle.plot(arrays["ratio"], np.maximum(arrays[f"ratio_{key}"], FLOOR), **style, gid=name)
    fine = np.geomspace(1e-16, 1e-2, 50)
    left.plot(fine, EPS * np.sqrt(2.0 / fine), color="0.5", linewidth=0.8, label="ε (2/δ)$^{1/2}$")
    for number, (axis, name, title) in enumerate((
        (left, "ζ − 1 = δ (far left: 0)", "flow near critical damping"),
        (middle, "damping ratio ζ", "flow over the damping"),
    )):  # fmt: skip
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylim(FLOOR / 2.0, 1e-6)
        label(axis.xaxis, name)
        label(axis.yaxis, "largest relative error")
        panel(axis, number, title)
    left.set_xticks([1e-16, 1e-12, 1e-8, 1e-4])
    place = np.arange(arrays["collision"].size)[::-1]
    right.plot(np.maximum(arrays["collision_error"], FLOOR), place, linestyle="none", marker="o",
               color=PALETTE[0], gid="collisions")
    right.axvline(Exact.accuracy, color="0.4", linestyle=":", linewidth=0.8, gid="stated accuracy")
    right.annotate("stated", (Exact.accuracy, 0.0), xytext=(-2, 0), textcoords="offset points",
                   ha="right", fontsize=NOTE)
    right.set_yticks(place, list(arrays["collision"]), fontsize=NOTE)
    right.set_xscale("log")
    right.set_xlim(FLOOR, 1e-9)
    label(right.xaxis, "error of a collision")
    panel(right, 2, "collisions")
    label(right.yaxis, "case")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
