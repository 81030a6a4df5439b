"""Time stepping under Newton's law: Moreau and Jean's method and the nonsmooth generalised-alpha method.

Their steps against matrices, energy, impacts that accumulate, penetration, stays on the stop, limits.
"""

import math

import numpy as np
import pytest
from oscillators import GAMMA, GAP, OMEGA, PHI, THROWN, modes_on_stop, newton, spring
from whole_motions import falling_body

from contact import State, simulate
from contact.integrators import MoreauJean, NonsmoothGeneralisedAlpha
from contact.integrators.generalised_alpha import chung_hulbert

RESTITUTION, STEP, STEPS = 0.6, 4e-5, 1000
W = 2 * np.pi * 21.5
PUSH, SPRINGS, DAMPING = GAMMA[:3] * 1e-4 * W**2, np.diag(OMEGA[:3] ** 2), np.diag(0.02 * OMEGA[:3])
TIP = PHI[:3]


def by_percussions(theta: float) -> tuple[np.ndarray, np.ndarray, int]:
    """Moreau and Jean's complementarity problem of each step with matrices, both its cases tried."""
    n, h = 3, STEP
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-SPRINGS, -DAMPING]])
    tip, push = np.concatenate([np.zeros(n), TIP]), np.concatenate([np.zeros(n), PUSH])
    implicit = np.eye(2 * n) - theta * h * system
    # q_{n+1} takes the percussion through theta v_{n+1}: the same rows give both
    x, acted = np.concatenate([THROWN.displacement, THROWN.velocity]), 0
    for i in range(STEPS):
        drive = push * ((1 - theta) * math.sin(W * i * h) + theta * math.sin(W * (i + 1) * h))
        new = np.linalg.solve(implicit, x + (1 - theta) * h * system @ x + h * drive)
        before = tip @ x
        if TIP @ x[:n] - GAP + 0.5 * h * before >= 0 and tip @ new + RESTITUTION * before > 0:
            answer = np.linalg.solve(implicit, -tip)
            new = new + answer * (-(RESTITUTION * before + tip @ new) / (tip @ answer))
            acted += 1
        x = new
    return x[:n], x[n:], acted


def by_all_unknowns(rho: float) -> tuple[np.ndarray, np.ndarray, int]:
    """A step of the nonsmooth method, (q, v, a, f, p) in one linear system, both cases of the stop tried."""
    m, f, beta, gamma, _eta = chung_hulbert(rho)
    n, one, h = 3, np.eye(3), STEP
    q, v, acted = THROWN.displacement, THROWN.velocity, 0
    a = smooth = -SPRINGS @ q - DAMPING @ v
    zero, column = np.zeros((n, n)), np.zeros((n, 1))
    rows = [
        [one, zero, -beta * h**2 * one, zero, 0.5 * h * TIP[:, None]],
        [zero, one, -gamma * h * one, zero, TIP[:, None]],
        [zero, zero, (1 - m) * one, -(1 - f) * one, column],
        [SPRINGS, DAMPING, zero, one, column],
    ]
    free = np.block([*rows, [np.zeros((1, 4 * n)), np.ones((1, 1))]])
    struck = np.block([*rows, [np.concatenate([np.zeros(n), TIP, np.zeros(2 * n + 1)])[None, :]]])
    for i in range(STEPS):
        place, speed = q + h * v + h**2 * (0.5 - beta) * a, v + h * (1 - gamma) * a
        known = np.concatenate([place, speed, f * smooth - m * a, PUSH * math.sin(W * (i + 1) * h)])
        before, answer = TIP @ v, np.linalg.solve(free, np.append(known, 0.0))
        if TIP @ q - GAP + 0.5 * h * before >= 0 and TIP @ answer[n : 2 * n] + RESTITUTION * before > 0:
            answer = np.linalg.solve(struck, np.append(known, -RESTITUTION * before))
            assert answer[-1] > 0
            acted += 1
        q, v, a, smooth = answer[:-1].reshape(4, n)
    return q, v, acted


STEPPED = [(MoreauJean(step=STEP, theta=x), by_percussions, x, 1e-11) for x in (0.5, 0.8, 1.0)]
NONSMOOTH = [(NonsmoothGeneralisedAlpha(step=STEP, rho=x), x) for x in (0.0, 0.5, 0.8, 1.0)]
STEPPED += [(method, by_all_unknowns, rho, 1e-10) for method, rho in NONSMOOTH]
STEPPED += [(NONSMOOTH[-1][0], by_percussions, 0.5, 1e-10)]  # with rho = 1 it is Moreau and Jean's


