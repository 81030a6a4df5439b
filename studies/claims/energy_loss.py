"""The p_m orbits against the energy lost in a collision: hysteresis, and their first bifurcation.

The free period T and the decay rate mu fix the map (Eqs. (2), (3)) at a drive frequency, with it the band m,
and the family of p_m orbits of Eq. (1) itself. At time s after its impact the tip of an orbit with approach
speed v is at

    x - gap = v G(s) - gap (1 - cos w s),   G = h - s_0 cos w s + b sin w s,

(s_0, b) the arms of the family, h the free motion per unit speed: linear in v. Hence the first orbit with a
second impact has v_2 = min over G > 0 of gap (1 - cos w s)/G(s). The trace of its multipliers is p + q/v, so
that the flip (multiplier -1) has v = -q/(1 + D + p), D their determinant. The secondary bifurcation of the
node p_m is the one of the two that comes first above its fold; the fold counts where its orbit has no second
impact. What falls with the loss is the hysteresis 1 - F_m/F_g in the drive amplitude; |rho_m| itself rises in
the map, because rho per F falls faster.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from contact import MaximalFamily, NordmarkMap, fold, maximal_period, stable_range
from studies import letter, plotting
from studies.run import Run
from studies.scene import Scene, corresponding, single_mode_at

__all__ = ["RESTITUTIONS", "Node", "energy_loss", "falls", "family_at", "flip_speed", "map_at", "node_at",
           "second_impact_speed", "trends"]  # fmt: skip

RESTITUTIONS = tuple(np.round(np.linspace(0.0, 0.9, 19), 3).tolist())
"""tau of the curves."""

SCANNED_HZ = (19.62, 23.75)
"""Across the bands of p3 to p16, for the letter's spring."""

ROUNDING = 1e-12
"""Change of an excess that is rounding."""

SLACK = 0.02
"""Change of a share of the scanned frequencies that is that of one cell or two."""

SEARCHED = 2000
"""Times of a drive period at which a second impact is looked for; G turns a few times in one."""


@dataclass(frozen=True, kw_only=True)
class Node:
    """The node p_m at one frequency and restitution, by the map and by Eq. (1); NaN where there is no fold.

    `fold`, `secondary`: F/F_g - 1 at its fold and at its first bifurcation (infinite: none); `rho`: rho_m;
    `admissible`: one impact at the fold of Eq. (1).
    """

    frequency_hz: float
    period: int
    restitution: float
    rho: float
    fold_of_map: float
    secondary_of_map: float
    fold: float
    secondary: float
    admissible: bool


def falls(values: Sequence[float]) -> bool:
    """Whether no value exceeds the one before it by more than rounding; a NaN does not fall."""
    return bool(np.all(np.diff(values) <= ROUNDING))


def map_at(scene: Scene, frequency: float, restitution: float) -> NordmarkMap:
    """The Nordmark map of the scene's mode at a drive frequency [Hz]."""
    mode = scene.single_mode
    return NordmarkMap.from_frequencies(
        drive_frequency=frequency, free_period=mode.free_period_s, decay_rate=mode.decay_rate_per_s,
        restitution=restitution,
    )  # fmt: skip


def family_at(scene: Scene, frequency: float, restitution: float, period: int) -> MaximalFamily:
    """The orbits p_m of Eq. (1), m = `period`, at a drive frequency [Hz]."""
    return MaximalFamily.from_oscillator(
        single_mode_at(scene, frequency), period=period, restitution=restitution
    )


