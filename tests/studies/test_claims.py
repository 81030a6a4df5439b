"""The letter's other claims: closed forms against simulation and shooting, windows against exponents."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact import NordmarkMap, StroboscopicMap, maximal_orbits, maximal_period
from contact.orbits import Shooting, settle
from studies.experiment.claims.bands import inside_band
from studies.experiment.claims.energy_loss import (
    RESTITUTIONS,
    end_speed,
    falls,
    family_at,
    line_of,
    lives,
    node_at,
    trends,
)
from studies.experiment.claims.overdamped import exponents, outside_windows
from studies.experiment.claims.universality import Job, born_at, springs
from studies.shell.scene import band_of, nordmark_at, single_mode_at


def with_tau(scene, restitution):
    return scene.replace({"single_mode.restitution": restitution})


def strobed_at(scene, frequency, restitution):
    return StroboscopicMap(oscillator=single_mode_at(with_tau(scene, restitution), frequency))


def followed(strobed, values):
    """The motion carried from excess to excess; period and impacts at the last."""
    state = strobed.at(float(values[0])).steady()
    for excess in values:
        found = settle(strobed.at(float(excess)), state, most_cycles=6000)
        state = found.end
    return found.period, found.impacts


@pytest.mark.parametrize(("frequency", "tau", "m"), [(20.90, 0.3, 3), (21.50, 0.0, 4), (22.20, 0.4, 5)])
def test_the_node_keeps_one_impact_up_to_its_secondary_bifurcation(letter_scene, frequency, tau, m):
    found = node_at(with_tau(letter_scene, tau), frequency)
    assert found.period == m and found.admissible and found.secondary > 1e-3
    strobed = strobed_at(letter_scene, frequency, tau)
    below = np.linspace(5e-4, found.secondary * 0.99, 25)
    assert followed(strobed, below) == (m, 1)
    assert followed(strobed, [*below, found.secondary * 1.01]) != (m, 1)


@pytest.mark.parametrize(("frequency", "tau", "m"), [(21.50, 0.3, 4), (20.90, 0.5, 3)])
def test_the_second_impact_is_where_shooting_finds_it(letter_scene, frequency, tau, m):
    """The orbit of the closed form and that of shooting lose their single impact at the same speed."""
    family = family_at(with_tau(letter_scene, tau), frequency, m)
    speed, shooting = end_speed(family, family.fold()), Shooting(oscillator=family.oscillator, period=m)
    inside, outside = (shooting.at_speed(part * speed) for part in (0.999, 1.001))
    assert lives(inside) and outside.stable and not outside.admissible


def test_a_secondary_bifurcation_below_grazing_lets_another_state_be_born(letter_scene):
    """21.50 Hz: below grazing at tau = 0.3, above at 0.1; the born motion is p4 with one impact only then."""
    low, high = (node_at(with_tau(letter_scene, tau), 21.50).secondary for tau in (0.1, 0.3))
    assert low > 0.0 > high
    born = [followed(strobed_at(letter_scene, 21.50, tau), [-1e-3, 1e-3]) for tau in (0.1, 0.3)]
    assert born[0] == (4, 1) and born[1] != (4, 1)


def test_hysteresis_falls_with_the_energy_lost_and_rho_of_the_map_does_not(letter_scene):
    drives = letter_scene.drive.frequencies_hz
    rows = [node for tau in RESTITUTIONS for node in line_of(letter_scene, drives, tau)]
    assert trends(rows) == {"map": True, "eq1": True, "rho": False}
    assert all(row.fold < row.fold_of_map < 0.0 for row in rows)  # the map is too small throughout


def test_secondary_bifurcations_of_the_map_come_above_grazing(letter_scene):
    rows = [node for tau in RESTITUTIONS for node in line_of(letter_scene, (20.90, 22.60, 23.40), tau)]
    assert min(row.secondary_of_map for row in rows) > 0.0 > np.nanmin([row.secondary for row in rows])


def test_the_hysteresis_starts_from_zero_at_the_upper_edge_of_each_band(letter_scene):
    for m in range(3, 9):
        edges, rows = band_of(letter_scene, m), inside_band(letter_scene, m, 13)
        assert edges.upper == pytest.approx(2 * m / ((2 * m + 1) * 40.80e-3), rel=1e-12)
        assert band_of(letter_scene, m + 1).lower < edges.upper  # neighbours overlap
        assert max(rows[-1].map, rows[-1].eq1) < 1e-12
        assert falls([row.map for row in rows]) and falls([row.eq1 for row in rows])
    path = [nordmark_at(letter_scene, f) for f in np.linspace(19.6, 23.8, 60)]
    assert {3, 4, 5, 6, 8, 11} <= {maximal_period(place) for place in path}


@pytest.mark.parametrize("position", [0.85, 0.905])
def test_eq_1_has_the_period_of_the_map_near_the_upper_edge_of_a_band(letter_scene, position):
    eq1 = springs(letter_scene.replace({"modes.count": 1}))[0]
    place = nordmark_at(letter_scene, position / letter_scene.single_mode.free_period_s)
    assert eq1[2].n_modes == 1 and born_at(Job(*eq1, position, 1e-4)) == maximal_period(place)


def overdamped_map(alpha):
    """Real eigenvalues alpha and 0 of the motion without impact, tau = 0."""
    return NordmarkMap(alpha=alpha, gamma=0.0, restitution=0.0, whole_turns=0)


def window(nordmark, period):
    """The rho between which p_m is stable and without a second impact; None if there are none."""
    size, ends = nordmark.alpha ** (2 * period - 2), []
    for unstable in (True, False):  # along rho p_m becomes stable once, and meets its second impact once
        low, high = math.log(1e-4), math.log(1e6)
        for _ in range(60):
            middle = 0.5 * (low + high)
            orbits = maximal_orbits(nordmark, period, size * math.exp(middle))
            before = not any(o.stable for o in orbits) if unstable else any(o.admissible for o in orbits)
            low, high = (middle, high) if before else (low, middle)
        ends.append(size * math.exp(middle))
    return tuple(ends) if ends[0] < ends[1] else None


@pytest.mark.parametrize("alpha", [0.2, 0.45, 0.6])
def test_windows_of_the_overdamped_map_have_their_limits(alpha):
    m = 14
    low, high = window(overdamped_map(alpha), m)
    size = alpha ** (2 * m - 2)
    # z = 1/2 and z = (1 - l)/l; what is neglected is of the order alpha^m
    assert low / size == pytest.approx(0.75 * (1.0 - alpha), rel=20 * alpha**m + 1e-12)
    assert high / size == pytest.approx(((1.0 - alpha) / alpha) ** 2, rel=20 * alpha**m + 1e-12)
    gap = math.log(low / window(overdamped_map(alpha), m + 1)[1]) / (2.0 * math.log(1.0 / alpha))
    assert outside_windows(alpha) == pytest.approx(max(gap, 0.0), abs=20 * alpha**m + 1e-12)


def test_between_the_windows_there_is_chaos_and_above_two_thirds_nothing_else():
    assert window(overdamped_map(0.70), 14) is None
    alpha, m = 0.45, 8
    low, top = window(overdamped_map(alpha), m)
    high = window(overdamped_map(alpha), m + 1)[1]
    assert high < low  # a gap
    inside = np.geomspace(high * 1.02, low * 0.98, 40)
    assert np.mean(exponents(alpha, inside, 1000, 2000)[0] > 0.0) > 0.9
    found, x = exponents(alpha, np.geomspace(low * 1.02, top * 0.98, 40), 1000, 2000)
    assert np.all(found < 0.0)
    middle = slice(5, -5)  # at the very edge the motion takes its time
    assert np.all(np.abs(x[-1] - x[-1 - m])[middle] < 1e-12)  # and it is p_m
    assert np.all(np.abs(x[-1] - x[-m])[middle] > 1e-9)
    everywhere = np.geomspace(1e-6, 1e-5, 60)
    assert np.all(exponents(0.8, everywhere, 1000, 2000)[0] > 0.0)
    assert np.all(exponents(0.2, everywhere, 1000, 2000)[0] < 0.0)


def test_the_exponent_of_the_map_is_the_multiplier_of_p_m():
    alpha, m = 0.45, 8
    rho = math.sqrt(math.prod(window(overdamped_map(alpha), m)))
    (node,) = (o for o in maximal_orbits(overdamped_map(alpha), m, rho) if o.stable and o.admissible)
    found, _x = exponents(alpha, np.array([rho]), 2000, 50 * m)
    assert found[0] == pytest.approx(math.log(abs(node.multipliers[0])) / m, rel=1e-6)
