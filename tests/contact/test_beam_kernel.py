"""The kernels of a drive period of the beam: sine, cosine and exponential, and Hertz contact side by side."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contact.event_loop import STATE
from contact.flight.elementary import exponential, sine_cosine
from contact.flight.modal_flow import loaded_drift, tip_state
from contact.flight.motion import LOAD, Motion, motion_of
from contact.laws import HuntCrossley
from contact.touch import hertz
from contact.touch.series import new_series
from contact.trajectory import OUTSIDE


def beam(n: int, *, chi: float = 0.0, decay: float = 0.02, load: float = 0.0) -> Motion:
    """A cantilever-like ladder of `n` modes, driven near the first; over-damped if decay > 2."""
    ladder = np.arange(1.0, n + 1.0)
    omega = 150.0 * (2.0 * ladder - 1.0) ** 2
    omega[0] = 0.0 if load else omega[0]
    return motion_of(
        omega, decay * 150.0 * (2.0 * ladder - 1.0) ** 2, 8.0 / ladder**0.7, gap=0.01, drive=135.0,
        law=HuntCrossley(stiffness=2e7, dissipation=chi), period=2 * math.pi / 135.0,
        response=1e-3 * (1.0 - 0.1j) / ladder**4, load=load * (omega == 0.0),
    )  # fmt: skip


def touching(motion: Motion, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Deviations of a ringing beam whose tip is at the stop at time 0 with velocity `speed` [m/s]."""
    generator = np.random.default_rng(5)
    n = motion.phi.size
    v = 0.02 * generator.standard_normal(n) / np.arange(1, n + 1)
    u = np.where(motion.omega > 0, 0.3 * v / np.maximum(motion.omega, 1.0), 0.0)
    height, rate, _ = tip_state(motion, 0.0, u, v)
    u[0] -= height / motion.phi[0]
    v[0] += (speed - rate) / motion.phi[0]
    return u, v


def contact_by_series(motion: Motion, u: np.ndarray, v: np.ndarray) -> tuple[float, float, int]:
    """Duration of the contact, work on the stop, steps; (u, v) overwritten by the state at the release."""
    series, run = new_series(*hertz.room(motion)), np.zeros(1, dtype=STATE).view(np.recarray)[0]
    run.regime, _rebound, _loss = hertz.strike(motion, run, u, v, 1.0)
    done = 0.0
    for step in range(1, 20_000):
        s, h, run.regime = hertz.step(motion, run, u, v, 1.0, series)
        done += hertz.work(motion, run, s, series)
        hertz.state(motion, run, s, series, u, v)
        run.clock += h
        if run.regime == OUTSIDE:
            return run.clock, done, step
    raise AssertionError("the contact does not end")


def contact_by_solver(motion: Motion, u: np.ndarray, v: np.ndarray) -> float:
    """The same contact by an adaptive Runge-Kutta method of order 8 in sigma; returns its duration."""
    n, w, phi = motion.size, motion.drive, motion.phi

    def rates(_sigma: float, x: np.ndarray) -> np.ndarray:
        r, t, u, v = x[0], x[1], x[2 : 2 + n], x[2 + n :]
        speed = phi @ v + w * (motion.tip_sine * math.cos(w * t) - motion.tip_cosine * math.sin(w * t))
        force = motion.number0 * r**3 * (1.0 + motion.number1 * speed)
        pull = motion.row(LOAD) - motion.decay * v - motion.omega**2 * u - phi * force
        return np.concatenate([[0.5 * speed, r], r * v, r * pull])

    def released(sigma: float, x: np.ndarray) -> float:
        return x[0] if sigma > 0.0 else 1.0

    released.terminal, released.direction = True, -1.0
    scale = math.sqrt(float(np.sum(v**2 + (motion.omega * u) ** 2)))
    size = np.concatenate([[1e-4, 1e-4], scale / np.maximum(motion.omega, 1.0), np.full(n, scale)])
    start = np.concatenate([[0.0, 0.0], u, v])
    found = solve_ivp(rates, (0.0, 1e3), start, "DOP853", events=released, rtol=3e-14, atol=1e-15 * size)
    end = found.y_events[0][0]
    u[:], v[:] = end[2 : 2 + n], end[2 + n :]
    return float(end[1])


