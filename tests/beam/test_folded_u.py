"""The folded U against an independent planar frame, a finer mesh, closed rings and Castigliano's theorem."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from straight_frame import frame_frequencies, polygon

import beam
from beam.space import upright

RADII = (7.5e-3, 15e-3, 30e-3)
STRIP = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=0.65e-3)
BALL = beam.Tip(mass=4e-3, rotary_inertia=3e-8)


@functools.cache
def u_of(radius: float) -> beam.Modes:
    spring = beam.folded_u(leg_length=0.13, bend_radius=radius, section=STRIP, tip=BALL)
    return beam.natural_modes(beam.assemble(spring), 20)


@pytest.mark.parametrize("radius", RADII)
def test_first_ten_frequencies_against_an_independent_frame(radius: float) -> None:
    frame = frame_frequencies(polygon(radius, 60, 400), upright(STRIP), BALL, 10, moves=(0, 1, 5))
    np.testing.assert_allclose(u_of(radius).frequencies_hz[:10], frame, rtol=2e-4)


@pytest.mark.parametrize("radius", RADII)
def test_sway_couples_and_breathing_does_not(radius: float) -> None:
    modes = u_of(radius)
    model = modes.discretization
    total = model.spring.strip_mass + BALL.mass
    assert modes.coupled.sum() == 10
    still = ~modes.coupled
    assert np.abs(model.tip @ modes.shapes[:, still]).max() * math.sqrt(total) < 1e-7
    assert np.abs(model.base_load @ modes.shapes[:, still]).max() / math.sqrt(total) < 1e-7
    assert np.abs(modes.phi[modes.coupled]).min() * math.sqrt(total) > 1e-2


@pytest.mark.parametrize("radius", RADII)
def test_symmetry_of_the_two_families(radius: float) -> None:
    """Mirrored in the axis of the U, sway modes keep their y displacement, breathing modes reverse it."""
    modes = u_of(radius)
    along = modes.displacement_along(2)
    np.testing.assert_allclose(along.s + along.s[::-1], along.s[-1], rtol=1e-12)
    y = along.displacement[:, :, 1]
    parity = np.where(modes.coupled, 1.0, -1.0)[:, None]
    np.testing.assert_allclose(y[:, ::-1], parity * y, atol=1e-5 * np.abs(y).max())


def test_driving_along_the_legs_couples_the_other_family() -> None:
    across = beam.folded_u(leg_length=0.13, bend_radius=15e-3, section=STRIP, tip=BALL)
    along = replace(across, drive=(2.0, 0.0))
    assert along.drive == (1.0, 0.0)
    sway, breathing = (beam.natural_modes(beam.assemble(spring), 10) for spring in (across, along))
    np.testing.assert_allclose(sway.omega, breathing.omega, rtol=1e-6)
    np.testing.assert_array_equal(sway.coupled, ~breathing.coupled)


def test_static_compliance_of_the_u_by_castigliano() -> None:
    """Bending and stretching energy of one half of the U, cut at the ball, under half the force.

    By symmetry of sway the cut carries no moment, a force 1/2 along y and a force along x that keeps the ball
    from moving along x, i.e. the one that makes the energy of the half least. The compliance is 4 times that.
    """
    radius, leg = 15e-3, 0.13
    turn, x = np.linspace(0.0, 0.5 * np.pi, 4001), np.linspace(0.0, leg, 4001)  # from the ball to the support

    def energy(fx: float, fy: float) -> float:
        along = fy * np.cos(turn) + fx * np.sin(turn)
        in_bend = radius * (fy * (1.0 - np.cos(turn)) - fx * np.sin(turn)), along
        in_leg = fy * (radius + x) - fx * radius, np.full_like(x, fx)
        pairs = zip(in_bend, in_leg, strict=True)
        moment, force = (radius * np.trapezoid(a**2, turn) + np.trapezoid(b**2, x) for a, b in pairs)
        return 0.5 * (moment / STRIP.bending_stiffness + force / STRIP.axial_stiffness)

    along, across = energy(1.0, 0.0), energy(0.0, 1.0)
    least = 0.25 * (across - (energy(1.0, 1.0) - along - across) ** 2 / (4.0 * along))
    model = beam.assemble(beam.folded_u(leg_length=leg, bend_radius=radius, section=STRIP, tip=BALL))
    assert model.static_compliance() == pytest.approx(4.0 * least, rel=1e-5)


@pytest.mark.parametrize("turn", [math.pi, math.pi / 2])
def test_ring_segment_between_guides(turn: float) -> None:
    """Ends that slide along the normal are planes of symmetry: exact modes u = A sin(n a), w = B cos(n a).

    Each n gives a 2 x 2 problem with strain (n A - B)/R and change of curvature n (A - n B)/R^2.
    """
    radius = 0.05
    line = beam.Centreline(pieces=(beam.Arc(radius=radius, angle=turn),))
    others = dict(sections=(STRIP,), supports=("guided", "guided"), tip=beam.Tip(), tip_at=0.0)
    spring, expected = beam.LeafSpring(centreline=line, **others), []
    for n in np.pi / turn * np.arange(30):
        stretch, bend = np.array([n, -1.0]) / radius, n * np.array([1.0, -n]) / radius**2
        k = STRIP.axial_stiffness * np.outer(stretch, stretch)
        k += STRIP.bending_stiffness * np.outer(bend, bend)
        expected += list(np.linalg.eigvalsh(k / STRIP.mass_per_length)[0 if n else 1 :])
    bent = np.sort([value for value in expected if value > 1.0])
    modes = beam.natural_modes(beam.assemble(spring, 120), 8)
    rigid = spring.rigid_motions
    assert rigid == (1 if turn == math.pi else 0)
    np.testing.assert_allclose(modes.omega[rigid:] ** 2, bent[: 8 - rigid], rtol=2e-5)


def test_elements_converge_at_fourth_order_on_the_arc() -> None:
    spring = beam.folded_u(leg_length=0.13, bend_radius=15e-3, section=STRIP, tip=BALL)
    meshes = ([60, n, 60] for n in (8, 16, 160))
    coarse, fine, finest = (beam.natural_modes(beam.assemble(spring, mesh), 1).omega[0] for mesh in meshes)
    assert math.log2((coarse - finest) / (fine - finest)) == pytest.approx(4.0, abs=0.1)


def test_shapes_along_the_centreline() -> None:
    modes = u_of(15e-3)
    along, spring = modes.displacement_along(4), modes.discretization.spring
    assert along.displacement.shape == (20, along.s.size, 3) and along.rotation.shape == (20, along.s.size)
    assert np.all(np.diff(along.s) > 0.0) and along.s[0] == 0.0 and along.s[-1] == spring.centreline.length
    np.testing.assert_allclose(along.displacement[:, [0, -1]], 0.0, atol=1e-9)
    ball = np.argmin(np.abs(along.s - spring.tip_at))
    np.testing.assert_allclose(along.displacement[:, ball, 1], modes.phi, atol=1e-7)
    np.testing.assert_allclose(along.points[ball], [0.145, 0.0, 0.0], atol=1e-15)
    # the rotation is the part of dr/ds across the strip, smooth also where the curvature jumps
    slope = np.gradient(along.displacement, along.s, axis=1, edge_order=2)
    across = np.einsum("kpi,pi->kp", slope, along.normal)
    np.testing.assert_allclose(across[:4], along.rotation[:4], atol=2e-3 * np.abs(along.rotation[:4]).max())


def test_sign_rule() -> None:
    modes = u_of(15e-3)
    assert np.all(modes.phi >= 0.0)
    along = modes.displacement_along(2)
    w = np.einsum("kpi,pi->kp", along.displacement, along.normal)[~modes.coupled]
    first = np.argmax(np.abs(w) > 0.5 * np.abs(w).max(axis=1, keepdims=True), axis=1)
    assert np.all(w[np.arange(len(first)), first] > 0.0)
