"""Solids of swept strips: their matrices, limits and convergence."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import skfem as sk
from skfem.helpers import ddot, dot, sym_grad, trace

from beam import (
    BRASS,
    Material,
    Tip,
    UniformBeam,
    exact_modes,
)
from beam.space import spatial_modes
from studies.spring_shape.__main__ import COARSE, shapes_of
from studies.spring_shape.elasticity import assembled, solid_modes
from studies.spring_shape.shapes import Mesh, Shape, kinds_of
from studies.spring_shape.swept_mesh import sweep

LENGTH, WIDTH, THICKNESS = 0.13, 12e-3, 1e-3
BRASS_STRIP = Shape(
    reading="plain", material=BRASS, length=LENGTH, width=WIDTH, bend_radius=7.5e-3, thickness=THICKNESS,
    tip=Tip(),
)  # fmt: skip
MESH = Mesh(legs=24, bend=8, across=1, halvings=3)
NO_CONTRACTION = Material(youngs_modulus=105e9, poissons_ratio=0.0, density=8500.0)


def compliance(shape: Shape, mesh: sk.MeshHex2) -> float:
    """Displacement of the end per unit force [m/N]: 1/(M omega^2) under a tip that outweighs the spring."""
    (frequencies, _), _ = solid_modes(replace(shape, tip=Tip(mass=1e5)), mesh, (1, 1))
    return 1.0 / (1e5 * (2.0 * math.pi * float(frequencies[0])) ** 2)


def test_a_clamped_strip_is_between_strip_and_plate(letter_scene):
    """Stiffer than 3 EI/L^3 by more the wider it is, never by nu^2/(1 - nu^2) = 13 %."""
    shape, excess = shapes_of(letter_scene)["plain"], []
    for factor in (0.5, 1.0, 4.0):
        wide = replace(shape, width=factor * shape.width)
        mesh = wide.swept(replace(COARSE[1], across=max(1, round(factor))))
        free = wide.length**3 / (3.0 * wide.section.in_plane_stiffness)
        excess.append(free / compliance(wide, mesh) - 1.0)
    nu = shape.material.poissons_ratio
    assert np.all(np.diff([0.003, *excess, nu**2 / (1.0 - nu**2)]) > 0.0)
    assert excess[1] == pytest.approx(0.0118, abs=1.5e-3)


def folded(legs: int, bend: int) -> sk.MeshHex2:
    shape = replace(BRASS_STRIP, reading="folded", thickness=0.7e-3)
    return shape.swept(replace(MESH, legs=legs, bend=bend))


def strip_stiffness(shape: Shape) -> float:
    """3 EI/L^3 [N/m]."""
    return 3.0 * shape.section.in_plane_stiffness / shape.length**3


def through_twice(shape: Shape, mesh: Mesh) -> sk.MeshHex2:
    """The plain strip with two elements through its thickness."""
    _, _, z = sk.MeshHex.from_mesh(shape.swept(mesh)).p
    profile = (0.5 * shape.thickness * np.array([-1.0, 0.0, 1.0]), np.unique(z))
    return sweep(profile, shape.centreline, [mesh.legs], tip_at=shape.tip_at, halvings=(mesh.halvings, 0))


def test_matrices_are_those_of_the_weak_form_integrated_as_one_vector_element():
    mesh = folded(2, 4)
    _, stiffness, mass = assembled(mesh, BRASS)
    e, nu = BRASS.youngs_modulus, BRASS.poissons_ratio
    lame, shear = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), BRASS.shear_modulus

    @sk.BilinearForm
    def elasticity(u, v, _):
        return lame * trace(sym_grad(u)) * trace(sym_grad(v)) + 2.0 * shear * ddot(sym_grad(u), sym_grad(v))

    @sk.BilinearForm
    def inertia(u, v, _):
        return BRASS.density * dot(u, v)

    vector = sk.Basis(mesh, sk.ElementVector(sk.ElementHex2()), intorder=5)
    order = np.concatenate(vector.split_indices())  # ours are numbered component by component
    for mine, form in ((stiffness, elasticity), (mass, inertia)):
        theirs = form.assemble(vector)[order][:, order]
        assert abs(mine - 2.0 * theirs).max() < 1e-12 * abs(theirs).max()  # both halves of the width


def test_the_mass_of_a_swept_u_is_that_of_its_strip():
    basis, _, mass = assembled(folded(4, 8), BRASS)
    along = np.repeat([0.0, 1.0, 0.0], basis.N)
    expected = BRASS.density * WIDTH * 0.7e-3 * (2.0 * LENGTH + math.pi * 7.5e-3)
    assert along @ mass @ along == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("slenderness", [5.0, 10.0])
def test_a_thick_cantilever_shears_as_timoshenko_says(slenderness):
    """C = L^3/(3 EI) + L/(k GA), k = 5/6 for a rectangle; a clamp that forbids warping takes some away."""
    side = LENGTH / slenderness
    shape = replace(BRASS_STRIP, material=NO_CONTRACTION, thickness=side, width=side)
    mesh = through_twice(shape, replace(MESH, legs=16, halvings=4))
    shear = LENGTH / (NO_CONTRACTION.shear_modulus * side**2)
    excess = (compliance(shape, mesh) - 1.0 / strip_stiffness(shape)) / shear
    assert 1.0 < excess < 1.2


def test_a_thin_strip_that_does_not_contract_is_that_of_strip_theory():
    shape = replace(BRASS_STRIP, material=NO_CONTRACTION, tip=Tip(mass=6e-3))
    mesh = shape.swept(MESH)
    assert compliance(shape, mesh) * strip_stiffness(shape) == pytest.approx(1.0, abs=5e-4)
    beam = UniformBeam(
        length=LENGTH,
        bending_stiffness=105e9 * WIDTH * THICKNESS**3 / 12.0,
        mass_per_length=8500.0 * WIDTH * THICKNESS,
        tip_mass=6e-3,
    )
    ((frequencies, phi), _), exact = solid_modes(shape, mesh, (3, 1)), exact_modes(beam, 3)
    assert np.all(np.abs(2.0 * math.pi * frequencies / exact.omega - 1.0) < [2e-4, 2e-3, 5e-3])
    np.testing.assert_allclose(phi, exact.phi, rtol=2e-3)


def test_refinement_converges_in_every_direction():
    meshes = (replace(MESH, legs=12), MESH, Mesh(legs=48, bend=8, across=2, halvings=4))
    found = [solid_modes(BRASS_STRIP, BRASS_STRIP.swept(mesh), (3, 3)) for mesh in meshes]
    for family in (0, 1):
        f = [modes[family][0] for modes in found]
        first, second = np.abs(f[0] / f[2] - 1.0), np.abs(f[1] / f[2] - 1.0)
        assert np.all(second < np.maximum(0.4 * first, 3e-4))
        assert second.max() < 5e-3
    (through, _), _ = solid_modes(BRASS_STRIP, through_twice(BRASS_STRIP, MESH), (3, 1))
    np.testing.assert_allclose(through, found[1][0][0], rtol=5e-4)


@pytest.mark.parametrize("inertia", [0.0, 7e-8])
def test_torsion_and_sideways_bending_of_a_thin_strip(inertia):
    """The rotary inertia sees by how much the section at the tip turns: it lowers the twist by a half."""
    shape = replace(BRASS_STRIP, tip=Tip(mass=6e-3, rotary_inertia=inertia))
    strip = spatial_modes(shape.spring(), 8)
    _, (solid_hz, _) = solid_modes(shape, shape.swept(MESH), (1, 2))
    apart = np.flatnonzero(strip.out_of_plane > 0.5)[:2]
    assert kinds_of(shape, strip)[apart[-1]] == "twist"
    np.testing.assert_allclose(strip.frequencies_hz[apart], solid_hz, rtol=4e-3)


def test_wrong_solids_are_refused():
    plain, profile = BRASS_STRIP.centreline, (np.array([-8e-3, 8e-3]), np.array([0.0, 1e-3]))
    with pytest.raises(ValueError, match="tip_at"):
        sweep(profile, plain, [2], tip_at=0.1)
    with pytest.raises(ValueError, match="below 1"):
        sweep(profile, replace(BRASS_STRIP, reading="folded").centreline, (2, 4, 2), tip_at=LENGTH)
