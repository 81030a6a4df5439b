"""Restitution, delay and kick side by side against one quantity."""

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from studies import letter
from studies.experiment.effective_impact.model import Approach, on_orbits, select, series_of
from studies.shell import plotting
from studies.shell.plotting import PAGE, PALETTE

AXES = {
    "restitution": ("restitution", "restitution τ", "1", 1.0),
    "delay_s": ("time delay", "delay", "ms", 1e3),
    "kick": ("kick", "kick / approach velocity", "1", 1.0),
}
"""Column of the rows -> title, quantity, unit, factor to that unit."""

MASS = "tip mass / leaf mass"


def line(axis: Any, rows: Sequence[Approach], column: str, number: int, name: str) -> None:
    """One series."""
    axis.plot(
        [row.value for row in rows],
        [AXES[column][3] * getattr(row, column) for row in rows],
        **plotting.series(number),
        markevery=max(1, len(rows) // 12),
        markersize=2.8,
        markerfacecolor="white",
        markeredgewidth=0.7,
        label=name,
    )


def panels(rows: Sequence[Approach], curve: str, quantity: str, arc_of: str) -> tuple[Figure, list[Any]]:
    """The series of a curve, a panel for each quantity; beside the delay the arc v/a of one series."""
    figure, axes = plotting.new_figure(1, len(AXES), width=PAGE, height=0.066)
    figure.set_layout_engine("constrained", wspace=0.06)
    for place, (axis, (column, (title, words, unit, _))) in enumerate(zip(axes, AXES.items(), strict=True)):
        for number, name in enumerate(series_of(rows, curve)):
            line(axis, select(rows, curve, name), column, number, name)
        plotting.label(axis.xaxis, quantity)
        plotting.label(axis.yaxis, words, unit)
        axis.set_ylim(bottom=0.0)
        plotting.panel(axis, place, title)
    chosen = select(rows, curve, arc_of)
    arc = [1e3 * row.arc_s for row in chosen]
    axes[1].plot([row.value for row in chosen], arc, **plotting.GUIDE, label=f"v/a: time to turn, {arc_of}")
    return figure, list(axes)


@plotting.in_house_style
def speed(rows: Sequence[Approach], letters: bool) -> Figure:
    """Restitution, delay and kick against the excess above grazing. Kick and loss fade towards grazing, where
    the contact takes longer than the arc beyond the plate."""
    figure, axes = panels(rows, "speed", plotting.EXCESS, "Hertz")
    hertz = select(rows, "speed", "Hertz")
    floor, words = [math.sqrt(row.contact_s / row.arc_s) for row in hertz], "√(contact time · a/v)"
    axes[0].plot([row.value for row in hertz], floor, color="0.45", linewidth=0.8, label=words)
    axes[1].set_yscale("log")
    least, most = hertz[0].value / 1.6, 1.6 * hertz[-1].value
    for axis, bounds in zip(axes, ((0.0, 1.05), (1e-2, 1e1), (0.0, 1.1)), strict=True):
        axis.set_xscale("log")
        if letters:
            words = "letter: stability of the drive amplitude"
            axis.axvspan(least, letter.AMPLITUDE_STABILITY, color="0.92", zorder=-1, lw=0, label=words)
        axis.set(xlim=(least, most), ylim=bounds)
    if letters:
        plotting.mark_letter(axes[0].yaxis, letter.RESTITUTION, words="letter, τ ≈ 0.1", along=0.02)
    plotting.legend_below(figure, axes, 2, handlelength=3.0)
    return figure


@plotting.in_house_style
def mass(rows: Sequence[Approach], letters: bool) -> Figure:
    """Restitution, delay and kick against the mass of ball and mount. The restitution is smallest where the
    kick is near one."""
    figure, axes = panels(rows, "mass", MASS, "excess 0.013")
    looks = ((True, "x", "settled orbit, excess 0.013"), (False, "|", "the same, no return"))
    for returns, mark, name in looks:
        chosen = [row for row in on_orbits(rows) if row.returns is returns]
        heights = [row.restitution if returns else 0.0 for row in chosen]
        look = {"linestyle": "none", "markersize": 4.0, "color": PALETTE[4], "clip_on": False}
        if chosen:
            axes[0].plot([row.value for row in chosen], heights, marker=mark, **look, label=name)
    for axis, top in zip(axes, (1.0, None, 1.7), strict=True):
        axis.set_xlim(0.0, 1.03)
        axis.set_ylim(top=top)
    if letters:
        plotting.mark_letter(axes[0].yaxis, letter.RESTITUTION, words="letter, τ ≈ 0.1")
    plotting.legend_below(figure, axes, 3, handlelength=2.4)
    return figure
