"""Sections against independent quadrature, a finite-difference torsion problem and a published limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import diags, identity, kron
from scipy.sparse.linalg import spsolve

import beam
from beam import BRASS, DAMPING_TAPE, STEEL, BeamSection, Layer, StripSection

BARE = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)


@pytest.mark.parametrize("both_sides", [True, False])
def test_layered_strip_against_slices(both_sides: bool) -> None:
    """Sums over the middles of 40 000 slices of the height."""
    section = replace(BARE, layer=Layer(material=DAMPING_TAPE, thickness=0.4e-3, both_sides=both_sides))
    low = 0.4e-3 if both_sides else 0.0
    dy = (low + BARE.thickness + 0.4e-3) / 40_000
    y = (np.arange(40_000) + 0.5) * dy
    materials = np.where((y > low) & (y < low + BARE.thickness), BRASS, DAMPING_TAPE)
    names = "youngs_modulus", "density", "loss_factor"
    modulus, density, eta = (np.array([getattr(one, name) for one in materials]) for name in names)
    neutral = np.sum(modulus * y) / np.sum(modulus)
    bending = section.width * modulus * (y - neutral) ** 2 * dy
    assert section.bending_stiffness == pytest.approx(bending.sum(), rel=2e-4)
    assert section.bending_loss_factor == pytest.approx(eta @ bending / bending.sum(), rel=2e-4)
    assert section.axial_loss_factor == pytest.approx(eta @ modulus / modulus.sum(), rel=2e-4)
    assert section.mass_per_length == pytest.approx(section.width * density.sum() * dy, rel=2e-4)
    assert (neutral == pytest.approx(section.total_thickness / 2, rel=1e-9)) == both_sides


def _torsion_constant(width: float, thickness: float, n: int) -> float:
    """J of a rectangle from Prandtl's stress function, Laplacian = -2, by five-point differences."""
    hx, hy = width / n, thickness / n
    second = diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n - 1, n - 1))
    one = identity(n - 1)
    laplacian = kron(second / hx**2, one) + kron(one, second / hy**2)
    stress = spsolve(laplacian.tocsc(), -2.0 * np.ones((n - 1) ** 2))
    return 2.0 * stress.sum() * hx * hy


@pytest.mark.parametrize("aspect", [1.0, 4.0])
def test_torsion_against_stress_function(aspect: float) -> None:
    section = StripSection(material=BRASS, width=aspect * 1e-3, thickness=1e-3)
    coarse, fine = (_torsion_constant(section.width, section.thickness, n) for n in (40, 80))
    extrapolated = fine + (fine - coarse) / 3.0
    shear_modulus = BRASS.youngs_modulus / (2.0 * (1.0 + BRASS.poissons_ratio))
    assert section.torsional_stiffness == pytest.approx(shear_modulus * extrapolated, rel=1e-4)


def test_glued_layer_of_the_same_material_is_a_thicker_strip() -> None:
    glued = replace(BARE, layer=Layer(material=BRASS, thickness=0.1e-3))
    solid = replace(BARE, thickness=BARE.thickness + 0.2e-3)
    for name in ("axial_stiffness", "bending_stiffness", "torsional_stiffness", "mass_per_length"):
        assert getattr(glued, name) == pytest.approx(getattr(solid, name), rel=1e-12)


def test_a_section_by_its_numbers_is_the_strip_of_these_numbers():
    """Also on bends, where the axial stiffness counts."""
    names = "bending_stiffness", "mass_per_length", "axial_stiffness", "width", "thickness"
    numbers = BeamSection(**{name: getattr(BARE, name) for name in names}, loss_factor=BRASS.loss_factor)
    shape = dict(leg_length=0.13, bend_radius=7.5e-3, tip=beam.Tip(mass=4e-3))
    springs = (beam.folded_u(section=section, **shape) for section in (BARE, numbers))
    found = [beam.natural_modes(beam.assemble(spring), 6) for spring in springs]
    np.testing.assert_array_equal(found[0].omega, found[1].omega)
    np.testing.assert_array_equal(*(beam.StripDamping().decay_rates(modes) for modes in found))
    np.testing.assert_array_equal(*(beam.solid_spring(modes).points for modes in found))


def test_a_tube_has_the_frequencies_and_the_statics_of_its_circles():
    outer, inner, length = 8e-3, 6e-3, 0.4
    tube = BeamSection.tube(material=STEEL, outer=outer, inner=inner)
    area, inertia = np.pi * (outer**2 - inner**2) / 4, np.pi * (outer**4 - inner**4) / 64
    modes = beam.natural_modes(beam.assemble(beam.cantilever(length=length, section=tube)), 3)
    roots = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])
    stiffness = STEEL.youngs_modulus * inertia
    wave = np.sqrt(stiffness / (STEEL.density * area))
    np.testing.assert_allclose(modes.omega, (roots / length) ** 2 * wave, rtol=1e-6)
    compliance = modes.discretization.static_compliance()
    assert compliance == pytest.approx(length**3 / (3 * stiffness), rel=1e-7)
    assert tube.axial_stiffness == pytest.approx(STEEL.youngs_modulus * area)
