"""Fig. 3 as it would have been measured."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from studies import letter
from studies.measurement.noise.model import Observed
from studies.shell import plotting
from studies.shell.digits import written
from studies.shell.plotting import BLACK, BLUE, GUIDE, LETTER, PAGE, VERMILION, tint
from studies.shell.scene import Scene, corresponding

OBSERVED = (
    "Hysteresis against the drive frequency as an observer would have measured it by scans of Eq. (1), where "
    "a scan from above grazing reaches p_m, beside the folds of the map and of Eq. (1) without noise."
)


@plotting.in_house_style
def draw_observed(scene: Scene, rows: Sequence[Observed], letters: bool) -> Figure:
    """A panel for each noise."""
    kinds = list(dict.fromkeys(row.noise for row in rows))
    shape = {"width": PAGE, "height": 0.025 + 0.047 * len(kinds)}
    figure, axes = plotting.new_figure(len(kinds), 1, **shape, sharex=True, sharey=True, squeeze=False)
    given = "frequencies of the letter" if letters else "drive frequencies of the scene"
    for number, (axis, kind) in enumerate(zip(axes[:, 0], kinds, strict=True)):
        for m in sorted({row.m for row in rows}):
            own = [row for row in rows if row.m == m and row.noise == kind]
            f = [row.frequency_hz for row in own]
            maps = np.array([row.map for row in own], dtype=float)
            axis.plot(f, [row.fold for row in own], "--", color=BLUE, label="fold of Eq. (1)")
            axis.plot(f, maps, "-", color=BLACK, label="fold of the map")
            low, high = [row.low for row in own], [row.high for row in own]
            pale = tint(VERMILION, 0.3)
            axis.fill_between(f, low, high, color=pale, linewidth=0, label="observed, 5-95 % of the scans")
            axis.plot(f, [row.median for row in own], color=VERMILION, marker=".", label="observed, median")
        for height in (-letter.AMPLITUDE_STABILITY, letter.AMPLITUDE_STABILITY):
            axis.axhline(height, **GUIDE, label="axis linear between, logarithmic beyond")
        for frequency in scene.drive.frequencies_hz:
            axis.axvline(frequency, **LETTER, label=given)
        axis.set_yscale("symlog", linthresh=letter.AMPLITUDE_STABILITY, linscale=0.4)
        axis.set_ylim(-1e-3, 0.2)
        ticks = (-5e-4, 0.0, 1e-3, 1e-2, 1e-1)
        axis.set_yticks(ticks, [written(tick) for tick in ticks])
        axis.yaxis.set_minor_locator(NullLocator())
        plotting.panel(axis, number, f"{kind} noise" if kind == "white" else kind)
    axes[-1, 0].set_xlim(corresponding(scene, 19.5), corresponding(scene, 23.9))
    figure.supylabel(plotting.HYSTERESIS)
    plotting.label(axes[-1, 0].xaxis, "drive frequency", "Hz")
    plotting.legend_below(figure, axes[:, 0], 3)
    return figure
