"""One mode with the restitution and the delay of the beam's own collisions."""

import math
from dataclasses import replace
from functools import partial
from itertools import count

import numpy as np
import pytest
from oscillators import slow

from contact import StroboscopicMap, first_collision, simulate
from contact.orbits import KickFamily, onset_m, onset_orbit, orbit_end
from studies import letter
from studies.experiment.transitions.model import rows_at
from studies.physics import two_parameters
from studies.physics.two_parameters import extracted, fold_of_kicks, law_of, two_parameters_at
from studies.shell.scene import SceneError, approach_speed, beam_at


@pytest.mark.parametrize("excess", [3.3e-6, 0.21])
def test_one_mode_comes_out_of_a_collision_as_mode_1_of_the_beam(letter_scene, letter_model, excess):
    """At excesses between those of the tables: restitution, delay and kick."""
    of_beam = first_collision(beam_at(letter_scene, 22.2, letter_model).with_excess(excess))
    one = first_collision(two_parameters_at(letter_scene, 22.2, letter_model).with_excess(excess))
    for name in ("approach", "restitution", "delay", "kick"):
        assert getattr(one, name) == pytest.approx(getattr(of_beam, name), rel=2e-3), name


def test_no_touch_is_held_longer_than_it_would_be_behind_the_wall(letter_scene, letter_model):
    """Nor below the slowest collision, where the delay falls with the speed."""
    law = law_of(beam_at(letter_scene, 22.2, letter_model))
    deceleration = (2 * math.pi * 22.2) ** 2 * letter_scene.stop.gap_m
    slowest = approach_speed(22.2, letter_scene.stop.gap_m, two_parameters.EXCESSES[0])
    for v in np.geomspace(2e-6, 1.0, 60):
        assert 0.0 < law.delay(v) < 2.0 * v / deceleration
    assert law.delay(0.1 * slowest) == pytest.approx(0.1 * law.delay(slowest), rel=1e-6)
    assert law.restitution(0.1 * slowest) == pytest.approx(law.restitution(slowest), rel=1e-9)


@pytest.mark.parametrize(("frequency", "m"), [(21.50, 4), *slow((20.90, 3), (22.20, 5), (23.40, 11))])
def test_the_orbit_ends_where_the_kicks_of_the_beam_say(letter_scene, letter_model, frequency, m):
    """Simulated with restitution and delay, and without simulation by kick and shift of each collision."""
    strobed = StroboscopicMap(oscillator=two_parameters_at(letter_scene, frequency, letter_model))
    settled = onset_orbit(strobed, 1e-3, most_cycles=2000)
    assert (settled.m, settled.impacts) == (m, 1)
    end = orbit_end(strobed, settled.end, 1e-3, most_cycles=2000)
    by_law = KickFamily(oscillator=strobed.oscillator, m=m).fold()
    assert end.kind == "fold" and end.excess == pytest.approx(by_law.excess, rel=1e-8)
    by_kicks = fold_of_kicks(KickFamily(oscillator=beam_at(letter_scene, frequency, letter_model), m=m))
    assert end.excess == pytest.approx(by_kicks, rel=0.01)
    found = extracted(letter_scene, frequency, letter_model, end=settled.end, m=m)
    assert found.fold == by_kicks and found.map == m
    run = simulate(strobed.oscillator.with_excess(1e-3), settled.end, periods=m)
    assert run.impacts.approach == pytest.approx([found.approach_m_per_s], rel=1e-6)
    beam = StroboscopicMap(oscillator=beam_at(letter_scene, frequency, letter_model)).at(-0.5)
    quiet, ringing = beam.steady(), np.eye(letter_model.n_modes)[1] * 1e-6  # of mode 2, which decays slowest
    rung = beam.orbit(replace(quiet, displacement=quiet.displacement + ringing), m).end
    u, v = rung.displacement[1] - quiet.displacement[1], rung.velocity[1] - quiet.velocity[1]
    rate, omega = letter_model.decay_rate[1], letter_model.omega[1]
    turn = math.sqrt(omega**2 - 0.25 * rate**2)
    left = math.hypot(u, (v + 0.5 * rate * u) / turn) / math.hypot(1.0, 0.5 * rate / turn) / 1e-6
    assert found.ringing_left == pytest.approx(left, rel=1e-6)
    assert 0.05 < found.restitution < 0.5 and 0.0 < found.delay_s < 5e-4


@pytest.mark.slow
def test_they_have_the_beams_periods_and_its_p8_ends_by_the_same_graze(letter_scene, letter_model):
    for frequency, m in list(letter.PERIODS.items())[:5]:
        strobed = StroboscopicMap(oscillator=two_parameters_at(letter_scene, frequency, letter_model))
        assert [onset_m(strobed, excess, most_cycles=2000) for excess in (2.5e-4, 1e-3)] == [m, m]
    at = rows_at(letter_scene, 23.05, letter_model)
    two, beam = (row for row in at.rows if row.description in ("two_parameters", "beam"))
    assert not at.failures and two.ends_by == beam.ends_by == "grazing"
    assert two.excess_down == pytest.approx(beam.excess_down, rel=0.03)


def test_collisions_without_restitution_are_left_out(letter_scene, letter_model, monkeypatch):
    """A few make no difference but of interpolation; with too few there is no law, and the rest goes on."""
    beam = beam_at(letter_scene, 22.2, letter_model)
    whole, calls = law_of(beam), count()

    def gone(oscillator, every):
        found = first_collision(oscillator)
        return replace(found, restitution=math.nan, delay=math.nan) if next(calls) % every == 0 else found

    monkeypatch.setattr(two_parameters, "first_collision", partial(gone, every=5))
    for v in (0.003, 0.1, 0.6):
        assert law_of(beam).restitution(v) == pytest.approx(whole.restitution(v), rel=0.02)
    monkeypatch.setattr(two_parameters, "first_collision", partial(gone, every=1))
    with pytest.raises(SceneError, match=r"contact.law leaves mode 1 a restitution in 0 of 45"):
        law_of(beam)
    at = rows_at(letter_scene, 22.2, letter_model)
    assert [row.m for row in at.rows] == [5, 5, None, 5] and at.extracted is None
    assert [where for where, _ in at.failures] == ["22.2 Hz, two_parameters"]
