"""The orbit diagrams of Fig. 5 below one another, and the born period as a map of labelled cells."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from contact import plots
from studies.experiment.breakdown.model import BORN_PERIOD, CHAOS_AT, HIGHEST, Cell, Outcome, periods
from studies.physics.descriptions import Diagram
from studies.shell import plotting
from studies.shell.plotting import DOWN, EXCESS, GREEN, GUIDE, NOTE, ORANGE, PAGE, SKY, UP, tint

SCANS = (
    "Orbit diagrams at the frequency of Fig. 5: Eq. (1), with the island of p3 and chaos in grey; the beam "
    "as calibrated; the beam found in the search. At the right are finer steps above grazing."
)
BORN = (
    "The period that begins at grazing, at an excess of 0.001, by two quantities that the letter does not "
    "print: the mass of ball and mount, and the damping of the higher modes."
)
LOOKS = {
    "up": {**UP, "label": "upward scan"},
    "down": {**DOWN, "label": "downward scan"},
    "island": {
        "color": "0.55",
        "markersize": 0.8,
        "zorder": 1,
        "label": "island, followed upwards from its fold",
    },
}


def title_of(outcome: Outcome, tau: float) -> str:
    """What a panel shows; `tau` is the restitution of Eq. (1)."""
    if outcome.tip_mass_kg is None:
        return f"Eq. (1), τ = {tau:g}"
    words = f"beam, {1e3 * outcome.tip_mass_kg:.2f} g"
    if outcome.higher_damping != 1.0:
        words += f", higher modes damped × {outcome.higher_damping:g}"
    return f"{words}, as calibrated" if outcome.description == "beam" else words


@plotting.in_house_style
def draw_scans(
    panels: Sequence[tuple[Outcome, Mapping[str, Diagram]]], tau: float, *, letters: bool
) -> Figure:
    """The scans below one another: steps below grazing on the left, the finer ones above it on the right."""
    looks: plotting.Style = {"width": PAGE, "squeeze": False, "sharey": "row", "width_ratios": [1.4, 1.0]}
    figure, axes = plotting.new_figure(len(panels), 2, height=0.052 * len(panels) + 0.014, **looks)
    for number, (pair, (outcome, ways)) in enumerate(zip(axes, panels, strict=True)):
        for axis in pair:
            for way, diagram in ways.items():
                settled = (periods(diagram) > 0) | (way == "island")
                plots.strobes(axis, 1e2 * diagram.excess, 1e3 * diagram.points, settled, **LOOKS[way])
            axis.axvline(0.0, **GUIDE, label="grazing")
        pair[0].set_xlim(1e2 * min(float(d.excess.min()) for d in ways.values()) - 0.3, 0.02)
        pair[1].set_xlim(-0.03, 1e2 * HIGHEST + 0.03)
        plotting.panel(pair[0], number, title_of(outcome, tau))
        begins = f"p$_{{{outcome.born_period}}}$ begins" if outcome.born_period else "no periodic motion"
        seen = f" (letter: p$_{{{BORN_PERIOD}}}$)" if letters and outcome.tip_mass_kg else ""
        pair[1].set_title(f"{begins}{seen}", loc="left")
        plotting.label(pair[0].yaxis, "tip" if number == 0 else "read-out", "mm")
        if outcome.fold_p3 is not None:
            line: plotting.Style = {"color": GREEN, "linestyle": "-.", "linewidth": 0.9, "zorder": 0}
            pair[0].axvline(1e2 * outcome.fold_p3, **line, label="fold of p$_3$")
    if letters:
        plotting.mark_letter(axes[0, 0].xaxis, 1e2 * CHAOS_AT, words="letter: chaos of Eq. (1)", along=0.98)
    plotting.label(axes[-1, 0].xaxis, EXCESS, "%")
    plotting.label(axes[-1, 1].xaxis, f"the same above grazing, {EXCESS}", "%")
    plotting.legend_below(figure, axes[:, 0], 3, markerscale=2.0)
    return figure


@plotting.in_house_style
def draw_born(cells: Sequence[Cell], mass: float, found: Outcome | None, *, letters: bool) -> Figure:
    """The born period as a map of labelled cells; `mass` is that of the calibrated beam [kg]."""
    masses = sorted({cell.tip_mass_kg for cell in cells})
    factors = sorted({cell.higher_damping for cell in cells})
    figure, axis = plotting.new_figure(height=0.040 + 0.0055 * len(masses))
    looks = {0: ("0.87", "no period up to 64"), 3: (SKY, "p$_3$")}
    looks[int(BORN_PERIOD)] = ORANGE, f"p$_{{{BORN_PERIOD}}}$" + ", as in the letter" * letters
    framed = None if found is None else (found.tip_mass_kg, found.higher_damping)
    for cell in sorted(cells, key=lambda cell: cell.m):
        x, y = factors.index(cell.higher_damping), masses.index(cell.tip_mass_kg)
        colour, words = looks.get(cell.m, (tint(GREEN, 0.2), "another period"))
        axis.add_patch(Rectangle((x - 0.46, y - 0.44), 0.92, 0.88, facecolor=colour, label=words))
        axis.text(x, y, str(cell.m or "–"), ha="center", va="center", fontsize=NOTE)
        if framed == (cell.tip_mass_kg, cell.higher_damping):
            frame: plotting.Style = {"fill": False, "linewidth": 1.2, "label": "framed: its scans are drawn"}
            axis.add_patch(Rectangle((x - 0.46, y - 0.44), 0.92, 0.88, **frame))
    if masses[0] <= mass <= masses[-1] and 1.0 in factors:
        own = factors.index(1.0) - 0.3, float(np.interp(mass, masses, np.arange(len(masses))))
        axis.plot(*own, "D", color="black", markersize=3.5, label=f"calibrated beam, {1e3 * mass:.2f} g")
    axis.set(xlim=(-0.5, len(factors) - 0.5), ylim=(-0.5, len(masses) - 0.5))
    axis.set_xticks(np.arange(len(factors)), [f"{k:g}" for k in factors])
    axis.set_yticks(np.arange(len(masses)), [f"{1e3 * m:.2f}" for m in masses])
    axis.tick_params(length=0)
    axis.set_title("period that begins at grazing", loc="left")
    plotting.label(axis.xaxis, "factor on the damping of the higher modes")
    plotting.label(axis.yaxis, "ball and mount", "g")
    plotting.legend_below(figure, [axis], 2)
    return figure
