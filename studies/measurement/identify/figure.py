"""A record with its fit, its residuals, the intervals of all parameters, and which of them trade off."""

import math
from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import PchipInterpolator
from scipy.stats import norm

from studies.measurement.identify.fit.profiles import Profile
from studies.measurement.identify.fit.result import Fit
from studies.measurement.identify.motion.readings import Readings
from studies.physics.parameters import parameters_of
from studies.shell import plotting
from studies.shell.digits import minus, prefixed, written

CAPTION = (
    "(a) The record and its fit: two periods of an orbit, six drive periods of another motion, three periods "
    "of strobe points, or all transitions. (b) Residuals and their histogram. (c) The 90 % intervals of all "
    "parameters. (d) The likelihood along one of the two parameters that trade off most, with all others "
    "fitted again, or all correlations."
)
ORBITS, SHOWN, STROBES = 2, 6, 3  # orbits, drive periods of other motions, and periods of strobes shown
FINE, DOTS, FEW = 200, 150, 200  # times of a curve; rows shown at most; rows with large dots at most
DARK, SMALL, CELLS = 0.6, 5.5, 5  # correlation of a dark cell; size of its digits [pt]; least cells a side
READINGS = {"x_m": ("displacement", 1e3, "mm", 1e6, "µm"), "v_m_per_s": ("velocity", 1.0, "m/s", 1e3, "mm/s")}
READINGS |= {"a_m_per_s2": ("acceleration", 1.0, "m/s²", 1.0, "m/s²")}
READINGS |= dict.fromkeys(("excess", "error"), ("excess at the end of $p_m$", 1e2, "%", 1e2, "%"))
"""Last column -> name, scale and unit of the readings, scale and unit of the residuals."""
OVER = {"phase": " / 2π", "offset": " / range"}  # what an interval of a number that may be zero is divided by
RISE = "rise of $\\chi^2$"
BLUE: plotting.Style = {"color": plotting.BLUE, "linestyle": "none", "markerfacecolor": "none"}
PALE: plotting.Style = {"color": plotting.tint(plotting.BLUE, 0.5)}
HIT: plotting.Style = {"marker": 7, "color": plotting.VERMILION, "linestyle": "none", "clip_on": False}
HIT |= {"label": "impact in the fitted motion"}
NOTE: plotting.Style = {"textcoords": "offset points", "fontsize": plotting.NOTE}


