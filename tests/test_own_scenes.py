"""The scenes delivered besides the letter's: read, built, driven; and what they claim of themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact import StroboscopicMap, first_collision, maximal_period
from contact.orbits.settling import settle
from studies import time_trace
from studies.instruments.corresponding import corresponding, periods_of
from studies.instruments.oscillators import beam_of, nordmark_of
from studies.instruments.scene_file import SCENES, dump_scene, read_scene
from studies.instruments.spring_of_scene import model_of
from studies.published import PERIODS

OWN = sorted(path.stem for path in SCENES.glob("*.toml") if path.stem != "letter")
KEPT = "modes.count=8"


def test_there_are_scenes_of_ones_own_to_start_from():
    assert {"steel_ruler", "measured_modes"} <= set(OWN)


@pytest.mark.parametrize("name", OWN)
def test_eq_1_of_the_scene_is_its_first_mode(name):
    scene = read_scene(name, [KEPT])
    model = model_of(scene)
    period = 2.0 * math.pi / math.sqrt(model.omega[0] ** 2 - (0.5 * model.decay_rate[0]) ** 2)
    assert scene.single_mode.free_period_s == pytest.approx(period, rel=5e-4)
    assert scene.single_mode.decay_rate_per_s == pytest.approx(model.decay_rate[0], rel=1e-3)


@pytest.mark.parametrize("name", OWN)
def test_it_comes_back_from_its_own_dump(name, tmp_path):
    scene = read_scene(name, [])
    path = tmp_path / "again.toml"
    path.write_text(dump_scene(scene), encoding="utf-8")
    assert read_scene(str(path), []).fingerprint() == scene.fingerprint()


@pytest.mark.parametrize("name", OWN)
def test_the_same_period_is_born_at_the_same_f_t(name):
    """The letter's universality: what its spring does at f T another spring does too, and the map says so."""
    scene = read_scene(name, [KEPT])
    model = model_of(scene)
    for frequency, period in list(periods_of(scene).items())[:4]:
        strobed = StroboscopicMap(oscillator=beam_of(scene, frequency, model).with_excess(1e-3))
        settled = settle(strobed, strobed.steady(), most_cycles=4000)
        assert settled.period == period == maximal_period(nordmark_of(scene, frequency))


def test_the_ruler_bounces_as_its_comment_says():
    scene = read_scene("steel_ruler", ["modes.count=30"])
    frequency = scene.drive.frequencies_hz[0]
    collision = first_collision(beam_of(scene, frequency, model_of(scene)).with_excess(0.013))
    assert collision.restitution == pytest.approx(scene.single_mode.restitution, abs=0.001)
    assert np.allclose(scene.drive.frequencies_hz, list(periods_of(scene)), rtol=2e-3)


def test_the_letters_frequencies_are_its_own():
    letter = read_scene("letter", [])
    assert [corresponding(letter, f) for f in PERIODS] == list(PERIODS)


def test_a_study_of_one_frequency_takes_the_corresponding_one(tmp_path, capsys):
    assert time_trace.main(["--scene", "steel_ruler", "--set", KEPT, "--out", str(tmp_path), "--quick"]) == 0
    said = capsys.readouterr()
    assert "p4; the letter has p4" in said.out + said.err
