"""The points of a figure as tables, read back from its axes: what stands beside a picture is what is drawn.

`drawn_points` has a row for each point, with these columns (those that no point needs are left out):

    panel                     letter of the panel or label of its axes, empty for a figure of one panel
    series                    name of the series: its gid, or its label in the legend
    x, y                      place of the point; a line across the panel has one of them
    low, high                 ends of an error bar or of a bar; the bar ends at the point
    x_quantity, y_quantity    what the axes show, units in brackets

Points of a series without a line that fall on each other are written once.  Lines and markers, bars, error
bars, histograms, filled areas and cells are read; words are not.  `drawn_maps` has a table for each mesh or
image: the columns are headed by its x, the first one holds its y.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, QuadMesh
from matplotlib.container import BarContainer, ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle

__all__ = ["COLUMNS", "axis_words", "drawn_maps", "drawn_points", "name_of", "plain_words"]

COLUMNS = ("panel", "series", "x", "y", "low", "high", "x_quantity", "y_quantity")
DIGITS = 8
"""Digits kept of a number: far more than a picture shows."""

Point = dict[str, Any]


def plain_words(text: str) -> str:
    """A label without the signs of mathematical setting."""
    text = text.replace("\\mathrm", "").replace("\\log", "log").replace("\\", "").replace("\n", " ")
    return re.sub(r"[${}]", "", text).replace("\u2212", "-").strip()


def name_of(artist: Any) -> str:
    """The gid of what is drawn, or else its label; empty if it has neither."""
    gid = artist.get_gid() if isinstance(artist, Artist) else None
    words = str(gid or artist.get_label() or "")
    return "" if words.startswith("_") else plain_words(words)


def axis_words(axes: Axes, which: str) -> str:
    """What the x or y axis shows: its own label, that of a panel of its column or row, or the figure's."""
    figure: Any = axes.get_figure()
    spec = axes.get_subplotspec()

    def place(other: Any) -> Any:
        return None if other is None else (other.colspan if which == "x" else other.rowspan)

    near = [other for other in figure.axes if place(other.get_subplotspec()) == place(spec)]
    for one in [axes, *near[::-1]]:
        words = getattr(one, f"get_{which}label")()
        if words:
            return plain_words(words)
    return plain_words(getattr(figure, f"get_sup{which}label")())


def _panels(figure: Figure) -> Iterator[tuple[str, Axes]]:
    """Letter and axes of each panel; a label of the axes goes before the letter in their title."""
    shown = [axes for axes in figure.axes if axes.get_visible() and axes.get_label() != "<colorbar>"]
    for number, axes in enumerate(shown):
        title = re.match(r"\((\w)\)", axes.get_title(loc="left") or axes.get_title())
        alone = "" if len(shown) == 1 else chr(ord("a") + number)
        yield str(axes.get_label()) or (title.group(1) if title else alone), axes


def drawn_points(figure: Figure) -> dict[str, list[Any]]:
    """The points, columns by name."""
    rows: list[Point] = []
    for letter, axes in _panels(figure):
        common = {
            "panel": letter, "x_quantity": axis_words(axes, "x"), "y_quantity": axis_words(axes, "y"),
        }  # fmt: skip
        rows += [{**common, **point} for point in _points(axes)]
    used = [name for name in COLUMNS if any(row.get(name, "") != "" for row in rows)]
    return {name: [row.get(name, "") for row in rows] for name in used or COLUMNS}


def drawn_maps(figure: Figure) -> dict[str, dict[str, list[str]]]:
    """The meshes and images, columns by name, by the letter of their panel."""
    found: dict[str, dict[str, list[str]]] = {}
    for letter, axes in _panels(figure):
        meshes = [collection for collection in axes.collections if isinstance(collection, QuadMesh)]
        maps = [(one, _mesh(one)) for one in meshes] + [(one, _image(one)) for one in axes.images]
        for shown, (x, y, values) in maps:
            corner = f"{axis_words(axes, 'y')}; across: {axis_words(axes, 'x')}; cells: {name_of(shown)}"
            columns = {corner: [_number(place) for place in y]}
            columns |= {_number(place): [_number(v) for v in values[:, j]] for j, place in enumerate(x)}
            key = letter if letter not in found else f"{letter}{len(found)}"
            found[key] = columns
    return found


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}" if np.isfinite(value) else ""


def _row(series: str, **numbers: float) -> Point:
    return {"series": series, **{key: _number(float(value)) for key, value in numbers.items()}}


def _points(axes: Axes) -> Iterator[Point]:
    bars: set[Any] = set()
    errors: dict[Line2D, ErrorbarContainer] = {}
    caps: set[Line2D] = set()
    for container in axes.containers:
        if isinstance(container, BarContainer):
            bars |= set(container.patches)
            yield from _bars(container)
        elif isinstance(container, ErrorbarContainer):
            errors[container.lines[0]] = container
            caps |= set(container.lines[1])
    for line in axes.lines:
        if line not in caps and line.get_visible():
            yield from _line(axes, line, errors.get(line))
    bar_lines = {one for container in errors.values() for one in container.lines[2]}
    for patch in axes.patches:
        if patch not in bars:
            yield from _patch(axes, patch)
    for collection in axes.collections:
        if collection not in bar_lines and not isinstance(collection, QuadMesh):
            yield from _collection(axes, collection)


