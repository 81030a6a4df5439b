"""One piece of a thin strip, straight or an arc, by Euler-Bernoulli finite elements in the arc length.

A point of the centreline moves by u t + w n relative to the base. With k the curvature, and t' = k n,
n' = -k t,

    stretch    u' - k w                             [1]
    rotation   w' + k u                             [rad]
    bending    (w' + k u)' = w'' + k u' on a piece  [1/m]

and virtual work for test functions (v, z) reads

    int EA (u' - k w)(v' - k z) + EI (w'' + k u')(z'' + k v') ds + int m (u.. v + w.. z) ds
        =  -z_base.. int m (e_t v + e_n z) ds,      e the drive direction.

EA [N], EI [N m^2] and m [kg/m] belong to the section. Shear and the rotary inertia of the strip itself are
left out.

w is cubic Hermite and u continuous of degree four, rich enough to cancel any cubic k w: thin arcs do not
lock. Coordinates on a piece run from its middle, which keeps the Hermite basis, built from powers of the
coordinate, accurate.

Rounding: an entry of the stiffness matrix is of the order EI/h^3 and carries the error eps EI/h^3, h the
length of an element, while the whole strip resists with EI/L^3; x^T K x of a slow shape is good to some
(L/h)^4 eps. The strains of the shape are good to (L/h)^2 eps, and so is the energy summed from them
(`PieceMesh.strain_energies`): 1e-12 where the matrix gives 1e-8.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .section import StripSection

#: Degree of the tangential displacement.
TANGENTIAL_DEGREE = 4
#: Exact for the product of two quartics.
QUADRATURE_ORDER = 2 * TANGENTIAL_DEGREE
#: Unknowns at a node of a piece, in this order: u, w, w'.
NODAL = 3

Direction = Callable[[NDArray[np.float64]], NDArray[np.float64]]
Field = Any  # values of a scikit-fem function at the quadrature points, with .grad and .hess


def stretch(u: Field, w: Field, k: float) -> Field:
    """Membrane strain u' - k w [1]."""
    return u.grad[0] - k * w


def bend(u: Field, w: Field, k: float) -> Field:
    """Change of curvature w'' + k u' [1/m]."""
    return w.hess[0, 0] + k * u.grad[0]


@sk.BilinearForm
def stretching(u: Field, w: Field, v: Field, z: Field, p: Any) -> Field:
    """int EA (u' - k w)(v' - k z) ds."""
    return p.EA * stretch(u, w, p.k) * stretch(v, z, p.k)


@sk.BilinearForm
def bending(u: Field, w: Field, v: Field, z: Field, p: Any) -> Field:
    """int EI (w'' + k u')(z'' + k v') ds."""
    return p.EI * bend(u, w, p.k) * bend(v, z, p.k)


@sk.BilinearForm
def inertia(u: Field, w: Field, v: Field, z: Field, p: Any) -> Field:
    """int m (u v + w z) ds."""
    return p.m * (u * v + w * z)


