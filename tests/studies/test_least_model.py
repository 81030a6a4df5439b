"""The least number of modes: as good as is needed, no more, and checked against following the orbits."""

import math
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from oscillators import slow

from contact import Chatter, HarmonicDrive, StroboscopicMap, first_collision
from contact.orbits import Shooting, fold_of, onset_m, onset_orbit
from studies.experiment.hysteresis.__main__ import hysteresis
from studies.experiment.time_trace.__main__ import conditions, time_trace
from studies.experiment.transitions.__main__ import ends_beside_folds, transitions
from studies.letter import AMPLITUDE_STABILITY
from studies.physics.descriptions import born_and_lowered, or_none
from studies.physics.least_model import LADDER, Question, least_modes, questions, reference_of
from studies.shell.scene import Scene, beam_at, corresponding, read_scene

#: What a search over modes, meshes and laws that followed every orbit found for the letter's scene.
BY_SEARCH = [({"frequency 10": 1e-3}, 10), ({"frequency 1": 1e-5, "kick": 0.005}, 12)]
BY_SEARCH += slow(({"born_period": 0.0, "fold": 0.07}, 10))


@pytest.mark.parametrize(("needs", "modes"), BY_SEARCH)
def test_the_choice_is_that_of_the_long_search(letter_scene, needs, modes):
    scene, sentence = least_modes(letter_scene, needs)
    assert scene.modes.count == modes and f" {modes} " in sentence
    assert scene.provenance()["modes.count"] == "least"


@pytest.mark.parametrize("frequency", [21.50, *slow(22.20)])
def test_errors_of_folds_from_kicks_are_those_of_the_orbits_themselves(letter_scene, frequency):
    """Folds by shooting and continuation, an independent route, with 12 and 40 modes."""
    whole, found = reference_of(letter_scene), {}
    for modes in (12, 40):
        oscillator = beam_at(letter_scene, frequency, whole.truncated(modes)).with_excess(1e-3)
        period = onset_m(StroboscopicMap(oscillator=oscillator))
        found[modes] = fold_of(Shooting(oscillator=oscillator, m=period)).excess
    error = abs(found[12] / found[40] - 1.0)
    here = letter_scene.replace({"drive.frequencies_hz": (frequency,)})
    (question,) = questions(here, {"fold": 0.0}, whole)
    assert question.off(12) == pytest.approx(error, rel=0.12)


@pytest.mark.slow
def test_the_reference_is_good_to_the_third_of_a_percent(letter_scene, monkeypatch):
    """40 modes against 60: the folds differ by less than what the loosest and the tightest study needs."""
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


def test_a_spring_of_ones_own_gets_its_own_number_and_a_tolerance_too_tight_is_said():
    ruler = read_scene("steel_ruler")
    scene, _ = least_modes(ruler, {"kick": 0.005})
    assert scene.modes.count in LADDER and scene.modes.count > 15
    scene, sentence = least_modes(ruler, {"fold": 0.05})
    # its p4 has two impacts and ends by a torus at -1.7e-3; the fold of kicks, at -2.0e-2, says nothing of it
    assert scene.modes.count == 40 and "for fold at 7.62 Hz" in sentence
    scene, sentence = least_modes(ruler, {"kick": 1e-12})
    assert scene.modes.count == 40 and "all that were tried" in sentence


def test_a_coarse_mesh_or_few_measured_rates_bound_the_reference(letter_scene):
    rates = {"damping.kind": "measured", "damping.measured_rates_per_s": [3.56, 20.0, 50.0]}
    few = letter_scene.replace(rates)
    assert least_modes(few, {"kick": 1e-12})[0].modes.count == 3
    coarse = letter_scene.replace({"spring.elements_per_leg": 2, "spring.elements_on_arc": 1})
    assert reference_of(coarse).n_modes < 40


@pytest.mark.parametrize("least", [3, 10, 40])
def test_a_number_of_modes_that_is_good_by_chance_is_not_taken(letter_scene, monkeypatch, least):
    """One mode gives it, where errors cancel, and two do not; a quantity that needs three comes first."""
    off = [lambda modes, low=low: float(1 < modes < low) for low in (3, least)]
    both = [Question("kick at 22.2 Hz", 0.5, each) for each in off]
    monkeypatch.setattr("studies.physics.least_model.questions", lambda *_: both)
    assert least_modes(letter_scene, {"kick": 0.5})[0].modes.count == least


def test_an_unknown_quantity_is_refused(letter_scene):
    with pytest.raises(ValueError, match="colour"):
        least_modes(letter_scene, {"colour": 0.1})


def test_where_the_reference_has_no_fold_its_first_collision_chooses(letter_scene):
    """At f T = 0.9996 nothing has a fold; one mode would leave a restitution of 0.99999 for 0.977."""
    near = letter_scene.replace({"drive.frequencies_hz": (24.5,)})
    scene, sentence = least_modes(near, {"fold": 0.05})
    assert scene.modes.count == 12 and "no fold at 24.5 Hz: response and first collision" in sentence


