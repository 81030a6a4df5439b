"""What stands around the spring, as boxes: the clamp, the plate, and the table that carries them.

Seen from the base, all of it is at rest but for a stop that yields. With d the direction of the drive, e the
one in the plane of the strip at right angles to it and the spring's far side, and z across the strip:

    plate    its face is met by the drawn ball when the tip has moved by the gap along d; a ball that sits
             beyond the end of the spring meets a plate that begins beyond it, so that the strip passes
             beside it; the plate stands on a foot, and the ball presses both back as far as it goes
    clamps   behind every held end of the strip, one for ends that look the same way
    table    below, with lines 10 mm apart
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam import Modes
from beam.spring_mesh import SpringMesh

__all__ = ["FACES", "Bench", "Box", "bench_of"]

FACES = np.array([(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])
"""Corners of the faces of a box, outwards; the corners 0 to 3 run round below, 4 to 7 above them."""

GRID = 0.010
"""Between two lines on the table [m]."""

WALL = 0.004
"""Thickness of the plate, of the clamp around the strip, and of the table's distance from the strip [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """Corners (8, 3) [m], numbered as for a hexahedron of VTK."""

    corners: NDArray[np.float64]

    @property
    def centre(self) -> NDArray[np.float64]:
        """[m]."""
        return self.corners.mean(axis=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Bench:
    """The bodies at rest.

    Parameters
    ----------
    clamps : tuple of Box
    stop : tuple of Box
        The plate and its foot, or nothing.
    table : Box
    lines : ndarray, shape (n_lines, 2, 3)
        On the table [m].
    meeting : ndarray, shape (3,)
        Where the ball meets the plate [m].
    """

    clamps: tuple[Box, ...]
    stop: tuple[Box, ...]
    table: Box
    lines: NDArray[np.float64]
    meeting: NDArray[np.float64]

    @property
    def points(self) -> NDArray[np.float64]:
        """All corners [m], shape (n, 3)."""
        return np.concatenate([box.corners for box in (*self.clamps, *self.stop, self.table)])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Directions:
    """e, d and z as rows."""

    rows: NDArray[np.float64]

    def box(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> Box:
        """From `low` to `high` along e, d and z [m]."""
        order = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        return Box(corners=np.where(np.array(order), high, low) @ self.rows)


def bench_of(mesh: SpringMesh, modes: Modes, *, ball_radius: float, gap: float | None, swing: float) -> Bench:
    """The bench of a spring with a ball of `ball_radius` [m] that swings by `swing` [m] on either side.

    There is no plate without a `gap` [m].
    """
    spring = modes.discretization.spring
    drive = np.array([*spring.drive, 0.0])
    frame = _Directions(rows=np.array([[drive[1], -drive[0], 0.0], drive, [0.0, 0.0, 1.0]]))
    local = mesh.points @ frame.rows.T
    across = float(np.abs(mesh.points[np.unique(mesh.hexahedra), 2]).max())
    floor = -across - 2.0 * WALL
    clamps = _clamps(modes, frame, across, floor)
    centre = local[np.unique(mesh.triangles)].mean(axis=0)
    top = centre + np.array([0.0, ball_radius + (gap or 0.0), 0.0])
    stop = () if gap is None else _stop(frame, modes, centre, ball_radius, top, floor)
    held = np.concatenate([mesh.points, *(box.corners for box in (*clamps, *stop))])
    away = np.array([0.0, swing, 0.0])
    reach = np.concatenate([held @ frame.rows.T, local + away, local - away])
    low = np.floor((reach.min(axis=0) - 0.3 * WALL) / GRID) * GRID
    high = np.ceil((reach.max(axis=0) + 0.3 * WALL) / GRID) * GRID
    low[2], high[2] = floor - WALL, floor
    return Bench(
        clamps=clamps, stop=stop, table=frame.box(low, high), lines=_lines(frame, low, high),
        meeting=top @ frame.rows,
    )  # fmt: skip


def _stop(
    frame: _Directions,
    modes: Modes,
    centre: NDArray[np.float64],
    radius: float,
    top: NDArray[np.float64],
    floor: float,
) -> tuple[Box, Box]:
    """The plate whose face the ball meets at `top`, and its foot; all in the directions e, d, z."""
    spring = modes.discretization.spring
    beside = centre - spring.centreline.points(spring.tip_at) @ frame.rows.T
    half = 3.0 * WALL
    left, right = top[0] - half, top[0] + half
    if abs(beside[0]) > abs(beside[1]):
        away = float(np.sign(beside[0]))
        edge = centre[0] - 0.75 * away * radius
        left, right = sorted((edge, edge + away * half))
    back = top[1] + WALL
    plate = frame.box(np.array([left, top[1], -1.5 * radius]), np.array([right, back, 1.5 * radius]))
    return plate, frame.box(np.array([left, back, floor]), np.array([right, back + WALL, 1.5 * radius]))


def _clamps(modes: Modes, frame: _Directions, across: float, floor: float) -> tuple[Box, ...]:
    spring = modes.discretization.spring
    ends: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
    line, places = spring.centreline, (0.0, spring.centreline.length)
    for place, sign, support in zip(places, (-1.0, 1.0), spring.supports, strict=True):
        if support != "free":
            outwards = sign * (line.frame(place)[0] @ frame.rows.T)
            ends.append((line.points(place) @ frame.rows.T, outwards))
    if len(ends) == 2 and float(ends[0][1] @ ends[1][1]) > 0.9:
        groups = [[ends[0][0], ends[1][0]]]
    else:
        groups = [[place] for place, _ in ends]
    boxes = []
    for group, (_, outwards) in zip(groups, ends, strict=False):
        room, back = np.array([WALL, WALL, 0.0]) * (1.0 - np.abs(outwards)), 4.0 * WALL * outwards
        low, high = np.min(group, axis=0) - room, np.max(group, axis=0) + room
        low, high = np.minimum(low, low + back), np.maximum(high, high + back)
        low[2], high[2] = floor, across + 0.5 * WALL
        boxes.append(frame.box(low, high))
    return tuple(boxes)


def _lines(frame: _Directions, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    lines = []
    for axis in (0, 1):
        for place in np.arange(low[axis], high[axis] + 0.5 * GRID, GRID):
            line = np.array([low, high])
            line[:, axis], line[:, 2] = place, high[2]
            lines.append(line @ frame.rows)
    return np.array(lines)
