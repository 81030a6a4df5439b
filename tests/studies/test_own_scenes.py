"""The scenes delivered besides the letter's: read, built, driven; and what they claim of themselves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact import StroboscopicMap, first_collision, maximal_period
from contact.orbits import settle
from studies.letter import PERIODS
from studies.shell.scene import SCENES, beam_at, corresponding, model_of, nordmark_at, periods_of, read_scene

OWN = sorted(path.stem for path in SCENES.glob("*.toml") if path.stem != "letter")
KEPT = "modes.count=8"


@pytest.mark.parametrize("name", OWN)
def test_eq_1_of_the_scene_is_its_first_mode(name):
    scene = read_scene(name, [KEPT])
    model = model_of(scene)
    period = 2.0 * math.pi / math.sqrt(model.omega[0] ** 2 - (0.5 * model.decay_rate[0]) ** 2)
    assert scene.single_mode.free_period_s == pytest.approx(period, rel=5e-4)
    assert scene.single_mode.decay_rate_per_s == pytest.approx(model.decay_rate[0], rel=1e-3)


@pytest.mark.parametrize("name", OWN)
def test_the_same_period_is_born_at_the_same_f_t(name):
    """The letter's universality: what its spring does at f T another spring does too, and the map says so."""
    scene = read_scene(name, [KEPT])
    model = model_of(scene)
    for frequency, period in list(periods_of(scene).items())[:2]:
        strobed = StroboscopicMap(oscillator=beam_at(scene, frequency, model).with_excess(1e-3))
        settled = settle(strobed, strobed.steady(), most_cycles=4000)
        assert settled.period == period == maximal_period(nordmark_at(scene, frequency))


def test_the_ruler_bounces_as_its_comment_says():
    scene = read_scene("steel_ruler", ["modes.count=30"])
    frequency = scene.drive.frequencies_hz[0]
    collision = first_collision(beam_at(scene, frequency, model_of(scene)).with_excess(0.013))
    assert collision.restitution == pytest.approx(scene.single_mode.restitution, abs=0.001)
    assert np.allclose(scene.drive.frequencies_hz, list(periods_of(scene)), rtol=2e-3)


def test_the_letters_frequencies_are_its_own():
    letter = read_scene("letter", [])
    assert [corresponding(letter, f) for f in PERIODS] == list(PERIODS)


@pytest.mark.slow
def test_a_study_of_one_frequency_takes_the_corresponding_one(run_study):
    ran = run_study("time_trace", "--scene", "steel_ruler", "--set", KEPT)
    assert ran.code == 0 and ran.summary["period"] == ran.summary["letter"] == 4
    assert ran.summary["frequency_hz"] == pytest.approx(21.5 * 40.8 / 115.1, rel=1e-3)
