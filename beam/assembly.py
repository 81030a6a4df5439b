"""The finite-element model of a leaf spring: pieces of strip, tied together, with supports and tip.

Each piece of the centreline has elements of its own (`strip_element`). Where pieces meet, the displacements
u along the tangent and w along the normal and the rotation w' + k u are continuous, not w': where the
curvature k jumps by [k], w' jumps by -[k] u, while u' is free. The pieces are therefore assembled alone and
tied by a sparse matrix T, x_pieces = T x, which holds the supports too:

    K = T^T K_pieces T,     M = T^T M_pieces T + the tip,     b = T^T b_pieces + the tip,

and the tip, of mass M_t [kg] and rotary inertia J [kg m^2], adds for test functions (v, z)

    M_t (u.. v + w.. z) + J (w' + k u)..(z' + k v)  =  -z_base.. M_t (e_t v + e_n z)     where it sits,

e the drive direction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array
from scipy.sparse.linalg import splu

from .parameters import require_array, require_kind, require_whole, shown
from .spring import HELD, LeafSpring
from .strip_element import NODAL, QUADRATURE_ORDER, PieceMesh, base_motion, bending, inertia, stretching

MOST_ELEMENTS = 100_000
"""On a piece: rounding has long since eaten the digits by then, and a slip does not fill the memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Discretization:
    """A leaf spring in n_dofs degrees of freedom, supports built in: M x'' + K x = -b z'' + tip * force.

    Parameters
    ----------
    spring : LeafSpring
    stiffness, mass : sparse array, shape (n_dofs, n_dofs)
        K and M, the tip's mass and rotary inertia included.
    loss_stiffness : sparse array, shape (n_dofs, n_dofs)
        K with each stiffness times its loss factor.
    base_load : ndarray, shape (n_dofs,)
        b.
    tip : ndarray, shape (n_dofs,)
        The displacement of the tip in the drive direction is ``tip @ x`` [m].
    readouts : dict of str to ndarray, shape (n_dofs,)
        Likewise for the read-outs [m or rad].
    pieces : tuple of PieceMesh
    ties : sparse array, shape (unknowns of all pieces, n_dofs)
        T: the unknowns of the pieces, end to end, are ``ties @ x``.
    """

    spring: LeafSpring
    stiffness: csr_array
    mass: csr_array
    loss_stiffness: csr_array
    base_load: NDArray[np.float64]
    tip: NDArray[np.float64]
    readouts: dict[str, NDArray[np.float64]]
    pieces: tuple[PieceMesh, ...]
    ties: csr_array

    def __post_init__(self) -> None:
        require_kind("spring", self.spring, LeafSpring, "a LeafSpring")
        tip = require_array("tip", self.tip, "[1]", dimensions=1, words="a row of numbers")
        require_array("base_load", self.base_load, "kg", shape=tip.shape, words="a row of numbers")
        for name in ("stiffness", "mass", "loss_stiffness"):
            shape = getattr(getattr(self, name), "shape", None)
            if shape != 2 * tip.shape:
                raise ValueError(f"{name} has shape {shape}; it must be a matrix of shape {2 * tip.shape}")

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom."""
        return self.tip.size

    def static_compliance(self) -> float | None:
        """Tip displacement per unit static tip force [m/N]; None if the supports leave a rigid motion."""
        if self.spring.rigid_motions:
            return None
        return float(self.tip @ splu(self.stiffness.tocsc()).solve(self.tip))

    def strain_energies(self, shapes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Strain energies of shapes, from their strains rather than from K.

        Parameters
        ----------
        shapes : ndarray, shape (n_dofs, n)

        Returns
        -------
        ndarray, shape (2, n_pieces, n)
            In stretching and in bending of each piece [J, for shapes in m]. Their sum is x^T K x / 2 with
            some four digits more: K loses them to the stiffness of single elements.
        """
        energies, first, unknowns = [], 0, self.ties @ shapes
        for piece in self.pieces:
            energies.append(piece.strain_energies(unknowns[first : first + piece.size]))
            first += piece.size
        return np.stack(energies, axis=1)


