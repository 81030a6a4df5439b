"""The letter's other claims: closed forms against simulation and shooting."""

import numpy as np
import pytest

from contact import StroboscopicMap, maximal_m
from contact.orbits import settle
from studies.experiment.claims.model import RESTITUTIONS, Job, born_at, line_of, node_at, springs, trends
from studies.shell.scene import nordmark_at, single_mode_at


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
    return found.m, found.impacts


@pytest.mark.parametrize(("frequency", "tau", "m"), [(20.90, 0.3, 3), (21.50, 0.0, 4), (22.20, 0.4, 5)])
def test_the_node_keeps_one_impact_up_to_its_secondary_bifurcation(letter_scene, frequency, tau, m):
    found = node_at(with_tau(letter_scene, tau), frequency)
    assert found.m == m and found.admissible and found.secondary > 1e-3
    strobed = strobed_at(letter_scene, frequency, tau)
    below = np.linspace(5e-4, found.secondary * 0.99, 25)
    assert followed(strobed, below) == (m, 1)
    assert followed(strobed, [*below, found.secondary * 1.01]) != (m, 1)


def test_a_secondary_bifurcation_below_grazing_lets_another_state_be_born(letter_scene):
    """21.50 Hz: below grazing at tau = 0.3, above at 0.1; the born motion is p4 with one impact only then."""
    low, high = (node_at(with_tau(letter_scene, tau), 21.50).secondary for tau in (0.1, 0.3))
    assert low > 0.0 > high
    born = [followed(strobed_at(letter_scene, 21.50, tau), [-1e-3, 1e-3]) for tau in (0.1, 0.3)]
    assert born[0] == (4, 1) and born[1] != (4, 1)


def test_hysteresis_falls_with_the_energy_lost_and_rho_of_the_map_does_not(letter_scene):
    rows = [node for tau in RESTITUTIONS[::3] for node in line_of(letter_scene, (20.90, 22.60, 23.40), tau)]
    assert trends(rows) == {"map": True, "eq1": True, "rho": False}
    assert all(row.fold < row.fold_of_map < 0.0 for row in rows)  # the map is too small throughout
    assert min(row.secondary_of_map for row in rows) > 0.0 > np.nanmin([row.secondary for row in rows])


@pytest.mark.parametrize("position", [0.85, 0.905])
def test_eq_1_has_the_period_of_the_map_near_the_upper_edge_of_a_band(letter_scene, position):
    eq1 = springs(letter_scene.replace({"modes.count": 1}))[0]
    place = nordmark_at(letter_scene, position / letter_scene.single_mode.free_period_s)
    assert eq1[2].n_modes == 1 and born_at(Job(*eq1, position, 1e-4)) == maximal_m(place)
