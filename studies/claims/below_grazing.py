"""Secondary bifurcations: above grazing in the map at any loss, below it in Eq. (1) with elastic collisions.

The first bifurcation of the node p_m above its fold (``equation_one``), against the restitution at the
frequencies of the scene, and the part of the plane of frequency and restitution where it is below grazing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from contact import maximal_period, maximal_periods
from studies import letter, plotting
from studies.claims.equation_one import (
    RESTITUTIONS,
    falls,
    family_at,
    map_at,
    secondary_of,
    secondary_of_map,
)
from studies.run import Run
from studies.scene import Scene, corresponding

__all__ = ["First", "Plane", "first_at", "plane_of", "secondary"]

SCANNED_HZ = (19.62, 23.75)
"""Across the bands of p3 to p16, for the letter's spring."""

ABOVE, BELOW, NOT_SIMPLE = 0.0, 1.0, 2.0
"""Of a cell of the plane: the bifurcation against grazing, or a fold that has a second impact already."""

SLACK = 0.02
"""Change of a share of the scanned frequencies that is that of one cell or two."""


@dataclass(frozen=True, kw_only=True)
class First:
    """The first secondary bifurcation at one frequency and restitution, F/F_g - 1; None where there is none.

    `map`, `eq1`: of both descriptions; `fold_eq1`: the fold below it; `admissible`: whether that is one orbit
    with one impact. `kind` is that of Eq. (1).
    """

    frequency_hz: float
    period: int
    restitution: float
    map: float | None
    eq1: float | None
    kind: str
    fold_eq1: float | None
    admissible: bool


@dataclass(frozen=True, kw_only=True)
class Plane:
    """`where`, shape (n_restitutions, n_frequencies): `ABOVE`, `BELOW`, `NOT_SIMPLE` or NaN (no fold)."""

    frequency_hz: NDArray[np.float64]
    restitution: NDArray[np.float64]
    where: NDArray[np.float64]
    lowest_of_map: float

    @property
    def below(self) -> NDArray[np.float64]:
        """Share of the frequencies at which the node is lost below grazing, for each restitution."""
        return np.asarray(np.nanmean(self.where > ABOVE, axis=1))


def first_at(scene: Scene, frequency: float, restitution: float) -> First:
    """One row, for the period that the band of tau = 0 has."""
    m = maximal_period(map_at(scene, frequency, 0.0))
    found = secondary_of(family_at(scene, frequency, restitution, m))
    return First(
        frequency_hz=frequency, period=m, restitution=restitution,
        map=secondary_of_map(map_at(scene, frequency, restitution), m),
        eq1=None if found is None else found.excess, kind="" if found is None else found.kind,
        fold_eq1=None if found is None else found.fold, admissible=found is not None and found.admissible,
    )  # fmt: skip


def _cell(scene: Scene, restitution: float, frequency: float) -> tuple[float, float]:
    """Kind of a cell of the plane, and the excess of the secondary bifurcation of the map there."""
    nordmark = map_at(scene, frequency, restitution)
    m = maximal_period(nordmark)
    other = secondary_of_map(nordmark, m) if m in maximal_periods(nordmark) else None
    found = secondary_of(family_at(scene, frequency, restitution, m))
    if found is None:
        kind = math.nan
    else:
        kind = NOT_SIMPLE if not found.admissible else BELOW if found.excess < 0.0 else ABOVE
    return kind, math.inf if other is None else other


def _line(scene: Scene, frequencies: NDArray[np.float64], restitution: float) -> NDArray[np.float64]:
    """The cells of one restitution, shape (n_frequencies, 2)."""
    return np.array([_cell(scene, restitution, frequency) for frequency in frequencies.tolist()])


def plane_of(scene: Scene, run: Run, across: int, restitutions: int) -> Plane:
    """The bands of p3 to p16 against the restitution."""
    low, high = (corresponding(scene, f) for f in SCANNED_HZ)
    frequencies, tau = np.linspace(low, high, across), np.linspace(0.0, 0.9, restitutions)
    cells = np.array(run.map(partial(_line, scene, frequencies), tau.tolist(), "plane of f and tau"))
    return Plane(
        frequency_hz=frequencies, restitution=tau, where=cells[:, :, 0], lowest_of_map=cells[:, :, 1].min()
    )


