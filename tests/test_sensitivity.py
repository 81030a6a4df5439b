"""The six transitions under errors, noise and open assumptions."""

from __future__ import annotations

import json

import numpy as np
import pytest

from contact.nordmark import StrobedNordmarkMap
from contact.orbits import born
from contact.stroboscope import StroboscopicMap
from studies import sensitivity
from studies.instruments.calibration import free_period
from studies.instruments.oscillators import beam_of, nordmark_of, single_mode_oscillator
from studies.instruments.scene_file import read_scene
from studies.instruments.sensitivity.amplitude_noise import noise_at, noisy
from studies.instruments.sensitivity.changed_folds import row_at
from studies.instruments.sensitivity.grazing_births import BORN_EXCESS, NOISE, first_birth, upper_end
from studies.instruments.sensitivity.scene_changes import changed, changes_of
from studies.instruments.sensitivity.strobe_clouds import clouds, since_impact
from studies.instruments.spring_of_scene import model_of
from studies.published import FREE_PERIOD_ERROR_S

NAMES = ("map", "single_mode", "beam")


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter", [])


@pytest.fixture(scope="module")
def model(scene):
    return model_of(scene)


def change(scene, parameter, sign):
    return next(c for c in changes_of(scene, False) if (c.parameter, c.sign) == (parameter, sign))


@pytest.fixture(scope="module")
def last(scene, model):
    """23.40 Hz without a change, and with T at both ends of its error."""
    base, periods = row_at(scene, model, 23.40, None, None)
    found = {0: base}
    for sign in (-1, 1):
        one = change(scene, "free period", sign)
        found[sign] = row_at(*changed(scene, one), 23.40, one, periods)[0]
    return found


def test_nothing_within_the_error_of_the_free_period_gives_p10_at_grazing(last):
    for row in last.values():
        assert 10 not in [row[f"born_{name}"] for name in NAMES]
        assert row["born_map"] == row["born_beam"] == 11


def test_a_shorter_free_period_deepens_the_hysteresis_in_all_descriptions(last):
    """f T falls: further below the upper edge of the band, where the fold leaves grazing as its square."""
    for name in NAMES:
        shorter, base, longer = (last[sign][f"fold_{name}"] for sign in (-1, 0, 1))
        assert shorter < base < longer < 0
    edge = 22.0 / 23.0
    distance = {sign: edge - 23.40 * (40.80e-3 + sign * FREE_PERIOD_ERROR_S) for sign in (-1, 0, 1)}
    for sign in (-1, 1):
        ratio = last[sign]["fold_map"] / last[0]["fold_map"]
        assert ratio == pytest.approx((distance[sign] / distance[0]) ** 2, rel=0.05)


def test_the_free_period_at_which_p10_is_born(scene):
    """The band edge f T = 20/21 in the map itself, on both sides of it."""
    for period, wanted in ((40.71e-3, 11), (40.69e-3, 10)):
        there = scene.replace({"single_mode.free_period_s": period})
        strobed = StrobedNordmarkMap(map=nordmark_of(there, 23.40))
        assert born(strobed, 1e-5).period == wanted
    assert 20.0 / (21.0 * 23.40) == pytest.approx(40.70e-3, abs=5e-6)


def test_the_steps_that_skip_p11_are_far_above_the_noise(scene, model):
    for oscillator in (single_mode_oscillator(scene, 23.40), beam_of(scene, 23.40, model)):
        strobed = StroboscopicMap(oscillator=oscillator)
        lives = upper_end(strobed, 11)
        ten = first_birth(strobed, 10)
        assert 5 * NOISE < lives < ten < 40 * NOISE


def test_a_changed_spring_keeps_its_period_and_the_rate_of_mode_1(scene, model):
    period = free_period(scene)
    for parameter in ("mass of ball and mount", "damping of higher modes"):
        there, modes = changed(scene, change(scene, parameter, 1))
        assert free_period(there) == pytest.approx(period, rel=1e-9)
        assert modes.decay_rate[0] == pytest.approx(model.decay_rate[0], rel=1e-9)
    assert modes.decay_rate[1:] == pytest.approx(2.0 * model.decay_rate[1:], rel=1e-12)


