"""Fig. 3 as it would have been measured, and the ends of orbits in scans beside the formulas."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from studies import letter
from studies.measurement.noise.model import End, Observed
from studies.shell import plotting
from studies.shell.plotting import BLACK, BLUE, GUIDE, LETTER, PAGE, VERMILION, tint
from studies.shell.scene import Scene, corresponding

OBSERVED = (
    "Hysteresis against the drive frequency as an observer would have measured it, median and 5 to 95 % of "
    "the scans of Eq. (1) (line and area, as far as a scan from above grazing comes to p_m) and of the beam "
    "(circles and bars), beside the folds of the map and of Eq. (1) without noise; dotted: the letter's "
    "frequencies. Linear below the printed stability of the amplitude, logarithmic above."
)
ESCAPE = (
    "Where orbits end in scans, from their end without noise (grazing for p1, the fold for the others): "
    "simulated (5 to 95 %, median with its error) and by formula (black ticks at 5, 50 and 95 %). Filled: "
    "the first slip or touch, which the formulas describe; open: where an observer no longer sees the orbit."
)
LOOKS = {
    "touched": (BLUE, "o", BLUE),
    "left": (BLUE, "o", "white"),
    "slipped": (VERMILION, "s", VERMILION),
    "lost": (VERMILION, "s", "white"),
}


@plotting.in_house_style
def draw_observed(scene: Scene, rows: Sequence[Observed]) -> Figure:
    """A panel for each noise."""
    kinds = list(dict.fromkeys(row.noise for row in rows))
    figure, axes = plotting.new_figure(
        len(kinds), 1, width=PAGE, height=0.02 + 0.047 * len(kinds), sharex=True, sharey=True, squeeze=False
    )
    for number, (axis, kind) in enumerate(zip(axes[:, 0], kinds, strict=True)):
        here = [row for row in rows if row.noise == kind]
        for m in sorted({row.m for row in here}):
            own = [row for row in here if row.m == m and row.description == "Eq. (1)"]
            f = [row.frequency_hz for row in own]
            looks = {"fold": (BLUE, "--", "fold of Eq. (1)"), "map": (BLACK, "-", "fold of the map")}
            for name, (colour, line, words) in looks.items():
                folds = np.array([getattr(row, name) for row in own], dtype=float)
                axis.plot(f, folds, line, color=colour, label=words)
            low, high = [row.low for row in own], [row.high for row in own]
            axis.fill_between(
                f, low, high, color=tint(VERMILION, 0.3), linewidth=0, label="observed, Eq. (1), 5 to 95 %"
            )
            axis.plot(f, [row.median for row in own], color=VERMILION, marker=".", label="its median")
        of_beam = [row for row in here if row.description == "beam"]
        middle = np.array([row.median for row in of_beam])
        ends = np.array([[row.low, row.high] for row in of_beam]).reshape(-1, 2).T
        axis.errorbar(
            [row.frequency_hz for row in of_beam],
            middle,
            np.abs(ends - middle),
            fmt="o",
            mfc="white",
            color=BLACK,
            elinewidth=0.8,
            label="observed, beam",
        )
        axis.axhline(0.0, **GUIDE)
        for frequency in scene.drive.frequencies_hz:
            axis.axvline(frequency, **LETTER)
        axis.set_yscale("symlog", linthresh=letter.AMPLITUDE_STABILITY, linscale=0.4)
        axis.set_ylim(-1e-3, 0.2)
        axis.set_yticks(
            [-5e-4, 0.0, 5e-4, 1e-3, 1e-2, 1e-1], ["-0.0005", "0", "0.0005", "0.001", "0.01", "0.1"]
        )
        axis.yaxis.set_minor_locator(NullLocator())
        plotting.panel(axis, number, kind)
        plotting.label(axis.yaxis, plotting.HYSTERESIS)
    axes[-1, 0].set_xlim(corresponding(scene, 19.5), corresponding(scene, 23.9))
    plotting.label(axes[-1, 0].xaxis, "excitation frequency", "Hz")
    plotting.legend_below(figure, axes[:, 0], 5)
    return figure


@plotting.in_house_style
def draw_escape(rows: Sequence[End]) -> Figure:
    """A panel for each noise, a group for each frequency."""
    kinds = list(dict.fromkeys(row.noise for row in rows))
    places = list(dict.fromkeys((row.frequency_hz, row.m) for row in rows))
    figure, axes = plotting.new_figure(
        1, len(kinds), width=PAGE, height=0.030 + 0.009 * len(places), sharey=True, squeeze=False
    )
    for number, (axis, kind) in enumerate(zip(axes[0], kinds, strict=True)):
        for row in rows:
            if row.noise == kind and row.description == "Eq. (1)":
                draw_end(axis, row, places.index((row.frequency_hz, row.m)))
        axis.axvline(0.0, **GUIDE)
        axis.set_yticks(range(len(places)), [f"{f:.2f} Hz, p$_{{{m}}}$" for f, m in places])
        axis.set_ylim(len(places) - 0.5, -0.5)
        plotting.panel(axis, number, kind)
    plotting.label(axes[0, len(kinds) // 2].xaxis, "excess from the end without noise", "10$^{-4}$")
    plotting.legend_below(figure, axes[0], 5)
    return figure


def draw_end(axis: Axes, row: End, place: int) -> None:
    """One end: simulated, and by formula."""
    colour, marker, face = LOOKS[row.end]
    origin = (row.fold or 0.0) if row.end in ("slipped", "lost") else 0.0
    y = place - 0.3 + 0.2 * list(LOOKS).index(row.end)
    low, median, high = (1e4 * (value - origin) for value in (row.low, row.median, row.high))
    axis.plot([low, high], [y, y], color=colour, linewidth=0.8)
    axis.errorbar(
        median,
        y,
        xerr=1e4 * row.error,
        color=colour,
        marker=marker,
        markersize=3.0,
        mfc=face,
        label=f"{'p$_1$' if row.end in ('touched', 'left') else 'p$_m$'} {row.end}",
    )
    if row.formula is not None:
        law = np.array([row.formula_low, row.formula, row.formula_high], dtype=float)
        found = 1e4 * (law - origin)
        axis.plot(found, [y] * len(found), "|", color=BLACK, markersize=5.0, label="formula")
