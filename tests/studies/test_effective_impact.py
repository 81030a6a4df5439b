"""One approach to the plate: limits of restitution, delay and kick, closed relations, what is read off the
curves, and the study."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import verdicts_on

from contact import LinearContact, NewtonRestitution
from studies.experiment.effective_impact.model import Approach, Spring, cases_of, floor_of, on_orbits
from studies.letter import TIME_TRACE_EXCESS
from studies.physics.calibration import bare_cantilever
from studies.shell.scene import approach_speed, beam_at, hertz_of, read_scene

pytestmark = pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
"""Calibration tries springs that nobody would build."""

COARSE = {"spring.elements_per_leg": 20, "spring.elements_on_arc": 12}
LETTER = read_scene("letter").replace(COARSE)
FREQUENCY = 22.2


@pytest.fixture(scope="module")
def spring() -> Spring:
    """The letter's spring with 20 modes."""
    return Spring.of(LETTER, FREQUENCY, 20)


def met(spring: Spring, law, excess: float = TIME_TRACE_EXCESS) -> Approach:
    """The row of one approach."""
    return spring.case("speed", "a", law, excess=excess).measured()


@pytest.mark.parametrize("modes", [2, 5, 10])
def test_the_kick_under_newtons_law_is_that_of_the_modal_masses(spring, modes):
    e, phi = 0.7, spring.model.phi[:modes]
    truncated = replace(spring, model=spring.model.truncated(modes))
    row = met(truncated, NewtonRestitution(local_restitution=e))
    # (1 + e) phi_1^2 / sum phi_k^2, with the higher modes all but at rest
    assert row.impacts == 1
    assert row.kick == pytest.approx((1.0 + e) * phi[0] ** 2 / np.sum(phi**2), rel=2e-3)
    assert row.restitution == pytest.approx(abs(1.0 - row.kick), abs=2e-3)


def test_the_floor_of_restitution_is_the_time_of_the_contact(spring):
    hertz = hertz_of(LETTER)
    row = met(spring, hertz)
    assert row.kick == pytest.approx(1.0, abs=0.02)
    assert row.restitution == pytest.approx(math.sqrt(row.contact_s / row.arc_s), rel=0.03)
    mass, speed = LETTER.tip.mass_kg, approach_speed(FREQUENCY, LETTER.stop.gap_m, TIME_TRACE_EXCESS)
    linear = mass * (math.pi / hertz.contact_time(mass, speed)) ** 2
    as_hard, harder = (met(spring, LinearContact(stiffness=factor * linear)) for factor in (1.0, 9.0))
    assert as_hard.contact_s == pytest.approx(row.contact_s, rel=0.05)
    assert harder.contact_s == pytest.approx(as_hard.contact_s / 3.0, rel=0.05)
    assert harder.restitution < 0.65 * as_hard.restitution


def test_a_bare_tip_keeps_seven_tenths_and_is_late_by_more_than_the_arc():
    fine = LETTER.replace({"spring.elements_per_leg": 50})  # a mesh that bears 25 modes
    bare = Spring.of(bare_cantilever(fine, FREQUENCY), FREQUENCY, 25)
    row = met(bare, hertz_of(bare.scene))
    assert row.restitution == pytest.approx(0.7, abs=0.02)
    assert row.delay_s > row.arc_s
    assert row.impacts > 1


def test_a_settled_orbit_has_its_collision_in_every_period():
    """The orbit of Fig. 4, and a motion without impacts, which has none."""
    spring = Spring.of(read_scene("letter"), FREQUENCY, 20)
    case = spring.case("orbit", "21.5 Hz", hertz_of(LETTER), frequency=21.50)
    row = case.measured()
    assert row.orbit_m == 4 and row.impacts == 1 and on_orbits([row]) == [row]
    assert row.restitution == pytest.approx(0.0710, abs=1e-3)
    below = replace(case, oscillator=case.oscillator.with_excess(-0.01)).measured()
    assert below.orbit_m == 1 and math.isnan(below.kick) and on_orbits([below]) == []


def test_other_tip_masses_keep_the_drive_amplitude_and_are_in_hertz_contact_only():
    narrow = LETTER.replace({"stop.gap_m": 0.006})
    own, heavy = (Spring.of(narrow, FREQUENCY, 4, ratio) for ratio in (None, 0.5))
    sizes = [beam_at(one.scene, FREQUENCY).grazing_amplitude() for one in (own, heavy)]
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-9)
    newton = replace(own, scene=narrow.replace({"contact.law": "newton"}))
    assert {case.row.curve for case in cases_of(newton, [heavy], own)} == {"speed", "reference"}


def test_the_smallest_restitution_lies_between_the_cases():
    row = Approach(curve="search", series="1", value=0.0, excess=0.01, mass_ratio=0.3, impacts=1)
    rows = []
    for ratio in (0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 1.0):
        kick = 1.0 + 0.5 * math.log(ratio / 0.25)
        rows.append(replace(row, mass_ratio=ratio, kick=kick, restitution=math.hypot(1.0 - kick, 0.08)))
    found = floor_of(rows)
    assert found.restitution == pytest.approx(0.08, abs=1e-4)
    assert found.mass_ratio == pytest.approx(0.25, rel=0.01)
    falling = [replace(row, kick=0.5, restitution=1.0 - 0.5 * row.mass_ratio) for row in rows]
    assert floor_of([]) is floor_of(falling) is None  # the end of the range is no floor


def test_the_answers_agree_with_what_is_known(run_study, monkeypatch):
    monkeypatch.setattr("studies.experiment.effective_impact.__main__.QUICK", (4, 12))
    ran = run_study("effective_impact", "--quick", *(f"--set={key}={value}" for key, value in COARSE.items()))
    assert ran.code == 0 and ran.summary["frequency_hz"] == FREQUENCY
    curves = {row["curve"] for row in ran.rows("collisions")}
    assert curves == {"speed", "reference", "mass", "orbit", "search"}
    floors = [floor["restitution"] for floor in ran.summary["floors"]]
    assert len(floors) > 1 and all(0.2 < tau < 0.24 for tau in floors)  # whatever the loss in the contact
    assert ran.verdicts == verdicts_on("effective_impact")
