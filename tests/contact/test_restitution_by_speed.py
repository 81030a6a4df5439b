"""A restitution that depends on the approach speed: by function, by table, and against the constant one."""

import math
import pickle
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from oscillators import GAP, PHI, THROWN, equation_1, newton, spring
from simulated_orbit import beam
from whole_motions import falling_body

import contact
from contact import NewtonRestitution, State, Stop, simulate
from contact.integrators import MoreauJean, NonsmoothGeneralisedAlpha
from contact.orbits import Change, KickFamily, MaximalFamily, Shooting, fold_excess, motion_derivatives

E0, V0 = 0.6, 2.0


def falls(speed: float) -> float:
    """e(v) = E0/(1 + v/V0)."""
    return E0 / (1.0 + speed / V0)


BY_SPEED = NewtonRestitution(local_restitution=falls)


def at_speed(speed: float, law: NewtonRestitution) -> float:
    """e of one impact at this speed, of a falling body."""
    start = State(displacement=np.array([0.3]), velocity=np.array([speed]))
    return -simulate(falling_body(0.3, law), start, duration=1e-9).impacts.rebound[0] / speed


def test_a_bouncing_ball_rebounds_as_its_speed_says_and_stays_at_last():
    """The ball of weight g meets the floor with v_(n+1) = e(v_n) v_n, after a flight of 2 v_(n+1)/g."""
    g, height = 9.81, 0.3
    run = simulate(falling_body(height, BY_SPEED), duration=2.0)
    speed, time = math.sqrt(2.0 * g * height), math.sqrt(2.0 * height / g)
    hits = run.impacts
    for hit in zip(hits.start[:10], hits.approach, hits.rebound, hits.loss, strict=False):
        left = falls(speed) * speed
        assert hit == pytest.approx((time, speed, -left, 0.5 * (speed**2 - left**2)), rel=1e-9)
        speed, time = left, time + 2.0 * left / g
    assert run.end.regime == contact.Regime.SUSTAINED


def test_a_rebound_without_delay_is_the_same_motion():
    """200 periods of Eq. (1) from a stable orbit."""
    twin = contact.DelayedRestitution(restitution=falls, delay=0.0)
    orbit = Shooting(oscillator=equation_1(22.2, BY_SPEED, gap=GAP), m=5).orbits(0.01)[-1]
    stops = (Stop(gap=GAP, law=law) for law in (BY_SPEED, twin))
    runs = (simulate(replace(orbit.oscillator, stop=stop), orbit.state(), periods=200) for stop in stops)
    one, other = (run.impacts for run in runs)
    assert orbit.stable and len(one) == len(other) >= 40
    assert one.approach == pytest.approx(other.approach, rel=1e-9)
    assert one.rebound == pytest.approx(other.rebound, rel=1e-9)


@pytest.mark.parametrize("modes", [1, 4])
def test_orbits_are_those_of_the_constant_at_their_speed_but_for_their_multipliers(modes):
    """The product of the multipliers is G e (e + e' v), with the free flow's G; the fold has least excess."""
    oscillator = equation_1(22.2, BY_SPEED, gap=GAP) if modes == 1 else beam(22.2, BY_SPEED, modes)
    free = math.exp(-5.0 * oscillator.period * np.sum(oscillator.model.decay_rate))

    def excess(speed: float) -> float:
        family = MaximalFamily.from_oscillator(oscillator, m=5, local_restitution=falls(speed))
        return family.orbit(speed).excess

    family, kicks = (kind(oscillator=oscillator, m=5) for kind in (Shooting, KickFamily))
    for speed in (0.01, 0.1, 0.5):
        orbit, e = family.at_speed(speed), falls(speed)
        assert (orbit.excess, kicks.excess(speed)) == pytest.approx((excess(speed),) * 2, abs=1e-11)
        turned = e - e * speed / (V0 + speed)
        assert np.prod(orbit.multipliers).real == pytest.approx(free * e * turned, rel=1e-6)
    fold = family.fold()
    assert fold.excess < min(excess(fold.speed * (1.0 + part)) for part in (-1e-3, 1e-3))
    ends = fold_excess(contact.StroboscopicMap(oscillator=oscillator), 5), excess(fold.speed)
    assert ends == pytest.approx((fold.excess,) * 2, abs=1e-11)
    with pytest.raises(TypeError, match="constant restitution"):
        MaximalFamily(oscillator=oscillator, m=5)