def element_counts(elements: int | Sequence[int], pieces: int) -> list[int]:
    """Return the number of elements on each of so many pieces, from one for all or one for each."""
    several = isinstance(elements, Sequence | np.ndarray) and not isinstance(elements, str)
    counts = [
        require_whole("elements", count, "[1]", low=1, high=MOST_ELEMENTS, why=", or one for each piece")
        for count in (elements if several else [elements] * pieces)  # type: ignore[union-attr,list-item]
    ]
    if len(counts) != pieces:
        raise ValueError(
            f"elements is {shown(elements)} [1]; it must be a whole number, or one for each of {pieces} "
            "pieces"
        )
    return counts


def default_elements(spring: LeafSpring) -> tuple[int, ...]:
    """Return the number of elements on each piece of `spring` that `assemble` takes by default.

    The straight pieces share 120 by length: four for each half wave of mode 30. An arc has 48 for each half
    turn, whatever its size: a cubic w follows the rigid motion of an arc element of angle a only to order
    a^4, and the bending so feigned competes with the small true bending of a tight bend.
    """
    require_kind("spring", spring, LeafSpring, "a LeafSpring")
    pieces = spring.centreline.pieces
    straight = sum(piece.length for piece in pieces if piece.curvature == 0.0)
    shares = [abs(p.curvature) * p.length / math.pi * 48 or p.length / straight * 120 for p in pieces]
    return tuple(max(2, math.ceil(share - 1e-9)) for share in shares)


def assemble(spring: LeafSpring, elements: int | Sequence[int] | None = None) -> Discretization:
    """Return the finite-element model of a leaf spring.

    Parameters
    ----------
    spring : LeafSpring
    elements : int or sequence of int, optional
        Elements on every piece, or on each; `default_elements` by default. Inside a piece the node nearest to
        the tip is moved there. Rounding grows as the fourth power of the number of elements on the strip:
        2e-7 of the first frequency at 300, 5e-5 at 1200.

    Returns
    -------
    Discretization

    Raises
    ------
    ValueError
        For fewer than one element on a piece, or a count for each piece where there are more or fewer pieces.
    """
    require_kind("spring", spring, LeafSpring, "a LeafSpring")
    pieces = _meshes(spring, default_elements(spring) if elements is None else elements)
    ties = _ties(spring, pieces)
    parts = list(zip(*(_parts(spring, piece) for piece in pieces), strict=True))
    stiffness, loss, mass = (ties.T @ block_diag(blocks, format="csr") @ ties for blocks in parts[:3])
    *lumped, tip = _place(spring, pieces, ties, spring.tip_at)
    carried = (spring.tip.mass, spring.tip.mass, spring.tip.rotary_inertia)
    for row, amount in zip(lumped, carried, strict=True):
        mass = mass + amount * (csr_array(row[:, None]) @ csr_array(row[None, :]))
    readouts = {}
    for name, readout in spring.readouts.items():
        *_, rotation, displacement = _place(spring, pieces, ties, readout.at)
        readouts[name] = {"displacement": displacement, "rotation": rotation}[readout.quantity]
    return Discretization(
        spring=spring,
        stiffness=csr_array(0.5 * (stiffness + stiffness.T)),
        mass=csr_array(0.5 * (mass + mass.T)),
        loss_stiffness=csr_array(0.5 * (loss + loss.T)),
        base_load=ties.T @ np.concatenate(parts[3]) + spring.tip.mass * tip,
        tip=tip,
        readouts=readouts,
        pieces=pieces,
        ties=ties,
    )


