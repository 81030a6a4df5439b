"""The finite-element model of a leaf spring: pieces of strip, tied together, with supports and tip.

Each piece of the centreline has elements of its own (`strip_element`). Where pieces meet, the displacements
u along the tangent and w along the normal and the rotation w' + k u are continuous, not w': where the
curvature k jumps by [k], w' jumps by -[k] u, while u' is free. The pieces are therefore assembled alone and
tied by a sparse matrix T, x_pieces = T x, which holds the supports too:

    K = T^T K_pieces T,     M = T^T M_pieces T + the tip,     b = T^T b_pieces + the tip,

and the tip, of mass M_t [kg] and rotary inertia J [kg m^2], adds for test functions (v, z)

    M_t (u.. v + w.. z) + J (w' + k u)..(z' + k v)  =  -z_base.. M_t (e_t v + e_n z)     where it sits,

e the drive direction.

The lower half of this module ties pieces of any kind, in the plane or in space (`space`): a `Piece` says how
many unknowns its nodes have and which of them jump where the curvature does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array
from scipy.sparse.linalg import splu

from .centreline import Centreline
from .parameters import require_array, require_kind, require_whole, shown
from .spring import HELD, LeafSpring, Tip
from .strip_element import NODAL, Piece, PieceMesh

P = TypeVar("P", bound=Piece)

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
    return shared_elements(spring.centreline, 120, 48)


def shared_elements(line: Centreline, straight: int, half_turn: int) -> tuple[int, ...]:
    """Return the number of elements on each piece: so many on all straight pieces, and on each half turn."""
    whole = sum(piece.length for piece in line.pieces if piece.curvature == 0.0)
    shares = [
        abs(piece.curvature) * piece.length / math.pi * half_turn or piece.length / whole * straight
        for piece in line.pieces
    ]
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
    pieces = meshes(PieceMesh, spring, default_elements(spring) if elements is None else elements)
    left_out = [piece.tangential & spring.centreline.is_straight for piece in pieces]  # u decouples there
    t = ties(pieces, [np.array(HELD[support][: NODAL]) for support in spring.supports], left_out)
    drive = np.array([*spring.drive, 0.0])
    stiffness, mass, loss = assembled(pieces, t)
    displacement, rotation = place(spring.centreline, pieces, t, spring.tip_at)
    mass = mass + carried(spring.tip, displacement, rotation)
    load = t.T @ base_load(spring.centreline, pieces, drive) + spring.tip.mass * (drive @ displacement)
    readouts = {}
    for name, readout in spring.readouts.items():
        moved, turned = place(spring.centreline, pieces, t, readout.at)
        readouts[name] = turned[2] if readout.quantity == "rotation" else drive @ moved
    return Discretization(
        spring=spring,
        stiffness=csr_array(0.5 * (stiffness + stiffness.T)),
        mass=csr_array(0.5 * (mass + mass.T)),
        loss_stiffness=csr_array(0.5 * (loss + loss.T)),
        base_load=load,
        tip=drive @ displacement,
        readouts=readouts,
        pieces=pieces,
        ties=t,
    )


def meshes(kind: Callable[..., P], spring: Any, elements: int | Sequence[int]) -> tuple[P, ...]:
    """Return the pieces of a spring, uniform meshes but for the node that is moved to the tip."""
    line, found = spring.centreline, []
    counts = element_counts(elements, len(line.pieces))
    for i, (piece, start) in enumerate(zip(line.pieces, line.joints[:-1].tolist(), strict=True)):
        tip = (spring.tip_at - start) / piece.length
        inside = 1e-9 < tip < 1.0 - 1e-9
        x = np.linspace(0.0, 1.0, max(counts[i], 1 + inside) + 1)
        if inside:
            x[1 + np.argmin(np.abs(x[1:-1] - tip))] = tip
        nodes, section = piece.length * x, spring.sections[i]
        found.append(kind(start=start, nodes=nodes, curvature=piece.curvature, section=section))
    return tuple(found)


def assembled(pieces: Sequence[Piece], ties: csr_array) -> list[csr_array]:
    """Return the matrices of the pieces, tied."""
    parts = zip(*(piece.matrices() for piece in pieces), strict=True)
    return [ties.T @ block_diag(blocks, format="csr") @ ties for blocks in parts]


def ties(
    pieces: Sequence[Piece],
    held: Sequence[NDArray[np.bool_]],
    left_out: Sequence[NDArray[np.bool_]] | None = None,
) -> csr_array:
    """Return T, which joins the pieces and builds in the supports.

    Parameters
    ----------
    pieces : sequence of Piece
    held : two arrays of bool
        Whether the first and the last support hold each unknown of a node.
    left_out : arrays of bool, shape (size,), optional
        Unknowns of each piece that are left out.
    """
    begins = np.concatenate(([0], np.cumsum([piece.size for piece in pieces])))
    first = [begin + piece.node(0) for begin, piece in zip(begins, pieces, strict=False)]
    last = [begin + piece.node(-1) for begin, piece in zip(begins, pieces, strict=False)]
    free = np.ones(begins[-1], dtype=bool) if left_out is None else ~np.concatenate(left_out)
    free[first[0][held[0]]] = free[last[-1][held[1]]] = False
    follows, leads, weights = [], [], []
    for after, before, piece, lead in zip(first[1:], last[:-1], pieces[1:], pieces[:-1], strict=True):
        free[after] = False  # follow from the piece before
        kinks = np.array(piece.kinks)
        follows += [after, after[kinks[:, 0]]]
        leads += [before, before[kinks[:, 1]]]
        weights += [np.ones(after.size), np.full(len(kinks), lead.curvature - piece.curvature)]
    every = np.arange(free.size)
    places = np.concatenate([every, *follows]), np.concatenate([every, *leads])
    full = csr_array((np.concatenate([free * 1.0, *weights]), places), shape=2 * free.shape)
    return full[:, np.flatnonzero(free)]


def place(
    line: Centreline, pieces: Sequence[Piece], ties: csr_array, s: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rows of displacement [m] and rotation [rad] along and about x, y, z at arc length s, (3, n_dofs)."""
    which = int(line.piece_at(s))
    piece, before = pieces[which], sum(piece.size for piece in pieces[:which])
    x, nodes = s - piece.start, piece.nodes
    element = int(np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2))
    local = np.clip((x - nodes[element]) / (nodes[element + 1] - nodes[element]), 0.0, 1.0)
    _, matrices = piece.sampling(np.array([local]), np.array([element]))
    rows = np.zeros((6, ties.shape[1]))
    for move, matrix in zip(piece.moves, matrices, strict=True):
        rows[move] = (matrix @ ties[before : before + piece.size]).toarray()[0]
    turn = line.axes(np.array(s)).T
    return turn @ rows[:3], turn @ rows[3:]


