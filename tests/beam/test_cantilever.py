"""Straight strips by elements: convergence to the frequency equation, every pair of supports, statics."""

import itertools
import math
from functools import partial

import numpy as np
import pytest
from straight_frame import uniform_beam

import beam.modes
from beam import BRASS, StripSection, Tip, assemble, cantilever, exact_modes, natural_modes, straight_strip

LENGTH = 0.13
STRIP = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
MASS = STRIP.mass_per_length * LENGTH
HEAVY = Tip(mass=0.3 * MASS, rotary_inertia=0.01 * MASS * LENGTH**2)
strip = partial(straight_strip, length=LENGTH, section=STRIP)


@pytest.mark.parametrize("tip", [Tip(), Tip(mass=0.3 * MASS), HEAVY])
@pytest.mark.parametrize("mode", [1, 2, 5, 8])
def test_frequencies_converge_at_fourth_order(tip: Tip, mode: int) -> None:
    exact = exact_modes(uniform_beam(STRIP, LENGTH, tip), mode).omega[-1]
    spring = cantilever(length=LENGTH, section=STRIP, tip=tip)
    counts = [max(4, 3 * mode), max(8, 6 * mode)]
    errors = [natural_modes(assemble(spring, n), mode).omega[-1] / exact - 1.0 for n in counts]
    assert 0.0 < errors[1] < errors[0]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("mode", [1, 3, 5])
def test_shapes_converge_at_fourth_order_and_rotations_at_third(mode: int) -> None:
    exact = exact_modes(uniform_beam(STRIP, LENGTH, HEAVY), mode)
    spring, errors = cantilever(length=LENGTH, section=STRIP, tip=HEAVY), []
    for count in (6 * mode, 12 * mode):
        along = natural_modes(assemble(spring, count), mode).displacement_along(16)
        lift = along.displacement[-1, :, 1] - exact.shapes(along.s)[-1]
        turn = along.rotation[-1] - exact.shapes(along.s, derivative=1)[-1]
        errors.append([np.sqrt(np.mean(lift**2)), np.sqrt(np.mean(turn**2))])
    rates = np.log2(np.divide(*errors))
    np.testing.assert_allclose(rates, [4.0, 3.0], atol=0.1)


@pytest.mark.parametrize("tip", [Tip(), HEAVY])
def test_default_mesh_gives_frequencies_tip_values_and_participations(tip: Tip) -> None:
    exact = exact_modes(uniform_beam(STRIP, LENGTH, tip), 20)
    modes = natural_modes(assemble(cantilever(length=LENGTH, section=STRIP, tip=tip)), 20)
    np.testing.assert_allclose(modes.omega, exact.omega, rtol=1e-4)
    np.testing.assert_allclose(modes.phi, exact.phi, rtol=1e-3)
    np.testing.assert_allclose(modes.participation, exact.participation, rtol=1e-3, atol=1e-5)
    assert modes.coupled.all()


SUPPORTS = ("clamped", "pinned", "guided", "free")


@pytest.mark.parametrize("supports", list(itertools.product(SUPPORTS, SUPPORTS)))
def test_every_pair_of_supports(supports: tuple) -> None:
    spring = strip(supports=supports, tip_at=0.3 * LENGTH)
    modes = natural_modes(assemble(spring, 60), 8)
    rigid = spring.rigid_motions
    assert rigid == (modes.omega == 0.0).sum()
    expected = exact_modes(uniform_beam(STRIP, LENGTH, Tip(), supports), 8 - rigid).omega
    np.testing.assert_allclose(modes.omega[rigid:], expected, rtol=1e-4)


def test_swinging_beam() -> None:
    """Pinned and free: the rigid rotation has phi^2 = L^2 / (m L^3/3) and Gamma = (3 m L)^(1/2)/2."""
    spring = strip(supports=("pinned", "free"), tip_at=LENGTH)
    modes = natural_modes(assemble(spring), 3)
    assert modes.omega[0] == 0.0 and modes.phi[0] == pytest.approx(math.sqrt(3.0 / MASS), rel=1e-6)
    assert modes.participation[0] == pytest.approx(math.sqrt(0.75 * MASS), rel=1e-6)
    along = modes.displacement_along(8)
    moment = np.trapezoid(along.s * along.displacement[1:, :, 1], along.s)
    np.testing.assert_allclose(moment / LENGTH**2, 0.0, atol=1e-4)


