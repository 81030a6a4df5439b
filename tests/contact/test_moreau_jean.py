"""Moreau and Jean's time stepping: its step, energy, order before and after impacts, penetration."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.errors import StepTooLarge
from contact.integrators.moreau_jean import MoreauJean
from contact.laws import HertzContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State

OMEGA = 2 * np.pi * 24.5 * np.array([1.0, 6.1, 15.4])
PHI = 10.0 * np.array([1.0, 0.7, 0.5])
GAMMA = np.array([0.09, 0.05, -0.03])
GAP = 0.005
START = State(displacement=np.zeros(3), velocity=np.array([0.15, 0.02, 0.01]))


def oscillator(restitution: float, *, damping: float = 0.02, amplitude: float = 0.0) -> ImpactOscillator:
    return ImpactOscillator(
        model=ModalModel(omega=OMEGA, decay_rate=damping * OMEGA, phi=PHI, participation=GAMMA),
        stop=Stop(gap=GAP, law=NewtonRestitution(local_restitution=restitution)),
        drive=HarmonicDrive(frequency=21.5, amplitude=amplitude) if amplitude else None,
    )


def free_mass(restitution: float, gap: float, load: float = 0.0) -> ImpactOscillator:
    """A mass of 1 kg, pushed towards the stop by `load` [N]."""
    return ImpactOscillator(
        model=ModalModel(omega=np.zeros(1), decay_rate=np.zeros(1), phi=np.ones(1), participation=np.ones(1)),
        stop=Stop(gap=gap, law=NewtonRestitution(local_restitution=restitution)),
        load=np.array([load]),
    )


def error(spring: ImpactOscillator, method: MoreauJean, duration: float, exact: State) -> float:
    end = simulate(spring, START, duration=duration, method=method).end
    return float(np.linalg.norm(OMEGA * (end.displacement - exact.displacement)))


@pytest.mark.parametrize("theta", [0.5, 0.8, 1.0])
def test_the_step_is_that_of_the_matrix_equations(theta: float) -> None:
    """The linear complementarity problem of each step solved with matrices, both its cases tried."""
    spring, h, steps, e = oscillator(0.6, amplitude=1e-4), 4e-5, 1000, 0.6
    n = spring.n_modes
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n], system[n:, n:] = -np.diag(OMEGA**2), -np.diag(0.02 * OMEGA)
    w, tip = 2 * np.pi * 21.5, np.concatenate([np.zeros(n), PHI])
    push = np.concatenate([np.zeros(n), GAMMA * 1e-4 * w**2])
    implicit = np.eye(2 * n) - theta * h * system
    # q_{n+1} takes the percussion through theta v_{n+1}: the same rows give both
    x = np.concatenate([START.displacement, START.velocity])
    acted = 0
    for i in range(steps):
        drive = push * ((1 - theta) * math.sin(w * i * h) + theta * math.sin(w * (i + 1) * h))
        right = x + (1 - theta) * h * system @ x + h * drive
        new = np.linalg.solve(implicit, right)
        if PHI @ x[:n] - GAP + 0.5 * h * (tip @ x) >= 0 and tip @ new + e * (tip @ x) > 0:
            answer = np.linalg.solve(implicit, -tip)
            new = new + answer * (-(e * (tip @ x) + tip @ new) / (tip @ answer))
            acted += 1
        x = new
    end = simulate(spring, START, duration=steps * h, method=MoreauJean(step=h, theta=theta)).end
    assert acted >= 2
    np.testing.assert_allclose(end.displacement, x[:n], rtol=0, atol=1e-11 * np.abs(x[:n]).max())
    np.testing.assert_allclose(end.velocity, x[n:], rtol=0, atol=1e-11 * np.abs(x[n:]).max())


def test_elastic_impacts_keep_the_energy_to_rounding() -> None:
    spring = oscillator(1.0, damping=0.0)
    times = np.linspace(0, 4.0, 51)[1:]
    motion = simulate(spring, START, duration=4.0, times=times, method=MoreauJean(step=2e-5))
    begun = float(spring.energy(START.displacement, START.velocity))
    assert len(motion.impacts) > 100
    assert np.abs(motion.impacts.loss).max() < 1e-14 * begun
    # 2e5 steps, each good to one unit of the last place
    assert spring.energy(motion.end.displacement, motion.end.velocity) == pytest.approx(begun, rel=1e-11)
    damped = simulate(spring, START, duration=4.0, method=MoreauJean(step=2e-5, theta=1.0)).end
    assert spring.energy(damped.displacement, damped.velocity) < 0.95 * begun


def test_what_is_lost_is_what_the_log_says() -> None:
    """For e < 1 the energy falls by the losses of Newton's law, up to the share of a step."""
    spring = oscillator(0.7, damping=0.0)
    begun = float(spring.energy(START.displacement, START.velocity))
    gaps = []
    for step in (8e-6, 2e-6):
        motion = simulate(spring, START, duration=0.3, method=MoreauJean(step=step))
        end = float(spring.energy(motion.end.displacement, motion.end.velocity))
        gaps.append(abs(begun - end - motion.impacts.loss.sum()) / begun)
        ratio = motion.impacts.rebound / motion.impacts.approach
        single = motion.impacts.start == motion.impacts.end
        assert single.all() and np.allclose(ratio, -0.7, rtol=1e-9)
    assert gaps[0] < 1e-2 and gaps[1] < 0.5 * gaps[0]


