"""The settled orbit against time: its period, its collision, its spectrum, and what the study writes."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from beam import single_mode
from contact.collision import before_collision, first_collision
from contact.drive import HarmonicDrive
from contact.laws import LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from studies import time_trace
from studies.instruments.settled_trace import close_up, settled_state, trace_of
from studies.instruments.spectrum import lines_of, peaks_of

COARSE = ("--set", "spring.elements_per_leg=30", "--set", "spring.elements_on_arc=16")


@pytest.fixture(scope="module")
def letter(tmp_path_factory):
    """The study on the letter's scene, and its folder."""
    out = tmp_path_factory.mktemp("trace")
    assert time_trace.main(["--out", str(out), *COARSE]) == 0
    folder = out / "time_trace"
    return json.loads((folder / "summary.json").read_text()), folder


def test_the_orbit_of_figure_4_has_period_4_and_one_impact_in_it(letter):
    summary, _ = letter
    assert (summary["schema"], summary["period"], summary["impacts"]) == (1, 4, 1)
    times = summary["impact_times_s"]
    assert len(times) == 2
    assert times[1] - times[0] == pytest.approx(4 / 21.5, rel=1e-8)


def test_higher_modes_ring_after_the_impact(letter):
    summary, _ = letter
    collision = summary["collisions"][0]
    energy = collision["energy_to_higher_modes"]
    assert energy > 0.0
    modes = {peak["mode"]: peak for peak in summary["peaks"] if peak["mode"]}
    assert {1, 2, 3, 4, 5} <= set(modes)
    for number, peak in modes.items():
        assert abs(peak["frequency_hz"] - summary["modes_hz"][number - 1]) <= 21.5
    amplitudes = [modes[n]["amplitude_m"] for n in (1, 2, 3, 4, 5)]
    assert amplitudes == sorted(amplitudes, reverse=True)


def test_all_lines_are_multiples_of_the_inverse_orbit_period(letter):
    summary, folder = letter
    stored = np.load(folder / "time_trace.npz")
    readout = stored["readout_m"]
    half = readout.size // 2
    # the second orbit period repeats the first: a settled orbit, and a spectrum without leakage
    assert np.max(np.abs(readout[half:] - readout[:half])) < 1e-8 * np.max(np.abs(readout))
    for peak in summary["peaks"]:
        assert (peak["frequency_hz"] * 4 / 21.5) % 1.0 == pytest.approx(0.0, abs=1e-6) or (
            peak["frequency_hz"] * 4 / 21.5
        ) % 1.0 == pytest.approx(1.0, abs=1e-6)


def test_figures_and_tables_are_written(letter):
    _, folder = letter
    wanted = {
        "time_trace.png",
        "time_trace.pdf",
        "spectrum.png",
        "spectrum.pdf",
        "spectrum.csv",
        "time_trace.npz",
        "summary.json",
        "manifest.json",
    }
    assert wanted <= {file.name for file in folder.iterdir()}
    assert all((folder / name).stat().st_size > 0 for name in wanted)


def test_below_grazing_there_is_no_impact_and_one_line(tmp_path, capsys):
    argv = ["--out", str(tmp_path), *COARSE, "--excess", "-0.01", "--json"]
    assert time_trace.main(argv) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["period"], found["impacts"], found["collisions"]) == (1, 0, [])
    assert [round(peak["frequency_hz"], 6) for peak in found["peaks"]] == [21.5]


def driven(law, excess):
    """Eq. (1) with this contact law at 21.50 Hz, its tip as read-out point."""
    model = single_mode(free_period=40.8e-3, decay_rate=3.56)
    return ImpactOscillator(
        model=replace(model, readouts={"readout": model.phi}), stop=Stop(gap=0.0107, law=law),
        drive=HarmonicDrive(frequency=21.5),
    ).with_excess(excess)


def test_the_close_up_shows_the_force_of_the_law():
    stiffness = 1e8
    oscillator = driven(LinearContact(stiffness=stiffness), 0.013)
    state = before_collision(oscillator)
    collision = first_collision(oscillator)
    near = close_up(oscillator, state, collision, 2e-4, 4001)
    assert near.spans[0][0] == pytest.approx(0.0, abs=1e-12)
    touching = near.height > 1e-12
    assert np.allclose(near.force[touching], stiffness * near.height[touching], rtol=1e-9)
    assert np.all(near.force[near.height < -1e-12] == 0.0)
    # momentum: what the force takes from the unit mass is the kick
    step = near.time[1] - near.time[0]
    assert step * near.force.sum() == pytest.approx(collision.kick_velocity, rel=2e-3)


def test_an_impact_law_has_no_force():
    oscillator = driven(NewtonRestitution(local_restitution=0.1), 0.005)
    period, state = settled_state(oscillator, 1000)
    assert period == 4
    trace = trace_of(oscillator, state, period, 2 * period)
    near = close_up(oscillator, state, trace.collisions[0], 1e-4, 101)
    assert np.all(np.isnan(near.force))
    assert near.spans == [(0.0, 0.0)]


def test_lines_of_a_known_sum():
    time = np.arange(4096) / 4096 * 2.0
    signal = 0.5 + 3.0 * np.cos(2 * np.pi * 5.0 * time) + 0.2 * np.sin(2 * np.pi * 40.0 * time)
    frequency, amplitude = lines_of(signal, 2.0)
    assert amplitude[0] == pytest.approx(0.5)
    assert amplitude[frequency == 5.0][0] == pytest.approx(3.0)
    assert amplitude[frequency == 40.0][0] == pytest.approx(0.2)
    assert np.sum(amplitude > 1e-9) == 3


def test_a_peak_belongs_to_the_mode_next_to_it():
    frequency = np.arange(0.0, 200.0, 1.0)
    amplitude = np.full(200, 1e-9)
    amplitude[[20, 95, 104, 150]] = [1.0, 0.1, 0.3, 0.5]
    told = peaks_of(frequency, amplitude, np.array([21.0, 100.0]), 6.0)
    assert [(p["frequency_hz"], p["mode"]) for p in told] == [
        (20.0, 1),
        (95.0, None),
        (104.0, 2),
        (150.0, None),
    ]


def test_another_orbit_than_the_letters_is_told():
    lines = time_trace.closing_lines(3, 4, 21.5, 0.013, [])
    assert "p3; the letter has p4" in lines[0] and "not the letter's" in lines[1]
    assert "no period up to 64" in time_trace.closing_lines(0, None, 20.0, 0.013, [])[0]
    cell = dict.fromkeys(("approach_velocity", "delay_s", "kick", "contact_s", "ringing_m"), 0.1)
    words = time_trace.closing_lines(4, 4, 21.5, 0.013, [cell | {"restitution": math.nan, "impacts": 1}])
    assert "does not come back" in words[-1] and "1 impact in" in words[-1] and "nan" not in words[-1]
    rung = {"restitution": math.nan, "impacts": 2, "approach_velocity": math.nan}
    words = time_trace.closing_lines(4, 4, 21.5, 0.013, [cell | rung, cell | rung])
    assert "2 impacts that ringing alone makes" in words[-2] and "further collisions" in words[-1]


@pytest.mark.parametrize(
    "wrong",
    [("--set", "contact.law=foo"), ("--excess", "-1"), ("--excess", "nan"), ("--frequency", "0"),
     ("--frequency", "1e6"), ("--set", "drive.kind=none"), ("--colour", "red")],
)
def test_wrong_use_is_refused_in_one_sentence(tmp_path, capsys, wrong):
    assert time_trace.main(["--out", str(tmp_path), *wrong]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and told.startswith("python -m studies.time_trace: ")
