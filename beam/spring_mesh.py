"""The spring as a solid that moves: its strip with width and thickness, and the ball.

A point at y along the normal n and z across the width moves with its cross-section, which stays plane. With
the displacement d [m], the rotation theta [rad] and the tangent t of the centreline there,

    v = d + theta e_z x (y n + z e_z) = d - theta y t.

The ball moves as one body with the strip at the tip.

Every ply of the strip, on either side of a slot, is a row of hexahedra. The middle of the bare strip lies on
the centreline. The ball is a sphere that touches the strip from the side towards which the drive pushes it.
Where the drive runs along the strip, the ball lies outside the bend.
"""

import math
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from .modes import Modes, ShapesAlong
from .parameters import Array, record, require_within
from .section import BeamSection, StripSection

STRIP, LAYER, BALL = 0, 1, 2
"""Values of the cell array `part`."""
BALL_POINTS = 300
"""Number of points on the sphere, a few degrees apart."""


@record
class SpringMesh:
    """The spring as a solid, with the motion of each of its points in each mode.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        Points at rest [m].
    shapes : ndarray, shape (n_modes, n_points, 3)
        Displacements relative to the base [kg^(-1/2)]: times a modal coordinate they are in metres.
    hexahedra : ndarray of int, shape (n_hexahedra, 8)
        Corners of the cells of strip and layers.
    triangles : ndarray of int, shape (n_triangles, 3)
        Corners of the surface of the ball; none without a ball.
    part : ndarray of int, shape (n_hexahedra + n_triangles,)
        Part of each cell: `beam.STRIP`, `beam.LAYER` or `beam.BALL`.
    """

    points: Array
    shapes: Array
    hexahedra: NDArray[np.intp]
    triangles: NDArray[np.intp]
    part: NDArray[np.intp]

    def normalised(self, largest: float) -> Array:
        """Return the shapes scaled to a largest displacement of `largest` [m], (n_modes, n_points, 3)."""
        require_within("largest", largest, "m", above=0)
        size = np.linalg.norm(self.shapes, axis=2).max(axis=1)
        return self.shapes * (largest / size)[:, None, None]

    def surface(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the outer faces of strip and layers, shape (n_faces, 4), and the part of each, (n_faces,).

        These are the four long sides of every hexahedron and both ends of every row. The order of the corners
        makes each face point outwards.
        """
        first, last = self.hexahedra[:, :4], self.hexahedra[:, 4:]
        after = np.roll(np.arange(4), -1)
        sides = np.stack([first, first[:, after], last[:, after], last], axis=2)
        opens = np.append(True, np.any(first[1:] != last[:-1], axis=1))
        closes = np.append(opens[1:], True)
        faces = [sides.reshape(-1, 4), first[opens][:, ::-1], last[closes]]
        part = self.part[: len(self.hexahedra)]
        return np.concatenate(faces), np.concatenate([np.repeat(part, 4), part[opens], part[closes]])

    def grid(self, points: Array | None = None) -> Any:
        """Return the mesh as a `pyvista.UnstructuredGrid`, at `points` (n_points, 3) [m] or at rest."""
        import pyvista

        cells = {pyvista.CellType.HEXAHEDRON: self.hexahedra, pyvista.CellType.TRIANGLE: self.triangles}
        kept = {kind: rows for kind, rows in cells.items() if rows.size}
        grid = pyvista.UnstructuredGrid(kept, self.points if points is None else points)
        grid.cell_data["part"] = self.part
        return grid


def solid_spring(
    modes: Modes, *, ball_radius: float | None = None, points_per_element: int = 1
) -> SpringMesh:
    """Return a leaf spring as a solid that moves in its modes.

    Parameters
    ----------
    modes : Modes
        Modes from `natural_modes`.
    ball_radius : float, optional
        Radius of the ball [m]; no ball without it.
    points_per_element : int
        Rows of hexahedra along each element.

    Returns
    -------
    SpringMesh
        Points and cells at rest, and the displacement of each point in each mode.

    Raises
    ------
    ValueError
        If `ball_radius` is not positive, or `points_per_element` is not a whole number above zero.
    TypeError
        If `ball_radius` or `points_per_element` is not a number.
    """
    along = modes.displacement_along(points_per_element)
    line = modes.discretization.spring.centreline
    points, shapes, hexahedra, part = [], [], [], []
    count, edge = 0, 1e-9 * line.length
    for piece, section in enumerate(modes.discretization.spring.sections):
        inside = (along.s > line.joints[piece] - edge) & (along.s < line.joints[piece + 1] + edge)
        where = np.flatnonzero(inside)
        for (kind, low, high), sides in product(_plies(section), section.bands):
            heights, across = np.array([low, high, high, low]), np.repeat(sides, 2)
            corners = heights[:, None] * along.normal[where, None]
            corners = corners + across[:, None] * np.array([0.0, 0.0, 1.0])
            points.append((along.points[where, None] + corners).reshape(-1, 3))
            shapes.append(_shapes_at(along, where[:, None], corners).reshape(modes.omega.size, -1, 3))
            first = count + 4 * np.arange(where.size - 1)
            hexahedra.append(first[:, None] + np.arange(8))
            part.append(np.full(where.size - 1, kind))
            count += 4 * where.size
    triangles = np.empty((0, 3), dtype=np.intp)
    if ball_radius is not None:
        offsets, triangles = _ball(modes, ball_radius)
        at = np.array([np.argmin(np.abs(along.s - modes.discretization.spring.tip_at))])
        points.append(along.points[at] + offsets)
        shapes.append(_shapes_at(along, at, offsets))
        part.append(np.full(len(triangles), BALL))
    return SpringMesh(
        points=np.concatenate(points),
        shapes=np.concatenate(shapes, axis=1),
        hexahedra=np.concatenate(hexahedra),
        triangles=triangles + count,
        part=np.concatenate(part),
    )


def _plies(section: StripSection | BeamSection) -> list[tuple[int, float, float]]:
    """Return kind, lower and upper height [m] of strip and layers; a single layer lies on the upper face."""
    half, layer = 0.5 * section.thickness, section.layer
    plies = [(STRIP, -half, half)]
    if layer is not None:
        plies.append((LAYER, half, half + layer.thickness))
        if layer.both_sides:
            plies.append((LAYER, -half - layer.thickness, -half))
    return plies


def _shapes_at(along: ShapesAlong, where: NDArray[np.intp], offsets: Array) -> Array:
    """Return shapes (n_modes, ..., 3) at `offsets` (..., 3) [m] from the points `where` of the centreline."""
    across = np.cross(np.array([0.0, 0.0, 1.0]), offsets)
    return along.displacement[:, where] + along.rotation[:, where, None] * across


def _ball(modes: Modes, radius: float) -> tuple[Array, NDArray[np.intp]]:
    """Return points of the sphere relative to the tip on the centreline [m], and its outward triangles."""
    require_within("ball_radius", radius, "m", above=0)
    spring = modes.discretization.spring
    piece = int(spring.centreline.piece_at(spring.tip_at))
    normal = spring.centreline.frame(spring.tip_at)[1]
    push, bend = float(normal[:2] @ np.array(spring.drive)), float(spring.centreline.curvatures[piece])
    side = math.copysign(1.0, push) if abs(push) > 0.5 or bend == 0.0 else -math.copysign(1.0, bend)
    order = np.arange(BALL_POINTS) + 0.5
    polar, turn = np.arccos(1.0 - 2.0 * order / BALL_POINTS), math.pi * (1.0 + math.sqrt(5.0)) * order
    sphere = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1)
    triangles = ConvexHull(sphere).simplices.astype(np.intp)
    a, b, c = (sphere[triangles[:, i]] for i in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    surface = max(side * height for _, *pair in _plies(spring.sections[piece]) for height in pair)
    return radius * sphere + side * (surface + radius) * normal, triangles
