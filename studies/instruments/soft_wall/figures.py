"""Figures of the soft wall, from what the study has stored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.figures import (
    EXCESS,
    GUIDE,
    LINES,
    MARKERS,
    NOTE,
    PAGE,
    PALETTE,
    SKY,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
    tint,
)

__all__ = ["draw_beam", "draw_doubling", "draw_hysteresis", "draw_kicks"]

COLOURS = PALETTE[:7]
CASES = ("lossless", "dashpot")
WORDS = {"lossless": "lossless", "dashpot": "with dashpot"}
Rows = Sequence[Mapping[str, Any]]


def _power(value: float) -> str:
    exponent = np.log10(value)
    return f"10$^{{{exponent:.0f}}}$" if abs(exponent - round(exponent)) < 1e-6 else f"{value:g}"


@in_house_style
def draw_kicks(curves: Rows, resolution: float) -> Any:
    """Kick against excess for each K with both power laws, without and with the dashpot."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.075, sharey=True)
    for axis, case in zip(axes, CASES, strict=True):
        chosen = [curve for curve in curves if curve["case"] == case]
        for i, curve in enumerate(chosen):
            excess = np.array(curve["excess"])
            soft, hard = np.array(curve["soft_law"]), np.array(curve["hard_law"])
            near, hardness = soft < 3.0 * hard, f"K = {_power(curve['K'])}"
            axis.loglog(
                excess[near], soft[near], color=COLOURS[i % 7], linewidth=0.8, linestyle="--", zorder=1,
                gid=f"{hardness}, power law below",
            )
            axis.loglog(
                excess, curve["kick_velocity"], color=COLOURS[i % 7], linestyle="none", marker=MARKERS[i % 8],
                markerfacecolor="white", zorder=3, label=hardness,
            )  # fmt: skip
            axis.loglog(excess, curve["closed_form"], color=COLOURS[i % 7], linewidth=0.8, zorder=2,
                        gid=f"{hardness}, closed form")
        if chosen:
            axis.loglog(excess, hard, color="0.45", linewidth=1.2, linestyle=":", zorder=1,
                        label="hard wall, power 1/2")
        mark_letter(axis.xaxis, resolution, words="letter: stability\nof the amplitude", along=0.02,
                    turn=True, level=True)
        power = "3/2" if case == "lossless" else "1"
        panel(axis, CASES.index(case), f"{WORDS[case]}: power {power} below, dashed")
        label(axis.xaxis, EXCESS)
    floor = min((min(curve["kick_velocity"]) for curve in curves), default=1e-6)
    axes[0].set_ylim(bottom=0.3 * floor)
    label(axes[0].yaxis, "kick of one collision", "m/s")
    handles, names = axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=min(7, max(1, len(names))))
    return figure


@in_house_style
def draw_doubling(rows: Rows, theory: Rows, resolution: float) -> Any:
    """Excess of the period doubling against K, and how far measurement and formulas are apart."""
    figure, (left, right) = new_figure(1, 2, width=PAGE, height=0.070)
    frequencies = sorted({row["frequency_hz"] for row in rows})
    for i, frequency in enumerate(frequencies):
        here = [r for r in rows if r["frequency_hz"] == frequency and r["excess_pd_measured"] is not None]
        lines = next((t for t in theory if t["frequency_hz"] == frequency), None)
        look, name = {"color": PALETTE[i % 7], "linewidth": 0.9}, f"{frequency:.2f} Hz"
        if lines is not None:
            left.loglog(lines["K"], lines["leading"], linestyle="--", **look, zorder=1, gid=f"{name}, K → ∞")
            left.loglog(lines["K"], lines["closed_form"], linestyle="-", **look, zorder=2,
                        gid=f"{name}, closed form")
        if not here:
            continue
        hardness = np.array([r["K"] for r in here])
        measured = np.array([r["excess_pd_measured"] for r in here])
        dots = {"color": PALETTE[i % 7], "marker": MARKERS[i % 8]}
        left.loglog(
            hardness,
            measured,
            linestyle="none",
            markerfacecolor="white",
            **dots,
            zorder=3,
            label=name,
        )
        leading = np.array([r["excess_pd_leading"] for r in here])
        right.loglog(hardness, np.abs(measured / leading - 1.0), linestyle="--", linewidth=0.8, **dots,
                     gid=f"{name}, against K → ∞")
        closed = [
            (r["K"], abs(r["excess_pd_measured"] / r["excess_pd_theory"] - 1.0))
            for r in here
            if r["excess_pd_theory"]
        ]
        if closed:
            right.loglog(
                *zip(*closed, strict=True), linestyle="-", linewidth=0.8, markerfacecolor="white", **dots,
                gid=f"{name}, against the closed form",
            )
    mark_letter(left.yaxis, resolution, words="letter: stability of the amplitude")
    label(left.xaxis, "hardness K")
    label(left.yaxis, "excess of the period doubling")
    words = "rise at $10^6$: rounding,\n$h_f$ is some $10^{-12}$ gaps"
    right.text(0.03, 0.05, words, fontsize=NOTE, color="0.35", transform=right.transAxes)
    label(right.xaxis, "hardness K")
    label(right.yaxis, "|measured/formula - 1|")
    panel(left, 0, "measured; closed form (line), K → ∞ (dashed)")
    panel(right, 1, "against K → ∞ (dashed), closed form (open)")
    handles, names = left.get_legend_handles_labels()
    if handles:
        figure.legend(handles, names, loc="outside lower center", ncols=min(6, len(names)))
    return figure


