"""Whether the spring of a scene may be taken as linear at its gap: kappa, effective periods, what is born."""

import pytest

from beam import FiniteRotation
from studies.shell.scene import (
    beyond_linear,
    nonlinear_mode_at,
    period_shifts,
    read_scene,
    shift_at_gap,
    spring_of,
)
from studies.spring.shape.finite_amplitude import effective, frame_period, matched, reading_of, survivals

OTHER_BALL = 6e-3  # of the springs whose frame is not solved [kg]

SPRINGS = {"wide": ("folded", 0.03, OTHER_BALL), "legs": ("side_by_side", 9e-3, OTHER_BALL)}


FOLDED = read_scene("tight_fold")  # a strip with a tight bend


def test_a_tight_fold_softens_and_loses_the_letters_periods():
    """kappa -1.014 and 41.315 ... 41.359 ms, found by a planar frame that is not ours; the first and last."""
    ends = FOLDED.replace({"drive.frequencies_hz": [20.90, 23.40]})
    small, row = survivals(ends, (4e-3, FOLDED.stop.gap_m), ("folded", 7.5e-3, FOLDED.tip.mass_kg))
    assert row.kappa == pytest.approx(-1.014, rel=2e-3)
    assert list(row.effective_period_s.values()) == pytest.approx([41.315e-3, 41.359e-3], abs=0.005e-3)
    assert row.survive == 0 and row.born_period["at_20.9_Hz"] != 3 == small.born_period["at_20.9_Hz"]


def test_legs_side_by_side_and_a_wide_bend_keep_them():
    (legs,), (wide,) = (survivals(FOLDED, (FOLDED.stop.gap_m,), SPRINGS[name]) for name in ("legs", "wide"))
    assert 0.019 < legs.kappa < 0.026
    assert legs.survive == wide.survive == 5 and list(legs.born_period.values())[:5] == [3, 4, 5, 6, 8]


@pytest.mark.slow
def test_mode_and_frame_agree_where_both_are_nearly_linear():
    """To 0.005 ms of the legs and the wide bend; 0.035 ms of 0.5 ms for the tight one."""
    tight = ("folded", 7.5e-3, FOLDED.tip.mass_kg)
    for spring, close in ((tight, 0.035e-3), *((one, 0.005e-3) for one in SPRINGS.values())):
        drawn = reading_of(FOLDED, *spring)
        frame = frame_period(drawn, FiniteRotation.of(spring_of(drawn), 16), 22.2)
        assert effective(nonlinear_mode_at(drawn, 22.2)) == pytest.approx(frame, abs=close)


def test_a_mode_is_given_the_frames_period():
    spring = spring_of(FOLDED)
    mode = nonlinear_mode_at(FOLDED, 22.2)
    wanted = frame_period(FOLDED, FiniteRotation.of(spring, 8), 22.2)
    assert matched(mode, wanted).effective_period == pytest.approx(wanted, rel=1e-9)


def test_a_scene_beyond_its_linear_model_says_so(letter_scene, run_study):
    sentence = beyond_linear(FOLDED)
    assert sentence and "stop.gap_m" in sentence and "-0.69%" in sentence and "20.9, 21.5, 22.2" in sentence
    short = ["stability", "--quick", "--families", "false_restitution"]
    assert sentence in run_study(*short, "--scene", "tight_fold").summary["warnings"]
    assert beyond_linear(letter_scene) is None and 0.0 < shift_at_gap(letter_scene) < 2e-4
    assert not run_study(*short).summary["warnings"]
    assert beyond_linear(FOLDED.replace({"drive.kind": "none"})) is None
    shorter = [shift for shift, _ in period_shifts(letter_scene).values()]
    assert -1e-3 < shorter[0] < shorter[-1] < -5e-4  # off resonance the leaf's two parts do not cancel
    assert all(abs(shift) < 0.3 * bound for shift, bound in period_shifts(letter_scene).values())


def test_measured_modes_bring_their_own_kappa():
    scene = read_scene("measured_modes")
    assert shift_at_gap(scene) == 0.0 and beyond_linear(scene) is None
    length = 10.0 * scene.stop.gap_m
    bent = scene.replace({"modal_data.kappa": -1.0, "modal_data.kappa_length_m": length})
    assert shift_at_gap(bent) == pytest.approx(-0.01, rel=1e-12)
    assert "-1.00%" in (beyond_linear(bent) or "")
