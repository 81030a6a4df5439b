"""The comparison with published numbers as a program: what agrees, what differs, what is open."""

from __future__ import annotations

import csv

import pytest

from contact import NotPeriodic
from studies.methods.two_masses import two_masses
from studies.methods.validation import __main__ as program
from studies.methods.validation.responses import followed, harmonic
from studies.methods.validation.rows import Section, compared


@pytest.mark.parametrize(
    ("numbers", "holds", "verdict"),
    [
        ((1.0, 1.05, 0.1), None, "agrees"),
        ((1.0, 0.85, 0.1), None, "differs"),
        ((0, 0, 0), None, "agrees"),
        ((None, 2.0, None), None, "open"),
        ((1.0, 2.0, None), None, "open"),
        ((1.0, None, 0.1), None, "not found"),
        ((None, 2.0, None), True, "holds"),
        ((None, 2.0, None), False, "fails"),
    ],
)
def test_verdicts(numbers, holds, verdict):
    row = compared("a", "b", *numbers, holds=holds)
    assert row.verdict == verdict
    assert (row.difference is None) == (numbers[0] is None or numbers[1] is None)


BY_A_BOUNDARY_PROBLEM = {
    "torus": (0.581900650365, 0.618606874267),
    "period doubling": (0.738783025373, 0.755586159356),
    "fold": (0.755627352609, 0.653440134549),
}
"""W from a solution in 40 digits by a program of its own: contact and flight as two pieces of unknown
durations, closed, with a condition on the eigenvalues of their product."""


def test_the_bifurcations_of_two_masses_by_a_boundary_problem_in_40_digits():
    branch = followed(two_masses, 0.635, low=0.5, high=0.8, step=0.3)
    for kind, exact in BY_A_BOUNDARY_PROBLEM.items():
        found = [event.parameter for event in branch.events if event.kind == kind]
        assert found == pytest.approx(list(exact), abs=2e-12)
    here = min(branch.orbits, key=lambda orbit: abs(orbit.oscillator.drive.angular_frequency - 0.635))
    assert abs(here.multipliers[0]) == pytest.approx(0.885750370466, abs=2e-12)
    # 128 samples alias a kink
    assert abs(harmonic(here, "mass 2")) == pytest.approx(0.678123770452, abs=1e-7)


FAST = ("ghosh_simpson", "coco", "sdnd122", "nlvib", "bouncing_bar", "two_bars")


@pytest.mark.parametrize("count", [3, pytest.param(len(FAST), marks=pytest.mark.slow)])
def test_every_source_has_its_table_and_its_tally(run_study, monkeypatch, count):
    sections = {name: program.SECTIONS[name] for name in FAST[:count]}
    sections["nothing"] = lambda run: Section(rows=[compared("none", "a number", 1.0, 3.0, 0.5, "wrong")])
    monkeypatch.setattr(program, "SECTIONS", sections)
    ran = run_study("validation", "--quick")
    differ = {each["source"]: each["differs"] for each in ran.summary["sources"]}
    expected = {
        "Ghosh and Simpson": 0,
        "COCO 15.2": 0,
        "SDND122": 1,
        "NLvib 03": 0,
        "bouncing bar": 0,
        "SDNL111": 0,
    }
    assert differ == dict([*expected.items()][:count]) | {"none": 1}
    if count == len(FAST):
        assert sum(each["agrees"] for each in ran.summary["sources"]) >= 30
        assert sum(each["holds"] for each in ran.summary["sources"]) >= 15
    assert not any(each["fails"] for each in ran.summary["sources"])
    with (ran.folder / "rows.csv").open(newline="") as stream:
        told = [row["verdict"] for row in csv.DictReader(stream)]
    assert told == [row["verdict"] for row in ran.summary["rows"]]
    assert {f"{name}.csv" for name in sections} <= {path.name for path in ran.folder.iterdir()}


def test_a_source_that_fails_does_not_take_the_others_along(run_study, monkeypatch):
    def lost(run):
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail="as a test has it")

    sections = {"lost": lost, "two_bars": program.SECTIONS["two_bars"]}
    monkeypatch.setattr(program, "SECTIONS", sections)
    ran = run_study("validation")
    assert ran.code == 3 and "as a test has it" in ran.summary["failures"][0]
    assert [each["source"] for each in ran.summary["sources"]] == ["SDNL111"]


@pytest.mark.slow
def test_the_whole_small_form(run_study):
    ran = run_study("validation", "--quick")
    rows = {(row["source"], row["quantity"]): row for row in ran.summary["rows"]}
    wrong = [key for key, row in rows.items() if row["verdict"] in ("differs", "fails")]
    assert wrong == [("SDND122", "f at 0.00650108 J"), ("Woiwode and Krack 2024", "right, mode 5 [Hz]")]
