"""Pieces of a strip, and how they are tied together: what motion in the plane and out of it have in common.

A piece of the centreline, straight or an arc, is meshed by itself. Its unknowns are `nodal` values at each
node, then `inner` values inside each element. `strip_element` says which they are in the plane and
`space.element` out of it. Where pieces meet, displacements and rotations are continuous, which are sums such
as w' + k u: where the curvature k jumps by [k], the unknown w' jumps by -[k] u. A sparse matrix T,
x_pieces = T x, ties the pieces so and holds the supports too:

    K = T^T K_pieces T,     M = T^T M_pieces T + the tip,     b = T^T b_pieces + the tip.

Coordinates on a piece run from its middle, which keeps the Hermite basis, built from powers of the
coordinate, accurate.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, TypeVar

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array

from .centreline import Centreline
from .parameters import require, require_whole, shown

MOST_ELEMENTS = 100_000
"""On a piece: rounding has long since eaten the digits by then, and a slip does not fill the memory."""

TANGENTIAL_DEGREE = 4
"""Of the displacement u along a strip."""
QUADRATURE_ORDER = 2 * TANGENTIAL_DEGREE
"""Exact for the product of two quartics."""

Field = Any  # values of a scikit-fem function at the quadrature points, with .grad and .hess


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece(ABC):
    """One piece: from arc length `start` [m] on, `nodes` counted from there [m], its curvature and section.

    `moves` says which of u, w, v [m] and of the rotations about t, n, z [rad] are `motion`. The unknown i of
    a node jumps by -[k] times the unknown j, (i, j) = `kink`.
    """

    nodal: ClassVar[int]
    inner: ClassVar[int]
    moves: ClassVar[tuple[int, ...]]
    kink: ClassVar[tuple[int, int]]

    start: float
    nodes: NDArray[np.float64]
    curvature: float
    section: Any

    @staticmethod
    @abstractmethod
    def element() -> sk.Element:
        """The finite element."""

    @abstractmethod
    def motion(self, *functions: Field) -> tuple[Field, ...]:
        """What `moves`, from the functions of an element."""

    @abstractmethod
    def matrices(self) -> tuple[csr_array, ...]:
        """K and M of the piece alone, shape (size, size); what follows is assembled likewise."""

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.nodal * self.nodes.size + self.inner * (self.nodes.size - 1)

    def basis(
        self, local: NDArray[np.float64] | None = None, elements: NDArray[np.intp] | None = None
    ) -> tuple[sk.Basis, NDArray[np.float64]]:
        """Return the basis and the arc lengths of its points [m], shape (n_elements, n_points).

        At Gauss's points, or at `local` ones (0 to 1), in all elements or in these.
        """
        points = (None if array is None else tuple(array.tolist()) for array in (local, elements))
        basis = _basis(type(self), tuple(self.nodes.tolist()), *points)
        return basis, self.start + 0.5 * self.nodes[-1] + np.asarray(basis.global_coordinates())[0]

    def sampling(
        self,
        local: NDArray[np.float64] | None = None,
        elements: NDArray[np.intp] | None = None,
        of: Callable[..., tuple[Field, ...]] | None = None,
    ) -> tuple[NDArray[np.float64], list[csr_array]]:
        """Arc lengths [m] and matrices of what `moves`, or of other functions, at the points of `basis`."""
        basis, s = self.basis(local, elements)
        rows = np.tile(np.arange(s.size), basis.Nbfun)
        columns = np.repeat(basis.element_dofs, s.shape[1], axis=1).ravel()
        found = []
        for fields in zip(*((of or self.motion)(*functions) for functions in basis.basis), strict=True):
            entries = np.concatenate([np.broadcast_to(field, s.shape) for field in fields]).ravel()
            found.append(csr_array((entries, (rows, columns)), shape=(s.size, basis.N)))
        return s.ravel(), found

    def base_load(self, line: Centreline, drive: NDArray[np.float64]) -> NDArray[np.float64]:
        """int m e . (motion) ds [kg], shape (size,), for a base motion along e = `drive`, (3,)."""
        basis, s = self.basis()
        pull, load = line.axes(s) @ drive * self.section.mass_per_length, np.zeros(self.size)
        for functions, places in zip(basis.basis, basis.element_dofs, strict=True):
            motion = zip(self.moves, self.motion(*functions), strict=True)
            work = sum(pull[..., move] * field for move, field in motion if move < 3)
            np.add.at(load, places, np.sum(work * basis.dx, axis=1))
        return load


@lru_cache(maxsize=32)
def _basis(
    kind: type[Piece],
    nodes: tuple[float, ...],
    local: tuple[float, ...] | None,
    elements: tuple[int, ...] | None,
) -> sk.Basis:
    """The basis about the middle of a piece. Kept: springs differ in their sections more often than in their
    meshes, and a leg comes twice."""
    points: dict[str, Any] = {"intorder": QUADRATURE_ORDER}
    if local is not None:
        points = {"quadrature": (np.array([local]), np.ones(len(local)))}
    if elements is not None:
        points["elements"] = np.array(elements)
    return sk.Basis(sk.MeshLine(np.array(nodes) - 0.5 * nodes[-1]), kind.element(), **points)


P = TypeVar("P", bound=Piece)


def element_counts(elements: int | Sequence[int], pieces: int) -> list[int]:
    """Return the number of elements on each of so many pieces, from one for all or one for each."""
    several = isinstance(elements, Sequence | np.ndarray) and not isinstance(elements, str)
    counts = [
        require_whole("elements", count, "[1]", low=1, high=MOST_ELEMENTS, why=", or one for each piece")
        for count in (elements if several else [elements] * pieces)  # type: ignore[union-attr,list-item]
    ]
    told = f"elements is {shown(elements)} [1]"
    require(len(counts) == pieces, f"{told}; it must be a whole number, or one for each of {pieces} pieces")
    return counts


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


def ties(pieces: Sequence[Piece], held: NDArray[np.bool_], straight: bool = False) -> csr_array:
    """Return T, which joins the pieces and builds in the supports.

    Parameters
    ----------
    pieces : sequence of Piece
    held : ndarray of bool, shape (2, nodal)
        Whether the support at each end holds each unknown of a node.
    straight : bool
        Whether the first unknown of the nodes and the inner ones are left out: u along a straight strip.
    """
    begins = np.concatenate(([0], np.cumsum([piece.size for piece in pieces])))
    first, unknown = begins[:-1], np.arange(pieces[0].nodal)
    nodal = np.array([piece.nodal * piece.nodes.size for piece in pieces])
    last, k = first + nodal - unknown.size, np.array([piece.curvature for piece in pieces])
    free = np.ones(begins[-1], dtype=bool)
    free[first[1:, None] + unknown] = False  # follow from the piece before
    free[first[0] + unknown] &= ~held[0]
    free[last[-1] + unknown] &= ~held[1]
    if straight:
        for start, inner, end in zip(first, first + nodal, begins[1:], strict=True):
            free[start : inner : unknown.size] = free[inner:end] = False
    follows, leads = (first[1:, None] + unknown).ravel(), (last[:-1, None] + unknown).ravel()
    jumping, by = pieces[0].kink
    weights = np.concatenate((free * 1.0, np.ones(follows.size), k[:-1] - k[1:]))
    rows = np.concatenate((np.arange(free.size), follows, first[1:] + jumping))
    columns = np.concatenate((np.arange(free.size), leads, last[:-1] + by))
    return csr_array((weights, (rows, columns)), shape=2 * free.shape)[:, np.flatnonzero(free)]


def tied(pieces: Sequence[Piece], ties: csr_array) -> list[csr_array]:
    """Return the matrices of the pieces, tied."""
    parts = zip(*(piece.matrices() for piece in pieces), strict=True)
    return [ties.T @ block_diag(blocks, format="csr") @ ties for blocks in parts]


def place(line: Centreline, pieces: Sequence[Piece], ties: csr_array, s: float) -> NDArray[np.float64]:
    """Return rows of displacement along x, y, z [m], then rotation about them [rad], at s; (6, n_dofs)."""
    which = int(line.piece_at(s))
    piece, before = pieces[which], sum(piece.size for piece in pieces[:which])
    x, nodes = s - piece.start, piece.nodes
    element = int(np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2))
    local = np.clip((x - nodes[element]) / (nodes[element + 1] - nodes[element]), 0.0, 1.0)
    _, matrices = piece.sampling(np.array([local]), np.array([element]))
    rows = np.zeros((6, ties.shape[1]))
    for move, matrix in zip(piece.moves, matrices, strict=True):
        rows[move] = (matrix @ ties[before : before + piece.size]).toarray()[0]
    turn = line.axes(s).T
    return np.concatenate((turn @ rows[:3], turn @ rows[3:]))


def along(
    line: Centreline, pieces: Sequence[Piece], unknowns: NDArray[np.float64], points_per_element: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return arc lengths (n_points,), and displacements and rotations in x, y, z, (2, n_modes, n_points, 3).

    Of `unknowns`, those of the loose pieces end to end, (unknowns of all pieces, n_modes), at
    `points_per_element` equal steps to an element.
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
    return s, np.einsum("gikp,pic->gkpc", fields.reshape(2, 3, -1, s.size), line.axes(s))


def shared_elements(line: Centreline, straight: int, half_turn: int) -> tuple[int, ...]:
    """Return the number of elements on each piece: so many on all straight pieces, and on each half turn."""
    whole = sum(piece.length for piece in line.pieces if piece.curvature == 0.0)
    shares = [
        abs(piece.curvature) * piece.length / np.pi * half_turn or piece.length / whole * straight
        for piece in line.pieces
    ]
    return tuple(max(2, int(np.ceil(share - 1e-9))) for share in shares)
