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

from dataclasses import dataclass
from typing import Any

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
class PieceMesh:
    """One piece of the centreline: from arc length `start` [m] on, `nodes` counted from there [m]."""

    start: float
    nodes: NDArray[np.float64]
    curvature: float
    section: StripSection

    @property
    def size(self) -> int:
        """Number of unknowns: those at the nodes, then those inside the elements."""
        return NODAL * self.nodes.size + (TANGENTIAL_DEGREE - 1) * (self.nodes.size - 1)

    def basis(self, **points: Any) -> tuple[sk.Basis, NDArray[np.float64]]:
        """Return the basis of (u, w) and the arc lengths of its points [m], shape (n_elements, n_points)."""
        middle = 0.5 * self.nodes[-1]
        element = sk.ElementComposite(sk.ElementLinePp(TANGENTIAL_DEGREE), sk.ElementLineHermite())
        basis = sk.Basis(sk.MeshLine(self.nodes - middle), element, **points)
        return basis, self.start + middle + np.asarray(basis.global_coordinates())[0]

    def sampling(
        self, local: NDArray[np.float64], elements: NDArray[np.intp] | None = None
    ) -> tuple[NDArray[np.float64], tuple[csr_array, ...]]:
        """Arc lengths [m] and matrices of u, w and rotation at `local` points (0 to 1) of the elements."""
        basis, s = self.basis(quadrature=(local[None, :], np.ones(local.size)), elements=elements)
        fields = [(u + 0.0, w + 0.0, w.grad[0] + self.curvature * u) for u, w in basis.basis]
        rows = np.tile(np.arange(s.size), basis.Nbfun)
        columns = np.repeat(basis.element_dofs, local.size, axis=1).ravel()
        entries = (np.concatenate([np.broadcast_to(field[i], s.shape) for field in fields]) for i in range(3))
        shape = (s.size, basis.N)
        return s.ravel(), tuple(csr_array((part.ravel(), (rows, columns)), shape=shape) for part in entries)

    def strain_energies(self, unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Strain energies in stretching and in bending [J] of `unknowns` [m], (size, n); shape (2, n)."""
        basis, _ = self.basis(intorder=QUADRATURE_ORDER)
        local = unknowns[basis.element_dofs]  # (functions of an element, elements, n)
        moduli = self.section.axial_stiffness, self.section.bending_stiffness
        energies = []
        for strain, modulus in zip((stretch, bend), moduli, strict=True):
            per_function = [strain(u, w, self.curvature) + 0.0 * basis.dx for u, w in basis.basis]
            values = np.einsum("fep,fen->epn", np.array(per_function), local)
            energies.append(0.5 * modulus * np.einsum("epn,ep->n", values**2, basis.dx))
        return np.array(energies)
