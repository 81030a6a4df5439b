"""The chart as a figure: upward scan left, downward scan right; period above, impacts in a period below.

Colours and numbers come from ``period_colours``, the upright axis from ``model.sheared``.

Figures of the settled motions: strobe points and exponents of a scan, and basins on the strobe plane.
"""

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_hex
from matplotlib.figure import Figure
from numpy.typing import NDArray

from contact import Band, plots
from studies.experiment.chart import settled
from studies.experiment.chart.model import Fold, Plane, sheared
from studies.experiment.period_colours import key, key_of_periods, paint
from studies.physics.descriptions import TITLES
from studies.shell import plotting
from studies.shell.digits import written

CLASSES = {1: "1", 2: "2", 3: "3", 4: "4\u20135", 6: "6\u20138", 9: "9 or more"}
"""Classes of impacts in a period: lower end and name."""
VIRIDIS = matplotlib.colormaps["viridis"]
IMPACTS = ["white", *map(to_hex, VIRIDIS(np.linspace(1.0, 0.1, len(CLASSES))))]

EDGE, MARKED = 0.0006, 10
"""Distance of the marks for band edges from grazing, where they hold [excess]; largest m of a mark."""

TICKS = (-0.1, -0.03, -0.01, -0.003, 0.0, 0.003, 0.01, 0.03, 0.1)

CAPTION = (
    "Period (above) and impacts in a period (below) over drive frequency and excess, in the upward scan "
    "(left) and the downward scan (right). The lines are exact folds, the ticks band edges of the map."
)

Integers = NDArray[np.int32]


@plotting.in_house_style
def draw(
    plane: Plane, cells: Mapping[str, Integers], edges: Sequence[Band], folds: Sequence[Fold], name: str
) -> Figure:
    """The figure."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.150, sharex=True, sharey=True)
    x, y = plane.frequencies(), sheared(plane.rising_excesses())
    names, struck = ["", *CLASSES.values()], np.where(cells["impacts"] > 0, cells["m"], 0)
    classes = np.searchsorted(list(CLASSES), cells["impacts"], side="right")
    for k, way in enumerate(("upward scan", "downward scan")):
        period = cells["m"][k]
        paint(axes[0, k], x, y, period, struck[k])
        paint(axes[1, k], x, y, period, classes[k], colours=IMPACTS, words=names.__getitem__)
        for axis in axes[:, k]:
            _draw_theory(axis, edges, folds)
            axis.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        plotting.panel(axes[0, k], k, f"{name}, {way}: period")
        plotting.panel(axes[1, k], 2 + k, f"{name}, {way}: impacts")
        plotting.label(axes[1, k].xaxis, "drive frequency", "Hz")
    for axis in axes[:, 0]:
        axis.set_yticks(sheared(TICKS), [written(t) for t in TICKS])
        plotting.label(axis.yaxis, plotting.EXCESS)
    key_of_periods(axes[0, 1], cells["m"], struck)
    seen, failed = np.unique(classes[struck > 0]).tolist(), bool(np.any(cells["m"] < 0))
    key(axes[1, 1], "impacts", {names[k]: IMPACTS[k] for k in seen}, failed)
    plotting.legend_below(figure, axes.flat, 4)
    return figure


def _draw_theory(axis: Axes, edges: Sequence[Band], folds: Sequence[Fold]) -> None:
    """Grazing, the band edges there, and the folds."""
    axis.axhline(0.0, color="0.5", linewidth=0.6, label="grazing")
    for name, place, marker in (("upper", EDGE, "v"), ("lower", -EDGE, "^")):
        places = [getattr(band, name) for band in edges if band.m <= MARKED]
        look: plotting.Style = {"color": "black", "markeredgecolor": "white", "linestyle": "none"}
        height = np.full(len(places), sheared(place))
        axis.plot(places, height, marker, markersize=4, **look, label=f"{name} band edge, map (m ≤ {MARKED})")
    for period in sorted({fold.m for fold in folds}):
        curve = [fold for fold in folds if fold.m == period]
        f, excess = [fold.frequency_hz for fold in curve], sheared([fold.excess for fold in curve])
        axis.plot(f, excess, color="white", linewidth=1.8)
        axis.plot(f, excess, color="black", linewidth=0.9, label="exact fold of p$_m$")


SCAN = (
    "Strobe points and largest Lyapunov exponent while the amplitude is raised and lowered, for Eq. (1) and "
    "the beam; above zero the motion is chaotic."
)
BASINS = "Where starts on the strobe plane of Eq. (1) lead below grazing: to p_m, or to no impacts at all."
LOOKS = {
    settled.WITHOUT: ("v", plotting.SKY),
    settled.PERIODIC: ("o", plotting.BLUE),
    settled.CHAOTIC: ("s", plotting.VERMILION),
    settled.NOT_SETTLED: ("^", plotting.ORANGE),
    settled.UNDECIDED: ("x", "0.5"),
}
"""Marker and colour of a kind."""


@plotting.in_house_style
def draw_scan(
    rows: Sequence[settled.Settlement], strobes: Sequence[np.ndarray], frequency: float, quantity: str
) -> Figure:
    """Strobe points and exponents against the excess, a column for each model."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.112, sharex="col")
    for column, name in enumerate(("single_mode", "beam")):
        upper, lower = axes[:, column]
        for way, look in (("up", plotting.UP), ("down", plotting.DOWN)):
            mine = [k for k, row in enumerate(rows) if (row.model, row.direction) == (name, way)]
            excess, points = np.array([rows[k].excess for k in mine]), np.array([strobes[k] for k in mine])
            periodic = np.array([rows[k].m > 0 for k in mine])
            words = {"label": f"{way}ward scan", "pale": "pale: not periodic"}
            plots.strobes(upper, 1e2 * excess, 1e3 * points, periodic, **look, **words)
        for kind, (marker, colour) in LOOKS.items():
            alike = [(1e2 * r.excess, r.lyapunov_map) for r in rows if (r.model, r.kind) == (name, kind)]
            mark: plotting.Style = {"markersize": 3.4, "mfc": "none", "markeredgecolor": colour}
            if alike:
                lower.plot(*np.array(alike).T, marker, **mark, label=kind)
        lower.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        for axis in (upper, lower):
            axis.axvline(0.0, **plotting.GUIDE, label="grazing")
        plotting.panel(upper, column, f"{TITLES[name]}, {frequency:.2f} Hz")
        plotting.panel(lower, column + 2, f"{TITLES[name]}, largest Lyapunov exponent")
        plotting.label(lower.xaxis, plotting.EXCESS, "%")
    plotting.label(axes[0, 0].yaxis, "read-out", "mrad" if quantity == "rotation" else "mm")
    plotting.label(axes[1, 0].yaxis, "per drive period")
    plotting.legend_below(figure, axes.flat, 4, markerscale=1.5)
    return figure


