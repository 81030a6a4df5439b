"""What the loop of one mode is made of, and when it is used."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from one_mode import (
    DAMPINGS,
    FREQUENCIES,
    GAP,
    OMEGA,
    Period,
    at_a_strobe,
    general_orbit,
    oscillator,
    rest_of,
)

from beam import ModalModel, SuspiciousValue, single_mode
from contact import stroboscope
from contact.drive import HarmonicDrive
from contact.errors import ContactError
from contact.event_loop import FAILED_CHATTER
from contact.flight.modal_flow import tip_state
from contact.laws import DelayedRestitution, HertzContact
from contact.oscillator import ImpactOscillator
from contact.single_mode.one_impact import guessed, is_settled, one_impact, zero_of
from contact.single_mode.period_table import SMALL, flow_over, period_table, short_flow, table_at, tip_near
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap, strobed_orbits
from contact.trajectory import State

# --- the crossing in one evaluation ------------------------------------------------------------------------


def struck(period: Period, u: float, v: float):
    """Whether one evaluation settles the crossing; its time, the slope, and the deviation at the strobe."""
    n = period.table.mode
    p, q = (flow[0] * u + flow[1] * v for flow in (n.peak_flow[:2], n.peak_flow[2:]))
    t = guessed(n, p, q)
    if not 0.0 <= t <= n.period:
        return False, t, 0.0, u, v
    rho = math.sqrt(u * u + n.inverse * v * v)
    return one_impact(n, period.table.rows, t, rho, u, v)


@pytest.mark.parametrize("tau", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("damping", ["undamped", "letter", "strong"])
def test_a_crossing_settled_at_once_is_the_zero_of_the_closed_form(damping, tau):
    rng = np.random.default_rng(11)
    settled_ones = others = 0
    for _ in range(300):
        single = oscillator(
            rng.uniform(18.0, 24.4), decay=DAMPINGS[damping], tau=tau, excess=10 ** rng.uniform(-6, -0.5)
        )
        period = Period(single)
        motion, n = period.motion, period.table.mode
        size, turn = 0.4 * GAP * rng.uniform(), rng.uniform(0.0, 2.0 * math.pi)
        u, v = size * math.cos(turn), size * math.sin(turn) * motion.omega[0]
        settled, t, approach, un, vn = struck(period, u, v)
        if not settled:
            others += 1
            continue
        settled_ones += 1
        ui, vi = flow_over(n, period.table.rows, t, u, v)
        height, slope, _a = tip_state(motion, t, np.array([ui]), np.array([vi]))
        assert abs(height) < 2e-15 * GAP + SMALL * n.margin
        assert slope == pytest.approx(approach, rel=1e-12, abs=1e-13 * GAP * motion.drive)
        # the impact, and a flight to the end of the period
        vi -= (1.0 + tau) * approach / motion.phi[0]
        after = flow_over(n, period.table.rows, n.period - t, ui, vi)
        assert period.size(np.array([after[0] - un]), np.array([after[1] - vn])) < 1e-14 * GAP
    assert settled_ones > 80 and others > 20


def test_what_one_evaluation_cannot_settle_is_not_taken():
    """A guess far off, from a fifth derivative that the guess does not know, and a bare graze."""
    period = Period(oscillator(21.5, excess=0.02))
    n = period.table.mode
    assert 0.0 < n.reach * n.drive < 1e-3
    height, slope = -1e-3 * GAP, 0.05 * GAP * n.drive
    y = height, slope, -n.crest, 0.0, n.crest * n.drive**2
    step, rest, approach = zero_of(*y)
    assert step > n.reach  # a thousandth of the gap is too far for the series
    assert not is_settled(n, 0.0, 0.0, 0.0, slope, step, rest, approach)
    tiny = math.sqrt(3.9 * n.crest * n.margin)
    assert not is_settled(n, 0.0, 0.0, 0.0, tiny, 0.0, 0.0, tiny)
    assert is_settled(n, 0.0, 0.0, 0.0, 1.1 * tiny, 0.0, 0.0, 1.1 * tiny)
    assert not is_settled(n, 0.0, 1.001 * n.most, 0.0, slope, 0.0, 0.0, slope)
    for wrong in (math.nan, -slope):
        assert not is_settled(n, 0.0, 0.0, 0.0, wrong, 0.0, 0.0, wrong)


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_nearly_every_impact_takes_one_evaluation(frequency):
    """What the loop of one mode is fast by: no more than one in ten of its impacts needs an iteration."""
    period = Period(oscillator(frequency, excess=0.02))
    u, v = rest_of(oscillator(frequency))
    runs = at_a_strobe()
    impacts = at_once = 0
    for _ in range(600):
        settled, *_rest = struck(period, u[0], v[0])
        _status, count, _left = period.fast(u, v, runs)
        impacts += count > 0
        at_once += bool(settled) and count > 0
    assert impacts > 60
    assert at_once >= 0.9 * impacts


# --- the motion between the nodes --------------------------------------------------------------------------


@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("frequency", [3.0, 22.2])
def test_the_motion_between_nodes_is_the_closed_form(frequency, damping):
    motion = oscillator(frequency, decay=DAMPINGS[damping]).motion()
    table = period_table(motion)
    assert table is not None
    rng = np.random.default_rng(3)
    u, v = 0.3 * GAP, -0.2 * GAP * motion.omega[0]
    for t in rng.uniform(0.0, motion.period, 60):
        un, vn, y0, y1, y2 = tip_near(table.mode, table.rows, u, v, t)
        # the closed form through exponentials of complex numbers
        root = np.sqrt(complex(motion.decay[0] ** 2 / 4 - motion.omega[0] ** 2))
        fast, slow = -motion.decay[0] / 2 + root, -motion.decay[0] / 2 - root
        b = (v - fast * u) / (slow - fast)
        parts = (u - b) * np.exp(fast * t), b * np.exp(slow * t)
        free = [(fast**n * parts[0] + slow**n * parts[1]).real for n in range(3)]
        steady = motion.tip_sine * math.sin(motion.drive * t) + motion.tip_cosine * math.cos(motion.drive * t)
        tiny = 2e-15 * GAP * (1 + abs(root))
        fastest = max(motion.drive, motion.omega[0], motion.decay[0])
        assert un == pytest.approx(free[0], abs=tiny)
        assert vn == pytest.approx(free[1], abs=tiny * fastest)
        assert y0 == pytest.approx(motion.level + steady + free[0], abs=tiny)
        assert y2 == pytest.approx(free[2] - motion.drive**2 * steady, abs=tiny * fastest**2)
        turned = motion.drive * t
        rate = motion.drive * (motion.tip_sine * math.cos(turned) - motion.tip_cosine * math.sin(turned))
        assert y1 == pytest.approx(rate + free[1], abs=tiny * fastest)
    step = 0.37 * table.mode.stretch
    there = short_flow(table.mode, step, u, v)[:2]
    assert short_flow(table.mode, -step, *there)[:2] == pytest.approx((u, v), rel=1e-13)


@pytest.mark.parametrize("factor", [0.3, 1.0, 7.0])
def test_the_table_of_another_amplitude_is_a_scaled_one(factor):
    single = oscillator(21.5)
    assert single.drive is not None
    other = single.with_amplitude(factor * single.drive.amplitude).motion()
    table, wanted = period_table(single.motion()), period_table(other)
    assert table is not None and wanted is not None
    found = table_at(table, other, factor)
    assert found.rows == pytest.approx(wanted.rows, rel=1e-14, abs=1e-16 * GAP)
    for name, value in wanted.mode._asdict().items():
        assert getattr(found.mode, name) == pytest.approx(value, rel=1e-13), name
    # far beyond any amplitude the place of the peak is not good enough
    far = single.with_amplitude(1e7 * single.drive.amplitude).motion()
    assert wanted.mode.most > 0 > table_at(table, far, 1e7).mode.most


# --- when it is used ---------------------------------------------------------------------------------------


def test_it_is_offered_to_one_mode_under_newtons_law_only():
    single = oscillator()
    assert period_table(single.motion()) is not None
    for law in (HertzContact(stiffness=1e9), DelayedRestitution(restitution=0.1, delay=1e-3)):
        other = replace(single, stop=Stop(gap=GAP, law=law))
        assert period_table(other.motion()) is None
    with pytest.warns(SuspiciousValue, match="frequency of the drive"):
        fast = replace(single, drive=HarmonicDrive(frequency=0.2, amplitude=0.01))
    assert period_table(fast.motion()) is None
    two = ModalModel(
        omega=np.array([150.0, 900.0]), decay_rate=np.ones(2), phi=np.ones(2), participation=np.ones(2)
    )
    assert period_table(replace(single, model=two).motion()) is None
    loose = single_mode(free_period=40.80e-3, decay_rate=3.56)
    loose = replace(loose, omega=np.zeros(1))
    assert period_table(ImpactOscillator(model=loose, stop=single.stop).motion()) is None


def test_a_constant_load_moves_the_mean_place():
    single = replace(oscillator(22.2, excess=0.0), load=np.array([0.03 * GAP * OMEGA**2]))
    strobed = StroboscopicMap(oscillator=single)
    assert period_table(single.motion()) is not None
    ours = strobed.orbit(strobed.steady(), 300)
    points, counts = general_orbit(single, strobed.steady(), 300)
    assert counts.sum() > 10
    assert np.array_equal(ours.impacts, counts)
    assert np.abs(ours.points - points).max() < 1e-11 * GAP


def test_orbits_continue_bit_for_bit():
    maps = [StroboscopicMap(oscillator=oscillator(f, tau=t)) for f in FREQUENCIES for t in (0.1, 0.5)]
    for strobed in maps:
        whole, half = (strobed.orbit(strobed.steady(), count) for count in (500, 250))
        assert np.array_equal(half.points, whole.points[:250])
        # a state is kept as displacement, not as deviation: its continuation agrees within rounding
        rest = strobed.orbit(half.end, 1)
        assert rest.points == pytest.approx(whole.points[250:251], abs=1e-12 * GAP)
        assert rest.end.time == pytest.approx(251 * strobed.oscillator.period)


MIXED = (
    # chaos, large amplitudes, a slow drive that presses the tip to the wall, no impacts, other nodes
    [oscillator(f, tau=t, excess=e) for f in FREQUENCIES for t in (0.05, 0.5) for e in (1e-3, 0.08)]
    + [oscillator(6.0, tau=0.1, decay=20.0, excess=3.0), oscillator(9.0, tau=0.3, excess=0.6)]
    + [oscillator(22.2, excess=-0.1), oscillator(22.2, phi=-1.3)]
    + [oscillator(21.5, phi=2.7, participation=-0.4)]
)


def test_an_orbit_is_the_same_in_any_company():
    maps = [StroboscopicMap(oscillator=single) for single in MIXED]
    starts = [State.rest(1) if i % 2 else strobed.steady() for i, strobed in enumerate(maps)]
    impacts = 0
    for workers in (1, 3):
        for strobed, start, orbit in zip(maps, starts, strobed_orbits(maps, starts, 700, workers=workers),
                                         strict=True):  # fmt: skip
            wanted = strobed.orbit(start, 700)
            assert np.array_equal(wanted.points, orbit.points)
            assert np.array_equal(wanted.impacts, orbit.impacts)
            assert np.array_equal(wanted.end.displacement, orbit.end.displacement)
            assert np.array_equal(wanted.end.velocity, orbit.end.velocity)
            assert (wanted.end.time, wanted.end.regime) == (orbit.end.time, orbit.end.regime)
            impacts += int(orbit.impacts.sum())
    assert impacts > 3000


def test_other_oscillators_may_be_in_the_batch():
    single = oscillator()
    other = replace(single, stop=Stop(gap=GAP, law=HertzContact(stiffness=1e9)))
    maps = [StroboscopicMap(oscillator=one) for one in (single, other, single, single)]
    orbits = strobed_orbits(maps, [strobed.steady() for strobed in maps], 60, workers=2)
    for strobed, orbit in zip(maps, orbits, strict=True):
        assert np.array_equal(strobed.orbit(strobed.steady(), 60).points, orbit.points)
    assert strobed_orbits([], [], 5) == []


def test_failures_are_those_of_the_general_loop():
    """A tip that starts behind the wall is refused; a failed orbit ends the batch."""
    strobed = StroboscopicMap(oscillator=oscillator())
    behind = State(displacement=np.array([1.5 * GAP]), velocity=np.zeros(1))
    with pytest.raises(ValueError, match="behind the stop"):
        strobed_orbits([strobed, strobed], [strobed.steady(), behind], 10)
    between = State(displacement=strobed.steady().displacement, velocity=np.zeros(1), time=0.3 / 22.2)
    with pytest.raises(ValueError, match="strobe time"):
        strobed_orbits([strobed, strobed], [between, strobed.steady()], 10)
    assert not issubclass(ValueError, ContactError)


def test_the_first_failure_in_their_order_ends_a_batch(monkeypatch):
    """A failure of the general loop, put in by hand: it does not occur with one mode."""
    compiled = stroboscope.strobed_motion

    def failing(system, u, v, runs, points, counts):
        if system.motion.number0 == 0.5:
            runs["clock"] = 0.25 * system.motion.period
            return FAILED_CHATTER
        return compiled(system, u, v, runs, points, counts)

    monkeypatch.setattr(stroboscope, "strobed_motion", failing)
    slow = [oscillator(6.0, tau=tau, decay=20.0, excess=3.0) for tau in (0.1, 0.5, 0.5)]
    maps = [StroboscopicMap(oscillator=single) for single in slow]
    with pytest.raises(ContactError, match="accumulate") as caught:
        strobed_orbits(maps, [State.rest(1)] * 3, 200, workers=1)
    assert (caught.value.time * 6.0) % 1.0 == pytest.approx(0.25)
