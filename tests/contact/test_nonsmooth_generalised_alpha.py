"""The nonsmooth generalised-alpha method: its step, its two neighbours, its order and its energy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.integrators.generalised_alpha import GeneralisedAlpha, chung_hulbert
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.laws import LinearContact, NewtonRestitution
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


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8])
def test_the_step_is_that_of_the_matrix_equations(rho: float) -> None:
    """All unknowns of a step (q, v, a, f, p) in one linear system, both cases of the stop tried."""
    spring, h, steps, e = oscillator(0.6, amplitude=1e-4), 4e-5, 1000, 0.6
    numbers = chung_hulbert(rho)
    m, f, beta, gamma = numbers
    n, one = 3, np.eye(3)
    w = 2 * np.pi * 21.5
    stiffness, damping = np.diag(OMEGA**2), np.diag(0.02 * OMEGA)

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.asarray(GAMMA * 1e-4 * w**2 * math.sin(w * t) - stiffness @ q - damping @ v)

    q, v = np.array(START.displacement), np.array(START.velocity)
    a = smooth = force(0.0, q, v)
    acted = 0
    zero, column = np.zeros((n, n)), np.zeros((n, 1))
    for i in range(steps):
        rows = [
            [one, zero, -beta * h**2 * one, zero, 0.5 * h * PHI[:, None]],
            [zero, one, -gamma * h * one, zero, PHI[:, None]],
            [zero, zero, (1 - m) * one, -(1 - f) * one, column],
            [stiffness, damping, zero, one, column],
        ]
        known = np.concatenate([
            q + h * v + h**2 * (0.5 - beta) * a, v + h * (1 - gamma) * a, f * smooth - m * a,
            GAMMA * 1e-4 * w**2 * math.sin(w * (i + 1) * h),
        ])  # fmt: skip
        before = PHI @ v
        untouched = np.block([*rows, [np.zeros((1, 4 * n)), np.ones((1, 1))]])
        answer = np.linalg.solve(untouched, np.append(known, 0.0))
        if PHI @ q - GAP + 0.5 * h * before >= 0 and PHI @ answer[n : 2 * n] + e * before > 0:
            law = np.concatenate([np.zeros(n), PHI, np.zeros(2 * n + 1)])
            answer = np.linalg.solve(np.block([*rows, [law[None, :]]]), np.append(known, -e * before))
            assert answer[-1] > 0
            acted += 1
        q, v, a, smooth = answer[:n], answer[n : 2 * n], answer[2 * n : 3 * n], answer[3 * n : 4 * n]
    end = simulate(spring, START, duration=steps * h, method=NonsmoothGeneralisedAlpha(step=h, rho=rho)).end
    assert acted >= 2
    np.testing.assert_allclose(end.displacement, q, rtol=0, atol=1e-10 * np.abs(q).max())
    np.testing.assert_allclose(end.velocity, v, rtol=0, atol=1e-10 * np.abs(v).max())


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_without_dissipation_it_is_moreau_and_jean_s(restitution: float) -> None:
    spring = oscillator(restitution, amplitude=6e-3)
    step = 3e-5
    here = simulate(spring, START, periods=4, method=NonsmoothGeneralisedAlpha(step=step, rho=1.0))
    there = simulate(spring, START, periods=4, method=MoreauJean(step=step))
    assert len(here.impacts) == len(there.impacts) >= 4
    scale = np.abs(there.strobe_displacement).max()
    # both round once a step, and the impacts between multiply a difference a few hundred times
    np.testing.assert_allclose(here.strobe_displacement, there.strobe_displacement, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(here.impacts.start, there.impacts.start, rtol=0, atol=1e-14)


@pytest.mark.parametrize("rho", [0.0, 0.5, 1.0])
def test_off_the_stop_it_is_generalised_alpha(rho: float) -> None:
    spring = oscillator(0.6, amplitude=1e-4)
    force_law = ImpactOscillator(
        model=spring.model, stop=Stop(gap=GAP, law=LinearContact(stiffness=1e5)), drive=spring.drive
    )
    times = np.linspace(0.0, 0.0031, 30)
    here = simulate(
        spring, START, duration=0.0031, times=times, method=NonsmoothGeneralisedAlpha(step=2e-5, rho=rho)
    )
    there = simulate(
        force_law, START, duration=0.0031, times=times,
        method=GeneralisedAlpha.with_dissipation(step=2e-5, rho=rho),
    )  # fmt: skip
    assert len(here.impacts) == len(there.impacts) == 0
    np.testing.assert_allclose(here.displacement, there.displacement, rtol=0, atol=1e-13 * GAP)


@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_order(rho: float) -> None:
    """2 in flight; after an impact, whose instant is off by a varying fraction of a step, 1 in the mean."""
    spring = oscillator(0.6, amplitude=1e-4)

    def error(step: float, duration: float, exact: State) -> float:
        method = NonsmoothGeneralisedAlpha(step=step, rho=rho)
        end = simulate(spring, START, duration=duration, method=method).end
        return float(np.linalg.norm(OMEGA * (end.displacement - exact.displacement)))

    flight = simulate(spring, START, duration=0.003)
    assert len(flight.impacts) == 0
    errors = [error(step, 0.003, flight.end) for step in (1e-5, 5e-6, 2.5e-6)]
    assert np.all(np.abs(np.diff(np.log2(errors)) + 2) < 0.1)
    bounced = simulate(spring, START, duration=0.006)
    assert len(bounced.impacts) == 1
    touch = float(bounced.impacts.start[0])
    counts = np.array([400, 1600, 6400])
    means = [np.mean([error(touch / (n + i / 16), 0.006, bounced.end) for i in range(16)]) for n in counts]
    assert abs(np.polyfit(np.log(counts), np.log(means), 1)[0] + 1) < 0.1


def test_elastic_impacts_keep_the_energy_only_without_dissipation() -> None:
    spring = oscillator(1.0, damping=0.0)
    begun = float(spring.energy(START.displacement, START.velocity))

    def left(rho: float) -> float:
        method = NonsmoothGeneralisedAlpha(step=2e-5, rho=rho)
        motion = simulate(spring, START, duration=2.0, method=method)
        assert len(motion.impacts) > 50
        return float(spring.energy(motion.end.displacement, motion.end.velocity)) / begun

    assert left(1.0) == pytest.approx(1.0, rel=1e-11)
    assert left(0.5) < 0.999


def test_a_stay_on_the_stop_does_not_drift() -> None:
    """Held by a load, e = 0: penetration below h U, constant, and the next step as the last."""
    model = ModalModel(omega=OMEGA, decay_rate=0.05 * OMEGA, phi=PHI, participation=GAMMA)
    stop = Stop(gap=GAP, law=NewtonRestitution(local_restitution=0.0))
    spring = ImpactOscillator(model=model, stop=stop, load=np.array([2000.0, 0.0, 0.0]))
    times = np.array([0.6, 0.7, 0.8])
    step = 2e-5
    motion = simulate(
        spring, duration=0.8, times=times, method=NonsmoothGeneralisedAlpha(step=step, rho=0.5)
    )
    depth = motion.displacement @ PHI - GAP
    fastest = motion.impacts.approach.max()
    assert 0 <= depth[-1] < step * fastest
    assert np.ptp(depth) < 1e-6 * step * fastest
    # static equilibrium with the tip held there: omega^2 q = load - phi N
    weights = PHI / OMEGA**2
    hold = (weights @ spring.load - GAP - depth[-1]) / (weights @ PHI)
    rest = (spring.load - PHI * hold) / OMEGA**2
    np.testing.assert_allclose(motion.displacement[-1], rest, atol=1e-6 * GAP)


def test_refusals() -> None:
    with pytest.raises(ValueError, match=r"rho is -0\.1"):
        NonsmoothGeneralisedAlpha(step=1e-5, rho=-0.1)
    with pytest.raises(ValueError, match="step"):
        NonsmoothGeneralisedAlpha(step=math.nan, rho=0.5)
    linear = ImpactOscillator(
        model=oscillator(0.5).model, stop=Stop(gap=GAP, law=LinearContact(stiffness=1e5))
    )
    with pytest.raises(TypeError, match="nonsmooth-generalised-alpha"):
        simulate(linear, START, duration=0.01, method=NonsmoothGeneralisedAlpha(step=1e-5, rho=0.5))
