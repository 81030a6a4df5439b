"""The six transitions under errors, noise and open assumptions."""

from __future__ import annotations

import pytest

from contact import StroboscopicMap
from contact.orbits import born, settle
from studies.experiment.sensitivity.changes import NAMES, PARAMETERS, changed, changes_of, row_at
from studies.experiment.sensitivity.p10 import causes_of
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S
from studies.physics.calibration import free_period
from studies.shell.scene import beam_at, single_mode_at


def single(scene, frequency):
    return StroboscopicMap(oscillator=single_mode_at(scene, frequency))


def change(scene, parameter, sign):
    return next(c for c in changes_of(scene) if (c.parameter, c.sign) == (parameter, sign))


@pytest.fixture(scope="module")
def last(letter_scene, letter_model):
    """23.40 Hz without a change, and with T at both ends of its error."""
    found = {0: row_at(letter_scene, letter_model, 23.40)}
    for way in (-1, 1):
        there, model = changed(letter_scene, change(letter_scene, "free period", way))
        found[way] = row_at(there, model, 23.40, found[0])
    return found


def test_nothing_within_the_error_of_the_free_period_gives_p10_at_grazing(last):
    for row in last.values():
        assert 10 not in (row.born_map, row.born_single_mode, row.born_beam)
        assert row.born_map == row.born_beam == 11


def test_a_shorter_free_period_deepens_the_hysteresis_in_all_descriptions(last):
    """f T falls: further below the upper edge of the band, where the fold leaves grazing as its square."""
    for name in NAMES:
        shorter, base, longer = (getattr(last[sign], f"fold_{name}") for sign in (-1, 0, 1))
        assert shorter < base < longer < 0
    edge = 22.0 / 23.0
    distance = {sign: edge - 23.40 * (40.80e-3 + sign * FREE_PERIOD_ERROR_S) for sign in (-1, 0, 1)}
    for sign in (-1, 1):
        ratio = last[sign].fold_map / last[0].fold_map
        assert ratio == pytest.approx((distance[sign] / distance[0]) ** 2, rel=0.05)


def test_p11_ends_above_the_noise_before_p10_is_born(letter_scene, letter_model):
    beam = beam_at(letter_scene, 23.40, letter_model)
    for strobed in (single(letter_scene, 23.40), StroboscopicMap(oscillator=beam)):
        eleven = born(strobed).end
        assert settle(strobed.at(5 * AMPLITUDE_STABILITY), eleven, most_cycles=4000).period == 11
        assert settle(strobed.at(16 * AMPLITUDE_STABILITY), eleven, most_cycles=4000).period != 11


def test_a_changed_spring_keeps_its_period_and_the_rate_of_mode_1(letter_scene, letter_model):
    period = free_period(letter_scene)
    for parameter in ("mass of ball and mount", "damping of higher modes"):
        there, modes = changed(letter_scene, change(letter_scene, parameter, 1))
        assert free_period(there) == pytest.approx(period, rel=1e-9)
        assert modes.decay_rate[0] == pytest.approx(letter_model.decay_rate[0], rel=1e-9)
    assert modes.decay_rate[1:] == pytest.approx(2.0 * letter_model.decay_rate[1:], rel=1e-12)
    shorter, _ = changed(letter_scene, change(letter_scene, "free period", -1))
    assert free_period(shorter) == pytest.approx(40.78e-3, rel=1e-9)
    faster, modes = changed(letter_scene, change(letter_scene, "decay rate of mode 1", 1))
    assert modes.decay_rate[0] == pytest.approx(faster.single_mode.decay_rate_per_s, rel=1e-9)


def test_each_parameter_is_lowered_and_raised_but_for_tape_beyond_the_leg(letter_scene):
    assert len(changes_of(letter_scene.replace({"spring.tape_coverage": 0.5}))) == 2 * len(PARAMETERS)
    covered = changes_of(letter_scene.replace({"spring.tape_coverage": 1.0}))
    assert [c.sign for c in covered if "coverage" in c.parameter] == [-1]


def test_the_fold_of_eq_1_and_map_know_nothing_of_the_higher_modes(letter_scene, letter_model):
    base = row_at(letter_scene, letter_model, 20.90)
    row = row_at(*changed(letter_scene, change(letter_scene, "damping of higher modes", 1)), 20.90, base)
    assert (row.fold_map, row.fold_single_mode) == (base.fold_map, base.fold_single_mode)
    assert abs(row.fold_beam / base.fold_beam - 1) > 0.05


def test_small_form(run_study, monkeypatch):
    monkeypatch.setattr(
        "studies.experiment.sensitivity.__main__.causes_of", lambda *given: causes_of(*given)[:2]
    )
    ran = run_study("sensitivity", "--quick", "--set", "drive.frequencies_hz=[23.4]")
    assert ran.code == 0 and len(ran.summary["rows"]) == 1 + 8
    assert len(ran.rows("p10")) == 2 and ran.summary["p10"][1]["born"] == [11, 11, 10, 10]
    assert "Eq. (1), 4." in ran.summary["answers"]["last_period"]