@plotting.in_house_style
def draw(one: Fit, rows: Sequence[Profile], values: Mapping[str, str], title: str = "") -> Figure:
    """Four panels; `rows` are of profiles, the first of the one that is drawn, `values` printed estimates."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.14)
    traded = f"{rows[0].parameter} against {rows[0].other}".replace("_", " ") if rows else "correlations"
    words = "Record and fit", "Residuals", "90 % intervals", traded.capitalize()
    for k, axis in enumerate(axes.flat):
        plotting.panel(axis, k, words[k])
    _record(axes[0, 0], axes[0, 1], one)
    axes[1, 0].set_axis_off()
    values = {name: value.replace("^1.5", "$^{1.5}$") for name, value in values.items()}
    _intervals(axes[1, 0].inset_axes([0.5, 0.0, 0.5, 1.0]), one, values)
    if rows:
        _profile(axes[1, 1], one, [row for row in rows if row.parameter == rows[0].parameter])
    else:
        _correlations(axes[1, 1], one)
    parts = [*axes[0], *axes[0, 1].child_axes, *axes[1, 0].child_axes, *figure.axes]
    plotting.legend_below(figure, parts, 4)
    figure.suptitle(title)
    return figure


def _record(left: Axes, right: Axes, one: Fit) -> None:
    """The first rows and their fit, then all residuals and the deviation of the noise."""
    record, prediction, place = one.record, one.problem.prediction, one.record.rows[:, 0]
    words, scale, unit, fine, small = READINGS[record.columns[-1 if record.kind != "strobe" else 0]]
    off, across, few = fine * one.residuals[:, 0], ("drive frequency", "Hz"), record.kind == "transitions"
    noise = record.units(one.problem.noise)[:, 0] * fine * one.noise / one.problem.noise
    if isinstance(prediction, Readings) and record.kind == "motion":
        second, prefix = prefixed(place[-1] - place[0], "s")
        _motion(left, one, prediction, scale, second)
        place, across = place / second, ("time", prefix)
    else:
        if record.kind == "strobe":
            place, across = np.arange(1.0, len(place) + 1.0), ("strobe", "1")
        shown, errors = slice(STROBES * prediction.m or None), scale / fine * noise if few else None
        seen, off_ = scale * record.observed[shown, 0], scale / fine * off[shown]
        left.errorbar(place[shown], seen, errors, marker="o", **BLUE, elinewidth=0.7, label="record")
        left.plot(place[shown], seen - off_, "k_", markersize=7.0, label="fit")
        left.xaxis.set_major_locator(MaxNLocator(6, integer=not few))
    right.plot(place, off, "o", ms=1.3 if off.size > FEW else 3.0, mew=0.0, rasterized=True, **PALE)
    for way in (-1.0, 1.0):
        right.plot(place, way * noise, "k--", linewidth=0.7, label="±1 standard deviation of the noise")
    left.margins(0.05 if few else 0.02, 0.15)
    for axis, name, its in ((left, words, unit), (right, "record less fit", small)):
        plotting.label(axis.yaxis, name, its)
        plotting.label(axis.xaxis, *across)
    if not few:
        most, bins = 1.1 * max(float(np.abs(off).max()), 3.0 * noise[0]), min(8 + off.size // 50, 40)
        side, at = right.inset_axes((1.02, 0.0, 0.18, 1.0), sharey=right), np.linspace(-most, most, FINE)
        side.hist(off, bins, range=(-most, most), density=True, orientation="horizontal", **PALE)
        side.plot(norm.pdf(at, 0.0, noise[0]), at, "k", linewidth=0.8, label="normal curve")
        side.tick_params(left=False, labelleft=False, bottom=False, labelbottom=False)
        right.set_ylim(-most, most)


def _motion(axis: Axes, one: Fit, prediction: Readings, scale: float, second: float) -> None:
    """Rows as open dots, the fit at finely spaced times, its impacts, and the stop."""
    (oscillator, extra), (times, seen) = one.problem.at(one.unknowns), one.record.rows.T
    lasting, count = prediction.m * oscillator.period or math.inf, ORBITS * prediction.m or SHOWN
    span = min(count * oscillator.period, times[-1] - times[0])
    fine = prediction.between(times[0] + np.linspace(0.0, span, FINE * count))
    run, place = fine.run(oscillator, extra)
    hits = (run.impacts.start - run.time[place[0]]) % lasting
    shown = np.flatnonzero(times <= times[0] + span)
    every = math.ceil(shown.size / DOTS)
    look = BLUE | {"label": f"record, 1 row in {every}" if every > 1 else "record", "zorder": 3}
    axis.plot(times[shown[::every]] / second, scale * seen[shown[::every]], "o", ms=2.4, mew=0.5, **look)
    axis.plot(fine.times / second, scale * fine.values(oscillator, extra)[:, 0], "k", lw=0.8, label="fit")
    for hit in [hit for hit in (*hits, *(hits + lasting)) if hit <= span]:
        axis.plot((times[0] + hit) / second, 1.0, transform=axis.get_xaxis_transform(), **HIT)
    if one.record.columns[1] == "x_m":
        sensor, across = prediction.reading(extra), axis.get_yaxis_transform()
        gap = scale * (sensor["offset"] + sensor["scale"] * oscillator.stop.gap)
        axis.axhline(gap, **plotting.GUIDE)
        axis.annotate("stop", (1.0, gap), (0.0, 1.5), xycoords=across, ha="right", **NOTE)


def _intervals(axis: Axes, one: Fit, values: Mapping[str, str]) -> None:
    """A row a parameter: its name and printed value, and how far the ends of its interval are from it."""
    sizes = dict(zip(one.names, np.where(one.estimate, np.abs(one.estimate), one.errors), strict=True))
    sizes |= {"phase": 2.0 * math.pi, "offset": float(np.ptp(one.record.observed))}
    names = [f"{name.replace('_', ' ')}{OVER.get(name, '')}  {values[name]}" for name in one.names]
    away = 100.0 * np.abs(one.intervals().T - one.estimate) / [sizes[name] for name in one.names]
    row, finite = np.arange(len(names)), away[np.isfinite(away) & (away > 0.0)]
    first, last = math.floor(math.log10(finite.min())), math.ceil(math.log10(finite.max()))
    limits = 10.0 ** np.array([first - 0.1, max(last, first + 1) + 0.1])
    axis.set_xscale("log")
    for side, mark, words in zip(np.clip(away, *limits), "<>", ("lower, ▷ upper end", "_"), strict=True):
        axis.plot(side, row, mark, color=plotting.BLUE, mfc="none", ms=4.0, clip_on=False, label=words)
    axis.hlines(row, limits[0], limits[1], color="0.85", linewidth=0.5, zorder=0)
    axis.set(xlim=limits, ylim=(row.size - 0.4, -0.6))
    axis.set_xticks(ticks := 10.0 ** np.arange(first, last + 1, 1 + (last - first) // 3), map(written, ticks))
    axis.minorticks_off()
    axis.set_yticks(row, names, fontsize=min(plotting.NOTE, 56.0 / row.size))
    plotting.label(axis.xaxis, "from the value to either end", "% of it")


def _profile(axis: Axes, one: Fit, own: Sequence[Profile]) -> None:
    """The rise of chi^2 along a parameter, and the one that trades off with it, as fitted again."""
    other, known, names = axis.twinx(), parameters_of(one.oscillator), (own[0].parameter, own[0].other)
    held, first = np.unique([row.value for row in own], return_index=True)
    rise, values = np.array([(max(own[i].depth, 0.0), own[i].other_value) for i in first]).T
    again = f"{names[1].replace('_', ' ')}, fitted again"
    scale, unit = prefixed(float(np.abs(held).max()), known[names[0]].unit)
    size, another = prefixed(float(np.abs(values).max()), known[names[1]].unit)
    at, root = np.linspace(held[0], held[-1], FINE), np.sign(held - held[rise.argmin()]) * np.sqrt(rise)
    curves = PchipInterpolator(held, root)(at) ** 2, PchipInterpolator(held, values / size)(at)
    for k, (side, points, words) in enumerate(((axis, rise, RISE), (other, values / size, again))):
        look = plotting.series(k + 1)
        side.plot(at / scale, curves[k], color=look["color"], linestyle=look["linestyle"])
        side.plot(held / scale, points, **look | {"linestyle": "none"}, label=words)
        side.tick_params(axis="y", colors=look["color"])
        side.yaxis.label.set_color(look["color"])
        side.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10], min_n_ticks=3))
        side.margins(y=0.12)
    axis.axhline(one.reach**2, **plotting.GUIDE)
    axis.annotate("90 %", (at.mean() / scale, one.reach**2), (0.0, 1.5), ha="center", **NOTE)
    axis.xaxis.set_major_locator(MaxNLocator(3, min_n_ticks=3))
    other.spines["right"].set_visible(True)
    plotting.label(axis.xaxis, names[0].replace("_", " "), unit)
    plotting.label(axis.yaxis, RISE)
    plotting.label(other.yaxis, names[1].replace("_", " "), another.replace("^1.5", "$^{1.5}$"))


def _correlations(axis: Axes, one: Fit) -> None:
    """A triangle: a row has the name of one parameter, the head of a column that of the other."""
    names, count = [name.replace("_", " ") for name in one.names], len(one.names)
    shown = np.where(np.tri(count, k=-1) > 0.0, one.correlations, np.nan)
    image = axis.imshow(shown, vmin=-1.0, vmax=1.0, cmap="RdBu", aspect="auto")
    bar = axis.figure.colorbar(image, cax=axis.inset_axes((1.04, 0.0, 0.05, 1.0)), ticks=[-1.0, 0.0, 1.0])
    plotting.label(bar.ax.yaxis, "correlation")
    side = max(count, CELLS) - 0.5
    axis.set(xlim=(-0.5, side), ylim=(side, -0.5), xticks=[], yticks=range(1, count), yticklabels=names[1:])
    axis.tick_params(left=False)
    axis.set_frame_on(False)
    for i, j in combinations(range(count), 2):
        look: plotting.Style = {"color": "white" if abs(shown[j, i]) > DARK else "black", "fontsize": SMALL}
        axis.text(i, j, minus(f"{shown[j, i]:.2f}"), ha="center", va="center", **look)
    for j, name in enumerate(names[:-1]):
        axis.text(j - 0.4, j, name, va="center", fontsize=plotting.NOTE)
