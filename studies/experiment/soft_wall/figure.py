"""Figures of the soft wall, from what the study has stored."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from studies import letter
from studies.experiment.soft_wall.closed_forms import SoftWall
from studies.experiment.soft_wall.model import Beam, Doubling, Kick
from studies.shell import plotting
from studies.shell.plotting import EXCESS, PAGE, PALETTE, in_house_style
from studies.shell.scene import Scene, single_mode_at

CASES = {"lossless": "Eq. (1), elastic wall: power 3/2", "beam": "beam, Hertz contact: power 2"}


@in_house_style
def draw_kicks(rows: Sequence[Kick]) -> Figure:
    """Kick against excess with both power laws: walls of each K, and the beam."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.078, sharey=True)
    for number, (axis, case) in enumerate(zip(axes, CASES, strict=True)):
        for i, hardness in enumerate(dict.fromkeys(row.hardness for row in rows if row.case == case)):
            curve = [row for row in rows if row.case == case and row.hardness == hardness]
            excess, simulated, closed, soft, hard = np.array(
                [(r.excess, r.kick_velocity, r.closed_form or np.nan, r.soft_law, r.hard_law) for r in curve]
            ).T
            style, near = plotting.points(i % 7), soft < 3.0 * hard
            axis.loglog(excess[near], soft[near], color=style["color"], linestyle="--", linewidth=0.8)
            axis.loglog(excess, closed, color=style["color"], linewidth=0.8)
            name = None if hardness is None else f"K = 10$^{{{np.log10(hardness):.0f}}}$"
            axis.loglog(excess, simulated, **style, markerfacecolor="white", label=name)
        axis.loglog(excess, hard, color="0.45", linewidth=1.2, linestyle=":", label="hard wall, power 1/2")
        plotting.mark_letter(axis.xaxis, letter.AMPLITUDE_STABILITY, along=0.02, words="letter:\nstability")
        plotting.panel(axis, number, CASES[case])
        plotting.label(axis.xaxis, EXCESS)
    axes[0].set_ylim(bottom=0.3 * min((row.kick_velocity for row in rows), default=1e-6))
    plotting.label(axes[0].yaxis, "kick of one collision", "m/s")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=7)
    return figure


@in_house_style
def draw_orbits(scene: Scene, doublings: Sequence[Doubling], beam: Beam | None) -> Figure:
    """Excess of the doubling against K; what is born on the beam."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.075)
    hardness = np.geomspace(10.0, 1e6, 121)
    for i, frequency in enumerate(sorted({row.frequency_hz for row in doublings})):
        style, colour = plotting.points(i % 7), PALETTE[i % 7]
        oscillator = single_mode_at(scene, frequency)
        walls = [SoftWall(oscillator=oscillator, hardness=K) for K in hardness.tolist()]
        axes[0].loglog(hardness, [(wall.doubling() or (0.0, np.nan))[1] for wall in walls], color=colour)
        rows = [row for row in doublings if row.frequency_hz == frequency]
        axes[0].loglog(
            [row.hardness for row in rows],
            [row.excess or np.nan for row in rows],
            **style,
            markerfacecolor="white",
            label=f"{frequency:.2f} Hz",
        )
    plotting.mark_letter(axes[0].yaxis, letter.AMPLITUDE_STABILITY, words="letter: stability")
    if beam is not None:
        axes[1].semilogx(
            *zip(*(one for one in beam.born if one[1]), strict=True),
            **plotting.points(2),
            markerfacecolor="white",
            label="raised in one step",
        )
        stable = (beam.born[0][0], beam.unstable_excess or np.nan)
        axes[1].semilogx(stable, (1, 1), color=PALETTE[1], marker="|", label="p$_1$ with a touch is stable")
        axes[1].set_ylim(0.0, 1.5 + axes[1].get_ylim()[1])
        plotting.mark_letter(axes[1].xaxis, letter.AMPLITUDE_STABILITY, along=0.3, words="letter:\nstability")
        axes[1].legend(loc="center left", bbox_to_anchor=(0.0, 0.55))
    for number, (axis, name, across) in enumerate(
        zip(
            axes,
            ("excess of the doubling of p$_1$", "beam: period born"),
            ("hardness K", EXCESS),
            strict=True,
        )
    ):
        plotting.panel(axis, number, name)
        plotting.label(axis.xaxis, across)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure
