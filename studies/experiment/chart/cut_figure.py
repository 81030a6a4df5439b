"""Figures of the settled motions: strobe points and exponents of a scan, and basins on the strobe plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from studies.experiment.chart.basins import Starts, parts
from studies.experiment.chart.cut import CHAOTIC, NOT_SETTLED, PERIODIC, UNDECIDED, WITHOUT, Settlement
from studies.physics.descriptions import TITLES
from studies.shell import plotting
from studies.shell.plotting import BLUE, DOWN, EXCESS, GUIDE, ORANGE, PAGE, SKY, UP, VERMILION, tint

SCAN = (
    "Strobe points and largest Lyapunov exponent against the excess, for Eq. (1) and the beam. Filled: "
    "amplitude raised; open: lowered; pale: not periodic."
)
BASINS = (
    "Where starts on the strobe plane of Eq. (1) lead below grazing: the motion without impacts has a small "
    "basin, p_m the rest."
)
LOOKS = {
    WITHOUT: ("v", SKY),
    PERIODIC: ("o", BLUE),
    CHAOTIC: ("s", VERMILION),
    NOT_SETTLED: ("^", ORANGE),
    UNDECIDED: ("x", "0.5"),
}
"""Marker and colour of a kind."""


@plotting.in_house_style
def draw_scan(
    rows: Sequence[Settlement], strobes: Sequence[np.ndarray], frequency: float, quantity: str
) -> Figure:
    """Strobe points and exponents against the excess, a column for each model."""
    figure, axes = plotting.new_figure(2, 2, width=PAGE, height=0.112, sharex="col")
    for column, name in enumerate(("single_mode", "beam")):
        upper, lower = axes[:, column]
        for way, look in (("up", UP), ("down", DOWN)):
            mine = [k for k, row in enumerate(rows) if (row.model, row.direction) == (name, way)]
            excess, points = np.array([rows[k].excess for k in mine]), np.array([strobes[k] for k in mine])
            settled = np.array([rows[k].period > 0 for k in mine])
            plotting.strobe_points(upper, 1e2 * excess, 1e3 * points, settled, look, f"{way}ward scan")
        for kind, (marker, colour) in LOOKS.items():
            alike = [(1e2 * r.excess, r.lyapunov_map) for r in rows if (r.model, r.kind) == (name, kind)]
            look = {"markersize": 3.4, "mfc": "none", "markeredgecolor": colour}
            lower.plot(*np.array(alike).reshape(-1, 2).T, marker, **look, label=kind)
        lower.axhline(0.0, **GUIDE)
        for axis in (upper, lower):
            axis.axvline(0.0, **GUIDE)
        plotting.panel(upper, column, f"{TITLES[name]}, {frequency:.2f} Hz")
        plotting.panel(lower, column + 2)
        plotting.label(lower.xaxis, EXCESS, "%")
    plotting.label(axes[0, 0].yaxis, quantity, "mrad" if quantity == "rotation" else "mm")
    plotting.label(axes[1, 0].yaxis, "exponent per drive period")
    plotting.legend_below(figure, axes.flat, 3, markerscale=1.5)
    return figure


@plotting.in_house_style
def draw_basins(plane: Starts, leads: np.ndarray, frequency: float) -> Figure:
    """The strobe plane, coloured by where its points lead."""
    figure, axis = plotting.new_figure(height=0.088)
    oscillator, m = plane.strobed.oscillator, plane.period
    gap, speed = oscillator.stop.gap, oscillator.unit_speed
    looks = {
        m: (BLUE, f"to p$_{{{m}}}$"),
        1: (tint(SKY, 0.3), "to p$_1$ without impacts"),
        0: (ORANGE, "to something else"),
    }
    x, y, picture = plane.x / gap, plane.velocity / speed, np.full(leads.shape, np.nan)
    for place, code in enumerate(looks):
        picture[leads == code] = place
    colours = ListedColormap([colour for colour, _ in looks.values()])
    axis.pcolormesh(x, y, picture, vmin=-0.5, vmax=len(looks) - 0.5, cmap=colours, rasterized=True)
    for code in plane.orbits:
        look = {"color": VERMILION if code == 1 else "white", "markeredgecolor": "black", "markersize": 4}
        strobes = (plane.strobes(code) / (gap, speed)).T
        axis.plot(*strobes, "D" if code == 1 else "o", **look, label=f"p$_{{{code}}}$")
    for colour, words in looks.values():
        axis.fill([], [], facecolor=colour, edgecolor="0.4", label=words)
    share = 100 * parts(leads, m)["p1 without impacts"]
    title = f"Eq. (1), {frequency:.2f} Hz, $F/F_g - 1$ = {oscillator.excess:g}"
    axis.set_title(f"{title}\n{share:.1f} % lead to p$_1$")
    plotting.label(axis.xaxis, "$ξ$ / gap at the strobe")
    plotting.label(axis.yaxis, "$\\dot{ξ}$ / (2π f gap) at the strobe")
    plotting.legend_below(figure, [axis], 2)
    return figure
