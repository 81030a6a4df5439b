"""Orbits with a touch that waits: the closed form against shooting, the simulated map and the letter's map.

Eq. (1) with a gap of 10.7 mm; laws with constant and with tabulated numbers.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import oscillators
import pytest
from oscillators import apart
from simulated_orbit import differences, touches

from contact.errors import NotPeriodic
from contact.laws import ContactLaw, DelayedRestitution, NewtonRestitution
from contact.maximal_orbits import band
from contact.maximal_orbits import fold as fold_of_map
from contact.nordmark import NordmarkMap
from contact.orbits import orbit_end, settle
from contact.orbits.continuation import fold_of, follow
from contact.orbits.kick import KickFamily
from contact.orbits.lyapunov import orbit_exponents
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State

T, MU, TAU, GAP = 40.80e-3, 3.56, 0.1, 0.0107
LAWS = {
    "constant": DelayedRestitution(restitution=0.1, delay=1e-4),
    "plastic": DelayedRestitution(restitution=0.0, delay=5e-4),
    "elastic": DelayedRestitution(restitution=0.9, delay=2e-3),
    "table": DelayedRestitution(restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 4e-4 + 2e-4 * v),
    "falling": DelayedRestitution(restitution=lambda v: 0.4 * math.exp(-v), delay=lambda v: 2e-4 * v**0.2),
}
PLACES = [(20.90, 3), (21.50, 4), (22.20, 5), (23.40, 11)]


def equation_1(frequency: float, law: ContactLaw) -> ImpactOscillator:
    return oscillators.equation_1(frequency, law, gap=GAP)


def unit_speed(frequency: float) -> float:
    return 2.0 * math.pi * frequency * GAP


def deceleration(frequency: float) -> float:
    """Of the tip at a graze [m/s^2]."""
    return (2.0 * math.pi * frequency) ** 2 * GAP


@pytest.mark.parametrize(("frequency", "period"), PLACES)
def test_without_delay_they_are_newtons(frequency: float, period: int) -> None:
    oscillator = equation_1(frequency, DelayedRestitution(restitution=TAU, delay=0.0))
    newton = equation_1(frequency, NewtonRestitution(local_restitution=TAU))
    kicks, family = (make(oscillator=oscillator, period=period) for make in (KickFamily, Shooting))
    closed = MaximalFamily.from_oscillator(newton, period=period)
    for part in (1e-3, 0.05, 0.5):
        speed = part * unit_speed(frequency)
        expected, kick, found = closed.orbit(speed), kicks.orbit(speed), family.at_speed(speed)
        assert kick.excess == pytest.approx(expected.excess, abs=1e-14)
        assert found.excess == pytest.approx(expected.excess, abs=1e-12)  # where shooting ends
        assert kick.phase == pytest.approx(expected.phase, abs=1e-13)
        assert kick.displacement == pytest.approx(expected.displacement, abs=1e-14)
        assert kick.velocity == pytest.approx(expected.velocity, abs=1e-14)
        assert apart(found.multipliers, expected.multipliers) < 1e-12 / part**2
        assert found.admissible == expected.admissible
    assert kicks.fold().excess == pytest.approx(closed.fold().excess, abs=1e-14)
    assert fold_of(family).excess == pytest.approx(closed.fold().excess, abs=1e-14)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("frequency", "period"), PLACES[:3])
def test_closed_form_shooting_and_simulation_agree(name: str, frequency: float, period: int) -> None:
    law = LAWS[name]
    oscillator = equation_1(frequency, law)
    kicks, family = (make(oscillator=oscillator, period=period) for make in (KickFamily, Shooting))
    seen = 0
    for part in (0.03, 0.1, 0.2, 0.3, 0.5):
        kick, orbit = kicks.orbit(part * unit_speed(frequency)), family.at_speed(part * unit_speed(frequency))
        assert orbit.excess == pytest.approx(kick.excess, abs=1e-13)
        assert orbit.phase == pytest.approx(kick.phase, abs=1e-13)
        assert abs(kicks.error(kick)) < 1e-13 and kick.kick.touches == 1
        v, f = orbit.speed, 1e-4 * orbit.speed
        tau, delay = (g if callable(g) else (lambda _v, g=g: g) for g in (law.restitution, law.delay))
        assert kick.kick.duration == pytest.approx(delay(v), rel=1e-9)
        # tau (tau + tau' v) exp(-c (m/f - delay)), tau' by a difference
        slope = (tau(v + f) - tau(v - f)) / (2.0 * f)
        lost = math.exp(-MU * (period / frequency - delay(v)))
        expected = lost * tau(v) * (tau(v) + slope * v)
        assert np.prod(orbit.multipliers).real == pytest.approx(expected, rel=1e-6, abs=1e-12)
        if orbit.admissible:
            seen += 1
            found, open_by = differences(orbit)
            assert open_by < 1e-11
            assert touches(orbit) == 1
            assert apart(found, orbit.multipliers) < 1e-6
    assert seen >= (1 if name == "elastic" else 2)


@pytest.mark.parametrize("name", ["constant", "falling"])
@pytest.mark.parametrize(("frequency", "period"), PLACES[:3])
def test_folds_are_those_of_the_closed_form_and_of_a_downward_scan(
    name: str, frequency: float, period: int
) -> None:
    oscillator = equation_1(frequency, LAWS[name])
    kicks, family = (make(oscillator=oscillator, period=period) for make in (KickFamily, Shooting))
    fold = fold_of(family)
    assert fold.admissible and abs(fold.multipliers[0] - 1.0) < 1e-7
    assert kicks.fold().excess == pytest.approx(fold.excess, abs=1e-13)
    if name == "constant":
        # A^2 is a quadratic in the speed: three orbits give its minimum
        speeds = fold.speed * np.array([0.5, 1.0, 2.0])
        squares = [kicks.orbit(v).amplitude ** 2 for v in speeds]
        two, one, none = np.polyfit(speeds, squares, 2)
        assert fold.speed == pytest.approx(-one / (2.0 * two), rel=1e-7)
        assert fold.amplitude == pytest.approx(math.sqrt(none - one * one / (4.0 * two)), rel=1e-13)
    node = family.at_speed(1.3 * fold.speed)
    assert node.stable and node.admissible and node.excess > fold.excess
    end = orbit_end(
        StroboscopicMap(oscillator=oscillator), replace(node.strobe_state(), time=0.0), node.excess,
        most_cycles=4000, relative=1e-2,
    )  # fmt: skip
    assert end.lost < fold.excess < end.held


def test_events_of_a_branch_are_seen_by_the_simulation() -> None:
    oscillator = equation_1(22.20, LAWS["constant"])
    family = Shooting(oscillator=oscillator, period=5)
    fold = fold_of(family)
    start, high = family.at_speed(1.5 * fold.speed), 0.6 * unit_speed(22.2)
    branch = follow(family, start, low=0.5 * fold.speed, high=high)
    assert branch.of_kind("fold")[0].excess == pytest.approx(fold.excess, abs=1e-13)
    (graze,) = branch.of_kind("grazing")
    before, after = (family.at_speed(graze.speed * part, graze) for part in (0.999, 1.001))
    assert (before.admissible, after.admissible) == (True, False)
    assert (touches(before), touches(after)) == (1, 2)


def test_a_period_doubling_is_seen_by_the_simulation() -> None:
    family = Shooting(oscillator=equation_1(22.20, LAWS["constant"]), period=4)
    unit = unit_speed(22.20)
    branch = follow(family, family.at_speed(0.36 * unit), low=0.3 * unit, high=0.45 * unit)
    (doubled,) = branch.of_kind("period doubling")
    assert abs(doubled.multipliers[0] + 1.0) < 1e-7
    for part, stable in ((0.99, False), (1.01, True)):
        orbit = family.at_speed(part * doubled.speed, doubled)
        assert orbit.stable == stable and orbit.admissible
        # a small change at the strobe alternates in sign from one period to the next, and grows or shrinks
        strobed, start = StroboscopicMap(oscillator=orbit.oscillator), orbit.strobe_state()
        begin = State(displacement=start.displacement + 1e-7 * GAP, velocity=start.velocity)
        ends = [strobed.orbit(begin, 4 * n).end for n in (3, 4, 13, 14)]
        steps = [float(end.displacement[0] - start.displacement[0]) for end in ends]
        assert steps[0] * steps[1] < 0.0
        assert (abs(steps[3]) > abs(steps[1])) == (not stable)
        assert steps[3] / steps[2] == pytest.approx(orbit.multipliers[0].real, rel=1e-4)


@pytest.mark.parametrize(("frequency", "part"), [(22.20, 0.8), (20.90, 0.9), (23.40, 0.9)])
def test_a_motion_settles_on_its_orbit_though_the_strobe_falls_into_the_wait(
    frequency: float, part: float
) -> None:
    """The tip touches a quarter of a period after the strobe, and waits there over the next one."""
    strobed = StroboscopicMap(
        oscillator=equation_1(frequency, DelayedRestitution(restitution=0.1, delay=part / frequency))
    ).at(0.3)
    fast = State(displacement=np.zeros(1), velocity=np.array([2.0]))
    settled = settle(strobed, fast, most_cycles=4000)
    assert settled.period > 1 and settled.impacts == 1
    family = Shooting(oscillator=strobed.oscillator, period=settled.period)
    state = settled.end
    for _ in range(settled.period):
        if state.regime == 4:
            break
        state = strobed.orbit(state, 1).end
    assert state.regime == 4 and state.wait > 0.0
    for start in (settled.end, state):
        orbit = family.from_state(start)
        assert orbit.excess == pytest.approx(0.3, abs=1e-12) and orbit.stable and orbit.admissible
        assert orbit.strobe_state().regime == 4


def test_exponents_are_the_logarithms_of_the_multipliers() -> None:
    family = Shooting(oscillator=equation_1(22.20, LAWS["table"]), period=5)
    orbit = family.at_speed(0.15 * unit_speed(22.2))
    assert orbit.stable and orbit.admissible
    found = orbit_exponents(StroboscopicMap(oscillator=orbit.oscillator), orbit.strobe_state(), 5).values
    assert found == pytest.approx(np.log(np.abs(orbit.multipliers)) / 5.0, rel=1e-6)


@pytest.mark.parametrize("excess", [1e-4, 1e-3])
def test_two_touches_with_a_wait_each(excess: float) -> None:
    oscillator = equation_1(22.20, DelayedRestitution(restitution=0.1, delay=2e-3))
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = settle(strobed.at(excess), strobed.at(-1e-3).steady(), most_cycles=2000)
    assert (settled.period, settled.impacts) == (6, 2)
    family = Shooting(oscillator=oscillator.with_excess(excess), period=6, impacts=2)
    orbit = family.from_state(settled.end)
    assert orbit.admissible and orbit.stable and touches(orbit) == 2
    multipliers, open_by = differences(orbit)
    assert open_by < 1e-12 and apart(multipliers, orbit.multipliers) < 1e-7


# ------------------------------------------------------------------------------------------ the letter's map


@pytest.mark.parametrize(("frequency", "period"), PLACES)
def test_a_short_delay_lifts_slow_orbits_as_in_the_map(frequency: float, period: int) -> None:
    """rho(X) = (a X^2 + b (X - d))/c: at X = 0 the delay alone is left, -b d/c, to first order."""
    nordmark = NordmarkMap.from_frequencies(
        drive_frequency=frequency, free_period=T, decay_rate=MU, restitution=TAU
    )
    wrong = []
    for delay in (1e-5, 1e-6):
        kicks = KickFamily(
            oscillator=equation_1(frequency, DelayedRestitution(restitution=TAU, delay=delay)), period=period
        )
        slow = kicks.orbit(1e-9 * unit_speed(frequency)).excess
        wrong.append(slow / nordmark.excess(map_shift(frequency, period, delay)) - 1.0)
    assert abs(wrong[1]) < 5e-3 * (1.0 if period < 11 else 10.0)
    assert wrong[0] / wrong[1] == pytest.approx(10.0, rel=0.2)


def map_shift(frequency: float, period: int, delay: float) -> float:
    """rho that a constant delay [s] adds to the map's fold: |b| d/c."""
    nordmark = NordmarkMap.from_frequencies(
        drive_frequency=frequency, free_period=T, decay_rate=MU, restitution=TAU
    )
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
    edge = band(period, free_period=T, decay_rate=MU, restitution=TAU).upper
    wrong = []
    for below in (1e-3, 1e-4):
        frequency = edge * (1.0 - below)
        newton = equation_1(frequency, NewtonRestitution(local_restitution=TAU))
        free = MaximalFamily.from_oscillator(newton, period=period).fold()
        delay = 1e-3 * free.speed / deceleration(frequency)
        law = DelayedRestitution(restitution=TAU, delay=delay)
        fold = KickFamily(oscillator=equation_1(frequency, law), period=period).fold(speeds=(1e-7, 1.0))
        nordmark = NordmarkMap.from_frequencies(
            drive_frequency=frequency, free_period=T, decay_rate=MU, restitution=TAU
        )
        share = map_shift(frequency, period, delay) / -fold_of_map(nordmark, period).rho
        wrong.append((fold.excess - free.excess) / -free.excess / share - 1.0)
    assert abs(wrong[1]) < 2e-3
    assert abs(wrong[1]) < 0.3 * abs(wrong[0])


