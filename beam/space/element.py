"""One piece of a thin strip in space, straight or an arc, by finite elements in the arc length.

The centreline is a plane curve of curvature k with frame t, n and z = t x n; t' = k n, n' = -k t. A section
moves by u t + w n + v z and turns by phi about t, without shear:

    rotation   theta = phi t - v' n + (w' + k u) z                                     [rad]
    strains    theta' = (phi' + k v') t + (k phi - v'') n + (w'' + k u') z             [1/m]

so that motion in the plane (u, w: `beam.strip_element`) and out of it (v, phi) do not couple. Out of the
plane, with test functions (y, psi), v measured at the shear centre and the centroid at a n from there,

    twist      tau = phi' + k v'       [1/m]      warping  tau' = phi'' + k v''        [1/m^2]
    bending    chi = v'' - k phi       [1/m]

    int EI_n chi(v, phi) chi(y, psi) + GJ tau tau + EG tau' tau' ds
        + int m (v + a phi)..(y + a psi) + I phi..psi ds  =  -z_base.. int m e_z (y + a psi) ds

(V. Z. Vlasov, Thin-Walled Elastic Beams, ch. 2, for the straight piece; A. E. H. Love, A Treatise on the
Mathematical Theory of Elasticity, art. 293, for the strains of the arc with EG = 0). Left out: shear, and the
rotary inertia about n and z. An arc has no shear offset here.

v and phi are cubic Hermite. Under chi = 0 a cubic v asks for a linear phi, which is among them, so that
strips that are stiff edgewise and tight arcs do not lock. Coordinates run from the middle of the piece.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array

from ..strip_element import (
    NODAL,
    QUADRATURE_ORDER,
    TANGENTIAL_DEGREE,
    Direction,
    Field,
    Piece,
    at_points,
    base_motion,
    bending,
    inertia,
    plane_element,
    sampled,
    stretching,
)
from .section import SpatialSection

#: Unknowns at a node, in this order: u, w, w' in the plane, v, v', phi, phi' out of it.
PLANE, SPACE = NODAL, 4


def twist(v: Field, phi: Field, k: float) -> Field:
    """tau = phi' + k v' [1/m]."""
    return phi.grad[0] + k * v.grad[0]


def warp(v: Field, phi: Field, k: float) -> Field:
    """tau' = phi'' + k v'' [1/m^2]."""
    return phi.hess[0, 0] + k * v.hess[0, 0]


def bow(v: Field, phi: Field, k: float) -> Field:
    """chi = v'' - k phi [1/m]."""
    return v.hess[0, 0] - k * phi


@sk.BilinearForm
def bending_and_twist(v: Field, phi: Field, y: Field, psi: Field, p: Any) -> Field:
    """int EI_n chi chi + GJ tau tau + EG tau' tau' ds."""
    return (
        p.EI * bow(v, phi, p.k) * bow(y, psi, p.k)
        + p.GJ * twist(v, phi, p.k) * twist(y, psi, p.k)
        + p.EG * warp(v, phi, p.k) * warp(y, psi, p.k)
    )


@sk.BilinearForm
def inertia_out_of_plane(v: Field, phi: Field, y: Field, psi: Field, p: Any) -> Field:
    """int m (v + a phi)(y + a psi) + I phi psi ds."""
    return p.m * (v + p.a * phi) * (y + p.a * psi) + p.I * phi * psi


