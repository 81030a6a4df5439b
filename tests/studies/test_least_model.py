"""The least number of modes: as good as is asked, no more, and checked against following the orbits."""

from __future__ import annotations

import pytest

from contact import StroboscopicMap
from contact.orbits import Shooting, born_period, fold_of
from studies.physics.least_model import LADDER, least_modes, questions, reference_of
from studies.shell.scene import beam_at, read_scene

#: What a search over modes, meshes and laws that followed every orbit found for the letter's scene.
BY_SEARCH = [
    pytest.param({"born_period": 0.0, "fold": 0.07}, 10, marks=pytest.mark.slow),
    ({"frequency 10": 1e-3}, 10),
    ({"frequency 1": 1e-5, "kick": 0.005}, 12),
]


@pytest.mark.parametrize(("needs", "modes"), BY_SEARCH)
def test_the_choice_is_that_of_the_long_search(letter_scene, needs, modes):
    scene, sentence = least_modes(letter_scene, needs)
    assert scene.modes.count == modes and f" {modes} " in sentence
    assert scene.provenance()["modes.count"] == "least"


@pytest.mark.parametrize("frequency", [21.50, pytest.param(22.20, marks=pytest.mark.slow)])
def test_errors_of_folds_from_kicks_are_those_of_the_orbits_themselves(letter_scene, frequency):
    """Folds by shooting and continuation, an independent route, with 12 and 40 modes."""
    whole, found = reference_of(letter_scene), {}
    for modes in (12, 40):
        oscillator = beam_at(letter_scene, frequency, whole.truncated(modes)).with_excess(1e-3)
        period = born_period(StroboscopicMap(oscillator=oscillator))
        found[modes] = fold_of(Shooting(oscillator=oscillator, period=period)).excess
    error = abs(found[12] / found[40] - 1.0)
    here = letter_scene.replace({"drive.frequencies_hz": (frequency,)})
    (question,) = questions(here, {"fold": 0.0}, whole)
    assert question.off(12) == pytest.approx(error, rel=0.12)


@pytest.mark.slow
def test_the_reference_is_good_to_the_third_of_a_percent(letter_scene, monkeypatch):
    """40 modes against 60: the folds differ by less than what the loosest and the tightest study asks for."""
    monkeypatch.setattr("studies.physics.least_model.REFERENCE", 60)
    whole = reference_of(letter_scene)
    assert whole.n_modes == 60
    for question in questions(letter_scene, {"fold": 0.05}, whole):
        assert question.off(40) < 3e-3


def test_what_the_scene_says_itself_is_not_changed(letter_scene):
    needs = {"fold": 0.05}
    for scene in (
        letter_scene.replace({"modes.count": 7}),
        letter_scene.replace({"drive.kind": "none"}),
        read_scene("measured_modes"),
    ):
        assert least_modes(scene, needs) == (scene, "")


def test_a_spring_of_ones_own_gets_its_own_number_and_a_tolerance_too_tight_is_told():
    ruler = read_scene("steel_ruler")
    scene, _ = least_modes(ruler, {"fold": 0.05})
    assert scene.modes.count in LADDER and scene.modes.count > 15
    scene, sentence = least_modes(ruler, {"kick": 1e-12})
    assert scene.modes.count == 40 and "all that were tried" in sentence


def test_a_coarse_mesh_or_few_measured_rates_bound_the_reference(letter_scene):
    rates = {"damping.kind": "measured", "damping.measured_rates_per_s": [3.56, 20.0, 50.0]}
    few = letter_scene.replace(rates)
    assert least_modes(few, {"kick": 1e-12})[0].modes.count == 3
    coarse = letter_scene.replace({"spring.elements_per_leg": 2, "spring.elements_on_arc": 1})
    assert reference_of(coarse).n_modes < 40


def test_an_unknown_quantity_is_refused(letter_scene):
    with pytest.raises(ValueError, match="colour"):
        least_modes(letter_scene, {"colour": 0.1})
