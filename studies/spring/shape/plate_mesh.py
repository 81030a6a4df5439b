"""Triangles on half of a flat U, along its centreline.

A grid has lines of constant s (along the centreline, from the clamp) and t (across, outwards) [m]. It covers
one leg, of length L [m], and half of the bend, of radius r [m]. The angle is a = 0 on the leg and
a = (s - L)/r on the bend. The grid point (s, t) is mapped to

    x = min(s, L) - L - r + (r + t) sin a,      z = (r + t) cos a,

so that the ball is at the origin and z = 0 is the line of symmetry. Squares of the grid about the ball become
circles up to the edge of the seat. Beyond it the circles blend into the grid, up to the edge of the sheet. A
diagonal that points to the ball cuts each cell in two triangles. Next to the clamp, which keeps the sheet
from curving across its width, s grows as the square of the line number.
"""

from __future__ import annotations

import math

import numpy as np
import skfem as sk

LONGEST = 2.0
"""Length of a cell over its width, on the leg."""


def half_u(
    *,
    leg: float,
    radius: float,
    width: float,
    seat: float,
    covered: float,
    cells: tuple[int, int],
    times: int,
) -> sk.MeshTri:
    """The half z >= 0 of the U.

    Parameters
    ----------
    leg, radius, width, seat, covered : float
        Length of a leg, radius of the bend's centreline, width of the sheet, radius of the seat, length of
        the tape from the clamp [m].
    cells : (int, int)
        Cells over the radius of the seat, and from the seat to the edge of the sheet.
    times : int
        Number of parts into which each of these cells is divided along each side.

    Returns
    -------
    MeshTri
        With boundaries "clamped" and "symmetry" and subdomains "taped" and "seat".
    """
    end, half = leg + 0.5 * math.pi * radius, 0.5 * width
    longest, near = LONGEST * half / sum(cells), min(width, 0.5 * covered)

    def even(a: float, b: float) -> np.ndarray:
        return np.linspace(a, b, times * math.ceil((b - a) / longest - 1e-9) + 1)[1:]

    rim = np.linspace(seat, half, times * cells[1] + 1)
    out = np.concatenate((np.linspace(0.0, seat, times * cells[0] + 1)[:-1], rim))
    clamp = near * np.linspace(0.0, 1.0, 2 * times * sum(cells) + 1) ** 2
    s = np.concatenate(
        (clamp, even(near, covered), even(covered, leg), even(leg, end - half), end - out[-2::-1])
    )
    t = np.concatenate((-out[:0:-1], out))
    ix = np.arange(s.size * t.size).reshape(s.size, t.size)
    a, b, c, d = ix[:-1, :-1], ix[1:, :-1], ix[1:, 1:], ix[:-1, 1:]
    cut = (np.where(t[1:] <= 0.0, *ways) for ways in (((a, b, c), (a, b, d)), ((a, c, d), (b, c, d))))
    triangles = np.concatenate([part.reshape(3, -1) for part in cut], axis=1)

    s, t = (grid.ravel() for grid in np.meshgrid(s, t, indexing="ij"))
    turn = np.maximum(s - leg, 0.0) / radius
    x, z = np.minimum(s, leg) - leg - radius + (radius + t) * np.sin(turn), (radius + t) * np.cos(turn)
    box = np.stack((t, end - s))
    far = np.abs(box).max(axis=0)
    circles = far * box / np.maximum(np.linalg.norm(box, axis=0), np.finfo(float).tiny)
    share = np.clip((half - far) / (half - seat), 0.0, 1.0)
    p = (1.0 - share) * (x, z) + share * circles
    p[1, s == end] = 0.0
    covers, seats = s[triangles].mean(axis=0) < covered, far[triangles].max(axis=0) <= seat * (1.0 + 1e-9)
    parts = {"taped": np.flatnonzero(covers), "seat": np.flatnonzero(seats)}
    start = -leg - radius
    return (
        sk.MeshTri(p, triangles)
        .with_subdomains(parts)
        .with_boundaries(
            {"clamped": lambda x: x[0] < (1.0 - 1e-9) * start, "symmetry": lambda x: x[1] == 0.0}
        )
    )
