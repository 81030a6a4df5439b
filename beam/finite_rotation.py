"""A leaf spring at finite rotations: its strain energy, forces and tangent stiffness.

With u, w [m] along tangent and normal of the centreline at rest, k its curvature and r the position,

    r' = (1 + a) t + b n,     a = u' - k w,     b = w' + k u,                                     [1]

the strip is stretched by e = |r'| - 1 and its tangent has turned by the angle p with sin p = b/(1 + e).
Euler-Bernoulli's strip stores

    V = int EA e^2/2 + EI p'^2/2 ds,     p' = b'/sqrt(1 - b^2),                                   [J]

without shear. Of e, a few parts in 1e5, the bending takes no notice: whether a moment goes with the turn per
length at rest or per length now is a question of that order as well, which the theory of thin strips leaves
open. Rotations stay below a quarter turn. Everything else is linear in u and w, as it is for small motions:
supports, masses, the tip and its displacement, so that mesh, ties and M are those of `assembly`, but for u,
which a straight strip has here too: its end comes nearer as it bends.

Under rigid rotations of any angle e and p' vanish to the last digit, on arcs as well (b is the sine of it).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, bsr_array, csr_array, vstack

from .assembly import assemble
from .modes import COUPLING_TOLERANCE, DENSE_LIMIT, lowest
from .parameters import require, require_kind
from .pieces import Field
from .spring import LeafSpring
from .strip_element import PieceMesh, bend, stretch

Array = NDArray[np.float64]


def rotation(u: Field, w: Field, k: float) -> Field:
    """b = w' + k u [1]."""
    return w.grad[0] + k * u


STRAINS = (stretch, rotation, bend)
"""a, b and b' of an element's functions."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FiniteRotation:
    """A leaf spring in n_dofs degrees of freedom, without damping: M x'' + f(x) = -b z'' + tip * force.

    Parameters
    ----------
    spring : LeafSpring
    mass : sparse array, shape (n_dofs, n_dofs)
    base_load, tip : ndarray, shape (n_dofs,)
        b, and the row that gives the displacement of the tip along the drive, as in `Discretization`.
    strains : tuple of three sparse arrays, shape (n_points, n_dofs)
        a, b, b' at Gauss's points of all elements.
    axial, bending : ndarray, shape (n_points,)
        EA and EI there, times the length that a point stands for [N m, N m^3].
    """

    spring: LeafSpring
    mass: csr_array
    base_load: Array
    tip: Array
    strains: tuple[csr_array, csr_array, csr_array]
    axial: Array
    bending: Array

    @classmethod
    def of(cls, spring: LeafSpring, elements: int | Sequence[int] | None = None) -> FiniteRotation:
        """The model of a spring, with so many `elements` on every piece or on each, as for `assemble`."""
        require_kind("spring", spring, LeafSpring, "a LeafSpring")
        linear = assemble(spring, elements, shortening=True)
        parts = [_points(piece) for piece in linear.pieces]
        strains, axial, bending = zip(*parts, strict=True)
        a, b, change = (block_diag(kind, format="csr") @ linear.ties for kind in zip(*strains, strict=True))
        return cls(
            spring=spring, mass=linear.mass, base_load=linear.base_load, tip=linear.tip,
            strains=(a, b, change), axial=np.concatenate(axial), bending=np.concatenate(bending),
        )  # fmt: skip

    @cached_property
    def first_mode(self) -> tuple[float, Array]:
        """omega_1 [rad/s] of small motions and the shape of mode 1 with unit tip displacement.

        ValueError if the supports leave a rigid motion, or mode 1 leaves the tip at rest.
        """
        rigid = self.spring.rigid_motions
        require(not rigid, f"supports leave {rigid} motions without strain [no unit]; they must leave none")
        stiffness = self.stiffness(self.densities(np.zeros_like(self.tip)))
        square, shapes = lowest(stiffness, self.mass, 0.0, 1, dense_limit=DENSE_LIMIT)
        shape, moved = shapes[:, 0], self.tip @ shapes[:, 0]
        whole = (self.spring.strip_mass + self.spring.tip.mass) / (shape @ (self.mass @ shape))
        moves = moved**2 * whole > COUPLING_TOLERANCE**2
        require(moves, "mode 1 of the spring leaves the tip at rest [no unit]; it must move it")
        return float(np.sqrt(square[0])), shape / moved

    def energy(self, x: Array) -> Array:
        """V [J] of displacements x [m], shape (n_dofs, ...)."""
        a, b, change = (strain @ x for strain in self.strains)
        stretched = np.hypot(1.0 + a, b) - 1.0
        return 0.5 * (self.axial @ stretched**2 + self.bending @ (change**2 / (1.0 - b**2)))

    def force(self, x: Array) -> Array:
        """f = dV/dx [N], of the shape of x."""
        a, b, change = (strain @ x for strain in self.strains)
        axial, bending = (part.reshape((-1,) + (1,) * (x.ndim - 1)) for part in (self.axial, self.bending))
        long, left = np.hypot(1.0 + a, b), 1.0 / (1.0 - b**2)
        pull = axial * (1.0 - 1.0 / long)
        stresses = pull * (1.0 + a), pull * b + bending * change**2 * b * left**2, bending * change * left
        return sum(strain.T @ stress for strain, stress in zip(self.strains, stresses, strict=True))

    def densities(self, x: Array) -> Array:
        """Second derivatives of the energy of each point in (a, b, b') [N m]; shape (3, 3, n_points, ...)."""
        a, b, change = (strain @ x for strain in self.strains)
        axial, bending = (part.reshape((-1,) + (1,) * (x.ndim - 1)) for part in (self.axial, self.bending))
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
        """The matrix of `densities` at one x, or of a sum of them over several, (3, 3, n_points)."""
        points = np.arange(self.axial.size + 1)
        blocks = bsr_array((np.moveaxis(densities, 2, 0), points[:-1], points))
        return csr_array(self._by_point.T @ (blocks @ self._by_point))

    @cached_property
    def _by_point(self) -> csr_array:
        """a, b and b' point by point, (3 n_points, n_dofs)."""
        order = np.arange(3 * self.axial.size).reshape(3, -1).T.ravel()
        return csr_array(vstack(self.strains, format="csr")[order])


def _points(piece: PieceMesh) -> tuple[list[csr_array], Array, Array]:
    """Strains, EA ds and EI ds at the points of a piece."""
    basis, s = piece.basis()
    rows, columns = np.tile(np.arange(s.size), basis.Nbfun), np.repeat(basis.element_dofs, s.shape[1], axis=1)
    found = []
    for strain in STRAINS:
        values = [np.broadcast_to(strain(u, w, piece.curvature), s.shape) for u, w in basis.basis]
        entries = np.array(values).ravel(), (rows, columns.ravel())
        found.append(csr_array(entries, shape=(s.size, basis.N)))
    length, section = np.asarray(basis.dx).ravel(), piece.section
    return found, section.axial_stiffness * length, section.bending_stiffness * length
