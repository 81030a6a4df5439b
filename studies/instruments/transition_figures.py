"""Orbit diagrams of the six transitions, as in the letter's Fig. 2, and their points as tables.

Filled points are the upward scan, open ones the downward scan, against the amplitude of the base [mm] (for
the map: against the excess); the dashed line is grazing, the grey band around it as wide as the amplitude of
the letter was stable.  A grey line marks an amplitude at which the motion did not settle: its points, those
of a moment, are stored but not drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.command_line import Request
from studies.instruments.figures import (
    BLUE,
    EXCESS,
    GUIDE,
    PAGE,
    VERMILION,
    in_house_style,
    label,
    new_figure,
    panel,
)
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M

__all__ = ["draw", "store_points"]


@in_house_style
def draw(
    scene: Scene, rows: Sequence[Mapping[str, Any]], diagrams: Sequence[Mapping[str, Any]], name: str
) -> Any:
    """The six panels of the letter's Fig. 2 for one description."""
    columns = min(3, len(rows))
    lines = math.ceil(len(rows) / columns)
    figure, axes = new_figure(lines, columns, width=PAGE, height=0.055 * lines + 0.012, squeeze=False)
    for axis in axes.flat[len(rows) :]:
        axis.set_visible(False)
    for number, (axis, row, found) in enumerate(zip(axes.flat, rows, diagrams, strict=False)):
        grazing = single_mode_oscillator(scene, row["frequency_hz"]).grazing_amplitude()
        if name == "beam":
            grazing = row["grazing_amplitude_m"]
        moving: list[float] = []
        for way, face, size in (("down", "none", 3.2), ("up", BLUE, 2.0)):
            diagram = found[name][way]
            amplitude = 1e3 * (grazing * (1.0 + diagram.excess) if name != "map" else diagram.excess)
            settled = diagram.period > 0
            x = np.repeat(amplitude[settled, None], diagram.points.shape[1], axis=1)
            y = diagram.points[settled] * (1e3 if name != "map" else 1.0)
            moving += [a for a, kind in zip(amplitude, diagram.kind, strict=True) if kind == "not settled"]
            axis.plot(
                x.ravel(), y.ravel(), linestyle="none", marker="o", markersize=size, markeredgewidth=0.5,
                markerfacecolor=face, markeredgecolor=BLUE if way == "up" else VERMILION,
                label=f"{way}ward scan", rasterized=True, zorder=2 if way == "down" else 3,
            )
        for place, unsettled in enumerate(sorted(set(moving))):
            axis.axvline(unsettled, color="0.75", linewidth=0.5, zorder=1, gid="not settled",
                         label="_" if place else "not settled")
        at, stable = (0.0, AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M)
        if name != "map":
            at, stable = grazing, AMPLITUDE_STABILITY_M
        axis.axvspan(1e3 * (at - stable), 1e3 * (at + stable), color="0.88", linewidth=0, zorder=0,
                     gid="amplitude stability of the letter", label="letter: stability of the amplitude")
        axis.axvline(1e3 * at, **GUIDE, gid="grazing", label="grazing")
        period = f"p$_{{{row[name]}}}$" if row[name] else "no period"
        seen = row.get("letter")
        letter = "" if seen is None else f" (letter: p$_{{{seen}}}$)"
        panel(axis, number, f"{row['frequency_hz']:.2f} Hz: {period}{letter}")
        axis.locator_params(axis="x", nbins=4)
    quantities = {
        "map": ((EXCESS, "10$^{-3}$"), ("$x$ of the map", "1")),
        "single_mode": (("excitation amplitude", "mm"), ("tip displacement $ξ$", "mm")),
        "beam": (("excitation amplitude", "mm"), ("read-out displacement", "mm")),
    }
    if name == "beam" and scene.readout.quantity == "rotation":
        quantities["beam"] = (quantities["beam"][0], ("read-out rotation", "mrad"))
    sideways, upwards = quantities[name]
    series: dict[str, Any] = {}
    for axis in axes.flat[: len(rows)]:
        series = dict(zip(*axis.get_legend_handles_labels()[::-1], strict=True)) | series
    order = ("upward scan", "downward scan", "letter: stability of the amplitude", "grazing", "not settled")
    names = [name for name in order if name in series]
    for axis in axes[-1, :]:
        label(axis.xaxis, *sideways)
    for axis in axes[:, 0]:
        label(axis.yaxis, *upwards)
    figure.legend([series[name] for name in names], names, loc="outside lower center", ncols=len(names),
                  markerscale=1.5)
    return figure


def store_points(
    request: Request, rows: Sequence[Mapping[str, Any]], diagrams: Sequence[Mapping[str, Any]]
) -> None:
    """The points of all scans, as npz, and periods against amplitude as csv."""
    arrays: dict[str, np.ndarray] = {}
    table: dict[str, list[Any]] = {
        name: []
        for name in ("frequency_hz", "model", "direction", "excess", "kind", "period", "impacts", "cycles")
    }
    for row, found in zip(rows, diagrams, strict=True):
        for name, ways in found.items():
            for way, diagram in ways.items():
                kinds = diagram.kind
                stem = f"{name}_{row['frequency_hz']:.2f}_hz_{way}".replace(".", "p")
                arrays[f"{stem}_excess"], arrays[f"{stem}_points"] = diagram.excess, diagram.points
                for i in range(diagram.excess.size):
                    values = (
                        row["frequency_hz"], name, way, float(diagram.excess[i]), kinds[i],
                        int(diagram.period[i]), int(diagram.impacts[i]), int(diagram.cycles[i]),
                    )
                    for column, value in zip(table.values(), values, strict=True):
                        column.append(value)
    request.record.write_arrays("orbit_diagram", **arrays)
    request.record.write_table("orbit_diagram", table)
