"""The frequency equation against roots in many digits, published numbers, sum rules and static forms."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

from beam import UniformBeam, exact_modes

LENGTH, STIFFNESS, MASS = 0.13, 0.0288, 0.0663
STRIP = MASS * LENGTH
PLAIN = UniformBeam(length=LENGTH, bending_stiffness=STIFFNESS, mass_per_length=MASS)


def tipped(mass_ratio: float, inertia_ratio: float = 0.0) -> UniformBeam:
    """A cantilever whose tip has the given fractions of m L and m L^3."""
    inertia = inertia_ratio * STRIP * LENGTH**2
    return replace(PLAIN, tip_mass=mass_ratio * STRIP, tip_rotary_inertia=inertia)


@pytest.mark.parametrize("mode", [1, 2, 12, 40, 60])
@pytest.mark.parametrize(("mass", "inertia"), [(0.0, 0.0), (0.3, 0.0), (1.0, 0.01)])
def test_roots_against_hyperbolic_form_in_many_digits(mode: int, mass: float, inertia: float) -> None:
    """The textbook 2 x 2 determinant in cosh and sinh changes sign at the root, in 120 digits."""
    root = exact_modes(tipped(mass, inertia), mode).wave_numbers[-1] * LENGTH

    def textbook(x: float) -> mpmath.mpf:
        x = mpmath.mpf(x)
        c, s, ch, sh = mpmath.cos(x), mpmath.sin(x), mpmath.cosh(x), mpmath.sinh(x)
        w = (ch - c, sh - s)
        slope, moment, force = (sh + s, ch - c), (ch + c, sh + s), (sh - s, ch + c)
        top = [moment[i] - inertia * x**3 * slope[i] for i in range(2)]
        low = [force[i] + mass * x * w[i] for i in range(2)]
        return top[0] * low[1] - top[1] * low[0]

    with mpmath.workdps(120):
        assert textbook(root * (1 - 1e-12)) * textbook(root * (1 + 1e-12)) < 0


def test_high_modes_are_all_there() -> None:
    modes = exact_modes(PLAIN, 120)
    np.testing.assert_allclose(modes.wave_numbers[2:] * LENGTH, (np.arange(2, 120) + 0.5) * np.pi, atol=1e-3)
    np.testing.assert_allclose(modes.phi**2 * STRIP, 4.0, rtol=1e-9)


@pytest.mark.parametrize(
    ("ratio", "printed", "limit"),
    [
        (0.1, [1, 0.634, 0.419, 0.351, 0.320, 0.295], 0.289),
        (0.3, [1, 0.768, 0.634, 0.592, 0.573, 0.557], 0.554),
        (1.0, [1, 0.900, 0.842, 0.824, 0.816, 0.809], 0.8075),
    ],
)
def test_share_of_mode_1_in_a_hard_impact(ratio: float, printed: list[float], limit: float) -> None:
    phi = exact_modes(tipped(ratio), 100).phi
    shares = phi[0] ** 2 / np.cumsum(phi**2)
    np.testing.assert_allclose(shares[[0, 1, 4, 9, 19, 99]], printed, atol=5.1e-4)
    assert ratio * STRIP * phi[0] ** 2 == pytest.approx(limit, abs=5.1e-4)


@pytest.mark.parametrize("beam", [PLAIN, tipped(0.3), tipped(0.3, 0.02)])
def test_static_sums(beam: UniformBeam) -> None:
    modes = exact_modes(beam, 80)
    flexibility = np.cumsum(modes.phi**2 / modes.omega**2)
    sag = np.cumsum(modes.participation * modes.phi / modes.omega**2)
    compliance = LENGTH**3 / (3.0 * STIFFNESS)
    assert flexibility[-1] == pytest.approx(compliance, rel=2e-6)
    exact = MASS * LENGTH**4 / (8.0 * STIFFNESS) + beam.tip_mass * LENGTH**3 / (3.0 * STIFFNESS)
    assert sag[-1] == pytest.approx(exact, rel=1e-7)
    assert np.all(np.diff(flexibility) > 0.0) and flexibility[-1] < compliance


@pytest.mark.parametrize("beam", [tipped(0.1), tipped(1.0)])
def test_dynamic_sums_converge_at_their_rates(beam: UniformBeam) -> None:
    modes = exact_modes(beam, 160)
    unit = np.abs(np.cumsum(modes.participation * modes.phi) - 1.0)
    total = STRIP + beam.tip_mass - np.cumsum(modes.participation**2)
    tip = 1.0 / beam.tip_mass - np.cumsum(modes.phi**2)
    for remainder in (total, tip):
        assert np.log2(remainder[79] / remainder[159]) == pytest.approx(1.0, abs=0.1)
    assert unit[159] < 2e-4 < unit[9]


def test_modes_are_orthogonal_with_the_tip_included_and_participate() -> None:
    beam = tipped(0.4, 0.03)
    modes = exact_modes(beam, 15)
    x, weight = np.polynomial.legendre.leggauss(300)
    shapes, turn = modes.shapes(0.5 * LENGTH * (1.0 + x)), modes.shapes(LENGTH, derivative=1)
    gram = 0.5 * LENGTH * MASS * (shapes * weight) @ shapes.T
    gram += beam.tip_mass * np.outer(modes.phi, modes.phi) + beam.tip_rotary_inertia * turn @ turn.T
    np.testing.assert_allclose(gram, np.eye(15), atol=1e-10)
    pulled = 0.5 * LENGTH * MASS * shapes @ weight + beam.tip_mass * modes.phi
    np.testing.assert_allclose(modes.participation, pulled, atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_derivatives_of_shapes_against_differences(order: int) -> None:
    modes = exact_modes(tipped(0.4), 6)
    s, step = np.linspace(0.1, 0.9, 5) * LENGTH, 1e-6 * LENGTH
    rise = modes.shapes(s + step, derivative=order - 1) - modes.shapes(s - step, derivative=order - 1)
    off = modes.shapes(s, derivative=order) - rise / (2.0 * step)
    assert np.abs(off / modes.wave_numbers[:, None] ** order).max() < 1e-7 * np.abs(modes.phi).max()
