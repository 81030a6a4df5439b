"""Quadratic hexahedra swept along a plane centreline.

The profile is a rectangle in the plane of (y, z) [m]; only its half z >= 0 is meshed. With r(s), t and n of
the centreline, a point of the box (s, y, z) goes to

    x(s, y, z) = r(s) + y n(s) + z e_z,      |dx/d(s, y, z)| = 1 - k y,

at all 27 nodes of each element, so that faces follow the arc to third order in the length of an element. The
mapping is one to one while k y < 1: the profile must not reach the centre of the bend.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import skfem as sk
from numpy.typing import NDArray

from beam import Centreline

Profile = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Half of a cross-section: grid lines y and z [m], rising, z from 0 on, that cut it into rectangles."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SweptMesh:
    """The half z >= 0 of a swept profile."""

    box: sk.MeshHex
    """Elements and faces in the coordinates (s, y, z)."""
    mesh: sk.MeshHex2
    """The same elements in space."""
    centreline: Centreline
    stations: NDArray[np.float64]
    """Arc lengths of the cross-sections between the elements [m]."""


def rectangle_profile(*, along_n: float, along_z: float, cells: int, through: int = 1) -> Profile:
    """Return half of a rectangle of these sides [m] about the centreline.

    `cells` lie across half of the side along z, besides two in a margin as wide as the side along n is: there
    the shear of torsion turns round. `through` lie across the side along n.
    """
    half = 0.5 * along_z
    margin = min(along_n, 0.5 * half)
    y = np.linspace(-0.5 * along_n, 0.5 * along_n, through + 1)
    return y, np.concatenate((np.linspace(0.0, half - margin, cells + 1), [half - margin / 3.0, half]))


def sweep(
    profile: Profile,
    centreline: Centreline,
    elements: Sequence[int],
    *,
    tip_at: float | None = None,
    halvings: tuple[int, int] = (0, 0),
) -> SweptMesh:
    """Return the profile swept along the centreline, with so many elements on each of its pieces.

    Inside a piece the station nearest to the tip is moved to `tip_at` [m]. The first and the last element are
    halved `halvings` times towards the ends: stresses are singular at the edges of a clamp. A profile that
    reaches the centre of a bend raises ValueError.
    """
    reach = float(np.max(np.outer(centreline.curvatures, profile[0])))
    if reach >= 1.0:
        raise ValueError(f"y reaches {reach:.3g} bend radii [1]; it must stay below 1")
    stations = [np.zeros(1)]
    for count, start, end in zip(elements, centreline.joints[:-1], centreline.joints[1:], strict=True):
        piece = np.linspace(start, end, count + 1)
        if tip_at is not None and start < tip_at < end and count > 1:
            piece[1 + np.argmin(np.abs(piece[1:-1] - tip_at))] = tip_at
        stations.append(piece[1:])
    s = np.concatenate(stations)
    parts = [0.5 ** np.arange(count, 0, -1) for count in halvings]
    s = np.concatenate(
        ([0.0], s[1] * parts[0], s[1:-1], s[-1] - (s[-1] - s[-2]) * parts[1][::-1], [centreline.length])
    )
    box = sk.MeshHex.init_tensor(s, *profile)
    quadratic = sk.MeshHex2.from_mesh(box)
    s_of, y, z = quadratic.doflocs
    s_of = np.clip(s_of, 0.0, centreline.length)
    _, n = centreline.frame(s_of)
    places = np.ascontiguousarray(centreline.points(s_of).T + y * n.T + z * np.array([[0.0], [0.0], [1.0]]))
    mesh = dataclasses.replace(quadratic, doflocs=places)
    return SweptMesh(box=box, mesh=mesh, centreline=centreline, stations=s)
