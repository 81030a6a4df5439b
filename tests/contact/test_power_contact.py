"""Contact forces that grow with a power of the depth, and a restitution that holds at every speed."""

import math
from fractions import Fraction

import numpy as np
import pytest
from oscillators import THROWN, modes_on_stop, slow, spring
from scipy.integrate import solve_ivp
from simulated_orbit import beam
from test_derivatives import slopes
from whole_motions import accelerations

from contact import ContactLaw, HertzContact, LinearContact, PowerContact, State, orbits, simulate

EXPONENTS = sorted({n / m for m in range(1, 9) for n in range(m, 3 * m + 1)})
DAMPED = sorted({float(1 + 2 * Fraction(n, m)) for m in range(1, 9) for n in range(m + 1)})


@pytest.mark.parametrize("exponents", [[1.0, 1.25, 4 / 3, 1.5, 2.75], *slow(DAMPED)])
def test_a_free_mass_leaves_with_its_restitution_at_every_speed(exponents: list[float]) -> None:
    for exponent in exponents:
        for e, speed in ((e, speed) for e in (0.3, 0.5, 0.9) for speed in (1e-3, 0.02, 1.0)):
            law = PowerContact.with_restitution(stiffness=1e8, exponent=exponent, restitution=e, mass=4.0)
            free = modes_on_stop(0.0, phi=0.5, law=law, gap=0.1 * speed)
            hit = simulate(free, State(displacement=[0.0], velocity=[2.0 * speed]), duration=5.0).impacts
            assert -hit.rebound[0] / hit.approach[0] == pytest.approx(e, rel=1e-12)
            assert hit.loss[0] == pytest.approx(2.0 * speed**2 * (1.0 - e * e), rel=1e-12)


@pytest.mark.parametrize("exponents", [[1.0, 1.125, 1.5, 2.0, 23 / 8], *slow(EXPONENTS)])
def test_depth_and_time_of_an_elastic_contact_are_those_of_its_energy(exponents: list[float]) -> None:
    """m d'^2/2 = m v^2/2 - k d^(p+1)/(p+1); the time is a beta function."""
    for p, speed in ((p, speed) for p in exponents for speed in (1e-3, 1.0)):
        free = modes_on_stop(0.0, phi=0.5, law=PowerContact(stiffness=1e8, exponent=p), gap=0.1 * speed)
        thrown = State(displacement=[0.0], velocity=[2.0 * speed])
        hit = simulate(free, thrown, duration=5.0).impacts
        middle = simulate(free, thrown, duration=5.0, times=[0.5 * (hit.start[0] + hit.end[0])])
        depth = ((p + 1) * 2.0 * speed**2 / 1e8) ** (1 / (p + 1))
        lasts = 2 * math.sqrt(math.pi) * math.gamma(1 + 1 / (p + 1)) / math.gamma(0.5 + 1 / (p + 1))
        assert 0.5 * middle.displacement[0, 0] - 0.1 * speed == pytest.approx(depth, rel=1e-11)
        assert hit.end[0] - hit.start[0] == pytest.approx(lasts * depth / speed, rel=1e-12)
        assert hit.rebound[0] == pytest.approx(-speed, rel=1e-13) and abs(hit.loss[0]) < 1e-13 * speed**2


SPECIAL = [(HertzContact(stiffness=3e7), 1.5), (LinearContact(stiffness=3e5), 1.0)]
SPECIAL += [(LinearContact(stiffness=1e5, damping=60.0), 1.0)]


@pytest.mark.parametrize("law, exponent", SPECIAL)
def test_hertz_and_a_linear_stop_are_cases_of_it(law: ContactLaw, exponent: float) -> None:
    same = PowerContact(stiffness=law.numbers[0], exponent=exponent, damping=law.numbers[1])
    one, other = (simulate(spring(3, each, drive=(21.5, 2.2e-3)), periods=6) for each in (law, same))
    assert len(one.impacts) >= 4 and len(other.impacts) == len(one.impacts)
    assert other.impacts.end == pytest.approx(one.impacts.end, rel=1e-13)
    assert other.impacts.loss == pytest.approx(one.impacts.loss, abs=1e-15)
    assert other.end.velocity == pytest.approx(one.end.velocity, abs=1e-12 * np.abs(one.end.velocity).max())