@dataclass(frozen=True, kw_only=True, eq=False)
class SpatialPiece(Piece):
    """A piece in space, with its section; unknowns: in the plane as in `PieceMesh`, then v, v', phi, phi'."""

    moves = (0, 1, 5, 2, 3, 4)
    kinks = ((2, 0), (6, 4))

    section: SpatialSection

    @property
    def plane_size(self) -> int:
        """Number of unknowns in the plane: those at the nodes, then those inside the elements."""
        return PLANE * self.nodes.size + (TANGENTIAL_DEGREE - 1) * (self.nodes.size - 1)

    @property
    def size(self) -> int:
        """Number of unknowns: in the plane, then out of it."""
        return self.plane_size + SPACE * self.nodes.size

    def node(self, number: int) -> NDArray[np.intp]:
        """Places of u, w, w', v, v', phi, phi' of a node."""
        at = number % self.nodes.size
        plane, space = PLANE * at + np.arange(PLANE), SPACE * at + np.arange(SPACE)
        return np.concatenate((plane, self.plane_size + space))

    def matrices(self) -> tuple[csr_array, csr_array]:
        """K and M."""
        s, nodes = self.section, tuple(self.nodes.tolist())
        stretch, bend, move, bow_, twist_, warp_, across, turn, both = _unit_matrices(nodes, self.curvature)
        m, a = s.mass_per_length, s.shear_offset
        plane = s.axial_stiffness * stretch + s.in_plane_stiffness * bend
        space = s.out_of_plane_stiffness * bow_ + s.torsional_stiffness * twist_ + s.warping_stiffness * warp_
        turning = m * across + (m * a) * both + (m * a**2 + s.polar_inertia) * turn
        return csr_array(block_diag([plane, space])), csr_array(block_diag([m * move, turning]))

    def base_load(self, direction: Direction) -> NDArray[np.float64]:
        """int m (e_t y_u + e_n y_w) ds, then int m e_z (y + a psi) ds."""
        plane, s = self.basis(plane_element(), intorder=QUADRATURE_ORDER)
        space, _ = self.basis(space_element(), intorder=QUADRATURE_ORDER)
        m, a = self.section.mass_per_length, self.section.shear_offset
        along, across, up = direction(s)
        loads = (
            base_motion.assemble(plane, m=m, along=along, across=across),
            base_motion.assemble(space, m=m, along=up, across=a * up),
        )
        return np.concatenate(loads)

    def sampling(
        self, local: NDArray[np.float64], elements: NDArray[np.intp] | None = None
    ) -> tuple[NDArray[np.float64], list[csr_array]]:
        """Arc lengths [m] and matrices of u, w [m], the turn about z, v of the centroid, the turns about t
        and n, at `local` points (0 to 1) of the elements."""
        k, a = self.curvature, self.section.shear_offset
        plane, s = self.basis(plane_element(), **at_points(local, elements))
        space, _ = self.basis(space_element(), **at_points(local, elements))
        in_plane = [(u + 0.0, w + 0.0, w.grad[0] + k * u) for u, w in plane.basis]
        out_of_it = [(v + a * phi, phi + 0.0, -v.grad[0]) for v, phi in space.basis]
        families = (in_plane, plane.element_dofs), (out_of_it, self.plane_size + space.element_dofs)
        return s.ravel(), [
            sampled(field, dofs, s.shape, self.size)
            for fields, dofs in families
            for field in zip(*fields, strict=True)
        ]


def space_element() -> sk.Element:
    """(v, phi)."""
    return sk.ElementComposite(sk.ElementLineHermite(), sk.ElementLineHermite())


@lru_cache(maxsize=64)
def _unit_matrices(nodes: tuple[float, ...], k: float) -> tuple[csr_array, ...]:
    """The matrices of a piece for EA, EI_z and m of 1 in the plane, for EI_n, GJ, EG, m, I and m a of 1 out
    of it. Kept: springs differ in their sections more often than in their meshes."""
    mesh = sk.MeshLine(np.array(nodes) - 0.5 * nodes[-1])
    plane, space = (
        sk.Basis(mesh, element, intorder=QUADRATURE_ORDER) for element in (plane_element(), space_element())
    )
    zero = {"EI": 0.0, "GJ": 0.0, "EG": 0.0}
    stiff = [bending_and_twist.assemble(space, **{**zero, name: 1.0}, k=k) for name in zero]
    across, turn, together = (
        inertia_out_of_plane.assemble(space, m=m, a=a, I=i)
        for m, a, i in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 0.0))
    )
    found = (
        stretching.assemble(plane, EA=1.0, k=k),
        bending.assemble(plane, EI=1.0, k=k),
        inertia.assemble(plane, m=1.0),
        *stiff,
        across,
        turn,
        together - across - turn,
    )
    return tuple(csr_array(matrix) for matrix in found)
