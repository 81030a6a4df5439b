"""The readings of "U shaped": sizes by second routes, twist modes; solids against theory and strips."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import skfem as sk
from skfem.helpers import ddot, sym_grad, trace

from beam import (
    BRASS,
    Arc,
    Centreline,
    Material,
    Straight,
    StripSection,
    Tip,
    UniformBeam,
    assemble,
    exact_modes,
    folded_u,
    natural_modes,
)
from beam.space import SpatialSpring, channel_centroid, spatial_modes, upright
from studies.scene import SceneError
from studies.spring_shape.__main__ import COARSE, shapes_of
from studies.spring_shape.elasticity import SolidSpring, assembled, solid_modes
from studies.spring_shape.rows import error_rows, reading_row
from studies.spring_shape.shapes import Shape, angular_frequency_of, brought_to, kinds_of, shape_of
from studies.spring_shape.swept_mesh import rectangle_profile, sweep

LENGTH, WIDTH, THICKNESS, RADIUS = 0.13, 12e-3, 1e-3, 7.5e-3
U = Centreline(
    pieces=(Straight(length=LENGTH), Arc(radius=RADIUS, angle=math.pi), Straight(length=LENGTH)),
    start=(0.0, -RADIUS),
)
NO_CONTRACTION = Material(youngs_modulus=105e9, poissons_ratio=0.0, density=8500.0)


@pytest.fixture(scope="module")
def shapes(letter_scene):
    return shapes_of(letter_scene)


@pytest.fixture(scope="module")
def rows(shapes):
    return {name: reading_row(shape, 5e-4) for name, shape in shapes.items()}


def test_every_reading_has_the_free_period_of_the_letter(letter_scene, rows):
    omega = angular_frequency_of(letter_scene)
    assert 2.0 * math.pi / math.sqrt(omega**2 - 1.78**2) == pytest.approx(40.80e-3, rel=1e-9)
    for row in rows.values():
        assert 2.0 * math.pi * row.first_bending_hz == pytest.approx(omega, rel=1e-6)


def test_the_sheet_of_the_plain_strip_by_the_frequency_equation(letter_scene, shapes):
    shape = shapes["plain"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    beam = UniformBeam(
        length=shape.length,
        bending_stiffness=strip.bending_stiffness,
        mass_per_length=strip.mass_per_length,
        tip_mass=shape.tip.mass,
    )
    assert exact_modes(beam, 1).omega[0] == pytest.approx(angular_frequency_of(letter_scene), rel=1e-6)


def test_the_sheet_of_the_folded_strip_by_the_plane_model(letter_scene, shapes):
    shape = shapes["folded"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    spring = folded_u(leg_length=shape.length, bend_radius=shape.bend_radius, section=strip, tip=shape.tip)
    assert natural_modes(assemble(spring), 1).omega[0] == pytest.approx(
        angular_frequency_of(letter_scene), rel=1e-4
    )
    assert shape.thickness == pytest.approx(
        letter_scene.spring.thickness_m, rel=2e-3
    )  # the letter_scene has its tape on


def test_twist_of_the_plain_strip_by_hand(rows, shapes):
    """(1/4L) sqrt(GJ/I), the clamp taking b sqrt(E/48G) of the length away; the ball is on the axis."""
    shape = shapes["plain"]
    section, b, material = shape.section, shape.width, shape.material
    free = shape.length - b * math.sqrt(material.youngs_modulus / (48.0 * material.shear_modulus))
    by_hand = math.sqrt(section.torsional_stiffness / section.polar_inertia) / (4.0 * free)
    assert rows["plain"].first_twist_hz == pytest.approx(by_hand, rel=2e-3)


def test_the_table_says_what_the_study_claims(rows):
    ratio = {name: row.ratio_twist for name, row in rows.items()}
    assert ratio["plain"] > ratio["folded"] > ratio["side_by_side"] > ratio["channel"]
    assert ratio["folded"] == pytest.approx(16.6, abs=0.2)
    assert ratio["side_by_side"] == pytest.approx(7.8, abs=0.2)
    for row in rows.values():
        assert row.tip_value_twist < 1e-4 * row.tip_value_bending
        assert row.tip_value_twist_off_line > 10.0 * row.tip_value_twist
        assert row.ratio <= row.ratio_twist and row.compliance_share_off_line < 1e-3


def test_a_mount_with_rotary_inertia_lowers_the_twist_of_the_plain_strip_most(letter_scene, shapes, rows):
    """Of a ball of the mass and of brass, of all bodies of one material the one of least inertia."""
    mass = letter_scene.tip.mass_kg
    mount = Tip(mass=mass, rotary_inertia=0.4 * mass * (3.0 * mass / (4.0 * math.pi * 8500.0)) ** (2.0 / 3.0))
    assert 5e-8 < mount.rotary_inertia < 1e-7
    fall = {}
    for name in ("plain", "folded", "side_by_side"):
        heavier = reading_row(replace(shapes[name], tip=mount), 5e-4)
        fall[name] = 1.0 - heavier.first_twist_hz / rows[name].first_twist_hz
    assert fall["plain"] > 0.2 > fall["folded"] > 0.05 > fall["side_by_side"] > 0.0


def test_a_light_ball_off_the_line_sees_its_distance_times_the_turn(shapes):
    light = replace(shapes["folded"], tip=Tip(mass=1e-8))
    row = reading_row(light, 5e-4)
    assert row.tip_value_twist_off_line == pytest.approx(5e-4 * row.turn_of_twist, rel=1e-3)


def test_kinds_of_the_folded_strip(shapes):
    modes = spatial_modes(shapes["folded"].spring(), 7)
    kinds = kinds_of(shapes["folded"], modes.displacement, modes.rotation)
    assert kinds == ["bending", "breathing", "bending", "sideways", "breathing", "bending", "twist"]


def test_errors_of_strip_theory_mode_by_mode(shapes):
    """On coarse meshes: plain -0.7 %, folded twice that, half of it from the bend as a plate."""
    plain, folded = (error_rows(shapes[name], COARSE, (3, 2)) for name in ("plain", "folded"))
    low = {"plain": plain[:3], "folded": folded[:3]}
    error = {name: np.array([row.error for row in found]) for name, found in low.items()}
    plate = np.array([row.error_bend_as_plate for row in low["folded"]])
    assert np.all((-0.009 < error["plain"]) & (error["plain"] < -0.006))
    assert np.all((-0.021 < error["folded"]) & (error["folded"] < -0.011))
    assert np.all((-0.010 < plate) & (plate < -0.004))
    assert all(abs(row.mesh_change) < 0.006 for found in low.values() for row in found)
    twist = {
        found[0].reading: next(row.error for row in found if row.kind == "twist") for found in (plain, folded)
    }
    assert -0.004 < twist["plain"] < -0.002 and abs(twist["folded"]) < 0.02


def channel_solid(shape: Shape) -> SolidSpring:
    """A swept rectangle around the channel, less what lies between its flanges; its line is straight."""
    t, high = shape.thickness, 0.5 * shape.width
    web, inner = 0.5 * t - channel_centroid(**shape.channel_sizes), high - t
    profile = (
        np.array([web - t, web, web + shape.flange]), np.array([0.0, 0.5 * inner, inner, high])
    )  # fmt: skip
    swept = sweep(profile, shape.centreline, [40], halvings=(4, 0))
    _, y, z = swept.box.p[:, swept.box.t].mean(axis=1)
    box = swept.box.remove_elements(np.flatnonzero((y > web) & (z < inner)))
    return SolidSpring(
        solid=replace(swept, box=box, mesh=sk.MeshHex2.from_mesh(box)), material=shape.material,
        clamped=(True, False), tip=shape.tip, tip_at=shape.tip_at, drive=shape.stop,
    )  # fmt: skip


def test_a_channel_against_a_solid(shapes):
    """The shear centre matters: with the centroid in its place the modes out of the plane are far off."""
    spring, solid = shapes["channel"].spring(), channel_solid(shapes["channel"])
    strip = spatial_modes(spring, 8)
    for parity, apart in (("symmetric", False), ("antisymmetric", True)):
        f = strip.frequencies_hz[(strip.out_of_plane > 0.5) == apart][:2]
        error = f / solid_modes(solid, parity, 2).frequencies_hz - 1.0
        assert np.all(np.abs(error) < [3e-3, 1e-2])
    blind = spatial_modes(replace(spring, sections=(replace(spring.sections[0], shear_offset=0.0),)), 8)
    assert np.abs(blind.frequencies_hz[blind.out_of_plane > 0.5][:2] / f - 1.0).max() > 0.05


def compliance(spring: SolidSpring) -> float:
    """Displacement of the end per unit force [m/N]: 1/(M omega^2) under a tip that outweighs the spring."""
    heavy = replace(spring, tip=Tip(mass=1e5))
    return 1.0 / (1e5 * float(solid_modes(heavy, "symmetric", 1).omega[0]) ** 2)


def test_a_clamped_strip_is_between_strip_and_plate(shapes):
    """Stiffer than 3 EI/L^3 by more the wider it is, never by nu^2/(1 - nu^2) = 13 %."""
    shape, excess = shapes["plain"], []
    for factor in (0.5, 1.0, 4.0):
        wide = replace(shape, width=factor * shape.width)
        solid = wide.solid(replace(COARSE[1], across=max(1, round(factor))))
        free = wide.length**3 / (3.0 * wide.section.in_plane_stiffness)
        excess.append(free / compliance(solid) - 1.0)
    nu = shape.material.poissons_ratio
    assert np.all(np.diff([0.003, *excess, nu**2 / (1.0 - nu**2)]) > 0.0)
    assert excess[1] == pytest.approx(0.0118, abs=1.5e-3)


def test_a_channel_twists_as_high_as_the_folded_strip_only_with_low_flanges(letter_scene, rows):
    thin, thick = (reading_row(shapes_of(letter_scene, sheet)["channel"], 5e-4) for sheet in (0.5, 0.75))
    assert thin.ratio_twist < rows["folded"].ratio_twist < thick.ratio_twist
    assert thin.flange_m > 2.0 * thin.thickness_m and thick.flange_m < thick.thickness_m


def test_shapes_that_cannot_be_are_refused(letter_scene):
    with pytest.raises(SceneError, match="bend_radius_m"):
        shape_of(letter_scene.replace({"spring.width_m": 0.016}), "side_by_side")
    with pytest.raises(SceneError, match="no flange between"):
        brought_to(shape_of(letter_scene, "channel"), 2.0 * math.pi * 5.0)


@pytest.mark.parametrize("option", ["--off-line", "--channel-sheet"])
def test_a_size_that_is_none_is_refused(option, run_study):
    ran = run_study("spring_shape", option, "0")
    assert ran.code == 2 and option in ran.err and "greater than 0" in ran.err


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
    basis, stiffness, mass = assembled(spring)
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
    _, _, mass = assembled(folded(4, 8))
    along = np.zeros(mass.shape[0])
    along[1::3] = 1.0
    expected = BRASS.density * WIDTH * 0.7e-3 * (2.0 * LENGTH + math.pi * RADIUS)
    assert along @ mass @ along == pytest.approx(expected, rel=1e-5)


def test_turning_as_a_whole_strains_nothing_even_on_the_arc():
    basis, stiffness, _ = assembled(folded(4, 8))
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
    excess = (compliance(spring) - bending) / shear
    assert 1.0 < excess < 1.2


def test_a_thin_strip_that_does_not_contract_is_that_of_strip_theory():
    spring = clamped_strip(material=NO_CONTRACTION, tip=Tip(mass=6e-3))
    assert compliance(spring) * strip_stiffness(spring) == pytest.approx(1.0, abs=5e-4)
    beam = UniformBeam(
        length=LENGTH,
        bending_stiffness=105e9 * WIDTH * THICKNESS**3 / 12.0,
        mass_per_length=8500.0 * WIDTH * THICKNESS,
        tip_mass=6e-3,
    )
    modes, exact = solid_modes(spring, "symmetric", 3), exact_modes(beam, 3)
    assert np.all(np.abs(modes.omega / exact.omega - 1.0) < [2e-4, 2e-3, 5e-3])
    np.testing.assert_allclose(modes.phi, exact.phi, rtol=2e-3)


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
        centreline=Centreline(pieces=(Straight(length=LENGTH),)),
        sections=(section,),
        supports=("clamped", "free"),
        tip=tip,
        tip_at=LENGTH,
        drive=(0.0, 0.0, 1.0),
    )
    strip = spatial_modes(spring, 8)
    solid = solid_modes(replace(clamped_strip(tip=tip), drive=(0.0, 0.0, 1.0)), "antisymmetric", 2)
    apart = np.flatnonzero(strip.out_of_plane > 0.5)[:2]
    np.testing.assert_allclose(strip.omega[apart], solid.omega, rtol=4e-3)
    np.testing.assert_allclose(strip.phi[apart], solid.phi, rtol=5e-3, atol=1e-6)
    turns = np.abs(solid.section[:, 3])
    np.testing.assert_allclose(np.abs(strip.rotation[apart, 0]), turns, rtol=5e-3, atol=1e-3)


def test_wrong_solids_are_refused():
    spring = clamped_strip(elements=2)
    with pytest.raises(ValueError, match="clamped"):
        replace(spring, clamped=(False, False))
    with pytest.raises(ValueError, match="tip_at"):
        replace(spring, tip_at=0.1)
    with pytest.raises(ValueError, match="below 1"):
        sweep(rectangle_profile(along_n=16e-3, along_z=1e-3, cells=1), U, (2, 4, 2))