@plotting.in_house_style
def draw_basins(plane: settled.Starts, leads: np.ndarray, frequency: float) -> Figure:
    """The strobe plane, coloured by where its points lead."""
    figure, axis = plotting.new_figure(height=0.088)
    oscillator, m = plane.strobed.oscillator, plane.m
    gap, speed = oscillator.stop.gap, oscillator.unit_speed
    looks = {
        m: (plotting.BLUE, f"to p$_{{{m}}}$"),
        1: (plotting.tint(plotting.SKY, 0.3), "to p$_1$ without impacts"),
        0: (plotting.ORANGE, "to something else"),
    }
    x, y, picture = plane.x / gap, plane.velocity / speed, np.full(leads.shape, np.nan)
    for place, code in enumerate(looks):
        picture[leads == code] = place
    colours = ListedColormap([colour for colour, _ in looks.values()])
    axis.pcolormesh(x, y, picture, vmin=-0.5, vmax=len(looks) - 0.5, cmap=colours, rasterized=True)
    for code in sorted(plane.orbits):
        colour = plotting.VERMILION if code == 1 else "white"
        look = {"color": colour, "markeredgecolor": "black", "markersize": 4}
        strobes = (plane.strobes(code) / (gap, speed)).T
        axis.plot(*strobes, "D" if code == 1 else "o", **look, label=f"strobes of p$_{{{code}}}$")
    for code, (colour, words) in sorted(looks.items(), key=lambda pair: (pair[0] == 0, pair[0])):
        if np.any(leads == code):
            axis.fill([], [], facecolor=colour, edgecolor="0.4", label=words)
    axis.set_title(f"Eq. (1), {frequency:.2f} Hz, excess {written(oscillator.excess)}", loc="left")
    plotting.label(axis.xaxis, "$ξ$ / gap at the strobe")
    plotting.label(axis.yaxis, "$\\dot{ξ}$ / (2π f gap) at the strobe")
    plotting.legend_below(figure, [axis], 2)
    return figure
