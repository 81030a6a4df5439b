"""Contacts across strobes; rebounds that wait."""

import math

import numpy as np
import pytest
from oscillators import FREQUENCY, GAP, PHI, heights, modes_on_stop, spring
from whole_motions import DASHPOT, HERTZ, LOSSY, SOFTER, SPRING, TABLE, WAIT, name_of

from contact import ContactTooStiff, DelayedRestitution, LinearContact, State, UnresolvedCrossing, simulate

PERIOD = 1 / FREQUENCY
STRADDLERS = [(4, law) for law in (HERTZ, LOSSY, SPRING, DASHPOT)]
STRADDLERS += [(1, law) for law in (SOFTER, WAIT, TABLE)]


@pytest.mark.parametrize("n_modes, law", STRADDLERS, ids=name_of)
@pytest.mark.parametrize("share", [0.02, 0.5, 0.98])
def test_strobe_within_a_contact_changes_nothing(n_modes, law, share):
    """Half a drive period later the same motion has its strobes elsewhere: once in the contact, once not."""

    def approaching(time: float) -> State:
        q, v = np.zeros(n_modes), np.zeros(n_modes)
        q[0], v[0] = (GAP - 1e-9) / PHI[0], 0.4 / PHI[0]
        return State(displacement=q, velocity=v, time=time)

    plain = spring(n_modes, law, drive=(FREQUENCY, 2e-3))
    turned = spring(n_modes, law, drive=(FREQUENCY, 2e-3), turned=True)
    # how long the contact lasts decides how long before the strobe it must begin
    trial = simulate(plain, approaching(0.98 * PERIOD), duration=0.01).impacts
    lead = share * (trial.end[0] - trial.start[0])
    for _ in range(3):
        trial = simulate(plain, approaching(PERIOD - lead), duration=0.01).impacts
        lead = share * (trial.end[0] - trial.start[0]) + 1e-9 / 0.4
    # the same floating-point times on both sides of the shift
    lead, length = float(np.float32(lead)), 2.7 * PERIOD
    marks = np.sort(np.concatenate([[PERIOD], PERIOD - lead + np.linspace(0, length, 301)]))
    within = simulate(plain, approaching(PERIOD - lead), duration=length, times=marks)
    earlier = np.clip(marks - 0.5 * PERIOD, 0.5 * PERIOD - lead, None)
    apart = simulate(turned, approaching(0.5 * PERIOD - lead), duration=length, times=earlier)
    unsampled = simulate(plain, approaching(PERIOD - lead), duration=length)
    assert within.impacts.start[0] < PERIOD < within.impacts.end[0]
    assert not 0 < apart.impacts.start[0] % PERIOD - apart.impacts.end[0] % PERIOD
    assert len(within.impacts) == len(apart.impacts) == len(unsampled.impacts) >= 2
    for name, scale in (("start", 1), ("end", 1), ("approach", 10), ("rebound", 10), ("loss", 1)):
        mine = getattr(within.impacts, name)
        theirs = getattr(apart.impacts, name) + (0.5 * PERIOD if name in ("start", "end") else 0.0)
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=2e-12 * scale)
        np.testing.assert_array_equal(mine, getattr(unsampled.impacts, name))
    for name, digits in (("displacement", 1e-12), ("velocity", 1e-10)):
        theirs = getattr(apart, name)
        assert np.max(np.abs(getattr(within, name) - theirs)) < digits * np.max(np.abs(theirs))
    i = int(np.flatnonzero(marks == PERIOD)[0])
    np.testing.assert_allclose(within.strobe_displacement[0], within.displacement[i], rtol=1e-13, atol=1e-18)
    np.testing.assert_allclose(within.strobe_velocity[0], within.velocity[i], rtol=1e-10, atol=1e-12)
    np.testing.assert_array_equal(unsampled.end.displacement, within.end.displacement)


