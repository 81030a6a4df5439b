"""A restitution that depends on the approach speed: by function, by table, and against the constant one."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from oscillators import GAP, PHI, THROWN, apart, equation_1, newton, spring
from simulated_orbit import beam, differences
from whole_motions import falling_body

import contact
from contact import DelayedRestitution, NewtonRestitution, State, simulate
from contact.orbits import Change, KickFamily, MaximalFamily, Shooting, fold_excess, motion_derivatives

E0, V0 = 0.6, 2.0


def falls(speed: float) -> float:
    """e(v) = E0/(1 + v/V0)."""
    return E0 / (1.0 + speed / V0)


BY_SPEED = NewtonRestitution(local_restitution=falls)


def test_a_bouncing_ball_rebounds_as_its_speed_says_and_stays_at_last():
    """The ball of weight g meets the floor with v_(n+1) = e(v_n) v_n, after a flight of 2 v_(n+1)/g."""
    g, height = 9.81, 0.3
    run = simulate(falling_body(height, BY_SPEED), duration=2.0)
    speed, time = math.sqrt(2.0 * g * height), math.sqrt(2.0 * height / g)
    for hit in range(10):
        assert run.impacts.approach[hit] == pytest.approx(speed, rel=1e-9)
        assert run.impacts.start[hit] == pytest.approx(time, rel=1e-9)
        loss = 0.5 * speed**2 * (1.0 - falls(speed) ** 2)
        speed *= falls(speed)
        assert run.impacts.rebound[hit] == pytest.approx(-speed, rel=1e-9)
        assert run.impacts.loss[hit] == pytest.approx(loss, rel=1e-9)
        time += 2.0 * speed / g
    assert run.end.regime == contact.Regime.SUSTAINED


def test_a_rebound_without_delay_is_the_same_motion():
    """200 periods of Eq. (1) from a stable orbit."""
    twin = DelayedRestitution(restitution=falls, delay=0.0)
    orbit = Shooting(oscillator=equation_1(22.2, BY_SPEED, gap=GAP), period=5).orbits(0.01)[-1]
    assert orbit.stable and orbit.admissible
    one, other = (
        simulate(replace(orbit.oscillator, stop=contact.Stop(gap=GAP, law=law)), orbit.state(), periods=200)
        for law in (BY_SPEED, twin)
    )
    assert len(one.impacts) == len(other.impacts) >= 40
    assert one.impacts.approach == pytest.approx(other.impacts.approach, rel=1e-9)
    assert one.impacts.rebound == pytest.approx(-falls(orbit.speed) * orbit.speed, rel=1e-9)


@pytest.mark.parametrize("speed", [0.01, 0.1, 0.2])
@pytest.mark.parametrize("modes", [1, 4])
def test_an_orbit_is_that_of_the_constant_at_its_speed_and_its_tangent_is_not(modes, speed):
    """det of one period with an impact is G e (e + e' v), G that of the free flow."""
    oscillator = equation_1(22.2, BY_SPEED, gap=GAP) if modes == 1 else beam(22.2, BY_SPEED, modes)
    orbit = Shooting(oscillator=oscillator, period=5).at_speed(speed)
    closed = MaximalFamily.from_oscillator(oscillator, period=5, restitution=falls(speed)).orbit(speed)
    kicked = KickFamily(oscillator=oscillator, period=5).orbit(speed)
    assert orbit.excess == pytest.approx(closed.excess, abs=1e-11)
    assert kicked.excess == pytest.approx(closed.excess, abs=1e-11)
    free = math.exp(-5.0 * oscillator.period * np.sum(oscillator.model.decay_rate))
    e, slope = falls(speed), -E0 / V0 / (1.0 + speed / V0) ** 2
    assert np.prod(orbit.multipliers).real == pytest.approx(free * e * (e + slope * speed), rel=1e-6)
    assert orbit.admissible
    multipliers, open_by = differences(orbit)
    assert open_by < 1e-9 and apart(multipliers, orbit.multipliers) < 1e-5


def test_the_family_is_followed_through_its_fold():
    """The fold by shooting is the least excess of the closed orbits with e(v) in place of e."""
    oscillator = equation_1(22.2, BY_SPEED, gap=GAP)
    fold = Shooting(oscillator=oscillator, period=5).fold()

    def closed(speed: float) -> float:
        family = MaximalFamily.from_oscillator(oscillator, period=5, restitution=falls(speed))
        return family.orbit(speed).excess

    near = fold.speed * np.array([1.0 - 1e-3, 1.0, 1.0 + 1e-3])
    low, least, high = map(closed, near)
    assert fold.excess == pytest.approx(least, abs=1e-11) and least < min(low, high)
    strobed = contact.StroboscopicMap(oscillator=oscillator)
    assert fold_excess(strobed, 5) == pytest.approx(fold.excess, abs=1e-11)
    with pytest.raises(TypeError, match="constant restitution"):
        MaximalFamily(oscillator=oscillator, period=5)


@pytest.mark.parametrize("given", [falls, [[0.0, 0.3, 3.0], [0.6, 0.5, 0.2]]])
def test_the_strobe_map_and_a_shift_of_the_law_have_the_derivatives_of_differences(given):
    law = NewtonRestitution(local_restitution=given)
    oscillator, change = spring(3, law, drive=(21.5, 1e-4)), Change(law=(1.0, 0.0))
    found = motion_derivatives(oscillator, THROWN, [change], periods=1)
    assert len(found.run.impacts) >= 1

    def end(shift: np.ndarray) -> np.ndarray:
        state = State(displacement=THROWN.displacement + shift[:3], velocity=THROWN.velocity + shift[3:6])
        run = simulate(change.applied(oscillator, shift[6]), state, periods=1)
        return np.append(run.strobe_displacement[-1], run.strobe_velocity[-1])

    steps = np.array([1e-9] * 3 + [1e-7] * 3 + [1e-7])
    columns = [(end(row) - end(-row)) / (2.0 * h) for row, h in zip(np.diag(steps), steps, strict=True)]
    off = np.abs(found.strobes[-1] - np.column_stack(columns))
    assert np.all(off < 1e-5 * np.abs(found.strobes[-1]).max(axis=0))


@pytest.mark.parametrize("modes", [1, 3])
def test_a_constant_function_and_a_flat_table_move_as_the_number(modes):
    laws = [newton(0.6), NewtonRestitution(local_restitution=lambda _speed: 0.6)]
    laws += [NewtonRestitution(local_restitution=np.array([[0.0, 1.0], [0.6, 0.6]]))]
    start = State(displacement=THROWN.displacement[:modes], velocity=THROWN.velocity[:modes])
    plain, *others = (simulate(spring(modes, law, drive=(21.5, 1e-4)), start, periods=3) for law in laws)
    assert len(plain.impacts) >= 1
    for run in others:
        assert np.array_equal(run.end.displacement, plain.end.displacement)
        assert np.array_equal(run.impacts.rebound, plain.impacts.rebound)
        assert np.array_equal(run.impacts.loss, plain.impacts.loss)


def test_a_table_of_a_function_is_the_function():
    """The error of a monotone cubic through speeds `h` apart falls at least as h^2."""
    start = State(displacement=np.zeros(1), velocity=np.array([2.0]))
    exact, off = simulate(falling_body(0.3, BY_SPEED), start, duration=0.3).impacts.rebound[0], []
    for count in (20, 40, 80):
        speed = np.linspace(0.0, 5.0, count)
        law = NewtonRestitution(local_restitution=[speed, [falls(v) for v in speed]])
        off.append(abs(simulate(falling_body(0.3, law), start, duration=0.3).impacts.rebound[0] - exact))
    assert max(off) < 1e-3 and off[-1] < 1e-5


@pytest.mark.parametrize(
    "make",
    [
        contact.integrators.MoreauJean,
        lambda step: contact.integrators.NonsmoothGeneralisedAlpha(step=step, rho=0.6),
    ],
)
def test_percussions_take_the_restitution_at_the_speed_before_them(make):
    """The rebound of a free step is exactly -e(v) v; the motion tends to the exact one with the step."""
    oscillator, ends = spring(3, BY_SPEED, drive=(21.5, 1e-4)), []
    exact = simulate(oscillator, THROWN, duration=0.005)
    for count in (400, 1600, 6400):
        run = simulate(
            oscillator, THROWN, duration=0.005, method=make(step=exact.impacts.start[0] / (count + 0.5))
        )
        ends.append(np.abs((run.end.displacement - exact.end.displacement) @ PHI[:3]))
        assert len(run.impacts) == 1
    assert run.impacts.rebound[0] == pytest.approx(exact.impacts.rebound[0], rel=2e-3)
    assert ends[2] < 1e-6 and ends[2] < 0.2 * ends[0]


def test_no_cubic_leaves_zero_to_one_though_the_function_has_a_corner():
    """A ball too fast for e = max(0, 1 - v/V0) stays; one just below the corner leaves slowly."""
    law = NewtonRestitution(local_restitution=lambda v: max(0.0, 1.0 - v / V0))
    rounded = 0.25 * V0 * (1e6 ** (1.0 / 1024.0) - 1.0)  # a quarter of an interval of the table
    for speed in V0 * np.linspace(0.97, 1.03, 61):
        start = State(displacement=np.array([0.3]), velocity=np.array([speed]))
        rebound = simulate(falling_body(0.3, law), start, duration=1e-3).impacts.rebound[0]
        assert -rounded - max(0.0, V0 - speed) * speed / V0 <= rebound <= 0.0


def test_laws_pickle_compare_and_are_the_number_at_the_lowest_speed():
    table = NewtonRestitution(local_restitution=[[0.0, 1.0, 3.0], [0.9, 0.4, 0.3]])
    for law in (BY_SPEED, table, BY_SPEED.moved(0.1, 0.0), table.moved(0.1, 0.0)):
        again = pickle.loads(pickle.dumps(law))
        assert np.array_equal(again.table, law.table) and again.numbers == law.numbers
    assert table == NewtonRestitution(local_restitution=np.array([[0.0, 1.0, 3.0], [0.9, 0.4, 0.3]]))
    assert len({table, BY_SPEED, newton(0.9)}) == 3
    oscillator = equation_1(22.2, table, gap=GAP)
    assert oscillator.local_restitution == 0.9 and table.adjustable == (0.9,)
    constant = contact.NordmarkMap.from_oscillator(equation_1(22.2, newton(0.9), gap=GAP))
    assert contact.NordmarkMap.from_oscillator(oscillator) == constant
    assert NewtonRestitution(local_restitution=falls).moved(0.1, 0.0).numbers[0] == pytest.approx(
        E0 + 0.1, rel=1e-4
    )