@sk.LinearForm
def base_motion(v: Field, z: Field, p: Any) -> Field:
    """int m (e_t v + e_n z) ds."""
    return p.m * (p.along * v + p.across * z)


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece(ABC):
    """One piece of the centreline: from arc length `start` [m] on, `nodes` counted from there [m].

    `assembly` ties pieces together by what follows, in the plane and in space alike. `moves` says which of
    u, w, v [m] and of the rotations about t, n, z [rad] `sampling` gives. Where the curvature k jumps by [k],
    the unknown i of a node jumps by -[k] times the unknown j, for each (i, j) of `kinks`.
    """

    moves: ClassVar[tuple[int, ...]]
    kinks: ClassVar[tuple[tuple[int, int], ...]]

    start: float
    nodes: NDArray[np.float64]
    curvature: float

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of unknowns."""

    @abstractmethod
    def node(self, number: int) -> NDArray[np.intp]:
        """Places of the unknowns of a node among those of the piece; -1 is the last node."""

    @abstractmethod
    def sampling(
        self, local: NDArray[np.float64], elements: NDArray[np.intp] | None = None
    ) -> tuple[NDArray[np.float64], list[csr_array]]:
        """Arc lengths [m] and matrices of what `moves`, at `local` points (0 to 1) of the elements."""

    @abstractmethod
    def matrices(self) -> tuple[csr_array, ...]:
        """K [N/m] and M [kg] of the piece alone, and what else `assembly` adds up."""

    @abstractmethod
    def base_load(self, direction: Direction) -> NDArray[np.float64]:
        """int m e . (test functions) ds [kg]; `direction` gives e along t, n, z, (3, ...), at arc lengths."""

    def basis(self, element: sk.Element, **points: Any) -> tuple[sk.Basis, NDArray[np.float64]]:
        """Return a basis on the piece and the arc lengths of its points [m], shape (n_elements, n_points)."""
        middle = 0.5 * self.nodes[-1]
        basis = sk.Basis(sk.MeshLine(self.nodes - middle), element, **points)
        return basis, self.start + middle + np.asarray(basis.global_coordinates())[0]


def plane_element() -> sk.Element:
    """(u, w)."""
    return sk.ElementComposite(sk.ElementLinePp(TANGENTIAL_DEGREE), sk.ElementLineHermite())


def at_points(local: NDArray[np.float64], elements: NDArray[np.intp] | None) -> dict[str, Any]:
    """Points of a basis: `local` (0 to 1) in these elements, or in all."""
    return {"quadrature": (local[None, :], np.ones(local.size)), "elements": elements}


def sampled(fields: Sequence[Field], dofs: NDArray[np.intp], shape: tuple[int, ...], size: int) -> csr_array:
    """Matrix (points, unknowns) from the values (n_elements, n_points) of each function of an element."""
    entries = np.concatenate([np.broadcast_to(field, shape) for field in fields]).ravel()
    points = math.prod(shape)
    places = np.tile(np.arange(points), len(fields)), np.repeat(dofs, shape[1], axis=1).ravel()
    return csr_array((entries, places), shape=(points, size))


@dataclass(frozen=True, kw_only=True, eq=False)
class PieceMesh(Piece):
    """A piece in the plane, with its section; unknowns: u, w, w' at the nodes, then u inside the elements."""

    moves = (0, 1, 5)
    kinks = ((2, 0),)

    section: StripSection

    @property
    def size(self) -> int:
        """Number of unknowns: those at the nodes, then those inside the elements."""
        return NODAL * self.nodes.size + (TANGENTIAL_DEGREE - 1) * (self.nodes.size - 1)

    @property
    def tangential(self) -> NDArray[np.bool_]:
        """Which unknowns are values of u, shape (size,)."""
        nodal = NODAL * self.nodes.size
        return (np.arange(self.size) >= nodal) | (np.arange(self.size) % NODAL == 0)

    def node(self, number: int) -> NDArray[np.intp]:
        """Places of u, w, w' of a node."""
        return NODAL * (number % self.nodes.size) + np.arange(NODAL)

    def sampling(
        self, local: NDArray[np.float64], elements: NDArray[np.intp] | None = None
    ) -> tuple[NDArray[np.float64], list[csr_array]]:
        """Arc lengths [m] and matrices of u, w [m] and rotation [rad] at `local` points of the elements."""
        basis, s = self.basis(plane_element(), **at_points(local, elements))
        moved = [(u + 0.0, w + 0.0, w.grad[0] + self.curvature * u) for u, w in basis.basis]
        fields = zip(*moved, strict=True)
        return s.ravel(), [sampled(field, basis.element_dofs, s.shape, basis.N) for field in fields]

    def matrices(self) -> tuple[csr_array, csr_array, csr_array]:
        """K, M and K with each stiffness times its loss factor."""
        basis, _ = self.basis(plane_element(), intorder=QUADRATURE_ORDER)
        section, k = self.section, self.curvature
        membrane = stretching.assemble(basis, EA=section.axial_stiffness, k=k)
        flexure = bending.assemble(basis, EI=section.bending_stiffness, k=k)
        loss = section.axial_loss_factor * membrane + section.bending_loss_factor * flexure
        return membrane + flexure, inertia.assemble(basis, m=section.mass_per_length), loss

    def base_load(self, direction: Direction) -> NDArray[np.float64]:
        """int m (e_t v + e_n z) ds."""
        basis, s = self.basis(plane_element(), intorder=QUADRATURE_ORDER)
        along, across, _ = direction(s)
        return base_motion.assemble(basis, m=self.section.mass_per_length, along=along, across=across)

    def strain_energies(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Strain energies in stretching and in bending [J] of `unknowns` [m], (size, n); shape (2, n)."""
        basis, _ = self.basis(plane_element(), intorder=QUADRATURE_ORDER)
        local = unknowns[basis.element_dofs]  # (functions of an element, elements, n)
        moduli = self.section.axial_stiffness, self.section.bending_stiffness
        energies = []
        for strain, modulus in zip((stretch, bend), moduli, strict=True):
            per_function = [strain(u, w, self.curvature) + 0.0 * basis.dx for u, w in basis.basis]
            values = np.einsum("fep,fen->epn", np.array(per_function), local)
            energies.append(0.5 * modulus * np.einsum("epn,ep->n", values**2, basis.dx))
        return np.array(energies)