def _meshes(spring: LeafSpring, elements: int | Sequence[int]) -> tuple[PieceMesh, ...]:
    """Uniform meshes of the pieces, but for the node that is moved to the tip."""
    line = spring.centreline
    counts = element_counts(elements, len(line.pieces))
    meshes = []
    for i, (piece, start) in enumerate(zip(line.pieces, line.joints[:-1].tolist(), strict=True)):
        tip = (spring.tip_at - start) / piece.length
        inside = 1e-9 < tip < 1.0 - 1e-9
        x = np.linspace(0.0, 1.0, max(counts[i], 1 + inside) + 1)
        if inside:
            x[1 + np.argmin(np.abs(x[1:-1] - tip))] = tip
        section, k = spring.sections[i], piece.curvature
        meshes.append(PieceMesh(start=start, nodes=piece.length * x, curvature=k, section=section))
    return tuple(meshes)


def _parts(spring: LeafSpring, piece: PieceMesh) -> tuple[Any, Any, Any, NDArray[np.float64]]:
    """K, K times loss factors, M and b of one piece alone."""
    (basis, s), section, k = piece.basis(intorder=QUADRATURE_ORDER), piece.section, piece.curvature
    m, drive = section.mass_per_length, np.array([*spring.drive, 0.0])
    along, across = (direction @ drive for direction in spring.centreline.frame(s))
    membrane = stretching.assemble(basis, EA=section.axial_stiffness, k=k)
    flexure = bending.assemble(basis, EI=section.bending_stiffness, k=k)
    loss = section.axial_loss_factor * membrane + section.bending_loss_factor * flexure
    mass = inertia.assemble(basis, m=m)
    return membrane + flexure, loss, mass, base_motion.assemble(basis, m=m, along=along, across=across)


def _ties(spring: LeafSpring, pieces: tuple[PieceMesh, ...]) -> csr_array:
    """T: joins the pieces with continuous u, w and rotation, and builds in the supports."""
    begins = np.concatenate(([0], np.cumsum([piece.size for piece in pieces])))
    first, size, nodal = begins[:-1], begins[-1], NODAL * np.array([piece.nodes.size for piece in pieces])
    last, k = first + nodal - NODAL, np.array([piece.curvature for piece in pieces])
    free, unknown = np.ones(size, dtype=bool), np.arange(NODAL)
    free[first[1:, None] + unknown] = False  # follow from the piece before
    free[first[0] + unknown] &= ~np.array(HELD[spring.supports[0]])
    free[last[-1] + unknown] &= ~np.array(HELD[spring.supports[1]])
    if spring.centreline.is_straight:  # u decouples and is left out
        for start, inner, end in zip(first, first + nodal, begins[1:], strict=True):
            free[start:inner:NODAL] = free[inner:end] = False
    follows, leads = (first[1:, None] + unknown).ravel(), (last[:-1, None] + unknown).ravel()
    weights = np.concatenate((free * 1.0, np.ones(follows.size), k[:-1] - k[1:]))
    rows = np.concatenate((np.arange(size), follows, first[1:] + 2))
    columns = np.concatenate((np.arange(size), leads, last[:-1]))
    return csr_array((weights, (rows, columns)), shape=(size, size))[:, np.flatnonzero(free)]


def _place(
    spring: LeafSpring, pieces: tuple[PieceMesh, ...], ties: csr_array, s: float
) -> tuple[NDArray[np.float64], ...]:
    """Rows (n_dofs,) of u [m], w [m], rotation [rad] and displacement along the drive [m] at arc length s."""
    which = int(spring.centreline.piece_at(s))
    piece, before = pieces[which], sum(piece.size for piece in pieces[:which])
    x, nodes = s - piece.start, piece.nodes
    element = int(np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2))
    local = np.clip((x - nodes[element]) / (nodes[element + 1] - nodes[element]), 0.0, 1.0)
    _, matrices = piece.sampling(np.array([local]), np.array([element]))
    u, w, rotation = ((matrix @ ties[before : before + piece.size]).toarray()[0] for matrix in matrices)
    tangent, normal = (direction @ np.array([*spring.drive, 0.0]) for direction in spring.centreline.frame(s))
    return u, w, rotation, tangent * u + normal * w