@pytest.mark.parametrize(("method", "known", "number", "digits"), STEPPED)
def test_the_step_is_that_of_the_matrix_equations(method, known, number, digits) -> None:
    q, v, acted = known(number)
    beam = spring(3, newton(RESTITUTION), drive=(21.5, 1e-4))
    end = simulate(beam, THROWN, duration=STEPS * STEP, method=method).end
    assert acted >= 2
    np.testing.assert_allclose(end.displacement, q, rtol=0, atol=digits * np.abs(q).max())
    np.testing.assert_allclose(end.velocity, v, rtol=0, atol=digits * np.abs(v).max())


ELASTIC = [(MoreauJean(step=2e-5, theta=theta), theta == 0.5) for theta in (0.5, 1.0)]
ELASTIC += [(NonsmoothGeneralisedAlpha(step=2e-5, rho=rho), rho == 1.0) for rho in (1.0, 0.5)]


@pytest.mark.parametrize(("method", "kept"), ELASTIC)
def test_elastic_impacts_keep_the_energy_to_rounding_if_the_flight_does(method, kept: bool) -> None:
    beam = spring(3, newton(1.0), damping=0.0)
    numbers = simulate(beam, THROWN, duration=4.0, method=method)
    begun = float(beam.energy(THROWN.displacement, THROWN.velocity))
    left = float(beam.energy(numbers.end.displacement, numbers.end.velocity)) / begun
    assert len(numbers.impacts) > (100 if kept else 5)
    assert np.abs(numbers.impacts.loss).max() < 1e-14 * begun
    # 2e5 steps, each good to one unit of the last place
    assert left == pytest.approx(1.0, rel=1e-11) if kept else left < 0.999


def test_what_is_lost_is_what_the_log_says() -> None:
    """For e < 1 the energy falls by the losses of Newton's law, up to the share of a step."""
    beam = spring(3, newton(0.7), damping=0.0)
    begun, gaps = float(beam.energy(THROWN.displacement, THROWN.velocity)), []
    for step in (8e-6, 2e-6):
        numbers = simulate(beam, THROWN, duration=0.3, method=MoreauJean(step=step))
        end = float(beam.energy(numbers.end.displacement, numbers.end.velocity))
        gaps.append(abs(begun - end - numbers.impacts.loss.sum()) / begun)
        ratio = numbers.impacts.rebound / numbers.impacts.approach
        single = numbers.impacts.start == numbers.impacts.end
        assert single.all() and np.allclose(ratio, -0.7, rtol=1e-9)
    assert gaps[0] < 1e-2 and gaps[1] < 0.5 * gaps[0]


def test_impacts_that_accumulate_are_passed() -> None:
    """A ball: h = 1 m, g = 9.81 m/s^2, e = 0.7, at rest after 2.55863 s."""
    ball, step = falling_body(1.0, newton(0.7)), 1e-4
    times = np.array([2.0, 2.5, 2.65, 3.0, 4.0])
    numbers = simulate(ball, duration=4.0, times=times, method=MoreauJean(step=step))
    exact = simulate(ball, duration=4.0, times=times)
    heights = 1.0 - numbers.displacement[:, 0]
    np.testing.assert_allclose(heights[:2], 1.0 - exact.displacement[:2, 0], atol=20 * step)
    # at rest from there on: no velocity above one step of gravity, the same place to the last digit
    assert np.all(np.abs(numbers.velocity[2:, 0]) <= 9.81 * step)
    assert abs(heights[2]) < 9.81 * step**2 and np.ptp(heights[2:]) < 9.81 * step**2
    apart = np.diff(numbers.impacts.start)
    settled = numbers.impacts.start[1:][apart < 20 * step]
    assert settled[0] == pytest.approx(2.55863, abs=0.02)


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_the_penetration_stays_below_a_step(restitution: float) -> None:
    """An impact leaves the tip at most (1 - e) h U/2 (grid points) and h U (corner) behind the stop, over all
    phases of the grid; it approaches that bound."""
    speed, step = 0.8, 1e-3
    worst = []
    for phase in np.linspace(0.0, 1.0, 41, endpoint=False):
        mass = falling_body((5 + phase) * step * speed, newton(restitution), gravity=0.0)
        start = State(displacement=np.zeros(1), velocity=np.array([speed]))
        times = step * np.arange(1, 13)
        numbers = simulate(mass, start, duration=12 * step, times=times, method=MoreauJean(step=step))
        assert len(numbers.impacts) == 1
        depth = numbers.displacement[:, 0] - mass.stop.gap
        corner = float(numbers.impacts.displacement_start[0, 0]) - mass.stop.gap
        assert -1e-12 <= corner / (step * speed) < 1
        # before, at and after the step of the impact
        assert depth.max() / (step * speed) <= max(0.5, 1 - 0.5 * restitution) + 1e-12
        worst.append(float(depth[-1]))
    if restitution == 0.0:
        assert 0.4 * step * speed < max(worst) <= step * speed


