"""Claim c (letter 1996): bands in the (alpha, gamma) plane, and the hysteresis across each of them.

"bands in the (alpha, gamma) parameter plane ... crossed approximately transversely"; "At the upper boundary
... there is no hysteresis. The hysteresis increases towards ... the lower-lying m - 1".  With
alpha = 2 sqrt(gamma) cos theta the band of p_m has its upper edge at theta = pi/m and its lower one at

    sin((m - 1) theta)/sin(theta) = -tau^2 gamma^(m/2).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact.maximal_orbits import band, fold
from studies.instruments.claims.single_mode_leaf import Leaf
from studies.instruments.claims.verdict import Claim, falls, frequencies_of
from studies.instruments.corresponding import corresponding
from studies.instruments.figures import (
    BLACK,
    BLUE,
    HYSTERESIS,
    LETTER,
    LETTER_POINTS,
    NOTE,
    PAGE,
    PALETTE,
    in_house_style,
    label,
    new_figure,
    panel,
)
from studies.instruments.scene import Scene
from studies.published import PERIODS

__all__ = ["SPAN_HZ", "bands_claim", "lower_angle"]

SPAN_HZ = (19.6, 23.8)
"""Where the letter measured, by its Figs. 3 and 5."""


def lower_angle(period: int, gamma: float, restitution: float) -> float:
    """theta at the lower edge of a band at fixed gamma: sin((m-1) theta)/sin(theta) = -tau^2 gamma^(m/2)."""
    m, ratio = period, restitution**2 * gamma ** (0.5 * period)
    if m == 2:
        return math.pi

    def height(past: float) -> float:
        return ratio * math.sin((math.pi + past) / (m - 1)) - math.sin(past)

    return (math.pi + float(brentq(height, 0.0, 0.5 * math.pi, xtol=1e-15))) / (m - 1)


@in_house_style
def bands_claim(scene: Scene, quick: bool) -> Claim:
    """c: bands in the (alpha, gamma) plane, the path of the experiment, and the hysteresis along it."""
    leaf, tau = Leaf.of(scene), scene.single_mode.restitution
    figure, axes = new_figure(1, 2, width=PAGE, height=0.070)
    gammas = np.linspace(0.02, 1.0, 80)
    for m in range(3, 9):
        angles = [[math.pi / m] * gammas.size, [lower_angle(m, float(g), tau) for g in gammas]]
        edges = [2.0 * np.sqrt(gammas) * np.cos(angle) for angle in angles]
        axes[0].fill_betweenx(gammas, edges[1], edges[0], color=PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4,
                              gid=f"band of p$_{{{m}}}$")
        axes[0].text(
            0.5 * (edges[0][-1] + edges[1][-1]),
            1.015,
            f"{m}",
            fontsize=NOTE,
            ha="center",
            va="bottom",
        )
    low, high = (corresponding(scene, f) for f in SPAN_HZ)
    path = np.linspace(low, high, 200)
    alpha = [leaf.map(f, tau).alpha for f in path.tolist()]
    gamma = [leaf.map(f, tau).gamma for f in path.tolist()]
    axes[0].plot(alpha, gamma, color="black", linewidth=1.4, gid=f"path from {low:g} to {high:g} Hz")
    places = [f for f in frequencies_of(scene)]
    axes[0].plot(
        [leaf.map(f, tau).alpha for f in places],
        [leaf.map(f, tau).gamma for f in places],
        **LETTER_POINTS,
        gid="letter",
        label="letter",
    )
    table: dict[str, list[Any]] = {n: [] for n in ("m", "frequency_hz", "map", "eq1")}
    zero, grows, ratios = [], {"map": True, "eq1": True}, {}
    for m in range(3, 12):
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        inside = np.linspace(edge.lower, edge.upper, 26 if quick else 101)[:-1]
        inside = np.append(inside, edge.upper - 1e-7 * (edge.upper - edge.lower))
        map_values, exact = [], []
        for f in inside.tolist():
            nordmark = leaf.map(f, tau)
            end, orbit = fold(nordmark, m), leaf.family(f, tau, m).fold()
            map_values.append(0.0 if end is None else -nordmark.excess(end.rho))
            exact.append(0.0 if orbit is None else -orbit.excess)
        table["m"] += [m] * inside.size
        table["frequency_hz"] += inside.tolist()
        table["map"] += map_values
        table["eq1"] += exact
        zero.append(max(map_values[-1], exact[-1]))
        grows["map"] &= falls(map_values)
        grows["eq1"] &= falls(exact)
        ratios[f"p{m}"] = {
            "lower_hz": edge.lower,
            "upper_hz": edge.upper,
            "map": map_values[0],
            "eq1": exact[0],
        }
        shown = (inside >= low) & (inside <= high)
        for values, style in ((map_values, "-"), (exact, "--")):
            axes[1].plot(
                inside[shown],
                1e2 * np.array(values)[shown],
                color=BLACK if style == "-" else BLUE,
                linestyle=style,
                linewidth=1.1,
                gid=f"{'Nordmark map' if style == '-' else 'Eq. (1)'}, m = {m}",
            )
        if m < 10:
            middle = max(edge.lower, low)
            axes[1].text(
                0.3 * edge.upper + 0.7 * middle,
                105.0 * exact[0] if edge.lower > low else 3.2,
                f"{m}",
                fontsize=NOTE,
                ha="left",
            )
    panel(axes[0], 0, "bands of p$_m$ as ρ → 0\n")
    label(axes[0].xaxis, "α")
    label(axes[0].yaxis, "γ")
    axes[0].annotate(
        f"{low:g} to {high:g} Hz",
        (alpha[60], gamma[60]),
        xytext=(0.05, 0.62),
        fontsize=NOTE,
        arrowprops={"arrowstyle": "-", "linewidth": 0.6},
    )
    panel(axes[1], 1, "hysteresis along the path\n")
    axes[1].plot([], [], color=BLACK, linestyle="-", label="Nordmark map")
    axes[1].plot([], [], color=BLUE, linestyle="--", label="Eq. (1)")
    label(axes[1].xaxis, "drive frequency", "Hz")
    label(axes[1].yaxis, HYSTERESIS, "%")
    for f in PERIODS:
        axes[1].axvline(f, **LETTER, gid="letter", label="letter, Fig. 2" if f == min(PERIODS) else None)
    axes[0].legend(loc="lower right")
    axes[1].legend(loc="upper right", frameon=True, framealpha=1.0, edgecolor="white")
    crossed = sorted({leaf.period(f, tau) for f in path.tolist()})
    holds = max(zero) < 1e-9 and all(grows.values())
    return Claim(
        holds=holds,
        table=table,
        figure=figure,
        numbers={
            "bands": ratios,
            "crossed": crossed,
            "largest_at_upper_edge": max(zero),
            "grows": grows,
            "alpha": [alpha[0], alpha[-1]],
            "gamma": [gamma[0], gamma[-1]],
        },
        sentence=(
            f"From {low:g} to {high:g} Hz the experiment crosses the bands m = {crossed[0]} to "
            f"{crossed[-1]}: alpha from {alpha[0]:.2f} to {alpha[-1]:.2f}, gamma from {gamma[0]:.3f} to "
            f"{gamma[-1]:.3f}; "
            "in each of p3 to p11 the hysteresis is zero at the upper edge and "
            f"{'grows' if all(grows.values()) else 'does not always grow'} towards the lower."
        ),
    )
