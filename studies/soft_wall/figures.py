"""Figures of the soft wall, from what the study has stored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies import letter, plotting
from studies.plotting import EXCESS, GUIDE, LINES, MARKERS, NOTE, PAGE, PALETTE, SKY, in_house_style, tint
from studies.soft_wall.beam import Beam, BeamKick, Born
from studies.soft_wall.measured import Doubling, End, Kick

__all__ = ["draw_beam", "draw_doublings", "draw_kicks"]

CASES = {"lossless": "lossless: power 3/2 below", "dashpot": "with dashpot: power 1 below"}


def power_of_ten(value: float) -> str:
    """As 10 to an exponent."""
    return f"10$^{{{np.log10(value):.0f}}}$"


@in_house_style
def draw_kicks(rows: Sequence[Kick]) -> Figure:
    """Kick against excess for each K with both power laws, without and with the dashpot."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.075, sharey=True)
    for number, (axis, case) in enumerate(zip(axes, CASES, strict=True)):
        for i, hardness in enumerate(sorted({row.hardness for row in rows})):
            curve = [row for row in rows if row.hardness == hardness and row.case == case]
            excess, measured, closed, soft, hard = np.array(
                [(r.excess, r.kick_velocity, r.closed_form or np.nan, r.soft_law, r.hard_law) for r in curve]
            ).reshape(-1, 5).T  # fmt: skip
            look = {"color": PALETTE[i % 7], "linewidth": 0.8}
            near = soft < 3.0 * hard
            axis.loglog(excess[near], soft[near], **look, linestyle="--", zorder=1)
            axis.loglog(excess, closed, **look, zorder=2)
            axis.loglog(excess, measured, color=PALETTE[i % 7], linestyle="none", marker=MARKERS[i % 8],
                        markerfacecolor="white", zorder=3, label=f"K = {power_of_ten(hardness)}")  # fmt: skip
            last = axis.loglog(excess, hard, color="0.45", linewidth=1.2, linestyle=":", zorder=1)
        if rows:
            last[0].set_label("hard wall, power 1/2")
        plotting.mark_letter(axis.xaxis, letter.AMPLITUDE_STABILITY, along=0.02, turn=True, level=True,
                             words="letter: stability\nof the amplitude")  # fmt: skip
        plotting.panel(axis, number, CASES[case])
        plotting.label(axis.xaxis, EXCESS)
    axes[0].set_ylim(bottom=0.3 * min((row.kick_velocity for row in rows), default=1e-6))
    plotting.label(axes[0].yaxis, "kick of one collision", "m/s")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


@in_house_style
def draw_doublings(
    doublings: Sequence[Doubling], ends: Sequence[End], theory: Mapping[float, np.ndarray]
) -> Figure:
    """Excess of the period doubling against K, errors of the formulas, and the shift of the end of p_m."""
    figure, (left, middle, right) = plotting.new_figure(1, 3, width=PAGE, height=0.072)
    for i, (frequency, (hardness, closed, limit)) in enumerate(theory.items()):
        look = {"color": PALETTE[i % 7], "linewidth": 0.8}
        left.loglog(hardness, closed, **look)
        left.loglog(hardness, limit, linestyle="--", **look)
        rows = [r for r in doublings if (r.frequency_hz, r.case) == (frequency, "lossless") and r.excess]
        K, excess = (np.array(column) for column in ([r.hardness for r in rows], [r.excess for r in rows]))
        dots = {"color": PALETTE[i % 7], "marker": MARKERS[i % 8]}
        left.loglog(K, excess, linestyle="none", markerfacecolor="white", **dots, label=f"{frequency:.2f} Hz")
        for formula, style, face in (("limit", "--", PALETTE[i % 7]), ("closed_form", "-", "white")):
            known = np.array([getattr(row, formula) or np.nan for row in rows])
            middle.loglog(K, np.abs(excess / known - 1.0), linestyle=style, linewidth=0.8,
                          markerfacecolor=face, **dots)  # fmt: skip
        draw_shift(right, [row for row in ends if row.frequency_hz == frequency], i)
    plotting.mark_letter(left.yaxis, letter.AMPLITUDE_STABILITY, words="letter: stability")
    span = np.array([3e3, 1e6])
    right.loglog(span, 20.0 * span**-0.5, color="0.5", linestyle=":", label="slope -1/2")
    words = ("excess of the doubling", "|measured/formula - 1|", "shift of the end / hard wall")
    for number, (axis, name) in enumerate(zip((left, middle, right), words, strict=True)):
        plotting.panel(axis, number, name)
        plotting.label(axis.xaxis, "hardness K")
    handles, names = left.get_legend_handles_labels()
    others = right.get_legend_handles_labels()
    more = dict(zip(others[1], others[0], strict=True))
    figure.legend([*handles, *more.values()], [*names, *more], loc="outside lower center", ncols=5)
    return figure


