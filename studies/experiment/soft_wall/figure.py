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

KICKS = (
    "Kick of one collision against the excess: points, closed form (line) and, dashed, the law of a soft "
    "touch. All go over into the power 1/2 of a hard one, the beam below what the letter's drive could "
    "resolve."
)
DOUBLINGS = (
    "Excess of the period doubling of p1 at an elastic wall; closed form (line). Dashed: where p1 of the "
    "beam loses its stability."
)
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
    plotting.legend_below(figure, axes[:1], 7)
    return figure


@in_house_style
def draw_doublings(scene: Scene, doublings: Sequence[Doubling], beam: Beam | None) -> Figure:
    """Excess of the doubling against K, and what the beam does."""
    figure, axis = plotting.new_figure(height=0.080)
    hardness = np.geomspace(10.0, 1e6, 121)
    for i, frequency in enumerate(sorted({row.frequency_hz for row in doublings})):
        oscillator, colour = single_mode_at(scene, frequency), PALETTE[i % 7]
        walls = [SoftWall(oscillator=oscillator, hardness=K) for K in hardness.tolist()]
        axis.loglog(hardness, [(wall.doubling() or (0.0, np.nan))[1] for wall in walls], color=colour)
        rows = [row for row in doublings if row.frequency_hz == frequency]
        places = [row.hardness for row in rows], [row.excess or np.nan for row in rows]
        look = {**plotting.points(i % 7), "markerfacecolor": "white"}
        axis.loglog(*places, **look, label=f"{frequency:.2f} Hz")
    if beam is not None and beam.unstable_excess:
        axis.axhline(beam.unstable_excess, **plotting.GUIDE, label="beam: loss of stability")
    plotting.mark_letter(axis.yaxis, letter.AMPLITUDE_STABILITY, words="letter: stability")
    plotting.label(axis.xaxis, "hardness K")
    plotting.label(axis.yaxis, "excess of the doubling of p$_1$")
    plotting.legend_below(figure, [axis], 3)
    return figure
