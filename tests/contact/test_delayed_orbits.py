"""Orbits of Eq. (1) with a touch that waits: long waits, and short ones as in the letter's map."""

import math
import pickle
from functools import partial

import numpy as np
import oscillators
import pytest
from cases_of_calls import LAWS, Case, oscillator_of
from oscillators import apart
from simulated_orbit import differences, touches

import contact
from contact.maps.nordmark_orbits import MapFamily
from contact.orbits import KickFamily, Shooting, settle

T, MU, TAU, GAP = 40.80e-3, 3.56, 0.1, 0.0107
equation_1 = partial(oscillators.equation_1, gap=GAP)


@pytest.mark.parametrize(("frequency", "part"), [(22.20, 0.8), (20.90, 0.9), (23.40, 0.9)])
def test_a_motion_settles_on_its_orbit_though_the_strobe_falls_into_the_wait(frequency, part):
    """The tip touches a quarter of a period after the strobe, and waits there over the next one."""
    law = contact.DelayedRestitution(restitution=0.1, delay=part / frequency)
    strobed = contact.StroboscopicMap(oscillator=equation_1(frequency, law)).at(0.3)
    fast = contact.State(displacement=np.zeros(1), velocity=np.array([2.0]))
    settled = settle(strobed, fast, most_cycles=4000)
    assert settled.m > 1 and settled.impacts == 1
    family = Shooting(oscillator=strobed.oscillator, m=settled.m)
    state = settled.end
    for _ in range(settled.m):
        if state.regime == 4:
            break
        state = strobed.orbit(state, 1).end
    assert state.regime == 4 and state.wait > 0.0
    for start in (settled.end, state):
        orbit = family.from_state(start)
        assert orbit.excess == pytest.approx(0.3, abs=1e-12) and orbit.stable and orbit.admissible
        assert orbit.strobe_state().regime == 4


def map_shift(frequency: float, period: int, delay: float) -> float:
    """rho that a constant delay [s] adds to the map's fold: |b| d/c."""
    nordmark = contact.NordmarkMap.from_oscillator(equation_1(frequency))
    gamma, theta = nordmark.gamma, nordmark.angle
    d = (2 * math.pi / T) * delay / (2.0 * math.sqrt(gamma) * math.sin(theta) * (1.0 + TAU) ** 2)
    g = gamma ** (0.5 * period)
    b = gamma ** (0.5 * (period - 1)) * math.sin(period * theta) / math.sin(theta)
    b /= 1.0 - 2.0 * g * math.cos(period * theta) + g * g
    return -b * d * (1.0 - nordmark.alpha + gamma)


@pytest.mark.parametrize("period", [3, 5])
def test_the_fold_shifts_by_the_maps_part_of_the_hysteresis_at_a_band_edge(period: int) -> None:
    """Towards the upper edge of a band the fold rises by 2 d/X of the hysteresis, in the map and in Eq. (1).

    X is sqrt(x_0) at the fold without delay.  The map's hysteresis there is that of Eq. (1) times
    (1 - tau g)^2/((1 + tau^2 g)(1 + g)), g = gamma^(m/2), and so is the shift: their ratio is right.
    """
    edge = contact.frequency_band(period, free_period=T, decay_rate=MU, restitution=TAU).upper
    wrong = []
    for below in (1e-3, 1e-4):
        frequency = edge * (1.0 - below)
        free = contact.MaximalFamily.from_oscillator(equation_1(frequency), m=period).fold()
        delay = 1e-3 * free.speed / ((2.0 * math.pi * frequency) ** 2 * GAP)
        law = contact.DelayedRestitution(restitution=TAU, delay=delay)
        fold = KickFamily(oscillator=equation_1(frequency, law), m=period).fold(speeds=(1e-7, 1.0))
        nordmark = contact.NordmarkMap.from_oscillator(equation_1(frequency))
        share = map_shift(frequency, period, delay) / -MapFamily(nordmark, period).fold().rho
        wrong.append((fold.excess - free.excess) / -free.excess / share - 1.0)
    assert abs(wrong[1]) < 2e-3 and abs(wrong[1]) < 0.3 * abs(wrong[0])


def test_a_wait_longer_than_the_free_return_holds_the_tip_and_feeds_the_motion() -> None:
    """Slower than a delay/2 the tip is held while it would fly off: period 1 far below grazing."""
    frequency, delay = 23.40, 2e-3
    slow = 0.5 * (2.0 * math.pi * frequency) ** 2 * GAP * delay
    law = contact.DelayedRestitution(restitution=0.1, delay=delay)
    family = Shooting(oscillator=equation_1(frequency, law), m=1)
    for part in (0.3, 0.6, 0.9):
        orbit = family.at_speed(part * slow)
        assert orbit.excess < -0.4 and orbit.stable and orbit.admissible and touches(orbit) == 1
        multipliers, open_by = differences(orbit)
        assert open_by < 1e-12 and apart(multipliers, orbit.multipliers) < 1e-6
        # over many periods the simulated motion stays there
        run = contact.simulate(orbit.oscillator, orbit.state(), periods=50)
        assert run.impacts.approach == pytest.approx(orbit.speed, rel=1e-9)


def test_a_wait_of_all_periods_is_refused() -> None:
    law = contact.DelayedRestitution(restitution=0.1, delay=3.0 / 20.9)
    kicks = KickFamily(oscillator=equation_1(20.90, law), m=3)
    with pytest.raises(contact.NotPeriodic, match="period 3"):
        kicks.orbit(0.1)
    assert KickFamily(oscillator=equation_1(20.90, law), m=4).orbit(0.1).kick.duration == law.delay


def test_an_error_with_an_orbit_whose_law_has_functions_leaves_its_process() -> None:
    """As itself, with its sentence, time, gap and velocity; the orbit stays behind."""
    orbit = Case(oscillator_of(LAWS["delayed by table"], 1)).orbit
    error = orbit.failure(contact.BranchEnded, "it ends here")
    error.orbit = orbit
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is contact.BranchEnded and again.orbit is None and str(again) == str(error)
    assert (again.time, again.gap, again.velocity) == (error.time, error.gap, error.velocity)