@in_house_style
def draw_hysteresis(rows: Rows) -> Any:
    """Where p_m ends against K, and its distance from the hard wall."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.075)
    frequencies = sorted({row["frequency_hz"] for row in rows})
    for i, frequency in enumerate(frequencies):
        for case in CASES:
            here = sorted(
                (
                    r
                    for r in rows
                    if r["frequency_hz"] == frequency and r["case"] == case and r["hysteresis"] is not None
                ),
                key=lambda r: r["K"],
            )
            if not here:
                continue
            hardness = np.array([r["K"] for r in here])
            end = np.array([r["hysteresis"] for r in here])
            hard = abs(here[0]["hysteresis_hard"])
            shift = np.abs(np.array([r["hysteresis_shift"] for r in here]))
            look = {
                "color": PALETTE[i % 7],
                "marker": MARKERS[i % 8],
                "linewidth": 0.8,
                "linestyle": LINES[0] if case == "dashpot" else LINES[1],
                "markerfacecolor": "white" if case == "lossless" else PALETTE[i % 7],
            }
            name = f"{frequency:.2f} Hz, p$_{{{here[0]['period']}}}$, {case}"
            axes[0].semilogx(hardness, -end / hard, **look, gid=name)
            axes[1].loglog(
                hardness,
                shift / hard,
                **look,
                label=name,
            )
    low, high = axes[1].get_xlim()
    span = np.array([max(low, 1e4), high])
    axes[1].loglog(span, 30.0 * span**-0.5, color="0.5", linestyle=":", linewidth=1.0, label="slope -1/2")
    axes[0].axhline(1.0, **GUIDE, gid="hard wall")
    axes[0].axhline(0.0, **GUIDE, gid="no hysteresis")
    for axis in axes:
        label(axis.xaxis, "hardness K")
    label(axes[0].yaxis, "hysteresis / hard wall")
    label(axes[1].yaxis, "shift / hard wall")
    panel(axes[0], 0, "hysteresis of p$_m$, by the fold")
    panel(axes[1], 1, "shift from Eq. (1) with the hard wall")
    handles, names = axes[1].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3)
    return figure


@in_house_style
def draw_beam(beam: Mapping[str, Any], resolution: float) -> Any:
    """Kick of the beam and born periods against excess, with the letter's amplitude stability."""
    figure, axes = new_figure(3, 1, height=0.128, sharex=True, height_ratios=(2.0, 1.3, 1.0))
    excess, speed = np.array(beam["excess"]), np.array(beam["kick_velocity"])
    top, middle, bottom = axes
    top.loglog(
        excess,
        speed,
        color=PALETTE[1],
        marker="o",
        markerfacecolor="white",
        linestyle="-",
        zorder=3,
        label="beam, mode 1",
    )
    soft = np.array(beam["soft_law"])
    near = soft < 3.0 * speed.max()
    top.loglog(excess[near], soft[near], color="0.4", linestyle="--", linewidth=0.8, label="Hertz, power 2")
    top.loglog(
        excess, beam["hard_law"], color="0.4", linestyle=":", linewidth=1.2, label="power 1/2 at full kick"
    )
    top.set_ylim(0.4 * speed.min(), 4.0 * speed.max())
    label(top.yaxis, "kick of mode 1", "m/s")
    middle.semilogx(excess, beam["slope"], color=PALETTE[1], marker="o", markerfacecolor="white",
                    gid="beam, mode 1")
    middle.axhspan(0.4, 0.6, color="0.9", zorder=0, linewidth=0, gid="1/2 within 0.1")
    middle.axhline(0.5, color="0.5", linewidth=0.8, linestyle=":", gid="power 1/2")
    middle.axhline(2.0, color="0.5", linewidth=0.8, linestyle="--", gid="power 2")
    label(middle.yaxis, "local power")
    for name, number, size in (("in_one_step", 2, 5.0), ("gently", 1, 2.5)):
        found = [(r["excess"], r[f"period_{name}"]) for r in beam["born"] if r[f"period_{name}"]]
        if found:
            bottom.semilogx(
                *zip(*found, strict=True),
                linestyle="none",
                marker=MARKERS[number],
                markersize=size,
                color=PALETTE[number],
                markerfacecolor="white" if name == "in_one_step" else PALETTE[number],
                label="raised " + ("in one step" if name == "in_one_step" else "gently"),
            )
    highest = max((r[f"period_{n}"] or 0 for r in beam["born"] for n in ("gently", "in_one_step")), default=1)
    bottom.set_ylim(0.0, min(highest, 12) + 1.0)
    label(bottom.yaxis, "born period")
    label(bottom.xaxis, EXCESS)
    bottom.yaxis.get_major_locator().set_params(integer=True)
    marks = (("half_excess", "-.", "half kick"), ("doubling_excess", (0, (1, 1)), "p$_1$ ends"))
    marked = [mark for mark in marks if beam[mark[0]]]
    for axis in axes:
        shaded = axis.axvspan(excess.min(), resolution, color=tint(SKY, 0.15), linewidth=0, zorder=-1,
                              gid="letter, stability of the amplitude")
        for key, style, words in marked:
            axis.axvline(beam[key], color="0.35", linewidth=0.7, linestyle=style, zorder=1, gid=words)
    for key, _, words in marked:
        top.text(beam[key], 1.02, words, fontsize=NOTE, color="0.25", ha="center", va="bottom",
                 transform=top.get_xaxis_transform())
    for number, axis in enumerate(axes):
        panel(axis, number)
    top.legend(loc="lower right")
    bottom.legend(loc="center right", bbox_to_anchor=(1.0, 0.45))
    shaded.set_label("letter: stability\nof the amplitude")
    middle.legend(handles=[shaded], loc="upper right", bbox_to_anchor=(1.0, 0.9))
    return figure
