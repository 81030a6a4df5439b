"""The letter's Fig. 5: where the state born at grazing is not p3, and p3 is the end of the downward scan."""

import numpy as np
import pytest
from conftest import verdicts_on

from contact import MapFamily, maximal_m
from studies import letter
from studies.experiment.breakdown import model
from studies.experiment.breakdown.model import FREQUENCY_HZ, Spring, cell_of, fig_5, island, periods, scanned
from studies.physics.calibration import ACCURACY, calibrate_thickness, strip_decay_rate
from studies.shell.scene import free_period, model_of, nordmark_at


@pytest.fixture(scope="module")
def scene(letter_scene):
    return fig_5(letter_scene)


def test_the_beam_of_fig_5_has_its_period_and_damping_and_keeps_ball_and_gap(scene, letter_scene):
    assert free_period(scene) == pytest.approx(letter.BREAKDOWN["free_period_s"], rel=2 * ACCURACY)
    assert strip_decay_rate(scene) == pytest.approx(letter.BREAKDOWN["decay_rate_per_s"], rel=2 * ACCURACY)
    assert (scene.tip, scene.stop) == (letter_scene.tip, letter_scene.stop)
    assert scene.spring.thickness_m < letter_scene.spring.thickness_m  # a slower spring is a thinner one


def test_the_map_puts_fig_5_in_the_region_of_a_stable_p3(scene):
    nordmark = nordmark_at(scene, FREQUENCY_HZ)
    low, high = MapFamily(nordmark, 3).stable_range()
    assert maximal_m(nordmark) == 3 and low < 0 < high
    # and the letter's rho of the chaos is not its excess
    chaos = letter.BREAKDOWN["chaos_at"]
    assert nordmark.excess(chaos) / chaos == pytest.approx(0.787, abs=2e-3)


@pytest.mark.parametrize(
    ("restitution", "fold", "second_impact", "end"),
    [(0.1, -0.13207, -0.13097, -0.084), (0.05, -0.11574, -0.11282, -0.061)],
)
def test_the_island_of_eq_1_starts_at_the_fold_and_outlives_the_single_impact_p3(
    scene, restitution, fold, second_impact, end
):
    found, diagram = island(scene, restitution, step=1e-3)
    assert found.fold_p3 == pytest.approx(fold, abs=2e-5)
    on_p3 = (diagram.m == 3) & (diagram.impacts == 1)
    assert on_p3[0] and diagram.excess[on_p3].max() < second_impact + 2e-5
    # chaos is a transient beyond the end, which a scan of finite length overruns by a few steps at most
    assert found.end == pytest.approx(end, abs=4e-3)
    assert np.mean(diagram.m == 0) > 0.5
    # the letter's chaos at -0.0707 is there for the smaller tau only
    assert (found.end >= letter.BREAKDOWN["chaos_at"]) == (restitution == 0.05)
    # not connected to grazing: the motion without impacts is stable all along
    assert found.end < -0.05


def test_the_beam_as_calibrated_and_eq_1_are_born_without_a_period(scene):
    calibrated = Spring(scene=scene, model=model_of(scene), tip_mass_kg=scene.tip.mass_kg)
    for spring in (model.single_mode(scene, 0.1), calibrated):
        cell = cell_of(spring)
        assert cell.m == 0 and cell.impacts > 20


def test_a_lighter_ball_gives_the_letters_p6_and_p3_at_the_end_of_the_downward_scan(scene):
    tuned = model.tuned(scene, 0.00425)
    light = Spring(scene=scene, model=tuned, tip_mass_kg=0.00425, higher_damping=1.5)
    cell = cell_of(light)
    assert (cell.m, cell.impacts) == (6, 3)
    outcome, ways = scanned(("light", light), points=31, cycles=500, early=True)
    assert outcome.born_period == 6 and -0.09 < outcome.fold_p3 < -0.05 and outcome.ends_on_p3
    up, down = ways["up"], ways["down"]
    below = up.excess < -1e-9
    assert np.all(periods(up)[below] == 1) and np.all(up.impacts[below] == 0)
    # p3 with one impact is met once, and after it there is only the motion without impacts
    last = int(np.flatnonzero((periods(down) == 3) & (down.impacts == 1))[-1])
    step = down.excess[last] - down.excess[last + 1]
    assert 0.0 <= outcome.p3_last - outcome.fold_p3 + 1e-9 <= 2 * step
    assert np.all(down.impacts[last + 1 :] == 0) and np.all(down.impacts[: last + 1] > 0)
    assert outcome.p3_first < 0.6 * outcome.fold_p3  # far from grazing, at the end of the scan


@pytest.mark.parametrize("side", [-1.0, pytest.param(1.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["free_period", "decay_rate"])
def test_errors_of_the_letter_do_not_give_period_6_to_the_calibrated_beam(scene, side, name):
    given = dict(letter.BREAKDOWN)
    (key,) = (key for key in given if key.startswith(name) and "error" not in key)
    given[key] += side * given[key.replace(name, f"{name}_error")]
    here = scene.replace({"damping.decay_rate_per_s": given["decay_rate_per_s"]})
    model = model_of(calibrate_thickness(here, given["free_period_s"]))
    assert cell_of(Spring(scene=here, model=model, tip_mass_kg=scene.tip.mass_kg)).m != 6


def test_small_form(run_study):
    ran = run_study("breakdown", "--quick", "--cycles", "400")
    assert ran.code == 0
    six = ran.summary["cells_with_period_6"]
    assert (0.004, 1.0) in [(cell["tip_mass_kg"], cell["higher_damping"]) for cell in six]
    assert ran.summary["found"]["tip_mass_kg"] == 0.004
    assert ran.verdicts == verdicts_on("breakdown")
    points = [row for row in ran.rows("breakdown") if row["description"] == "beam"]
    kept = {row["excess"]: sum(one["excess"] == row["excess"] for one in points) for row in points}
    assert {row["direction"] for row in points} == {"up", "down"}
    assert max(kept.values()) <= 2 * letter.STROBE_POINTS
