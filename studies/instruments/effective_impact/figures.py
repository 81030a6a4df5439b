"""Figures of one approach to the plate: restitution, delay and kick side by side, against one quantity."""

from __future__ import annotations

import math
from typing import Any

from matplotlib.ticker import NullFormatter

from studies.instruments.effective_impact.approaches import select
from studies.instruments.effective_impact.panels import (
    QUANTITIES,
    Rows,
    drawn,
    guide,
    legend,
    name_letter,
    plot,
    three,
)
from studies.instruments.figures import NOTE, PAGE, PALETTE, in_house_style, label, new_figure, panel
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M

__all__ = ["draw_all"]


@in_house_style
def speed(rows: Rows) -> Any:
    figure, axes = three(rows, "speed", ("scene", "hertz", "bare tip"), log=True)
    found = select(rows, "speed", "hertz")
    x = [r["value"] for r in found]
    axes[1].set_yscale("log")
    axes[1].set_ylim(1e-2, 1e1)
    guide(
        axes[0], x, [math.sqrt(r["contact_s"] / r["arc_s"]) for r in found], "√(contact time · a/v), Hertz"
    )
    guide(axes[1], x, [1e3 * r["arc_s"] for r in found], "arc v/a", "-.")
    axes[0].set_ylim(0.0, 1.05)
    for axis in axes:
        axis.axvspan(x[0], AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M, color="0.92", zorder=-1, linewidth=0,
                     gid="letter, stability of the amplitude")
        axis.set_xlim(x[0], x[-1])
    axes[1].annotate("letter:\nstability\nof the\namplitude", (1.3e-5, 8.0), fontsize=NOTE, va="top")
    axes[2].set_ylim(0.0, 1.1)
    legend(figure, axes, 5, left=True)
    return figure


