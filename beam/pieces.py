"""Meshed pieces of a strip and the matrix that ties them together.

Both `strip_element` (motion in the plane) and `space.element` (motion out of it) use this module. Each piece
of the centreline, straight or an arc, is meshed by itself. Its unknowns are `nodal` values at each node, then
`inner` values inside each element. Where pieces meet, displacements and rotations are continuous. A rotation
is a sum such as w' + k u: where the curvature k jumps by [k], the unknown w' jumps by -[k] u. A sparse matrix
T, x_pieces = T x, holds these ties and the supports.

Coordinates on a piece run from its middle. This keeps the Hermite basis accurate, which is built from powers
of the coordinate.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, ClassVar, TypeVar

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array

from .centreline import Centreline
from .parameters import Array, record, require, require_whole, shown

MOST_ELEMENTS = 100_000
"""Largest number of elements on a piece; beyond it rounding leaves no digits, and a slip fills the memory."""
TANGENTIAL_DEGREE = 4
"""Polynomial degree of the displacement u along a strip."""
QUADRATURE_ORDER = 2 * TANGENTIAL_DEGREE
"""Order of the quadrature, exact for the product of two quartics."""

Field = Any  # values of a scikit-fem function at the quadrature points, with .grad and .hess


@record
class Piece(ABC):
    """One meshed piece: arc length `start` [m], `nodes` counted from there [m], curvature [1/m] and section.

    `components` are the rows that `motion` fills, of u, w, v [m] and the rotations about t, n, z [rad] (0 to
    5). The unknown i of a node jumps by -[k] times the unknown j, (i, j) = `curvature_jump`.
    """

    nodal: ClassVar[int]
    inner: ClassVar[int]
    components: ClassVar[tuple[int, ...]]
    curvature_jump: ClassVar[tuple[int, int]]

    start: float
    nodes: Array
    curvature: float
    section: Any

    @staticmethod
    @abstractmethod
    def element() -> sk.Element:
        """Return the finite element."""

    @abstractmethod
    def motion(self, *functions: Field) -> tuple[Field, ...]:
        """Return displacements [m] and rotations [rad], one for each of `components`."""

    @abstractmethod
    def matrices(self) -> tuple[csr_array, ...]:
        """Return K, M and possibly further matrices of the piece alone, each of shape (size, size)."""

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.nodal * self.nodes.size + self.inner * (self.nodes.size - 1)

    def basis(
        self, local: Array | None = None, elements: NDArray[np.intp] | None = None
    ) -> tuple[sk.Basis, Array]:
        """Return the basis and the arc lengths of its points [m], shape (n_elements, n_points).

        The points are Gauss's, or `local` ones (0 to 1), in all elements or in the given ones.
        """
        points = (None if array is None else tuple(array.tolist()) for array in (local, elements))
        basis = _basis(type(self), tuple(self.nodes.tolist()), *points)
        return basis, self.start + 0.5 * self.nodes[-1] + np.asarray(basis.global_coordinates())[0]

    def sampling(
        self,
        local: Array | None = None,
        elements: NDArray[np.intp] | None = None,
        of: Callable[..., tuple[Field, ...]] | None = None,
    ) -> tuple[Array, list[csr_array]]:
        """Return arc lengths [m] of the points of `basis`, and matrices of `motion` or `of` there."""
        basis, s = self.basis(local, elements)
        rows = np.tile(np.arange(s.size), basis.Nbfun)
        columns = np.repeat(basis.element_dofs, s.shape[1], axis=1).ravel()
        found = []
        for fields in zip(*((of or self.motion)(*functions) for functions in basis.basis), strict=True):
            entries = np.concatenate([np.broadcast_to(field, s.shape) for field in fields]).ravel()
            found.append(csr_array((entries, (rows, columns)), shape=(s.size, basis.N)))
        return s.ravel(), found

    def base_load(self, line: Centreline, drive: Array) -> Array:
        """Return int m e . (motion) ds [kg], shape (size,), for a base motion along e = `drive`, (3,)."""
        basis, s = self.basis()
        pull, load = line.axes(s) @ drive * self.section.mass_per_length, np.zeros(self.size)
        for functions, unknowns in zip(basis.basis, basis.element_dofs, strict=True):
            motion = zip(self.components, self.motion(*functions), strict=True)
            work = sum(pull[..., component] * field for component, field in motion if component < 3)
            np.add.at(load, unknowns, np.sum(work * basis.dx, axis=1))
        return load


@lru_cache(maxsize=32)  # many springs share one mesh, and both legs of a U do
def _basis(
    kind: type[Piece],
    nodes: tuple[float, ...],
    local: tuple[float, ...] | None,
    elements: tuple[int, ...] | None,
) -> sk.Basis:
    """Return the basis of a piece, its coordinate counted from the middle of the piece."""
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
    words = f"it must be a whole number, or one for each of {pieces} pieces"
    require(len(counts) == pieces, "elements", f"is {shown(elements)} [1]; {words}")
    return counts


def shared_elements(line: Centreline, straight: int, half_turn: int) -> tuple[int, ...]:
    """Return the number of elements on each piece: all straight pieces share `straight` by length, and an arc
    has `half_turn` on each half turn."""
    whole, counts = sum(piece.length for piece in line.pieces if piece.curvature == 0.0), []
    for piece in line.pieces:
        arc = abs(piece.curvature) * piece.length / np.pi * half_turn
        counts.append(max(2, int(np.ceil((arc or piece.length / whole * straight) - 1e-9))))
    return tuple(counts)


def meshed_pieces(kind: Callable[..., P], spring: Any, elements: int | Sequence[int]) -> tuple[P, ...]:
    """Return the pieces of a spring, meshed uniformly but for the nodes that are moved to the tip and to
    supports between the ends."""
    line, found = spring.centreline, []
    counts = element_counts(elements, len(line.pieces))
    for i, (piece, start) in enumerate(zip(line.pieces, line.joints[:-1].tolist(), strict=True)):
        places = [(s - start) / piece.length for s in (spring.tip_at, *getattr(spring, "between", ()))]
        inside = [place for place in places if 1e-9 < place < 1.0 - 1e-9]
        x = np.linspace(0.0, 1.0, max(counts[i], 1 + len(inside)) + 1)
        for place in sorted(inside):
            away = np.where(np.isin(x, [0.0, 1.0, *inside]), np.inf, np.abs(x - place))
            x[np.argmin(away)] = place if place not in x else x[np.argmin(away)]
        x.sort()
        nodes, section = piece.length * x, spring.sections[i]
        found.append(kind(start=start, nodes=nodes, curvature=piece.curvature, section=section))
    return tuple(found)


def tie_matrix(
    pieces: Sequence[Piece],
    held: NDArray[np.bool_],
    straight: bool = False,
    between: Mapping[float, NDArray[np.bool_]] | None = None,
) -> csr_array:
    """Return T, which joins the pieces and builds in the supports.

    Parameters
    ----------
    pieces : sequence of Piece
    held : ndarray of bool, shape (2, nodal)
        Whether the support at each end holds each unknown of a node.
    straight : bool
        Whether to leave out u, the first unknown of each node and the inner ones, along a straight strip.
    between : mapping of float to ndarray of bool, shape (nodal,), optional
        Which unknowns the node at an arc length [m] has held.
    """
    begins = np.concatenate(([0], np.cumsum([piece.size for piece in pieces])))
    first, unknown = begins[:-1], np.arange(pieces[0].nodal)
    nodal = np.array([piece.nodal * piece.nodes.size for piece in pieces])
    last, k = first + nodal - unknown.size, np.array([piece.curvature for piece in pieces])
    free = np.ones(begins[-1], dtype=bool)
    free[first[1:, None] + unknown] = False  # follow from the piece before
    free[first[0] + unknown] &= ~held[0]
    free[last[-1] + unknown] &= ~held[1]
    for s, kept in (between or {}).items():
        which = max(
            i for i, piece in enumerate(pieces) if i == 0 or piece.start < s
        )  # at a joint, the one before
        node = int(np.argmin(np.abs(pieces[which].start + pieces[which].nodes - s)))
        free[first[which] + unknown.size * node + unknown] &= ~kept
    if straight:
        for start, inner, end in zip(first, first + nodal, begins[1:], strict=True):
            free[start : inner : unknown.size] = free[inner:end] = False
    follows, leads = (first[1:, None] + unknown).ravel(), (last[:-1, None] + unknown).ravel()
    jumping, by = pieces[0].curvature_jump
    weights = np.concatenate((free * 1.0, np.ones(follows.size), k[:-1] - k[1:]))
    rows = np.concatenate((np.arange(free.size), follows, first[1:] + jumping))
    columns = np.concatenate((np.arange(free.size), leads, last[:-1] + by))
    return csr_array((weights, (rows, columns)), shape=2 * free.shape)[:, np.flatnonzero(free)]


def tied_matrices(pieces: Sequence[Piece], ties: csr_array) -> list[csr_array]:
    """Return T^T A T for each of the `matrices` A of the pieces, T = `ties`."""
    parts = zip(*(piece.matrices() for piece in pieces), strict=True)
    return [ties.T @ block_diag(blocks, format="csr") @ ties for blocks in parts]


def motion_at(line: Centreline, pieces: Sequence[Piece], ties: csr_array, s: float) -> Array:
    """Return the motion of the cross-section at arc length `s` [m] as rows over the unknowns, (6, n_dofs):
    displacements along x, y, z [m] and rotations about them [rad]."""
    which = int(line.piece_at(s))
    piece, before = pieces[which], sum(piece.size for piece in pieces[:which])
    x, nodes = s - piece.start, piece.nodes
    element = int(np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2))
    local = np.clip((x - nodes[element]) / (nodes[element + 1] - nodes[element]), 0.0, 1.0)
    _, matrices = piece.sampling(np.array([local]), np.array([element]))
    rows = np.zeros((6, ties.shape[1]))
    for component, matrix in zip(piece.components, matrices, strict=True):
        rows[component] = (matrix @ ties[before : before + piece.size]).toarray()[0]
    turn = line.axes(s).T
    return np.concatenate((turn @ rows[:3], turn @ rows[3:]))


def motion_along(
    line: Centreline, pieces: Sequence[Piece], unknowns: Array, points_per_element: int
) -> tuple[Array, Array]:
    """Return arc lengths [m] (n_points,), and displacements and rotations in x, y, z, (2, n, n_points, 3).

    `unknowns`, of shape (unknowns of all pieces, n), holds n motions of the pieces before they are tied. Each
    element is sampled in `points_per_element` equal steps.
    """
    local = np.linspace(0.0, 1.0, points_per_element + 1)
    lengths, matrices = zip(*(piece.sampling(local) for piece in pieces), strict=True)
    s = np.concatenate(lengths)
    kept = np.arange(s.size) % local.size < points_per_element  # an element's end is the next one's start
    kept[-1] = True
    s = np.clip(s[kept], 0.0, line.length)
    fields = np.zeros((6, unknowns.shape[1], s.size))
    for component, part in zip(pieces[0].components, zip(*matrices, strict=True), strict=True):
        fields[component] = (block_diag(part, format="csr") @ unknowns)[kept].T
    return s, np.einsum("gikp,pic->gkpc", fields.reshape(2, 3, -1, s.size), line.axes(s))
