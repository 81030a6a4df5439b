"""The readings of "U shaped": sizes by second routes, twist modes; solids against theory and strips."""

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
    StripSection,
    Tip,
    UniformBeam,
    assemble,
    exact_modes,
    folded_u,
    natural_modes,
)
from beam.space import channel_centroid, spatial_modes
from studies.scene import SceneError, single_mode_of
from studies.spring_shape.__main__ import COARSE, shapes_of
from studies.spring_shape.elasticity import assembled, solid_modes
from studies.spring_shape.rows import error_rows, reading_row
from studies.spring_shape.shapes import Mesh, Shape, brought_to, kinds_of, shape_of
from studies.spring_shape.swept_mesh import sweep

LENGTH, WIDTH, THICKNESS = 0.13, 12e-3, 1e-3
BRASS_STRIP = Shape(
    reading="plain", material=BRASS, length=LENGTH, width=WIDTH, bend_radius=7.5e-3, thickness=THICKNESS,
    tip=Tip(),
)  # fmt: skip
MESH = Mesh(legs=24, bend=8, across=1, halvings=3)
NO_CONTRACTION = Material(youngs_modulus=105e9, poissons_ratio=0.0, density=8500.0)


@pytest.fixture(scope="module")
def shapes(letter_scene):
    return shapes_of(letter_scene)


@pytest.fixture(scope="module")
def rows(shapes):
    return {name: reading_row(shape, 5e-4) for name, shape in shapes.items()}


def test_every_reading_has_the_free_period_of_the_letter(letter_scene, rows):
    omega = single_mode_of(letter_scene).omega[0]
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
    assert exact_modes(beam, 1).omega[0] == pytest.approx(single_mode_of(letter_scene).omega[0], rel=1e-6)


def test_the_sheet_of_the_folded_strip_by_the_plane_model(letter_scene, shapes):
    shape = shapes["folded"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    spring = folded_u(leg_length=shape.length, bend_radius=shape.bend_radius, section=strip, tip=shape.tip)
    assert natural_modes(assemble(spring), 1).omega[0] == pytest.approx(
        single_mode_of(letter_scene).omega[0], rel=1e-4
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
    kinds = kinds_of(shapes["folded"], spatial_modes(shapes["folded"].spring(), 7))
    assert kinds == ["bending", "breathing", "bending", "sideways", "breathing", "bending", "twist"]


def test_errors_of_strip_theory_mode_by_mode(shapes):
    """On coarse meshes: plain -0.7 %, folded twice that, half of it from the bend, which acts as a plate."""
    plain, folded = (error_rows(shapes[name], COARSE, (3, 2)) for name in ("plain", "folded"))
    assert all(-0.009 < row.error < -0.006 for row in plain[:3])
    assert all(-0.021 < row.error < -0.011 for row in folded[:3])
    assert all(abs(row.mesh_change) < 0.006 for row in plain[:3] + folded[:3])
    plain_twist, folded_twist = (
        next(row.error for row in rows if row.kind == "twist") for rows in (plain, folded)
    )
    assert -0.004 < plain_twist < -0.002 and abs(folded_twist) < 0.02
    spring = shapes["folded"].spring()
    leg, bend, _ = spring.sections
    stiff = bend.in_plane_stiffness / (1.0 - shapes["folded"].material.poissons_ratio ** 2)
    plates = spatial_modes(replace(spring, sections=(leg, replace(bend, in_plane_stiffness=stiff), leg)), 3)
    plate = plates.frequencies_hz / [row.solid_hz for row in folded[:3]] - 1.0
    assert np.all((-0.010 < plate) & (plate < -0.004))


def channel_solid(shape: Shape) -> sk.MeshHex2:
    """A swept rectangle around the channel, less what lies between its flanges; its line is straight."""
    t, high = shape.thickness, 0.5 * shape.width
    web, inner = 0.5 * t - channel_centroid(**shape.channel_sizes), high - t
    profile = (
        np.array([web - t, web, web + shape.flange]), np.array([0.0, 0.5 * inner, inner, high])
    )  # fmt: skip
    swept = sweep(profile, shape.centreline, [40], tip_at=shape.tip_at, halvings=(4, 0))
    box = replace(sk.MeshHex.from_mesh(swept), _boundaries=swept.boundaries)
    _, y, z = box.p[:, box.t].mean(axis=1)
    box = box.remove_elements(np.flatnonzero((y > web) & (z < inner)))
    return replace(sk.MeshHex2.from_mesh(box), _boundaries=box.boundaries)


def test_a_channel_against_a_solid(shapes):
    """The shear centre matters: with the centroid in its place the modes out of the plane are far off."""
    shape, spring = shapes["channel"], shapes["channel"].spring()
    strip = spatial_modes(spring, 8)
    for apart, (solid_hz, _) in enumerate(solid_modes(shape, channel_solid(shape), (2, 2))):
        f = strip.frequencies_hz[(strip.out_of_plane > 0.5) == apart][:2]
        assert np.all(np.abs(f / solid_hz - 1.0) < [3e-3, 1e-2])
    blind = spatial_modes(replace(spring, sections=(replace(spring.sections[0], shear_offset=0.0),)), 8)
    assert np.abs(blind.frequencies_hz[blind.out_of_plane > 0.5][:2] / f - 1.0).max() > 0.05


def compliance(shape: Shape, mesh: sk.MeshHex2) -> float:
    """Displacement of the end per unit force [m/N]: 1/(M omega^2) under a tip that outweighs the spring."""
    (frequencies, _), _ = solid_modes(replace(shape, tip=Tip(mass=1e5)), mesh, (1, 1))
    return 1.0 / (1e5 * (2.0 * math.pi * float(frequencies[0])) ** 2)


def test_a_clamped_strip_is_between_strip_and_plate(shapes):
    """Stiffer than 3 EI/L^3 by more the wider it is, never by nu^2/(1 - nu^2) = 13 %."""
    shape, excess = shapes["plain"], []
    for factor in (0.5, 1.0, 4.0):
        wide = replace(shape, width=factor * shape.width)
        mesh = wide.swept(replace(COARSE[1], across=max(1, round(factor))))
        free = wide.length**3 / (3.0 * wide.section.in_plane_stiffness)
        excess.append(free / compliance(wide, mesh) - 1.0)
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


def test_turning_as_a_whole_strains_nothing_even_on_the_arc():
    basis, stiffness, _ = assembled(folded(4, 8), BRASS)
    for axis in np.eye(3):
        turned = np.cross(axis, basis.doflocs.T).T.ravel()
        energy = turned @ stiffness @ turned
        assert energy < 1e-12 * (np.abs(turned) @ abs(stiffness) @ np.abs(turned))


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
