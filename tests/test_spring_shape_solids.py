"""Solid elements: against their own weak form, Timoshenko's beam, finer meshes, and the strips they check."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import skfem as sk
from skfem.helpers import ddot, sym_grad, trace

from beam import BRASS, Arc, Centreline, Material, Straight, StripSection, Tip, UniformBeam, exact_modes
from beam.space import SpatialSpring, channel, channel_centroid, spatial_modes, upright
from studies.spring_shape_solids import (
    SolidSpring,
    channel_profile,
    end_compliance,
    rectangle_profile,
    solid_modes,
    sweep,
)
from studies.spring_shape_solids.elasticity import _assembled

LENGTH, WIDTH, THICKNESS, RADIUS = 0.13, 12e-3, 1e-3, 7.5e-3
U = Centreline(
    pieces=(Straight(length=LENGTH), Arc(radius=RADIUS, angle=math.pi), Straight(length=LENGTH)),
    start=(0.0, -RADIUS),
)
NO_CONTRACTION = Material(youngs_modulus=105e9, poissons_ratio=0.0, density=8500.0)


def clamped_strip(
    *,
    material: Material = BRASS,
    length: float = LENGTH,
    width: float = WIDTH,
    thickness: float = THICKNESS,
    elements: int = 24,
    across: int = 1,
    through: int = 1,
    halvings: int = 3,
    tip: Tip | None = None,
) -> SolidSpring:
    profile = rectangle_profile(along_n=thickness, along_z=width, cells=across, through=through)
    line = Centreline(pieces=(Straight(length=length),))
    return SolidSpring(
        solid=sweep(profile, line, [elements], halvings=(halvings, 0)),
        material=material,
        clamped=(True, False),
        tip=tip or Tip(),
        tip_at=length,
    )


def strip_stiffness(spring: SolidSpring, width: float = WIDTH, thickness: float = THICKNESS) -> float:
    """3 EI/L^3 [N/m]."""
    return 3.0 * spring.material.youngs_modulus * width * thickness**3 / 12.0 / spring.tip_at**3


def folded(legs: int, bend: int, *, tip_mass: float = 6e-3) -> SolidSpring:
    tip_at = LENGTH + 0.5 * math.pi * RADIUS
    profile = rectangle_profile(along_n=0.7e-3, along_z=WIDTH, cells=1)
    return SolidSpring(
        solid=sweep(profile, U, (legs, bend, legs), tip_at=tip_at, halvings=(3, 3)),
        material=BRASS,
        clamped=(True, True),
        tip=Tip(mass=tip_mass),
        tip_at=tip_at,
    )


def test_matrices_are_those_of_the_weak_form_integrated_as_one_vector_element():
    spring = folded(2, 4)
    basis, stiffness, mass = _assembled(spring)
    e, nu = BRASS.youngs_modulus, BRASS.poissons_ratio
    lame, shear = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), BRASS.shear_modulus

    @sk.BilinearForm
    def elasticity(u, v, _):
        return lame * trace(sym_grad(u)) * trace(sym_grad(v)) + 2.0 * shear * ddot(sym_grad(u), sym_grad(v))

    @sk.BilinearForm
    def inertia(u, v, _):
        return BRASS.density * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2])

    vector = sk.Basis(spring.solid.mesh, sk.ElementVector(sk.ElementHex2()), intorder=5)
    place = {tuple(np.round(point, 9)): 3 * i for i, point in enumerate(basis.doflocs.T)}
    order = np.empty(vector.N, dtype=int)  # ours are numbered node by node
    for dof, point in enumerate(vector.doflocs.T):
        key = tuple(np.round(point, 9))
        order[place[key]] = dof
        place[key] += 1
    for mine, form in ((stiffness, elasticity), (mass, inertia)):
        theirs = form.assemble(vector)[order][:, order]
        assert abs(mine - 2.0 * theirs).max() < 1e-12 * abs(theirs).max()  # both halves of the width


def test_the_mass_of_a_swept_u_is_that_of_its_strip():
    _, _, mass = _assembled(folded(4, 8))
    along = np.zeros(mass.shape[0])
    along[1::3] = 1.0
    expected = BRASS.density * WIDTH * 0.7e-3 * (2.0 * LENGTH + math.pi * RADIUS)
    assert along @ mass @ along == pytest.approx(expected, rel=1e-5)


def test_turning_as_a_whole_strains_nothing_even_on_the_arc():
    basis, stiffness, _ = _assembled(folded(4, 8))
    for axis in np.eye(3):
        turned = np.cross(axis, basis.doflocs.T).ravel()
        energy = turned @ stiffness @ turned
        assert energy < 1e-12 * (np.abs(turned) @ abs(stiffness) @ np.abs(turned))


@pytest.mark.parametrize("slenderness", [5.0, 10.0])
def test_a_thick_cantilever_shears_as_timoshenko_says(slenderness):
    """C = L^3/(3 EI) + L/(k GA), k = 5/6 for a rectangle; a clamp that forbids warping takes some away."""
    thickness = LENGTH / slenderness
    spring = clamped_strip(
        material=NO_CONTRACTION, thickness=thickness, width=thickness, elements=16, through=2, halvings=4
    )
    bending = 1.0 / strip_stiffness(spring, thickness, thickness)
    shear = LENGTH / (NO_CONTRACTION.shear_modulus * thickness**2)
    excess = (end_compliance(spring, "symmetric") - bending) / shear
    assert 1.0 < excess < 1.2


def test_a_thin_strip_that_does_not_contract_is_that_of_strip_theory():
    spring = clamped_strip(material=NO_CONTRACTION, tip=Tip(mass=6e-3))
    assert end_compliance(spring, "symmetric") * strip_stiffness(spring) == pytest.approx(1.0, abs=5e-4)
    beam = UniformBeam(
        length=LENGTH,
        bending_stiffness=105e9 * WIDTH * THICKNESS**3 / 12.0,
        mass_per_length=8500.0 * WIDTH * THICKNESS,
        tip_mass=6e-3,
    )
    modes, exact = solid_modes(spring, "symmetric", 3), exact_modes(beam, 3)
    assert np.all(np.abs(modes.omega / exact.omega - 1.0) < [2e-4, 2e-3, 5e-3])
    np.testing.assert_allclose(modes.phi, exact.phi, rtol=2e-3)


def test_a_wide_clamped_strip_lies_between_strip_and_plate():
    """Its stiffness exceeds 3 EI/L^3 by more the wider it is, never by nu^2/(1 - nu^2) = 13 %."""
    limit = BRASS.poissons_ratio**2 / (1.0 - BRASS.poissons_ratio**2)
    excess = []
    for width in (6e-3, 12e-3, 48e-3):
        spring = clamped_strip(width=width, across=max(1, round(width / 12e-3)))
        excess.append(1.0 / (end_compliance(spring, "symmetric") * strip_stiffness(spring, width)) - 1.0)
    assert 0.003 < excess[0] < excess[1] < excess[2] < limit
    assert excess[1] == pytest.approx(0.0118, abs=1.5e-3)


def test_refinement_converges_in_every_direction():
    coarse, fine = clamped_strip(elements=12), clamped_strip(elements=24)
    finest = clamped_strip(elements=48, across=2, halvings=4)
    for parity in ("symmetric", "antisymmetric"):
        f = [solid_modes(spring, parity, 3).omega for spring in (coarse, fine, finest)]
        first, second = np.abs(f[0] / f[2] - 1.0), np.abs(f[1] / f[2] - 1.0)
        assert np.all(second < np.maximum(0.4 * first, 3e-4))
        assert second.max() < 5e-3
    through = solid_modes(clamped_strip(through=2), "symmetric", 3).omega
    np.testing.assert_allclose(through, solid_modes(fine, "symmetric", 3).omega, rtol=5e-4)


def test_torsion_and_sideways_bending_of_a_thin_strip():
    section = upright(StripSection(material=BRASS, width=WIDTH, thickness=THICKNESS))
    tip = Tip(mass=6e-3, rotary_inertia=7e-8)
    spring = SpatialSpring(
        centreline=Centreline(pieces=(Straight(length=LENGTH),)), sections=(section,),
        supports=("clamped", "free"), tip=tip, tip_at=LENGTH, drive=(0.0, 0.0, 1.0),
    )
    strip = spatial_modes(spring, 8)
    solid = solid_modes(replace(clamped_strip(tip=tip), drive=(0.0, 0.0, 1.0)), "antisymmetric", 2)
    apart = np.flatnonzero(strip.out_of_plane > 0.5)[:2]
    np.testing.assert_allclose(strip.omega[apart], solid.omega, rtol=4e-3)
    np.testing.assert_allclose(strip.phi[apart], solid.phi, rtol=5e-3, atol=1e-6)
    turns = np.abs(solid.section[:, 3])
    np.testing.assert_allclose(np.abs(strip.rotation[apart, 0]), turns, rtol=5e-3, atol=1e-3)


@pytest.mark.parametrize(
    "meshes", [((12, 16), (24, 24)), pytest.param(((40, 24), (80, 48)), marks=pytest.mark.slow)]
)
def test_the_folded_u_is_stiffer_than_strip_theory_because_its_bend_is_a_plate(meshes):
    section = upright(StripSection(material=BRASS, width=WIDTH, thickness=0.7e-3))
    plate = replace(section, in_plane_stiffness=section.in_plane_stiffness / (1.0 - BRASS.poissons_ratio**2))
    coarse, fine = (solid_modes(folded(*mesh), "symmetric", 3).omega for mesh in meshes)
    tip_at = LENGTH + 0.5 * math.pi * RADIUS
    found = []
    for bend in (section, plate):
        spring = SpatialSpring(
            centreline=U, sections=(section, bend, section), supports=("clamped", "clamped"),
            tip=Tip(mass=6e-3), tip_at=tip_at,
        )
        modes = spatial_modes(spring, 6)
        found.append(modes.omega[modes.out_of_plane < 0.5][:3] / fine - 1.0)
    loose = 1.0 if meshes[0][0] > 20 else 2.0
    assert np.all(np.abs(coarse / fine - 1.0) < 0.01 * loose)
    assert np.all(found[0] < -0.010) and np.all(found[0] > -0.020 * loose)
    assert np.all(found[1] - found[0] > 0.004) and np.all(np.abs(found[1]) < 0.008 * loose)


def test_a_channel_is_meshed_without_its_hollow():
    sizes = {"width": 12e-3, "flange": 2e-3, "thickness": 0.3e-3}
    profile = channel_profile(**sizes, centroid=1e-4, cells=(1, 2))
    solid = sweep(profile, Centreline(pieces=(Straight(length=0.05),)), [4])
    spring = SolidSpring(solid=solid, material=BRASS, clamped=(True, False), tip=Tip(), tip_at=0.05)
    _, _, mass = _assembled(spring)
    across = np.zeros(mass.shape[0])
    across[1::3] = 1.0
    area = 12e-3 * 0.3e-3 + 2 * 2e-3 * 0.3e-3
    assert across @ mass @ across == pytest.approx(BRASS.density * area * 0.05, rel=1e-9)


def test_a_channel_against_a_solid():
    sizes = {"width": 12e-3, "flange": 2e-3, "thickness": 0.3e-3}
    section = channel(material=BRASS, **sizes)
    line = Centreline(pieces=(Straight(length=LENGTH),))
    spring = SpatialSpring(
        centreline=line, sections=(section,), supports=("clamped", "free"), tip=Tip(mass=5e-3), tip_at=LENGTH
    )
    modes = spatial_modes(spring, 8)
    profile = channel_profile(**sizes, centroid=channel_centroid(**sizes), cells=(1, 2))
    solid = SolidSpring(
        solid=sweep(profile, line, [20], halvings=(3, 0)),
        material=BRASS, clamped=(True, False), tip=Tip(mass=5e-3), tip_at=LENGTH,
    )
    apart = modes.out_of_plane > 0.5
    for parity, chosen in (("symmetric", ~apart), ("antisymmetric", apart)):
        found = solid_modes(solid, parity, 2)
        ratio = modes.frequencies_hz[chosen][:2] / found.frequencies_hz - 1.0
        assert abs(ratio[0]) < 3e-3 and abs(ratio[1]) < 1e-2
        np.testing.assert_allclose(
            np.abs(modes.rotation[chosen, 0][:2]), np.abs(found.section[:, 3]), rtol=0.03, atol=1e-3
        )
    # the shear centre matters: with the centroid in its place the two modes out of the plane are far off
    blind = spatial_modes(replace(spring, sections=(replace(section, shear_offset=0.0),)), 8)
    off = blind.frequencies_hz[blind.out_of_plane > 0.5][:2] / modes.frequencies_hz[apart][:2] - 1.0
    assert np.abs(off).max() > 0.05


def test_wrong_solids_are_refused():
    spring = clamped_strip(elements=2)
    with pytest.raises(ValueError, match="clamped"):
        replace(spring, clamped=(False, False))
    with pytest.raises(ValueError, match="tip_at"):
        replace(spring, tip_at=0.1)
    with pytest.raises(ValueError, match="below 1"):
        sweep(rectangle_profile(along_n=16e-3, along_z=1e-3, cells=1), U, (2, 4, 2))