@in_house_style
def modes(rows: Rows) -> Any:
    names = (
        "scene",
        "hertz",
        "newton",
        "light tip, hertz",
        "bare cantilever, hertz",
        "bare cantilever, newton",
    )
    figure, axes = new_figure(2, 2, width=PAGE, height=0.105, sharex=True)
    for number, name in enumerate(drawn(rows, "modes", names)):
        found = select(rows, "modes", name)
        for axis, quantity, scale in zip(
            axes.flat, ("restitution", "delay_s", "kick", "impacts"), (1.0, 1e3, 1.0, 1.0), strict=True
        ):
            if found:
                plot(axis, found, quantity, number, scale, max(1, len(found) // 12))
    for axis, (quantity, unit) in zip(
        axes.flat,
        (("restitution τ", "1"), ("delay", "ms"), ("kick", "1"), ("impacts in the collision", "1")),
        strict=True,
    ):
        axis.set_xscale("log")
        axis.set_ylim(bottom=0.0)
        label(axis.yaxis, quantity, unit)
    axes[1, 1].set_yscale("log")
    axes[1, 1].set_ylim(0.8, 200)
    for axis in axes[1]:
        axis.set_xticks([1, 2, 5, 10, 20, 40, 60], ["1", "2", "5", "10", "20", "40", "60"])
        axis.xaxis.set_minor_formatter(NullFormatter())
        label(axis.xaxis, *QUANTITIES["modes"])
    for place, axis in enumerate(axes.flat):
        panel(axis, place)
    legend(figure, list(axes.flat), 3)
    return figure


@in_house_style
def mass(rows: Rows) -> Any:
    names = list(dict.fromkeys(r["series"] for r in rows if r["curve"] == "mass"))
    chosen = [n for n in names if n in ("excess 0.0001", "excess 0.001", "excess 0.013", "excess 0.05")]
    figure, axes = three(rows, "mass", chosen, log=False)
    found = select(rows, "mass", chosen[-1])
    guide(axes[2], [r["value"] for r in found], [r["ball_limit"] for r in found], "2 M φ$_1^2$")
    middle = select(rows, "mass", "excess 0.013")
    guide(
        axes[1],
        [r["value"] for r in middle],
        [1e3 * r["arc_s"] for r in middle],
        "arc v/a, excess 0.013",
        "-.",
    )
    orbits = [r for r in select(rows, "orbit") if r["impacts"] and not r["forced_by_ringing"]]
    axes[0].plot(
        [r["value"] for r in orbits],
        [r["restitution"] if r["returns"] else 0.0 for r in orbits],
        linestyle="none",
        marker="x",
        markersize=3.5,
        color=PALETTE[4],
        label="settled orbit, 21.50 Hz, excess 0.013 (0: no return)",
        clip_on=False,
    )
    for axis in axes:
        axis.set_xlim(0.0, 1.03)
    axes[0].set_ylim(0.0, 1.0)
    axes[2].set_ylim(0.0, 1.7)
    legend(figure, axes, 4)
    return figure


@in_house_style
def stiffness(rows: Rows) -> Any:
    names = list(dict.fromkeys(r["series"] for r in rows if r["curve"] == "stiffness"))
    figure, axes = three(rows, "stiffness", names, log=True)
    balls = [r for r in rows if r["curve"] == "materials" and not r["failure"]]
    marks = ("*", "P", "X", "d")
    for ball, mark in zip(balls, marks, strict=False):
        for axis, quantity, scale in zip(
            axes, ("restitution", "delay_s", "kick"), (1.0, 1e3, 1.0), strict=True
        ):
            axis.plot(
                [ball["value"]], [scale * ball[quantity]], marker=mark, markersize=5, linestyle="none",
                color=PALETTE[5], markeredgecolor="black", markeredgewidth=0.4, zorder=5,
                label=f"Hertz, {ball['series']}",
            )
    found = select(rows, "stiffness", names[0])
    guide(axes[1], [r["value"] for r in found], [1e3 * r["arc_s"] for r in found], "arc v/a", "-.")
    guide(axes[2], [r["value"] for r in found], [r["ball_limit"] for r in found], "2 M φ$_1^2$, scene")
    axes[0].set_ylim(0.0, 1.0)
    legend(figure, axes, 3)
    return figure


@in_house_style
def damping(rows: Rows) -> Any:
    names = list(dict.fromkeys(r["series"] for r in rows if r["curve"] == "damping"))
    figure, axes = three(rows, "damping", names, log=True)
    legend(figure, axes, 3)
    return figure


@in_house_style
def loss(rows: Rows) -> Any:
    names = list(dict.fromkeys(r["series"] for r in rows if r["curve"] == "loss"))
    figure, axes = three(rows, "loss", names, log=False)
    legend(figure, axes, 4, left=True)
    return figure


@in_house_style
def search(rows: Rows) -> Any:
    """Restitution over tip mass: with loss in the contact, and with other hardness."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.075, sharey=True)
    parts = (
        ("search", "local restitution ", "1", "0.7", "0.4", "0.2", "0.1"),
        ("hardness", "stiffness × ", *("1", "3", "10", "30", "100", "300")),
    )
    for axis, (curve, words, *wanted) in zip(axes, parts, strict=True):
        known = {r["series"] for r in rows if r["curve"] == curve}
        for number, name in enumerate([n for n in wanted if n in known]):
            found = [r for r in select(rows, curve, name) if r["value"] > 0.0]
            plot(axis, found, "restitution", number, 1.0, 2)
            axis.get_lines()[-1].set_label(words + name)
        name_letter(axis)
        axis.set_xscale("log")
        axis.set_ylim(0.0, 1.12)
        axis.set_xticks([0.02, 0.05, 0.1, 0.2, 0.5, 1, 2], ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"])
        axis.xaxis.set_minor_formatter(NullFormatter())
        label(axis.xaxis, *QUANTITIES["search"])
        axis.legend(loc="upper left", bbox_to_anchor=(0.0, 1.02), ncols=2, handlelength=3.0)
    label(axes[0].yaxis, "restitution τ", "1")
    panel(axes[0], 0, "loss in the contact (Hunt-Crossley)")
    panel(axes[1], 1, "hardness (linear, times that of the ball)")
    return figure


DRAWN = {
    "speed": speed,
    "mass": mass,
    "search": search,
    "modes": modes,
    "stiffness": stiffness,
    "damping": damping,
    "loss": loss,
}
QUICK = 3
"""So many of them, the first ones, are drawn for a first look."""


@in_house_style
def draw_all(rows: Rows, *, quick: bool) -> dict[str, Any]:
    """All figures by name, or those of a first look."""
    return {name: DRAWN[name](rows) for name in list(DRAWN)[: QUICK if quick else len(DRAWN)]}