def test_the_fold_of_eq_1_and_map_know_nothing_of_the_higher_modes(scene, model):
    base, periods = row_at(scene, model, 20.90, None, None)
    one = change(scene, "damping of higher modes", 1)
    row, _ = row_at(*changed(scene, one), 20.90, one, periods)
    assert row["fold_map"] == base["fold_map"]
    assert row["fold_single_mode"] == base["fold_single_mode"]
    assert abs(row["fold_beam"] / base["fold_beam"] - 1) > 0.05


def test_noise_has_the_size_asked_for_and_leaves_p3_with_three_clouds(scene):
    """Jitter of relative rms s moves a strobe point of p_m by at least its own share of the steady motion."""
    strobed = StroboscopicMap(oscillator=single_mode_oscillator(scene, 20.90))
    points, impacts = noisy(strobed, strobed.tip, "jitter", 600)
    found = clouds(points, impacts, 3)
    assert found["regular"] == 1.0
    assert found["told_apart"] > 5
    quiet = strobed.at(BORN_EXCESS).orbit(born(strobed).end, 3)
    phases = since_impact(impacts)
    centres = np.sort([np.median(points[phases == j]) for j in range(3)])
    # the clouds lie where the points without noise are
    assert centres == pytest.approx(np.sort(strobed.tip(quiet.points)), abs=0.5 * found["spread"])


def test_strobe_points_run_together_and_hysteresis_sinks_below_the_noise_as_m_grows(scene):
    rows = {m: noise_at(scene, m, 500) for m in (6, 9, 13)}
    ratio = [rows[m]["jitter"]["told_apart"] for m in rows]
    assert ratio[0] > 2 > ratio[1] > 1 / 2 > ratio[2] or ratio[0] > 2 > 0.7 > ratio[2]
    assert ratio[0] > ratio[1] > ratio[2]
    for m in rows:
        assert rows[m]["born"] == m
        assert rows[m]["drift"]["told_apart"] < rows[m]["jitter"]["told_apart"]
    assert abs(rows[6]["fold"]) > 2 * NOISE
    assert abs(rows[13]["fold"]) < 0.5 * NOISE


def test_clouds_tell_well_separated_points_from_merged_ones():
    n = np.arange(3000)
    impacts = (n % 3 == 0).astype(int)
    dice = np.random.default_rng(0)
    level = np.array([0.0, 1.0, 5.0])[n % 3]
    near = clouds(level + 0.1 * dice.standard_normal(n.size), impacts, 3)
    # 90 % of a normal distribution lie within 3.29 standard deviations
    assert near["told_apart"] == pytest.approx(1 / 0.329, rel=0.05)
    assert near["separation"] == pytest.approx(1.0, abs=0.02)
    assert near["regular"] == 1.0
    far = clouds(level + 1.0 * dice.standard_normal(n.size), impacts, 3)
    assert far["told_apart"] < 0.5
    assert clouds(level, impacts, 4)["regular"] == 0.0


def test_json_has_the_promised_keys(tmp_path, capsys):
    arguments = ["--json", "--quick", "--out", str(tmp_path), "--set", "drive.frequencies_hz=[22.6, 23.4]"]
    code = sensitivity.main(arguments)
    answer = json.loads(capsys.readouterr().out)
    assert code == 0
    wanted = {
        "frequency_hz",
        "parameter",
        "change",
        "born_map",
        "born_single_mode",
        "born_beam",
        "fold_map",
        "fold_single_mode",
        "fold_beam",
    }
    assert all(wanted <= row.keys() for row in answer["rows"])
    assert {"schema", "answers"} <= answer.keys()
    assert answer["answers"]["changes_that_give_p10"] == []
    folder = tmp_path / "sensitivity"
    for name in ("fold_against_parameter.png", "strobe_points.png", "noise.png", "sensitivity.csv"):
        assert (folder / name).stat().st_size > 100


@pytest.mark.parametrize("setting", ["drive.kind=none", "spring.kind=modal_data"])
def test_wrong_input_gets_one_sentence(tmp_path, capsys, setting):
    assert sensitivity.main(["--out", str(tmp_path), "--set", setting]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert "Traceback" not in said
