"""The main job: the letter's six transitions in four descriptions."""

import json

import pytest
from conftest import verdicts_on
from oscillators import slow

from contact.orbits import Shooting, fold_excess, fold_of, onset_m, onset_orbit, orbit_end, settle
from contact.orbits.branches.amplitude_curve import whole_branch
from studies.experiment.transitions.model import rows_at
from studies.letter import PERIODS
from studies.physics.descriptions import TITLES, strobed_at
from studies.shell.scene import beam_at, model_of, read_scene
from studies.shell.scene.keys import MODE_LISTS

EXPECTED = {20.90: 3, 21.50: 4, 22.20: 5, 22.60: 6, 23.05: 8, 23.40: 11}
"""m of the map, of Eq. (1) and of the beam; the letter saw 10 at the last."""


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_no_period_of_the_letter_stands_beside_another_spring():
    scene = read_scene("steel_ruler", ["modes.count=2", "scan.settle_cycles=1"])
    assert [row.letter for row in rows_at(scene, 22.2, model_of(scene)).rows] == [None] * 4


def test_eq_1_and_the_beam_show_p10_above_grazing_where_the_letter_did(letter_scene, letter_model):
    for name in ("single_mode", "beam"):
        assert onset_m(strobed_at(name, letter_scene, 23.40, letter_model), 1e-2) == PERIODS[23.40]


@pytest.mark.parametrize("frequency", [20.90, *slow(*sorted(PERIODS.keys() - {20.90}))])
def test_the_orbits_end_where_the_closed_forms_say(letter_scene, letter_model, frequency):
    for name in ("map", "single_mode"):
        strobed = strobed_at(name, letter_scene, frequency)
        exact = fold_excess(strobed, EXPECTED[frequency])
        assert fold_excess(strobed, 0) is fold_excess(strobed, 1) is None  # 0: the motion did not settle
        end = orbit_end(strobed, onset_orbit(strobed).end, 1e-3, most_cycles=1000)
        assert end.lost <= exact <= end.held and end.held - end.lost <= 0.0101 * abs(end.held), name
        assert end.kind == "fold" and end.excess == pytest.approx(exact, rel=1e-10), name


def test_the_beams_p8_ends_where_another_touch_grazes(letter_scene, letter_model):
    """23.05 Hz: by the scan, by the branch, and by settling beside the end without either.

    Below it the tip touches softly once in every period; its orbit is settled on when it repeats to a part in
    a thousand of the excess, as the peak over the wall is.
    """
    strobed = strobed_at("beam", letter_scene, 23.05, letter_model)
    state = onset_orbit(strobed).end
    end = orbit_end(strobed, state, 1e-3, most_cycles=1000)
    assert end.kind == "grazing" and end.lost < end.excess < end.held
    branch = whole_branch(Shooting(oscillator=strobed.oscillator, m=8), None)[2]
    lowest = min(branch.events, key=lambda event: event.orbit.excess)
    assert (lowest.kind, lowest.orbit.excess) == ("grazing", pytest.approx(end.excess, rel=1e-8))
    assert end.excess == pytest.approx(1.3799e-6, rel=1e-3)
    seen = {}
    for excess in (2e-6, 1.39e-6, 1.37e-6, 1e-6, 3e-7, 1e-7):
        limits = dict(most_cycles=6000, tolerance=1e-3 * excess)
        settled = settle(strobed.at(excess), end.state, prove=False, **limits)
        seen[excess] = settled.m, settled.impacts
    assert seen == {2e-6: (8, 1), 1.39e-6: (8, 1), 1.37e-6: (8, 2), 1e-6: (1, 1), 3e-7: (1, 1), 1e-7: (1, 1)}


def test_the_small_form_and_own_modes_that_give_the_same_orbit(run_study):
    """The second spring is given by the modes of the first, as if they were measured."""
    ran = run_study("transitions", "--quick", "--json", "--set=scan.points=5")
    assert ran.code == 0 and json.loads(ran.out)["rows"] == ran.summary["rows"]
    assert ran.verdicts == verdicts_on("transitions")
    assert [row["description"] for row in ran.rows("transitions")] == 6 * list(TITLES)
    assert all(row["m"] == EXPECTED[row["frequency_hz"]] for row in ran.summary["rows"])
    rows = {row["description"]: row for row in ran.summary["rows"] if row["frequency_hz"] == 22.2}
    count = f"modes.count={ran.summary['modes']}"
    scene = read_scene("letter", [count])
    model = model_of(scene)
    fold = fold_of(Shooting(oscillator=beam_at(scene, 22.2, model), m=5))
    assert rows["beam"]["end_speed"] == pytest.approx(abs(fold.speed), rel=1e-4)
    assert rows["map"]["exact"] == pytest.approx(rows["map"]["excess_down"], rel=1e-9)
    points = [row for row in ran.rows("orbit_diagram") if float(row["frequency_hz"]) == 22.2]
    beams = [row for row in points if row["description"] == "beam"]
    assert {row["m"] for row in beams if row["direction"] == "down"} <= {"0", "1", "5"}
    scan = [row for row in beams if row["direction"] == "up"]
    assert len({row["excess"] for row in scan}) == 5 and float(scan[0]["excess"]) < 0.0
    strobes = [row["strobe"] for row in scan if row["excess"] == scan[-1]["excess"]]
    assert scan[-1]["m"] == "5" and strobes == ["0", "1", "2", "3", "4"]
    top = max(float(row["amplitude_m"]) / (1.0 + float(row["excess"])) for row in points)
    assert top == pytest.approx(max(row["grazing_amplitude"] for row in rows.values()), rel=1e-12)
    lists = (model.frequencies_hz, model.decay_rate, model.phi, model.participation)
    given = tuple(f"modal_data.{key}={one.tolist()}" for key, one in zip(MODE_LISTS, lists, strict=True))
    given += "scan.points=5", "drive.frequencies_hz=[22.2]", "spring.kind=modal_data", count
    given += (f"modal_data.tip_mass_kg={scene.tip.mass_kg}",)
    ran = run_study("transitions", "--quick", *(f"--set={key}" for key in given))
    *_, row = ran.summary["rows"]
    assert ran.code == 0 and (row["description"], row["m"]) == ("beam", 5)
    assert row["excess_down"] == pytest.approx(rows["beam"]["excess_down"], rel=1e-9)
