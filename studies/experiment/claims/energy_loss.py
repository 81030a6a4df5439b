"""The p_m orbits against the energy lost in a collision: hysteresis, and their first bifurcation.

The free period T and the decay rate mu fix the map (Eqs. (2), (3)) at a drive frequency, with it the band m,
and the family of p_m orbits of Eq. (1) itself, by its approach speed v. The secondary bifurcation of the node
p_m is where it first has a second impact, or a multiplier -1, above its fold. Either happens once along the
family: between two impacts x - gap is linear in v, and the trace of the multipliers is p + q/v. The fold
counts where its orbit has no second impact. What falls with the loss is the hysteresis 1 - F_m/F_g in the
drive amplitude; |rho_m| itself rises in the map, because rho per F falls faster.
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
from scipy.optimize import bisect

from contact import MaximalFamily, NordmarkMap, fold, maximal_period, stable_range
from contact.orbits import Orbit
from studies import letter
from studies.shell import plotting
from studies.shell.scene import Scene, corresponding, nordmark_at, single_mode_at
from studies.shell.study import Run

RESTITUTIONS = tuple(np.round(np.linspace(0.0, 0.9, 19), 3).tolist())
"""tau of the curves."""

SCANNED_HZ = (19.62, 23.75)
"""Across the bands of p3 to p16, for the letter's spring."""

ROUNDING = 1e-12
"""Change of an excess that is rounding."""

SLACK = 0.02
"""Change of a share of the scanned frequencies that is that of one cell or two."""

ABOVE, FASTEST, EXACT = 1e-6, 10.0, 1e-14
"""The bifurcation is looked for from next to the fold (relative) to this approach speed over 2 pi f gap, far
beyond the letter's amplitudes, to a relative accuracy."""