@pytest.mark.parametrize("theta, order", [(0.5, 2.0), (1.0, 1.0), (0.6, 1.0)])
def test_order_before_impacts(theta: float, order: float) -> None:
    spring = oscillator(0.6, amplitude=1e-4)
    exact = simulate(spring, START, duration=0.003)
    assert len(exact.impacts) == 0
    errors = [error(spring, MoreauJean(step=h, theta=theta), 0.003, exact.end) for h in (2e-5, 1e-5, 5e-6)]
    assert np.all(np.abs(np.diff(np.log2(errors)) + order) < 0.1)


def test_order_after_impacts() -> None:
    """The instant of an impact is off by a part of a step; the mean over 16 parts of it shows order 1.

    The velocity is off by its whole jump while one motion has bounced and the other has not, so that its mean
    square error over a stretch of time with an impact falls as h^(1/2) only.
    """
    spring = oscillator(0.6, amplitude=1e-4)
    exact = simulate(spring, START, duration=0.006)
    assert len(exact.impacts) == 1
    touch = float(exact.impacts.start[0])
    times = np.linspace(0.95 * touch, 1.05 * touch, 20001)
    reference = simulate(spring, START, duration=0.006, times=times).velocity
    counts = np.array([200, 800, 3200])
    means, norms = [], []
    for count in counts:
        chosen = [touch / (count + i / 16) for i in range(16)]
        means.append(np.mean([error(spring, MoreauJean(step=h), 0.006, exact.end) for h in chosen]))
        squares = []
        for h in chosen:
            motion = simulate(spring, START, duration=0.006, times=times, method=MoreauJean(step=h))
            squares.append(np.mean((motion.velocity - reference) ** 2))
        norms.append(math.sqrt(np.mean(squares)))
    position = -np.polyfit(np.log(counts), np.log(means), 1)[0]
    speed = -np.polyfit(np.log(counts), np.log(norms), 1)[0]
    assert abs(position - 1.0) < 0.1
    assert abs(speed - 0.5) < 0.1


def test_impacts_that_accumulate_are_passed() -> None:
    """The ball of FACTS section 4: h = 1 m, g = 9.81 m/s^2, e = 0.7, at rest after 2.55863 s."""
    ball = free_mass(0.7, gap=1.0, load=9.81)
    step = 1e-4
    times = np.array([2.0, 2.5, 2.65, 3.0, 4.0])
    motion = simulate(ball, duration=4.0, times=times, method=MoreauJean(step=step))
    exact = simulate(ball, duration=4.0, times=times)
    heights = 1.0 - motion.displacement[:, 0]
    np.testing.assert_allclose(heights[:2], 1.0 - exact.displacement[:2, 0], atol=20 * step)
    # at rest from there on: no velocity above one step of gravity, the same place to the last digit
    assert np.all(np.abs(motion.velocity[2:, 0]) <= 9.81 * step)
    assert abs(heights[2]) < 9.81 * step**2 and np.ptp(heights[2:]) < 9.81 * step**2
    apart = np.diff(motion.impacts.start)
    settled = motion.impacts.start[1:][apart < 20 * step]
    assert settled[0] == pytest.approx(2.55863, abs=0.02)


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_the_penetration_stays_below_a_step(restitution: float) -> None:
    """An impact leaves the tip at most (1 - e) h U/2 (grid points) and h U (corner) behind the stop, over all
    phases of the grid; it approaches that bound."""
    speed, step = 0.8, 1e-3
    worst = []
    for phase in np.linspace(0.0, 1.0, 41, endpoint=False):
        mass = free_mass(restitution, gap=(5 + phase) * step * speed)
        start = State(displacement=np.zeros(1), velocity=np.array([speed]))
        times = step * np.arange(1, 13)
        motion = simulate(mass, start, duration=12 * step, times=times, method=MoreauJean(step=step))
        assert len(motion.impacts) == 1
        depth = motion.displacement[:, 0] - mass.stop.gap
        corner = float(motion.impacts.displacement_start[0, 0]) - mass.stop.gap
        assert -1e-12 <= corner / (step * speed) < 1
        # before, at and after the step of the impact
        assert depth.max() / (step * speed) <= max(0.5, 1 - 0.5 * restitution) + 1e-12
        worst.append(float(depth[-1]))
    if restitution == 0.0:
        assert 0.4 * step * speed < max(worst) <= step * speed


