"""The letter's other claims: closed forms against simulation, and what each claim says."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from contact.maximal_orbits import maximal_orbits
from contact.orbits.settling import settle
from contact.orbits.shooting import Shooting
from contact.stroboscope import StroboscopicMap
from studies import claims
from studies.instruments.claims.bands import bands_claim
from studies.instruments.claims.hysteresis_and_loss import hysteresis_claim
from studies.instruments.claims.overdamped_map import exponents, overdamped, window
from studies.instruments.claims.second_impact import secondary_claim
from studies.instruments.claims.secondary_bifurcation import flip_speed, second_impact_speed, secondary
from studies.instruments.claims.single_mode_leaf import Leaf
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene_file import read_scene


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter", [])


@pytest.fixture(scope="module")
def leaf(scene):
    return Leaf.of(scene)


def strobed_at(scene, frequency, restitution):
    changed = scene.replace({"single_mode.restitution": restitution})
    return StroboscopicMap(oscillator=single_mode_oscillator(changed, frequency))


def followed(strobed, values):
    """The motion carried from excess to excess; period and impacts at the last."""
    state = strobed.at(float(values[0])).steady()
    for excess in values:
        found = settle(strobed.at(float(excess)), state, most_cycles=6000)
        state = found.end
    return found.period, found.impacts


@pytest.mark.parametrize(
    ("frequency", "restitution", "m"), [(20.90, 0.3, 3), (21.50, 0.0, 4), (22.20, 0.4, 5)]
)
def test_the_node_keeps_one_impact_up_to_its_secondary_bifurcation(scene, leaf, frequency, restitution, m):
    found = secondary(leaf.family(frequency, restitution, m))
    assert found.admissible and found.excess > 1e-3
    strobed = strobed_at(scene, frequency, restitution)
    below = np.linspace(5e-4, found.excess * 0.99, 25)
    assert followed(strobed, below) == (m, 1)
    assert followed(strobed, [*below, found.excess * 1.01]) != (m, 1)


def test_second_impact_and_flip_are_where_shooting_finds_them(scene, leaf):
    """At tau = 0.3 a second impact at 21.50 Hz; the certified flights of shooting agree on the speed."""
    gap = scene.stop.gap_m
    for frequency, restitution, m in ((21.50, 0.3, 4), (20.90, 0.5, 3)):
        family = leaf.family(frequency, restitution, m)
        speed = second_impact_speed(family)
        shooting = Shooting(oscillator=strobed_at(scene, frequency, restitution).oscillator, period=m)
        inside, outside = (shooting.at_speed(part * speed * gap) for part in (0.999, 1.001))
        assert inside.admissible and not outside.admissible
        flip = flip_speed(family)
        if math.isfinite(flip):
            trace = np.trace(family.orbit(flip).monodromy())
            assert trace == pytest.approx(-1.0 - np.linalg.det(family.orbit(flip).monodromy()), abs=1e-9)


def test_a_secondary_bifurcation_below_grazing_lets_another_state_be_born(scene, leaf):
    """21.50 Hz: below grazing at tau = 0.3, above at 0.1; the born motion is p4 with one impact only then."""
    low, high = (secondary(leaf.family(21.50, tau, 4)).excess for tau in (0.1, 0.3))
    assert low > 0.0 > high
    born = [followed(strobed_at(scene, 21.50, tau), [-1e-3, 1e-3]) for tau in (0.1, 0.3)]
    assert born[0] == (4, 1) and born[1] != (4, 1)


def test_hysteresis_falls_with_the_energy_lost(scene):
    found = hysteresis_claim(scene)
    assert found.holds is True
    for f in scene.drive.frequencies_hz:
        entry = found.numbers[f"{f:g} Hz"]
        assert abs(entry["map"][0]) < abs(entry["map"][1])
        assert abs(entry["eq1"][0]) < abs(entry["eq1"][1])
        assert abs(entry["map"][0]) < abs(entry["eq1"][0])  # the map is too small throughout
    at = {
        (f, tau): (a, b)
        for f, tau, a, b in zip(
            *(found.table[n] for n in ("frequency_hz", "restitution", "map", "eq1")), strict=True
        )
    }
    assert at[20.90, 0.1] == pytest.approx((-6.272937252e-4, -1.2784409283e-3), rel=1e-8)
    assert at[23.05, 0.1] == pytest.approx((-7.691764860e-5, -1.2823017008e-4), rel=1e-8)


def test_secondary_bifurcations_come_above_grazing_in_the_map_only(scene):
    found = secondary_claim(scene, quick=True)
    assert found.holds is True
    assert found.numbers["map_lowest_excess"] > 0.0
    parts = list(found.numbers["part_of_band_below_grazing"].values())
    assert 0.2 < parts[0] < parts[-1] < 1.0


def test_the_path_crosses_the_bands_and_the_hysteresis_starts_from_zero(scene):
    found = bands_claim(scene, quick=True)
    assert found.holds is True
    assert {3, 4, 5, 6, 8, 11} <= set(found.numbers["crossed"])
    assert found.numbers["largest_at_upper_edge"] < 1e-12
    edges = found.numbers["bands"]
    for m in range(3, 11):
        assert edges[f"p{m}"]["upper_hz"] == pytest.approx(2 * m / ((2 * m + 1) * 40.80e-3), rel=1e-12)
        assert edges[f"p{m + 1}"]["lower_hz"] < edges[f"p{m}"]["upper_hz"]  # neighbours overlap


@pytest.mark.parametrize("alpha", [0.2, 0.45, 0.6])
def test_windows_of_the_overdamped_map_have_their_limits(alpha):
    m = 14
    low, high = window(overdamped(alpha), m)
    size = alpha ** (2 * m - 2)
    # z = 1/2 and z = (1 - l)/l; what is neglected is of the order alpha^m
    assert low / size == pytest.approx(0.75 * (1.0 - alpha), rel=20 * alpha**m + 1e-12)
    assert high / size == pytest.approx(((1.0 - alpha) / alpha) ** 2, rel=20 * alpha**m + 1e-12)
    assert not maximal_orbits(overdamped(alpha), m, high * 1.01)[0].admissible
    assert not maximal_orbits(overdamped(alpha), m, low * 0.99)[0].stable


def test_between_the_windows_there_is_chaos_and_above_two_thirds_nothing_else():
    assert window(overdamped(0.70), 14) is None
    alpha, m = 0.45, 8
    low, high = window(overdamped(alpha), m)[0], window(overdamped(alpha), m + 1)[1]
    assert high < low  # a gap
    inside = np.geomspace(high * 1.02, low * 0.98, 40)
    assert np.mean(exponents(alpha, 0.0, inside, 1000, 2000)[0] > 0.0) > 0.9
    across = np.geomspace(low * 1.02, window(overdamped(alpha), m)[1] * 0.98, 40)
    found, x = exponents(alpha, 0.0, across, 1000, 2000)
    assert np.all(found < 0.0)
    middle = slice(5, -5)  # at the very edge the motion takes its time
    assert np.all(np.abs(x[-1] - x[-1 - m])[middle] < 1e-12)  # and it is p_m
    assert np.all(np.abs(x[-1] - x[-m])[middle] > 1e-9)
    everywhere = np.geomspace(1e-6, 1e-5, 60)
    assert np.all(exponents(0.8, 0.0, everywhere, 1000, 2000)[0] > 0.0)
    assert np.all(exponents(0.2, 0.0, everywhere, 1000, 2000)[0] < 0.0)


def test_exponents_of_the_map_sum_to_the_multiplier_of_p_m():
    alpha, m = 0.45, 8
    low, high = window(overdamped(alpha), m)
    rho = math.sqrt(low * high)
    (node,) = (o for o in maximal_orbits(overdamped(alpha), m, rho) if o.stable and o.admissible)
    found, _x = exponents(alpha, 0.0, np.array([rho]), 2000, 50 * m)
    assert found[0] == pytest.approx(math.log(abs(node.multipliers[0])) / m, rel=1e-6)


def test_the_study_answers_every_claim(tmp_path, capsys):
    assert claims.main(["--quick", "--json", "--out", str(tmp_path), "--workers", "2"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert set(summary["claims"]) == set("abcde") and "schema" in summary
    for key, claim in summary["claims"].items():
        assert set(claim) == {"holds", "numbers", "sentence"}
        assert claim["holds"] is True, (key, claim["sentence"])
    springs = {n: e for n, e in summary["claims"]["d"]["numbers"].items() if isinstance(e, dict)}
    assert len(springs) == 7
    for name, entry in springs.items():
        # next to the upper edge all agree, over whole bands not; a bare tip only closer to grazing
        assert entry["agree"] < 0.9, name
        assert entry["agree_by_quarter_of_band"][3] == 1.0 or name.startswith("bare"), name
    for stem in ("a_hysteresis", "b_secondary", "c_bands", "d_universality", "e_overdamped"):
        for ending in ("png", "pdf", "csv"):
            assert (tmp_path / "claims" / f"{stem}.{ending}").exists()
