"""Finite rotations: elastica, backbone coefficients, periodic motions and the decay of deviations."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

import beam
from beam import BRASS, FiniteRotation, LeafSpring, StripSection, Tip, backbone_coefficient, periodic_motion

pytestmark = pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")  # heavy tips, thin strips

LEG = 0.13
STRIP = StripSection(material=BRASS, width=12e-3, thickness=0.7e-3)


def folded_u(
    radius: float = 7.5e-3, thickness: float = 0.7e-3, mass: float = 6e-3, section: StripSection = STRIP
) -> LeafSpring:
    """A U whose tip is as heavy, compared with its strip, at every thickness."""
    tip, section = Tip(mass=mass * thickness / 0.7e-3), replace(section, thickness=thickness)
    return beam.folded_u(leg_length=LEG, bend_radius=radius, section=section, tip=tip)


def leaf(thickness: float = 0.7e-3, mass: float = 0.0) -> LeafSpring:
    return beam.cantilever(length=LEG, section=replace(STRIP, thickness=thickness), tip=Tip(mass=mass))


def hook() -> LeafSpring:
    """A leg and a bend of 100 degrees: motions to either side differ."""
    line = beam.Centreline(pieces=(beam.Straight(length=LEG), beam.Arc(radius=0.03, angle=1.75)))
    others = dict(sections=(STRIP, STRIP), supports=("clamped", "free"), tip=Tip(mass=5e-3))
    return LeafSpring(centreline=line, tip_at=line.length, **others)


def bent(model: FiniteRotation, force: float) -> NDArray[np.float64]:
    """Equilibrium under a force on the tip along the drive, by Newton's method in ten steps of load."""
    x = np.zeros_like(model.linear.tip)
    for load in np.linspace(0.1, 1.0, 10) * force:
        for _ in range(8):
            left = model.force(x) - load * model.linear.tip
            x = x - splu(model.stiffness(model.densities(x)).tocsc()).solve(left)
    assert np.abs(model.force(x) - force * model.linear.tip).max() < 1e-6 * force
    return x


def test_force_and_stiffness_are_derivatives_of_the_energy() -> None:
    model, rng = FiniteRotation.of(folded_u(), 3), np.random.default_rng(1)
    x, d = 1e-5 * rng.standard_normal((2, model.linear.tip.size))
    h = 1e-3
    after, before = x + h * d, x - h * d
    assert model.force(x) @ d == pytest.approx((model.energy(after) - model.energy(before)) / (2 * h))
    slope = (model.force(after) - model.force(before)) / (2 * h)
    found = model.stiffness(model.densities(x)) @ d
    np.testing.assert_allclose(found, slope, atol=1e-7 * np.abs(slope).max())


def test_small_motions_are_those_of_the_linear_model() -> None:
    model = FiniteRotation.of(folded_u(), 6)
    linear = model.linear.stiffness
    same = model.stiffness(model.densities(np.zeros_like(model.linear.tip))) - linear
    assert abs(same).max() < 1e-12 * abs(linear).max()


@pytest.mark.parametrize("load, deflection", [(1.0, 0.30172), (2.0, 0.49346)])
def test_elastica(load: float, deflection: float) -> None:
    """A cantilever under P L^2/EI (K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272)."""
    thin = leaf(thickness=0.1e-3)
    model = FiniteRotation.of(thin, 24)
    force = load * thin.sections[0].bending_stiffness / LEG**2
    assert model.linear.tip @ bent(model, force) / LEG == pytest.approx(deflection, abs=1e-5)


def test_restoring_force_of_a_guided_leg() -> None:
    """x + (36/35) x^3 with x = y/L: two cantilevers of half its length."""
    model = FiniteRotation.of(leaf(thickness=0.05e-3), 24)
    linear = 3.0 * model.linear.spring.sections[0].bending_stiffness / LEG**2
    excess = []
    for force in (0.05 * linear, 0.1 * linear):
        x = model.linear.tip @ bent(model, force) / LEG
        excess.append((force / linear / x - 1.0) / x**2)
    assert (4 * excess[0] - excess[1]) / 3 == pytest.approx(36 / 35, rel=2e-4)


def test_heavy_tip_on_a_massless_leg() -> None:
    """27/70 elastic, -9/25 inertial; the leg's own mass is 9e-3 of the tip's, its stretching (t/L)^2."""
    found = backbone_coefficient(leaf(thickness=0.05e-3, mass=1.0))
    assert (found.elastic, found.inertial) == pytest.approx((27 / 70, -9 / 25), rel=5e-5)
    assert found.length == LEG


def test_backbone_does_not_know_the_modulus_and_hardly_the_thickness() -> None:
    """Only stretching knows the thickness, by its square: 0.8 % at 0.7 mm."""
    kappa = [backbone_coefficient(folded_u(thickness=t)).kappa for t in (0.7e-3, 0.35e-3, 0.175e-3)]
    falls = kappa[1] - kappa[0], kappa[2] - kappa[1]
    assert falls[0] / falls[1] == pytest.approx(4.0, rel=0.02)
    assert 4 / 3 * falls[0] / kappa[2] == pytest.approx(0.008, abs=0.002)
    stiff = replace(STRIP, material=replace(BRASS, youngs_modulus=2 * BRASS.youngs_modulus))
    assert backbone_coefficient(folded_u(section=stiff)).kappa == pytest.approx(kappa[0], rel=1e-6)


def test_coupling_of_a_narrow_u_with_a_heavy_tip() -> None:
    """-(9/2800)(L/r)^2: the legs bow under the axial forces 6 EI y/(L^2 r) of the sway, but for order r/L."""
    springs = {r: folded_u(radius=r, thickness=0.02e-3, mass=1e3) for r in (4e-3, 2e-3)}
    wide, narrow = (backbone_coefficient(u).kappa * (r / LEG) ** 2 for r, u in springs.items())
    assert 2 * narrow - wide == pytest.approx(-9 / 2800, rel=5e-3)


