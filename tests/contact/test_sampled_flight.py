"""The letter's scheme: exact where nothing is missed, and missing exactly what its rule misses."""

import math

import numpy as np
import pytest
from oscillators import equation_1, modes_on_stop, newton, spring
from whole_motions import DASHPOT, HERTZ, LOSSY, SPRING, WAIT, falling_body

from contact import State, simulate
from contact.integrators import SampledFlight

CASES = [(law, n) for n in (1, 4) for law in (newton(0.6), SPRING, DASHPOT, HERTZ, LOSSY)]


@pytest.mark.parametrize(("law", "n"), [*CASES, (WAIT, 1)])
def test_it_is_exact_where_nothing_is_missed(law, n):
    """All laws, one mode and four, strobes, samples between them, and impacts, against the proved search."""
    oscillator = spring(n, law, drive=(22.2, 0.0)).with_excess(0.01)
    times = np.linspace(0.001, 0.9, 57)
    exact = simulate(oscillator, periods=25, times=times)
    run = simulate(oscillator, periods=25, times=times, method=SampledFlight(points=4 if n == 1 else 32))
    assert len(run.impacts) == len(exact.impacts) > 3
    for name in ("strobe_displacement", "strobe_velocity", "displacement", "velocity"):
        ours, theirs = getattr(run, name), getattr(exact, name)
        assert ours == pytest.approx(theirs, abs=1e-11 * np.abs(theirs).max())
    assert run.impacts.start == pytest.approx(exact.impacts.start, abs=1e-13)
    assert np.array_equal(run.strobe_impacts, exact.strobe_impacts)


def test_equation_1_needs_two_points_and_one_is_too_few():
    """The letter's "small number of discrete points": p5 at 22.2 Hz, one impact every fifth period."""
    oscillator = equation_1(22.2, excess=1e-3)
    exact = simulate(oscillator, periods=500)
    assert set(np.diff(np.flatnonzero(exact.strobe_impacts[-100:]))) == {5}
    run = simulate(oscillator, periods=500, method=SampledFlight(points=2))
    assert run.strobe_displacement == pytest.approx(exact.strobe_displacement, abs=1e-12)
    blind = simulate(oscillator, periods=500, method=SampledFlight(points=1))
    assert len(blind.impacts) == 0  # sampled at the strobes alone, the tip never seems to arrive


@pytest.mark.parametrize("point", range(1, 7))
def test_a_start_at_a_point_is_that_point_though_it_be_rounded(point):
    oscillator, method = equation_1(22.2, excess=-0.01), SampledFlight(points=7)
    start = point * (oscillator.period / 7)
    exact, before = (
        simulate(oscillator, State(displacement=[0.0], velocity=[0.0], time=time), periods=2, method=method)
        for time in (start, np.nextafter(start, 0.0))
    )
    assert before.evaluations == exact.evaluations


def first_seen(y: np.ndarray, v: np.ndarray, per_interval: int) -> int:
    """The number of the interval in which the rule sees a crossing first, from fine samples; -1 for none."""
    for start in range(0, y.size - 1, per_interval):
        stop = start + per_interval
        if y[stop] > 0:
            return start // per_interval
        if v[start] > 0 > v[stop]:
            inside = slice(start, stop + 1)
            falls = np.flatnonzero((v[inside][:-1] > 0) & (v[inside][1:] <= 0))
            if falls.size == 1 and y[inside][falls[0]] > 0:
                return start // per_interval
    return -1


def test_it_misses_what_its_rule_misses():
    """Two undamped modes in closed form: where the first crossing is seen, or is not, is the rule's doing.

    Flights in which a peak lies within 1e-3 of the stop or an interval holds several peaks are left to
    chance, and not looked at.
    """
    random = np.random.default_rng(5)
    omega, period, fine = np.array([2 * np.pi, 2 * np.pi * 7.3]), 1.0, 2400
    oscillator = modes_on_stop(omega, law=newton(0.0), gap=1.0)
    t = np.linspace(0.0, period, fine + 1)[:, None]
    missed, seen = {8: 0, 60: 0}, {8: 0, 60: 0}
    for _ in range(300):
        q, v = random.normal(size=2) * [0.5, 0.3], random.normal(size=2) * [3.0, 14.0]
        y = (q * np.cos(omega * t) + v / omega * np.sin(omega * t)).sum(axis=1) - 1.0
        rate = (v * np.cos(omega * t) - q * omega * np.sin(omega * t)).sum(axis=1)
        peaks = np.flatnonzero((rate[:-1] > 0) & (rate[1:] <= 0))
        if y[0] > -0.05 or np.abs(y[peaks]).min() < 1e-3 or abs(y[-1]) < 1e-3:
            continue
        state = State(displacement=q, velocity=v)
        exact = simulate(oscillator, state, duration=0.999999 * period)
        for points in missed:
            per_interval = fine // points
            inside = np.bincount(peaks // per_interval, minlength=points)
            if inside.max() > 1:
                continue
            expected = first_seen(y, rate, per_interval)
            run = simulate(oscillator, state, duration=0.999999 * period, method=SampledFlight(points=points))
            if expected < 0:
                assert len(run.impacts) == 0
            else:
                assert len(run.impacts) > 0
                place = run.impacts.start[0] * points / period
                assert expected - 1e-9 <= place <= expected + 1 + 1e-9
            same = len(run.impacts) == len(exact.impacts) == 0 or (
                len(run.impacts) > 0 and abs(run.impacts.start[0] - exact.impacts.start[0]) < 1e-9
            )
            missed[points] += not same
            seen[points] += same and expected >= 0
    assert missed[8] > 10 and missed[60] == 0 and seen[8] > 20 and seen[60] > 20


def test_a_bouncing_ball_comes_to_rest_at_any_number_of_points():
    """The ball stays behind the floor that it has missed, so that no hop is lost: h = 1 m, e = 0.7."""
    oscillator = falling_body(1.0, newton(0.7))
    for points in (1, 7):
        run = simulate(oscillator, duration=3.0, method=SampledFlight(points=points))
        hops = run.impacts.start[run.impacts.kind == 0]
        arrivals = math.sqrt(2 / 9.81) * (1 + 2 * 0.7 * (1 - 0.7 ** np.arange(10)) / (1 - 0.7))
        assert hops[:10] == pytest.approx(arrivals) and run.end.regime == 3
        assert run.end.displacement[0] == pytest.approx(1.0, abs=1e-12)
