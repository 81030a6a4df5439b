"""The scenes delivered besides the letter's: read, built, driven; and what they claim of themselves."""

import math
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import ANY

import numpy as np
import pytest

import contact
from contact import State, StroboscopicMap, first_collision, simulate
from contact.orbits import settle
from studies.experiment.trace import contact_force
from studies.letter import PERIODS
from studies.physics.one_mode import doubts, with_restitution
from studies.shell.scene import (
    SCENES,
    SceneError,
    beam_at,
    corresponding,
    model_of,
    nordmark_at,
    own_frequency,
    periods_of,
    read_scene,
    single_mode_at,
)
from studies.shell.scene.values import scene_from_text

OWN = sorted(path.stem for path in SCENES.glob("*.toml") if path.stem != "letter")
KEPT = "modes.count=8"


@pytest.mark.parametrize("name", OWN)
def test_eq_1_of_the_scene_is_its_first_mode_and_the_same_period_is_born_at_the_same_f_t(name):
    """The letter's universality: what its spring does at f T another spring does too, and the map says so."""
    scene = read_scene(name, [KEPT])
    model = model_of(scene)
    period = 2.0 * math.pi / math.sqrt(model.omega[0] ** 2 - (0.5 * model.decay_rate[0]) ** 2)
    assert scene.single_mode.free_period_s == pytest.approx(period, rel=5e-4)
    assert scene.single_mode.decay_rate_per_s == pytest.approx(model.decay_rate[0], rel=1e-3)
    for frequency, period in list(periods_of(scene).items())[:2]:
        strobed = StroboscopicMap(oscillator=beam_at(scene, frequency, model).with_excess(1e-3))
        settled = settle(strobed, strobed.steady(), most_cycles=4000)
        assert settled.m == period == contact.maximal_m(nordmark_at(scene, frequency))


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
    assert ran.code == 0 and ran.summary["m"] == ran.summary["letter"] == 4
    assert ran.summary["frequency_hz"] == pytest.approx(21.5 * 40.8 / 115.1, rel=1e-3)


CANTILEVER = """
[spring]
kind = "cantilever"
leg_length_m = 0.22
width_m = 0.02
thickness_m = 0.0015
tape_thickness_m = 0.0
[tip]
mass_kg = 0.0
[damping]
kind = "constant_ratio"
ratio = 0.005
[stop]
gap_m = 0.0008
[drive]
frequencies_hz = [18.0]
"""


def of_file(tmp_path, text, *overrides):
    """The scene in a file with this text."""
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return read_scene(path, overrides)


def test_eq_1_of_a_file_that_does_not_give_it_is_that_of_mode_1(tmp_path):
    """First root of cos z cosh z = -1; flexural rigidity E t^2/12 of a beam; c = 2 zeta omega."""
    scene = of_file(tmp_path, CANTILEVER, "modes.count=12")
    spring, z = scene.spring, 1.8751040687119611
    rigidity = spring.young_modulus_pa * spring.thickness_m**2 / 12.0
    omega = (z / spring.leg_length_m) ** 2 * math.sqrt(rigidity / spring.density_kg_m3)
    single = scene.single_mode
    assert single.free_period_s == pytest.approx(2.0 * math.pi / omega / math.sqrt(1.0 - 0.005**2), rel=1e-6)
    assert single.decay_rate_per_s == pytest.approx(2.0 * 0.005 * omega, rel=1e-6)
    assert not list(doubts(scene)) and scene.provenance()["single_mode.free_period_s"] == "mode 1"
    scene, sentence = with_restitution(scene)
    collision = first_collision(beam_at(scene, 18.0).with_excess(0.013))
    assert scene.single_mode.restitution == pytest.approx(collision.restitution, rel=1e-8)
    assert "of a first collision at 18 Hz" in sentence
    assert scene_from_text(scene.dump()) == scene


