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
from scipy.sparse import block_array, block_diag, csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from beam import Material, Tip

#: Three Gauss points each way: exact for the stiffness of a brick.
QUADRATURE_ORDER = 5
Parity = Literal["symmetric", "antisymmetric"]
#: Which of d_x, d_y, d_z, theta_x, theta_y, theta_z each parity has.
MOVES: dict[str, tuple[int, ...]] = {"symmetric": (0, 1, 5), "antisymmetric": (2, 3, 4)}


@dataclass(frozen=True, kw_only=True, eq=False)
class SolidSpring:
    """A swept solid that is clamped at its faces `clamped`; `drive` is the unit vector e.

    The mesh has the cross-sections "start", "end" and "tip" as named faces; `axes` are t, n and e_z at the
    tip. The rotary inertia of the tip counts about every axis.
    """

    mesh: sk.MeshHex2
    axes: NDArray[np.float64]
    material: Material
    clamped: tuple[str, ...]
    tip: Tip
    drive: tuple[float, float, float] = (0.0, 1.0, 0.0)


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
    rows = _section_rows(spring, basis) * np.isin(np.arange(6), MOVES[parity])[:, None]
    lumped = np.repeat([spring.tip.mass, spring.tip.rotary_inertia], 3)
    carried = csr_array(np.sqrt(lumped)[:, None] * rows)
    mass = mass + carried.T @ carried
    held = np.zeros((3, basis.N), dtype=bool)
    held[:, basis.get_dofs(spring.clamped).all()] = True
    held[np.ix_([2] if parity == "symmetric" else [0, 1], basis.doflocs[2] == 0.0)] = True
    free = np.flatnonzero(~held)
    k, m = (csc_array(matrix)[free][:, free] for matrix in (stiffness, mass))
    factors = splu(k, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, factors.solve, dtype=np.float64)
    start = np.cos(np.arange(k.shape[0]))  # fixed, so that results repeat, and orthogonal to no mode
    values, x = eigsh(k, count, M=m, sigma=0.0, OPinv=inverse, v0=start)
    order = np.argsort(values)
    full = np.zeros((held.size, count))
    full[free] = x[:, order]
    full /= np.sqrt(np.einsum("ik,ik->k", full, mass @ full))
    section = (rows @ full).T
    phi = section[:, :3] @ np.array(spring.drive)
    signs = np.where(phi < 0.0, -1.0, 1.0)
    return SolidModes(omega=np.sqrt(values[order]), phi=np.abs(phi), section=signs[:, None] * section)


@lru_cache(maxsize=1)  # both parities of a spring ask for them, one after the other
def assembled(spring: SolidSpring) -> tuple[sk.Basis, csr_array, csr_array]:
    """Scalar basis of N functions, K and M without tip and supports; unknown c N + i is component c of node
    i.

    D_ab = int d_a N_i d_b N_j dV holds everything: K_ab = lambda D_ab + G (D_ba + delta_ab sum_c D_cc). Nine
    scalar forms replace the 81 x 81 ones that a vector element would integrate, ten times faster.
    """
    basis = sk.Basis(spring.mesh, sk.ElementHex2(), intorder=QUADRATURE_ORDER)
    e, nu = spring.material.youngs_modulus, spring.material.poissons_ratio
    lame, shear, density = 2.0 * np.array(  # two halves
        [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), spring.material.shear_modulus, spring.material.density]
    )
    d = [
        [sk.BilinearForm(lambda u, v, _, a=a, b=b: v.grad[a] * u.grad[b]).assemble(basis) for b in range(3)]
        for a in range(3)
    ]
    squares = d[0][0] + d[1][1] + d[2][2]
    blocks = [
        [lame * d[a][b] + shear * (d[b][a] + squares if a == b else d[b][a]) for b in range(3)]
        for a in range(3)
    ]
    heavy = density * sk.BilinearForm(lambda u, v, _: u * v).assemble(basis)
    return basis, block_array(blocks, format="csr"), block_diag([heavy] * 3, format="csr")


def _section_rows(spring: SolidSpring, basis: sk.Basis) -> NDArray[np.float64]:
    """Rows of d along x, y, z and theta about them for the section at the tip, shape (6, unknowns).

    A coordinate is a function of the basis: with m = int N_i N_j dA, int y u dA = (m y) . u.
    """
    bricks, faces = sk.MeshHex.from_mesh(spring.mesh), spring.mesh.boundaries["tip"]  # sections are plane
    face = sk.FacetBasis(bricks, sk.ElementHex2(), facets=faces, intorder=QUADRATURE_ORDER)
    m = sk.BilinearForm(lambda u, v, _: u * v).assemble(face)
    (_, n, z_axis), x = spring.axes, basis.doflocs
    even = m @ np.ones(basis.N)
    mean = even / even.sum()
    y, z = n @ (x - (x @ mean)[:, None]), x[2]
    by_y, by_z = m @ y, m @ z
    turns = np.stack([
        (np.kron(z_axis, by_y) - np.kron(n, by_z)) / (y @ by_y + z @ by_z),
        np.kron(spring.axes[0], by_z) / (z @ by_z), -np.kron(spring.axes[0], by_y) / (y @ by_y),
    ])  # fmt: skip
    return np.concatenate((np.kron(np.eye(3), mean), spring.axes.T @ turns))