def carried(tip: Tip, displacement: NDArray[np.float64], rotation: NDArray[np.float64]) -> csr_array:
    """Return the mass matrix of a tip that moves and turns by these rows, each (3, n_dofs)."""
    moves, turns = csr_array(displacement), csr_array(rotation)
    return tip.mass * (moves.T @ moves) + tip.rotary_inertia * (turns.T @ turns)


def base_load(line: Centreline, pieces: Sequence[Piece], drive: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return b of the loose pieces [kg] for a base motion along `drive`, (3,)."""

    def direction(s: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.moveaxis(line.axes(s) @ drive, -1, 0)

    return np.concatenate([piece.base_load(direction) for piece in pieces])


def along(
    line: Centreline, pieces: Sequence[Piece], unknowns: NDArray[np.float64], points_per_element: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return arc lengths (n_points,), displacements and rotations (n_modes, n_points, 3) in x, y, z.

    Of `unknowns`, those of the loose pieces end to end, (..., n_modes), at `points_per_element` equal steps
    to an element.
    """
    local = np.linspace(0.0, 1.0, points_per_element + 1)
    places, matrices = zip(*(piece.sampling(local) for piece in pieces), strict=True)
    s = np.concatenate(places)
    kept = np.arange(s.size) % local.size < points_per_element  # an element's end is the next one's start
    kept[-1] = True
    s = np.clip(s[kept], 0.0, line.length)
    fields = np.zeros((6, unknowns.shape[1], s.size))
    for move, part in zip(pieces[0].moves, zip(*matrices, strict=True), strict=True):
        fields[move] = (block_diag(part, format="csr") @ unknowns)[kept].T
    axes = line.axes(s)
    return s, *(np.einsum("ikp,pic->kpc", part, axes) for part in (fields[:3], fields[3:]))