@pytest.mark.parametrize("modes", [1, 2, 8, 20, 40])
@pytest.mark.parametrize("chi", [0.0, 0.3])
@pytest.mark.parametrize("decay", [0.02, 2.5])
def test_series_and_solver_give_the_same_collision(modes, chi, decay):
    """Two routes: the power series of the package, or an outside solver."""
    motion = beam(modes, chi=chi, decay=decay)
    for speed in (0.3, 1e-3):
        u, v = touching(motion, speed)
        other_u, other_v = u.copy(), v.copy()
        size = math.sqrt(float(np.sum(v**2 + (motion.omega * u) ** 2)))
        before = v.copy()
        duration, _work, _steps = contact_by_series(motion, u, v)
        assert duration == pytest.approx(contact_by_solver(motion, other_u, other_v), rel=1e-11)
        assert np.max(np.abs(v - before)) > 1e-5 * size  # the collision did something
        np.testing.assert_allclose(v, other_v, rtol=0, atol=2e-13 * size)
        np.testing.assert_allclose(motion.omega * u, motion.omega * other_u, rtol=0, atol=2e-13 * size)


def test_a_contact_takes_a_loaded_mode_of_zero_frequency():
    motion = beam(4, load=3.0)
    u, v = touching(motion, 0.2)
    other_u, other_v = u.copy(), v.copy()
    duration, _work, _steps = contact_by_series(motion, u, v)
    assert duration == pytest.approx(contact_by_solver(motion, other_u, other_v), rel=1e-11)
    np.testing.assert_allclose(v, other_v, rtol=0, atol=1e-13)
    _du, dv = loaded_drift(motion.decay[0], motion.row(LOAD)[0], duration)
    assert abs(dv) > 1e-6  # the load is felt


def test_an_elastic_stop_gives_back_what_it_got_and_a_lossy_one_less():
    for modes in (1, 8, 20):
        u, v = touching(beam(modes), 0.3)
        _duration, work, _steps = contact_by_series(beam(modes), u, v)
        energy = 0.5 * 0.3**2 / beam(modes).compliance
        assert abs(work) < 1e-13 * energy
        motion = beam(modes, chi=0.3)
        u, v = touching(motion, 0.3)
        _duration, work, _steps = contact_by_series(motion, u, v)
        assert 0.01 * energy < work < energy


def test_sine_cosine_and_exponential_are_good_to_one_unit_in_the_last_place():
    generator = np.random.default_rng(2)
    worst = np.zeros(3)
    with mp.workdps(50):
        for _ in range(4000):
            phase = float(generator.choice([-1, 1]) * 10 ** generator.uniform(-6, 6.5))
            rest = float(generator.uniform(-1, 1) * 1e-16 * abs(phase))
            exact = mp.mpf(phase) + mp.mpf(rest)
            size = 1.5 if abs(phase) < 5e5 else 1e4  # beyond, the library's result is turned by `rest`
            for place, (value, true) in enumerate(
                zip(sine_cosine(phase, rest), (mp.sin(exact), mp.cos(exact)), strict=True)
            ):
                error = abs(float((mp.mpf(value) - true) / math.ulp(abs(float(true)))))
                worst[place] = max(worst[place], error / size)
            x = -float(10 ** generator.uniform(-6, 2.85))
            true = mp.exp(x)
            worst[2] = max(worst[2], abs(float((mp.mpf(exponential(x)) - true) / math.ulp(float(true)))) /
            1.5)
    assert np.all(worst < 1.0)
    assert sine_cosine(0.0, 0.0) == (0.0, 1.0)
    assert exponential(0.0) == 1.0 and exponential(-800.0) == 0.0
