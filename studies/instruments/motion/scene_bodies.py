"""The spring and its bench as what a stage draws, and what every stage is.

A stage makes one picture after another of the same bodies: it is told where the points of the strip, the
ball and the base are, and whether the plate flashes. `rendered_stage` and `painted_stage` are the two there
are.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from beam import Modes
from beam.spring_mesh import SpringMesh
from studies.instruments.motion.bench import Bench
from studies.instruments.off_screen import SENTENCE, can_render

__all__ = ["Bodies", "Colours", "Moment", "Stage", "bodies_of", "choose_stage"]

Colour = tuple[float, float, float]


def _colour(text: str) -> Colour:
    red, green, blue = (int(text[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    return red, green, blue


class Colours:
    """Of the bodies; the flash is told by its outline, its rays and a word as well."""

    part = (_colour("#D0A62B"), _colour("#4A4A4A"), _colour("#E9EDF2"))
    """Of strip, layer and ball, whose numbers in `beam.spring_mesh` are their places here."""

    plate = _colour("#8C9AA8")
    flash = _colour("#FF7A1A")
    holder = _colour("#6B7682")
    table = _colour("#EEF1F4")
    lines = _colour("#CBD2D9")
    sky = _colour("#FFFFFF")


@dataclass(frozen=True, kw_only=True, eq=False)
class Bodies:
    """What there is to be drawn.

    Parameters
    ----------
    faces : ndarray of int, shape (n_faces, 4)
        Of the strip, outwards.
    part : ndarray of int, shape (n_faces,)
        STRIP or LAYER.
    triangles : ndarray of int, shape (n_triangles, 3)
        Of the ball, outwards.
    points : ndarray, shape (n_points, 3)
        At rest [m].
    ball_centre : ndarray, shape (3,)
        At rest [m].
    ball_radius : float
        [m].
    bench : Bench
    """

    faces: NDArray[np.intp]
    part: NDArray[np.intp]
    triangles: NDArray[np.intp]
    points: NDArray[np.float64]
    ball_centre: NDArray[np.float64]
    ball_radius: float
    bench: Bench


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """Where everything is.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        Displacements of the points of the strip relative to the base [m]; those of the ball are not used.
    ball, base : ndarray, shape (3,)
        Displacement of the ball relative to the base, and of the base [m].
    pressed : ndarray, shape (3,)
        How far the ball presses the plate in [m].
    flash : bool
        Whether the plate flashes.
    """

    points: NDArray[np.float64]
    ball: NDArray[np.float64]
    base: NDArray[np.float64]
    pressed: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    flash: bool = False


class Stage(Protocol):
    """Makes pictures."""

    def picture(self, moment: Moment) -> NDArray[np.uint8]:
        """Rows, columns and red, green, blue."""

    def close(self) -> None:
        """Nothing more will be drawn."""


def bodies_of(mesh: SpringMesh, modes: Modes, bench: Bench, ball_radius: float) -> Bodies:
    """The mesh and the bench of a spring."""
    faces, part = mesh.surface()
    return Bodies(
        faces=faces,
        part=part,
        triangles=mesh.triangles,
        points=mesh.points,
        ball_centre=mesh.points[np.unique(mesh.triangles)].mean(axis=0),
        ball_radius=ball_radius,
        bench=bench,
    )


def choose_stage(renderer: str) -> tuple[str, str]:
    """Which renderer is taken for "auto", "vtk" or "matplotlib", and the sentence that explains a second
    choice."""
    if renderer == "matplotlib":
        return "matplotlib", ""
    if can_render():
        return "vtk", ""
    if renderer == "vtk":
        raise ValueError(SENTENCE)
    return "matplotlib", SENTENCE
