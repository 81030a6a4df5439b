"""Pictures by matplotlib: polygons, the farthest first.

Only faces turned towards the viewer are drawn, sorted by the nearness of their middle; table and lines come
first. Brightness follows the angle to a light below and to the left of the viewer. For convex bodies that do
not pierce one another, with faces small beside their distances, this is what is seen.
"""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from beam.spring_mesh import BALL
from studies.instruments.motion.bench import FACES
from studies.instruments.motion.scene_bodies import Bodies, Colours, Moment
from studies.instruments.motion.view import View

__all__ = ["PaintedStage"]

AMBIENT, FLASH = 0.62, 0.88
"""Brightness of a face that the light does not reach, and of one that shines by itself."""

DOTS = 100
"""Points of the picture per inch of the figure."""


class PaintedStage:
    """A figure with one set of polygons that is replaced from picture to picture."""

    def __init__(self, bodies: Bodies, view: View) -> None:
        self._bodies, self._view = bodies, view
        self._light = view.towards - 0.9 * view.up - 0.4 * view.right
        self._light /= np.linalg.norm(self._light)
        self._figure = Figure(figsize=(view.width / DOTS, view.height / DOTS), dpi=DOTS)
        self._canvas = FigureCanvasAgg(self._figure)
        axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(0.0, view.width)
        axes.set_ylim(view.height, 0.0)
        self._table = PolyCollection([], linewidths=0.0, zorder=1)
        self._lines = LineCollection([], colors=[Colours.lines], linewidths=0.6, zorder=2)
        self._solid = PolyCollection([], linewidths=0.35, joinstyle="round", zorder=3)
        for artist in (self._table, self._lines, self._solid):
            axes.add_collection(artist, autolim=False)
        self._strip_colours = np.array(Colours.part)[bodies.part]
        self._ball_colours = np.tile(Colours.part[BALL], (len(bodies.triangles), 1))

    def picture(self, moment: Moment) -> NDArray[np.uint8]:
        bodies, view = self._bodies, self._view
        places = bodies.points + moment.points + moment.base
        ball = bodies.points + moment.ball + moment.base
        groups = [
            self._seen(places[bodies.faces], self._strip_colours),
            self._seen(ball[bodies.triangles], self._ball_colours),
        ]
        bench = bodies.bench
        shining = (Colours.flash, FLASH) if moment.flash else (Colours.plate, AMBIENT)
        boxes = [(box.corners, Colours.holder, AMBIENT) for box in bench.clamps]
        for box, (colour, ambient) in zip(bench.stop, (shining, (Colours.holder, AMBIENT)), strict=False):
            boxes.append((box.corners + moment.pressed, colour, ambient))
        for corners, colour, ambient in boxes:
            groups.append(self._seen(corners[FACES] + moment.base, np.tile(colour, (6, 1)), ambient))
        near = np.concatenate([group[0] for group in groups])
        polygons = [polygon for group in groups for polygon in group[1]]
        colours = np.concatenate([group[2] for group in groups])
        order = np.argsort(near, kind="stable")
        self._solid.set_verts([polygons[place] for place in order])
        self._solid.set_facecolor(colours[order])  # type: ignore[arg-type]
        self._solid.set_edgecolor(colours[order])  # type: ignore[arg-type]
        _, table, _ = self._seen(bench.table.corners[FACES] + moment.base, np.tile(Colours.table, (6, 1)))
        self._table.set_verts(table)
        self._table.set_facecolor([Colours.table])
        self._lines.set_segments(list(view.places(bench.lines + moment.base)))
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()

    def close(self) -> None:
        self._figure.clear()

    def _seen(
        self, corners: NDArray[np.float64], colours: NDArray[np.float64], ambient: float = AMBIENT
    ) -> tuple[NDArray[np.float64], list[NDArray[np.float64]], NDArray[np.float64]]:
        """Nearness, outline and colour of the faces (n, 3 or 4, 3) that are turned towards the viewer."""
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        seen = normal @ self._view.towards > 0.0
        bright = ambient + (1.0 - ambient) * np.clip(normal[seen] @ self._light, 0.0, 1.0)
        near = self._view.nearness(corners[seen].mean(axis=1))
        return near, list(self._view.places(corners[seen])), colours[seen] * bright[:, None]
