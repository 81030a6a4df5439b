"""Tables and figure of the next measurement: errors over the plane of frequency and excess."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from studies import letter
from studies.measurement.next_measurement import model
from studies.measurement.next_measurement.model import Array, Measurement, Plan, best
from studies.physics.parameters import described
from studies.shell import plotting
from studies.shell.digits import written
from studies.shell.run import Run
from studies.shell.scene import Scene, corresponding, of_the_letter

BEST = ("frequency_hz", "excess", "m", "errors", "together")  # columns on the terminal
PLANE = "Standard errors by the best orbit at each frequency and excess; the best places are numbered."

ERRORS = {
    "free_period": ("free period", "standard error (µs)", 1e6),
    "decay_rate": ("decay rate", "standard error (1/s)", 1.0),
    "gap": ("gap", "standard error (mm)", 1e3),
    "restitution": ("restitution", "standard error", 1.0),
    "delay": ("time delay", "standard error (µs)", 1e6),
}
"""Parameter -> name, label and scale of its error."""


def where_to_measure(
    scene: Scene, run: Run, wanted: Sequence[str], delay: float | None, noise: float
) -> list[Measurement]:
    """The best places to measure the `wanted` parameters of Eq. (1) with a constant `delay` [s].

    Tables, figure and findings over the plane are stored, on the letter's scene with the letter's orbits.
    """
    before = {name: error for name, error in Plan().before.items() if name not in wanted}
    plan, thin = Plan(names=tuple(wanted), noise=noise, before=before), model.THIN[run.quick]
    of, letters = partial(described, scene, "two_parameters", delay), of_the_letter(scene)
    frequencies = [corresponding(scene, f) for f in model.FREQUENCIES_HZ[::thin]]
    work = partial(model.measurements_at, of, plan, model.EXCESSES[::thin])
    columns = run.map(work, frequencies, "frequencies")
    found = [one for column in columns for one in column]
    chosen = best(found)
    caption = f"Standard errors of {', '.join(plan.names)} by one orbit.".replace("_", " ")
    run.table("measurements", found, caption, of=Measurement, show=())
    run.table("next", chosen, f"The five best places. {caption}", of=Measurement, show=BEST)
    if found:
        run.figure("next", draw_plane(found, plan, letters), PLANE)
    own = model.letter_rows(of, plan) if letters else []
    if own:
        run.table("letter_orbits", own, "The same by the letter's orbits.", of=model.LetterOrbits)
    for sentence in model.findings(found, own if plan.names == Plan().names else []):
        run.finding(sentence)
    return chosen


def edges(centres: Array) -> Array:
    """Borders of cells around rising `centres`, halfway between them."""
    half = 0.5 * np.diff(centres) if centres.size > 1 else np.full(1, 0.5)
    return np.concatenate([centres[:1] - half[:1], centres[:-1] + half, centres[-1:] + half[-1:]])


@plotting.in_house_style
def draw_plane(found: Sequence[Measurement], plan: Plan, letters: bool) -> Figure:
    """The error of each wanted parameter over frequency and excess."""
    places = [(round(one.frequency_hz, 6), round(one.excess, 9)) for one in found]
    across, up = (sorted({place[i] for place in places}) for i in (0, 1))
    shape = {"width": plotting.PAGE, "height": 0.092}
    figure, axes = plotting.new_figure(1, len(plan.names), **shape, sharey=True, squeeze=False)
    cells = edges(np.array(across)), model.STABLE * np.sinh(edges(np.arcsinh(np.array(up) / model.STABLE)))
    shown = dict(sorted(zip(places, found, strict=True), key=lambda pair: (pair[1].kept, -pair[1].together)))
    marks = dict[str, Any]()
    for k, (axis, name) in enumerate(zip(axes.flat, plan.names, strict=True)):
        title, words, scale = ERRORS.get(name, (name.replace("_", " "), "standard error (SI units)", 1.0))
        seen, lost = np.full((2, len(up), len(across)), np.nan)
        for (f, excess), one in shown.items():
            error = list(one.errors.values())[k] * scale
            (seen if one.kept else lost)[up.index(excess), across.index(f)] = error
        if np.isfinite(lost).any():
            axis.pcolormesh(*cells, 0.0 * lost, cmap="Greys", vmin=-1.0, vmax=3.0)
            marks["orbit that does not outlive its errors"] = Patch(color=matplotlib.colormaps["Greys"](0.25))
        if np.isfinite(seen).any():
            mesh = axis.pcolormesh(*cells, seen, cmap="viridis_r", norm=LogNorm())
            ends = float(np.nanmin(seen)), float(np.nanmax(seen))
            ticks = np.outer(10.0 ** np.arange(-15.0, 15.0), (1.0, 3.0)).ravel()
            ticks = ticks[(ends[0] <= ticks) & (ticks <= ends[1])]
            ticks = ticks if ticks.size > 2 else np.unique(np.geomspace(*ends, 3))
            bar = figure.colorbar(mesh, ax=axis, location="bottom", label=words, ticks=ticks)
            bar.minorticks_off()
            bar.formatter = FuncFormatter(lambda tick, _: written(tick, 3))
        if letters:
            at = list(letter.PERIODS), [1e-3] * len(letter.PERIODS)
            (marks["letter, at an excess of 0.001"],) = axis.plot(*at, **plotting.LETTER_POINTS)
        for number, one in enumerate(best(found), 1):
            circle = {"boxstyle": "circle,pad=0.1", "fc": "white", "lw": 0.5}
            place = {"ha": "center", "va": "center", "fontsize": plotting.NOTE - 1.5, "bbox": circle}
            axis.annotate(str(number), (one.frequency_hz, one.excess), **place)
            ring = Line2D([], [], marker="o", mfc="white", mec="black", ls="none")
            marks["numbered: the best places, 1 the best"] = ring
        axis.set_yscale("symlog", linthresh=model.STABLE)
        axis.minorticks_off()
        axis.set_yticks(levels := (-1e-2, -1e-3, 0.0, 1e-3, 1e-2), map(written, levels))
        plotting.panel(axis, k, title)
        plotting.label(axis.xaxis, "drive frequency", "Hz")
    marks["white: no orbit"] = Patch(facecolor="white", edgecolor="0.5", linewidth=0.5)
    plotting.label(axes[0, 0].yaxis, plotting.EXCESS)
    figure.legend(marks.values(), marks.keys(), loc="outside lower center", ncols=2)
    return figure
