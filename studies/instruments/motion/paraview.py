"""The frames of a film as meshes: spring, ball and bench, moved as in the film, one .vtu a frame.

Point arrays, all with three components [m]:

    displacement         as computed, relative to the base: the motion itself
    displacement_drawn   with the higher modes enlarged and the motion of the base added: the points are there

The cell array `part` is 0 on the strip, 1 on its layers, 2 on the ball, 3 on the plate and 4 on clamp and
foot; `contact` is 1 on the plate while it is touched. Field arrays: TimeValue [s], tip_m, base_m, force_n,
slowed, magnification, contact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.instruments.motion.orbit_film import OrbitFilm

__all__ = ["HOLDER", "PLATE", "grids_of"]

PLATE, HOLDER = 3, 4
"""Values of the cell array `part` besides those of `beam.spring_mesh`."""


def grids_of(film: OrbitFilm) -> Iterator[tuple[float, Any]]:
    """Time [s] and pyvista.UnstructuredGrid of every frame."""
    import pyvista

    mesh, bench, orbit = film.mesh, film.bodies.bench, film.orbit
    boxes = [*bench.stop, *bench.clamps]
    count = len(mesh.points)
    points = np.concatenate([mesh.points, *(box.corners for box in boxes)])
    corners = np.arange(8 * len(boxes)).reshape(-1, 8) + count
    cells = {
        pyvista.CellType.HEXAHEDRON: np.concatenate([mesh.hexahedra, corners]),
        pyvista.CellType.TRIANGLE: mesh.triangles,
    }
    solid = len(mesh.hexahedra)
    part = np.concatenate(
        [mesh.part[:solid], [PLATE], np.full(len(boxes) - 1, HOLDER), mesh.part[solid:]]
    ).astype(np.int8)
    ball = np.unique(mesh.triangles)
    for number in range(film.count):
        moment = film.moment(number)
        true, drawn = np.zeros_like(points), np.zeros_like(points)
        true[:count] = film.shape.displacement(orbit.coordinates[number], magnified=False)
        drawn[:count] = moment.points
        true[ball], drawn[ball] = moment.ball, moment.ball
        stop = slice(count, count + 8 * len(bench.stop))
        true[stop], drawn[stop] = moment.pressed, moment.pressed
        drawn += moment.base
        grid = pyvista.UnstructuredGrid(cells, points + drawn)
        grid.point_data["displacement"], grid.point_data["displacement_drawn"] = true, drawn
        grid.cell_data["part"] = part
        grid.cell_data["contact"] = ((part == PLATE) & moment.flash).astype(np.int8)
        fields: dict[str, NDArray[Any]] = {
            "tip_m": orbit.tip,
            "base_m": orbit.base,
            "force_n": orbit.force,
            "slowed": orbit.law.slowed,
            "contact": orbit.touching.astype(np.int8),
        }
        for name, values in fields.items():
            grid.field_data[name] = values[number : number + 1]
        grid.field_data["magnification"] = [film.shape.magnification]
        yield float(orbit.law.time[number]), grid