def test_samples_know_on_which_side_of_the_jump_they_lie() -> None:
    """Within the step of an impact the path is two straight lines, and the velocity jumps at its corner."""
    mass = falling_body(1.0, newton(0.5), gravity=0.0)
    start = State(displacement=np.zeros(1), velocity=np.ones(1))
    step, times = 0.3, np.linspace(0.0, 2.0, 401)
    for theta, corner in ((0.5, 0.9 + 0.5 * step), (1.0, 0.9), (0.8, 0.9 + 0.2 * step)):
        numbers = simulate(mass, start, duration=2.0, times=times, method=MoreauJean(step=step, theta=theta))
        expected = np.where(times < corner, times, corner - 0.5 * (times - corner))
        np.testing.assert_allclose(numbers.displacement[:, 0], expected, atol=1e-12)
        clear = np.abs(times - corner) > 1e-6
        speeds = np.where(times < corner, 1.0, -0.5)
        np.testing.assert_allclose(numbers.velocity[clear, 0], speeds[clear], atol=1e-12)
        assert numbers.impacts.start[0] == pytest.approx(corner, rel=1e-12)


def test_an_end_within_rounding_behind_an_impact_is_taken() -> None:
    mass = falling_body(0.34, newton(0.5), gravity=0.0)
    start = State(displacement=np.zeros(1), velocity=np.ones(1))
    end = simulate(mass, start, duration=0.1 * (4 + 8e-10), method=MoreauJean(step=0.1)).end
    assert float(end.displacement[0]) == pytest.approx(0.35 - 0.5 * 0.05, rel=1e-8)
    assert float(end.velocity[0]) == pytest.approx(-0.5, rel=1e-8)


def test_a_stay_on_the_stop_does_not_drift() -> None:
    """Held by a load, e = 0: penetration below h U, constant, and the next step as the last."""
    beam = spring(3, newton(0.0), damping=0.05, load=np.array([2000.0, 0.0, 0.0]))
    times, step = np.array([0.6, 0.7, 0.8]), 2e-5
    numbers = simulate(beam, duration=0.8, times=times, method=NonsmoothGeneralisedAlpha(step=step, rho=0.5))
    depth = numbers.displacement @ TIP - GAP
    fastest = numbers.impacts.approach.max()
    assert 0 <= depth[-1] < step * fastest and np.ptp(depth) < 1e-6 * step * fastest
    # static equilibrium with the tip held there: omega^2 q = load - phi N
    weights = TIP / OMEGA[:3] ** 2
    hold = (weights @ beam.load - GAP - depth[-1]) / (weights @ TIP)
    rest = (beam.load - TIP * hold) / OMEGA[:3] ** 2
    np.testing.assert_allclose(numbers.displacement[-1], rest, atol=1e-6 * GAP)


@pytest.mark.parametrize("zeta", [0.3, 1.7])
def test_the_limit_is_where_the_growth_factor_of_a_step_leaves_one(zeta: float) -> None:
    numbers = modes_on_stop(100.0, 2 * zeta * 100.0).numbers()
    for step in (1e-3, 3e-3, 6e-3, 1e-2, 2e-2, 4e-2):
        system = np.array([[0.0, 1.0], [-1e4, -200.0 * zeta]])
        for theta in (0.0, 0.3):
            old, new = np.eye(2) + (1 - theta) * step * system, np.eye(2) - theta * step * system
            factors = np.linalg.eigvals(np.linalg.solve(new, old))
            grows = np.abs(factors).max() > 1 + 1e-9
            assert (MoreauJean(step=step, theta=theta).critical_stiffness(numbers) < 0) == grows