def draw_shift(axis: Axes, rows: Sequence[End], number: int) -> None:
    """Distance of the end of p_m from the hard wall's at one frequency, over the hysteresis there."""
    for case, style in (("lossless", LINES[1]), ("dashpot", LINES[0])):
        known = [(r.hardness, abs(r.shift / r.hard_wall)) for r in rows
                 if r.case == case and r.shift is not None and r.hard_wall is not None]  # fmt: skip
        axis.loglog(
            *np.array(known).reshape(-1, 2).T,
            color=PALETTE[number % 7], marker=MARKERS[number % 8], linestyle=style, linewidth=0.8,
            markerfacecolor="white" if case == "lossless" else PALETTE[number % 7],
        )  # fmt: skip


@in_house_style
def draw_beam(beam: Beam, kicks: Sequence[BeamKick], born: Sequence[Born]) -> Figure:
    """Kick of the beam and born periods against excess, with the letter's amplitude stability."""
    figure, (top, middle, bottom) = plotting.new_figure(
        3, 1, height=0.128, sharex=True, height_ratios=(2.0, 1.3, 1.0)
    )
    excess, speed, slope, soft, hard = np.array(
        [(r.excess, r.kick_velocity, r.slope, r.soft_law, r.hard_law) for r in kicks]
    ).T
    look = {"color": PALETTE[1], "marker": "o", "markerfacecolor": "white"}
    top.loglog(excess, speed, **look, zorder=3, label="beam, mode 1")
    near = soft < 3.0 * speed.max()
    top.loglog(excess[near], soft[near], color="0.4", linestyle="--", linewidth=0.8, label="Hertz, power 2")
    top.loglog(excess, hard, color="0.4", linestyle=":", linewidth=1.2, label="power 1/2 at full kick")
    top.set_ylim(0.4 * speed.min(), 4.0 * speed.max())
    plotting.label(top.yaxis, "kick of mode 1", "m/s")
    middle.semilogx(excess, slope, **look)
    middle.axhspan(0.4, 0.6, color="0.9", zorder=0, linewidth=0)
    for power in (0.5, 2.0):
        middle.axhline(power, **GUIDE)
    plotting.label(middle.yaxis, "local power")
    ways = {"in one step": ("period_in_one_step", 2, 5.0, "white"), "gently": ("period_gently", 1, 2.5, None)}
    for name, (key, number, size, face) in ways.items():
        settled = [(row.excess, getattr(row, key)) for row in born if getattr(row, key)]
        bottom.semilogx(*np.array(settled).reshape(-1, 2).T, linestyle="none", marker=MARKERS[number],
                        markersize=size, color=PALETTE[number], markerfacecolor=face, label=f"raised {name}")
    bottom.set_ylim(0.0, bottom.get_ylim()[1] + 0.8)
    bottom.yaxis.get_major_locator().set_params(integer=True)
    plotting.label(bottom.yaxis, "born period")
    plotting.label(bottom.xaxis, EXCESS)
    marks = ((beam.half_excess, "-.", "half kick"), (beam.doubling_excess, ":", "p$_1$ ends"))
    for value, style, words in marks:
        if value is not None:
            top.text(value, 1.02, words, fontsize=NOTE, color="0.25", ha="center",
                     transform=top.get_xaxis_transform())  # fmt: skip
            for axis in (top, middle, bottom):
                axis.axvline(value, color="0.35", linewidth=0.7, linestyle=style, zorder=1)
    for number, axis in enumerate((top, middle, bottom)):
        axis.axvspan(excess.min(), letter.AMPLITUDE_STABILITY, color=tint(SKY, 0.15), linewidth=0, zorder=-1,
                     label="letter: stability\nof the amplitude" if number == 1 else None)  # fmt: skip
        plotting.panel(axis, number)
    top.legend(loc="lower right")
    middle.legend(loc="upper right", bbox_to_anchor=(1.0, 0.9))
    bottom.legend(loc="center right", bbox_to_anchor=(1.0, 0.45))
    return figure
