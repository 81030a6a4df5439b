"""One mode at finite amplitude: against Eq. (1), another integrator and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from one_mode import FREQUENCIES, GAP, oscillator
from scipy.integrate import solve_ivp

from contact import Diverged, NonlinearMode, NotPeriodic, StroboscopicMap
from contact.orbits import onset_m, onset_orbit

LEG = 0.13
U, LEAF, LINEAR = (-1.715, 1.486), (36 / 35, 36 / 25), (0.0, 0.0)
"""b and a, times LEG^2: a folded U with a tight bend, a leaf with a heavy tip, Eq. (1)."""


def mode(cubic: tuple[float, float] = U, frequency: float = 22.2, **others: float) -> NonlinearMode:
    stiffness, inertia = (part / LEG**2 for part in cubic)
    numbers = {"free_period": 40.80e-3, "decay_rate": 3.56, "gap": GAP, "restitution": 0.1} | others
    return NonlinearMode(stiffness=stiffness, inertia=inertia, frequency=frequency, **numbers)


def solved(one: NonlinearMode, force: float, span: tuple[float, float], start: object, **events: object):
    """The motion without a stop, by another integrator."""
    square, decay, b, a, w = one.numbers

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v = y
        pull = force * math.cos(w * t) - decay * v - square * (x + b * x**3) - a * x * v**2
        return [v, pull / (1.0 + a * x**2)]

    settings = dict(method="DOP853", rtol=1e-13, atol=1e-16, max_step=one.period / 40, dense_output=True)
    return solve_ivp(rate, span, start, **settings, **events)


def decay_rate(one: NonlinearMode) -> float:
    """Of the linear mode whose deviations fade as fast under this drive [1/s]."""
    return -math.log(np.linalg.det(one.monodromy)) / one.period


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_without_cubic_terms_it_is_eq_1(frequency: float) -> None:
    """Grazing drive, effective period, what is born (strobes are at another phase of the drive)."""
    one, linear = mode(LINEAR, frequency), oscillator(frequency)
    assert one.effective_period == pytest.approx(40.80e-3, rel=1e-12)
    assert decay_rate(one) == pytest.approx(3.56, rel=1e-10)
    assert mode(LINEAR, 26.0).effective_period == pytest.approx(40.80e-3, rel=1e-12)  # above resonance
    drive = one.grazing[0] / one.numbers[4] ** 2  # the base's amplitude whose inertia pushes as much
    assert drive == pytest.approx(linear.grazing_amplitude(), rel=1e-12)
    settled = [onset_orbit(strobed, 0.01) for strobed in (one, StroboscopicMap(oscillator=linear))]
    assert [run.m for run in settled] == 2 * [settled[0].m]
    assert [run.impacts for run in settled] == 2 * [settled[0].impacts]


@pytest.mark.parametrize("excess, digits", [(-0.2, 1e-11), (0.02, 1e-9)])
@pytest.mark.parametrize("cubic", [U, LEAF])
def test_a_motion_against_another_integrator(cubic, excess: float, digits: float) -> None:
    """In flight, and with impacts, which the other integrator finds as events."""
    one = mode(cubic).at(excess)
    force, root = (1.0 + excess) * one.grazing[0], math.sqrt(one.numbers[0])
    found = one.orbit(one.steady() * 0.9, 6)

    def gap_closes(_t: float, y: np.ndarray) -> float:
        return y[0] - GAP

    gap_closes.terminal, gap_closes.direction = True, 1.0  # type: ignore[attr-defined]
    t, y, hits = 0.0, np.array(one.steady() * 0.9) * [1.0, root], 0
    end = 6 * one.period
    while t < end:
        run = solved(one, force, (t, end), y, events=gap_closes)
        t, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            y, hits = np.array([GAP * (1 - 1e-15), -one.restitution * y[1]]), hits + 1
    assert found.impacts.sum() == hits and (hits > 0) == (excess > 0)
    np.testing.assert_allclose(found.end, y / [1.0, root], atol=digits * GAP)


def test_factors_are_those_of_the_force() -> None:
    one, levels = mode(LINEAR).at(0.02), np.array([1.0, 1.01, 0.9, 1.2])
    run = one.orbit(one.steady(), 4, factors=levels)
    here, points = one.steady(), []
    for level in levels:
        part = one.at(1.02 * level - 1.0).orbit(here, 1)
        here = part.end
        points.append(here)
    np.testing.assert_allclose(run.points, points, rtol=1e-12, atol=1e-12 * GAP)
    with pytest.raises(ValueError, match="factors"):
        one.orbit(one.steady(), 4, factors=levels[:3])


def test_grazing_motion_touches_at_rest_and_nowhere_else() -> None:
    one = mode()
    force, touch = one.grazing
    run = solved(one, force, (touch, touch + one.period), [GAP, 0.0])
    np.testing.assert_allclose(run.y[:, -1], [GAP, 0.0], atol=1e-10)
    assert run.sol(np.linspace(touch, touch + one.period, 1001))[0].max() < GAP * (1 + 1e-12)
    below, above = one.at(-1e-9), one.at(1e-7)
    assert below.orbit(below.steady(), 50).impacts.sum() == 0
    assert above.orbit(above.steady(), 50).impacts.sum() > 0


@pytest.mark.parametrize("cubic, close", [(U, 0.05), (LEAF, None)])
def test_effective_period_and_decay_rate(cubic: tuple[float, float], close: float | None) -> None:
    """From differences of another integrator's motions; the decay rate also as mu <1/(1 + a x^2)>.

    The average sqrt((D + k)(D + 3 k)) gives the shift of the U to 5 %; a leaf's elastic and inertial parts
    cancel in k and not in a driven motion.
    """
    for frequency in FREQUENCIES[::2]:
        one = mode(cubic, frequency)
        force, touch = one.grazing
        starts, h = np.array([[GAP, 0.0]] * 4), 1e-5 * GAP
        starts += h * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 200.0], [0.0, -200.0]])
        span = touch, touch + one.period
        runs = [solved(one, force, span, y) for y in starts]
        ends = np.array([run.y[:, -1] for run in runs])
        monodromy = np.array([ends[0] - ends[1], (ends[2] - ends[3]) / 200.0]).T / (2 * h)
        det, trace = np.linalg.det(monodromy), np.trace(monodromy)
        turn = math.acos(0.5 * trace / math.sqrt(det)) / (2 * math.pi)
        turn = turn if frequency < 1.0 / one.free_period else -turn
        assert one.effective_period == pytest.approx(1.0 / (frequency * (1.0 + turn)), rel=1e-8)
        assert decay_rate(one) == pytest.approx(-math.log(det) / one.period, rel=1e-6)
        x = runs[0].sol(np.linspace(*span, 65)[:-1])[0]
        averaged = one.decay_rate * np.mean(1.0 / (1.0 + one.inertia * x**2))
        assert decay_rate(one) == pytest.approx(averaged, rel=1e-4)
        if close is not None:
            free, w = 2 * math.pi / one.free_period, one.numbers[4]
            k = free * (3 / 8 * one.stiffness - one.inertia / 4) * GAP**2
            expected = 2 * math.pi / (w + math.sqrt((free - w + k) * (free - w + 3 * k)))
            shift = one.effective_period - one.free_period
            assert shift == pytest.approx(expected - one.free_period, rel=close)


def test_the_u_loses_periods_that_the_leaf_keeps() -> None:
    """Born at 1e-3: Eq. (1), a leaf and the letter say 3, 4, 5, 6, 8 at the first five frequencies."""
    rows = ([mode(cubic, f, gap=10.7e-3) for f in FREQUENCIES[:5]] for cubic in (LINEAR, LEAF, U))
    linear, leaf, u = ([onset_m(one, 1e-3) for one in row] for row in rows)
    assert linear == leaf == [3, 4, 5, 6, 8]
    assert sum(a == b for a, b in zip(u, leaf, strict=True)) <= 1


def test_a_tip_pressed_against_the_stop_leaves_it_when_the_force_turns() -> None:
    """At the moment at which the force on the resting tip is zero; free from there to the next strobe."""
    one = mode(LEAF, frequency=60.0)
    square, w = one.numbers[0], one.numbers[4]
    held = square * (GAP + one.stiffness * GAP**3)
    one = one.at(1.2 * held / one.grazing[0] - 1.0)
    release = math.acos(1 / 1.2) / w
    run = solved(one, 1.2 * held, (release, one.period), [GAP, 0.0])
    assert run.y[0].max() <= GAP
    found = one.orbit(np.array([GAP, 0.0]), 1)
    np.testing.assert_allclose(found.end * [1.0, math.sqrt(square)], run.y[:, -1], rtol=1e-9)
    one = mode(LEAF, 22.2).at(9.0)
    bouncing = replace(one, restitution=0.8)
    assert 20 < bouncing.orbit(np.array([0.999 * GAP, 0.0]), 1).impacts[0] < 200


@pytest.mark.parametrize("start", [(-0.2, -0.3), (0.0, -1e150), (-1e300, 0.0)])
def test_a_motion_beyond_its_cubic_terms_is_no_number(start: tuple[float, float]) -> None:
    """A softening mode runs away where its force falls, a stiffening one takes endless steps."""
    for cubic in (U, LEAF):
        one = mode(cubic)
        if cubic == U or abs(start[0]) + abs(start[1]) > 1.0:
            with pytest.raises(Diverged, match="without bound"):
                one.orbit(np.array(start), 5)
    with pytest.raises(Diverged) as error:
        mode(U).at(30.0).orbit(mode(U).steady(), 50)
    assert error.value.gap > 2.0 * GAP  # away from the stop
    with pytest.raises(NotPeriodic):
        mode(U).at(30.0).steady()
