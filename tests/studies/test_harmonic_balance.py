"""Harmonic balance: exact where the motion is linear, and the orders that its kinks leave elsewhere."""

import math
from dataclasses import replace

import numpy as np
import pytest

from contact import ImpactOscillator, LinearContact, NewtonRestitution, NotPeriodic, Stop, simulate
from contact.orbits import Shooting, follow_path
from studies.methods.work_precision.harmonic_balance import balanced
from studies.methods.work_precision.problems import two_masses


def sprung(damping: float) -> ImpactOscillator:
    return replace(two_masses(0.635), stop=Stop(gap=1.0, law=LinearContact(stiffness=100.0, damping=damping)))


@pytest.mark.parametrize("damping", [0.0, 3.0])
def test_a_motion_that_never_leaves_the_spring_is_solved_at_once(damping: float) -> None:
    """K + k phi phi^T and C + c phi phi^T, under a load that presses: two harmonics, one step."""
    oscillator = replace(sprung(damping), load=np.array([-9.0, -7.0]))
    found, model, w = balanced(oscillator, 5, 64), oscillator.model, oscillator.driven.angular_frequency
    both, pressed = np.outer(model.phi, model.phi), oscillator.load + 100.0 * model.phi
    stiff, loss = np.diag(model.omega**2) + 100.0 * both, np.diag(model.decay_rate) + damping * both
    shaken = np.linalg.solve(stiff - w**2 * np.eye(2) + 1j * w * loss, -0.1j * model.participation)
    np.testing.assert_allclose(found.coefficients[0], np.linalg.solve(stiff, pressed), rtol=1e-12)
    np.testing.assert_allclose(found.coefficients[1], shaken, rtol=0, atol=1e-11)
    assert np.max(np.abs(found.coefficients[2:])) < 1e-12 and found.iterations <= 2


def errors_of(oscillator: ImpactOscillator, order: int) -> tuple[float, ...]:
    """Largest errors of the tip's displacement and velocity within a period of the settled motion."""
    start, grid = simulate(oscillator, periods=400).end, np.linspace(0.0, 0.999 * oscillator.period, 4000)
    run = simulate(oscillator, start, periods=1, times=start.time + grid)
    found = balanced(oscillator, order, 2**18, start)
    errors = run.displacement - found.modes(run.time), run.velocity - found.modes(run.time, 1)
    return tuple(float(np.max(np.abs(oscillator.tip(error)))) for error in errors)


def test_coefficients_and_errors_are_those_that_the_kinks_of_the_force_leave() -> None:
    """x''' jumps by k v: C_h = w/pi sum jump exp(-i h w t)/(h w)^4 up to (10/h w)^2, 10 rad/s being the
    frequency in contact; beyond H the series adds up to no more than if all were in phase."""
    oscillator, h = two_masses(0.635), np.arange(60, 151)
    w, start = oscillator.driven.angular_frequency, simulate(oscillator, periods=400).end
    met = simulate(oscillator, start, periods=1).impacts
    times, jumps = [*met.start, *met.end], 100.0 * np.append(-met.approach, met.rebound)
    found, size = balanced(oscillator, 161, 2**18, start).coefficients, np.sum(np.abs(jumps)) / math.pi
    expected = w / math.pi * (np.exp(-1j * w * np.outer(h, times)) @ jumps) / (h * w) ** 4
    away = np.abs(oscillator.tip(found)[h] - expected)
    assert np.max(away / (size * w) * (h * w) ** 6) < 2.0 * 10.0**2
    for order in (41, 81, 161):
        place, speed = errors_of(oscillator, order)
        assert 0.3 < place * 3.0 * (order * w) ** 3 / size < 1.0
        assert 0.3 < speed * 2.0 * (order * w) ** 2 / size < 1.0


def test_a_dashpot_costs_an_order() -> None:
    """The force jumps by c v at the touch, and the velocity errs by H^-1 instead of H^-2."""
    coarse, fine = (errors_of(sprung(damping=2.0), order)[1] for order in (81, 161))
    assert math.log2(coarse / fine) == pytest.approx(1.0, abs=0.15)


def test_what_cannot_be_balanced_is_refused_and_what_is_not_found_is_said() -> None:
    hard = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.5))
    with pytest.raises(ValueError, match="NewtonRestitution"):
        balanced(replace(two_masses(0.635), stop=hard), 21, 1024)
    with pytest.raises(NotPeriodic, match="order 21"):  # the steady response goes twice as far as the gap
        balanced(two_masses(0.635), 21, 1024)


BY_A_BOUNDARY_PROBLEM = {
    "torus": (0.581900650365, 0.618606874267),
    "period doubling": (0.738783025373, 0.755586159356),
    "fold": (0.755627352609, 0.653440134549),
}
"""W from a solution in 40 digits by a program of its own: contact and flight as two pieces of unknown
durations, closed, with a condition on the eigenvalues of their product."""


def test_the_bifurcations_of_two_masses_by_a_boundary_problem_in_40_digits():
    here = two_masses(0.635)
    settled = replace(simulate(here, periods=400).end, time=0.0)
    start = Shooting(oscillator=here, m=1, impacts=1).from_state(settled)
    branch = follow_path(two_masses, start, 0.635, low=0.5, high=0.8, step=0.3)
    for kind, exact in BY_A_BOUNDARY_PROBLEM.items():
        found = [event.parameter for event in branch.events if event.kind == kind]
        assert found == pytest.approx(list(exact), abs=2e-12)
    here = min(branch.orbits, key=lambda orbit: abs(orbit.oscillator.drive.angular_frequency - 0.635))
    assert abs(here.multipliers[0]) == pytest.approx(0.885750370466, abs=2e-12)
