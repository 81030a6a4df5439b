"""One piece of a thin strip in space, straight or an arc, by finite elements in the arc length.

The centreline is a plane curve of curvature k with frame t, n and z = t x n; t' = k n, n' = -k t. A section
moves by u t + w n + v z and turns by phi about t, without shear:

    rotation   theta = phi t - v' n + (w' + k u) z                                     [rad]
    strains    theta' = (phi' + k v') t + (k phi - v'') n + (w'' + k u') z             [1/m]

so that motion in the plane (u, w: `strip_element`) and out of it (v, phi) do not couple. Out of the plane,
with test functions (y, psi), v measured at the shear centre and a the distance from there to the centroid,

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

from .spatial_section import SpatialSection
from .strip_element import NODAL, QUADRATURE_ORDER, TANGENTIAL_DEGREE, bending, inertia, stretching

#: Unknowns at a node, in this order: u, w, w' in the plane, v, v', phi, phi' out of it.
PLANE, SPACE = NODAL, 4
Field = Any  # values of a scikit-fem function at the quadrature points, with .grad and .hess


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
class SpatialPiece:
    """One piece of the centreline: from arc length `start` [m] on, `nodes` counted from there [m]."""

    start: float
    nodes: NDArray[np.float64]
    curvature: float
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
        """Places of u, w, w', v, v', phi, phi' of a node among the unknowns of the piece."""
        at = number % self.nodes.size
        plane, space = PLANE * at + np.arange(PLANE), SPACE * at + np.arange(SPACE)
        return np.concatenate((plane, self.plane_size + space))

    def matrices(self) -> tuple[csr_array, csr_array]:
        """K and M of the piece alone."""
        s, nodes = self.section, tuple(self.nodes.tolist())
        stretch, bend, move, bow_, twist_, warp_, across, turn, both = _unit_matrices(nodes, self.curvature)
        m, a = s.mass_per_length, s.shear_offset
        plane = s.axial_stiffness * stretch + s.in_plane_stiffness * bend
        space = s.out_of_plane_stiffness * bow_ + s.torsional_stiffness * twist_ + s.warping_stiffness * warp_
        turning = m * across + (m * a) * both + (m * a**2 + s.polar_inertia) * turn
        return csr_array(block_diag([plane, space])), csr_array(block_diag([m * move, turning]))

    def sampling(
        self, local: NDArray[np.float64], elements: NDArray[np.intp] | None = None
    ) -> tuple[NDArray[np.float64], tuple[csr_array, ...]]:
        """Arc lengths [m] and matrices of u, w, v of the centroid [m] and of the three rotations [rad].

        At `local` points (0 to 1) of the elements; the rotations are about t, n and z.
        """
        bases, s = self._bases(local, elements)
        k, a = self.curvature, self.section.shear_offset
        fields: list[list[Any]] = [[] for _ in range(6)]
        columns = [bases[0].element_dofs, self.plane_size + bases[1].element_dofs]
        for u, w in bases[0].basis:
            for place, value in zip((0, 1, 5), (u + 0.0, w + 0.0, w.grad[0] + k * u), strict=True):
                fields[place].append(value)
        for v, phi in bases[1].basis:
            for place, value in zip((2, 3, 4), (v + a * phi, phi + 0.0, -v.grad[0]), strict=True):
                fields[place].append(value)
        found = []
        for place, field in enumerate(fields):
            where = columns[0] if place in (0, 1, 5) else columns[1]
            entries = np.concatenate([np.broadcast_to(part, s.shape) for part in field]).ravel()
            rows = np.tile(np.arange(s.size), where.shape[0])
            at = np.repeat(where, local.size, axis=1).ravel()
            found.append(csr_array((entries, (rows, at)), shape=(s.size, self.size)))
        return s.ravel(), tuple(found)

    def _bases(
        self, local: NDArray[np.float64] | None = None, elements: NDArray[np.intp] | None = None
    ) -> tuple[tuple[sk.Basis, sk.Basis], NDArray[np.float64]]:
        """Bases of (u, w) and of (v, phi), and arc lengths of their points [m]."""
        bases = _bases_on(
            tuple(self.nodes.tolist()),
            None if local is None else tuple(local.tolist()),
            None if elements is None else tuple(elements.tolist()),
        )
        return bases, self.start + 0.5 * self.nodes[-1] + np.asarray(bases[0].global_coordinates())[0]


@lru_cache(maxsize=128)
def _bases_on(
    nodes: tuple[float, ...], local: tuple[float, ...] | None, elements: tuple[int, ...] | None
) -> tuple[sk.Basis, sk.Basis]:
    """Bases about the middle of a piece, at `local` points or Gauss's. Kept: springs differ in their sections
    more often than in their meshes."""
    mesh = sk.MeshLine(np.array(nodes) - 0.5 * nodes[-1])
    plane = sk.ElementComposite(sk.ElementLinePp(TANGENTIAL_DEGREE), sk.ElementLineHermite())
    space = sk.ElementComposite(sk.ElementLineHermite(), sk.ElementLineHermite())
    points: dict[str, Any] = {"intorder": QUADRATURE_ORDER}
    if local is not None:
        points = {"quadrature": (np.array([local]), np.ones(len(local)))}
    if elements is not None:
        points["elements"] = np.array(elements)
    return sk.Basis(mesh, plane, **points), sk.Basis(mesh, space, **points)


@lru_cache(maxsize=64)
def _unit_matrices(nodes: tuple[float, ...], k: float) -> tuple[csr_array, ...]:
    """The matrices of a piece for EA, EI_z and m of 1 in the plane, for EI_n, GJ, EG, m, I and m a of 1 out
    of it. Kept, as the bases are."""
    plane, space = _bases_on(nodes, None, None)
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
