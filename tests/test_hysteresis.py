"""The chain of descriptions from the map to the beam, and what it answers."""

from __future__ import annotations

import json
import math

import pytest

from contact.laws import NewtonRestitution
from studies import hysteresis
from studies.instruments.hysteresis_causes import CAUSES, CHAIN, folds_at, shares
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import model_of, single_mode_of


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter", [])


@pytest.fixture(scope="module")
def fold(scene):
    return folds_at(scene, 21.50, 4, model_of(scene))


def test_the_causes_multiply_to_the_ratio_of_beam_and_map(fold):
    found = shares(fold)
    assert found.keys() == CAUSES.keys()
    assert sum(found.values()) == pytest.approx(math.log(fold.excess["beam"] / fold.excess["map"]), abs=1e-12)
    steps = list(CAUSES.values())
    assert [a for a, _ in steps] + [steps[-1][1]] == list(CHAIN)


def test_the_kick_description_knows_its_own_error(fold):
    """What the second collision, entered with the ringing, says is the distance to the exact orbit."""
    true = fold.excess["beam"] - fold.excess["all_mode_kick"]
    assert fold.estimated_error == pytest.approx(true, rel=0.2)
    assert abs(true) < 1e-2 * abs(fold.excess["beam"])


def test_with_one_mode_and_newtons_law_the_whole_chain_is_eq_1(scene):
    """Then there is no delay, no velocity dependence and no higher mode: five descriptions are one."""
    plain = scene.replace(
        {"contact.law": "newton", "contact.local_restitution": scene.single_mode.restitution}
    )
    fold = folds_at(plain, 22.20, 5, single_mode_of(scene))
    assert isinstance(fold.orbit.oscillator.stop.law, NewtonRestitution)
    for name in ("measured_kick", "kick_of_velocity", "two_parameters", "all_mode_kick", "beam"):
        assert fold.excess[name] == pytest.approx(-1.4773426733e-3, rel=1e-8), name
    assert fold.excess["map"] == pytest.approx(-8.235686505e-4, abs=1e-12)
    assert fold.excess["map_measured_kick"] == pytest.approx(fold.excess["map"], rel=1e-9)


def test_a_downward_scan_of_the_simulated_beam_ends_at_the_fold(scene, fold):
    end = hysteresis.confirm(scene, fold, model_of(scene))
    assert end == pytest.approx(fold.excess["beam"], rel=3e-3)


def test_the_answers_follow_from_the_rows():
    causes = dict.fromkeys(CAUSES, math.log(2.0))
    rows = [
        {"map": -2e-3, "map_measured_kick": -4e-3, "two_parameters": -1.2e-3, "all_mode_kick": -1e-3,
         "beam": -1e-3,
         "map_printed": None, "single_mode": -1e-3, "measured_kick": -1e-3, "kick_of_velocity": -1e-3,
         "causes": causes}
    ]
    off = hysteresis.factors(rows)
    assert off["map"]["median"] == pytest.approx(2.0)
    assert off["map_measured_kick"]["worst"] == pytest.approx(4.0)
    assert "map_printed" not in off
    assert hysteresis.median_causes(rows)["delay"]["factor"] == pytest.approx(2.0)
    answers = hysteresis.sentences(rows, [])
    assert "1.20" in answers["do energy loss and delay suffice"]


def test_statistics_are_of_folds_that_the_letter_could_resolve():
    """Next to a band edge hysteresis vanishes, and ratios of it say nothing."""
    row = {"map": -1e-3, "beam": -1e-3}
    edge, none = {"map": -1e-3, "beam": -1e-6}, {"map": None, "beam": -1e-2}
    above, missing = {"map": -1e-3, "beam": 1e-3}, {"map": -1e-3, "beam": None}
    assert hysteresis.resolved([row, edge, none, above, missing]) == [row]


def test_json_has_the_promised_keys(tmp_path, capsys):
    code = hysteresis.main(["--json", "--quick", "--out", str(tmp_path)])
    answer = json.loads(capsys.readouterr().out)
    assert code == 0
    wanted = {
        "frequency_hz", "m", "map_printed", "map", "map_measured_kick", "single_mode", "two_parameters",
        "all_mode_kick", "beam", "coexisting",
    }
    assert all(wanted <= row.keys() for row in answer["rows"])
    assert {row["m"] for row in answer["rows"]} >= {3, 4, 5, 6}
    assert answer["answers"] and answer["causes"]
    counted = sum((row["beam"] or 0.0) < -2.5e-4 and row["map"] is not None for row in answer["rows"])
    assert answer["factors"]["single_mode"]["count"] == counted < len(answer["rows"])
    for name in ("hysteresis.png", "hysteresis_ratio.png", "hysteresis_causes.png", "hysteresis.csv"):
        assert (tmp_path / "hysteresis" / name).stat().st_size > 500