# ------------------------------------------------------------------------------------------------ long waits


def test_a_wait_longer_than_the_free_return_holds_the_tip_and_feeds_the_motion() -> None:
    """Slower than a delay/2 the tip is held while it would fly off: period 1 far below grazing."""
    frequency, delay = 23.40, 2e-3
    slow = 0.5 * deceleration(frequency) * delay
    family = Shooting(
        oscillator=equation_1(frequency, DelayedRestitution(restitution=0.1, delay=delay)), period=1
    )
    for part in (0.3, 0.6, 0.9):
        orbit = family.at_speed(part * slow)
        assert orbit.excess < -0.4 and orbit.stable and orbit.admissible and touches(orbit) == 1
        multipliers, open_by = differences(orbit)
        assert open_by < 1e-12 and apart(multipliers, orbit.multipliers) < 1e-6
        # over many periods the simulated motion stays there
        run = simulate(orbit.oscillator, orbit.state(), periods=50)
        assert run.impacts.approach == pytest.approx(orbit.speed, rel=1e-9)


def test_a_wait_of_all_periods_is_refused() -> None:
    law = DelayedRestitution(restitution=0.1, delay=3.0 / 20.9)
    kicks = KickFamily(oscillator=equation_1(20.90, law), period=3)
    with pytest.raises(NotPeriodic, match=r"no orbit of period 3 has a touch that waits for 0\.14354"):
        kicks.orbit(0.1)
    with pytest.raises(NotPeriodic, match="does not end within half a drive period"):
        kicks.kick(0.1, np.zeros((1, 2)))
    assert KickFamily(oscillator=equation_1(20.90, law), period=4).orbit(0.1).kick.duration == law.delay
    with pytest.raises(ValueError, match="speed is nan"):
        kicks.orbit(math.nan)