@pytest.mark.parametrize("given", [falls, [[0.0, 0.3, 3.0], [0.6, 0.5, 0.2]]])
def test_the_strobe_map_and_a_shift_of_the_law_have_the_derivatives_of_differences(given):
    oscillator = spring(3, NewtonRestitution(local_restitution=given), drive=(21.5, 1e-4))
    change, start = Change(law=(1.0, 0.0)), np.array([*THROWN.displacement, *THROWN.velocity, 0.0])
    found = motion_derivatives(oscillator, THROWN, [change], periods=1)
    assert len(found.trajectory.impacts) >= 1

    def end(numbers: np.ndarray) -> np.ndarray:
        state = State(displacement=numbers[:3], velocity=numbers[3:6])
        run = simulate(change.applied(oscillator, numbers[6]), state, periods=1)
        return np.append(run.strobe_displacement[-1], run.strobe_velocity[-1])

    steps = np.diag([1e-9] * 3 + [1e-7] * 4)
    columns = [(end(start + row) - end(start - row)) / (2.0 * row.sum()) for row in steps]
    off = np.abs(found.strobes[-1] - np.column_stack(columns))
    assert np.all(off < 1e-5 * np.abs(found.strobes[-1]).max(axis=0))


@pytest.mark.parametrize("modes", [1, 3])
def test_a_constant_function_moves_as_the_number(modes):
    laws = newton(0.6), NewtonRestitution(local_restitution=lambda _speed: 0.6)
    start = State(displacement=THROWN.displacement[:modes], velocity=THROWN.velocity[:modes])
    plain, other = (simulate(spring(modes, law, drive=(21.5, 1e-4)), start, periods=3) for law in laws)
    assert len(plain.impacts) >= 1 and np.array_equal(plain.end.displacement, other.end.displacement)
    assert np.array_equal(plain.impacts.loss, other.impacts.loss)


def test_a_table_of_a_function_is_the_function_and_no_cubic_leaves_zero_to_one():
    """Monotone cubics through points `h` apart are right to h^2 at least; a corner is cut by h/4 at most."""
    points = np.linspace(0.0, 5.0, 81)
    table = NewtonRestitution(local_restitution=[points, [falls(v) for v in points]])
    assert max(abs(at_speed(v, table) - falls(v)) for v in (0.03, 0.7, 2.0, 4.99)) < (5.0 / 80) ** 2 / 100
    assert at_speed(7.0, table) == pytest.approx(falls(5.0), rel=1e-14)
    corner = NewtonRestitution(local_restitution=lambda v: max(0.0, 1.0 - v / V0))
    cut = 0.25 * (1e6 ** (1.0 / 1024.0) - 1.0)
    for speed in V0 * np.linspace(0.97, 1.03, 61):
        assert 0.0 <= at_speed(speed, corner) <= max(0.0, 1.0 - speed / V0) + cut


@pytest.mark.parametrize("method", [MoreauJean, partial(NonsmoothGeneralisedAlpha, rho=0.6)])
def test_percussions_take_the_restitution_at_the_speed_before_them(method):
    oscillator, off = spring(3, BY_SPEED, drive=(21.5, 1e-4)), []
    exact = simulate(oscillator, THROWN, duration=0.005)
    for count in (400.5, 6400.5):
        step = exact.impacts.start[0] / count
        run = simulate(oscillator, THROWN, duration=0.005, method=method(step=step))
        off.append(abs((run.end.displacement - exact.end.displacement) @ PHI[:3]))
    assert run.impacts.rebound == pytest.approx(exact.impacts.rebound, rel=2e-3)
    assert off[1] < min(1e-6, 0.2 * off[0])


def test_laws_pickle_compare_and_are_the_number_at_the_lowest_speed():
    rows = [[0.0, 1.0, 3.0], [0.9, 0.4, 0.3]]
    table, same = (NewtonRestitution(local_restitution=given) for given in (rows, np.array(rows)))
    for law in (BY_SPEED, table, BY_SPEED.moved(0.1, 0.0), table.moved(0.1, 0.0)):
        again = pickle.loads(pickle.dumps(law))
        assert np.array_equal(again.table, law.table) and again.numbers == law.numbers
    assert table == same and len({table, same, BY_SPEED, newton(0.9)}) == 3
    by_table, constant = (equation_1(22.2, law, gap=GAP) for law in (table, newton(0.9)))
    assert contact.NordmarkMap.from_oscillator(by_table) == contact.NordmarkMap.from_oscillator(constant)
