"""Enough model and not more: against a larger reference, one step less, and the quick estimate of studies."""

import math
from dataclasses import asdict, replace
from functools import cache

import numpy as np
import pytest
from oscillators import slow

from studies.methods.adequacy.__main__ import questions, sentences
from studies.methods.adequacy.model import QUANTITIES, Choice, LeastModel, Models, Search, first
from studies.physics.least_model import least_modes
from studies.shell.scene import read_scene

LETTER, FOLDED = read_scene("letter"), read_scene("tight_fold")
#: Of the heavy ball and of the soft contact.
pytestmark = pytest.mark.filterwarnings(
    "ignore:mass of the tip:beam.SuspiciousValue", "ignore:(youngs|other)_modulus:beam.SuspiciousValue"
)
SOFT = {"tip.ball_young_modulus_pa": 1e6, "tip.plate_young_modulus_pa": 1e6}
SCENES = {
    "letter": (LETTER, 22.2),
    "bare tip": (FOLDED.replace({"tip.mass_kg": 0.0}), 22.2),
    "heavy ball": (LETTER.replace({"tip.mass_kg": 0.03}), 14.0),
    "soft contact": (LETTER.replace(SOFT), 22.2),
    "fast drive": (LETTER.replace({"drive.frequencies_hz": (140.0,)}), 140.0),
}


@cache
def models_of(name: str) -> Models:
    """The models of a scene, each solved once for all tests."""
    return Models(SCENES[name][0])


@cache
def search_of(quantity: str, frequency: float = 22.2, name: str = "letter") -> Search:
    """One question; its answers are kept for all tests."""
    return Search(models_of(name), quantity, frequency)


def chosen(row: object) -> Choice:
    return Choice(**{name: getattr(row, name) for name in asdict(Choice(level="", law="newton"))})


def check(name: str, quantity: str, frequency: float) -> Choice:
    """The least model and all that are one step smaller, against 100 modes and 200 elements on a leg.

    These are not enough, or so near to the tolerance that what the search's own reference leaves decides.
    """
    search = search_of(quantity, frequency, name)
    tolerance = search.tolerance
    row = search.least(tolerance)
    assert row.reached
    least = chosen(row)
    larger = Search(search.models, quantity, frequency, replace(search.sharp, modes=100, mesh=200))
    error = larger.error(least)
    assert error <= tolerance
    assert row.error == pytest.approx(error, rel=0.1, abs=0.1 * tolerance)
    beyond = tolerance - 2.0 * search.own_error()
    assert all(larger.error(step) > beyond for step in search.smaller(least))
    return least


@pytest.mark.parametrize("name", ["letter", *slow(*list(SCENES)[1:])])
@pytest.mark.parametrize("quantity", ["frequency 3", "kick", *slow("restitution", "delay")])
def test_enough_and_not_more(name, quantity):
    check(name, quantity, SCENES[name][1])


@pytest.mark.slow
@pytest.mark.parametrize(("frequency", "law"), [(20.9, "hertz"), (21.5, "linear"), (22.2, "hertz")])
def test_enough_and_not_more_for_the_fold(frequency, law):
    least = check("letter", "fold", frequency)
    assert least.law == law and least.modes >= 12


def test_a_soft_contact_leaves_the_higher_modes_alone_a_stiff_one_does_not():
    soft = search_of("kick", name="soft contact").least(1e-2)
    stiff = search_of("kick").least(1e-2)
    assert soft.modes == 1 < 8 <= stiff.modes and soft.cost < 0.7 * stiff.cost


@pytest.mark.slow
@pytest.mark.parametrize(("frequency", "least"), [(21.5, ("Eq. (1)", 1, False)), (23.4, ("beam", 1, True))])
def test_born_period_needs_one_mode_where_the_letter_agrees_and_a_residual_one_elsewhere(frequency, least):
    """An integer is right or wrong: equal at the drive frequency and at both ends of the error of T."""
    row = search_of("born_period", frequency).least(0.0)
    assert row.reached and row.error == 0.0 and (row.level, row.modes, row.residual) == least


@pytest.mark.parametrize(
    ("quantity", "tolerance"), [("kick", 5e-3), *slow(("fold", 0.07), ("tip_trace", 2e-3))]
)
def test_the_quick_estimate_of_the_studies_is_that_of_the_search(quantity, tolerance):
    """The search follows orbits to their folds on a fine mesh, the estimate takes kicks on the usual one."""
    scene = LETTER.replace({"drive.frequencies_hz": (22.2,)})
    quick, _ = least_modes(scene, {quantity: tolerance})
    search = search_of(quantity)
    ladder = [replace(search.sharp, modes=modes) for modes in (6, 7, 8, 10, 12, 15, 18, 21)]
    assert first(ladder, lambda choice: search.off(choice) <= tolerance).modes == quick.modes.count


def test_where_nothing_is_enough_it_says_what_remains():
    search = search_of("kick")
    row = search.least(1e-9)
    assert not row.reached and chosen(row) == search.sharp
    assert row.error == pytest.approx(row.parts["reference"]) and row.error > 1e-9


def test_parts_of_the_error_explain_it():
    """The whole is at most the sum of the parts, up to what they do to one another."""
    search = search_of("kick")
    choice = Choice(level="beam", law="linear", modes=10, mesh=6)
    parts = search.parts(choice)
    assert set(parts) == {"contact_law", "fewer_modes", "coarser_mesh"}
    assert search.off(choice) <= 1.3 * sum(parts.values())
    assert search.error(choice) >= max(parts.values())


def test_errors_that_cancel_get_no_credit():
    """Five modes on two elements come within 0.01 of the restitution, by luck."""
    search = search_of("restitution")
    choice = Choice(level="beam", law="hertz", modes=5, mesh=2)
    assert search.off(choice) < 1e-2 < search.error(choice)


def test_a_model_without_an_answer_is_infinitely_far_off():
    error = QUANTITIES["fold"][1]
    assert error(np.array([-1e-3, 4.0]), np.array([-1e-3, 5.0])) == math.inf
    assert error(np.array([-1e-4, 5.0]), np.array([-2e-4, 5.0])) == pytest.approx(0.4)  # of 2.5e-4
    coarse = Choice(level="beam", law="newton", modes=40, mesh=2)
    assert search_of("kick").error(coarse) == math.inf
    row = search_of("frequency 41").least(1e-3)  # of 40 modes
    assert not row.reached and row.error == math.inf and row.least == "none"


@pytest.mark.parametrize("count", [3, *slow(7)])
def test_the_study_leaves_a_row_a_question(run_study, monkeypatch, count):
    assert {name.partition(" ")[0] for name, _ in questions(LETTER, False)} == set(QUANTITIES)
    few = questions(LETTER.replace({"drive.frequencies_hz": (21.5,)}), True)[:count]
    monkeypatch.setattr("studies.methods.adequacy.__main__.questions", lambda scene, quick: few)
    ran = run_study("adequacy", "--quick", "--set", "drive.frequencies_hz=[21.5]")
    assert ran.code == 0 and len(ran.summary["rows"]) == count
    assert all(row["reached"] and row["error"] <= row["tolerance"] for row in ran.summary["rows"])
    rows = [LeastModel(**row) for row in ran.summary["rows"]]
    assert ran.summary["findings"] == list(sentences(rows)) != []
    far = [replace(row, level="beam", quantity="born period") for row in rows[:2]]
    assert not list(sentences(far))  # Eq. (1) is enough nowhere
