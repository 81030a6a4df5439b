"""A leaf spring at finite rotations: its strain energy, forces and tangent stiffness.

With u, w [m] along tangent and normal of the centreline at rest, k its curvature and r the position,

    r' = (1 + a) t + b n,     a = u' - k w,     b = w' + k u,                                     [1]

the stretch of the strip is e = |r'| - 1 and the rotation of its tangent the angle p, sin p = b/(1 + e). The
strain energy of Euler-Bernoulli's strip, for rotations below a quarter turn, is

    V = int EA e^2/2 + EI p'^2/2 ds,     p' = b'/sqrt(1 - b^2).                                   [J]

p' neglects e. Supports, masses, the tip and its displacement are linear in u and w, as in small motions.
Mesh, ties and M therefore come from ``beam.assembly``. A straight strip keeps u here, since its end comes
nearer as it bends.
See ``docs/theory/beam.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, bsr_array, csr_array, vstack

from ..assembly import Discretization, assemble
from ..modes import natural_modes
from ..parameters import Array, record, require
from ..pieces import Field
from ..spring import LeafSpring
from ..strip_element import bend, stretch


def _strains(u: Field, w: Field, k: float) -> tuple[Field, ...]:
    """Return a, b [1] and b' [1/m] of an element's functions."""
    return stretch(u, w, k), w.grad[0] + k * u, bend(u, w, k)


def _stretched(a: Array, b: Array) -> Array:
    """Return e [1] without loss of digits for small a and b."""
    return (a * (2.0 + a) + b**2) / (1.0 + np.hypot(1.0 + a, b))


@record
class FiniteRotation:
    """A leaf spring in n_dofs degrees of freedom, without damping: M x'' + f(x) = -b z'' + tip * force.

    The class method `of` makes it from a `LeafSpring`.

    Parameters
    ----------
    linear : Discretization
        Model of small motions: K = df/dx at rest, M, b and the row of the tip.
    strains : tuple of three sparse arrays, shape (n_points, n_dofs)
        Matrices that give a, b [1] and b' [1/m] at Gauss's points of all elements, as ``strain @ x``.
    axial, bending : ndarray, shape (n_points,)
        EA and EI there, times the weight of the point in the integral [N m, N m^3].
    """

    linear: Discretization
    strains: tuple[csr_array, csr_array, csr_array]
    axial: Array
    bending: Array

    @classmethod
    def of(cls, spring: LeafSpring, elements: int | Sequence[int] | None = None) -> FiniteRotation:
        """Return the model of a `LeafSpring`, with `elements` as for `beam.assemble`."""
        linear = assemble(spring, elements, shortening=True)
        kinds, stiff = [], []
        for piece in linear.pieces:
            kinds.append(piece.sampling(of=partial(_strains, k=piece.curvature))[1])
            moduli = piece.section.axial_stiffness, piece.section.bending_stiffness
            stiff.append(np.multiply.outer(moduli, np.asarray(piece.basis()[0].dx).ravel()))
        a, b, change = (block_diag(kind, format="csr") @ linear.ties for kind in zip(*kinds, strict=True))
        axial, bending = np.concatenate(stiff, axis=1)
        return cls(linear=linear, strains=(a, b, change), axial=axial, bending=bending)

    @cached_property
    def first_mode(self) -> tuple[float, Array]:
        """Angular frequency [rad/s] and shape [1], shape (n_dofs,), of the first mode that moves the tip.

        The shape has unit tip displacement. ValueError if the supports leave a rigid motion, or none of the
        first ten modes moves the tip.
        """
        rigid = self.linear.spring.rigid_motions
        require(not rigid, "supports", f"leave {rigid} motions without strain [no unit]; none may be left")
        modes = natural_modes(self.linear, min(10, self.linear.n_dofs))
        moving = np.flatnonzero(modes.phi)
        require(moving.size > 0, "none of the first modes moves the tip [no unit]; one of them must")
        return float(modes.omega[moving[0]]), modes.shapes[:, moving[0]] / modes.phi[moving[0]]

    def _moduli(self, x: Array) -> tuple[Array, Array]:
        """Return `axial` and `bending` in a shape that multiplies strains of x."""
        return self.axial.reshape(tail := (-1,) + (1,) * (x.ndim - 1)), self.bending.reshape(tail)

    def energy(self, x: Array) -> Array:
        """Return V [J] of displacements x [m], shape (n_dofs, ...)."""
        a, b, change = (strain @ x for strain in self.strains)
        stretched = _stretched(a, b)
        return 0.5 * (self.axial @ stretched**2 + self.bending @ (change**2 / (1.0 - b**2)))

    def force(self, x: Array) -> Array:
        """Return f = dV/dx [N], of the shape of x [m], (n_dofs, ...)."""
        a, b, change = (strain @ x for strain in self.strains)
        axial, bending = self._moduli(x)
        e, left = _stretched(a, b), 1.0 / (1.0 - b**2)
        pull = axial * e / (1.0 + e)
        stresses = pull * (1.0 + a), pull * b + bending * change**2 * b * left**2, bending * change * left
        return sum(strain.T @ stress for strain, stress in zip(self.strains, stresses, strict=True))

    def densities(self, x: Array) -> Array:
        """Return second derivatives of each point's energy in (a, b, b') [N m], (3, 3, n_points, ...)."""
        a, b, change = (strain @ x for strain in self.strains)
        axial, bending = self._moduli(x)
        long, left = np.hypot(1.0 + a, b), 1.0 / (1.0 - b**2)
        found = np.zeros((3, 3, *a.shape))
        found[0, 0] = axial * (1.0 - b**2 / long**3)
        found[0, 1] = found[1, 0] = axial * (1.0 + a) * b / long**3
        found[1, 1] = axial * (1.0 - (1.0 + a) ** 2 / long**3)
        found[1, 1] += bending * change**2 * (1.0 + 3.0 * b**2) * left**3
        found[1, 2] = found[2, 1] = 2.0 * bending * change * b * left**2
        found[2, 2] = bending * left
        return found

    def stiffness(self, densities: NDArray[Any]) -> csr_array:
        """Return d^2V/dx^2 [N/m] from `densities` at one x, (3, 3, n_points), or from a sum of such."""
        points = np.arange(self.axial.size + 1)
        blocks = bsr_array((np.moveaxis(densities, 2, 0), points[:-1], points))
        return csr_array(self._by_point.T @ (blocks @ self._by_point))

    @cached_property
    def _by_point(self) -> csr_array:
        """Matrix of a, b and b' point by point, (3 n_points, n_dofs)."""
        order = np.arange(3 * self.axial.size).reshape(3, -1).T.ravel()
        return csr_array(vstack(self.strains, format="csr")[order])