def second_impact_speed(family: MaximalFamily) -> float:
    """v_2 [m/s] of a family of one mode, infinity if there is none."""
    model, gap = family.oscillator.model, family.oscillator.stop.gap
    duration, w = family.period * family.oscillator.period, family.oscillator.driven.angular_frequency
    half = 0.5 * float(model.decay_rate[0])
    damped = math.sqrt(float(model.omega[0]) ** 2 - half**2)
    height, rate = (float(entry) * float(model.phi[0]) for entry in family.orbit(1.0).after[0])
    s0, b = family.arms

    def ratio(s: NDArray[np.float64]) -> NDArray[np.float64]:
        free = height * np.cos(damped * s) + (rate + half * height) / damped * np.sin(damped * s)
        reach = np.exp(-half * s) * free - s0 * np.cos(w * s) + b * np.sin(w * s)
        held = gap * (1.0 - np.cos(w * s))
        return np.where(reach > 0.0, held / np.where(reach > 0.0, reach, 1.0), np.inf)

    # the ends are the impact itself, where both sides vanish and rounding decides
    times = np.linspace(0.0, duration, SEARCHED * family.period + 1)[1:-1]
    values = ratio(times)
    i = int(np.argmin(values))
    least = float(values[i])
    if not math.isfinite(least) or not 0 < i < times.size - 1:
        return least
    best = minimize_scalar(
        lambda s: float(ratio(np.asarray(s))), bounds=(times[i - 1], times[i + 1]), method="bounded",
        options={"xatol": 1e-12 * duration},
    )  # fmt: skip
    return min(float(best.fun), least)


def flip_speed(family: MaximalFamily) -> float:
    """Approach speed [m/s] of the multiplier -1 of a family of one mode, infinity if there is none."""
    unit = family.oscillator.unit_speed
    slow, fast = (family.orbit(v).monodromy() for v in (1e-3 * unit, unit))
    q = float(np.trace(slow) - np.trace(fast)) * unit / 999.0
    size = 1.0 + float(np.linalg.det(fast)) + float(np.trace(fast)) - q / unit
    speed = -q / size if size != 0.0 else math.inf
    return speed if speed > 0.0 else math.inf


def node_at(scene: Scene, frequency: float, restitution: float) -> Node:
    """The node of the period that belongs to this frequency."""
    nordmark = map_at(scene, frequency, restitution)
    m = maximal_period(nordmark)
    end, stable = fold(nordmark, m), stable_range(nordmark, m)
    family = family_at(scene, frequency, restitution, m)
    least, second, flip = family.fold(), second_impact_speed(family), flip_speed(family)
    if least is not None and flip <= least.speed:
        flip = math.inf
    first = min(second, flip)
    return Node(
        frequency_hz=frequency, period=m, restitution=restitution,
        rho=math.nan if end is None else end.rho,
        fold_of_map=math.nan if end is None else nordmark.excess(end.rho),
        secondary_of_map=math.nan if stable is None
        else nordmark.excess(stable[1]) if math.isfinite(stable[1]) else math.inf,
        fold=math.nan if least is None else least.excess,
        secondary=math.nan if least is None else family.excess(first) if math.isfinite(first) else math.inf,
        admissible=least is not None and second > least.speed,
    )  # fmt: skip


def line_of(scene: Scene, frequencies: Sequence[float], restitution: float) -> list[Node]:
    """The nodes of one restitution."""
    return [node_at(scene, frequency, restitution) for frequency in frequencies]


def energy_loss(scene: Scene, run: Run, *, across: int, restitutions: int) -> Mapping[str, object]:
    """Compute, store, draw and judge both claims."""
    drives = sorted(scene.drive.frequencies_hz)
    lines = run.map(partial(line_of, scene, drives), RESTITUTIONS, "p_m against loss")
    rows = [node for f in zip(*lines, strict=True) for node in f]
    low, high = (corresponding(scene, f) for f in SCANNED_HZ)
    frequencies = np.linspace(low, high, across)
    tau = np.linspace(0.0, 0.9, restitutions)
    plane = run.map(partial(line_of, scene, frequencies.tolist()), tau.tolist(), "plane of f and tau")
    below = np.array([
        np.mean([not math.isnan(n.fold) and (not n.admissible or n.secondary < 0.0) for n in line])
        for line in plane
    ])  # fmt: skip
    run.table("loss", rows, "Fold and first bifurcation of p_m, F/F_g - 1.", show=())
    run.figure("loss", draw_loss(rows), "Hysteresis against restitution at each frequency: a smaller "
               "restitution, more energy lost, less hysteresis, in the map and in Eq. (1).")  # fmt: skip
    run.figure("secondary", draw_secondary(rows, tau, below),
               "Excess of the secondary bifurcation in Eq. (1) against the restitution, and at which part of "
               "the frequencies it lies below grazing.")  # fmt: skip
    found = trends(rows)
    both = found["map"] and found["eq1"]
    parts = ", ".join(f"{name} {'yes' if good else 'no'}" for name, good in found.items())
    note = "" if found["rho"] else "the hysteresis in F falls; |rho_m| rises, for rho per F falls faster"
    run.verdict("loss", "differs" if not both else "agrees" if found["rho"] else "in part",
                found=f"falls with the loss: {parts}", note=note)  # fmt: skip
    lowest = float(np.nanmin([[node.secondary_of_map for node in line] for line in plane]))
    simple = [row for row in rows if row.admissible]
    falling = [f for f in drives if falls([row.secondary for row in simple if row.frequency_hz == f])]
    holds = bool(lowest > 0.0 and below[0] < below[-1] and np.all(np.diff(below) >= -SLACK))
    at = {t: float(np.interp(t, tau, below)) for t in (0.0, letter.RESTITUTION, 0.9)}
    shares = ", ".join(f"{100 * part:.0f} % at tau = {t:g}" for t, part in at.items())
    run.verdict(
        "secondary", "agrees" if holds else "differs",
        found=f"map: never below excess {lowest:.2g}; Eq. (1): below grazing in {shares}",
        note=f"at one frequency its excess falls throughout as tau grows at {len(falling)} of {len(drives)}",
    )  # fmt: skip
    return {
        "loss": {"falls": found, "holds": both},
        "secondary": {"holds": holds, "lowest_of_map": lowest, "restitution": tau,
                      "part_below_grazing": below, "falls_with_restitution_hz": falling},
    }  # fmt: skip


