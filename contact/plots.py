"""Pictures of motions, scans and branches, drawn on axes of matplotlib.

`Trajectory.plot`, `OrbitDiagram.plot` and `Branch.plot` draw with these functions, which take plain arrays.
With None for the axes they make a figure with pyplot.  Further names, such as ``color``, go to `Axes.plot`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["branch", "motion", "strobes"]

Look = Any  # property of a line or a text of matplotlib
PALE = 0.35
"""Opacity of what did not settle, and of orbits that are not admissible."""

BRANCHES = {
    "stable": {"linestyle": "-"},
    "unstable": {"linestyle": "--"},
    "not admissible: would touch a second time": {"linestyle": ":", "alpha": PALE},
}
"""Names and lines of the parts of a branch."""


def _on(axes: Axes | None) -> Axes:
    """The axes, or new ones on a figure of their own."""
    if axes is None:
        from matplotlib import pyplot  # slow to import

        axes = pyplot.subplots(layout="constrained")[1]
    return axes


def motion(
    axes: Axes | None,
    time: ArrayLike,
    displacement: ArrayLike,
    stops: Mapping[int, float],
    impacts: Sequence[tuple[float, int]],
    **look: Look,
) -> Axes:
    """Draw a displacement against time, with lines at the stops and at the impacts.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Where to draw; None makes a figure.
    time, displacement : array_like, shape (n_times,)
        The motion, in any units.
    stops : dict of int to float
        Places of the stops, in the unit of the displacement, by their numbers.
    impacts : sequence of (float, int)
        Time of each impact, and the number of its stop.
    **look
        Properties of the line.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with a label for each kind of line.
    """
    axes, several = _on(axes), len({*stops, *(number for _, number in impacts)}) > 1
    axes.plot(np.asarray(time), np.asarray(displacement), **{"label": "motion", **look})
    axes.margins(x=0.0)
    named = set[int]()
    for at, number in impacts:
        words = "_" if number in named else f"impact on stop {number}" if several else "impact"
        line: Look = {"color": f"C{number + 1}", "linewidth": 0.6, "linestyle": ":", "zorder": 1}
        axes.axvline(at, **line, label=words)
        named.add(number)
    for number, place in stops.items():
        axes.axhline(place, color="0.6", linewidth=0.6, linestyle="--", zorder=0, label="stop")
        if several:
            beside: Look = {"transform": axes.get_yaxis_transform(), "va": "center", "fontsize": "small"}
            axes.text(1.005, place, f"stop {number}", **beside)
    return axes


def strobes(
    axes: Axes | None,
    amplitude: ArrayLike,
    points: ArrayLike,
    settled: ArrayLike,
    *,
    pale: str = "pale: not settled",
    **look: Look,
) -> Axes:
    """Draw the strobe points of an orbit diagram; they are pale where the motion did not settle.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Where to draw; None makes a figure.
    amplitude : array_like, shape (n_amplitudes,)
        Amplitude or excess, in any unit.
    points : array_like, shape (n_amplitudes, n_points)
        What was observed at the strobes, in any unit.
    settled : array_like of bool, shape (n_amplitudes,)
        Whether the motion settled on an orbit.
    pale : str
        Label of the pale points.
    **look
        Properties of the points, such as ``color`` and ``label``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    axes, kept, found = _on(axes), np.asarray(settled, dtype=bool), np.asarray(points)
    dots = {"marker": "o", "markersize": 2.0, "markeredgewidth": 0.4, "linestyle": "none", "rasterized": True}
    for here, name, alpha in (
        (kept, look.pop("label", ""), 1.0),
        (~kept, pale if not kept.all() else "", PALE),
    ):
        places = np.repeat(np.asarray(amplitude)[here], found.shape[1]), found[here].ravel()
        order = look.get("zorder", 2.0) * alpha  # pale points lie behind
        axes.plot(*places, **{**dots, **look, "alpha": alpha, "label": name, "zorder": order})
    return axes


def branch(
    axes: Axes | None,
    sideways: ArrayLike,
    upwards: ArrayLike,
    stable: ArrayLike,
    admissible: ArrayLike,
    **look: Look,
) -> Axes:
    """Draw a branch of orbits in its order: stable, unstable, and as pale dots what is not admissible.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Where to draw; None makes a figure.
    sideways, upwards : array_like, shape (n_orbits,)
        Parameter and quantity of each orbit along the branch, in any units.
    stable, admissible : array_like of bool, shape (n_orbits,)
        Whether an orbit is stable, and whether it touches the stop at its impacts only.
    **look
        Properties of the lines; ``label`` begins the label of each kind.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with a label for each kind of orbit.
    """
    axes, x, y = _on(axes), np.asarray(sideways), np.asarray(upwards)
    name = f"{label}: " if (label := look.pop("label", "")) else ""
    kinds = np.where(np.asarray(admissible), np.where(np.asarray(stable), 0, 1), 2)
    runs = np.split(np.arange(kinds.size), np.flatnonzero(np.diff(kinds)) + 1)
    for run in sorted(runs, key=lambda run: int(kinds[run[0]])):  # in the order of the legend
        part = slice(run[0], run[-1] + 2)  # on to the next orbit: the line has no gap
        words, line = list(BRANCHES.items())[kinds[run[0]]]
        axes.plot(x[part], y[part], **{"color": "C0", **look, **line, "label": name + words})
    return axes