@dataclass(frozen=True, kw_only=True)
class Node:
    """The node p_m at one frequency and restitution, by the map and by Eq. (1); NaN where there is no fold.

    `fold`, `secondary`: F/F_g - 1 at its fold and at its first bifurcation (infinite: none); `rho`: rho_m;
    `admissible`: one impact at the fold of Eq. (1), otherwise the node is not there and has no `secondary`.
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


def lives(orbit: Orbit) -> bool:
    """Whether an orbit is stable and touches once in its period."""
    return orbit.admissible and orbit.stable


def family_at(scene: Scene, frequency: float, period: int) -> MaximalFamily:
    """The orbits p_m of Eq. (1), m = `period`, at a drive frequency [Hz]."""
    return MaximalFamily(oscillator=single_mode_at(scene, frequency), period=period)


def end_speed(family: MaximalFamily, fold: Orbit) -> float:
    """Approach speed [m/s] of the first bifurcation of the node above its fold, infinity if there is none."""
    low, high = (1.0 + ABOVE) * fold.speed, FASTEST * family.oscillator.unit_speed
    if not lives(family.orbit(low)):
        return low
    if lives(family.orbit(high)):
        return math.inf
    return float(bisect(lambda v: lives(family.orbit(v)) - 0.5, low, high, xtol=EXACT * low, rtol=EXACT))


def end_of_map(nordmark: NordmarkMap, period: int) -> float:
    """The excess of that of the map; NaN where p_m is not stable."""
    top = (stable_range(nordmark, period) or (math.nan, math.nan))[1]
    return nordmark.excess(top) if math.isfinite(top) else top


def node_at(scene: Scene, frequency: float) -> Node:
    """The node of the period that belongs to this frequency."""
    nordmark = nordmark_at(scene, frequency)
    m = maximal_period(nordmark)
    family, of_map = family_at(scene, frequency, m), fold(nordmark, m)
    least, end = family.fold(), math.nan
    if least is not None and least.admissible:
        end = end_speed(family, least)
    return Node(
        frequency_hz=frequency,
        period=m,
        restitution=nordmark.restitution,
        rho=math.nan if of_map is None else of_map.rho,
        fold_of_map=math.nan if of_map is None else of_map.excess,
        secondary_of_map=end_of_map(nordmark, m),
        fold=math.nan if least is None else least.excess,
        secondary=family.excess(end) if math.isfinite(end) else end,
        admissible=not math.isnan(end),
    )


def line_of(scene: Scene, frequencies: Sequence[float], restitution: float) -> list[Node]:
    """The nodes of one restitution."""
    changed = scene.replace({"single_mode.restitution": restitution})
    return [node_at(changed, frequency) for frequency in frequencies]


def below_grazing(scene: Scene, frequencies: Sequence[float], restitution: float) -> tuple[float, float]:
    """At which part of the frequencies the node of Eq. (1) has gone, by a secondary bifurcation, before
    grazing; and the lowest excess at which that of the map goes."""
    changed, gone, ends = scene.replace({"single_mode.restitution": restitution}), [], []
    for frequency in frequencies:
        nordmark = nordmark_at(changed, frequency)
        m = maximal_period(nordmark)
        at_grazing = family_at(changed, frequency, m).orbits(0.0)  # it has moved past its fold, if it has one
        gone.append(bool(at_grazing) and not lives(at_grazing[-1]))
        ends.append(end_of_map(nordmark, m))
    return float(np.mean(gone)), float(np.nanmin(ends))


def energy_loss(scene: Scene, run: Run, *, across: int, restitutions: int) -> Mapping[str, object]:
    """Compute, store, draw and judge both claims."""
    drives = sorted(scene.drive.frequencies_hz)
    lines = run.map(partial(line_of, scene, drives), RESTITUTIONS, "p_m against loss")
    rows = [node for f in zip(*lines, strict=True) for node in f]
    low, high = (corresponding(scene, f) for f in SCANNED_HZ)
    frequencies = np.linspace(low, high, across)
    tau = np.linspace(0.0, 0.9, restitutions)
    plane = run.map(partial(below_grazing, scene, frequencies.tolist()), tau.tolist(), "plane of f and tau")
    below = np.array([part for part, _ in plane])
    run.table("loss", rows, "Fold and first bifurcation of p_m, F/F_g - 1.", show=())
    run.figure(
        "loss",
        draw_loss(rows),
        "Hysteresis against restitution at each frequency: a smaller "
        "restitution, more energy lost, less hysteresis, in the map and in Eq. (1).",
    )
    run.figure(
        "secondary",
        draw_secondary(rows, tau, below),
        "Excess of the secondary bifurcation in Eq. (1) against the restitution, and at which part of "
        "the frequencies it lies below grazing.",
    )
    found = trends(rows)
    both = found["map"] and found["eq1"]
    parts = ", ".join(f"{name} {'yes' if good else 'no'}" for name, good in found.items())
    note = "" if found["rho"] else "the hysteresis in F falls; |rho_m| rises, for rho per F falls faster"
    run.verdict(
        "loss",
        "differs" if not both else "agrees" if found["rho"] else "in part",
        found=f"falls with the loss: {parts}",
        note=note,
    )
    lowest = float(np.nanmin([end for _, end in plane]))
    simple = [row for row in rows if row.admissible]
    falling = [f for f in drives if falls([row.secondary for row in simple if row.frequency_hz == f])]
    holds = bool(lowest > 0.0 and below[0] < below[-1] and np.all(np.diff(below) >= -SLACK))
    at = {t: float(np.interp(t, tau, below)) for t in (0.0, letter.RESTITUTION, 0.9)}
    shares = ", ".join(f"{100 * part:.0f} % at tau = {t:g}" for t, part in at.items())
    run.verdict(
        "secondary",
        "agrees" if holds else "differs",
        found=f"map: never below excess {lowest:.2g}; Eq. (1): below grazing in {shares}",
        note=f"at one frequency its excess falls throughout as tau grows at {len(falling)} of {len(drives)}",
    )
    return {
        "loss": {"falls": found, "holds": both},
        "secondary": {
            "holds": holds,
            "lowest_of_map": lowest,
            "restitution": tau,
            "part_below_grazing": below,
            "falls_with_restitution_hz": falling,
        },
    }


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
            [row.restitution for row in mine],
            [1e2 * value(row) for row in mine],
            markevery=3,
            **plotting.series(number % 8),
            label=f"{frequency:.2f} Hz, p$_{{{mine[0].period}}}$",
        )
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
