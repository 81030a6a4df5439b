"""One piece of a thin strip in space, straight or an arc, by finite elements in the arc length.

The centreline is a plane curve of curvature k with frame t, n and z = t x n; t' = k n, n' = -k t. A section
moves by u t + w n + v z and rotates by phi about t, without shear:

    rotation   theta = phi t - v' n + (w' + k u) z                                     [rad]
    strains    theta' = (phi' + k v') t + (k phi - v'') n + (w'' + k u') z             [1/m]

Out of the plane, with test functions (y, psi), v at the shear centre and the centroid at a n from there,

    twist      tau = phi' + k v'       [1/m]      warping  tau' = phi'' + k v''        [1/m^2]
    bending    chi = v'' - k phi       [1/m]

    int EI_n chi(v, phi) chi(y, psi) + GJ tau tau + EG tau' tau' ds
        + int m (v + a phi)..(y + a psi) + I phi..psi ds  =  -z_base.. int m e_z (y + a psi) ds

(V. Z. Vlasov, Thin-Walled Elastic Beams, ch. 2, for the straight piece; A. E. H. Love, A Treatise on the
Mathematical Theory of Elasticity, art. 293, for the strains of the arc with EG = 0). Left out: shear, and the
rotary inertia about n and z. An arc has no shear offset here. v and phi are cubic Hermite, which does not
lock (``docs/theory/beam.md``).
"""

from typing import Any

import skfem as sk
from scipy.sparse import csr_array

from ..pieces import Field, Piece
from ..record import record
from .section import SpatialSection


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


@record
class SidePiece(Piece):
    """A piece that moves out of the plane; its unknowns are v, v', phi, phi' at the nodes."""

    nodal = 4
    inner = 0
    components = (2, 3, 4)
    curvature_jump = (3, 1)

    section: SpatialSection

    @staticmethod
    def element() -> sk.Element:
        """Return the element of (v, phi), both cubic Hermite."""
        return sk.ElementComposite(sk.ElementLineHermite(), sk.ElementLineHermite())

    def motion(self, *functions: Field) -> tuple[Field, ...]:
        """Return v of the centroid [m], and the rotations about t and n [rad]."""
        v, phi = functions
        return v + self.section.shear_offset * phi, phi + 0.0, -v.grad[0]

    def matrices(self) -> tuple[csr_array, ...]:
        """Return K and M of the piece."""
        section, m, a = self.section, self.section.mass_per_length, self.section.shear_offset
        basis, _ = self.basis()
        stiffness = bending_and_twist.assemble(
            basis,
            EI=section.out_of_plane_stiffness,
            GJ=section.torsional_stiffness,
            EG=section.warping_stiffness,
            k=self.curvature,
        )
        return stiffness, inertia_out_of_plane.assemble(basis, m=m, a=a, I=section.polar_inertia)
