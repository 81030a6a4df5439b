"""Enough model and not more: the choice meets its tolerance, and nothing one step smaller does."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from studies.adequacy import main, questions
from studies.instruments.adequacy import memory
from studies.instruments.adequacy.asked import QUANTITIES, Asked
from studies.instruments.adequacy.fitted_scene import Need, fitted
from studies.instruments.adequacy.memory import DELIVERED, as_record, key_of, remembered
from studies.instruments.adequacy.model_choice import ModelChoice, rungs_of
from studies.instruments.adequacy.needed import Search, needed
from studies.instruments.adequacy.rows import measured_row
from studies.instruments.scene import Scene
from studies.instruments.scene_file import read_scene

NEEDS = (
    Need(quantity="born_period", tolerance=0.0, everywhere=True),
    Need(quantity="fold", tolerance=0.07, everywhere=True),
)

LETTER = read_scene()
#: Of the heavy ball and of the soft contact.
pytestmark = pytest.mark.filterwarnings(
    "ignore:mass of the tip:beam.SuspiciousValue", "ignore:(youngs|other)_modulus:beam.SuspiciousValue"
)

SCENES = {
    "letter": (LETTER, 22.2),
    "bare tip": (LETTER.replace({"tip.mass_kg": 0.0}), 22.2),
    "heavy ball": (LETTER.replace({"tip.mass_kg": 0.03}), 14.0),
    "soft contact": (
        LETTER.replace({"tip.ball_young_modulus_pa": 1e6, "tip.plate_young_modulus_pa": 1e6}), 22.2,
    ),
    "fast drive": (LETTER.replace({"drive.frequencies_hz": (140.0,)}), 140.0),
}  # fmt: skip


def check(scene: Scene, quantity: str, frequency: float) -> dict[str, object]:
    """Choose and compare with four times the model and with every smaller one."""
    tolerance = QUANTITIES[quantity.partition(" ")[0]][3]
    row, found, _tried = measured_row(
        scene, Asked(quantity=quantity, frequency=frequency), tolerance, repeats=1
    )
    assert found.reached
    assert row["error_measured"] <= tolerance
    less = row["error_one_less"]
    if row["one_less"] is None:
        assert found.choice.rung == "single_mode"  # the coarsest there is
    else:
        assert row["no_answer_with_one_less"] or less > tolerance
    assert row["error_estimate"] == pytest.approx(row["error_measured"], rel=0.1, abs=0.1 * tolerance)
    return row


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("quantity", ["frequency 3", "kick"])
def test_enough_and_not_more(name: str, quantity: str) -> None:
    check(SCENES[name][0], quantity, SCENES[name][1])


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("quantity", ["restitution", "delay"])
def test_enough_and_not_more_for_the_whole_collision(name: str, quantity: str) -> None:
    check(SCENES[name][0], quantity, SCENES[name][1])


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [20.9, 21.5, 22.2])
def test_enough_and_not_more_for_the_fold(frequency: float) -> None:
    row = check(LETTER, "fold", frequency)
    assert row["chosen"]["law"] == "hertz" and row["chosen"]["modes"] >= 12  # type: ignore[index]


def test_the_scenes_need_different_models() -> None:
    """A soft contact leaves the higher modes alone, a stiff one does not."""
    chosen = {}
    for name in ("letter", "soft contact"):
        scene, frequency = SCENES[name]
        chosen[name] = needed(scene, Asked(quantity="kick", frequency=frequency), 1e-2).choice
    assert chosen["soft contact"].modes == 1 < 8 <= chosen["letter"].modes
    assert chosen["soft contact"].cost() < 0.7 * chosen["letter"].cost()


def test_born_period_needs_one_mode_where_the_letter_agrees() -> None:
    """An integer is right or wrong: equal at the drive frequency and at both ends of the error of T."""
    found = needed(LETTER, Asked(quantity="born_period", frequency=21.5), 0.0)
    assert found.reached and found.error == 0.0 and found.choice.rung == "single_mode"


def test_where_nothing_is_enough_it_says_what_remains() -> None:
    found = needed(LETTER, Asked(quantity="kick", frequency=22.2), 1e-9)
    assert not found.reached and found.choice == Search(LETTER, found.asked).sharp
    assert found.error > 1e-9 and "no model gives kick" in found.sentence()
    assert max(found.sources, key=lambda name: found.sources[name]) in found.sentence()


def test_parts_of_the_error_explain_it() -> None:
    """The whole is at most the sum of the parts, up to what they do to one another."""
    search = Search(LETTER, Asked(quantity="kick", frequency=22.2))
    choice = ModelChoice(rung="straight", law="linear", modes=10, mesh=6)
    parts = search.sources(choice)
    assert set(parts) == {"rung", "law", "modes", "mesh", "reference"}
    assert search.off(choice) <= 1.3 * sum(parts.values())
    assert search.error(choice) >= max(parts["rung"], parts["law"], parts["modes"], parts["mesh"])


def test_errors_that_cancel_get_no_credit() -> None:
    """One mode and a residual one with a linear contact come within 0.01 of the restitution, by luck."""
    search = Search(LETTER, Asked(quantity="restitution", frequency=22.2))
    choice = ModelChoice(rung="straight", law="hertz", modes=1, mesh=2, residual=True)
    assert search.off(choice) < 1e-2 < search.error(choice)


def test_a_question_is_checked() -> None:
    for wrong in ("frequency", "frequency 0", "kick 2", "colour"):
        with pytest.raises(ValueError, match="quantity is"):
            Asked(quantity=wrong, frequency=22.2)
    with pytest.raises(ValueError, match="frequency is nan Hz"):
        Asked(quantity="kick", frequency=math.nan)
    with pytest.raises(ValueError, match="tolerance is -1"):
        needed(LETTER, Asked(quantity="kick", frequency=22.2), -1.0)


def test_a_model_without_an_answer_is_infinitely_far_off() -> None:
    asked = Asked(quantity="fold", frequency=22.2)
    assert asked.error(None, np.array([5.0, -1e-3])) == math.inf
    assert asked.error(np.array([4.0, -1e-3]), np.array([5.0, -1e-3])) == math.inf
    assert asked.error(np.array([8.0, math.nan]), np.array([8.0, math.nan])) == 0.0
    assert asked.error(np.array([5.0, -1e-4]), np.array([5.0, -2e-4])) == pytest.approx(0.4)  # of 2.5e-4


# -------------------------------------------------------------------------------------------- used by studies


def test_the_delivered_choices_are_those_that_are_found() -> None:
    """All questions of the main job are answered from the file, and two of them are found anew."""
    known = json.loads(DELIVERED.read_text())
    rungs, laws = rungs_of(LETTER)[-1:], (LETTER.contact.law,)
    keys = {
        (need.tolerance, asked): key_of(LETTER, asked, need.tolerance, rungs, laws, False)
        for need in NEEDS
        for asked in need.asked(LETTER)
    }
    assert len(keys) == 12 and set(keys.values()) <= set(known)
    for quantity, frequency, tolerance in (("born_period", 21.5, 0.0), ("fold", 21.5, 0.07)):
        asked = Asked(quantity=quantity, frequency=frequency)
        search = Search(LETTER, asked, law=laws[-1])
        found = needed(LETTER, asked, tolerance, rungs=rungs, laws=laws, residual=False, search=search)
        record = known[keys[tolerance, asked]]
        assert as_record(found)["choice"] == record["choice"]
        assert found.error == pytest.approx(record["error"], rel=0.05, abs=1e-4)


def test_a_choice_is_kept_with_its_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    asked = Asked(quantity="frequency 2", frequency=22.2)
    told: list[str] = []
    first = remembered(LETTER, asked, 1e-3, tell=told.append)
    assert len(told) == 1 and (tmp_path / "grazing-spring" / "choices.json").exists()
    assert remembered(LETTER, asked, 1e-3, tell=told.append) == first and len(told) == 1
    other = LETTER.replace({"tip.mass_kg": 0.007})
    remembered(other, asked, 1e-3, tell=told.append)
    assert len(told) == 2  # another scene is another question
    unrelated = LETTER.replace({"scan.points": 7})
    remembered(unrelated, asked, 1e-3, tell=told.append)
    assert len(told) == 2
    (tmp_path / "grazing-spring" / "choices.json").write_text("{ torn")
    assert remembered(LETTER, asked, 1e-3, tell=told.append) == first and len(told) == 3


def test_a_folder_that_cannot_be_written_to_is_no_reason_to_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "_own", lambda: Path("/proc/nowhere/choices.json"))
    assert remembered(LETTER, Asked(quantity="frequency 2", frequency=22.2), 1e-3).reached


def test_studies_get_the_modes_and_the_mesh_that_they_need() -> None:
    scene, sentence = fitted(LETTER, NEEDS, pytest.fail)  # nothing is left to be found
    assert scene.modes.count == 12 < LETTER.kept_modes
    assert "fold" in sentence and scene.provenance()["modes.count"] == "needed"
    assert sentence.startswith("model: folded U, 60 elements a leg, 12 modes")
    given, sentence = fitted(LETTER.replace({"modes.count": 9}), NEEDS, pytest.fail)
    assert given.modes.count == 9 and sentence == ""
    meshed, sentence = fitted(LETTER.replace({"spring.elements_per_leg": 33}), NEEDS, pytest.fail)
    assert sentence.startswith("model: folded U, 33 elements a leg, 12 modes")
    assert meshed.spring.elements_per_leg == 33 and meshed.modes.count == 12
    usual, sentence = fitted(LETTER, [Need(quantity="kick", tolerance=0.005, mesh=False)], pytest.fail)
    assert sentence.startswith("model: folded U, 60 elements a leg, 15 modes")
    assert usual.spring.elements_per_leg == 0 and usual.modes.count == 15


def test_the_study_prints_one_line_a_question(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--quick", "--json", "--out", str(tmp_path), "--set", "drive.frequencies_hz=[21.5]"]
    assert main(arguments) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["schema"] >= 1 and len(summary["rows"]) == len(questions(LETTER, True))
    for row in summary["rows"]:
        assert row["error_measured"] <= row["tolerance"] and row["chosen"]["rung"] in rungs_of(LETTER)
        assert row["cost_ratio"] > 0
    assert (tmp_path / "adequacy" / "ladder.png").exists() and (tmp_path / "adequacy" / "ladder.csv").exists()
    assert main(["--out", str(tmp_path), "--set", "drive.kind=none"]) == 2