def test_static_compliance_three_ways() -> None:
    model = assemble(cantilever(length=LENGTH, section=STRIP, tip=HEAVY), 12)
    exact = LENGTH**3 / (3.0 * STRIP.bending_stiffness)
    every_mode = natural_modes(model, model.n_dofs)
    assert model.static_compliance() == pytest.approx(exact, rel=1e-10)
    assert np.sum(every_mode.phi**2 / every_mode.omega**2) == pytest.approx(exact, rel=1e-7)


def test_tip_inside_a_strip() -> None:
    """Clamped at both ends with a mass at a: static compliance a^3 b^3 / (3 EI L^3)."""
    a, b = 0.37 * LENGTH, 0.63 * LENGTH
    spring = strip(supports=("clamped", "clamped"), tip_at=a, tip=Tip(mass=MASS))
    exact = a**3 * b**3 / (3.0 * STRIP.bending_stiffness * LENGTH**3)
    for elements in (1, 2, 20):
        assert assemble(spring, elements).static_compliance() == pytest.approx(exact, rel=1e-8)


def test_strip_cut_into_pieces_is_the_same_strip() -> None:
    whole = natural_modes(assemble(cantilever(length=LENGTH, section=STRIP, tip=HEAVY), 30), 10)
    damped = dict(damped_section=STRIP, damped_span=(0.2 * LENGTH, 0.6 * LENGTH))
    cut = cantilever(length=LENGTH, section=STRIP, tip=HEAVY, **damped)
    parts = natural_modes(assemble(cut, [6, 12, 12]), 10)
    np.testing.assert_allclose(parts.omega, whole.omega, rtol=1e-7)
    np.testing.assert_allclose(parts.phi, whole.phi, rtol=1e-6)


def test_readouts() -> None:
    readouts = {"tip": beam.Readout(at=LENGTH), "middle": beam.Readout(at=0.5123 * LENGTH)}
    readouts["laser"] = beam.Readout(at=0.7 * LENGTH, quantity="rotation")
    spring = cantilever(length=LENGTH, section=STRIP, tip=HEAVY, readouts=readouts)
    modes, exact = natural_modes(assemble(spring), 6), exact_modes(uniform_beam(STRIP, LENGTH, HEAVY), 6)
    np.testing.assert_allclose(modes.readouts["tip"], modes.phi, rtol=1e-12)
    middle, laser = exact.shapes(0.5123 * LENGTH)[:, 0], exact.shapes(0.7 * LENGTH, derivative=1)[:, 0]
    np.testing.assert_allclose(modes.readouts["middle"], middle, rtol=1e-4)
    np.testing.assert_allclose(modes.readouts["laser"], laser, rtol=1e-4)


@pytest.mark.parametrize("supports", [("clamped", "free"), ("pinned", "free"), ("free", "free")])
def test_sparse_and_dense_solvers_agree_and_miss_nothing(supports, monkeypatch):
    model = assemble(strip(supports=supports, tip_at=LENGTH, tip=HEAVY))
    dense = natural_modes(model, 40)
    monkeypatch.setattr(beam.modes, "DENSE_LIMIT", 0)
    sparse = natural_modes(model, 40)
    np.testing.assert_allclose(sparse.omega, dense.omega, rtol=1e-6)
    bent = dense.omega > 0.0
    np.testing.assert_allclose(sparse.phi[bent], dense.phi[bent], rtol=1e-5)
    np.testing.assert_array_equal(natural_modes(model, 40).shapes, sparse.shapes)


@pytest.mark.filterwarnings("ignore:(mass|rotary_inertia) of the tip")  # the last are heavy on purpose
@pytest.mark.parametrize("mass", [0.0, 0.1, 10.0, 1e4])
@pytest.mark.parametrize("inertia", [0.0, 1e-6, 1e-4, 1e-2, 1.0])
def test_scan_misses_no_frequency(mass: float, inertia: float) -> None:
    """Light and heavy tips whose own rotation resonates with one bending mode or another."""
    tip = Tip(mass=mass * MASS, rotary_inertia=inertia * MASS * LENGTH**2)
    modes = natural_modes(assemble(cantilever(length=LENGTH, section=STRIP, tip=tip), 60), 12)
    exact = exact_modes(uniform_beam(STRIP, LENGTH, tip), 12)
    np.testing.assert_allclose(modes.omega, exact.omega, rtol=5e-4)
