"""A picture of the bench on a figure, with words and marks at the same places whatever drew it.

Pictures belong to the figure and not to axes: they show no data that could be read from them. Contact is
told four times: by the colour of the plate, its outline, rays around the ball and a word.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.image import BboxImage
from matplotlib.patches import Polygon
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox, Transform, TransformedBbox
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from studies.instruments.motion.bench import GRID, Bench
from studies.instruments.motion.scene_bodies import Moment
from studies.instruments.motion.view import View

__all__ = ["Marks", "Place"]

RAYS = np.deg2rad([190.0, 230.0, 270.0, 310.0, 350.0])
"""Directions of the rays, on the side of the ball that the plate is not on."""

INNER, OUTER = 0.005, 0.0085
"""Begin and end of a ray from the place of the contact [m]."""

A = TypeVar("A", bound=Artist)


class Place:
    """Where a picture stands on a figure: (left, bottom, width, height) in parts of the figure."""

    def __init__(self, figure: Figure, view: View, box: tuple[float, float, float, float]) -> None:
        self.figure, self.view = figure, view
        left, bottom, width, height = box
        shrunk = Affine2D().scale(width / view.width, -height / view.height)
        self.transform: Transform = shrunk.translate(left, bottom + height) + figure.transFigure
        frame = TransformedBbox(Bbox.from_bounds(left, bottom, width, height), figure.transFigure)
        self.image = BboxImage(frame, interpolation="antialiased", zorder=-1.0)
        self.show(np.full((view.height, view.width, 3), 255, dtype=np.uint8))
        figure.add_artist(self.image)

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Another picture, of the size of the view."""
        self.image.set_data(picture)

    def draw(self, artist: A) -> A:
        """Add what is given in points of the picture."""
        artist.set_transform(self.transform)
        self.figure.add_artist(artist)
        return artist

    def write(self, at: NDArray[np.float64], words: str, **style: Any) -> Text:
        """Words at a column and row."""
        return self.figure.text(float(at[0]), float(at[1]), words, transform=self.transform, **style)


class Marks:
    """Names of the bodies, and the marks of a contact."""

    def __init__(
        self, place: Place, bench: Bench, reach: NDArray[np.float64], *, size: float = 8.0
    ) -> None:
        """`reach` (3,) is the largest displacement of the base [m]: names stand clear of all that moves."""
        self._view, self._bench = place.view, bench
        self.moving: list[Artist] = []
        self.names = self._names(place, reach, size)
        if not bench.stop:
            return
        thick = 0.2 * size
        outline = Polygon(np.zeros((3, 2)), closed=True, fill=False, edgecolor="black", linewidth=thick)
        self._outline = place.draw(outline)
        self._rays = place.draw(LineCollection([], colors="black", linewidths=thick))
        self._word = place.write(
            np.zeros(2), "contact", fontsize=1.2 * size, fontweight="bold", ha="center", va="top"
        )
        self.moving = [self._outline, self._rays, self._word]

    def show(self, moment: Moment) -> None:
        """The marks of a moment."""
        for artist in self.moving:
            artist.set_visible(moment.flash)
        if not (self._bench.stop and moment.flash):
            return
        moved = moment.base + moment.pressed
        corners = self._view.places(self._bench.stop[0].corners + moved)
        self._outline.set_xy(corners[ConvexHull(corners).vertices])
        middle = self._view.places(self._bench.meeting + moved)
        direction = np.stack([np.cos(RAYS), -np.sin(RAYS)], axis=1)
        ends = np.array([INNER, OUTER]) * self._view.scale
        self._rays.set_segments(list(middle + direction[:, None] * ends[:, None]))
        self._word.set_position((float(middle[0]), float(middle[1] + 1.25 * OUTER * self._view.scale)))

    def _names(self, place: Place, reach: NDArray[np.float64], size: float) -> list[Artist]:
        bench = self._bench
        lowest = self._view.places(bench.table.corners - reach)
        corner = lowest[np.argmax(lowest[:, 1] - lowest[:, 0])]
        names = [(f"table: lines {1e3 * GRID:g} mm apart", corner + 4.0, "left", "top")]
        called = [("clamp", box) for box in bench.clamps] + [("plate", box) for box in bench.stop[-1:]]
        for word, box in called:
            places = self._view.places(box.corners + reach)
            above = np.array([places[:, 0].mean(), places[:, 1].min() - 3.0])
            names.append((word, above, "center", "bottom"))
        return [
            place.write(at, words, fontsize=size, color="0.25", ha=across, va=up)
            for words, at, across, up in names
        ]
