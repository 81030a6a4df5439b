"""The settled orbit against time: its period, its collision, its spectrum, and what the study writes."""

from dataclasses import fields

import numpy as np
import pytest
from conftest import verdicts_on
from PIL import Image

from contact import Collision, StroboscopicMap, first_collision
from contact.collision import before_collision
from contact.orbits import onset_orbit
from studies.experiment.period_map import SimulatedMap
from studies.experiment.trace import WORDS, close_up
from studies.shell.painter import GRAPH_HEIGHT, HEIGHT, WIDTH
from studies.shell.scene import beam_at, single_mode_of


def test_the_orbit_of_figure_4_the_ringing_of_its_impact_and_its_film(run_study):
    at_the_ball = "--set", "readout.arc_fraction=1.0"
    ran = run_study("time_trace", "--quick", *at_the_ball, "--film", "--frames", "8", "--style", "slide")
    summary = ran.summary
    assert (ran.code, summary["m"], summary["impacts"]) == (0, 4, 1)
    times = summary["impact_times_s"]
    assert len(times) == 2 and times[1] - times[0] == pytest.approx(4 / 21.5, rel=1e-8)
    assert summary["rows"][0]["energy_to_higher_modes"] > 0.0
    modes = {peak["mode"]: peak for peak in summary["peaks"] if peak["mode"]}
    for number, peak in modes.items():
        assert abs(peak["frequency_hz"] - summary["modes_hz"][number - 1]) <= 21.5
        # all lines are multiples of the inverse orbit period
        line = peak["frequency_hz"] * 4 / 21.5
        assert line == pytest.approx(round(line), abs=1e-6)
    amplitudes = [modes[number]["amplitude"] for number in (1, 2, 3, 4, 5)]
    assert amplitudes == sorted(amplitudes, reverse=True)
    readout = ran.arrays("time_trace")["readout_m"]
    half = readout.size // 2
    # the second orbit period repeats the first: a settled orbit, and a spectrum without leakage
    assert np.max(np.abs(readout[half:] - readout[:half])) < 1e-8 * np.max(np.abs(readout))
    assert ran.verdicts == verdicts_on("time_trace") and summary["findings"][0].endswith(", with one impact.")
    assert len(list((ran.folder / "motion_frames").glob("*.vtu"))) == 8
    with Image.open(ran.folder / "motion.gif") as found:
        assert found.n_frames == 8 and found.size == (WIDTH, HEIGHT + GRAPH_HEIGHT)
    assert {"motion.gif", "motion.pvd"} <= set(ran.manifest["files"])
    assert WORDS.keys() == {field.name for field in fields(Collision)}


def test_below_grazing_there_is_no_impact_and_one_line(run_study, letter_scene):
    ran = run_study("time_trace", "--excess", "-0.01")
    found, readout = ran.summary, ran.arrays("time_trace")["readout_m"]
    assert (found["m"], found["impacts"], found["rows"]) == (1, 0, [])
    assert [round(peak["frequency_hz"], 6) for peak in found["peaks"]] == [21.5]
    assert found["peaks"][0]["amplitude"] == pytest.approx(0.5 * np.ptp(readout), rel=1e-3)
    kept = beam_at(letter_scene.replace({"modes.count": len(found["modes_hz"])}), 21.5)
    base = 0.99 * letter_scene.stop.gap_m / abs(kept.tip_response())
    size = (2.0 * np.pi * 21.5) ** 2 * base / 9.80665
    said = found["drive_amplitude_m"], found["drive_acceleration_g"]
    assert said == pytest.approx((base, size), rel=1e-6)


COARSE = (
    "spring = {elements_per_leg = 20, elements_on_arc = 12}\nmodes.count = 4\ndrive.frequencies_hz = [21.5]"
)


def test_a_spring_between_two_plates_touches_both(run_study, tmp_path):
    scene = tmp_path / "two_sides.toml"
    scene.write_text(f"{COARSE}\n[[stops]]\ngap_m = 0.012")
    options = "--quick", "--excess", "0.01", "--scene", str(scene), "--film", "--frames", "4"
    ran = run_study("time_trace", *options)
    summary, (time, tip) = ran.summary, (ran.arrays("time_trace")[name] for name in ("time_s", "tip_m"))
    assert (ran.code, summary["m"], summary["impacts"], summary["letter"]) == (0, 7, 2, None)
    assert [row["stop"] for row in summary["rows"]] == [int(row["stop"]) for row in ran.rows("impacts")]
    assert {row["stop"] for row in summary["rows"]} == {0, 1} and len(summary["rows"]) == 4
    assert all(row["approach"] > 0.0 > row["rebound"] > -row["approach"] for row in summary["rows"])
    begin = summary["rows"][0]["start"] - summary["impact_times_s"][0]
    for stop, gap in enumerate((0.011883925614219, -0.012)):
        past = begin + time[tip / gap > 1.0]
        spans = [(row["start"], row["end"]) for row in summary["rows"] if row["stop"] == stop]
        inside = [(first <= past) & (past <= last) for first, last in spans]
        assert past.size and np.all(np.any(inside, axis=0))
    assert not (ran.folder / "collisions.csv").exists()
    assert run_study("transitions", "--scene", str(scene)).code == 2


def test_the_simulated_map_is_the_period_map_of_one_stop(letter_scene):
    oscillator = beam_at(letter_scene.replace({"modes.count": 3}), 21.5).with_excess(0.013)
    simulated, compiled = SimulatedMap(oscillator=oscillator), StroboscopicMap(oscillator=oscillator)
    start = simulated.steady()
    found, expected = simulated.orbit(start, 60), compiled.orbit(start, 60)
    assert found.impacts.tolist() == expected.impacts.tolist() and found.impacts.sum() > 5
    np.testing.assert_allclose(found.points, expected.points, atol=1e-9 * simulated.scale)
    settled = [onset_orbit(each, 0.013) for each in (simulated, compiled)]
    assert settled[0].m == settled[1].m > 1 and settled[0].impacts == settled[1].impacts


def driven(scene, law, excess):
    """Eq. (1) with this contact law at 21.50 Hz."""
    changed = scene.replace({f"contact.{key}": value for key, value in law.items()})
    return beam_at(changed, 21.5, single_mode_of(scene)).with_excess(excess)


def test_the_close_up_shows_the_force_of_the_law(letter_scene):
    stiffness = 1e8
    oscillator = driven(letter_scene, {"law": "linear", "stiffness_n_per_m": stiffness}, 0.013)
    collision = first_collision(oscillator)
    near = close_up(oscillator, before_collision(oscillator), collision)
    assert near.spans[0][0] == pytest.approx(0.0, abs=1e-12)
    touching = near.height > 1e-12
    assert np.allclose(near.force[touching], stiffness * near.height[touching], rtol=1e-9)
    assert np.all(near.force[near.height < -1e-12] == 0.0)
    # momentum: what the force takes from the unit mass is the kick
    step = near.time[1] - near.time[0]
    assert step * near.force.sum() == pytest.approx(collision.kick_velocity, rel=2e-3)


def test_an_impact_law_has_no_force(letter_scene):
    oscillator = driven(letter_scene, {"law": "newton", "local_restitution": 0.1}, 0.005)
    near = close_up(oscillator, before_collision(oscillator), first_collision(oscillator))
    assert np.all(np.isnan(near.force)) and near.spans[0] == pytest.approx((0.0, 0.0), abs=1e-12)
