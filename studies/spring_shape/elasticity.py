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

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import block_array, block_diag, csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from beam import Material
from studies.spring_shape.shapes import Shape

QUADRATURE_ORDER = 5
"""Three Gauss points each way: exact for the stiffness of a brick."""

FAMILIES = {"in plane": ((0, 1, 5), [2]), "out of plane": ((2, 3, 4), [0, 1])}
"""Symmetric and antisymmetric motion: which of d_x, d_y, d_z, theta_x, theta_y, theta_z of a section it has,
and which components of u are 0 at z = 0."""

Modes = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Natural frequencies [Hz] and |e . d| of the section at the tip [kg^(-1/2)], each (n_modes,)."""


def solid_modes(shape: Shape, mesh: sk.MeshHex2, counts: tuple[int, int]) -> list[Modes]:
    """The lowest modes in the plane of symmetry and out of it, so many of each; mass-normalised.

    The mesh has the cross-sections "start", "tip" and "end" as named faces (``swept_mesh``). The rotary
    inertia of the tip counts about every axis.
    """
    basis, stiffness, mass = assembled(mesh, shape.material)
    clamped = basis.get_dofs(("start", "end") if shape.bent else "start").all()
    section = section_rows(mesh, basis, shape.centreline.axes(shape.tip_at))
    lumped = np.sqrt(np.repeat([shape.tip.mass, shape.tip.rotary_inertia], 3))
    found = []
    for (moves, still), count in zip(FAMILIES.values(), counts, strict=True):
        rows = section * np.isin(np.arange(6), moves)[:, None]
        carried = csr_array(lumped[:, None] * rows)
        held = np.zeros((3, basis.N), dtype=bool)
        held[:, clamped] = True
        held[np.ix_(still, basis.doflocs[2] == 0.0)] = True
        free = np.flatnonzero(~held)
        squares, x = lowest(stiffness, mass + carried.T @ carried, free, count)
        phi = np.abs(np.array(shape.stop) @ rows[:3, free] @ x)
        found.append((np.sqrt(squares) / (2.0 * np.pi), phi))
    return found


def lowest(stiffness: csr_array, mass: csr_array, free: NDArray[np.intp], count: int) -> Modes:
    """The `count` lowest omega^2 [rad^2/s^2], rising, and the mass-normalised modes in the free unknowns."""
    k, m = (csc_array(part)[free][:, free] for part in (stiffness, mass))
    factors = splu(k, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, factors.solve, dtype=np.float64)
    start = np.cos(np.arange(k.shape[0]))  # fixed, so that results repeat, and orthogonal to no mode
    squares, x = eigsh(k, count, M=m, sigma=0.0, OPinv=inverse, v0=start)
    order = np.argsort(squares)
    return squares[order], x[:, order] / np.sqrt(np.einsum("ik,ik->k", x, m @ x))[order]


def assembled(mesh: sk.MeshHex2, material: Material) -> tuple[sk.Basis, csr_array, csr_array]:
    """Scalar basis of N functions, K and M without tip and supports; unknown c N + i is component c of node
    i.

    D_ab = int d_a N_i d_b N_j dV holds everything: K_ab = lambda D_ab + G (D_ba + delta_ab sum_c D_cc). Nine
    scalar forms replace the 81 x 81 ones that a vector element would integrate, seven times faster.
    """
    basis = sk.Basis(mesh, sk.ElementHex2(), intorder=QUADRATURE_ORDER)
    e, nu = material.youngs_modulus, material.poissons_ratio
    lame, shear, density = 2.0 * np.array(  # two halves
        [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), material.shear_modulus, material.density]
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


def section_rows(mesh: sk.MeshHex2, basis: sk.Basis, axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of d along x, y, z and theta about them for the section at the tip, shape (6, unknowns); `axes`
    are t, n and e_z there.

    A coordinate is a function of the basis: with m = int N_i N_j dA, int y u dA = (m y) . u.
    """
    bricks, faces = sk.MeshHex.from_mesh(mesh), mesh.boundaries["tip"]  # the section is plane
    face = sk.FacetBasis(bricks, sk.ElementHex2(), facets=faces, intorder=QUADRATURE_ORDER)
    m = sk.BilinearForm(lambda u, v, _: u * v).assemble(face)
    (t, n, z_axis), x = axes, basis.doflocs
    even = m @ np.ones(basis.N)
    mean = even / even.sum()
    y, z = n @ (x - (x @ mean)[:, None]), x[2]
    by_y, by_z = m @ y, m @ z
    about_t = (np.kron(z_axis, by_y) - np.kron(n, by_z)) / (y @ by_y + z @ by_z)
    turns = np.stack([about_t, np.kron(t, by_z) / (z @ by_z), -np.kron(t, by_y) / (y @ by_y)])
    return np.concatenate((np.kron(np.eye(3), mean), axes.T @ turns))
