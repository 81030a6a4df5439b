"""The figure of a source: its panels side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from studies.methods.validation.rows import Panel
from studies.shell import plotting

MANY = 50
"""Points beyond which they are dots."""


@plotting.in_house_style
def draw(panels: Sequence[Panel]) -> Figure:
    """One panel after the other, two in a row."""
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    figure, axes = plotting.new_figure(
        rows, columns, width=plotting.PAGE, height=0.015 + 0.065 * rows, squeeze=False
    )
    for axis in axes.flat[len(panels) :]:
        axis.set_axis_off()
    for number, (panel, axis) in enumerate(zip(panels, axes.flat, strict=False)):
        for curve in panel.curves:
            style = plotting.series(curve.look) | ({"marker": ""} if curve.line else {"linestyle": "none"})
            if not curve.line and np.size(curve.x) > MANY:
                style |= {"markersize": 1.2, "markeredgewidth": 0.0, "rasterized": True}
            style |= {"alpha": 0.4, "linewidth": 0.8} if curve.faint else {}
            axis.plot(curve.x, curve.y, label=curve.name or "_", **style)
        if len(panels) > 1:
            plotting.panel(axis, number, panel.title)
        plotting.label(axis.xaxis, *panel.x)
        plotting.label(axis.yaxis, *panel.y)
        if any(curve.name for curve in panel.curves):
            axis.legend()
    return figure
