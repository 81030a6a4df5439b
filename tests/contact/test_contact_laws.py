"""Laws of the contact: their constants and one contact at a time."""

import itertools
import math

import numpy as np
import pytest
from oscillators import FREQUENCY, GAP, PHI, heights, modes_on_stop, newton, slow, spring
from scipy.integrate import solve_ivp
from whole_motions import DASHPOT, HERTZ, LOSSY, SOFTER, SPRING, accelerations

from contact import HertzContact, HuntCrossley, ImpactOscillator, State, simulate


@pytest.mark.parametrize("order", [1, -1])
def test_hertz_stiffness_is_that_of_the_contact_circle(order):
    """A circle of radius a, a^2 = R d, carries N = (4/3) E* a^3/R: alumina on steel, steel on alumina."""
    radius, depth = 2.5e-3, 3e-6
    (one, first), (other, second) = [(370e9, 0.22), (210e9, 0.30)][::order]
    moduli = dict(youngs_modulus=one, poissons_ratio=first, other_modulus=other, other_ratio=second)
    law = HertzContact.of_bodies(radius=radius, **moduli)
    plane_strain = 1 / ((1 - 0.22**2) / 370e9 + (1 - 0.30**2) / 210e9)
    force = 4 * plane_strain * math.sqrt(radius * depth) ** 3 / (3 * radius)
    assert law.stiffness * depth**1.5 == pytest.approx(force, rel=1e-14)
    assert law.stiffness == pytest.approx(9.65e9, rel=1e-3)


def ladder(n: int, *, chi: float, damping: float, load: float = 0.0) -> ImpactOscillator:
    """A cantilever-like ladder of `n` modes, driven near the first, over-damped if damping > 2; a load takes
    the stiffness of mode 1."""
    k = np.arange(1.0, n + 1.0)
    omega = 150.0 * (2.0 * k - 1.0) ** 2
    numbers = omega * (k > 1 if load else 1.0), damping * omega, 8.0 / k**0.7, 0.1 / k**2
    law = HuntCrossley(stiffness=2e7, dissipation=chi)
    return modes_on_stop(*numbers, law=law, drive=(21.5, 1e-3), load=load * (k == 1))


def contact_by_solver(oscillator: ImpactOscillator, start: float, q: np.ndarray, v: np.ndarray):
    """From a touch to its release by an adaptive Runge-Kutta method of order 8 in sigma.

    With dt = r dsigma, r = sqrt(depth), the force is smooth at both ends. Unknowns r, t, loss, q, v.
    """
    model, law, n = oscillator.model, oscillator.stop.law, oscillator.n_modes
    flight = accelerations(oscillator)

    def rates(_sigma: float, x: np.ndarray) -> np.ndarray:
        r, t, q, v = x[0], x[1], x[3 : 3 + n], x[3 + n :]
        speed = model.phi @ v
        force = law.stiffness * r**3 * (1.0 + law.dissipation * speed)
        pull = flight(t, q, v) - model.phi * force
        return np.concatenate([[0.5 * speed, r, r * force * speed], r * v, r * pull])

    def released(sigma: float, x: np.ndarray) -> float:
        return x[0] if sigma > 0.0 else 1.0

    released.terminal, released.direction = True, -1.0
    scale = math.sqrt(float(np.sum(v**2 + (model.omega * q) ** 2)))
    small = [1e-4, 1e-4, scale**2, *scale / np.maximum(model.omega, 1.0), *np.full(n, scale)]
    x, bounds = np.concatenate([[0.0, start, 0.0], q, v]), dict(rtol=3e-14, atol=1e-15 * np.array(small))
    return solve_ivp(rates, (0.0, 1e3), x, "DOP853", events=released, dense_output=True, **bounds)


CASES = [*itertools.product([1, 2, 8], [0.0, 0.3], [0.02, 2.5], [0.0]), (4, 0.0, 0.02, 3.0)]
CASES += [(20, 0.3, 0.02, 0.0), *slow(*itertools.product([20, 40], [0.0, 0.3], [0.02, 2.5], [0.0]))]


