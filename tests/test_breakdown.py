"""The letter's Fig. 5: where the state born at grazing is not p3, and p3 is the end of the downward scan."""

from __future__ import annotations

import json
import math
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from beam import ModalModel
from contact.maximal_orbits import maximal_period, stable_range
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies import breakdown
from studies.instruments.breakdown.beam_of_fig_5 import (
    FREE_PERIOD_S,
    FREQUENCY_HZ,
    born,
    driven,
    fold_of_p3,
    lossy,
    scene_of_fig_5,
    tuned,
)
from studies.instruments.breakdown.born_period_map import candidates, within_errors
from studies.instruments.breakdown.scans import both_ways, periods
from studies.instruments.breakdown.single_mode_island import island
from studies.instruments.calibration import ACCURACY, decay_rate, free_period
from studies.instruments.oscillators import (
    REFERENCE_EXCESS,
    approach_speed,
    nordmark_of,
    single_mode_oscillator,
)
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import model_of
from studies.published import BREAKDOWN

SIX = {"mass": 0.004, "factor": 2.0}
"""Ball and damping of the higher modes with which the state born at grazing has period 6, contact elastic."""


@pytest.fixture(scope="module")
def scene():
    return scene_of_fig_5(read_scene("letter", []))


@pytest.fixture(scope="module")
def light(scene):
    model = tuned(scene, FREE_PERIOD_S, mass=SIX["mass"])
    return driven(scene, model, factor=SIX["factor"], local_restitution=1.0)


def test_the_beam_of_fig_5_has_its_period_and_damping_and_keeps_ball_and_gap(scene):
    before = read_scene("letter", [])
    assert free_period(scene) == pytest.approx(BREAKDOWN["free_period_s"], rel=2 * ACCURACY)
    assert decay_rate(scene) == pytest.approx(BREAKDOWN["decay_rate_per_s"], rel=2 * ACCURACY)
    assert scene.tip == before.tip
    assert scene.stop == before.stop
    assert scene.spring.thickness_m < before.spring.thickness_m  # a slower spring is a thinner one


def test_the_map_puts_fig_5_in_the_region_of_a_stable_p3(scene):
    nordmark = nordmark_of(scene, FREQUENCY_HZ)
    assert maximal_period(nordmark) == 3
    low, high = stable_range(nordmark, 3)
    assert low < 0 < high


@pytest.mark.parametrize(
    ("restitution", "fold", "second_impact", "end"),
    [(0.1, -0.13207, -0.13097, -0.084), (0.05, -0.11574, -0.11282, -0.061)],
)
def test_the_island_of_eq_1_starts_at_the_fold_and_outlives_the_single_impact_p3(
    scene, restitution, fold, second_impact, end
):
    found, diagram = island(scene, restitution, step=1e-3)
    assert found["fold_p3"] == pytest.approx(fold, abs=2e-5)
    on_p3 = (diagram.period == 3) & (diagram.impacts == 1)
    assert on_p3[0]
    assert diagram.excess[on_p3].max() < second_impact + 2e-5
    # chaos is a transient beyond the end, which a scan of finite length overruns by a few steps at most
    assert found["end"] == pytest.approx(end, abs=4e-3)
    assert np.mean(diagram.period == 0) > 0.5
    # the letter's chaos at -0.0707 is there for the smaller tau only
    assert found["alive_at_letters_chaos"] == (restitution == 0.05)
    # not connected to grazing: the motion without impacts is stable all along
    assert found["end"] < -0.05


def test_the_fold_of_p3_of_eq_1_from_shooting_is_that_of_the_closed_form_for_either_tau(scene):
    """Closed form and shooting agree at both; by 1 + tau alone the folds would differ less."""
    folds = []
    for tau in (0.05, 0.1):
        here = scene.replace({"single_mode.restitution": tau})
        oscillator = single_mode_oscillator(here, FREQUENCY_HZ)
        closed = MaximalFamily.from_oscillator(oscillator, period=3).fold().excess
        scan = fold_of_p3(StroboscopicMap(oscillator=oscillator))
        assert scan == pytest.approx(closed, rel=1e-8)
        folds.append(closed)
    assert folds[1] / folds[0] == pytest.approx(1.141, abs=2e-3)


def test_the_beam_as_calibrated_and_eq_1_are_born_without_a_period(scene):
    for oscillator in (
        single_mode_oscillator(scene, FREQUENCY_HZ),
        driven(scene, model_of(scene)).oscillator,
    ):
        period, impacts = born(StroboscopicMap(oscillator=oscillator), 1500)
        assert period == 0
        assert impacts > 20


