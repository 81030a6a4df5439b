"""Bands of p_m in the (alpha, gamma) plane, and the hysteresis across each of them.

With alpha = 2 sqrt(gamma) cos(theta) the band of p_m has its upper edge in frequency at theta = pi/m and its
lower one at

    sin((m - 1) theta)/sin(theta) = -tau^2 gamma^(m/2).

In frequency both are those of ``contact.band``; the hysteresis is the fold of p_m of the map and of Eq. (1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

from contact import Band, band, fold, maximal_period
from studies import letter, plotting
from studies.claims.equation_one import falls, family_at, map_at
from studies.run import Run
from studies.scene import Scene, corresponding

__all__ = ["Inside", "Path", "band_of", "bands", "inside_band", "lower_angle", "path_of"]

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


@dataclass(frozen=True, kw_only=True)
class Path:
    """What the drive frequency crosses: alpha and gamma of the map, and the m of its band."""

    frequency_hz: float
    alpha: float
    gamma: float
    period: int


def band_of(scene: Scene, period: int) -> Band:
    """The band of p_m of the scene's mode."""
    mode = scene.single_mode
    return band(period, free_period=mode.free_period_s, decay_rate=mode.decay_rate_per_s,
                restitution=mode.restitution)  # fmt: skip


def lower_angle(period: int, gamma: float, restitution: float) -> float:
    """theta at the lower edge of a band at fixed gamma [rad]."""
    m, ratio = period, restitution**2 * gamma ** (0.5 * period)
    if m == 2:
        return math.pi

    def height(past: float) -> float:
        return ratio * math.sin((math.pi + past) / (m - 1)) - math.sin(past)

    return (math.pi + float(brentq(height, 0.0, 0.5 * math.pi, xtol=1e-15))) / (m - 1)


def inside_band(scene: Scene, period: int, count: int) -> list[Inside]:
    """The hysteresis from the lower edge of a band to just below its upper one."""
    edges, tau, rows = band_of(scene, period), scene.single_mode.restitution, []
    places = np.linspace(edges.lower, edges.upper, count)
    places[-1] = edges.upper - EDGE * (edges.upper - edges.lower)
    for frequency in places.tolist():
        nordmark = map_at(scene, frequency, tau)
        end, orbit = fold(nordmark, period), family_at(scene, frequency, tau, period).fold()
        rows.append(Inside(
            period=period, frequency_hz=frequency, map=0.0 if end is None else -nordmark.excess(end.rho),
            eq1=0.0 if orbit is None else -orbit.excess,
        ))  # fmt: skip
    return rows


def path_of(scene: Scene, frequencies: Sequence[float]) -> list[Path]:
    """The path of the experiment through the plane."""
    maps = [map_at(scene, f, scene.single_mode.restitution) for f in frequencies]
    return [
        Path(frequency_hz=f, alpha=one.alpha, gamma=one.gamma, period=maximal_period(one))
        for f, one in zip(frequencies, maps, strict=True)
    ]