def _in_data(axes: Axes, artist: Any) -> tuple[bool, bool]:
    """Whether its x and its y are values of the axes."""
    across, up = artist.get_transform().contains_branch_seperately(axes.transData)
    return bool(across), bool(up)


def _line(axes: Axes, line: Line2D, errors: ErrorbarContainer | None) -> Iterator[Point]:
    name = name_of(line) if errors is None else name_of(errors)
    xy = np.array(line.get_xydata(), dtype=float)
    across, up = _in_data(axes, line)
    if not across and not up:
        return
    if not (across and up):
        yield _row(name, **({"x": xy[0, 0]} if across else {"y": xy[0, 1]}))
        return
    spread: dict[float, tuple[float, float]] = {}
    for bars in errors.lines[2] if errors is not None else ():
        for ends in (ends for ends in bars.get_segments() if np.shape(ends) == (2, 2)):
            place, values = (0, ends[:, 1]) if ends[0, 0] == ends[1, 0] else (1, ends[:, 0])
            spread[float(ends[0, place])] = (float(values.min()), float(values.max()))
    seen: set[tuple[str, str]] = set()
    for x, y in xy[np.isfinite(xy).all(axis=1)]:
        row = _row(name, x=x, y=y)
        if line.get_linestyle() == "None" and (row["x"], row["y"]) in seen:
            continue
        seen.add((row["x"], row["y"]))
        ends_here = spread.get(float(x)) or spread.get(float(y))
        yield row if ends_here is None else {**row, **_row(name, low=ends_here[0], high=ends_here[1])}


def _bars(container: BarContainer) -> Iterator[Point]:
    for bar in container.patches:
        x, y, width, height = bar.get_x(), bar.get_y(), bar.get_width(), bar.get_height()
        name = name_of(bar) or name_of(container)
        if container.orientation == "horizontal":
            ends = sorted((x, x + width))
            yield _row(name, x=x + width, y=y + 0.5 * height, low=ends[0], high=ends[1])
        else:
            ends = sorted((y, y + height))
            yield _row(name, x=x + 0.5 * width, y=y + height, low=ends[0], high=ends[1])


def _patch(axes: Axes, patch: Patch) -> Iterator[Point]:
    across, up = _in_data(axes, patch)
    if isinstance(patch, Rectangle):
        x, y = patch.get_xy()
        corners = np.array([(x, y), (x + patch.get_width(), y + patch.get_height())])
        if across and up:  # a cell
            corners = corners.mean(axis=0, keepdims=True)
    elif isinstance(patch, Polygon):
        corners = np.array(patch.get_xy())
    else:
        return
    for x, y in corners:
        if across or up:
            yield _row(name_of(patch), **({"x": x} if across else {}), **({"y": y} if up else {}))


def _collection(axes: Axes, collection: Collection) -> Iterator[Point]:
    name = name_of(collection)
    offsets = np.ma.filled(np.ma.asarray(collection.get_offsets()).astype(float), np.nan)
    if offsets.shape[0] > 1 or (offsets.any() and not isinstance(collection, LineCollection)):
        for x, y in offsets:
            yield _row(name, x=x, y=y)
        return
    if all(_in_data(axes, collection)):
        for path in collection.get_paths():
            for x, y in np.asarray(path.vertices):
                yield _row(name, x=x, y=y)


def _centres(edges: np.ndarray) -> np.ndarray:
    """Places given to `pcolormesh` with shading nearest, from the edges of the cells made of them."""
    centres = np.empty(edges.size - 1)
    centres[0] = 0.5 * (edges[0] + edges[1])
    for i in range(1, centres.size):
        centres[i] = 2.0 * edges[i] - centres[i - 1]
    inside = (centres > np.minimum(edges[:-1], edges[1:])) & (centres < np.maximum(edges[:-1], edges[1:]))
    return centres if inside.all() else 0.5 * (edges[:-1] + edges[1:])


def _mesh(mesh: QuadMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres of the cells along x and y, and their values."""
    edges = np.asarray(mesh.get_coordinates())
    x, y = _centres(edges[0, :, 0]), _centres(edges[:, 0, 1])
    values = np.ma.filled(np.ma.asarray(mesh.get_array()).astype(float), np.nan)
    return x, y, values.reshape(y.size, x.size)


def _image(image: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres of the pixels along x and y, and their values (the mean of the colours of a picture)."""
    left, right, bottom, top = image.get_extent()
    values = np.ma.filled(np.ma.asarray(image.get_array()).astype(float), np.nan)
    values = values if values.ndim == 2 else values.mean(axis=2)
    rows, columns = values.shape
    if image.origin == "upper":
        bottom, top = top, bottom
    x = left + (right - left) * (np.arange(columns) + 0.5) / columns
    y = bottom + (top - bottom) * (np.arange(rows) + 0.5) / rows
    return x, y, values
