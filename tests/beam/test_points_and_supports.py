"""Points of a spring by name, supports between its ends, and constant forces."""

from dataclasses import replace

import numpy as np
import pytest

import beam
from beam import assemble, natural_modes

STRIP = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=1e-3)
LENGTH = 0.2
BARE = beam.straight_strip(length=LENGTH, section=STRIP, supports=("pinned", "pinned"), tip_at=0.05)
PINNED = replace(BARE, tip=beam.Tip(mass=1e-3))
U = beam.folded_u(leg_length=0.13, bend_radius=7.5e-3, section=STRIP, tip=beam.Tip(mass=4e-3))


def test_a_pin_in_the_middle_makes_two_spans():
    """Antisymmetric modes are those of a pinned span, symmetric ones those of one clamped at the pin."""
    modes = natural_modes(assemble(replace(BARE, between={0.5 * LENGTH: "pinned"}), 120), 4)
    roots = np.array([np.pi, 3.926602312047919, 2 * np.pi, 7.068582745628732])
    exact = (roots / (0.5 * LENGTH)) ** 2 * np.sqrt(STRIP.bending_stiffness / STRIP.mass_per_length)
    np.testing.assert_allclose(modes.omega, exact, rtol=1e-6)


def test_a_clamp_between_the_ends_divides_the_strip_and_a_pin_ends_rigid_motions():
    free = replace(BARE, supports=("free", "free"))
    assert free.rigid_motions == 2 and replace(free, between={0.1: "pinned"}).rigid_motions == 1
    held = replace(free, between={0.1: "clamped"})
    assert held.rigid_motions == 0
    exact = (1.875104068711961 / 0.1) ** 2 * np.sqrt(STRIP.bending_stiffness / STRIP.mass_per_length)
    np.testing.assert_allclose(natural_modes(assemble(held, 60), 2).omega, exact, rtol=1e-6)


def test_a_support_at_a_joint_of_two_pieces_is_built_in():
    at = float(U.centreline.joints[1])
    moved = natural_modes(assemble(replace(U, between={at * (1 + 1e-5): "pinned"})), 6).omega
    built_in = natural_modes(assemble(replace(U, between={at: "pinned"})), 6).omega
    np.testing.assert_allclose(built_in, moved, rtol=1e-3)
    assert np.all(moved[0] > 1.2 * natural_modes(assemble(U), 1).omega[0])


def test_points_have_their_rows_statics_and_masses():
    """Over all modes sum row^2/omega^2 is the static compliance; the ball's mass belongs to the ball."""
    spring = replace(PINNED, points={"far": 0.15, "ball": (0.05, 0.0)})
    model = beam.reduce(natural_modes(assemble(spring, 24), 47), beam.ConstantRatio(ratio=0.01))
    far, ball = model.points["far"], model.points["ball"]
    for point in (far, ball):
        assert point.static_compliance == pytest.approx(np.sum((point.row / model.omega) ** 2), rel=1e-9)
    x, rest, stiffness = 0.15, 0.05, 3.0 * STRIP.bending_stiffness * LENGTH
    assert far.static_compliance == pytest.approx((x * rest) ** 2 / stiffness, rel=1e-7)
    assert far.mass == 0.0 and ball.mass == 1e-3
    np.testing.assert_allclose(ball.row, model.phi, rtol=1e-9, atol=1e-9)
    # a constant force moves every point by the compliance between the two places
    bent = model.load_of({"far": 2.0}) / model.omega**2
    assert far.row @ bent == pytest.approx(2.0 * far.static_compliance, rel=1e-9)
    a = 0.05  # from the other end: w(x) = F b x (L^2 - b^2 - x^2)/(6 EI L)
    exact = 2.0 * rest * a * (LENGTH**2 - rest**2 - a**2) / (2.0 * stiffness)
    assert model.phi @ bent == pytest.approx(exact, rel=1e-7)


def test_a_point_keeps_the_modes_that_move_it():
    """The breathing modes of a folded U leave the ball at rest, but not a leg."""
    modes = natural_modes(assemble(replace(U, points={"leg": 0.06})), 10)
    assert modes.coupled.all() and not natural_modes(assemble(U), 10).coupled.all()
    for s in (0.03, 0.135, 0.14, 0.2):
        near, away = U.centreline.nearest(U.centreline.points(s)[:2])
        assert near == pytest.approx(s, rel=1e-9) and away < 1e-15
    assert PINNED.centreline.nearest((-0.01, -0.01)) == (0.0, pytest.approx(0.01 * np.sqrt(2.0)))