@pytest.mark.parametrize("modes, chi, damping, load", CASES)
def test_a_contact_is_that_of_an_independent_integration(modes, chi, damping, load):
    """State at the release, duration, loss and samples inside; fast and slow, driven, damped, loaded."""
    oscillator, generator = ladder(modes, chi=chi, damping=damping, load=load), np.random.default_rng(5)
    phi, omega = oscillator.model.phi, oscillator.model.omega
    for speed in (0.3, 1e-3) if not load else (0.2,):
        v = 0.02 * generator.standard_normal(modes) / np.arange(1, modes + 1)
        q = np.where(omega > 0, 0.3 * v / np.maximum(omega, 1.0), 0.0)
        q[0] += (0.01 - 1e-12 - phi @ q) / phi[0]
        v[0] += (speed - phi @ v) / phi[0]
        begin = State(displacement=q, velocity=v, time=0.013)
        impacts = simulate(oscillator, begin, duration=0.03).impacts
        start, end = float(impacts.start[0]), float(impacts.end[0])
        touch = impacts.displacement_start[0], impacts.velocity_start[0]
        solved = contact_by_solver(oscillator, start, *touch)
        _r, released, loss, *state = solved.y_events[0][0]
        size = math.sqrt(float(np.sum(v**2 + (omega * q) ** 2)))
        assert end - start == pytest.approx(released - start, rel=2e-10)
        assert impacts.loss[0] == pytest.approx(loss, abs=1e-11 * size**2)
        assert np.max(np.abs(impacts.velocity_end[0] - state[modes:])) < 1e-12 * size
        assert np.max(np.abs(omega * (impacts.displacement_end[0] - state[:modes]))) < 1e-12 * size
        assert np.max(np.abs(impacts.velocity_end[0] - v)) > 1e-5 * size  # the contact did something
        inside = solved.sol(solved.t[-1] * np.array([0.05, 0.2, 0.5, 0.8, 0.95]))
        run = simulate(oscillator, begin, duration=end + 1e-6 - begin.time, times=inside[1])
        assert run.impacts.start[0] == start
        assert np.max(np.abs(run.velocity - inside[3 + modes :].T)) < 1e-11 * size
        assert np.max(np.abs(omega * (run.displacement - inside[3 : 3 + modes].T))) < 1e-11 * size


@pytest.mark.parametrize("law", [HERTZ, SOFTER, LOSSY, SPRING, DASHPOT], ids=repr)
def test_touch_and_release_lie_on_the_wall_to_rounding(law):
    """Heights there are a few rounding errors of the sum over modes; signs are right on either side."""
    oscillator = spring(6, law, drive=(FREQUENCY, 2.2e-3))
    impacts = simulate(oscillator, periods=60).impacts
    finished = np.isfinite(impacts.end)
    assert finished.sum() > 35
    touch = heights(oscillator, impacts.displacement_start)
    release = heights(oscillator, impacts.displacement_end[finished])
    rounding = 2.2e-16 * 4 * (GAP + np.max(np.abs(impacts.displacement_start) @ PHI))
    assert np.max(np.abs(touch)) < 2 * rounding and np.max(np.abs(release)) < 20 * rounding
    np.testing.assert_allclose(impacts.velocity_start @ PHI, impacts.approach, rtol=1e-12)
    np.testing.assert_allclose(impacts.velocity_end[finished] @ PHI, impacts.rebound[finished], rtol=1e-10)
    assert np.all(impacts.approach > 0) and np.all(impacts.rebound[finished] < 0)
    near = 1e-3 * (impacts.end[finished] - impacts.start[finished])
    around = np.stack([at[finished] + side * near for at in (impacts.start, impacts.end) for side in (-1, 1)])
    sampled = simulate(oscillator, periods=60, times=np.sort(around.ravel()))
    signs = np.sign(heights(oscillator, sampled.displacement)).reshape(-1, 4)
    assert np.all(signs == [-1, 1, 1, -1])


@pytest.mark.parametrize(
    "law, allowed", [(HERTZ, 1e-11), (SOFTER, 1e-11), (SPRING, 2e-12), (newton(1.0), 1e-13)], ids=repr
)
def test_energy_is_kept_over_1e4_contacts_of_a_conservative_spring(law, allowed):
    """Each contact is good to rounding, and their errors add up as those of a random walk."""
    oscillator = spring(6, law, damping=0.0)
    state = State(displacement=[-0.002, 0, 0, 0, 0, 0], velocity=np.zeros(6))
    run = simulate(oscillator, state, duration=280.0)
    assert len(run.impacts) > 10_000
    first = oscillator.energy(state.displacement, state.velocity)
    for q, v in (
        (run.strobe_displacement, run.strobe_velocity),
        (run.impacts.displacement_start, run.impacts.velocity_start),
        (run.impacts.displacement_end[:-1], run.impacts.velocity_end[:-1]),
    ):
        outside = heights(oscillator, q) < 1e-12  # inside, the stop stores some of it
        assert outside.sum() > 0.9 * outside.size
        assert np.max(np.abs(oscillator.energy(q, v)[outside] / first - 1)) < allowed
    finished = np.isfinite(run.impacts.end)
    assert np.max(np.abs(run.impacts.loss[finished])) < 1e-13 * first


@pytest.mark.xfail(strict=True, reason="the force k d^(3/2) (1 + chi d') pulls where d' < -1/chi")
def test_hunt_crossley_never_pulls() -> None:
    """A mass thrown at the wall and drawn back by a load: at the end it leaves faster than 1/chi."""
    law = HuntCrossley(stiffness=1e6, dissipation=4.9)
    oscillator = modes_on_stop(0.0, law=law, gap=0.0, load=-50.0)
    state = State(displacement=[-1e-6], velocity=[1.0])
    impacts = simulate(oscillator, state, duration=0.05).impacts
    times = np.linspace(impacts.start[0], impacts.end[0], 1001)
    run = simulate(oscillator, state, duration=0.05, times=times)
    acceleration = np.diff(run.velocity[:, 0]) / np.diff(times)
    assert np.max(acceleration) < -50.0 + 50.0 * 1e-6
