"""Strips in space against closed forms, the plane model, straight frame elements and solids."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from straight_frame import frame_frequencies, polygon

import beam
from beam import BRASS, Arc, Centreline, Straight, StripSection, Tip
from beam.space import SpatialModes, SpatialSection, SpatialSpring, channel, flat, spatial_modes, upright

STRIP = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
BALL = Tip(mass=4e-3, rotary_inertia=3e-8)
LENGTH, RADIUS = 0.13, 7.5e-3
LEG = Straight(length=LENGTH)
U = Centreline(pieces=(LEG, Arc(radius=RADIUS, angle=math.pi), LEG), start=(0.0, -RADIUS))
MIDDLE = LENGTH + 0.5 * math.pi * RADIUS


def without_warping(section: SpatialSection) -> SpatialSection:
    return replace(section, warping_stiffness=0.0)


def spring(line: Centreline, section: SpatialSection, end: str, tip: Tip, tip_at: float, **others):
    """Clamped where it begins if it ends free, else supported alike at both ends."""
    supports, sections = ("clamped" if end == "free" else end, end), (section,) * len(line.pieces)
    named = dict(centreline=line, sections=sections, supports=supports, tip=tip, tip_at=tip_at)
    return SpatialSpring(**named, **others)


def straight(section: SpatialSection, tip: Tip | None = None, **others) -> SpatialSpring:
    return spring(Centreline(pieces=(LEG,)), section, "free", tip or Tip(), LENGTH, **others)


def bent(section: SpatialSection, tip: Tip = BALL, **others) -> SpatialSpring:
    return spring(U, section, "clamped", tip, MIDDLE, **others)


def out_of_plane(modes: SpatialModes) -> np.ndarray:
    return modes.out_of_plane > 0.5


def turning(modes: SpatialModes) -> np.ndarray:
    """Modes of a straight strip in which the end turns about its axis."""
    edge = 0.5 * STRIP.width * np.abs(modes.rotation[:, 0])
    return edge > np.linalg.norm(modes.displacement, axis=1)


def test_the_plane_family_is_that_of_the_plane_model():
    folded = beam.folded_u(leg_length=LENGTH, bend_radius=RADIUS, section=STRIP, tip=BALL)
    plane = beam.natural_modes(beam.assemble(folded), 8)
    space = spatial_modes(bent(upright(STRIP)), 16)
    inside = ~out_of_plane(space)
    np.testing.assert_allclose(space.frequencies_hz[inside][:8], plane.frequencies_hz, rtol=5e-5)
    np.testing.assert_allclose(space.phi[inside][:8], plane.phi, atol=2e-4)
    np.testing.assert_allclose(space.participation[inside][:8], plane.participation, atol=1e-5)


@pytest.mark.parametrize("inertia", [0.0, 2e-8, 5e-7])
def test_torsion_of_a_strip_with_a_tip_has_the_frequencies_of_the_closed_form(inertia):
    """a tan a = I L/J, omega = (a/L) sqrt(GJ/I); without tip a = pi/2, 3 pi/2, ..."""
    section = without_warping(upright(STRIP))
    speed = math.sqrt(section.torsional_stiffness / section.polar_inertia)
    share = inertia / (section.polar_inertia * LENGTH)

    def equation(a: float) -> float:
        return share * a * math.sin(a) - math.cos(a)

    roots = [brentq(equation, n * math.pi, (n + 0.75) * math.pi) for n in range(3)]
    modes = spatial_modes(straight(section, Tip(rotary_inertia=inertia)), 25)
    found = modes.omega[turning(modes)][:3]
    np.testing.assert_allclose(found, np.array(roots) * speed / LENGTH, rtol=1e-6)


def test_torsion_with_warping_held_at_the_clamp_solves_vlasovs_equation():
    """EG s^4 - GJ s^2 - I omega^2 = 0: cos, sin of a x and exp of +-b x; no torque and no bimoment at L."""
    section = upright(STRIP)
    gj, eg, inertia = section.torsional_stiffness, section.warping_stiffness, section.polar_inertia

    def determinant(omega: float) -> float:
        root = math.sqrt(gj**2 + 4.0 * eg * inertia * omega**2)
        a, b = math.sqrt((root - gj) / (2.0 * eg)), math.sqrt((root + gj) / (2.0 * eg))
        c, s, decay = math.cos(a * LENGTH), math.sin(a * LENGTH), math.exp(-b * LENGTH)
        ta, tb = gj * a + eg * a**3, gj * b - eg * b**3
        # cos, sin, exp(-b x), exp(b (x - L)): phi and phi' at 0, phi'' and the torque at L
        rows = np.array(
            [
                [1.0, 0.0, 1.0, decay],
                [0.0, a, -b, b * decay],
                [-a * a * c, -a * a * s, b * b * decay, b * b],
                [-ta * s, ta * c, -tb * decay, tb],
            ]
        )
        return float(np.linalg.det(rows / np.abs(rows).max(axis=1, keepdims=True)))

    modes = spatial_modes(straight(section), 25)
    found = modes.omega[turning(modes)][:3]
    exact = [brentq(determinant, 0.97 * omega, 1.03 * omega) for omega in found]
    np.testing.assert_allclose(found, exact, rtol=3e-6)
    loose = spatial_modes(straight(without_warping(section)), 25)
    # the clamp takes about sqrt(EG/GJ) of the length away
    shortened = LENGTH / (LENGTH - math.sqrt(eg / gj))
    assert found[0] / loose.omega[turning(loose)][0] == pytest.approx(shortened, rel=1e-3)


def test_sideways_bending_of_a_straight_strip_is_that_of_the_frequency_equation():
    section, tip = upright(STRIP), Tip(mass=4e-3, rotary_inertia=2e-7)
    body = dict(tip_mass=tip.mass, tip_rotary_inertia=tip.rotary_inertia)
    strip = dict(bending_stiffness=section.out_of_plane_stiffness, mass_per_length=section.mass_per_length)
    uniform = beam.UniformBeam(length=LENGTH, **strip, **body)
    modes = spatial_modes(straight(section, tip, drive=(0.0, 0.0, 1.0)), 30)
    moves, exact = modes.phi > 1e-6, beam.exact_modes(uniform, 3)
    np.testing.assert_allclose(modes.omega[moves][:3], exact.omega, rtol=1e-6)
    np.testing.assert_allclose(modes.phi[moves][:3], exact.phi, rtol=1e-5)
    np.testing.assert_allclose(np.abs(modes.participation[moves][:3]), np.abs(exact.participation), rtol=1e-5)


@pytest.mark.parametrize("turn", [math.pi, 0.5 * math.pi])
@pytest.mark.parametrize("warping", [True, False])
def test_ring_segment_between_guides_out_of_its_plane(turn, warping):
    """v = A cos(n a), phi = B cos(n a): a 2 x 2 problem for each n, tau = -(n/R)(B + A/R) sin(n a)."""
    radius = 0.05
    section = upright(STRIP) if warping else without_warping(upright(STRIP))
    line = Centreline(pieces=(Arc(radius=radius, angle=turn),))
    mass = np.diag([section.mass_per_length, section.polar_inertia])
    expected = []
    for n in np.pi / turn * np.arange(8):
        bow = np.array([-((n / radius) ** 2), -1.0 / radius])
        twist = n / radius * np.array([1.0 / radius, 1.0])
        rigidity = section.torsional_stiffness + section.warping_stiffness * (n / radius) ** 2
        k = section.out_of_plane_stiffness * np.outer(bow, bow) + rigidity * np.outer(twist, twist)
        expected += list(np.linalg.eigvals(np.linalg.solve(mass, k)).real)
    modes = spatial_modes(spring(line, section, "guided", Tip(), 0.0), 24, round(80 * turn / math.pi))
    found = modes.omega[out_of_plane(modes) & (modes.omega > 10.0)] ** 2
    expected = np.sort([value for value in expected if value > 100.0])
    np.testing.assert_allclose(found[:5], expected[:5], rtol=1.2e-4)


@pytest.mark.parametrize("lying", [False, True])
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.0, 0.0, 2e-3), (1e-3, -2e-3, 1e-3)])
def test_the_u_in_space_against_many_straight_elements(lying, offset):
    section = without_warping((flat if lying else upright)(STRIP))
    points = polygon(RADIUS, 40, 160)
    frame = frame_frequencies(points, section, BALL, 10, offset)
    modes = spatial_modes(bent(section, tip_offset=offset), 10, [40, 96, 40])
    np.testing.assert_allclose(modes.frequencies_hz, frame, rtol=4e-4)


def test_a_ball_on_the_plane_of_symmetry_sees_one_family_and_off_it_both():
    on, off = (spatial_modes(bent(upright(STRIP), tip_offset=(0.0, 0.0, z)), 12) for z in (0.0, 5e-4))
    apart = out_of_plane(on)
    assert apart.sum() >= 2 and np.abs(on.phi[apart]).max() < 1e-4 * on.phi[0]
    assert np.abs(on.participation[apart]).max() < 1e-4 * abs(on.participation[0])
    assert np.abs(off.phi[apart]).max() > 1e-3 * on.phi[0]
    assert off.frequencies_hz[0] == pytest.approx(on.frequencies_hz[0], rel=1e-4)


def test_a_light_ball_off_the_line_sees_the_turn_times_its_distance():
    off = spatial_modes(straight(upright(STRIP), Tip(mass=1e-9), tip_offset=(0.0, 0.0, 5e-4)), 10)
    twist = int(np.flatnonzero(turning(off))[0])
    assert off.phi[twist] == pytest.approx(5e-4 * abs(off.rotation[twist, 0]), rel=1e-5)


def test_shapes_are_those_of_the_section_at_the_tip_and_mass_normalised():
    modes = spatial_modes(bent(upright(STRIP), Tip()), 12)
    s, points, displacement, rotation = modes.along(4)
    place = int(np.argmin(np.abs(s - MIDDLE)))
    np.testing.assert_allclose(displacement[:, place], modes.displacement, atol=1e-9)
    np.testing.assert_allclose(rotation[:, place], modes.rotation, atol=1e-6)
    assert points.shape == (s.size, 3) and s[0] == 0.0 and s[-1] == pytest.approx(U.length)
    section, t = modes.spring.sections[0], U.frame(s)[0]
    turn = np.einsum("kpi,pi->kp", rotation, t)
    energy = section.mass_per_length * np.sum(displacement**2, axis=2) + section.polar_inertia * turn**2
    np.testing.assert_allclose(np.trapezoid(energy, s, axis=1), 1.0, rtol=2e-3)


def test_a_channel_without_flanges_is_the_strip_but_for_its_edges():
    section = channel(material=BRASS, width=12e-3, flange=0.0, thickness=0.65e-3)
    strip, edges = upright(STRIP), 1.0 - 0.63 * 0.65 / 12.0
    for name, number in vars(strip).items():
        digits, part = (1e-4, edges) if name == "torsional_stiffness" else (1e-12, 1.0)
        assert number == pytest.approx(part * getattr(section, name), rel=digits), name


def test_second_moments_of_a_channel_by_adding_up_little_squares():
    b, h, t = 12e-3, 2e-3, 0.4e-3
    section, step = channel(material=BRASS, width=b, flange=h, thickness=t), 0.5 * t / 8
    y, z = np.meshgrid(np.arange(0.5 * step, h + t, step), np.arange(0.5 * step, b, step) - 0.5 * b)
    inside = (y < t) | (np.abs(z) > 0.5 * b - t)
    y, z, area = y[inside], z[inside], step**2
    centroid, p = y.mean(), h + 0.5 * t
    behind = 3.0 * p**2 / (6.0 * p + b - t)  # the shear centre, behind the midline of the web
    assert section.shear_offset - behind == pytest.approx(centroid - 0.5 * t, rel=1e-9)
    e = BRASS.youngs_modulus
    stiffness = [e * area * (np.sum(arm**2) + y.size * step**2 / 12.0) for arm in (y - centroid, z)]
    assert [section.in_plane_stiffness, section.out_of_plane_stiffness] == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.parametrize(
    ("field", "make"),
    [
        ("tip_at", lambda u: replace(u, tip_at=1.0)),
        ("drive", lambda u: replace(u, drive=(0.0, 0.0, 0.0))),
        ("tip_offset", lambda u: replace(u, tip_offset=(0.0, math.nan, 0.0))),
        ("sections", lambda u: replace(u, sections=())),
        ("torsional_stiffness", lambda u: replace(u.sections[0], torsional_stiffness=-1.0)),
        ("shear_offset", lambda u: bent(replace(u.sections[0], shear_offset=1e-3))),
        ("thickness", lambda u: channel(material=BRASS, width=1e-3, flange=0.0, thickness=0.6e-3)),
        ("count", lambda u: spatial_modes(u, 0)),
    ],
)
def test_wrong_springs_are_refused(field, make):
    with pytest.raises(ValueError, match=field):
        make(bent(upright(STRIP)))


@pytest.mark.parametrize("width, mass", [(12e-3, 0.0), (12e-3, 6e-3), (10e-3, 6e-3)])
def test_a_flat_u_bends_as_its_legs_do_in_space(width: float, mass: float) -> None:
    """Half rings twist and bend where the plane model has a plate as wide as the U."""
    leg, tip = replace(STRIP, width=width), Tip(mass=mass)
    flat_u = beam.flat_u(leg_length=LENGTH, bend_radius=RADIUS, section=leg, tip=tip)
    plane = beam.natural_modes(beam.assemble(flat_u), 3)
    modes = spatial_modes(bent(flat(leg), tip, drive=(0.0, 0.0, 1.0)), 12)
    moving = np.flatnonzero(np.abs(modes.phi) > 0.1)[:3]
    assert np.all(np.abs(plane.frequencies_hz / modes.frequencies_hz[moving] - 1.0) < [1.5e-3, 4e-3, 5e-3])
    assert np.all(np.abs(plane.phi / np.abs(modes.phi[moving]) - 1.0) < [2e-3, 0.012, 0.03])


def test_two_legs_are_a_strip_each_in_space() -> None:
    slotted = replace(STRIP, slot=3e-3)
    for section in (flat, upright):
        with pytest.raises(ValueError, match="slot"):
            section(slotted)
    half = replace(STRIP, width=0.5 * STRIP.width)
    assert slotted.torsional_stiffness == pytest.approx(2.0 * half.torsional_stiffness, rel=1e-12)
    assert slotted.bending_stiffness == STRIP.bending_stiffness
