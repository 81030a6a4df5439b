"""What a motion settles on by its largest Lyapunov exponent, and basins."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

from contact import State, StroboscopicMap
from studies.attractors.basins import plane_of
from studies.attractors.scan import CHAOTIC, NOT_SETTLED, PERIODIC, WITHOUT, classify
from studies.scene import beam_at, read_scene, single_mode_at

FREQUENCY = 21.50


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter")


@pytest.fixture(scope="module")
def single(scene):
    return StroboscopicMap(oscillator=single_mode_at(scene, FREQUENCY))


@pytest.fixture(scope="module")
def beam(scene):
    return StroboscopicMap(oscillator=beam_at(scene.replace({"modes.count": 12}), FREQUENCY))


def test_chaos_slow_transient_and_motion_without_impacts_are_told_apart(single, beam):
    assert classify(single.at(0.034), single.steady(), cycles=500, most_cycles=1500).kind == CHAOTIC
    for strobed in (single, beam):
        free = classify(strobed.at(-0.02), strobed.at(-0.02).steady())
        rate = float(strobed.oscillator.model.decay_rate[0])
        assert free.kind == WITHOUT and free.lyapunov_map * FREQUENCY == pytest.approx(-0.5 * rate, rel=1e-9)
    chaos = classify(beam.at(0.03), beam.steady(), cycles=400, most_cycles=1500)
    assert chaos.kind == CHAOTIC and chaos.lyapunov_map > 0.05
    slow = classify(beam.at(0.01), beam.at(0.01).steady(), cycles=100, most_cycles=128)
    assert slow.kind in (PERIODIC, NOT_SETTLED) and slow.lyapunov_map < 0.0


def test_starts_next_to_either_orbit_lead_to_it_between_fold_and_grazing(scene):
    plane = plane_of(scene, FREQUENCY, -0.006, 2)
    gap, speed = scene.stop.gap_m, 2.0 * math.pi * FREQUENCY * scene.stop.gap_m
    assert plane.period == 4 and plane.orbit.shape == (4, 2)
    near = 3e-5
    assert plane.leads(plane.rest[0] + near * gap, plane.rest[1] - near * speed) == 1
    for x, velocity in plane.orbit:
        assert plane.leads(x + 1e-6 * gap, velocity) == 4
    assert plane.leads(1.01 * gap, 0.0) == -1
    # within the envelope no impact is possible; second route: every strobe of a long run
    start = State(displacement=np.array([plane.rest[0] + near * gap]), velocity=np.array([plane.rest[1]]))
    assert plane.envelope(start) < 0.006 * gap
    assert plane.strobed.orbit(start, 500).impacts.sum() == 0


def test_both_orbits_have_a_basin_between_fold_and_grazing_and_one_below(scene):
    between = plane_of(scene, FREQUENCY, -0.006, 2)
    around = np.linspace(-0.03, 0.03, 12) * scene.stop.gap_m
    speed = 2.0 * math.pi * FREQUENCY
    between = replace(between, x=between.rest[0] + around, velocity=between.rest[1] + speed * around)
    leads = np.array([between.line(v) for v in between.velocity.tolist()])
    assert np.mean(leads == 1) > 0.02 and np.mean(leads == 4) > 0.5
    below = plane_of(scene, FREQUENCY, -0.02, 6)
    leads = np.array([below.line(v) for v in below.velocity.tolist()])
    assert set(np.unique(leads)) <= {-1, 1}  # below the fold of -0.0132 only p1 is left


def test_small_form(run_study):
    ran = run_study("attractors", "--quick", "--model", "single_mode", "--side", "8", "--cycles", "60")
    assert ran.code == 0
    with (ran.folder / "rows.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        assert (row["kind"] in (PERIODIC, WITHOUT)) == (int(row["period"]) > 0)
        assert float(row["lyapunov_map"]) < 0.0 or not int(row["period"])
    up, down = (
        max(float(row["excess"]) for row in rows if row["direction"] == way and row["kind"] == WITHOUT)
        for way in ("up", "down")
    )
    assert up > down  # hysteresis
    assert ran.summary["verdicts"]["coexistence"]["verdict"] == "agrees"


@pytest.mark.parametrize("argv", [("--lowest", "0.1", "--highest", "0.0"), ("--basin-excess", "0.01"),
                                  ("--set", "drive.kind=none")])  # fmt: skip
def test_wrong_input_is_refused(run_study, argv):
    assert run_study("attractors", *argv).code == 2
