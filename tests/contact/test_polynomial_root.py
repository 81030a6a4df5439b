"""The first rising root of a polynomial in an interval."""

import numpy as np
import pytest

from contact.flight.polynomial_root import first_polynomial_root


def polynomial(roots: np.ndarray, sign: float) -> np.ndarray:
    """Coefficients in rising order of sign * prod (s - r), scaled to a largest entry of one."""
    coefficients = np.array([sign])
    for r in roots:
        coefficients = np.convolve(coefficients, [-r, 1.0])
    return coefficients / np.abs(coefficients).max()


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_first_rising_root_of_a_polynomial(degree):
    generator, none = np.random.default_rng([14, degree]), 0
    for _ in range(200):
        roots = generator.uniform(0.05, 1.3) + np.cumsum(generator.uniform(0.02, 0.3, degree))
        # negative at zero
        coefficients = polynomial(roots, 1.0)
        coefficients *= -np.sign(coefficients[0])
        result = first_polynomial_root(coefficients, 1.0, 1.0, 1e-15)
        if roots[0] > 1.0:
            none += 1
            assert result == -1.0
        else:
            slope = np.polynomial.polynomial.polyval(roots[0], np.polynomial.polynomial.polyder(coefficients))
            assert abs(result - roots[0]) < 1e-14 + 1e-14 / slope
    assert 0 < none < 200


def test_touch_of_zero_within_the_margin_has_no_consequence():
    """-(s - 1/2)^2 only touches zero and has no rising root; the same lifted by 1e-10 has one."""
    touching = np.array([-0.25, 1.0, -1.0])
    assert first_polynomial_root(touching, 1.0, 1.0, 1e-15) == -1.0
    lifted = touching + np.array([1e-10, 0.0, 0.0])
    assert first_polynomial_root(lifted, 1.0, 1.0, 1e-15) == pytest.approx(0.5 - 1e-5, abs=1e-11)
    then_rising = np.convolve(touching, [0.8, -1.0])  # touches at 0.5, rises through zero at 0.8
    assert first_polynomial_root(then_rising, 1.0, 1.0, 1e-15) == pytest.approx(0.8, abs=1e-12)


def test_polynomial_already_above_zero_is_left_in_few_steps():
    """Positive and falling at the start, which no contact should be: an answer all the same, and soon."""
    assert first_polynomial_root(np.array([1.0, -0.5]), 1.0, 1.0, 1e-16) == -1.0
    falling_then_rising = np.array([0.06, -0.5, 1.0])  # zeros at 0.2 and 0.3
    assert first_polynomial_root(falling_then_rising, 1.0, 1.0, 1e-16) == pytest.approx(0.3, abs=1e-14)


def test_polynomial_that_starts_at_zero_and_falls():
    """Entry into a contact: force zero and growing; the next zero is the release, the start is none."""
    for speed in (1.0, 1e-3, 1e-9):
        coefficients = np.array([0.0, -speed, 0.0, speed / 0.36])  # speed s (s^2/0.36 - 1)
        assert first_polynomial_root(coefficients, 1.0, 1.0, 1e-16) == pytest.approx(0.6, rel=1e-6)
        assert first_polynomial_root(coefficients, 1.0, 0.5, 1e-16) == -1.0
