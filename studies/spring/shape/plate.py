"""Modes of the flat U as a Kirchhoff plate, in Morley's triangles.

The sheet deflects by w(x, z) [m] relative to a base that moves by y [m] across it. A ball of mass M [kg] sits
at the tip, and a force F [N] acts there. For all test functions v

    int D ((1 - nu) w_ij v_ij + nu lap w lap v) + m (w.. + y..) v dA + M (w.. + y..) v (tip) = F v (tip),

with w = 0 and dw/dn = 0 on the clamped edges. D [N m] is the bending stiffness of the sheet, nu [1] Poisson's
ratio, m [kg/m^2] the mass per area. D (1 + nu) and D (1 - nu) are the bending stiffness per width of the
section if each ply has the modulus E/(1 - nu) or E/(1 + nu).

Morley's element is quadratic on a triangle, with w at the vertices and dw/dn at the middles of the edges as
unknowns (L. S. D. Morley, Aeronaut. Q. 19 (1968) 149). It does not conform; frequencies converge as h^2.

The ball is fixed to a point of the sheet or to a rigid round seat, where w = a + c x and x runs along the
legs. The sheet can dimple under a point. The rotary inertia of the ball acts on c; it is ignored at a point.

The triangles lie on half of a flat U, along its centreline. A grid has lines of constant s (along the
centreline, from the clamp) and t (across, outwards) [m]. It covers one leg, of length L [m], and half of the
bend, of radius r [m]. The angle is a = 0 on the leg and a = (s - L)/r on the bend. The grid point (s, t) is
mapped to

    x = min(s, L) - L - r + (r + t) sin a,      z = (r + t) cos a,

so that the ball is at the origin and z = 0 is the line of symmetry. Squares of the grid about the ball become
circles up to the edge of the seat. Beyond it the circles blend into the grid, up to the edge of the sheet. A
diagonal that points to the ball cuts each cell in two triangles. Next to the clamp, which keeps the sheet
from curving across its width, s grows as the square of the line number.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, eye_array, hstack
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem.helpers import dd, ddot, trace

from beam import Material, StripSection, Tip

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PlateModes:
    """The lowest modes with unit modal mass and phi >= 0, each array of shape (n_modes,).

    omega [rad/s], phi [kg^(-1/2)] at the ball, participation [kg^(1/2)] in a motion of the base along y.
    """

    omega: Array
    phi: Array
    participation: Array

    def extrapolated(self, coarser: PlateModes) -> PlateModes:
        """Extrapolation to h = 0 by h^2, from these modes and `coarser` ones on elements twice as long."""
        pairs = [(fine, vars(coarser)[name]) for name, fine in vars(self).items()]
        return PlateModes(**dict(zip(vars(self), (a + (a - b) / 3.0 for a, b in pairs), strict=True)))


def per_area(section: StripSection) -> tuple[float, float, float]:
    """D (1 + nu) and D (1 - nu) [N m], m [kg/m^2]."""

    def stiffness(sign: float) -> float:
        def changed(ply: Material) -> Material:
            return replace(ply, youngs_modulus=ply.youngs_modulus / (1.0 + sign * ply.poissons_ratio))

        layer = section.layer and replace(section.layer, material=changed(section.layer.material))
        return replace(section, material=changed(section.material), layer=layer).bending_stiffness

    return (
        stiffness(-1.0) / section.width,
        stiffness(1.0) / section.width,
        section.mass_per_length / section.width,
    )


@sk.BilinearForm
def bending(u, v, w):
    """D ((1 - nu) u_ij v_ij + nu lap u lap v), with `bulk` D (1 + nu) and `shear` D (1 - nu)."""
    return w.shear * ddot(dd(u), dd(v)) + 0.5 * (w.bulk - w.shear) * trace(dd(u)) * trace(dd(v))


def plate_modes(
    mesh: sk.MeshTri, bare: StripSection, taped: StripSection, tip: Tip, count: int, *, seated: bool
) -> PlateModes:
    """Return the `count` lowest modes of a plate.

    Parameters
    ----------
    mesh : MeshTri
        Triangles in the plane of the sheet [m], the ball at the origin. Boundaries "clamped" and "symmetry"
        and subdomains "taped" and "seat" are named. If "symmetry" has edges, the mesh is half of the plate,
        and the symmetric modes of the whole plate are computed.
    bare, taped : StripSection
        Sections outside and inside the subdomain "taped".
    tip : Tip
        Mass of the ball [kg]; its rotary inertia [kg m^2] counts only with a seat.
    count : int
        Number of modes.
    seated : bool
        True: the ball is on the rigid subdomain "seat"; False: on a point.

    Returns
    -------
    PlateModes
        Arrays of shape (count,), in rising order of frequency.
    """
    basis = sk.Basis(mesh, sk.ElementTriMorley(), intorder=4)
    halves = 2.0 if mesh.boundaries["symmetry"].size else 1.0
    values = halves * np.outer(per_area(bare), np.ones(mesh.nelements))
    values[:, mesh.subdomains["taped"]] = halves * np.array(per_area(taped))[:, None]
    bulk, shear, density = map(basis.with_element(sk.ElementTriP0()).interpolate, values)
    stiffness = bending.assemble(basis, bulk=bulk, shear=shear)
    mass = sk.BilinearForm(lambda u, v, w: w.m * u * v).assemble(basis, m=density)

    held = np.union1d(basis.get_dofs("clamped").all(), basis.get_dofs("symmetry").all("u_n"))
    rigid = np.setdiff1d(basis.get_dofs(elements="seat").all(), held)[: basis.N if seated else 0]
    unknowns = np.arange(basis.N)
    moved, turned = np.isin(unknowns, basis.nodal_dofs[0]) * 1.0, np.zeros(basis.N)
    ball = basis.nodal_dofs[0, np.argmin(np.linalg.norm(mesh.p, axis=0))]
    ties = eye_array(basis.N, format="csc")[:, np.setdiff1d(unknowns, np.union1d(held, rigid))]
    if seated:
        turned[rigid] = basis.project(lambda x: x[0])[rigid]
        seat = np.stack((moved * np.isin(unknowns, rigid), turned), axis=1)
        ties = hstack((ties, csc_array(seat)), format="csc")
    lumped = np.zeros((2, ties.shape[1]))
    lumped[0], lumped[1, -1] = ties[[ball]].toarray()[0], 1.0 * seated
    carried = csr_array(np.sqrt([[tip.mass], [tip.rotary_inertia]]) * lumped)
    k, m = csc_array(ties.T @ stiffness @ ties), csc_array(ties.T @ mass @ ties + carried.T @ carried)

    factors = splu(k, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator(k.shape, factors.solve, dtype=np.float64)
    start = np.cos(np.arange(k.shape[0]))  # fixed, so that results repeat, and orthogonal to no mode
    squares, x = eigsh(k, count, M=m, sigma=0.0, OPinv=inverse, v0=start)
    order = np.argsort(squares)
    x = x[:, order] / np.sqrt(np.einsum("ik,ik->k", x, m @ x))[order]
    x *= np.where(lumped[0] @ x < 0.0, -1.0, 1.0)
    phi = lumped[0] @ x
    participation = moved @ mass @ (ties @ x) + tip.mass * phi
    return PlateModes(omega=np.sqrt(squares[order]), phi=phi, participation=participation)


LONGEST = 2.0  # length of a cell over its width, on the leg


def half_u(
    *,
    leg: float,
    radius: float,
    width: float,
    seat: float,
    covered: float,
    cells: tuple[int, int],
    times: int,
) -> sk.MeshTri:
    """The half z >= 0 of the U.

    Parameters
    ----------
    leg, radius, width, seat, covered : float
        Length of a leg, radius of the bend's centreline, width of the sheet, radius of the seat, length of
        the tape from the clamp [m].
    cells : (int, int)
        Cells over the radius of the seat, and from the seat to the edge of the sheet.
    times : int
        Number of parts into which each of these cells is divided along each side.

    Returns
    -------
    MeshTri
        With boundaries "clamped" and "symmetry" and subdomains "taped" and "seat".
    """
    end, half = leg + 0.5 * math.pi * radius, 0.5 * width
    longest, near = LONGEST * half / sum(cells), min(width, 0.5 * covered)

    def even(a: float, b: float) -> np.ndarray:
        return np.linspace(a, b, times * math.ceil((b - a) / longest - 1e-9) + 1)[1:]

    rim = np.linspace(seat, half, times * cells[1] + 1)
    out = np.concatenate((np.linspace(0.0, seat, times * cells[0] + 1)[:-1], rim))
    clamp = near * np.linspace(0.0, 1.0, 2 * times * sum(cells) + 1) ** 2
    s = np.concatenate(
        (clamp, even(near, covered), even(covered, leg), even(leg, end - half), end - out[-2::-1])
    )
    t = np.concatenate((-out[:0:-1], out))
    ix = np.arange(s.size * t.size).reshape(s.size, t.size)
    a, b, c, d = ix[:-1, :-1], ix[1:, :-1], ix[1:, 1:], ix[:-1, 1:]
    cut = (np.where(t[1:] <= 0.0, *ways) for ways in (((a, b, c), (a, b, d)), ((a, c, d), (b, c, d))))
    triangles = np.concatenate([part.reshape(3, -1) for part in cut], axis=1)

    s, t = (grid.ravel() for grid in np.meshgrid(s, t, indexing="ij"))
    turn = np.maximum(s - leg, 0.0) / radius
    x, z = np.minimum(s, leg) - leg - radius + (radius + t) * np.sin(turn), (radius + t) * np.cos(turn)
    box = np.stack((t, end - s))
    far = np.abs(box).max(axis=0)
    circles = far * box / np.maximum(np.linalg.norm(box, axis=0), np.finfo(float).tiny)
    share = np.clip((half - far) / (half - seat), 0.0, 1.0)
    p = (1.0 - share) * (x, z) + share * circles
    p[1, s == end] = 0.0
    covers, seats = s[triangles].mean(axis=0) < covered, far[triangles].max(axis=0) <= seat * (1.0 + 1e-9)
    parts = {"taped": np.flatnonzero(covers), "seat": np.flatnonzero(seats)}
    start = -leg - radius
    sides = {"clamped": lambda x: x[0] < (1.0 - 1e-9) * start, "symmetry": lambda x: x[1] == 0.0}
    return sk.MeshTri(p, triangles).with_subdomains(parts).with_boundaries(sides)