def bands(scene: Scene, run: Run, *, inside: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    rows = [row for m in run.track(PERIODS, "bands") for row in inside_band(scene, m, inside)]
    low, high = (corresponding(scene, f) for f in SPAN_HZ)
    path = path_of(scene, np.linspace(low, high, 200).tolist())
    run.table("bands", rows, "Hysteresis 1 - F_m/F_g across the bands of p_m.", show=())
    run.arrays("bands_path", frequency_hz=[p.frequency_hz for p in path], alpha=[p.alpha for p in path],
               gamma=[p.gamma for p in path])  # fmt: skip
    run.figure(
        "bands",
        draw(scene, rows, path),
        "Bands of p_m in the plane of alpha and gamma with the path of the"
        " experiment, and the hysteresis along that path.",
    )
    grows = {"map": True, "eq1": True}
    for m in PERIODS:
        grows["map"] &= falls([row.map for row in rows if row.period == m])
        grows["eq1"] &= falls([row.eq1 for row in rows if row.period == m])
    edges = [band_of(scene, m) for m in PERIODS]
    lowest = [next(row for row in rows if row.period == m) for m in PERIODS]
    uppermost = [[row for row in rows if row.period == m][-1] for m in PERIODS]
    zero = max(max(row.map, row.eq1) for row in uppermost)
    crossed = sorted({place.period for place in path})
    holds = zero < 1e-9 and all(grows.values())
    run.verdict(
        "bands", "agrees" if holds else "differs",
        found=f"m = {crossed[0]} to {crossed[-1]} from {low:g} to {high:g} Hz; hysteresis at the upper"
        f" edges of p3 to p11 at most {zero:.1g}, growing towards the lower:"
        f" {'yes' if all(grows.values()) else 'no'}",
        note=f"alpha from {path[0].alpha:.2f} to {path[-1].alpha:.2f}, gamma from {path[0].gamma:.3f} to"
        f" {path[-1].gamma:.3f}: the bands are crossed at almost constant gamma",
    )  # fmt: skip
    return {
        "holds": holds, "bands": edges, "at_lower_edge": lowest, "largest_at_upper_edge": zero,
        "crossed": crossed, "grows": grows, "path": [path[0], path[-1]],
    }  # fmt: skip


@plotting.in_house_style
def draw(scene: Scene, rows: Sequence[Inside], path: Sequence[Path]) -> Figure:
    """The plane and the hysteresis."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.070)
    _plane(axes[0], scene, path)
    low, high = path[0].frequency_hz, path[-1].frequency_hz
    for name, colour, line, title in (
        ("map", plotting.BLACK, "-", "Nordmark map"), ("eq1", plotting.BLUE, "--", "Eq. (1)"),
    ):  # fmt: skip
        for m in PERIODS:
            shown = [row for row in rows if row.period == m and low <= row.frequency_hz <= high]
            axes[1].plot(
                [row.frequency_hz for row in shown], [1e2 * getattr(row, name) for row in shown],
                color=colour, linestyle=line, linewidth=1.1, label=title if m == PERIODS[0] else None,
                gid=f"{title}, m = {m}",
            )  # fmt: skip
    for m in PERIODS[:-2]:
        edges = band_of(scene, m)
        first = next(row for row in rows if row.period == m)
        axes[1].text(
            0.3 * edges.upper + 0.7 * max(edges.lower, low), 105.0 * first.eq1 if edges.lower > low else 3.2,
            f"{m}", fontsize=plotting.NOTE, ha="left",
        )  # fmt: skip
    for f in letter.PERIODS:
        first_one = f == min(letter.PERIODS)
        axes[1].axvline(f, **plotting.LETTER, gid="letter", label="letter, Fig. 2" if first_one else None)
    plotting.panel(axes[1], 1, "hysteresis along the path\n")
    plotting.label(axes[1].xaxis, "drive frequency", "Hz")
    plotting.label(axes[1].yaxis, plotting.HYSTERESIS, "%")
    axes[0].legend(loc="lower right")
    axes[1].legend(loc="upper right", frameon=True, framealpha=1.0, edgecolor="white")
    return figure


def _plane(axis: Axes, scene: Scene, path: Sequence[Path]) -> None:
    """The bands as rho -> 0 and the path of the experiment."""
    gammas, tau = np.linspace(0.02, 1.0, 80), scene.single_mode.restitution
    for m in range(3, 9):
        upper = 2.0 * np.sqrt(gammas) * math.cos(math.pi / m)
        lower = [2.0 * math.sqrt(g) * math.cos(lower_angle(m, g, tau)) for g in gammas.tolist()]
        axis.fill_betweenx(gammas, lower, upper, color=plotting.PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4,
                           gid=f"band of p$_{{{m}}}$")  # fmt: skip
        middle = 0.5 * (upper[-1] + lower[-1])
        axis.text(middle, 1.015, f"{m}", fontsize=plotting.NOTE, ha="center", va="bottom")
    axis.plot([p.alpha for p in path], [p.gamma for p in path], color="black", linewidth=1.4, gid="path")
    places = path_of(scene, sorted(scene.drive.frequencies_hz))
    axis.plot([p.alpha for p in places], [p.gamma for p in places], **plotting.LETTER_POINTS, label="letter")
    axis.annotate(
        f"{path[0].frequency_hz:g} to {path[-1].frequency_hz:g} Hz", (path[60].alpha, path[60].gamma),
        xytext=(0.05, 0.62), fontsize=plotting.NOTE, arrowprops={"arrowstyle": "-", "linewidth": 0.6},
    )  # fmt: skip
    plotting.panel(axis, 0, "bands of p$_m$ as ρ → 0\n")
    plotting.label(axis.xaxis, "α")
    plotting.label(axis.yaxis, "γ")