def test_modes_are_chosen_at_the_drive_and_excess_of_the_command_and_reach_above_it(letter_scene):
    needs, options = {"kick": 0.005}, {"frequency": 40.0, "excess": 0.2}
    frequencies, excess = conditions(letter_scene, options)
    assert (frequencies, excess) == ([40.0], 0.2)
    scene, sentence = least_modes(letter_scene, needs, frequencies, excess)
    whole = reference_of(letter_scene)
    assert " at 40 Hz" in sentence and whole.frequencies_hz[scene.modes.count - 1] > 40.0
    quiet, sentence = least_modes(letter_scene, {"tip_trace": 2e-3}, [40.0], -0.5)
    assert quiet.modes.count <= 3 and "tip_trace at 40 Hz" in sentence


def test_where_no_collision_ends_all_modes_are_kept(letter_scene, monkeypatch):
    def endless(oscillator):
        raise Chatter(time=0.0, gap=0.0, velocity=0.0)

    monkeypatch.setattr("studies.physics.least_model.first_collision", endless)
    scene, sentence = least_modes(letter_scene, {"kick": 0.005})
    assert scene.modes.count == 40 and "all that were tried, for kick at 22.2 Hz; no kick at" in sentence


def drawn(seed: int) -> tuple[Scene, float, float]:
    """A spring with a law, a drive frequency and an excess that a user could have."""
    rng = np.random.default_rng(seed)
    changes = {
        "spring.kind": str(rng.choice(["flat_u", "cantilever"])),
        "contact.law": str(rng.choice(["hertz", "linear", "newton", "hunt_crossley"])),
        "spring.leg_length_m": rng.uniform(0.08, 0.25),
        "spring.thickness_m": rng.uniform(0.0006, 0.002),
        "tip.mass_kg": rng.choice([0, 1]) * rng.uniform(0.001, 0.012),
        "damping.kind": "constant_ratio",
        "damping.ratio": 10 ** rng.uniform(-2.7, -1.5),
        "contact.local_restitution": rng.uniform(0.2, 1.0),
        "contact.dissipation_s_per_m": rng.uniform(0.0, 1.0),
        "contact.stiffness_n_per_m": 10 ** rng.uniform(4.0, 6.5),
        "stop.gap_m": 10 ** rng.uniform(-3.5, -2.0),
        **{f"single_mode.{key}": -1 for key in ("free_period_s", "decay_rate_per_s", "restitution")},
    }
    scene = read_scene("letter", [f"{key}={value}" for key, value in changes.items()])
    frequency = rng.uniform(0.7, 1.15) / scene.single_mode.free_period_s
    return scene.replace({"drive.frequencies_hz": (frequency,)}), frequency, 10 ** rng.uniform(-3.0, -0.5)


def of_time_trace(scene, oscillator, excess):
    """Period and impacts of the settled motion; kick and restitution of a first collision."""
    orbit = onset_orbit(StroboscopicMap(oscillator=oscillator), excess)
    struck = first_collision(oscillator.with_excess(excess))
    same = (orbit.m, orbit.m and orbit.impacts)
    return same, [(struck.kick, 0.005), (struck.restitution, 0.01)]


def of_transitions(scene, oscillator, excess):
    """The born orbit, and its end in a downward scan.  A warning names an end that is no fold."""
    orbit, end = born_and_lowered(StroboscopicMap(oscillator=oscillator), 1e-3, 1000)
    same = (orbit.m, orbit.m and orbit.impacts)
    fold = math.nan if end is None else end.excess
    row = SimpleNamespace(description="beam", frequency_hz=1.0, ends_by=end and end.kind)
    return same, [] if ends_beside_folds([row]) else [(fold, 0.07 * max(abs(fold), AMPLITUDE_STABILITY))]


def of_hysteresis(scene, oscillator, excess):
    """The fold of p5 where the letter has one, by shooting."""
    there = replace(oscillator, drive=HarmonicDrive(frequency=corresponding(scene, 22.2)))
    fold = or_none(fold_of, Shooting(oscillator=there, m=5))
    found = fold.excess if fold is not None and fold.admissible else math.nan
    return (), [(found, 0.05 * max(abs(found), AMPLITUDE_STABILITY))]


STUDIES = [(time_trace, of_time_trace), (transitions, of_transitions), (hysteresis, of_hysteresis)]
DRAWN = [(3, 0), (11, 1), (11, 2)]
LONG = slow(*product(range(40), range(3)))


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
@pytest.mark.parametrize(("seed", "number"), DRAWN + LONG)
def test_what_a_study_prints_of_a_drawn_scene_is_that_of_the_reference(seed, number):
    """By routes of their own: settled motions, downward scans, shooting.

    A motion without a period is said to have none, and is compared in its first collision.
    """
    scene, frequency, excess = drawn(seed)
    study, found = STUDIES[number]
    options = {"frequency": frequency, "excess": excess}
    kept = least_modes(scene, study.needs, *(study.at(scene, options) if study.at else ()))[0].modes.count
    whole = reference_of(scene)
    if kept == whole.n_modes:
        return
    beams = (beam_at(scene, frequency, model) for model in (whole.truncated(kept), whole))
    (same, values), (sharp_same, sharp) = (found(scene, beam, excess) for beam in beams)
    assert same == sharp_same
    for (value, _), (expected, tolerance) in zip(values, sharp, strict=False):
        assert value == pytest.approx(expected, abs=tolerance, nan_ok=True)