def test_a_letters_eq_1_for_another_spring_brings_a_sentence(tmp_path):
    given = "[single_mode]\nfree_period_s = 0.0408\ndecay_rate_per_s = 3.56\n"
    period, rate, *_ = doubts(of_file(tmp_path, CANTILEVER + given, "single_mode.restitution=0.1"))
    assert "free_period_s is 0.0408" in period and "decay_rate_per_s is 3.56" in rate
    measured = read_scene("measured_modes", ["single_mode.free_period_s=0.05"])
    assert "another spring than the beam" in next(doubts(measured))


ONE = (
    "modal_data.frequencies_hz=[5.0] modal_data.decay_rates_per_s=[0.8] modal_data.tip_values=[7.0] "
    "modal_data.participation=[0.17] modal_data.static_compliance_m_per_n=0 drive.frequencies_hz=[4.5] "
    "contact.law=newton contact.local_restitution=0.37"
)


def test_one_measured_mode_has_the_restitution_of_its_stop():
    opened = [f"single_mode.{key}=-1" for key in ("free_period_s", "decay_rate_per_s", "restitution")]
    scene = read_scene("measured_modes", [*ONE.split(" "), *opened])
    period = 2.0 * math.pi / math.sqrt((2.0 * math.pi * 5.0) ** 2 - 0.16)
    assert scene.single_mode.free_period_s == pytest.approx(period, rel=1e-8)
    assert scene.single_mode.decay_rate_per_s == 0.8
    assert with_restitution(scene)[0].single_mode.restitution == 0.37
    with pytest.raises(SceneError, match="restitution is open"):
        single_mode_at(scene, 4.5)
    with pytest.raises(SceneError, match="does not oscillate: give single_mode"):
        read_scene("measured_modes", [*ONE.split(" "), *opened, "modal_data.decay_rates_per_s=[99.0]"])


def test_a_collision_without_restitution_leaves_it_open_with_a_sentence(monkeypatch):
    scene = read_scene("letter", ["single_mode.restitution=-1", "modes.count=3"])
    gone = SimpleNamespace(restitution=math.nan)
    monkeypatch.setattr("studies.physics.one_mode.first_collision", lambda oscillator: gone)
    assert with_restitution(scene) == (scene, ANY) and "stays open" in with_restitution(scene)[1]


def test_a_study_of_one_frequency_takes_one_of_the_scene():
    for drives, own in {"[24.5]": 24.5, "[20, 22, 25]": 22.0}.items():
        assert own_frequency(read_scene("letter", [f"drive.frequencies_hz={drives}"]), 21.5) == own
    assert [own_frequency(read_scene(name), 21.5) for name in ("letter", "steel_ruler")] == [21.5, 7.62]


@pytest.mark.parametrize(
    "name, number, kind, error",
    [
        ("hunt_crossley", "dissipation_s_per_m=0.3", contact.HuntCrossley, 1e-6),
        ("tsuji", "local_restitution=0.5", contact.PowerContact, 1e-4),
    ],
)
def test_the_force_of_a_damped_law_changes_the_momentum_of_the_tip(name, number, kind, error):
    """v' = -c v - omega^2 u - phi N, integrated over the contact; N of Tsuji begins as time to the 1/4."""
    laws = [f"contact.law={name}", f"contact.{number}", "modes.count=1"]
    oscillator = beam_at(read_scene("letter", laws), 22.2)
    assert isinstance(oscillator.stop.law, kind)
    start = State(displacement=[0.0], velocity=[4.0 / oscillator.model.phi[0]])
    struck = simulate(replace(oscillator, drive=None), start, duration=0.05)
    begin, end = struck.impacts.start[0], struck.impacts.end[0]
    run = simulate(replace(oscillator, drive=None), start, duration=0.05, times=np.linspace(begin, end, 2001))
    model, u, v = oscillator.model, run.displacement[:, 0], run.velocity[:, 0]
    spring = model.omega[0] ** 2 * u + model.decay_rate[0] * v
    slopes = spring + model.phi[0] * contact_force(oscillator, run)
    assert np.trapezoid(slopes, run.time) == pytest.approx(v[0] - v[-1], rel=error)
    assert struck.impacts.peak_force[0] == pytest.approx(contact_force(oscillator, run).max(), rel=1e-5)
