"""The film of a mode: one period of its free vibration, undamped, that repeats without a seam.

Frame n of N shows the shape times cos(2 pi n/N); N is even, so that no two frames in a row are alike, and
frame N would be frame 0 again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from beam import Modes
from beam.spring_mesh import SpringMesh
from studies.instruments.figures import house_style
from studies.instruments.motion.bench import bench_of
from studies.instruments.motion.marks import Marks, Place
from studies.instruments.motion.orbit_film import smooth_mesh
from studies.instruments.motion.scene_bodies import Bodies, Moment, Stage, bodies_of
from studies.instruments.motion.view import View, view_of

__all__ = ["ModeFilm", "frames_of", "mode_film"]

WIDTH, HEAD, PICTURE, DOTS = 720, 44, 216, 120
"""Of a frame and its parts in points; points per inch."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ModeFilm:
    """What the films of some modes share.

    Parameters
    ----------
    mesh : SpringMesh
    shapes : ndarray, shape (n_modes, n_points, 3)
        Drawn displacements at their largest [m].
    ball : ndarray, shape (n_modes, 3)
        Of the ball [m].
    names : tuple of str
    bodies : Bodies
    view : View
    rest : ndarray, shape (n_lines, n_points, 3)
        Edges of the strip at rest [m].
    """

    mesh: SpringMesh
    shapes: NDArray[np.float64]
    ball: NDArray[np.float64]
    names: tuple[str, ...]
    bodies: Bodies
    view: View
    rest: NDArray[np.float64]

    def moment(self, mode: int, phase: float) -> Moment:
        """Where everything is at `phase` [1] of the period."""
        share = math.cos(2.0 * math.pi * phase)
        return Moment(points=share * self.shapes[mode], ball=share * self.ball[mode], base=np.zeros(3))

    def mark(self, place: Place, size: float) -> None:
        """Names, and the strip at rest."""
        Marks(place, self.bodies.bench, np.zeros(3), size=size)
        lines = LineCollection(list(self.view.places(self.rest)), colors="0.35", linewidths=0.09 * size)
        lines.set_linestyle((0, (4, 3)))
        place.draw(lines)


def mode_film(modes: Modes, count: int, *, largest: float, ball_radius: float) -> ModeFilm:
    """The first `count` modes, drawn with `largest` [m] as their largest displacement."""
    mesh = smooth_mesh(modes, ball_radius)
    shapes = mesh.normalised(largest)[:count]
    bench = bench_of(mesh, modes, ball_radius=ball_radius, gap=None, swing=largest)
    spring = modes.discretization.spring
    along = modes.displacement_along(2).points
    across = 0.5 * spring.sections[0].width * np.array([0.0, 0.0, 1.0])
    cloud = np.concatenate([bench.points, *(mesh.points + shapes), *(mesh.points - shapes)])
    names = [
        f"mode {number}: {frequency:.2f} Hz{'' if coupled else ', uncoupled'}"
        for number, frequency, coupled in zip(
            range(1, count + 1), modes.frequencies_hz, modes.coupled, strict=False
        )
    ]
    return ModeFilm(
        mesh=mesh,
        shapes=shapes,
        ball=shapes[:, np.unique(mesh.triangles)].mean(axis=1),
        names=tuple(names),
        bodies=bodies_of(mesh, modes, bench, ball_radius),
        view=view_of(cloud, spring.drive, width=WIDTH, height=PICTURE),
        rest=np.stack([along - across, along + across]),
    )


def frames_of(film: ModeFilm, stage: Stage, mode: int, count: int) -> Iterator[NDArray[np.uint8]]:
    """`count` frames of one period of a mode, an even number."""
    if count < 2 or count % 2:
        raise ValueError(f"frames is {count}; it must be an even number of at least 2")
    height = HEAD + PICTURE
    figure = Figure(figsize=(WIDTH / DOTS, height / DOTS), dpi=DOTS, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    largest = 1e3 * float(np.linalg.norm(film.shapes[mode], axis=1).max())
    with house_style():
        place = Place(figure, film.view, (0.0, 0.0, 1.0, PICTURE / height))
        film.mark(place, 7.0)
        figure.text(0.015, 0.98, film.names[mode], va="top", fontsize=9.0, fontweight="bold")
        words = f"drawn with {largest:.1f} mm at most; dashed: at rest"
        figure.text(0.985, 0.975, words, va="top", ha="right", fontsize=7.0, color="0.25")
        for number in range(count):
            place.show(stage.picture(film.moment(mode, number / count)))
            canvas.draw()
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