def test_delayed_restitution_waits_on_the_wall_and_leaves_as_its_law_says():
    for law in (
        DelayedRestitution(restitution=0.25, delay=3e-4),
        DelayedRestitution(restitution=0.0, delay=3e-3),
        DelayedRestitution(restitution=1.0, delay=0.0),
        DelayedRestitution(restitution=lambda v: 0.2 + 0.1 * math.sin(v), delay=lambda v: 1e-4 / (1 + v)),
        DelayedRestitution(restitution=0.4, delay=lambda v: 2e-4 * v**0.2),
    ):
        oscillator = spring(1, law, drive=(FREQUENCY, 2.2e-3))
        run = simulate(oscillator, periods=30)
        impacts = run.impacts
        finished = np.isfinite(impacts.end)
        assert finished.sum() > 10 and np.ptp(impacts.approach) > 0.02
        approach = impacts.approach[finished]
        tau = [law.restitution(v) if callable(law.restitution) else law.restitution for v in approach]
        delay = [law.delay(v) if callable(law.delay) else law.delay for v in approach]
        np.testing.assert_allclose(impacts.rebound[finished], -np.array(tau) * approach, rtol=0, atol=1e-9)
        waits = impacts.end[finished] - impacts.start[finished]
        np.testing.assert_allclose(waits, delay, rtol=0, atol=1e-12)
        loss = 0.5 * (approach**2 - impacts.rebound[finished] ** 2) / PHI[0] ** 2
        np.testing.assert_allclose(impacts.loss[finished], loss, rtol=1e-12, atol=1e-18)
        for q, v, speed in (
            (impacts.displacement_start[finished], impacts.velocity_start[finished], approach),
            (impacts.displacement_end[finished], impacts.velocity_end[finished], impacts.rebound[finished]),
        ):
            assert np.max(np.abs(heights(oscillator, q))) < 1e-16
            np.testing.assert_allclose(v @ oscillator.model.phi, speed, rtol=0, atol=1e-13)
        if np.max(waits) > 0:
            middles = (impacts.start + 0.5 * (impacts.end - impacts.start))[finished]
            held = simulate(oscillator, periods=30, times=middles)
            assert np.max(np.abs(heights(oscillator, held.displacement))) < 1e-16
            assert np.max(np.abs(held.velocity @ oscillator.model.phi)) < 1e-13


def test_functions_of_the_speed_are_sampled_finely_and_end_level():
    def tau(v: float) -> float:
        return 0.9 * (1 + (v / 0.05) ** 0.2) ** -1.0

    def delay(v: float) -> float:
        return 2e-4 * v**-0.2

    law = DelayedRestitution(restitution=tau, delay=delay, speeds=(1e-3, 2.0))
    oscillator = modes_on_stop(0.0, law=law, gap=0.0)

    def bounce(v: float) -> tuple[float, float]:
        run = simulate(oscillator, State(displacement=[-v], velocity=[v]), duration=1.5)
        return -run.impacts.rebound[0] / v, run.impacts.end[0] - run.impacts.start[0]

    speeds = np.geomspace(1.001e-3, 1.99, 37)
    for v in speeds:
        found = bounce(v)
        assert found[0] == pytest.approx(tau(v), abs=1e-9)
        assert found[1] == pytest.approx(delay(v), abs=1e-12)
    for beyond, end in ((1e-5, 1e-3), (2.0, 2.0), (50.0, 2.0)):
        assert bounce(beyond) == pytest.approx((tau(end), delay(end)), rel=1e-12)


def test_delayed_restitution_of_several_modes_is_refused():
    with pytest.raises(TypeError, match="DelayedRestitution"):
        spring(2, WAIT)


@pytest.mark.parametrize("ratio", [1e24, 1e26, 1e28, 1e40])
def test_a_contact_beyond_the_range_of_doubles_is_refused_and_does_not_hang(ratio: float) -> None:
    """Some 1e24 times the stiffness of the spring the series overflows; below that the impact is Newton's."""
    numbers, modal = ([150.0, 900.0], [3.0, 9.0], [10.0, 9.0], [0.1, 0.05]), 150.0**2 / 10.0**2
    oscillator = modes_on_stop(*numbers, law=LinearContact(stiffness=ratio * modal), drive=22.0)
    oscillator = oscillator.with_excess(0.01)
    try:
        run = simulate(oscillator, periods=60)
    except (ContactTooStiff, UnresolvedCrossing):
        return
    assert ratio < 1e27 and len(run.impacts) > 0
