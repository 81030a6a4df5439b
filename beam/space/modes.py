"""A thin strip in space: plane centreline, motion in its plane and out of it, clamped to a moving base.

The pieces of the centreline (`element`) are assembled alone and tied where they meet as in `beam.assembly`:
the displacements u, w, v, the rotations w' + k u, -v', phi and the twist phi' + k v' are continuous. So where
the curvature jumps by [k], w' jumps by -[k] u and phi' by -[k] v'.

The tip is one body with the section at `tip_at`: a mass M [kg] at the point c [m] from the centroid of that
section, moving by d + theta x c, with rotary inertia J [kg m^2], the same about every axis. It touches the
stop there too. Under a base motion z along the unit vector e, with x the unknowns and the displacement
p(x) = e . (d + theta x c) of the tip,

    M x.. + K x = -b z.. + p * force,     mass-normalised modes:  phi_k = p(x_k) [kg^(-1/2)],
                                                                  Gamma_k = b . x_k [kg^(1/2)].

A tip on the plane of symmetry (c_z = 0, e in the plane) leaves the two families of modes uncoupled; off it,
it is their only coupling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag

from ..assembly import along, assembled, base_load, carried, meshes, place, shared_elements, ties
from ..modes import lowest
from ..parameters import require_kind, require_whole
from ..spring import HELD
from .element import SpatialPiece
from .spring import SpatialSpring

#: Elements on all straight pieces together, shared by length, and on each half turn of an arc.
STRAIGHT_ELEMENTS, ARC_ELEMENTS = 80, 32


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialModes:
    """Mass-normalised modes, lowest first, each with phi >= 0 (its sign means nothing at rounding).

    Parameters
    ----------
    spring : SpatialSpring
    omega : ndarray, shape (n_modes,)
        Angular frequencies [rad/s]; near 0 for rigid motions.
    phi, participation : ndarray, shape (n_modes,)
        Of the tip along the drive [kg^(-1/2)], and of the whole in a base motion [kg^(1/2)].
    displacement, rotation : ndarray, shape (n_modes, 3)
        Of the section that carries the tip, along and about x, y, z [kg^(-1/2)], [kg^(-1/2) m^(-1)].
    out_of_plane : ndarray, shape (n_modes,)
        Share of the strain energy in bending out of the plane and in twist [1].
    pieces : tuple of SpatialPiece
    unknowns : ndarray, shape (unknowns of all pieces, n_modes)
    """

    spring: SpatialSpring
    omega: NDArray[np.float64]
    phi: NDArray[np.float64]
    participation: NDArray[np.float64]
    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64]
    out_of_plane: NDArray[np.float64]
    pieces: tuple[SpatialPiece, ...]
    unknowns: NDArray[np.float64]

    @property
    def frequencies_hz(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    def along(self, points_per_element: int = 4) -> tuple[NDArray[np.float64], ...]:
        """Return arc length [m] (n_points,), points [m] (n_points, 3), displacement and rotation along and
        about x, y, z, each (n_modes, n_points, 3)."""
        line = self.spring.centreline
        s, displacement, rotation = along(line, self.pieces, self.unknowns, points_per_element)
        return s, line.points(s), displacement, rotation


def spatial_modes(
    spring: SpatialSpring, count: int, elements: int | Sequence[int] | None = None
) -> SpatialModes:
    """Return the `count` lowest modes.

    Parameters
    ----------
    spring : SpatialSpring
    count : int
    elements : int or sequence of int, optional
        On every piece, or on each; by default 80 on the straight pieces together, 32 on each half turn.

    Raises
    ------
    ValueError
        For a count out of range, or fewer than one element on a piece.
    """
    require_kind("spring", spring, SpatialSpring, "a SpatialSpring")
    line = spring.centreline
    usual = shared_elements(line, STRAIGHT_ELEMENTS, ARC_ELEMENTS)
    pieces = meshes(SpatialPiece, spring, usual if elements is None else elements)
    t = ties(pieces, _held(spring))
    count = require_whole("count", count, "modes", high=t.shape[1] - 2)
    stiffness, mass = assembled(pieces, t)
    displacement, rotation = place(line, pieces, t, spring.tip_at)
    e = np.array(spring.drive)
    point = displacement + np.cross(rotation, np.array(spring.tip_offset), axis=0)
    mass = mass + carried(spring.tip, point, rotation)
    load = t.T @ base_load(line, pieces, e) + spring.tip.mass * (e @ point)
    shift = min(sec.in_plane_stiffness / sec.mass_per_length for sec in spring.sections) / line.length**4
    squares, x = lowest(stiffness, mass, shift, count, dense_limit=0)
    x = x / np.sqrt(np.einsum("ik,ik->k", x, mass @ x))
    x = x * np.where(e @ point @ x < 0.0, -1.0, 1.0)
    unknowns = t @ x
    energies = unknowns * (block_diag([piece.matrices()[0] for piece in pieces]) @ unknowns)
    apart = np.concatenate([np.arange(piece.size) >= piece.plane_size for piece in pieces])
    return SpatialModes(
        spring=spring,
        omega=np.sqrt(np.maximum(squares, 0.0)),
        phi=e @ point @ x,
        participation=load @ x,
        displacement=(displacement @ x).T,
        rotation=(rotation @ x).T,
        out_of_plane=energies[apart].sum(axis=0) / energies.sum(axis=0),
        pieces=pieces,
        unknowns=unknowns,
    )


def _held(spring: SpatialSpring) -> list[NDArray[np.bool_]]:
    """Unknowns that each support holds: a clamp holds phi' only where there is warping stiffness."""
    found = []
    for support, section in zip(spring.supports, (spring.sections[0], spring.sections[-1]), strict=True):
        held = np.array(HELD[support])
        held[6] &= section.warping_stiffness > 0.0 or support == "guided"
        found.append(held)
    return found
