"""Flights that start on the wall, and degenerate touches: none missed and none invented."""

import math

import numpy as np
import pytest
import tip_judge
from oscillators import modes_on_stop, slow
from tip_judge import PLANTED, Real, Signal, judge, random_deviation, random_oscillator, search, with_gap

from contact.flight.crossing import CROSSES, FREE, GRAZES, UNRESOLVED
from contact.flight.elementary import EPS
from contact.flight.tip import tip_bound, tip_rounding, tip_state
from contact.touch.newton import acceleration_rounding, newton_impact

pytestmark = tip_judge.LONG_DOUBLE


def on_the_wall(generator: np.random.Generator, n_modes: int, order: int) -> tuple:
    """A driven oscillator and a state whose height has `order` derivatives zero, the next one negative.

    Returns motion, base, u, v and a direction (du, dv) along which all of this stays so.
    """
    numbers = random_oscillator(generator, n_modes).numbers()
    base = float(generator.uniform(0, 0.5) * numbers.period)
    u, v = random_deviation(generator, numbers, ringing=True)
    phi, o2, c = numbers.phi, numbers.omega**2, numbers.decay
    scale = numbers.omega.max() ** np.arange(4)
    # derivatives of the height are linear in (u, v): rows of shape (2 n,)
    rows = [np.concatenate([phi, 0 * phi]), np.concatenate([0 * phi, phi])]
    a, b = -o2, -c
    for _ in range(2):
        rows.append(np.concatenate([phi * a, phi * b]))
        a, b = -o2 * b, a - c * b
    rows = np.array(rows[: order + 1]) / scale[: order + 1, None]
    weight = np.concatenate([1 / np.abs(phi), numbers.omega / np.abs(phi)])
    steady = np.array(tip_state(numbers, base, 0 * u, 0 * v))
    third, wanted = -(numbers.drive**2) * steady[1], np.zeros(order + 1)
    wanted[order] = -generator.uniform(0.02, 0.3) * 0.01
    wanted -= np.array([*steady, third])[: order + 1] / scale[: order + 1]
    state, pinned = np.concatenate([u, v]), rows * weight
    for _ in range(3):  # refined, so that the vanishing derivatives vanish to rounding
        state = state + weight * np.linalg.lstsq(pinned, wanted - rows @ state, rcond=None)[0]
    direction = generator.normal(size=2 * n_modes)
    direction = weight * (direction - np.linalg.pinv(pinned) @ (pinned @ direction)) * 0.01
    return numbers, base, *state.reshape(2, n_modes).copy(), *direction.reshape(2, n_modes)


@pytest.mark.parametrize("n_modes", [3, *slow(4, 6)])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_flights_from_the_wall(order, n_modes):
    """After an impact (1), a plastic one or a graze (2), a release (3): the start is no touch.

    The motion is bent along a direction that leaves the start as it is until its highest later peak stands h
    above or below the stop.
    """
    generator = np.random.default_rng([10, order, n_modes])
    counts = {"free": 0, "crosses": 0, "within rounding": 0}
    for _ in range(8):
        numbers, base, u, v, du, dv = on_the_wall(generator, n_modes, order)
        duration = numbers.period - base
        for h in PLANTED:
            lam, bent = 0.0, None
            for _ in range(8):
                signal = Signal(numbers, base, u + lam * du, v + lam * dv)
                x = signal(signal.samples(duration))
                places = signal.peaks(duration, above=max(0.9 * x.max(), 0.8 * numbers.gap))
                places = places[places > 1e-3 * numbers.period]
                if places.size == 0:
                    break
                top = places[np.argmax(signal(places))]
                excess = float(signal(top) - Real(numbers.gap) * (1 + Real(h)))
                if abs(excess) < max(1e-14, 0.05 * abs(h)) * numbers.gap:
                    bent = lam
                    break
                ahead = Signal(numbers, base, u + (lam + 1.0) * du, v + (lam + 1.0) * dv)
                slope = float(ahead(top) - signal(top))
                lam = lam - excess / slope if slope else math.inf
                if abs(lam) > 20:
                    break
            if bent is None:
                continue
            un, vn = u + bent * du, v + bent * dv
            result = search(numbers, base, un, vn, duration, order)
            # the height at the start is zero within rounding: leave it out, as the search does
            early = Real(1e-4) * numbers.period
            assert signal(early) < numbers.gap
            tops = signal.peaks(duration, above=0.9 * numbers.gap)
            verdict = judge(signal, numbers.gap, duration, start=early, peaks=tops)
            counts[tip_judge.assert_agrees(result, verdict, numbers, un, vn, base)] += 1
    assert min(counts["free"], counts["crosses"]) > 8