def trends(rows: Sequence[Node]) -> dict[str, bool]:
    """Whether the size of each quantity falls with the energy lost, at every frequency."""
    good = {"map": True, "eq1": True, "rho": True}
    for frequency in {row.frequency_hz for row in rows}:
        mine = sorted((r for r in rows if r.frequency_hz == frequency), key=lambda row: -row.restitution)
        good["map"] &= falls([-row.fold_of_map for row in mine])
        good["rho"] &= falls([-row.rho for row in mine])
        good["eq1"] &= falls([-row.fold for row in mine if row.admissible])
    return good


def curves(axis: Axes, rows: Sequence[Node], value: Callable[[Node], float]) -> None:
    """A value in percent against tau at each frequency."""
    for number, frequency in enumerate(sorted({row.frequency_hz for row in rows})):
        mine = [row for row in rows if row.frequency_hz == frequency]
        axis.plot(
            [row.restitution for row in mine], [1e2 * value(row) for row in mine], markevery=3,
            **plotting.series(number % 8), label=f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$",
        )  # fmt: skip
    plotting.label(axis.xaxis, "restitution τ")


@plotting.in_house_style
def draw_loss(rows: Sequence[Node]) -> Figure:
    """Hysteresis against tau, the map and Eq. (1)."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.072)
    curves(axes[0], rows, lambda row: -row.fold_of_map)
    curves(axes[1], rows, lambda row: -row.fold if row.admissible else math.nan)
    for place, (axis, title) in enumerate(zip(axes, ("Nordmark map", "Eq. (1)"), strict=True)):
        axis.set_yscale("log")
        axis.set_ylim(4e-3, 30.0)
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.98)
    plotting.label(axes[0].yaxis, plotting.HYSTERESIS, "%")
    plotting.legend_below(figure, axes[:1], 3)
    return figure


@plotting.in_house_style
def draw_secondary(rows: Sequence[Node], tau: NDArray[np.float64], below: NDArray[np.float64]) -> Figure:
    """The bifurcation against tau at each frequency, and at which part of the band it is below grazing."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.072)
    curves(axes[0], rows, lambda row: row.secondary if row.admissible else math.nan)
    axes[0].axhline(0.0, **plotting.GUIDE)
    axes[1].plot(tau, 1e2 * below, color=plotting.BLUE)
    plotting.label(axes[0].yaxis, "secondary bifurcation, excess", "%")
    plotting.label(axes[1].yaxis, "part of the frequencies", "%")
    plotting.label(axes[1].xaxis, "restitution τ")
    for place, (axis, title) in enumerate(zip(axes, ("Eq. (1)", "Eq. (1): below grazing"), strict=True)):
        plotting.panel(axis, place, title)
        plotting.mark_letter(axis.xaxis, letter.RESTITUTION, along=0.02)
    plotting.legend_below(figure, axes[:1], 3)
    return figure
