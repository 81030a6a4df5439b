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

from ..assembly import carried
from ..modes import lowest
from ..parameters import require_kind, require_whole
from ..pieces import Piece, along, meshes, place, shared_elements, tied, ties
from ..spring import HELD
from ..strip_element import PieceMesh
from .element import SidePiece
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
    families : tuple of two tuples of Piece
        In the plane and out of it.
    unknowns : tuple of two ndarrays, shape (unknowns of all pieces, n_modes)
        Those of each family.
    """

    spring: SpatialSpring
    omega: NDArray[np.float64]
    phi: NDArray[np.float64]
    participation: NDArray[np.float64]
    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64]
    out_of_plane: NDArray[np.float64]
    families: tuple[tuple[Piece, ...], ...]
    unknowns: tuple[NDArray[np.float64], ...]

    @property
    def frequencies_hz(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    def along(self, points_per_element: int = 4) -> tuple[NDArray[np.float64], ...]:
        """Return arc length [m] (n_points,), points [m] (n_points, 3), displacement and rotation along and
        about x, y, z, each (n_modes, n_points, 3)."""
        line = self.spring.centreline
        pairs = zip(self.families, self.unknowns, strict=True)
        (s, plane), (_, side) = (along(line, *pair, points_per_element) for pair in pairs)
        return s, line.points(s), *(plane + side)


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
    """
    require_kind("spring", spring, SpatialSpring, "a SpatialSpring")
    line, c, e = spring.centreline, np.array(spring.tip_offset), np.array(spring.drive)
    usual = shared_elements(line, STRAIGHT_ELEMENTS, ARC_ELEMENTS)
    kinds = PieceMesh, SidePiece
    families = tuple(meshes(kind, spring, usual if elements is None else elements) for kind in kinds)
    joints = [ties(pieces, held) for pieces, held in zip(families, _held(spring), strict=True)]
    pairs = list(zip(families, joints, strict=True))
    count = require_whole("count", count, "modes", high=sum(t.shape[1] for t in joints) - 2)
    parts = [tied(*pair) for pair in pairs]
    stiffness, mass = (block_diag([part[i] for part in parts], format="csr") for i in range(2))
    moved = np.hstack([place(line, *pair, spring.tip_at) for pair in pairs])
    point = moved[:3] + np.cross(moved[3:], c, axis=0)
    mass = mass + carried(spring.tip, np.concatenate((point, moved[3:])))
    loads = [t.T @ np.concatenate([piece.base_load(line, e) for piece in pieces]) for pieces, t in pairs]
    shift = min(sec.in_plane_stiffness / sec.mass_per_length for sec in spring.sections) / line.length**4
    squares, x = lowest(stiffness, mass, shift, count, dense_limit=0)
    x = x / np.sqrt(np.einsum("ik,ik->k", x, mass @ x))
    x = x * np.where(e @ point @ x < 0.0, -1.0, 1.0)
    energies = x * (stiffness @ x)
    first = joints[0].shape[1]
    return SpatialModes(
        spring=spring,
        omega=np.sqrt(np.maximum(squares, 0.0)),
        phi=e @ point @ x,
        participation=(np.concatenate(loads) + spring.tip.mass * (e @ point)) @ x,
        displacement=(moved[:3] @ x).T,
        rotation=(moved[3:] @ x).T,
        out_of_plane=energies[first:].sum(axis=0) / energies.sum(axis=0),
        families=families,
        unknowns=(joints[0] @ x[:first], joints[1] @ x[first:]),
    )


def _held(spring: SpatialSpring) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """What each support holds, (2, nodal) for each family: phi' only where there is warping stiffness."""
    held = np.array([HELD[support] for support in spring.supports])
    ends = spring.sections[0], spring.sections[-1]
    for row, support, section in zip(held, spring.supports, ends, strict=True):
        row[6] &= section.warping_stiffness > 0.0 or support == "guided"
    return held[:, :3], held[:, 3:]
