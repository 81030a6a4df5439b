"""The periods of the letter that survive at the amplitude of the gap."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from studies.shell import plotting
from studies.shell.scene import Scene
from studies.spring.shape.finite_amplitude import RADII, Survival
from studies.spring.shape.shapes import TITLES

SURVIVAL = (
    "Springs folded with a bend of this radius that keep the letter's periods at the amplitude of the gap."
)


@plotting.in_house_style
def draw_survival(scene: Scene, rows: Sequence[Survival]) -> Figure:
    """Periods that survive, of the folded strip over bend radius and gap."""
    figure, chart = plotting.new_figure(height=0.066)
    count = len(scene.drive.frequencies_hz)
    for row in rows:
        if row.reading == TITLES["folded"] and row.tip_mass_kg == scene.tip.mass_kg:
            place = 1e3 * row.bend_radius_m, 1e3 * row.gap_m
            chart.scatter(*place, s=120, color=plotting.tint(plotting.BLUE, row.survive / count))
            chart.annotate(str(row.survive), place, ha="center", va="center")
    chart.set_title(f"number: periods kept, of {count}", loc="left")
    chart.set_xscale("log")
    ticks = [1e3 * radius for radius in (RADII[0], 7.5e-3, 15e-3, 25e-3, RADII[-1])]
    chart.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    chart.set_xticks([], minor=True)
    chart.margins(0.08, 0.12)
    plotting.label(chart.xaxis, "bend radius", "mm")
    plotting.label(chart.yaxis, "gap", "mm")
    return figure
