"""The orbit diagrams of Fig. 5 below one another, and the born period as a map of labelled cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from studies.experiment.breakdown.model import CHAOS_AT, HIGHEST, Cell, Outcome, periods
from studies.physics.descriptions import Diagram
from studies.shell import plotting
from studies.shell.plotting import DOWN, EXCESS, GREEN, GUIDE, NOTE, ORANGE, PAGE, SKY, UP, tint

SCANS = (
    "Orbit diagrams at the frequency of Fig. 5: Eq. (1), with the island of p3 and chaos in grey; the beam "
    "as calibrated; the beam found in the search. Filled: amplitude raised; open: lowered; at the right, "
    "finer steps above grazing. Pale: did not settle."
)
BORN = (
    "Period born at excess 1e-3 (letter: 6) over the mass of ball and mount and the damping of the higher "
    "modes (–: none up to 64; framed: the beam found)."
)
LOOKS = {
    "down": (DOWN, "downward scan"),
    "up": (UP, "upward scan"),
    "island": (("0.55", "0.55", 0.8, 1), "island, followed upwards from its fold"),
}


def title_of(outcome: Outcome) -> str:
    """What a panel shows."""
    if outcome.tip_mass_kg is None:
        return outcome.description
    words = (
        f"beam, {1e3 * outcome.tip_mass_kg:.2f} g, damping of the higher modes × {outcome.higher_damping:g}"
    )
    return f"{words}, as calibrated" if outcome.description == "beam" else words


@plotting.in_house_style
def draw_scans(panels: Sequence[tuple[Outcome, Mapping[str, Diagram]]]) -> Figure:
    """The scans below one another: steps below grazing on the left, the finer ones above it on the right."""
    figure, axes = plotting.new_figure(
        len(panels),
        2,
        width=PAGE,
        height=0.052 * len(panels) + 0.014,
        squeeze=False,
        sharey="row",
        width_ratios=[1.7, 1.0],
    )
    lowest = min(float(d.excess.min()) for _, ways in panels for d in ways.values())
    for number, (pair, (outcome, ways)) in enumerate(zip(axes, panels, strict=True)):
        for axis in pair:
            for way, diagram in ways.items():
                look, words = LOOKS[way]
                settled = (periods(diagram) > 0) | (way == "island")
                plotting.strobe_points(axis, 1e2 * diagram.excess, 1e3 * diagram.points, settled, look, words)
            axis.axvline(0.0, **GUIDE)
        pair[0].set_xlim(1e2 * lowest - 0.3, 0.02)
        pair[1].set_xlim(-0.03, 1e2 * HIGHEST + 0.03)
        plotting.panel(pair[0], number, title_of(outcome))
        plotting.label(pair[0].yaxis, "tip displacement" if number == 0 else "read-out", "mm")
        if outcome.fold_p3 is not None:
            line: plotting.Style = {"color": GREEN, "linestyle": "-.", "linewidth": 0.9, "zorder": 0}
            pair[0].axvline(1e2 * outcome.fold_p3, **line, label="fold of p$_3$")
    axes[0, 1].set_title("finer steps above grazing", loc="right")
    axes[-1, 1].set_title("letter: p$_6$ born here", loc="right")
    plotting.mark_letter(axes[0, 0].xaxis, 1e2 * CHAOS_AT, words="letter: chaos\nof Eq. (1)", along=0.98)
    for axis in axes[-1]:
        plotting.label(axis.xaxis, EXCESS, "%")
    plotting.legend_below(figure, axes[:, 0], 4, markerscale=2.0)
    return figure


@plotting.in_house_style
def draw_born(cells: Sequence[Cell], mass: float, found: Outcome | None) -> Figure:
    """The born period as a map of labelled cells."""
    masses = sorted({cell.tip_mass_kg for cell in cells})
    factors = sorted({cell.higher_damping for cell in cells})
    figure, axis = plotting.new_figure(height=0.030 + 0.0058 * len(masses))
    colours = {3: SKY, 6: ORANGE, 12: tint(ORANGE, 0.4), 0: "0.87"}
    for cell in cells:
        place = factors.index(cell.higher_damping), masses.index(cell.tip_mass_kg)
        own = (cell.tip_mass_kg, cell.higher_damping)
        framed = found is not None and own == (found.tip_mass_kg, found.higher_damping)
        box = {"facecolor": colours.get(cell.period, tint(GREEN, 0.2)), "pad": 4.0}
        box["edgecolor"] = "black" if framed else "none"
        axis.text(*place, str(cell.period or "–"), ha="center", va="center", fontsize=NOTE, bbox=box)
    axis.set(xlim=(-0.5, len(factors) - 0.5), ylim=(-0.5, len(masses) - 0.5))
    axis.set_xticks(np.arange(len(factors)), [f"{k:g}" for k in factors])
    axis.set_yticks(np.arange(len(masses)), [f"{1e3 * m:.2f}" for m in masses])
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)
    plotting.label(axis.xaxis, "damping of the higher modes / that of the strips")
    plotting.label(axis.yaxis, "ball and mount", "g")
    axis.set_title(f"calibrated: {1e3 * mass:.2f} g, 1", loc="left")
    return figure
