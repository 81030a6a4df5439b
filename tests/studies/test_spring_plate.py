"""The flat U as a plate against closed forms, strip theory and an independent program; its modal models."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import skfem as sk

from beam import BRASS, StripSection, Tip
from studies.shell.scene import model_of, read_scene
from studies.spring.shape.__main__ import compare_plate
from studies.spring.shape.model_error import COARSE, models_of, plates_of
from studies.spring.shape.plate import LONGEST, half_u, plate_modes

SHEET = StripSection(material=BRASS, width=12e-3, thickness=1e-3)
NU = BRASS.poissons_ratio
RIGIDITY = BRASS.youngs_modulus * 1e-9 / 12.0 / (1.0 - NU**2)


def named(mesh, clamped, symmetry=(), seat=()):
    parts = {"taped": np.array([], dtype=int), "seat": np.asarray(seat, dtype=int)}
    edges = {"clamped": clamped, "symmetry": symmetry or (lambda x: np.zeros(x.shape[1], dtype=bool))}
    return mesh.with_subdomains(parts).with_boundaries(edges)


@pytest.fixture(scope="module")
def plates(letter_scene):
    return plates_of(letter_scene, COARSE)


def test_a_square_cantilever_against_published_values():
    """omega a^2 sqrt(m/D) for nu = 0.3, extrapolated; errors against it fall at least as h^1.3."""
    sheet = replace(SHEET, material=replace(BRASS, poissons_ratio=0.3))
    found = []
    for n in (8, 16, 32):
        line = np.linspace(0.0, 0.1, n + 1)
        mesh = named(sk.MeshTri.init_tensor(line, line), lambda x: x[0] == 0.0)
        modes = plate_modes(mesh, sheet, sheet, Tip(), 5, seated=False)
        found.append(modes)
    scale = 0.1**2 * math.sqrt(8.5 * 12.0 * (1.0 - 0.3**2) / BRASS.youngs_modulus / 1e-9)
    limit = found[2].extrapolated(found[1]).omega * scale
    np.testing.assert_allclose(limit, [3.471, 8.507, 21.28, 27.20, 30.96], rtol=1.5e-3)
    errors = [np.abs(modes.omega * scale / limit - 1.0) for modes in found]
    assert np.all(errors[1] < 0.4 * errors[0]) and np.all(errors[2] < 0.4 * errors[1])


@pytest.mark.parametrize("seated", [False, True])
def test_a_heavy_ball_on_a_clamped_disc_against_the_closed_form(seated):
    """Compliance C = (a^2 - b^2 - 4 a^2 b^2 ln(a/b)^2/(a^2 - b^2))/(16 pi D), radii a of disc, b of seat."""
    a, b, found = 0.1, 0.02, []
    for n in (10, 20):
        right = sk.MeshTri.init_tensor(np.arange(n + 1.0), np.arange(n + 1.0))
        mesh = right + sk.MeshTri(right.p * [[-1.0], [1.0]], right.t)
        far = np.abs(mesh.p).max(axis=0) * a / n
        p = far * mesh.p / np.maximum(np.linalg.norm(mesh.p, axis=0), 1e-99)
        seat = np.flatnonzero(far[mesh.t].max(axis=0) < b * (1.0 + 1e-6))
        edge = a * math.cos(0.6 / n)
        sides = (lambda x, edge=edge: np.linalg.norm(x, axis=0) > edge), (lambda x: x[1] == 0.0)
        disc = named(sk.MeshTri(p, mesh.t), *sides, seat)
        tip = Tip(mass=1e5, rotary_inertia=40.0 * seated)
        found.append(plate_modes(disc, SHEET, SHEET, tip, 1 + seated, seated=seated))
    ring = a**2 - b**2 - 4.0 * (a * b * math.log(a / b)) ** 2 / (a**2 - b**2)
    closed = (ring if seated else a**2) / (16.0 * math.pi * RIGIDITY)
    found.append(found[1].extrapolated(found[0]))
    errors = np.abs(1.0 / (1e5 * np.array([modes.omega[0] for modes in found]) ** 2) / closed - 1.0)
    assert errors[1] < 0.4 * errors[0] and errors[2] < 0.3 * errors[1]
    if seated:  # tilted: w = (A r + B r^3 + C/r + E r ln r) cos(angle), and the moment is -4 pi D E
        rows = [[r, r**3, 1.0 / r, r * math.log(r)] for r in (a, b)]
        rows += [[1.0, 3.0 * r * r, -1.0 / r**2, math.log(r) + 1.0] for r in (a, b)]
        tilt = -4.0 * math.pi * RIGIDITY * np.linalg.solve(rows, [0.0, b, 0.0, 1.0])[3]
        errors = np.abs(40.0 * np.array([modes.omega[1] for modes in found]) ** 2 / tilt - 1.0)
        assert errors[1] < 0.4 * errors[0] and errors[2] < 0.3 * errors[1]


def test_the_letters_spring_against_an_independent_program(letter_scene, plates):
    """Beam over plate - 1 of modes 1 to 6, and the first mode in which the legs twist, ball on a point."""
    point, beam = plates["point"], model_of(letter_scene).omega
    nearest = [int(np.argmin(np.abs(point.omega - omega))) for omega in beam[:6]]
    differences = 100.0 * (beam[:6] / point.omega[nearest] - 1.0)
    assert differences == pytest.approx([-0.50, -0.23, 0.04, 0.52, 0.45, 2.3], abs=0.03)
    assert 4 not in nearest and point.omega[4] == pytest.approx(2.0 * math.pi * 1414.0, rel=1e-3)
    assert point.phi[4] == pytest.approx(0.56, abs=0.01)
    assert point.participation[4] == pytest.approx(0.0055, abs=1e-4)
    assert np.all(plates["seat"].omega > point.omega)


def test_plates_have_period_and_damping_of_the_beam(letter_scene, plates):
    beam, *others = models_of(plates, model_of(letter_scene)).values()
    for model in others:
        assert model.free_period == pytest.approx(beam.free_period, rel=1e-12)
        assert model.decay_rate[0] == pytest.approx(3.56)


def test_every_cell_of_the_u_is_divided_as_often_as_asked():
    sizes = dict(leg=0.1, radius=6e-3, width=0.012, seat=3e-3, covered=0.05, cells=(1, 2))
    once, thrice = (half_u(**sizes, times=times) for times in (1, 3))
    assert thrice.nelements == 9 * once.nelements
    (x, z), near = once.p, 1e-9
    leg = np.unique(x[(x < 0.0) & (abs(z - z.max()) < near)].round(9))
    assert np.diff(leg).max() <= LONGEST * 0.006 / 3 + near


def test_a_spring_that_is_no_flat_u_goes_without_the_plate():
    said = []
    assert compare_plate(read_scene("tight_fold"), SimpleNamespace(say=said.append)) == []
    assert len(said) == 1 and "flat U" in said[0]