@pytest.mark.parametrize("restitution", [0.0, 1e-3, 0.7, *slow(1e-6, 0.1, 1.0)])
def test_overtones_ringing_after_an_impact(restitution):
    """Twenty modes hit the stop together; the next touch, often within a fraction of an overtone's period."""
    generator = np.random.default_rng([11, int(1e6 * restitution)])
    touches, early = 0, 0
    for _ in range(25):
        numbers = random_oscillator(generator, 20).numbers()
        u, v = random_deviation(generator, numbers, ringing=False)
        base = float(generator.uniform(0, 0.5) * numbers.period)
        u[0] -= tip_state(numbers, base, u, v)[0] / numbers.phi[0]
        v[0] += (generator.uniform(0.01, 1.0) - tip_state(numbers, base, u, v)[1]) / numbers.phi[0]
        newton_impact(numbers, v, tip_state(numbers, base, u, v)[1], restitution)
        acceleration = tip_state(numbers, base, u, v)[2]
        if restitution < 1e-3 and acceleration > 0:
            continue  # the tip stays, or chatters
        duration = numbers.period - base
        outcome, s = search(numbers, base, u, v, duration, 1 if restitution > 0 else 2)
        assert outcome in (CROSSES, FREE)
        signal = Signal(numbers, base, u, v)
        fine = np.linspace(0.0, duration, 12_000)
        heights = signal(fine) - numbers.gap
        above = fine[1:][heights[1:] > 1e-12]
        if outcome == FREE:
            assert above.size == 0
            continue
        touches += 1
        early += s < 0.2 * 2 * np.pi / numbers.omega[0]
        assert abs(signal(Real(s)) - Real(numbers.gap)) <= tip_rounding(numbers, u, v)
        assert signal(Real(s), 1) > 0
        assert above.size == 0 or above[0] > s - 1e-12
        assert np.all(heights[(fine > 1e-9) & (fine < s)] < 1e-12)
    assert touches > 5 and early > 0


def test_impact_with_next_to_no_speed_is_still_left():
    """Approach speeds down to 1e-13 m/s at a peak: the tip departs, for any restitution."""
    numbers = modes_on_stop(150.0, 3.0).numbers()
    for speed in 10.0 ** -np.arange(1.0, 14.0):
        outcome, s = search(numbers, 0.0, np.array([0.01]), np.array([-speed]), numbers.period, 1)
        assert outcome == FREE and s == numbers.period


def degenerate(flatness: float, third: float) -> tuple:
    """Four undamped modes with height and velocity zero, acceleration -`flatness`, third derivative `third`.

    Returns motion (gap set to the height there), u, v at s = 0, and the time 0.01 s of all this.
    """
    omega = np.array([100.0, 210.0, 330.0, 470.0])
    numbers = modes_on_stop(omega).numbers()
    # q cos(omega (s - s0)) + p sin(omega (s - s0)): even derivatives from q, odd ones from p
    q = np.linalg.solve([np.ones(4), -(omega**2), omega**4, [1.0, 0, 0, 0]], [0.01, -flatness, -5e5, 0.008])
    p = np.linalg.solve([omega, -(omega**3), [1.0, 0, 0, 0], [0, 0, 0, 1.0]], [0.0, third, 0.0, 0.0])
    time = 0.01
    u = q * np.cos(omega * time) - p * np.sin(omega * time)
    v = omega * (q * np.sin(omega * time) + p * np.cos(omega * time))
    return numbers, u, v, time


