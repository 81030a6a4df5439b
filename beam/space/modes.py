"""Natural modes of a thin strip in space, with motion in the plane of its centreline and out of it.

The pieces of the centreline (`element`) are assembled alone and tied where they meet, as in `beam.assembly`.
Displacements u, w, v, rotations w' + k u, -v', phi and twist phi' + k v' are continuous. Where the curvature
jumps by [k], w' jumps by -[k] u and phi' by -[k] v'.

The tip is one body with the section at `tip_at`: a mass M [kg] at the point c [m] from the centroid of that
section. It moves by d + theta x c, touches the stop at that point, and has the rotary inertia J [kg m^2]
about every axis. Under a base motion z along the unit vector e, with x the unknowns and the displacement
p(x) = e . (d + theta x c) of the tip,

    M x.. + K x = -b z.. + p * force,     mass-normalised modes:  phi_k = p(x_k) [kg^(-1/2)],
                                                                  Gamma_k = b . x_k [kg^(1/2)].

Only the tip couples the motion in the plane to that out of it; on the plane of symmetry (c_z = 0, e in the
plane) it does not.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag

from ..assembly import tip_inertia
from ..modes import lowest_modes
from ..parameters import Array, record, require_kind, require_whole
from ..pieces import Piece, meshed_pieces, motion_along, motion_at, shared_elements, tie_matrix, tied_matrices
from ..spring import HELD
from ..strip_element import PieceMesh
from .element import SidePiece
from .spring import SpatialSpring


@record
class SpatialModes:
    """Mass-normalised modes of a strip in space, lowest first.

    The sign of each mode is fixed by phi >= 0. It is arbitrary where phi is rounding.

    Parameters
    ----------
    spring : SpatialSpring
        The spring that vibrates.
    omega : ndarray, shape (n_modes,)
        Angular frequencies [rad/s]; near 0 for rigid motions.
    phi, participation : ndarray, shape (n_modes,)
        Displacement of the tip along the drive [kg^(-1/2)]; participation in a base motion [kg^(1/2)].
    displacement, rotation : ndarray, shape (n_modes, 3)
        Motion of the section at `tip_at` along and about x, y, z [kg^(-1/2)], [kg^(-1/2) m^(-1)].
    out_of_plane : ndarray, shape (n_modes,)
        Share of the strain energy in bending out of the plane and in twist [1].
    families : tuple of two tuples of Piece
        Meshed pieces for the motion in the plane and for the motion out of it.
    unknowns : tuple of two ndarrays, shape (unknowns of all pieces, n_modes)
        Unknowns of the pieces of each family in the modes.
    """

    spring: SpatialSpring
    omega: Array
    phi: Array
    participation: Array
    displacement: Array
    rotation: Array
    out_of_plane: Array
    families: tuple[tuple[Piece, ...], ...]
    unknowns: tuple[Array, ...]

    @property
    def frequencies_hz(self) -> Array:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    def along(self, points_per_element: int = 4) -> tuple[Array, ...]:
        """Return the shapes along the centreline, at equal steps in each element.

        The arrays are arc lengths [m] (n_points,), points at rest [m] (n_points, 3), and displacements and
        rotations along and about x, y, z (n_modes, n_points, 3).
        """
        line = self.spring.centreline
        pairs = zip(self.families, self.unknowns, strict=True)
        (s, plane), (_, side) = (motion_along(line, *pair, points_per_element) for pair in pairs)
        return s, line.points(s), *(plane + side)


def spatial_modes(
    spring: SpatialSpring, count: int, elements: int | Sequence[int] | None = None
) -> SpatialModes:
    """Return the lowest natural modes of a strip in space.

    Parameters
    ----------
    spring : SpatialSpring
        The spring that vibrates.
    count : int
        Number of modes, at least 1.
    elements : int or sequence of int, optional
        Elements on every piece, or one number for each. By default the straight pieces share 80 by length,
        and an arc has 32 for each half turn.

    Returns
    -------
    SpatialModes
        Frequencies and mass-normalised shapes, lowest first.

    Raises
    ------
    ValueError
        If `count` or `elements` is out of range, or `elements` does not hold one number for each piece.
    TypeError
        If `spring` is not a SpatialSpring, or `count` or `elements` is not a number.
    """
    require_kind("spring", spring, SpatialSpring, "a SpatialSpring")
    line, c, e = spring.centreline, np.array(spring.tip_offset), np.array(spring.drive)
    counts = shared_elements(line, 80, 32) if elements is None else elements
    families = tuple(meshed_pieces(kind, spring, counts) for kind in (PieceMesh, SidePiece))
    ties = [tie_matrix(pieces, held) for pieces, held in zip(families, _held(spring), strict=True)]
    pairs = list(zip(families, ties, strict=True))
    count = require_whole("count", count, "modes", high=sum(t.shape[1] for t in ties) - 2)
    parts = [tied_matrices(*pair) for pair in pairs]
    stiffness, mass = (block_diag([part[i] for part in parts], format="csr") for i in range(2))
    motion = np.hstack([motion_at(line, *pair, spring.tip_at) for pair in pairs])
    point = motion[:3] + np.cross(motion[3:], c, axis=0)
    mass = mass + tip_inertia(spring.tip, np.concatenate((point, motion[3:])))
    loads = [t.T @ np.concatenate([piece.base_load(line, e) for piece in pieces]) for pieces, t in pairs]
    shift = min(sec.in_plane_stiffness / sec.mass_per_length for sec in spring.sections) / line.length**4
    squares, x = lowest_modes(stiffness, mass, shift, count, dense_limit=0)
    x = x / np.sqrt(np.einsum("ik,ik->k", x, mass @ x))
    x = x * np.where(e @ point @ x < 0.0, -1.0, 1.0)
    energies = x * (stiffness @ x)
    first = ties[0].shape[1]
    return SpatialModes(
        spring=spring,
        omega=np.sqrt(np.maximum(squares, 0.0)),
        phi=e @ point @ x,
        participation=(np.concatenate(loads) + spring.tip.mass * (e @ point)) @ x,
        displacement=(motion[:3] @ x).T,
        rotation=(motion[3:] @ x).T,
        out_of_plane=energies[first:].sum(axis=0) / energies.sum(axis=0),
        families=families,
        unknowns=(ties[0] @ x[:first], ties[1] @ x[first:]),
    )


def _held(spring: SpatialSpring) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return whether each support holds each nodal unknown, (2, nodal), in the plane and out of it."""
    held = np.array([HELD[support] for support in spring.supports])
    ends = spring.sections[0], spring.sections[-1]
    for row, support, section in zip(held, spring.supports, ends, strict=True):
        row[6] &= section.warping_stiffness > 0.0 or support == "guided"  # phi' is held only against warping
    return held[:, :3], held[:, 3:]
