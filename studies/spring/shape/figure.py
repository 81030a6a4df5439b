"""The periods of the letter that survive at the amplitude of the gap."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from studies.shell import plotting
from studies.shell.digits import written
from studies.shell.scene import Scene
from studies.spring.shape.finite_amplitude import Survival
from studies.spring.shape.shapes import TITLES

SURVIVAL = "What is left of a linear spring at the amplitude of the gap, for strips folded with a bend."


@plotting.in_house_style
def draw_survival(scene: Scene, rows: Sequence[Survival], letters: bool) -> Figure:
    """Periods that survive, or else the change of the free frequency, by bend radius and gap of a fold."""
    figure, chart = plotting.new_figure(width=0.11)
    count, folded = len(scene.drive.frequencies_hz), [row for row in rows if row.reading == TITLES["folded"]]
    radii, gaps = (sorted({getattr(row, key) for row in folded}) for key in ("bend_radius_m", "gap_m"))
    for row in (row for row in folded if row.tip_mass_kg == scene.tip.mass_kg):
        place = radii.index(row.bend_radius_m), gaps.index(row.gap_m)
        change = 100.0 * row.kappa * (row.gap_m / row.length_m) ** 2
        colour = plotting.tint(plotting.SKY, (row.survive or 0) / count) if letters else "white"
        chart.scatter(*place, s=140, color=colour, edgecolor="0.6" if letters else "white", linewidth=0.5)
        words = str(row.survive) if letters else written(round(change, 2), 1)
        chart.annotate(words, place, ha="center", va="center")
    kept = f"number: periods of the letter that are kept, of {count}"
    chart.set_title(kept if letters else "change of the free frequency at the gap (%)", loc="left")
    chart.set_xticks(range(len(radii)), [f"{1e3 * radius:.3g}" for radius in radii])
    chart.set_yticks(range(len(gaps)), [f"{1e3 * gap:.3g}" for gap in gaps])
    chart.margins(0.08, 0.12)
    plotting.label(chart.xaxis, "bend radius", "mm")
    plotting.label(chart.yaxis, "gap", "mm")
    return figure
