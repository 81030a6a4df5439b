"""One piece of a thin strip, straight or an arc, by Euler-Bernoulli finite elements in the arc length.

A point of the centreline moves by u t + w n relative to the base. With k the curvature,

    stretch u' - k w  [1],     rotation w' + k u  [rad],     bending w'' + k u' on a piece  [1/m],

and virtual work for test functions (v, z) reads

    int EA (u' - k w)(v' - k z) + EI (w'' + k u')(z'' + k v') ds + int m (u.. v + w.. z) ds
        =  -z_base.. int m (e_t v + e_n z) ds,      e the drive direction.

EA [N], EI [N m^2] and m [kg/m] belong to the section. w is cubic Hermite. u is continuous of degree four, so
that u' can cancel any cubic k w: thin arcs do not lock. x^T K x of a slow shape is accurate to (L/h)^4 eps, h
the length of an element and L of the strip, but the energy summed from strains (`PieceMesh.strain_energies`)
to (L/h)^2 eps. Derivation: ``docs/theory/beam.md``.
"""

from typing import Any

import numpy as np
import skfem as sk
from scipy.sparse import csr_array

from .parameters import Array, record
from .pieces import TANGENTIAL_DEGREE, Field, Piece
from .section import BeamSection, StripSection


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


@record
class PieceMesh(Piece):
    """A piece that moves in the plane; its unknowns are u, w, w' at the nodes, then u inside the elements."""

    nodal = 3
    inner = TANGENTIAL_DEGREE - 1
    components = (0, 1, 5)
    curvature_jump = (2, 0)

    section: StripSection | BeamSection

    @staticmethod
    def element() -> sk.Element:
        """Return the element of (u, w), quartic and cubic Hermite."""
        return sk.ElementComposite(sk.ElementLinePp(TANGENTIAL_DEGREE), sk.ElementLineHermite())

    def motion(self, *functions: Field) -> tuple[Field, ...]:
        """Return u, w [m] and w' + k u [rad]."""
        u, w = functions
        return u + 0.0, w + 0.0, w.grad[0] + self.curvature * u

    def matrices(self) -> tuple[csr_array, ...]:
        """Return K, M, and K with each stiffness times its loss factor."""
        basis, _ = self.basis()
        section, k = self.section, self.curvature
        membrane = stretching.assemble(basis, EA=section.axial_stiffness, k=k)
        flexure = bending.assemble(basis, EI=section.bending_stiffness, k=k)
        loss = section.axial_loss_factor * membrane + section.bending_loss_factor * flexure
        return membrane + flexure, inertia.assemble(basis, m=section.mass_per_length), loss

    def strain_energies(self, unknowns: Array) -> Array:
        """Return the energies of stretching and bending [J], (2, n), of `unknowns` [m], (size, n)."""
        basis, _ = self.basis()
        local = unknowns[basis.element_dofs]  # (functions of an element, elements, n)
        moduli = self.section.axial_stiffness, self.section.bending_stiffness
        energies = []
        for strain, modulus in zip((stretch, bend), moduli, strict=True):
            per_function = [strain(u, w, self.curvature) + 0.0 * basis.dx for u, w in basis.basis]
            values = np.einsum("fep,fen->epn", np.array(per_function), local)
            energies.append(0.5 * modulus * np.einsum("epn,ep->n", values**2, basis.dx))
        return np.array(energies)
