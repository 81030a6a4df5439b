"""The kernels of a drive period of the beam: sine, cosine and exponential, and Hertz contact side by side."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from contact.hertz_lanes import (
    ROOT,
    contact_work,
    lane_arrays,
    lane_series,
    lane_state,
    speed_scale,
)
from contact.hertz_series import (
    HERTZ_ORDER,
    evaluate,
    hertz_series,
    hertz_state,
    hertz_step,
)
from contact.hertz_step import lane_step
from contact.modal_flow import mode_rows, scalars_of

from contact.flight.elementary import sine_cosine
from contact.flight.modal_flow import loaded_drift, tip_state
from contact.flight.motion import Motion
from contact.laws import HERTZ


def beam(n: int, *, chi: float = 0.0, decay: float = 0.02, load: float = 0.0) -> Motion:
    """A cantilever-like ladder of `n` modes, driven near the first; over-damped if decay > 2."""
    ladder = np.arange(1.0, n + 1.0)
    omega = 150.0 * (2.0 * ladder - 1.0) ** 2
    omega[0] = 0.0 if load else omega[0]
    phi = 8.0 / ladder**0.7
    sine = 1e-3 / ladder**4
    return Motion(
        omega=omega, decay=decay * 150.0 * (2.0 * ladder - 1.0) ** 2, damped=omega, damped_low=0.0 * omega,
        phi=phi, load=load * (omega == 0.0), sine=sine, cosine=-0.1 * sine, offset=0.0 * omega,
        tip_sine=float(phi @ sine), tip_cosine=float(-0.1 * phi @ sine), level=-0.01, drive=135.0,
        period=2 * math.pi / 135.0, gap=0.01, compliance=float(phi @ phi), law=HERTZ, number0=2e7,
        number1=chi, table=np.empty((0, 0)),
    )


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


def contact_by_lanes(motion: Motion, u: np.ndarray, v: np.ndarray) -> tuple[float, float, int]:
    """Duration of the contact, work on the stop, steps; (u, v) overwritten by the state at the release."""
    fixed, numbers = scalars_of(motion), mode_rows(motion)[0]
    series, sums, scalars = lane_arrays(numbers)
    late, size = np.empty(scalars.shape[1]), speed_scale(fixed, numbers, u, v)
    clock, root, done = 0.0, 0.0, 0.0
    for step in range(1, 20_000):
        scalars[ROOT, 0] = root
        lane_series(fixed, numbers, clock, u, v, series, sums, scalars)
        s, released, h = lane_step(numbers, size, series, scalars, late, 1.0)
        done += contact_work(s, series, scalars)
        lane_state(s, series, sums, scalars, u, v)
        root, clock = evaluate(scalars[ROOT], s), clock + h
        if released:
            return clock, done, step
    raise AssertionError("the contact does not end")


def contact_by_modes(motion: Motion, u: np.ndarray, v: np.ndarray) -> float:
    """The same contact with every mode a series of its own; returns its duration."""
    n = motion.omega.size
    us, vs = np.empty((HERTZ_ORDER + 1, n)), np.empty((HERTZ_ORDER + 1, n))
    scalars = np.empty((7, HERTZ_ORDER + 1))
    clock, root = 0.0, 0.0
    for _ in range(20_000):
        scalars[0, 0] = root
        hertz_series(motion, clock, u, v, us, vs, scalars)
        s, released, h = hertz_step(motion, u, v, us, vs, scalars, 1.0)
        hertz_state(us, vs, s, u, v)
        root, clock = evaluate(scalars[0], s), clock + h
        if released:
            return clock
    raise AssertionError("the contact does not end")


@pytest.mark.parametrize("modes", [1, 2, 8, 20, 40])
@pytest.mark.parametrize("chi", [0.0, 0.3])
@pytest.mark.parametrize("decay", [0.02, 2.5])
def test_modes_side_by_side_and_one_by_one_give_the_same_collision(modes, chi, decay):
    """Two routes: all modes in the columns of one array, or a power series for each of them."""
    motion = beam(modes, chi=chi, decay=decay)
    for speed in (0.3, 1e-3):
        u, v = touching(motion, speed)
        other_u, other_v = u.copy(), v.copy()
        size = math.sqrt(float(np.sum(v**2 + (motion.omega * u) ** 2)))
        before = v.copy()
        duration, _work, _steps = contact_by_lanes(motion, u, v)
        assert duration == pytest.approx(contact_by_modes(motion, other_u, other_v), rel=1e-11)
        assert np.max(np.abs(v - before)) > 1e-5 * size  # the collision did something
        np.testing.assert_allclose(v, other_v, rtol=0, atol=2e-13 * size)
        np.testing.assert_allclose(motion.omega * u, motion.omega * other_u, rtol=0, atol=2e-13 * size)


def test_a_contact_takes_a_loaded_mode_of_zero_frequency():
    motion = beam(4, load=3.0)
    u, v = touching(motion, 0.2)
    other_u, other_v = u.copy(), v.copy()
    duration, _work, _steps = contact_by_lanes(motion, u, v)
    assert duration == pytest.approx(contact_by_modes(motion, other_u, other_v), rel=1e-11)
    np.testing.assert_allclose(v, other_v, rtol=0, atol=1e-13)
    _du, dv = loaded_drift(motion.decay[0], motion.load[0], duration)
    assert abs(dv) > 1e-6  # the load is felt


def test_an_elastic_stop_gives_back_what_it_got_and_a_lossy_one_less():
    for modes in (1, 8, 20):
        u, v = touching(beam(modes), 0.3)
        _duration, work, _steps = contact_by_lanes(beam(modes), u, v)
        energy = 0.5 * 0.3**2 / beam(modes).compliance
        assert abs(work) < 1e-13 * energy
        motion = beam(modes, chi=0.3)
        u, v = touching(motion, 0.3)
        _duration, work, _steps = contact_by_lanes(motion, u, v)
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
            worst[2] = max(worst[2], abs(float((mp.mpf(fading(x)) - true) / math.ulp(float(true)))) / 1.5)
    assert np.all(worst < 1.0)
    assert sine_cosine(0.0, 0.0) == (0.0, 1.0)
    assert fading(0.0) == 1.0 and fading(-800.0) == 0.0


def test_sine_and_cosine_keep_their_quadrants():
    for turns in range(-9, 10):
        for offset in (-0.7, 0.0, 0.7):
            phase = turns * math.pi / 2 + offset
            s, c = sine_cosine(phase, 0.0)
            assert s == pytest.approx(math.sin(phase), abs=3e-16)
            assert c == pytest.approx(math.cos(phase), abs=3e-16)
