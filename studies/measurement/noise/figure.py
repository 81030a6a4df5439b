"""Fig. 3 as it would have been measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from studies import letter
from studies.measurement.noise.model import Observed
from studies.shell import plotting
from studies.shell.plotting import BLACK, BLUE, GUIDE, LETTER, PAGE, VERMILION, tint
from studies.shell.scene import Scene, corresponding

OBSERVED = (
    "Hysteresis against the drive frequency as an observer would have measured it, median and 5 to 95 % of "
    "the scans of Eq. (1) (line and area, as far as a scan from above grazing reaches p_m), beside the folds "
    "of the map and of Eq. (1) without noise; dotted: the letter's frequencies. Linear below the printed "
    "stability of the amplitude, logarithmic above."
)


@plotting.in_house_style
def draw_observed(scene: Scene, rows: Sequence[Observed]) -> Figure:
    """A panel for each noise."""
    kinds = list(dict.fromkeys(row.noise for row in rows))
    figure, axes = plotting.new_figure(
        len(kinds), 1, width=PAGE, height=0.02 + 0.047 * len(kinds), sharex=True, sharey=True, squeeze=False
    )
    for number, (axis, kind) in enumerate(zip(axes[:, 0], kinds, strict=True)):
        for m in sorted({row.m for row in rows}):
            own = [row for row in rows if row.m == m and row.noise == kind]
            f = [row.frequency_hz for row in own]
            maps = np.array([row.map for row in own], dtype=float)
            axis.plot(f, [row.fold for row in own], "--", color=BLUE, label="fold of Eq. (1)")
            axis.plot(f, maps, "-", color=BLACK, label="fold of the map")
            low, high = [row.low for row in own], [row.high for row in own]
            pale = tint(VERMILION, 0.3)
            axis.fill_between(f, low, high, color=pale, linewidth=0, label="observed, 5 to 95 %")
            axis.plot(f, [row.median for row in own], color=VERMILION, marker=".", label="its median")
        axis.axhline(0.0, **GUIDE)
        for frequency in scene.drive.frequencies_hz:
            axis.axvline(frequency, **LETTER)
        axis.set_yscale("symlog", linthresh=letter.AMPLITUDE_STABILITY, linscale=0.4)
        axis.set_ylim(-1e-3, 0.2)
        ticks = (-5e-4, 0.0, 5e-4, 1e-3, 1e-2, 1e-1)
        axis.set_yticks(ticks, ["-0.0005", "0", "0.0005", "0.001", "0.01", "0.1"])
        axis.yaxis.set_minor_locator(NullLocator())
        plotting.panel(axis, number, kind)
        plotting.label(axis.yaxis, plotting.HYSTERESIS)
    axes[-1, 0].set_xlim(corresponding(scene, 19.5), corresponding(scene, 23.9))
    plotting.label(axes[-1, 0].xaxis, "excitation frequency", "Hz")
    plotting.legend_below(figure, axes[:, 0], 4)
    return figure
