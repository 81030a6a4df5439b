"""Long runs: phase and energy of the exact methods, accumulation to rest, and the drift of fixed steps.

A flight is the exact flow of a drive period: what remains is its rounding, the same in every period, of about
eps each. An orbit that repeats every m periods repeats to rounding. A method with a step multiplies a free
mode by the principal root z of its polynomial in every step: phase error per radian arg(z)/x - 1, x = h
omega, is x^2/24 for central difference, -x^2/12 for the trapezoidal rule and Moreau and Jean's with theta =
1/2, 0 for splitting.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from oscillators import equation_1
from scipy.linalg import expm

from beam import ModalModel
from contact import (
    Chatter,
    ContactLaw,
    ImpactOscillator,
    LinearContact,
    MaximalFamily,
    NewtonRestitution,
    Regime,
    State,
    Stop,
    StroboscopicMap,
    simulate,
)
from contact.integrators import CentralDifference, GeneralisedAlpha, MoreauJean, Splitting

EPS, OMEGA, GRAVITY = 2.0**-52, 2.0 * math.pi * 24.5, 9.81


def one_mode(law: ContactLaw, gap: float, *, omega: float = OMEGA, load: float = 0.0) -> ImpactOscillator:
    """An undamped mode of unit mass."""
    one = np.ones(1)
    model = ModalModel(omega=omega * one, decay_rate=0.0 * one, phi=one, participation=one)
    return ImpactOscillator(model=model, stop=Stop(gap=gap, law=law), load=load * one)


def letters_mode(restitution: float, frequency: float) -> ImpactOscillator:
    """Eq. (1) of the letter."""
    return equation_1(frequency, NewtonRestitution(local_restitution=restitution), gap=0.0107)


def test_free_flight_keeps_phase_and_energy_for_1e5_periods():
    oscillator = one_mode(NewtonRestitution(local_restitution=0.5), 0.1)
    start = State(displacement=np.full(1, 0.01), velocity=np.zeros(1))
    run = simulate(oscillator, start, periods=100_000)
    for n in (1, 100, 10_000, 100_000):
        with mpmath.workdps(30):
            angle = mpmath.mpf(OMEGA) * n * mpmath.mpf(oscillator.period)
            turn = complex(mpmath.cos(angle), mpmath.sin(angle))
        found = complex(run.strobe_displacement[n - 1, 0], -run.strobe_velocity[n - 1, 0] / OMEGA) / 0.01
        change = np.log(found / turn)
        assert abs(change.imag) < 10 * EPS * (n + 1) and abs(change.real) < 5 * EPS * (n + 1)


def test_a_periodic_orbit_repeats_to_rounding_and_is_the_closed_form():
    """p5 of Eq. (1) at 22.2 Hz, followed for 20 000 drive periods."""
    oscillator = letters_mode(0.1, 22.2)
    orbits = MaximalFamily.from_oscillator(oscillator, period=5).orbits(1e-3)
    (orbit,) = [o for o in orbits if o.stable and o.admissible]
    strobed = StroboscopicMap(oscillator=oscillator.with_amplitude(orbit.amplitude))
    settled = strobed.orbit(strobed.steady(), 10_000).end
    start = State(displacement=settled.displacement, velocity=settled.velocity)
    points = strobed.orbit(start, 20_000).points
    apart = np.abs(points.reshape(-1, 5, 2) - points[-5:]).max() / strobed.scale
    assert apart < 10 * EPS
    times = (math.ceil(orbit.phase * 22.2) + np.arange(5)) / 22.2
    omega, c = (float(row[0]) for row in (oscillator.model.omega, oscillator.model.decay_rate))
    free = [expm(np.array([[0, 1], [-(omega**2), -c]]) * (t - orbit.phase)) @ orbit.after[0] for t in times]
    steady = orbit.amplitude * oscillator.steady_response()  # imaginary and real part at a strobe
    q, v = np.array(free).T + np.array([steady.imag, oscillator.drive.angular_frequency * steady.real])
    closed = np.column_stack([q, v / omega])
    off = min(float(np.abs(points[-5:] - np.roll(closed, k, axis=0)).max()) for k in range(5))
    assert off < 1e-13 * strobed.scale


def test_too_elastic_a_law_is_refused_as_chatter_and_a_lesser_one_comes_to_rest():
    """Hops of a ball that rests after half a period: 1e5, as many as one may hold, at 1 - e = 4.69e-5."""
    for left, refused in ((4.9e-5, False), (4.5e-5, True)):
        ball = one_mode(NewtonRestitution(local_restitution=1.0 - left), 1e-3, omega=0.0, load=GRAVITY)
        start = State(displacement=np.array([1e-3]), velocity=np.array([-0.25 * GRAVITY * left]))
        if refused:
            with pytest.raises(Chatter, match="accumulate") as caught:
                simulate(ball, start, duration=0.9)
            assert 0 < caught.value.time < 0.9 and abs(caught.value.gap) <= 1e-8
            assert abs(caught.value.velocity) <= 5e-4
        else:
            run = simulate(ball, start, duration=0.9)
            assert run.end.regime == Regime.SUSTAINED and 0.9e5 < len(run.impacts) < 1e5


@pytest.mark.parametrize(
    ("method", "error"),
    [
        (CentralDifference, 1 / 24),
        (GeneralisedAlpha.newmark, -1 / 12),
        (MoreauJean, -1 / 12),
        (Splitting, 0.0),
    ],
)
def test_the_phase_of_a_free_mode_drifts_as_theory_says(method, error):
    """From the angle after 20 periods, h omega = 0.1; the amplitude stays."""
    x, steps = 0.1, 1257
    chosen = method(step=x / OMEGA)
    law = NewtonRestitution(local_restitution=0.5) if method is MoreauJean else LinearContact(stiffness=1e-9)
    times = chosen.step * np.arange(1, steps + 1)
    run = simulate(
        one_mode(law, 0.5),
        State(displacement=np.full(1, 0.01), velocity=np.zeros(1)),
        duration=float(times[-1]),
        times=times,
        method=chosen,
    )
    scale = math.sqrt(1.0 - 0.25 * x * x) if method is CentralDifference else 1.0  # its velocities are means
    turn = np.unwrap(np.angle(run.displacement[:, 0] * scale - 1j * run.velocity[:, 0] / OMEGA))
    rate = abs(turn[-1] - turn[0]) / (x * (steps - 1)) - 1.0
    assert rate == pytest.approx(error * x * x, abs=2e-3 * x * x if error else 1e-13)
