"""The chain of descriptions from the map to the beam, and what it answers."""

import math

import numpy as np
import pytest
from conftest import verdicts_on
from matplotlib.text import Text

from contact import NewtonRestitution, StroboscopicMap, maximal_m
from contact.orbits import Shooting, fold_of, settle
from studies.experiment.hysteresis.figure import draw_curves
from studies.experiment.hysteresis.model import CAUSES, CHAIN, branch_of, folds_at, inside_band, path_of
from studies.physics.descriptions import falls
from studies.shell.scene import band_of, beam_at, model_of, single_mode_of


@pytest.fixture(scope="module")
def beam(letter_scene):
    return beam_at(letter_scene, 21.50, model_of(letter_scene))


@pytest.fixture(scope="module")
def fold(letter_scene, beam):
    return folds_at(letter_scene, 21.50, 4, beam.model)


def test_the_causes_multiply_to_the_ratio_of_beam_and_map(fold):
    row, _ = fold
    product = math.prod(row.factor(cause) for cause in CAUSES)
    assert product == pytest.approx(row.beam / row.map, rel=1e-12) and row.beam_admissible


def test_with_one_mode_and_newtons_law_the_whole_chain_is_eq_1(letter_scene):
    """Then there is no delay, no velocity dependence and no higher mode: five descriptions are one."""
    tau = letter_scene.single_mode.restitution
    plain = letter_scene.replace({"contact.law": "newton", "contact.local_restitution": tau})
    row, orbit = folds_at(plain, 22.20, 5, single_mode_of(letter_scene))
    assert isinstance(orbit.oscillator.stop.law, NewtonRestitution)
    for name in CHAIN[1:]:
        assert getattr(row, name) == pytest.approx(-1.4773426733e-3, rel=1e-8), name
    assert row.map == pytest.approx(-8.235686505e-4, abs=1e-12)
    assert row.map_measured_kick == pytest.approx(row.map, rel=1e-9)


def test_the_hysteresis_starts_from_zero_at_the_upper_edge_of_each_band(letter_scene):
    for m in range(3, 9):
        edges, rows = band_of(letter_scene, m), inside_band(letter_scene, 13, m)
        assert edges.upper == pytest.approx(2 * m / ((2 * m + 1) * 40.80e-3), rel=1e-12)
        assert band_of(letter_scene, m + 1).lower < edges.upper  # neighbours overlap
        assert max(rows[-1].map, rows[-1].eq1) < 1e-12
        assert falls([row.map for row in rows]) and falls([row.eq1 for row in rows])
    assert {3, 4, 5, 6, 8, 11} <= {maximal_m(place) for place in path_of(letter_scene)}


def test_the_branch_has_its_least_amplitude_at_the_fold_and_is_stable_above(letter_scene, fold, beam):
    rows = branch_of(letter_scene, 21.50, 4, beam.model)
    least = min(rows, key=lambda row: row.excess)
    assert least.excess == pytest.approx(fold[0].beam, rel=1e-9)
    assert any(row.event == "fold" and row.speed == pytest.approx(least.speed, rel=1e-6) for row in rows)
    assert all(row.stable for row in rows if row.speed > 1.01 * least.speed)
    assert not any(row.stable for row in rows if 0.1 < row.speed / least.speed < 0.99)


def test_the_figure_of_another_spring_bears_no_mark_of_the_letter(letter_scene, fold):
    for letters in (True, False):
        texts = draw_curves(letter_scene, [fold[0]], letters=letters).findobj(Text)
        assert any("letter" in text.get_text() for text in texts) == letters


def test_small_form(run_study, letter_scene):
    ran = run_study("hysteresis", "--quick", "--step", "0.6", "--inside", "9")
    assert ran.code == 0 and {row["m"] for row in ran.summary["rows"]} >= {3, 4, 5, 6}
    kept = [row for row in ran.summary["rows"] if (row["beam"] or 0.0) < -2.5e-4 and row["map"] is not None]
    off = {row["description"]: row for row in ran.summary["accuracy"]}
    assert off["single_mode"]["folds"] == len(kept) < len(ran.summary["rows"])
    error = [abs(np.log(row["map"] / row["beam"])) for row in kept]
    assert off["map"]["worst"] == pytest.approx(np.exp(max(error)))
    assert off["all_mode_kick"]["worst"] < 1.02 < off["map"]["median"]
    assert ran.verdicts == verdicts_on("hysteresis")
    # p7 remains where p6 is born; second route: the simulated motion above its fold and below it
    (seven,) = (row for row in ran.summary["rows"] if (row["m"], row["frequency_hz"]) == (7, 22.6))
    beam = beam_at(letter_scene, 22.6, model_of(letter_scene.replace({"modes.count": ran.summary["modes"]})))
    family, strobed = Shooting(oscillator=beam, m=7), StroboscopicMap(oscillator=beam)
    start = family.at_speed(1.05 * abs(fold_of(family).speed)).strobe_state()
    for factor, expected in ((0.997, (7, 1)), (1.003, (1, 0))):
        settled = settle(strobed.at(factor * seven["beam"]), start, most_cycles=2000)
        assert (settled.m, settled.impacts) == expected