SEVERAL = [(1.25, 20.0, 2e6), (2.75, 1e6, 4e11)], [(1.5, 300.0, 1.3e7), (2.5, 1e6, 5e10), (2.75, 0.0, 4e11)]


@pytest.mark.parametrize("exponent, damping, k", [*SEVERAL[0], *slow(*SEVERAL[1])])
def test_a_contact_of_several_modes_is_that_of_an_independent_integration(exponent, damping, k) -> None:
    """State and time at the release, and the loss, by DOP853 in time."""
    law = PowerContact(stiffness=k, exponent=exponent, damping=damping)
    oscillator, n = spring(3, law, drive=(21.5, 1e-3)), 3
    hit, phi = simulate(oscillator, THROWN, duration=0.02).impacts, oscillator.model.phi
    flight, gap = accelerations(oscillator), oscillator.stop.gap

    def rates(t: float, x: np.ndarray) -> np.ndarray:
        depth, rate = max(phi @ x[:n] - gap, 0.0), phi @ x[n : 2 * n]
        force = max(0.0, k * depth**exponent + damping * depth ** (0.5 * exponent - 0.5) * rate)
        return np.concatenate([x[n : 2 * n], flight(t, x[:n], x[n : 2 * n]) - phi * force, [force * rate]])

    def released(t: float, x: np.ndarray) -> float:
        return phi @ x[:n] - gap if t > hit.start[0] + 1e-6 else 1.0

    released.terminal, released.direction = True, -1.0
    start = np.concatenate([hit.displacement_start[0], hit.velocity_start[0], [0.0]])
    span, numbers = (hit.start[0], 0.1), dict(rtol=1e-12, atol=1e-17)
    solved = solve_ivp(rates, span, start, "DOP853", events=released, first_step=1e-9, **numbers)
    size = np.linalg.norm(start[n : 2 * n])
    assert hit.end[0] - hit.start[0] == pytest.approx(solved.t[-1] - hit.start[0], rel=1e-9)
    assert hit.loss[0] == pytest.approx(solved.y[-1, -1], abs=1e-9 * size**2)
    assert np.max(np.abs(hit.velocity_end[0] - solved.y[n : 2 * n, -1])) < 1e-9 * size


@pytest.mark.parametrize("exponent, damping", [(1.5, 2e4), *slow((1.25, 2e3), (1.0, 60.0), (2.5, 0.0))])
def test_a_motion_has_its_derivatives_and_an_orbit_comes_back(exponent: float, damping: float) -> None:
    """Differences of order four of a simulated motion, by its start and the numbers of the law."""
    law = PowerContact(stiffness=10.0 ** (6.5 * exponent), exponent=exponent, damping=damping)
    at_rest, change = beam(22.20, law, 3), orbits.Change(law=(law.stiffness, damping))
    oscillator, start = at_rest.with_excess(0.02), State(displacement=np.full(3, 1e-5), velocity=np.zeros(3))

    def observed(step: float) -> list[np.ndarray]:
        moved = State(displacement=start.displacement + 1e-5 * step, velocity=start.velocity)
        run = simulate(change.applied(oscillator, step), moved, periods=5)
        return [run.impacts.start, np.hstack([run.strobe_displacement, run.strobe_velocity])]

    found = orbits.motion_derivatives(oscillator, start, [change], periods=5)
    direction = np.array([1e-5] * 3 + [0.0] * 3 + [1.0])
    for exact, near in zip((found.impact_time, found.strobes), slopes(observed, 1e-6), strict=True):
        assert np.max(np.abs(near - exact @ direction) / np.abs(exact @ direction).max(axis=0)) < 1e-6
    orbit = orbits.Shooting(oscillator=at_rest, m=5).at_speed(0.3)
    run = simulate(at_rest.with_excess(orbit.excess), orbit.state(), periods=5)
    assert len(found.trajectory.impacts) >= 1 and run.impacts.approach[0] == pytest.approx(0.3, rel=1e-9)
    assert run.end.displacement == pytest.approx(orbit.state().displacement, abs=1e-10 * at_rest.stop.gap)
