"""Kick of a collision at a soft wall, and of the beam."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from studies import letter
from studies.experiment.soft_wall.model import Kick
from studies.shell import plotting
from studies.shell.plotting import EXCESS, PAGE, in_house_style

KICKS = "Kick of one collision against the excess. All laws go over into the power 1/2 of a hard wall."
BEAM: plotting.Style = {"color": plotting.SKY, "marker": "h", "linestyle": "none"}
CASES = {"lossless": "Eq. (1), elastic wall: power 3/2", "beam": "beam, Hertz contact: power 2"}


@in_house_style
def draw_kicks(rows: Sequence[Kick], letters: bool) -> Figure:
    """Kick against excess with both power laws: walls of each K, and the beam."""
    figure, axes = plotting.new_figure(1, 2, width=PAGE, height=0.078, sharey=True)
    for number, (axis, case) in enumerate(zip(axes, CASES, strict=True)):
        for i, hardness in enumerate(dict.fromkeys(row.hardness for row in rows if row.case == case)):
            curve = [row for row in rows if row.case == case and row.hardness == hardness]
            excess, simulated, closed, soft, hard = np.array(
                [(r.excess, r.kick_velocity, r.closed_form or np.nan, r.soft_law, r.hard_law) for r in curve]
            ).T
            style, near = plotting.points(i) if hardness else BEAM, soft < 3.0 * hard
            axis.loglog(excess[near], soft[near], color=style["color"], linestyle="--", linewidth=0.8)
            axis.loglog(excess, closed, color=style["color"], linewidth=0.8)
            name = "beam" if hardness is None else f"K = 10$^{{{np.log10(hardness):.0f}}}$"
            axis.loglog(excess, simulated, **style, markerfacecolor="white", label=name)
        if letters:
            plotting.mark_letter(
                axis.xaxis, letter.AMPLITUDE_STABILITY, along=0.02, words="letter:\nstability"
            )
        plotting.panel(axis, number, CASES[case])
        plotting.label(axis.xaxis, EXCESS)
        if curve:
            axis.loglog(excess, hard, ":", color="0.45", linewidth=1.2, label="hard wall, power 1/2")
    for line, name in (("-", "closed form"), ("--", "law of a soft touch")):
        axes[0].plot([], [], line, color="0.3", linewidth=0.8, label=name)
    axes[0].set_ylim(bottom=0.3 * min((row.kick_velocity for row in rows), default=1e-6))
    plotting.label(axes[0].yaxis, "kick of one collision", "m/s")
    plotting.legend_below(figure, axes, 4)
    return figure
