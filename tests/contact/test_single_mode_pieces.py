"""What the loop of one mode is made of, and when it is used."""

from dataclasses import replace

import numpy as np
import pytest
from one_mode import FREQUENCIES, GAP, OMEGA, oscillator
from oscillators import modes_on_stop

import contact
from beam import SuspiciousValue
from contact.engine.event_loop import FAILED_CHATTER
from contact.maps import stroboscope
from contact.one_mode.period_table import period_table, table_at


@pytest.mark.parametrize("factor", [0.3, 1.0, 7.0])
def test_the_table_of_another_amplitude_is_a_scaled_one(factor):
    single = oscillator(21.5)
    assert single.drive is not None
    other = single.with_amplitude(factor * single.drive.amplitude).numbers()
    table, wanted = period_table(single.numbers()), period_table(other)
    assert table is not None and wanted is not None
    found = table_at(table, single.numbers(), factor)
    steady = found.steady.factor * found.rows[:, :2]
    assert steady == pytest.approx(wanted.rows[:, :2], rel=1e-14, abs=1e-16 * GAP)
    for ours, theirs in ((found.mode, wanted.mode), (found.steady, wanted.steady._replace(factor=factor))):
        for name, value in theirs._asdict().items():
            assert getattr(ours, name) == pytest.approx(value, rel=1e-13), name
    # far beyond any amplitude the place of the peak is not good enough
    assert wanted.steady.largest_deviation > 0
    assert table_at(table, single.numbers(), 1e7).steady.largest_deviation < 0


def test_it_is_offered_to_one_mode_under_newtons_law_only():
    single = oscillator()
    assert period_table(single.numbers()) is not None
    for law in (contact.HertzContact(stiffness=1e9), contact.DelayedRestitution(restitution=0.1, delay=1e-3)):
        other = replace(single, stop=contact.Stop(gap=GAP, law=law))
        assert period_table(other.numbers()) is None
    with pytest.warns(SuspiciousValue, match="frequency of the drive"):
        fast = replace(single, drive=contact.HarmonicDrive(frequency=0.2, amplitude=0.01))
    assert period_table(fast.numbers()) is None
    two = modes_on_stop([150.0, 900.0], 1.0, 1.0, 1.0, gap=GAP, drive=22.2).with_excess(0.02)
    for other in (two, modes_on_stop(0.0, 3.56, 1.0, 1.0)):
        assert period_table(other.numbers()) is None


def test_a_constant_load_moves_the_mean_place():
    single = replace(oscillator(22.2, excess=0.0), load=np.array([0.03 * GAP * OMEGA**2]))
    strobed = contact.StroboscopicMap(oscillator=single)
    assert period_table(single.numbers()) is not None
    ours = strobed.orbit(strobed.steady(), 300)
    run = contact.simulate(single, strobed.steady(), periods=300)
    points = np.hstack([run.strobe_displacement, run.strobe_velocity / single.model.omega])
    assert ours.impacts.sum() > 10 and np.array_equal(ours.impacts, run.strobe_impacts)
    assert np.abs(ours.points - points).max() < 1e-11 * GAP


def test_orbits_continue_bit_for_bit():
    maps = [contact.StroboscopicMap(oscillator=oscillator(f, tau=t)) for f in FREQUENCIES for t in (0.1, 0.5)]
    for strobed in maps:
        whole, half = (strobed.orbit(strobed.steady(), count) for count in (500, 250))
        assert np.array_equal(half.points, whole.points[:250])
        # a state is kept as displacement, not as deviation: its continuation agrees within rounding
        rest = strobed.orbit(half.end, 1)
        assert rest.points == pytest.approx(whole.points[250:251], abs=1e-12 * GAP)
        assert rest.end.time == pytest.approx(251 * strobed.oscillator.period)


def test_a_failure_of_the_general_loop_carries_its_time(monkeypatch):
    """Put in by hand: it does not occur with one mode."""
    compiled = stroboscope.strobed_motion

    def failing(table, system, factors, u, v, runs, points, counts):
        if system.numbers.number0 == 0.5:
            runs["clock"] = 0.25 * system.numbers.period
            return FAILED_CHATTER
        return compiled(table, system, factors, u, v, runs, points, counts)

    monkeypatch.setattr(stroboscope, "strobed_motion", failing)
    strobed = contact.StroboscopicMap(oscillator=oscillator(6.0, tau=0.5, decay=20.0, excess=3.0))
    with pytest.raises(contact.ContactError, match="accumulate") as caught:
        strobed.orbit(contact.State.rest(1), 200)
    assert (caught.value.time * 6.0) % 1.0 == pytest.approx(0.25)