@pytest.mark.parametrize("drawn", [pytest.param(folded_u, marks=pytest.mark.slow), leaf, hook])
def test_backbone_against_harmonic_balance(drawn: Callable[[], LeafSpring]) -> None:
    """Motions to either side, their amplitudes falling by half, to the limit of both."""
    model, backbone = FiniteRotation.of(drawn(), 12), backbone_coefficient(drawn(), 12)
    first, shifts = periodic_motion(model, 1e-6).omega, []
    for amplitude in (2e-3, 4e-3):
        motions = [periodic_motion(model, side * amplitude, harmonics=3) for side in (1, -1)]
        assert max(abs(motion.decay_rate) for motion in motions) < 1e-8
        faster = np.mean([motion.omega for motion in motions]) / first - 1.0
        shifts.append(faster * (backbone.length / amplitude) ** 2)
    assert (4 * shifts[0] - shifts[1]) / 3 == pytest.approx(backbone.kappa, rel=2e-4, abs=1e-6)


def test_mesh_of_the_backbone() -> None:
    """The default mesh is good to 1e-5; half the elements are ten times as far off, as the arc's h^4 says."""
    meshes = (240, 96, 240), None, (60, 24, 60)
    fine, default, half = (backbone_coefficient(folded_u(), mesh).kappa for mesh in meshes)
    assert default == pytest.approx(fine, rel=3e-5) and 8 < (half - fine) / (default - fine) < 32


def test_harmonic_balance_against_time_integration() -> None:
    """The U comes back after the period found: implicit midpoint rule, steps to the limit."""
    model = FiniteRotation.of(folded_u(), 2)
    motion = periodic_motion(model, 6e-3, harmonics=7)
    mass = model.linear.mass.toarray()

    def end(steps: int) -> NDArray[np.float64]:
        h, x = 2 * np.pi / motion.omega / steps, motion.coefficients.sum(axis=0).real
        v = (1j * motion.omega * motion.harmonics @ motion.coefficients).real
        for _ in range(steps):
            middle = x + 0.5 * h * v
            for _ in range(4):
                left = mass @ (middle - x - 0.5 * h * v) + 0.25 * h**2 * model.force(middle)
                slope = mass + 0.25 * h**2 * model.stiffness(model.densities(middle)).toarray()
                middle = middle - np.linalg.solve(slope, left)
            x, v = 2 * middle - x, 4 * (middle - x) / h - v
        return np.array([model.linear.tip @ x, model.linear.tip @ v / motion.omega]) / 6e-3

    coarse, fine = end(100), end(200)
    np.testing.assert_allclose((4 * fine - coarse) / 3, [1.0, 0.0], atol=2e-5)


def test_deviations_from_a_driven_motion() -> None:
    """-mu/2 +- i (omega_1 - omega) for a small one; sqrt((D + k)(D + 3 k)) at a finite amplitude."""
    model, decay = FiniteRotation.of(folded_u(), 8), 3.56
    first = periodic_motion(model, 1e-6).omega
    for amplitude, frequency in ((1e-5, 22.2), (4e-3, 20.9), (4e-3, 23.4)):
        motion = periodic_motion(model, amplitude, frequency=frequency, decay_rate=decay, harmonics=3)
        k = periodic_motion(model, amplitude, harmonics=3).omega - first
        detuning = np.sqrt(first**2 - decay**2 / 4) - 2 * np.pi * frequency
        turning = np.sqrt((detuning + k) * (detuning + 3 * k))
        close = 1e-3 * (amplitude / 4e-3) ** 2 + 1e-7
        assert motion.exponent() == pytest.approx(-decay / 2 + 1j * turning, rel=close)
        period, close = 2 * np.pi / (motion.omega + turning), 1e-5 * (amplitude / 1e-3) ** 2 + 1e-8
        assert motion.effective_period == pytest.approx(period, rel=close)
        assert motion.tip(np.array([0.0]))[0] == pytest.approx(amplitude, rel=1e-9)


def test_drive_of_a_small_motion() -> None:
    """2 |Z| |tip (K - w^2 M + i w mu M)^-1 b| is the amplitude; half a period later the tip is opposite."""
    model, decay, amplitude = FiniteRotation.of(folded_u(), 8), 3.56, 1e-6
    motion = periodic_motion(model, amplitude, frequency=22.2, decay_rate=decay, harmonics=2)
    linear, w = model.linear, motion.omega
    stiffness = linear.stiffness + (1j * decay * w - w**2) * linear.mass
    pulled = splu(stiffness.tocsc()).solve(linear.base_load + 0j)
    assert 2 * abs(motion.drive) * abs(linear.tip @ pulled) == pytest.approx(amplitude, rel=1e-7)
    times = np.array([0.0, 0.25, 0.5]) * 2 * np.pi / w
    np.testing.assert_allclose(motion.tip(times) / amplitude, [1.0, 0.0, -1.0], atol=1e-6)


def test_mode_1_is_the_first_that_moves_the_tip() -> None:
    """A U driven along its legs: the sway, lowest by far, leaves the tip at rest along the drive."""
    along = replace(folded_u(), drive=(1.0, 0.0))
    modes = beam.natural_modes(beam.assemble(along, 12), 4)
    omega, _ = FiniteRotation.of(along, 12).first_mode
    first = np.flatnonzero(modes.phi)[0]
    assert first > 0 and omega == pytest.approx(modes.omega[first], rel=1e-9)
    assert np.isfinite(backbone_coefficient(along, 12).kappa)
