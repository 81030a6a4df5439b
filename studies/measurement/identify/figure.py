"""A record with its fit, the residuals, the intervals of all parameters, and which of them trade off."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import PchipInterpolator
from scipy.stats import norm

from studies.measurement.identify.fit.profiles import Profile
from studies.measurement.identify.fit.result import Fit
from studies.measurement.identify.motion.displacement import Displacement
from studies.measurement.identify.record.records import Array
from studies.physics.parameters import parameters_of
from studies.shell import plotting
from studies.shell.digits import minus, prefixed, written

CAPTION = (
    "(a) The record with its fit: two periods of an orbit, six drive periods of a motion that does not repeat, "
    "three periods of strobe points, or all transitions. (b) Residuals, with their histogram. (c) The 90 % "
    "intervals of all fitted parameters. (d) The likelihood profile of the two parameters that trade off most, "
    "or the correlations of all."
)
ORBITS, SHOWN, STROBES = 2, 6, 3  # orbits, drive periods of other motions and periods of strobes that are shown
FINE, DOTS = 200, 150  # times of the fit in a drive period; rows that are shown at most
MANY, DECADES = 10.0, 2  # ratio of widths from which on a scale is logarithmic; its labels on each side
DARK, SMALL, CELLS = 0.6, 5.5, 5  # correlation of a dark cell; size of digits [pt]; least cells along a side
UNITS = {"x_m": ("displacement", "m"), "v_m_per_s": ("velocity", "m/s"), "a_m_per_s2": ("acceleration", "m/s²")}
OPEN: plotting.Style = {"marker": "o", "linestyle": "none", "markersize": 2.4, "markerfacecolor": "none"}
OPEN |= {"markeredgewidth": 0.5, "color": plotting.BLUE, "zorder": 3}
LINE: plotting.Style = {"color": "black", "linewidth": 0.8, "zorder": 2}
LIGHT: plotting.Style = {"marker": ".", "linestyle": "none", "color": plotting.tint(plotting.BLUE, 0.5)}
LIGHT |= {"markersize": 1.5, "rasterized": True}
FITTED: plotting.Style = {"linestyle": "none", "marker": "_", "markersize": 7.0, "color": "black", "zorder": 5}
HIT: plotting.Style = {"marker": 7, "markersize": 4.0, "linestyle": "none", "color": plotting.VERMILION}
NOISE: plotting.Style = {"color": "black", "linewidth": 0.7, "linestyle": "--", "zorder": 4}


@plotting.in_house_style
def draw(one: Fit, rows: Sequence[Profile], values: Mapping[str, str], title: str = "") -> Figure:
    """Four panels: `rows` are of a profile, `values` the printed estimates of the parameters."""
    shape = {"width": plotting.PAGE, "height": 0.128}
    figure, axes = plotting.new_figure(2, 2, **shape, gridspec_kw={"height_ratios": (1.0, 1.0)})
    last = "Profile of the likelihood" if rows else "Correlations"
    for k, words in enumerate(("Record and fit", "Residuals", "90 % intervals", last)):
        plotting.panel(axes.flat[k], k, words)
    left, right, below, corner = axes.flat
    prediction = one.problem.prediction
    if isinstance(prediction, Displacement):
        _motion(left, one, prediction)
    else:
        _points(left, one)
    _residuals(right, one)
    _intervals(below, one, values)
    if rows:
        _profile(corner, one, [row for row in rows if row.parameter == rows[0].parameter])
    else:
        _correlations(corner, one)
    plotting.legend_below(figure, figure.axes, 4)
    if title:
        figure.suptitle(title)
    return figure


def _reading(one: Fit) -> tuple[str, float, str]:
    """What the first column of a record is, its scale in a figure and its unit."""
    if one.record.kind == "transitions":
        return "end of $p_m$", 1e2, "%"
    words, unit = UNITS[one.record.columns[one.record.kind == "motion"]]
    return (words, 1e3, "mm") if unit == "m" else (words, 1.0, unit)


def _motion(axis: Axes, one: Fit, prediction: Displacement) -> None:
    """Some rows, the fit at finely spaced times, its impacts, and the stop."""
    oscillator, extra = one.problem.at(one.unknowns)
    (times, seen), (words, scale, unit) = one.record.rows.T, _reading(one)
    lasting, count = prediction.m * oscillator.period or math.inf, ORBITS * prediction.m or SHOWN
    span = min(count * oscillator.period, times[-1] - times[0])
    fine = prediction.between(times[0] + np.linspace(0.0, span, FINE * count))
    run, place = fine.run(oscillator, extra)
    hits = (run.impacts.start - run.time[place[0]]) % lasting
    hits = times[0] + np.append(hits, hits + lasting)
    shown, (second, prefix) = times <= times[0] + span, prefixed(span, "s")
    every = math.ceil(shown.sum() / DOTS)
    name = f"record, one row of {every}" if every > 1 else "record"
    axis.plot(times[shown][::every] / second, scale * seen[shown][::every], **OPEN, label=name)
    axis.plot(fine.times / second, scale * fine.values(oscillator, extra)[:, 0], **LINE, label="fit")
    hits, top = hits[hits <= times[0] + span] / second, axis.get_xaxis_transform()
    axis.plot(hits, np.ones(hits.size), **HIT, transform=top, clip_on=False, label="impact of the fit")
    axis.set_xlim(times[0] / second, (times[0] + span) / second)
    axis.margins(y=0.15)
    if one.record.columns[1] == "x_m":
        sensor = prediction.reading(extra)
        gap = scale * (sensor["offset"] + sensor["scale"] * oscillator.stop.gap)
        axis.axhline(gap, **plotting.GUIDE)
        place = {"xycoords": axis.get_yaxis_transform(), "textcoords": "offset points", "ha": "right"}
        axis.annotate("stop", (1.0, gap), (0.0, 1.5), **place, fontsize=plotting.NOTE)
    plotting.label(axis.xaxis, "time", prefix)
    plotting.label(axis.yaxis, words, unit)


def _places(one: Fit) -> tuple[Array, str, str]:
    """Where the rows lie: values, what they are, and their unit."""
    if one.record.kind == "strobe":
        return np.arange(1.0, len(one.residuals) + 1.0), "strobe", "1"
    first = one.record.rows[:, 0]
    if one.record.kind == "transitions":
        return first, "drive frequency", "Hz"
    second, prefix = prefixed(first[-1] - first[0], "s")
    return first / second, "time", prefix


def _deviations(one: Fit) -> Array:
    """Standard deviation of the noise in each row."""
    problem = one.problem
    return np.asarray(one.record.units(problem.noise)[:, 0] * one.noise / problem.noise)


def _points(axis: Axes, one: Fit) -> None:
    """Strobe points of some periods, or transitions with their errors, and the fit."""
    place, *across = _places(one)
    words, scale, unit = _reading(one)
    seen, m = scale * one.record.observed[:, 0], one.problem.prediction.m
    shown = slice(STROBES * m or None)
    errors = None if m else scale * _deviations(one)
    axis.errorbar(place[shown], seen[shown], errors, **{**OPEN, "markersize": 4.0}, elinewidth=0.7)[
        0
    ].set_label("record")
    axis.plot(place[shown], (seen - scale * one.residuals[:, 0])[shown], **FITTED, label="fit")
    axis.xaxis.set_major_locator(MaxNLocator(6, integer=bool(m)))
    axis.margins(y=0.15)
    plotting.label(axis.xaxis, *across)
    plotting.label(axis.yaxis, words, unit)


def _residuals(axis: Axes, one: Fit) -> None:
    """Residuals with the standard deviation of the noise, and beside them their histogram."""
    place, *across = _places(one)
    _words, scale, unit = _reading(one)
    fine, unit = {"mm": (1e6, "µm"), "m/s": (1e3, "mm/s")}.get(unit, (scale, unit))
    off, noise = fine * one.residuals[:, 0], fine * _deviations(one)
    axis.plot(place, off, **LIGHT)
    for way in (-1.0, 1.0):
        axis.plot(place, way * noise, **NOISE, label="standard deviation of the noise, ±1")
    plotting.label(axis.xaxis, *across)
    plotting.label(axis.yaxis, "record less fit", unit)
    if one.record.kind == "transitions":  # few, with an error each
        return
    most = 1.1 * max(float(np.abs(off).max()), 2.5 * noise[0])
    side, heights = axis.inset_axes([1.03, 0.0, 0.2, 1.0], sharey=axis), np.linspace(-most, most, 200)
    bins = np.linspace(-most, most, min(max(int(math.sqrt(off.size)), 8), 40))
    light = plotting.tint(plotting.BLUE, 0.4)
    side.hist(off, bins.tolist(), density=True, orientation="horizontal", color=light, label="histogram")
    side.plot(norm.pdf(heights, 0.0, noise[0]), heights, color="black", lw=0.8, label="normal curve")
    side.set_xticks([])
    side.tick_params(axis="y", left=False, labelleft=False)
    axis.set_ylim(-most, most)


def _intervals(axis: Axes, one: Fit, values: Mapping[str, str]) -> None:
    """One row a parameter: its name, its 90 % interval about the estimate, and the printed value."""
    special = {"phase": (2.0 * math.pi, "of 2π"), "offset": (one.oscillator.stop.gap, "of the gap")}
    names, parts = list[str](), list[Array]()
    for name, value, ends, error in zip(one.names, one.estimate, one.intervals(), one.errors, strict=True):
        size, of = special.get(name, (abs(value), "") if value else (error, "of its error"))
        names.append(f"{name.replace('_', ' ')}{of and ', '}{of}")
        parts.append(100.0 * (ends - value) / size)
    low, high = np.array(parts).T
    half = np.maximum(*(np.where(np.isfinite(end), np.abs(end), 0.0) for end in (low, high)))
    widest, least = half.max(), half[half > 0.0].min()
    limit = 1.3 * widest
    if widest > MANY * least:
        first, last = math.floor(math.log10(least)), math.ceil(math.log10(widest))
        limit = max(limit, 10.0**last)
        axis.set_xscale("symlog", linthresh=10.0**first)
        decades = 10.0 ** np.arange(last, first, -math.ceil((last - first) / DECADES))
        axis.minorticks_off()
        axis.set_xticks(ticks := [*-decades, 0.0, *decades[::-1]], [written(tick) for tick in ticks])
    else:
        axis.xaxis.set_major_locator(MaxNLocator(5, symmetric=True))
    row = np.arange(low.size)
    axis.hlines(row, np.maximum(low, -limit), np.minimum(high, limit), color=plotting.BLUE, linewidth=1.6)
    for ends, mark in ((low, "<"), (high, ">")):
        open_ = ~np.isfinite(ends)
        axis.plot(np.copysign(limit, ends[open_]), row[open_], mark, color=plotting.BLUE, clip_on=False)
    axis.plot(0.0 * row, row, "o", markersize=2.6, color="black", label="estimate")
    axis.axvline(0.0, **plotting.GUIDE)
    axis.set_xlim(-limit, limit)
    axis.set_ylim(low.size - 0.4, -0.6)
    axis.set_yticks(row, names)
    for i, name in enumerate(one.names):
        place = {"transform": axis.get_yaxis_transform(), "va": "center", "fontsize": plotting.NOTE}
        axis.text(1.03, i, minus(values[name]), **place)
    plotting.label(axis.xaxis, "distance from the estimate", "% of it")


def _profile(axis: Axes, one: Fit, own: Sequence[Profile]) -> None:
    """The rise of chi^2 along a parameter, and the one that trades off with it, as fitted again."""
    other, known = axis.twinx(), parameters_of(one.oscillator)
    held, values, rise = np.array([(row.value, row.other_value, max(row.depth, 0.0)) for row in own]).T
    lines = list[Any]()
    (size, unit), (more, another) = (
        prefixed(float(np.abs(ends).max()), known[name].unit)
        for name, ends in ((own[0].parameter, held), (own[0].other, values))
    )
    at = np.linspace(held[0], held[-1], FINE)
    root = PchipInterpolator(held, np.sign(held - held[rise.argmin()]) * np.sqrt(rise))
    curves = ((axis, rise, root(at) ** 2, 1.0, "rise of $\\chi^2$"), (other, values, PchipInterpolator(held, values)(at), more, "other parameter, fitted again"))
    for number, (side, points, curve, scale, words) in enumerate(curves, 1):
        look = plotting.series(number)
        side.plot(at / size, curve / scale, color=look["color"], linestyle=look["linestyle"])
        side.plot(held / size, points / scale, **{**look, "linestyle": "none"})
        lines += side.plot([], [], **look, label=words)
        side.tick_params(axis="y", colors=look["color"])
        side.yaxis.label.set_color(look["color"])
        side.yaxis.set_major_locator(MaxNLocator(5))
    axis.axhline(one.reach**2, **plotting.GUIDE)
    place = {"xycoords": axis.get_yaxis_transform(), "textcoords": "offset points", "ha": "center"}
    axis.annotate("90 %", (0.5, one.reach**2), (0.0, 1.5), **place, fontsize=plotting.NOTE)
    axis.xaxis.set_major_locator(MaxNLocator(4))
    axis.margins(y=0.1)
    other.spines["right"].set_visible(True)
    plotting.label(axis.xaxis, own[0].parameter.replace("_", " "), unit)
    plotting.label(axis.yaxis, "rise of $\\chi^2$")
    plotting.label(other.yaxis, own[0].other.replace("_", " "), another)


def _correlations(axis: Axes, one: Fit) -> None:
    """The correlations as a triangle: a row names one parameter, the head of a column the other."""
    names, count = [name.replace("_", " ") for name in one.names], len(one.names)
    if count < 2:
        axis.set_visible(False)
        return
    shown = np.where(np.tri(count, k=-1) > 0.0, one.correlations, np.nan)
    image = axis.imshow(shown, vmin=-1.0, vmax=1.0, cmap="RdBu", aspect="auto")
    bar = axis.figure.colorbar(image, cax=axis.inset_axes([1.04, 0.0, 0.05, 1.0]), ticks=[-1.0, 0.0, 1.0])
    plotting.label(bar.ax.yaxis, "correlation")
    axis.set_xlim(-0.5, max(count, CELLS) - 0.5)
    axis.set_ylim(max(count, CELLS) - 0.5, -0.5)
    axis.set_xticks([])
    axis.set_yticks(range(1, count), names[1:])
    axis.spines[:].set_visible(False)
    for j in range(count - 1):
        axis.text(j - 0.4, j, names[j], va="center", fontsize=plotting.NOTE)
        for i in range(j + 1, count):
            number = one.correlations[i, j]
            look = {"color": "white" if abs(number) > DARK else "black", "fontsize": SMALL}
            axis.text(j, i, minus(f"{number:.2f}"), ha="center", va="center", **look)
