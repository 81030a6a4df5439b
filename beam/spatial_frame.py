"""A thin strip in space: plane centreline, motion in its plane and out of it, clamped to a moving base.

The pieces of the centreline (`spatial_element`) are assembled alone and tied where they meet: the
displacements u, w, v, the rotations w' + k u, -v', phi and the twist phi' + k v' are continuous. So where the
curvature jumps by [k], w' jumps by -[k] u and phi' by -[k] v'. Supports hold what `spatial_spring` says.

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

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array
from scipy.sparse.linalg import eigsh

from .assembly import element_counts
from .centreline import Centreline
from .parameters import require_kind, require_whole
from .spatial_element import SpatialPiece
from .spatial_spring import HOLDS, SpatialSpring

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
        local = np.linspace(0.0, 1.0, points_per_element + 1)
        places, matrices = zip(*(piece.sampling(local) for piece in self.pieces), strict=True)
        s = np.concatenate(places)
        kept = np.arange(s.size) % local.size < points_per_element
        kept[-1] = True
        blocks = (block_diag(part, format="csr") for part in zip(*matrices, strict=True))
        parts = [(block @ self.unknowns)[kept].T for block in blocks]
        line = self.spring.centreline
        s = np.clip(s[kept], 0.0, line.length)
        return s, line.points(s), _in_space(line, s, parts[:3]), _in_space(line, s, parts[3:])


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
    pieces = _meshes(spring, _default_elements(spring.centreline) if elements is None else elements)
    ties = _ties(spring, pieces)
    count = require_whole("count", count, "modes", high=ties.shape[1] - 2)
    loose = [block_diag(part, format="csr") for part in zip(*(p.matrices() for p in pieces), strict=True)]
    stiffness, mass = (ties.T @ matrix @ ties for matrix in loose)
    places = _section_rows(spring, pieces)
    displacement, rotation = places[:3] @ ties, places[3:] @ ties
    c, e = np.array(spring.tip_offset), np.array(spring.drive)
    point = displacement + np.cross(rotation, c, axis=0)
    for rows, amount in ((point, spring.tip.mass), (rotation, spring.tip.rotary_inertia)):
        used = csr_array(rows)
        mass = mass + amount * (used.T @ used)
    load = ties.T @ _base_load(spring, pieces) + spring.tip.mass * (e @ point)
    shift = min(sec.in_plane_stiffness / sec.mass_per_length for sec in spring.sections)
    shift /= spring.centreline.length**4
    start = np.cos(np.arange(ties.shape[1]))  # fixed, so that results repeat, and orthogonal to no mode
    values, x = eigsh(stiffness.tocsc(), count, M=mass.tocsc(), sigma=-shift, v0=start)
    order = np.argsort(values)
    x = x[:, order] / np.sqrt(np.einsum("ik,ik->k", x[:, order], mass @ x[:, order]))
    x = x * np.where(e @ point @ x < 0.0, -1.0, 1.0)
    unknowns = ties @ x
    energies = unknowns * (loose[0] @ unknowns)
    apart = np.concatenate([np.arange(piece.size) >= piece.plane_size for piece in pieces])
    return SpatialModes(
        spring=spring,
        omega=np.sqrt(np.maximum(values[order], 0.0)),
        phi=e @ point @ x,
        participation=load @ x,
        displacement=(displacement @ x).T,
        rotation=(rotation @ x).T,
        out_of_plane=energies[apart].sum(axis=0) / energies.sum(axis=0),
        pieces=pieces,
        unknowns=unknowns,
    )


def _default_elements(line: Centreline) -> list[int]:
    straight = sum(piece.length for piece in line.pieces if piece.curvature == 0.0)
    return [
        max(2, math.ceil(abs(p.curvature) * p.length / math.pi * ARC_ELEMENTS - 1e-9))
        if p.curvature
        else max(2, math.ceil(p.length / straight * STRAIGHT_ELEMENTS - 1e-9))
        for p in line.pieces
    ]


def _meshes(spring: SpatialSpring, elements: int | Sequence[int]) -> tuple[SpatialPiece, ...]:
    """Uniform meshes of the pieces, but for the node that is moved to the tip."""
    line = spring.centreline
    counts = element_counts(elements, len(line.pieces))
    meshes = []
    for i, (piece, start) in enumerate(zip(line.pieces, line.joints[:-1].tolist(), strict=True)):
        tip = (spring.tip_at - start) / piece.length
        inside = 1e-9 < tip < 1.0 - 1e-9
        x = np.linspace(0.0, 1.0, max(int(counts[i]), 1 + inside) + 1)
        if inside:
            x[1 + np.argmin(np.abs(x[1:-1] - tip))] = tip
        nodes, section = piece.length * x, spring.sections[i]
        meshes.append(SpatialPiece(start=start, nodes=nodes, curvature=piece.curvature, section=section))
    return tuple(meshes)


def _ties(spring: SpatialSpring, pieces: tuple[SpatialPiece, ...]) -> csr_array:
    """T: the unknowns of the pieces, end to end, are T x; joints and supports are built in."""
    begins = np.concatenate(([0], np.cumsum([piece.size for piece in pieces])))
    first = [begin + piece.node(0) for begin, piece in zip(begins, pieces, strict=False)]
    last = [begin + piece.node(-1) for begin, piece in zip(begins, pieces, strict=False)]
    free = np.ones(begins[-1], dtype=bool)
    for place, section, support in zip(
        (first[0], last[-1]), (spring.sections[0], spring.sections[-1]), spring.supports, strict=True
    ):
        held = np.array(HOLDS[support])
        held[6] &= section.warping_stiffness > 0.0 or support == "guided"
        free[place[held]] = False
    rows, columns, weights = [np.arange(free.size)], [np.arange(free.size)], []
    for before, after, lead, follow in zip(last[:-1], first[1:], pieces[:-1], pieces[1:], strict=True):
        free[after] = False  # follow from the piece before
        jump = lead.curvature - follow.curvature
        rows += [after, after[[2, 6]]]
        columns += [before, before[[0, 4]]]  # w' by u, phi' by v'
        weights += [np.ones(after.size), np.full(2, jump)]
    entries = np.concatenate([free * 1.0, *weights])
    full = csr_array((entries, (np.concatenate(rows), np.concatenate(columns))), shape=(free.size, free.size))
    return full[:, np.flatnonzero(free)]


def _section_rows(spring: SpatialSpring, pieces: tuple[SpatialPiece, ...]) -> NDArray[np.float64]:
    """Displacement along x, y, z and rotation about them of the section at the tip; (6, all unknowns)."""
    which = int(spring.centreline.piece_at(spring.tip_at))
    piece, x = pieces[which], spring.tip_at - pieces[which].start
    element = int(np.clip(np.searchsorted(piece.nodes, x, side="right") - 1, 0, piece.nodes.size - 2))
    left, right = piece.nodes[element : element + 2]
    local = np.array([np.clip((x - left) / (right - left), 0.0, 1.0)])
    _, matrices = piece.sampling(local, np.array([element]))
    begins = np.concatenate(([0], np.cumsum([each.size for each in pieces])))
    frame = _frame(spring.centreline, np.array(spring.tip_at))
    rows = np.zeros((6, begins[-1]))
    local_rows = np.array([matrix.toarray()[0] for matrix in matrices])
    place = slice(begins[which], begins[which + 1])
    rows[:3, place], rows[3:, place] = frame.T @ local_rows[:3], frame.T @ local_rows[3:]
    return rows


def _base_load(spring: SpatialSpring, pieces: tuple[SpatialPiece, ...]) -> NDArray[np.float64]:
    """int m e . d ds over the pieces: Gauss's rule on each element, for a product of degree 4 and a frame
    that turns."""
    x, weight = np.polynomial.legendre.leggauss(8)
    loads = []
    for piece in pieces:
        s, matrices = piece.sampling(0.5 * (1.0 + x))
        lengths = np.repeat(np.diff(piece.nodes), x.size)
        amount = piece.section.mass_per_length * 0.5 * lengths * np.tile(weight, piece.nodes.size - 1)
        parts = _frame(spring.centreline, s) @ np.array(spring.drive)
        loads.append(sum(matrices[i].T @ (amount * parts[:, i]) for i in range(3)))
    return np.concatenate(loads)


def _frame(line: Centreline, s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows t, n, z of the frame, shape (..., 3, 3)."""
    t, n = line.frame(s)
    return np.stack([t, n, np.broadcast_to([0.0, 0.0, 1.0], t.shape)], axis=-2)


def _in_space(
    line: Centreline, s: NDArray[np.float64], parts: list[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Components along x, y, z of those along t, n, z; (n_modes, n_points, 3)."""
    return np.einsum("ikp,pic->kpc", np.array(parts), _frame(line, s))
