"""The chain of descriptions from the map to the beam, and what it answers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact import NewtonRestitution
from contact.orbits import KickFamily
from studies.hysteresis.__main__ import accuracy, causes_at, over_all, resolved, with_neighbours
from studies.hysteresis.columns import scanned_end
from studies.hysteresis.descriptions import CAUSES, CHAIN, OneMode, Row, folds_at
from studies.scene import beam_at, model_of, read_scene, single_mode_of


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter")


@pytest.fixture(scope="module")
def fold(scene):
    return folds_at(scene, 21.50, 4, model_of(scene))


def test_the_causes_multiply_to_the_ratio_of_beam_and_map(fold):
    row, _ = fold
    product = math.prod(row.factor(cause) for cause in CAUSES)
    assert product == pytest.approx(row.beam / row.map, rel=1e-12)
    steps = list(CAUSES.values())
    assert [before for before, _ in steps] + [steps[-1][1]] == list(CHAIN)


def test_the_kick_description_knows_its_own_error(fold):
    """What the second collision, entered with the ringing, says is the distance to the exact orbit."""
    row, _ = fold
    true = row.beam - row.all_mode_kick
    assert row.estimated_error_of_kick == pytest.approx(true, rel=0.2)
    assert abs(true) < 1e-2 * abs(row.beam)


def test_with_one_mode_and_newtons_law_the_whole_chain_is_eq_1(scene):
    """Then there is no delay, no velocity dependence and no higher mode: five descriptions are one."""
    plain = scene.replace(
        {"contact.law": "newton", "contact.local_restitution": scene.single_mode.restitution}
    )
    row, orbit = folds_at(plain, 22.20, 5, single_mode_of(scene))
    assert isinstance(orbit.oscillator.stop.law, NewtonRestitution)
    for name in CHAIN[1:]:
        assert row.excess(name) == pytest.approx(-1.4773426733e-3, rel=1e-8), name
    assert row.map == pytest.approx(-8.235686505e-4, abs=1e-12)
    assert row.map_measured_kick == pytest.approx(row.map, rel=1e-9)


def test_mode_1_of_a_kick_is_what_the_kick_family_keeps_of_one_mode(scene):
    """Two routes to the letter's two parameters."""
    oscillator = beam_at(scene, 21.50, model_of(scene))
    kicks = KickFamily(oscillator=oscillator, period=4)
    one = OneMode(kicks=kicks, jump=lambda speed: tuple(kicks.kick(speed).jump[0]))
    mask = np.eye(oscillator.n_modes)[:1].T

    def first_mode(speed):
        kick = kicks.kick(speed)
        return replace(kick, jump=mask * kick.jump)

    exact = replace(kicks, collision=first_mode).fold()
    assert one.fold().excess == pytest.approx(exact.excess, rel=1e-9)


def test_a_downward_scan_of_the_simulated_beam_ends_at_the_fold(fold):
    row, orbit = fold
    assert row.beam_admissible
    assert scanned_end(orbit) == pytest.approx(row.beam, rel=3e-3)


def made(**excess) -> Row:
    """A row with these folds, the others none."""
    none = dict.fromkeys(("map_printed", "map_measured_kick", *CHAIN))
    return Row(
        frequency_hz=22.2, m=5, **{**none, **excess}, estimated_error_of_kick=None, beam_impacts=1,
        beam_admissible=True, beam_speed_m_s=0.1,
    )  # fmt: skip


def test_factors_follow_from_the_rows():
    row = made(map=-2e-3, map_measured_kick=-4e-3, single_mode=-5e-4, all_mode_kick=-1e-3, beam=-1e-3)
    assert accuracy("map", [row]).median == pytest.approx(2.0)
    assert accuracy("single_mode", [row]).worst == pytest.approx(2.0)  # up or down
    printed = accuracy("map_printed", [row])
    assert printed.folds == 0 and math.isnan(printed.median)
    apart = [row, replace(row, map=-8e-3, beam_admissible=False)]
    assert accuracy("map", apart).worst == pytest.approx(8.0)
    assert accuracy("map", apart).worst_admissible == pytest.approx(2.0)
    found = causes_at(row)
    assert found.truncation_of_the_map == pytest.approx(0.25) and found.delay is None
    median, least, greatest = over_all([row, replace(row, single_mode=-2e-3)])
    assert median.truncation_of_the_map == pytest.approx(0.5)
    assert (least.truncation_of_the_map, greatest.truncation_of_the_map) == pytest.approx((0.25, 1.0))
    assert median.delay is None


def test_statistics_are_of_folds_that_the_letter_could_resolve():
    """Next to a band edge hysteresis vanishes, and ratios of it say nothing."""
    row, edge, none = made(map=-1e-3, beam=-1e-3), made(map=-1e-3, beam=-1e-6), made(beam=-1e-2)
    above, missing = made(map=-1e-3, beam=1e-3), made(map=-1e-3)
    assert resolved([row, edge, none, above, missing]) == [row]
    assert above.ratio("map") is None and missing.ratio("map") is None


def test_orbits_coexist_only_where_they_are_real():
    three, four = replace(made(beam=-1e-3), m=3), replace(made(beam=-1e-2), m=4)
    assert [row.coexisting for row in with_neighbours([three, four])] == [(4,), (3,)]
    ghost = replace(four, beam_admissible=False)
    assert [row.coexisting for row in with_neighbours([three, ghost])] == [(), (3,)]
    elsewhere = replace(four, frequency_hz=21.0)
    assert [row.coexisting for row in with_neighbours([three, elsewhere])] == [(), ()]


def test_small_form(run_study):
    ran = run_study("hysteresis", "--quick")
    assert ran.code == 0 and {row["m"] for row in ran.summary["rows"]} >= {3, 4, 5, 6}
    kept = [row for row in ran.summary["rows"] if (row["beam"] or 0.0) < -2.5e-4 and row["map"] is not None]
    off = {row["description"]: row for row in ran.summary["accuracy"]}
    assert off["single_mode"]["folds"] == len(kept) < len(ran.summary["rows"])
    assert off["all_mode_kick"]["worst"] < 1.02 < off["map"]["median"]
    scans = [row for row in ran.summary["rows"] if row["beam_scan"] is not None]
    assert len(scans) == 2
    for row in scans:
        assert row["beam_scan"] == pytest.approx(row["beam"], rel=1e-3)
    assert ran.summary["verdicts"]["hysteresis"]["verdict"] == "in part"


@pytest.mark.parametrize("wrong", [("--set", "drive.kind=none"), ("--step", "0")])
def test_wrong_use_is_refused(run_study, wrong):
    assert run_study("hysteresis", "--quick", *wrong).code == 2