def secondary(scene: Scene, run: Run, *, across: int, restitutions: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    drives = sorted(scene.drive.frequencies_hz)
    rows = [
        first_at(scene, f, tau) for f in run.track(drives, "secondary bifurcations") for tau in RESTITUTIONS
    ]
    plane = plane_of(scene, run, across, restitutions)
    run.table("secondary", rows, "First bifurcation of p_m above its fold, F/F_g - 1.", show=())
    run.arrays(
        "secondary_plane", frequency_hz=plane.frequency_hz, restitution=plane.restitution, where=plane.where
    )
    run.figure(
        "secondary",
        draw(scene, rows, plane),
        "Excess of the secondary bifurcation in Eq. (1) against the"
        " restitution, and where it lies below grazing.",
    )
    below = plane.below
    falling = [f for f in drives if falls([r.eq1 for r in simple(rows, f) if r.eq1 is not None])]
    holds = bool(plane.lowest_of_map > 0.0 and below[0] < below[-1] and np.all(np.diff(below) >= -SLACK))
    at = {tau: float(np.interp(tau, plane.restitution, below)) for tau in (0.0, letter.RESTITUTION, 0.9)}
    shares = ", ".join(f"{100 * part:.0f} % at tau = {tau:g}" for tau, part in at.items())
    run.verdict(
        "secondary", "agrees" if holds else "differs",
        found=f"map: never below excess {plane.lowest_of_map:.2g}; Eq. (1): below grazing in {shares}",
        note=f"at one frequency its excess falls throughout as tau grows at {len(falling)} of {len(drives)}",
    )  # fmt: skip
    return {
        "holds": holds, "lowest_of_map": plane.lowest_of_map, "restitution": plane.restitution,
        "part_below_grazing": below, "falls_with_restitution_hz": falling,
    }  # fmt: skip


def simple(rows: Sequence[First], frequency: float) -> list[First]:
    """The rows of a frequency whose fold is that of an orbit with one impact."""
    return [row for row in rows if row.frequency_hz == frequency and row.admissible]


@plotting.in_house_style
def draw(scene: Scene, rows: Sequence[First], plane: Plane) -> Figure:
    """The bifurcation against tau, and the plane."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.084)
    for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
        mine = [row for row in simple(rows, frequency) if row.eq1 is not None]
        name = f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$" if mine else f"{frequency:.2f} Hz"
        axes[0].plot(
            [row.restitution for row in mine], [1e2 * (row.eq1 or 0.0) for row in mine], markevery=3,
            **plotting.series(number % 8), label=name,
        )  # fmt: skip
    axes[0].axhline(0.0, **plotting.GUIDE, gid="grazing")
    plotting.panel(axes[0], 0, "Eq. (1)")
    plotting.mark_letter(axes[0].xaxis, letter.RESTITUTION, along=0.02, turn=True, level=True)
    plotting.label(axes[0].xaxis, "restitution τ")
    plotting.label(axes[0].yaxis, "secondary bifurcation, excess", "%")
    colours = ListedColormap([plotting.tint(plotting.SKY, 0.3), plotting.BLUE, plotting.ORANGE])
    places = plane.frequency_hz * scene.single_mode.free_period_s
    picture = axes[1].pcolormesh(
        places, plane.restitution, plane.where, cmap=colours, vmin=-0.5, vmax=2.5, rasterized=True,
        shading="nearest", gid="0: above grazing; 1: below; 2: no simple p$_m$ at the fold",
    )  # fmt: skip
    for m in range(3, 11):
        if places[0] < 2 * m / (2 * m + 1) < places[-1]:
            axes[1].axvline(2 * m / (2 * m + 1), color="black", linewidth=0.5, gid=f"upper edge, m = {m}")
    axes[1].plot(
        [f * letter.FREE_PERIOD_S for f in letter.PERIODS], [letter.RESTITUTION] * len(letter.PERIODS),
        **plotting.LETTER_POINTS, label="letter",
    )  # fmt: skip
    plotting.panel(axes[1], 1, "Eq. (1): the secondary bifurcation is")
    plotting.label(axes[1].xaxis, "f T")
    plotting.label(axes[1].yaxis, "restitution τ")
    figure.legend(loc="outside lower center", ncols=4)
    bar = figure.colorbar(picture, ax=axes[1], ticks=[0, 1, 2], location="bottom", aspect=40, drawedges=False)
    bar.ax.set_xticklabels(["above grazing", "below grazing", "no simple p$_m$"])
    bar.outline.set_visible(False)  # type: ignore[operator]
    return figure