def test_a_ball_of_4_g_gives_the_letters_p6_and_p3_at_the_end_of_the_downward_scan(light):
    assert born(light) == (6, 3)
    fold = fold_of_p3(light)
    assert -0.09 < fold < -0.05
    plan = SimpleNamespace(below=45, above=4, cycles=700, early=True)
    found = both_ways(light, 1.12 * fold, plan, light.tip)
    up, down = found["up"], found["down"]
    below = up.excess < -1e-9
    assert np.all(periods(up)[below] == 1)
    assert np.all(up.impacts[below] == 0)
    # p3 with one impact is met once, and after it there is only the motion without impacts
    falling, period = down.excess, periods(down)
    on_p3 = np.flatnonzero((period == 3) & (down.impacts == 1))
    assert on_p3.size >= 1
    last = int(on_p3[-1])
    step = falling[last] - falling[last + 1]
    assert falling[last] >= fold - 1e-9
    assert falling[last] - fold <= 2 * step
    assert np.all(down.impacts[last + 1 :] == 0)
    assert np.all(down.impacts[: last + 1] > 0)
    assert falling[on_p3[0]] < 0.6 * fold  # far from grazing, at the end of the scan


def test_the_search_keeps_the_period_of_the_beam_and_scales_the_higher_modes_only(scene, light):
    omega, rate = light.oscillator.model.omega[0], light.oscillator.model.decay_rate[0]
    period = 2 * math.pi / math.sqrt(omega**2 - 0.25 * rate**2)
    assert period == pytest.approx(BREAKDOWN["free_period_s"], rel=1e-9)
    more = driven(scene, light.oscillator.model, factor=3.0).oscillator.model
    assert more.decay_rate[0] == rate
    assert more.decay_rate[1:] == pytest.approx(3.0 * light.oscillator.model.decay_rate[1:], rel=1e-15)


def test_a_lossy_ball_leaves_with_the_restitution_asked_for(scene):
    law = lossy(scene, 0.7)
    speed = approach_speed(FREQUENCY_HZ, scene.stop.gap_m, REFERENCE_EXCESS)
    mass = 0.006
    free = ModalModel(
        omega=[0.0], decay_rate=[0.0], phi=[1 / math.sqrt(mass)], participation=[math.sqrt(mass)]
    )
    ball = ImpactOscillator(model=free, stop=Stop(gap=1e-4, law=law), drive=None)
    start = State(displacement=np.zeros(1), velocity=np.array([speed * math.sqrt(mass)]))
    run = simulate(ball, start, duration=0.01)
    assert run.end.velocity[0] / start.velocity[0] == pytest.approx(-0.7, abs=1e-6)


def test_rho_of_the_letters_chaos_is_not_its_excess(scene):
    nordmark = nordmark_of(scene, FREQUENCY_HZ)
    assert isinstance(nordmark, NordmarkMap)
    assert nordmark.excess(BREAKDOWN["chaos_at"]) / BREAKDOWN["chaos_at"] == pytest.approx(0.787, abs=2e-3)


def test_cells_are_tried_by_what_they_ask_for(scene):
    cells = [
        {"tip_mass_kg": m, "higher_damping": k, "local_restitution": e, "period": p}
        for m, k, e, p in (
            (0.005, 1.0, 0.7, 6),
            (0.004, 4.0, 1.0, 6),
            (0.0045, 0.5, 1.0, 6),
            (0.006, 1.0, 1.0, 12),
        )
    ]
    assert candidates(cells, scene) == [cells[2], cells[1], cells[0]]
    assert candidates(cells[-1:], scene) == []


def test_errors_of_the_letter_do_not_give_period_6_to_the_calibrated_beam(scene):
    with ThreadPoolExecutor(max_workers=2) as pool:
        assert 6 not in [row["period"] for row in within_errors(scene, pool)]


def test_json_has_the_promised_keys(tmp_path, capsys):
    code = breakdown.main(["--json", "--quick", "--out", str(tmp_path)])
    answer = json.loads(capsys.readouterr().out)
    assert code == 0
    assert {"schema", "up", "down", "single_mode", "born", "found"} <= answer.keys()
    for way in ("up", "down"):
        assert {"excess", "period", "impacts"} == answer[way][0].keys()
    assert [row["excess"] for row in answer["up"]] == [row["excess"] for row in answer["down"]][::-1]
    cells = {(cell["tip_mass_kg"], cell["higher_damping"]): cell["period"] for cell in answer["born"]}
    assert cells[(0.004, 2.0)] == 6
    assert answer["found"]["tip_mass_kg"] == 0.004
    assert answer["found"]["p3_in_downward_scan"]
    for name in ("breakdown.png", "born_period.png", "born_period.csv", "breakdown.npz", "manifest.json"):
        assert (tmp_path / "breakdown" / name).stat().st_size > 100


@pytest.mark.parametrize("change", ["drive.kind=none", "spring.kind=modal_data"])
def test_wrong_input_gets_one_sentence(tmp_path, capsys, change):
    assert breakdown.main(["--out", str(tmp_path), "--set", change]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert "Traceback" not in said