@pytest.mark.parametrize("third", [0.0, 1.0, *slow(1e-3, 300.0)])
@pytest.mark.parametrize("flatness", [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("h", [0.0, 1e-15, -1e-15, 1e-13, -1e-13, 1e-10, -1e-10, 1e-6, -1e-6])
def test_tangency_with_no_acceleration_is_right_or_refused(third, flatness, h):
    """Height, velocity and acceleration vanish together: CROSSES only if it does, FREE only if not."""
    numbers, u, v, time = degenerate(flatness, third)
    signal, duration = Signal(numbers, 0.0, u, v), 0.016
    # fine samples about the flat top, in long double: it may hold two peaks a few microseconds apart
    fine = np.linspace(-1, 1, 4001)
    fine = Real(time) + Real(2e-3) * fine**3
    places = np.union1d(signal.peaks(duration, samples=fine), signal.peaks(float(fine[0])))
    assert np.all(signal(np.linspace(float(fine[-1]), duration, 500)) < 0.01)
    heights = signal(places)
    top = heights[np.argmin(np.abs(heights - 0.01))]
    gap = float(top / (1 + Real(h)))
    stopped = with_gap(numbers, gap)
    verdict = judge(signal, gap, duration, peaks=places)
    outcome, s = search(stopped, 0.0, u, v, duration)
    bound = tip_rounding(stopped, u, v)
    if outcome == UNRESOLVED:
        assert abs(signal(Real(s)) - Real(gap)) <= 4 * bound, "gave up away from the stop"
        assert abs(h) < 1e-11, "gave up on a peak that is clear of rounding"
    elif outcome == GRAZES:
        assert abs(verdict.peak) <= 2 * bound
    elif outcome == FREE:
        assert verdict.peak <= 0
    else:
        assert verdict.peak > 0
        # where the root is blurred, its height is what is certain
        assert abs(signal(Real(s)) - Real(gap)) <= bound
        assert s <= verdict.time + bound / verdict.slope + 1e-15 or abs(h) < 1e-13


def test_rising_inflection_on_the_stop_is_a_crossing_or_refused():
    """y ~ (s - s0)^3 at the stop, and the same lifted or lowered by a little: the motion passes through."""
    for lift in (0.0, 1e-16, -1e-16, 1e-14, -1e-14, 1e-11, -1e-11, 1e-8, -1e-8):
        numbers, u, v, time = degenerate(0.0, 5e4)
        omega = numbers.omega
        # without the even part beyond the height: a cubic to leading order
        q = np.linalg.solve([np.ones(4), -(omega**2), omega**4, -(omega**6)], [0.01, 0.0, 0.0, 0.0])
        p = np.linalg.solve([omega, -(omega**3), omega**5, -(omega**7)], [0.0, 5e4, 0.0, 0.0])
        u = q * np.cos(omega * time) - p * np.sin(omega * time)
        v = omega * (q * np.sin(omega * time) + p * np.cos(omega * time))
        stopped = with_gap(numbers, 0.01 + lift)
        signal = Signal(numbers, 0.0, u, v)
        fine = np.linspace(0, 0.014, 20_000)
        assert np.all(signal(fine[fine < 0.009]) < 0.0099999)
        assert np.all(signal(fine[fine > 0.011]) > 0.010001)
        outcome, s = search(stopped, 0.0, u, v, 0.014)
        assert outcome in (CROSSES, UNRESOLVED)
        assert abs(signal(Real(s)) - Real(stopped.gap)) <= 2 * tip_rounding(stopped, u, v)
        if abs(lift) >= 1e-11:
            assert outcome == CROSSES


def test_on_the_wall_and_pressed_is_refused():
    """A leading derivative that leads into the wall cannot begin a flight: UNRESOLVED at the start."""
    generator = np.random.default_rng(12)
    for order in (1, 2, 3):
        numbers, base, u, v, _du, _dv = on_the_wall(generator, 5, order)
        assert search(numbers, base, u, v, 0.3 * numbers.period, order)[0] in (CROSSES, FREE)
        # everything reversed, the stop too: the same derivatives vanish, the next one has the other sign
        names = "tip_sine", "tip_cosine", "gap", "level"
        mirrored = numbers._replace(**{name: -getattr(numbers, name) for name in names})
        assert search(mirrored, base, -u, -v, 0.3 * numbers.period, order) == (UNRESOLVED, 0.0)


@pytest.mark.parametrize("speed", [1.0, 1e-3, 1e-6])
def test_tip_on_the_wall_within_rounding_is_judged_by_its_velocity(speed):
    numbers = modes_on_stop([150.0, 700.0], [3.0, 9.0], [1.0, 2.0]).numbers()
    for ulps in (-2, -1, 0, 1, 2):
        u = np.array([0.01 * (1 + ulps * EPS), 0.0])
        outcome, s = search(numbers, 0.0, u, np.array([speed, 0.0]), 1e-3)
        assert outcome == CROSSES and 0.0 <= s <= 3 * EPS * 0.01 / speed
        assert search(numbers, 0.0, u, np.array([-speed, 0.0]), 1e-3) == (FREE, 1e-3)


@pytest.mark.parametrize("mode", [0, 1, 2])
@pytest.mark.parametrize("part", ["displacement", "velocity"])
def test_the_bounds_of_rounding_follow_the_mode_that_moves(mode, part):
    """Only one mode moves the tip; each bound lies between 0.5 and 100 EPS times that mode's amplitude."""
    phi = np.full(3, 1e-9)
    phi[mode] = 2.0
    system = modes_on_stop([100.0, 200.0, 400.0], 1.0, phi, 1.0, gap=1e-3)
    model, numbers = system.model, system.numbers()
    u, v = np.zeros(3), np.zeros(3)
    (u if part == "displacement" else v)[mode] = 1.0
    amplitude = 2.0 if part == "displacement" else 2.0 / model.omega[mode]
    assert 0.5 * EPS * amplitude < tip_rounding(numbers, u, v) < 100.0 * EPS * amplitude
    pull = 2.0 * (model.omega[mode] ** 2 if part == "displacement" else model.decay_rate[mode])
    assert 0.5 * EPS * pull < acceleration_rounding(numbers, u, v) < 100.0 * EPS * pull
    assert tip_bound(numbers, mode, 3.0, 4.0) == pytest.approx(10.0, rel=1e-15)
