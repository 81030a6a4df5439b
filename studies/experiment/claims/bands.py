"""Bands of p_m in the (alpha, gamma) plane, and the hysteresis across each of them.

With alpha = 2 sqrt(gamma) cos(theta) and gamma = exp(-mu/f) the edges in frequency of ``contact.band`` are
curves in that plane, drawn with mu as parameter; the experiment crosses them along its own mu. The hysteresis
is the fold of p_m of the map and of Eq. (1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact import NordmarkMap, StroboscopicMap, band, maximal_period
from contact.orbits import fold_excess
from studies import letter
from studies.experiment.claims.energy_loss import falls
from studies.shell import plotting
from studies.shell.scene import Scene, band_of, corresponding, nordmark_at, single_mode_at
from studies.shell.study import Run

SPAN_HZ = (19.6, 23.8)
"""Where the letter measured, by its Figs. 3 and 5."""

PERIODS = range(3, 12)
"""Bands whose hysteresis is computed."""

EDGE = 1e-7
"""Distance of the last frequency from the upper edge, relative to the band."""


@dataclass(frozen=True, kw_only=True)
class Inside:
    """Hysteresis 1 - F_m/F_g at a frequency of the band of p_m, map and Eq. (1); 0 without a fold."""

    period: int
    frequency_hz: float
    map: float
    eq1: float


def inside_band(scene: Scene, period: int, count: int) -> list[Inside]:
    """The hysteresis from the lower edge of a band to just below its upper one."""
    edges, rows = band_of(scene, period), []
    places = np.linspace(edges.lower, edges.upper, count)
    places[-1] = edges.upper - EDGE * (edges.upper - edges.lower)
    for frequency in places.tolist():
        of_map = fold_excess(nordmark_at(scene, frequency), period)
        of_eq1 = fold_excess(StroboscopicMap(oscillator=single_mode_at(scene, frequency)), period)
        rows.append(
            Inside(
                period=period, frequency_hz=frequency, map=0.0 - (of_map or 0.0), eq1=0.0 - (of_eq1 or 0.0)
            )
        )
    return rows


def bands(scene: Scene, run: Run, *, inside: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    rows = [row for m in run.track(PERIODS, "bands") for row in inside_band(scene, m, inside)]
    low, high = (corresponding(scene, f) for f in SPAN_HZ)
    path = [nordmark_at(scene, f) for f in np.linspace(low, high, 200).tolist()]
    run.table("bands", rows, "Hysteresis 1 - F_m/F_g across the bands of p_m.", show=())
    run.figure(
        "bands",
        draw(scene, rows, path, (low, high)),
        "Bands of p_m in the plane of alpha and "
        "gamma with the path of the experiment, and the hysteresis along that path.",
    )
    of_band = {m: [row for row in rows if row.period == m] for m in PERIODS}
    grows = {
        name: all(falls([getattr(row, name) for row in own]) for own in of_band.values())
        for name in ("map", "eq1")
    }
    zero = max(max(own[-1].map, own[-1].eq1) for own in of_band.values())
    crossed = sorted({maximal_period(place) for place in path})
    holds = zero < 1e-9 and all(grows.values())
    run.verdict(
        "bands",
        "agrees" if holds else "differs",
        found=f"m = {crossed[0]} to {crossed[-1]} from {low:g} to {high:g} Hz;"
        f" hysteresis at the upper edges of p3 to p11 at most {zero:.1g}, growing towards the lower:"
        f" {'yes' if all(grows.values()) else 'no'}",
        note=f"alpha from {path[0].alpha:.2f} to {path[-1].alpha:.2f}, gamma from {path[0].gamma:.3f} to"
        f" {path[-1].gamma:.3f}: the bands are crossed at almost constant gamma",
    )
    return {
        "holds": holds,
        "bands": [band_of(scene, m) for m in PERIODS],
        "at_lower_edge": [own[0] for own in of_band.values()],
        "largest_at_upper_edge": zero,
        "crossed": crossed,
        "grows": grows,
    }


@plotting.in_house_style
def draw(
    scene: Scene, rows: Sequence[Inside], path: Sequence[NordmarkMap], span: tuple[float, float]
) -> Figure:
    """The plane and the hysteresis."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.070)
    draw_plane(axes[0], scene, path)
    low, high = span
    axes[0].annotate(
        f"{low:g} to {high:g} Hz",
        (path[60].alpha, path[60].gamma),
        xytext=(0.05, 0.62),
        fontsize=plotting.NOTE,
        arrowprops={"arrowstyle": "-", "linewidth": 0.6},
    )
    for m in PERIODS:
        shown = [row for row in rows if row.period == m and low <= row.frequency_hz <= high]
        frequency, names = [row.frequency_hz for row in shown], m == PERIODS[0]
        axes[1].plot(
            frequency,
            [1e2 * row.map for row in shown],
            color=plotting.BLACK,
            linewidth=1.1,
            label="Nordmark map" if names else None,
        )
        axes[1].plot(
            frequency,
            [1e2 * row.eq1 for row in shown],
            color=plotting.BLUE,
            linestyle="--",
            linewidth=1.1,
            label="Eq. (1)" if names else None,
        )
        if shown and m < PERIODS[-2]:
            whole = rows[[row.period for row in rows].index(m)].frequency_hz >= low
            axes[1].text(
                0.7 * frequency[0] + 0.3 * frequency[-1],
                105.0 * shown[0].eq1 if whole else 3.2,
                f"{m}",
                fontsize=plotting.NOTE,
            )
    for f in letter.PERIODS:
        axes[1].axvline(f, **plotting.LETTER, label="letter, Fig. 2" if f == min(letter.PERIODS) else None)
    plotting.panel(axes[1], 1, "hysteresis along the path\n")
    plotting.label(axes[1].xaxis, "drive frequency", "Hz")
    plotting.label(axes[1].yaxis, plotting.HYSTERESIS, "%")
    axes[1].legend(loc="upper right", frameon=True, framealpha=1.0, edgecolor="white")
    return figure


def draw_plane(axis: Axes, scene: Scene, path: Sequence[NordmarkMap]) -> None:
    """The bands as rho -> 0 and the path of the experiment."""
    mode, rates = scene.single_mode, np.geomspace(100.0, 1e-3, 80)
    for m in range(3, 9):
        edges = [
            band(m, free_period=mode.free_period_s, decay_rate=mu, restitution=mode.restitution)
            for mu in rates.tolist()
        ]
        f = np.array([*(one.upper for one in edges), *(one.lower for one in edges[::-1])])
        gamma = np.exp(-np.concatenate([rates, rates[::-1]]) / f)
        alpha = 2.0 * np.sqrt(gamma) * np.cos(2.0 * math.pi / (f * mode.free_period_s))
        axis.fill(alpha, gamma, color=plotting.PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4)
        axis.text(0.5 * (alpha[79] + alpha[80]), 1.015, f"{m}", fontsize=plotting.NOTE, ha="center")
    axis.plot([p.alpha for p in path], [p.gamma for p in path], color="black", linewidth=1.4)
    own = [nordmark_at(scene, f) for f in sorted(scene.drive.frequencies_hz)]
    axis.plot([p.alpha for p in own], [p.gamma for p in own], **plotting.LETTER_POINTS, label="letter")
    axis.set_ylim(bottom=0.02)
    plotting.panel(axis, 0, "bands of p$_m$ as ρ → 0\n")
    plotting.label(axis.xaxis, "α")
    plotting.label(axis.yaxis, "γ")
    axis.legend(loc="lower right")
