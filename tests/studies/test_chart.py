"""What a motion settles on by its largest Lyapunov exponent, and basins."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import verdicts_on

from contact import State, StroboscopicMap
from contact.orbits import Shooting, fold_of, settle
from studies.experiment.chart.settled import CHAOTIC, NOT_SETTLED, PERIODIC, WITHOUT, kind_of, parts, plane_of
from studies.shell.scene import beam_at, single_mode_at

FREQUENCY = 21.50
FEW = np.array([-0.02, -0.012, -0.004, 0.004, 0.034, 0.045])


def kind_reached(strobed, *, most_cycles=1500, cycles=400):
    """Kind and largest exponent of what the motion without impacts turns into."""
    settled = settle(strobed, strobed.steady(), most_cycles=most_cycles)
    kind, exponents = kind_of(strobed, settled, cycles)
    return kind, exponents.largest


def test_chaos_slow_transient_and_motion_without_impacts_are_distinguished(letter_scene):
    twelve = letter_scene.replace({"modes.count": 12})
    both = single_mode_at(letter_scene, FREQUENCY), beam_at(twelve, FREQUENCY)
    single, beam = (StroboscopicMap(oscillator=oscillator) for oscillator in both)
    assert kind_reached(single.at(0.034), cycles=500)[0] == CHAOTIC
    for strobed in (single, beam):
        kind, exponent = kind_reached(strobed.at(-0.02))
        rate = float(strobed.oscillator.model.decay_rate[0])
        assert kind == WITHOUT and exponent * FREQUENCY == pytest.approx(-0.5 * rate, rel=1e-9)
    kind, exponent = kind_reached(beam.at(0.045))
    assert kind == CHAOTIC and exponent > 0.05
    family = Shooting(oscillator=beam.oscillator, m=4)
    orbit = family.at_excess(0.01, family.at_speed(2.0 * abs(fold_of(family).speed)))
    exact = np.log(np.max(np.abs(orbit.multipliers))) / 4
    for most_cycles, expected in ((128, NOT_SETTLED), (1500, PERIODIC)):
        kind, exponent = kind_reached(beam.at(0.01), cycles=100, most_cycles=most_cycles)
        assert (kind, exponent) == (expected, pytest.approx(exact, rel=0.01 if kind == NOT_SETTLED else 1e-6))


def test_starts_next_to_either_orbit_lead_to_it_between_fold_and_grazing(letter_scene):
    plane = plane_of(letter_scene, FREQUENCY, 2)
    gap = letter_scene.stop.gap_m
    assert {m: points.shape for m, points in plane.orbits.items()} == {4: (4, 2), 1: (1, 2)}
    near = 3e-5 * gap
    for m, moved in ((4, 1e-6 * gap), (1, near)):
        for x, velocity in plane.strobes(m):
            assert plane.leads(x + moved, velocity) == m
    assert plane.leads(1.01 * gap, 0.0) == -1
    # what is taken for p1 touches no more; second route: every strobe of a long run from three times as far
    ((x, velocity),) = plane.strobes(1)
    start = State(displacement=np.array([x + near]), velocity=np.array([velocity]))
    assert plane.near < near and plane.strobed.orbit(start, 500).impacts.sum() == 0


def test_both_orbits_have_a_basin_between_fold_and_grazing_and_one_below(letter_scene):
    between = plane_of(letter_scene, FREQUENCY, 2)
    ((x, velocity),), speed = between.strobes(1), 2.0 * np.pi * FREQUENCY
    around = np.linspace(-0.03, 0.03, 12) * letter_scene.stop.gap_m
    between = replace(between, x=x + around, velocity=velocity + speed * around)
    leads = np.array([between.line(v) for v in between.velocity.tolist()])
    assert np.mean(leads == 1) > 0.02 and np.mean(leads == 4) > 0.5
    below = plane_of(letter_scene, FREQUENCY, 6, -0.02)
    leads = np.array([below.line(v) for v in below.velocity.tolist()])
    assert below.m == 1 and set(np.unique(leads)) <= {-1, 1}  # below the fold of -0.0132 only p1 is left
    assert parts(leads, below.m) == {"p1 without impacts": 1.0, "something else": 0.0}


def test_small_form(run_study, monkeypatch):
    monkeypatch.setattr("studies.experiment.chart.settled.QUICK_CUT", (FEW, 400))
    ran = run_study("chart", "--quick", "--points", "4", "8", "--side", "8")
    assert ran.code == 0
    rows = ran.rows("cut")
    for row in rows:
        assert (row["kind"] in (PERIODIC, WITHOUT)) == (int(row["m"]) > 0)
        assert float(row["lyapunov_map"]) < 0.0 or not int(row["m"])
    seen = [row for row in rows if (row["model"], row["kind"]) == ("single_mode", WITHOUT)]
    seen.sort(key=lambda row: float(row["excess"]))
    last = {row["direction"]: float(row["excess"]) for row in seen}
    assert last["up"] > last["down"]  # hysteresis
    assert ran.verdicts == verdicts_on("chart")
