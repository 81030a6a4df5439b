"""Sections against independent quadrature, a finite-difference torsion problem and a published limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import diags, identity, kron
from scipy.sparse.linalg import spsolve

from beam import BRASS, DAMPING_TAPE, Layer, StripSection

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
