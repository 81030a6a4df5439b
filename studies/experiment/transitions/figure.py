"""Orbit diagrams of the transitions, as in the letter's Fig. 2."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact import plots
from studies import letter
from studies.experiment.transitions.model import Scans, Transition
from studies.physics.descriptions import TITLES, Diagram
from studies.shell import plotting
from studies.shell.plotting import GUIDE

ORDER = ("upward scan", "downward scan", "pale: orbit with several impacts", "not settled", "grazing")
"""Names of the legend, the letter's last."""


def draw(
    read: str, rows: Sequence[Transition], diagrams: Sequence[Scans], name: str, *, letters: bool
) -> Figure:
    """A panel a frequency for one description; `read`: the quantity at the read-out point."""
    rows = [row for row in rows if row.description == name]
    columns = min(3, len(rows))
    lines = math.ceil(len(rows) / columns)
    with plotting.house_style():
        size = {"width": plotting.PAGE, "height": 0.055 * lines + 0.012}
        figure, axes = plotting.new_figure(lines, columns, squeeze=False, **size)
        for axis in axes.flat[len(rows) :]:
            axis.set_visible(False)
        for number, (axis, row, found) in enumerate(zip(axes.flat, rows, diagrams, strict=False)):
            if name in found:
                panel(axis, row, found[name], letters)
            seen = "" if row.letter is None else f" (letter p$_{{{row.letter}}}$)"
            words = f"p$_{{{row.m}}}$" if row.m else "no period"
            plotting.panel(axis, number, f"{row.frequency_hz:.2f} Hz: {words}{seen}")
        figure.suptitle(TITLES[name], fontweight="bold")
        sideways = (plotting.EXCESS, "10$^{-3}$") if name == "map" else ("drive amplitude", "mm")
        upwards = {
            "map": ("$x$ of the map", "1"),
            "single_mode": ("tip $ξ$", "mm"),
            "two_parameters": ("tip $ξ$", "mm"),
            "beam": ("read-out", "mm" if read == "displacement" else "mrad"),
        }[name]
        for axis in axes.flat[max(len(rows) - columns, 0) : len(rows)]:
            plotting.label(axis.xaxis, *sideways)
        for axis in axes[:, 0]:
            plotting.label(axis.yaxis, *upwards)
        plotting.legend_below(figure, axes.flat, 3, order=ORDER, markerscale=1.5)
    return figure


def panel(axis: Axes, row: Transition, found: Mapping[str, Diagram], letters: bool) -> None:
    """Both scans at one frequency, against the amplitude [mm], for the map (no amplitude) the excess
    [1e-3]."""
    grazing = None if row.description == "map" else row.grazing_amplitude
    moving = set[float]()
    for way, look in (("up", plotting.UP), ("down", plotting.DOWN)):
        diagram = found[way]
        amplitude = 1e3 * (diagram.excess if grazing is None else grazing * (1.0 + diagram.excess))
        settled = diagram.m > 0
        # below grazing, beside the orbit that was born: longer ones with several impacts
        beside = (diagram.excess < 0.0) & ~np.isin(diagram.m, (1, row.m or 0))
        moving |= {a for a, kind in zip(amplitude, diagram.kind, strict=True) if kind == "not settled"}
        points = diagram.points[settled] * (1.0 if grazing is None else 1e3)
        words = {"label": f"{way}ward scan", "pale": "pale: orbit with several impacts"}
        plots.strobes(axis, amplitude[settled], points, ~beside[settled], **look, **words)
    for place, value in enumerate(sorted(moving)):
        axis.axvline(value, color="0.75", linewidth=0.5, zorder=1, label="_" if place else "not settled")
    at = 0.0 if grazing is None else 1e3 * grazing
    if letters:
        stable = 1e3 * (letter.AMPLITUDE_STABILITY if grazing is None else letter.AMPLITUDE_STABILITY_M)
        band: plotting.Style = {"color": "0.88", "linewidth": 0, "zorder": 0}
        axis.axvspan(at - stable, at + stable, **band, label="letter: stability of the drive amplitude")
    axis.axvline(at, **GUIDE, label="grazing")
    axis.locator_params(axis="x", nbins=4)