def test_samples_know_on_which_side_of_the_jump_they_lie() -> None:
    """Within the step of an impact the path is two straight lines, and the velocity jumps at its corner."""
    mass = free_mass(0.5, gap=1.0)
    start = State(displacement=np.zeros(1), velocity=np.ones(1))
    step = 0.3
    times = np.linspace(0.0, 2.0, 401)
    for theta, corner in ((0.5, 0.9 + 0.5 * step), (1.0, 0.9), (0.8, 0.9 + 0.2 * step)):
        motion = simulate(
            mass, start, duration=2.0, times=times, method=MoreauJean(step=step, theta=theta)
        )  # fmt: skip
        expected = np.where(times < corner, times, corner - 0.5 * (times - corner))
        np.testing.assert_allclose(motion.displacement[:, 0], expected, atol=1e-12)
        clear = np.abs(times - corner) > 1e-6
        speeds = np.where(times < corner, 1.0, -0.5)
        np.testing.assert_allclose(motion.velocity[clear, 0], speeds[clear], atol=1e-12)
        assert motion.impacts.start[0] == pytest.approx(corner, rel=1e-12)


def test_strobes_and_the_end_need_not_lie_on_the_grid() -> None:
    spring = oscillator(0.6, amplitude=2e-4)
    method = MoreauJean(step=1.1e-5)
    whole = simulate(spring, START, periods=3, method=method)
    again = simulate(spring, START, duration=3 / 21.5, times=whole.strobe_time, method=method)
    np.testing.assert_array_equal(whole.strobe_displacement, again.displacement)
    np.testing.assert_array_equal(whole.end.displacement, whole.strobe_displacement[-1])
    assert int(whole.strobe_impacts.sum()) == len(whole.impacts) > 3


def test_an_end_within_rounding_behind_an_impact_is_taken() -> None:
    mass = free_mass(0.5, gap=0.34)
    start = State(displacement=np.zeros(1), velocity=np.ones(1))
    end = simulate(mass, start, duration=0.1 * (4 + 8e-10), method=MoreauJean(step=0.1)).end
    assert float(end.displacement[0]) == pytest.approx(0.35 - 0.5 * 0.05, rel=1e-8)
    assert float(end.velocity[0]) == pytest.approx(-0.5, rel=1e-8)


def test_limits_and_refusals() -> None:
    spring = oscillator(0.5, damping=0.0)
    with pytest.raises(StepTooLarge, match="unstable even in flight"):
        simulate(spring, START, duration=0.01, method=MoreauJean(step=1e-6, theta=0.49))
    simulate(spring, START, duration=0.01, method=MoreauJean(step=1e-3, theta=0.5))
    # one damped mode: the limit against the growth factor of the step itself
    for zeta in (0.3, 1.7):
        model = ModalModel(
            omega=np.array([100.0]), decay_rate=np.array([2 * zeta * 100.0]), phi=np.ones(1),
            participation=np.ones(1),
        )  # fmt: skip
        damped = ImpactOscillator(model=model, stop=spring.stop)
        for step in (1e-3, 3e-3, 6e-3, 1e-2, 2e-2, 4e-2):
            system = np.array([[0.0, 1.0], [-1e4, -200.0 * zeta]])
            for theta in (0.0, 0.3):
                old, new = np.eye(2) + (1 - theta) * step * system, np.eye(2) - theta * step * system
                factors = np.linalg.eigvals(np.linalg.solve(new, old))
                method = MoreauJean(step=step, theta=theta)
                grows = np.abs(factors).max() > 1 + 1e-9
                assert (method.critical_stiffness(damped.motion()) < 0) == grows
    with pytest.raises(TypeError, match="moreau-jean"):
        hertz = ImpactOscillator(model=spring.model, stop=Stop(gap=GAP, law=HertzContact(stiffness=1e7)))
        simulate(hertz, START, duration=0.01, method=MoreauJean(step=1e-5))
    for wrong in ({"theta": -0.1}, {"theta": 1.2}, {"theta": math.nan}, {"step": 0.0}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            MoreauJean(**{"step": 1e-5, **wrong})
