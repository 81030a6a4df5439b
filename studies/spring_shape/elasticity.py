"""Linear elasticity of a swept solid: modes with the tip on one cross-section.

For displacements u and test functions v [m], strain e(u) = (grad u + grad u^T)/2, a base that moves by z_base
along the unit vector e, and Lame's constants lambda = E nu/((1 + nu)(1 - 2 nu)), G = E/(2 (1 + nu)) [Pa],

    int lambda div u div v + 2 G e(u) : e(v) dV + int rho u.. . v dV = -z_base.. int rho e . v dV,

u = 0 on the clamped ends: a clamp holds the section against curling and warping too. u is triquadratic (27
nodes), so that strips of one element through the thickness bend without locking, pure bending exactly.

The tip of mass M [kg] and rotary inertia J [kg m^2] moves with its cross-section A, on the mean,

    d = int u dA / A,    theta_t = int (y u_z - z u_y) dA / int (y^2 + z^2) dA,
    theta_n = int z u_t dA / int z^2 dA,    theta_z = -int y u_t dA / int y^2 dA     (y from the centroid),

which holds neither curling nor warping of that section. These are also the displacements that strip theories
speak of, and p = e . d is the displacement of the tip.

Motion that is symmetric in z (u_z odd: bending in the plane of the centreline) and motion that is
antisymmetric (u_t, u_n odd: out of it, twist) are solved apart on the half z >= 0, with u_z = 0 or
u_x = u_y = 0 at z = 0 and all energies doubled.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from beam import Material, Tip
from studies.spring_shape.swept_mesh import SweptMesh

#: Three Gauss points each way: exact for the stiffness of a brick.
QUADRATURE_ORDER = 5
Parity = Literal["symmetric", "antisymmetric"]
#: Which of d_x, d_y, d_z, theta_x, theta_y, theta_z each parity has.
MOVES: dict[str, tuple[int, ...]] = {"symmetric": (0, 1, 5), "antisymmetric": (2, 3, 4)}


@dataclass(frozen=True, kw_only=True, eq=False)
class SolidSpring:
    """A swept solid, clamped at s = 0, at the far end or at both; the tip at a station of the mesh.

    `tip_at` is an arc length [m], `drive` the unit vector e; the rotary inertia of the tip counts about every
    axis.
    """

    solid: SweptMesh
    material: Material
    clamped: tuple[bool, bool]
    tip: Tip
    tip_at: float
    drive: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        if len(self.clamped) != 2 or not any(self.clamped):
            raise ValueError(f"clamped is {self.clamped}; at least one end of two must be clamped")
        nearest = float(np.min(np.abs(self.solid.stations - self.tip_at)))
        if nearest > 1e-9 * self.solid.centreline.length:
            raise ValueError(f"tip_at is {self.tip_at} m; the nearest station of the mesh is {nearest} m off")


@dataclass(frozen=True, kw_only=True, eq=False)
class SolidModes:
    """Mass-normalised modes of one parity, lowest first, with phi >= 0."""

    omega: NDArray[np.float64]
    """[rad/s], shape (n_modes,)"""
    phi: NDArray[np.float64]
    """e . d of the section at the tip [kg^(-1/2)], shape (n_modes,)"""
    section: NDArray[np.float64]
    """d along x, y, z [kg^(-1/2)] and theta about them [kg^(-1/2) m^(-1)], shape (n_modes, 6)"""

    @property
    def frequencies_hz(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)


def solid_modes(spring: SolidSpring, parity: Parity, count: int) -> SolidModes:
    """Return the `count` lowest modes of one parity."""
    basis, stiffness, mass = assembled(spring)
    free = _free(spring, basis, parity)
    rows = _section_rows(spring, basis, parity)
    lumped = np.repeat([spring.tip.mass, spring.tip.rotary_inertia], 3)
    carried = csr_array(np.sqrt(lumped)[:, None] * rows)
    mass = mass + carried.T @ carried
    k, m = (csc_array(matrix)[free][:, free] for matrix in (stiffness, mass))
    factors = splu(k, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, factors.solve, dtype=np.float64)
    start = np.cos(np.arange(k.shape[0]))  # fixed, so that results repeat, and orthogonal to no mode
    values, x = eigsh(k, count, M=m, sigma=0.0, OPinv=inverse, v0=start)
    order = np.argsort(values)
    full = np.zeros((stiffness.shape[0], count))
    full[free] = x[:, order]
    full /= np.sqrt(np.einsum("ik,ik->k", full, mass @ full))
    phi = np.array(spring.drive) @ (rows[:3] @ full)
    full *= np.where(phi < 0.0, -1.0, 1.0)
    return SolidModes(omega=np.sqrt(values[order]), phi=np.abs(phi), section=(rows @ full).T)


@lru_cache(maxsize=2)  # both parities of a spring ask for them, one after the other
def assembled(spring: SolidSpring) -> tuple[sk.Basis, csr_array, csr_array]:
    """Scalar basis, K and M without tip and supports; unknown 3 i + c is component c at node i.

    D_{ia,jb} = int d_a N_i d_b N_j dV holds everything: K_{ia,jb} = lambda D_{ia,jb} + G (D_{ib,ja} +
    delta_ab sum_c D_{ic,jc}). One product of small matrices for each element replaces the 81 x 81 forms that
    a vector element would integrate one by one, fifty times faster.
    """
    basis = sk.Basis(spring.solid.mesh, sk.ElementHex2(), intorder=QUADRATURE_ORDER)
    e, nu = spring.material.youngs_modulus, spring.material.poissons_ratio
    lame, shear = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), spring.material.shear_modulus
    gradients = np.array([function[0].grad for function in basis.basis])  # (27, 3, elements, points)
    n, cells = basis.Nbfun, basis.nelems
    flat = gradients.transpose(2, 0, 1, 3).reshape(cells, 3 * n, -1)
    d = ((flat * basis.dx[:, None, :]) @ flat.transpose(0, 2, 1)).reshape(cells, n, 3, n, 3)
    local = lame * d + shear * d.transpose(0, 1, 4, 3, 2)
    squares = shear * np.einsum("eicjc->eij", d)
    values = np.array([np.broadcast_to(function[0], basis.dx.shape) for function in basis.basis])
    heavy = spring.material.density * np.einsum("iep,jep,ep->eij", values, values, basis.dx, optimize=True)
    inertia = np.zeros_like(local)
    for c in range(3):
        local[:, :, c, :, c] += squares
        inertia[:, :, c, :, c] = heavy
    dofs = (3 * basis.element_dofs.T[:, :, None] + np.arange(3)).reshape(cells, 3 * n)
    rows, columns = np.repeat(dofs, 3 * n, axis=1).ravel(), np.tile(dofs, (1, 3 * n)).ravel()
    shape = (3 * basis.N, 3 * basis.N)
    stiffness, mass = (
        csr_array(coo_array((2.0 * part.ravel(), (rows, columns)), shape=shape)) for part in (local, inertia)
    )
    return basis, stiffness, mass


def _free(spring: SolidSpring, basis: sk.Basis, parity: Parity) -> NDArray[np.intp]:
    """Unknowns that supports and symmetry leave."""
    held = np.zeros((basis.N, 3), dtype=bool)
    line, box = spring.solid.centreline, spring.solid.box
    for clamped, s in zip(spring.clamped, (0.0, line.length), strict=True):
        if clamped:
            faces = box.facets_satisfying(lambda x, s=s: np.abs(x[0] - s) < 1e-9 * line.length)
            held[basis.get_dofs(faces).all()] = True
    middle = np.abs(basis.doflocs[2]) < 1e-12 * line.length
    held[np.ix_(middle, [2] if parity == "symmetric" else [0, 1])] = True
    return np.flatnonzero(~held.ravel())


def _section_rows(spring: SolidSpring, basis: sk.Basis, parity: Parity) -> NDArray[np.float64]:
    """Rows of d along x, y, z and theta about them for the section at the tip, (6, unknowns); those that the
    other parity has are 0."""
    line, s = spring.solid.centreline, spring.tip_at
    faces = spring.solid.box.facets_satisfying(lambda x: np.abs(x[0] - s) < 1e-9 * line.length)
    face = sk.FacetBasis(spring.solid.box, sk.ElementHex2(), facets=faces, intorder=2 * QUADRATURE_ORDER)
    t, n = line.frame(np.array(s))
    _, y, z = np.asarray(face.global_coordinates())  # a section has the same shape in the box and in space
    y = y - np.sum(y * face.dx) / np.sum(face.dx)
    area, yy, zz = (float(np.sum(part * face.dx)) for part in (np.ones_like(y), y**2, z**2))

    def mean(weight: NDArray[np.float64]) -> NDArray[np.float64]:
        row = np.zeros(basis.N)
        for function, dofs in zip(face.basis, face.element_dofs, strict=True):
            np.add.at(row, dofs, np.sum(function[0] * weight * face.dx, axis=1))
        return row

    even, by_y, by_z = mean(np.ones_like(y)) / area, mean(y), mean(z)
    about_t = np.outer(by_y, [0.0, 0.0, 1.0]) - np.outer(by_z, n)
    turns = np.outer(t, about_t / (yy + zz)) + np.outer(n, np.outer(by_z, t) / zz)
    turns = turns - np.outer([0.0, 0.0, 1.0], np.outer(by_y, t) / yy)
    rows = np.zeros((6, 3 * basis.N))
    for c in range(3):
        rows[c, c::3] = even
    rows[3:] = turns
    kept = np.isin(np.arange(6), MOVES[parity])
    return rows * kept[:, None]
