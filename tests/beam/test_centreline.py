"""Centrelines against quadrature of the tangent and the Frenet equations."""

from itertools import pairwise

import numpy as np

from beam import Arc, Centreline, Straight

LINE = Straight(length=0.05), Arc(radius=0.02, angle=2.0), Straight(length=0.01), Arc(radius=0.03, angle=-1.0)
WINDING = Centreline(pieces=LINE, start=(0.1, -0.2), heading=0.4)


def test_points_are_the_integral_of_the_tangent() -> None:
    for s in (0.03, 0.05, 0.07, 0.095, 0.12):
        x, weight = np.polynomial.legendre.leggauss(20)
        cuts = np.append(WINDING.joints[WINDING.joints < s], s)
        walk = np.array([0.1, -0.2, 0.0])
        for a, b in pairwise(cuts):
            tangent, _ = WINDING.frame(a + 0.5 * (b - a) * (1.0 + x))
            walk = walk + 0.5 * (b - a) * weight @ tangent
        np.testing.assert_allclose(WINDING.points(s), walk, atol=1e-14)
    assert WINDING.points(np.zeros((2, 3))).shape == (2, 3, 3) and not WINDING.is_straight


def test_frenet() -> None:
    step = 1e-6
    for s, k in ((0.02, 0.0), (0.07, 50.0), (0.095, 0.0), (0.11, -1.0 / 0.03)):
        t, n = WINDING.frame(s)
        later, earlier = WINDING.frame(s + step), WINDING.frame(s - step)
        np.testing.assert_allclose((later[0] - earlier[0]) / (2 * step), k * n, atol=1e-6)
        np.testing.assert_allclose((later[1] - earlier[1]) / (2 * step), -k * t, atol=1e-6)
        np.testing.assert_allclose(np.cross(t, n), [0.0, 0.0, 1.0], atol=1e-15)
