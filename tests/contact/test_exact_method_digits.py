"""Digits of the exact method: degenerate modes and stiff contacts, against matrix exponentials of 60 digits.

Flights have closed forms in which omega^2 - (c/2)^2 is formed without loss, contacts are power series;
neither takes eigenvectors, so that modes which are critically damped, repeated, of zero frequency, hardly or
very strongly damped should cost no digit. Modal displacements are doubles, so the tip is known to about eps
gap; at a depth d that changes the energy by k d eps gap, of which the largest part gives

    error of the state after a collision ~ omega_c eps gap / v,   omega_c = sqrt(k sum phi^2)

with the approach speed v: the digits go as the root of the stiffness.
"""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from oscillators import at_rest_on, modes_on_stop, slow

from beam import ModalModel
from contact import ContactTooStiff, ImpactOscillator, LinearContact, State, Stop, Trajectory, simulate
from contact.integrators import Exact

EPS = 2.0**-52
GAP, SPEED, DIGITS = 0.005, 0.2, 60
RATIOS = np.array([1.0, 6.1, 15.4, 29.0, 47.0])


def spring(count: int, ratio: float = 0.01) -> ModalModel:
    """`count` modes like those of a leaf spring with a tip mass, damping ratio `ratio` in each."""
    omega = 2.0 * np.pi * 24.5 * RATIOS[:count]
    return modes_on_stop(omega, 2 * ratio * omega, 10.0 / (1.0 + 0.4 * np.arange(count))).model


def modal_stiffness(model: ModalModel) -> float:
    return float(model.omega[0] ** 2 / model.phi[0] ** 2)


def second(omega: float, decay: float) -> ModalModel:
    """A spring of three modes with these numbers for the second."""
    plain = spring(3)
    omegas, decays = plain.omega.copy(), plain.decay_rate.copy()
    omegas[1], decays[1] = omega, decay
    return replace(plain, omega=omegas, decay_rate=decays)


def after(a: mpmath.matrix, b: mpmath.matrix, x: mpmath.matrix, time: mpmath.mpf) -> mpmath.matrix:
    """x(time) of x' = a x + b, from the exponential of the augmented matrix."""
    size = x.rows
    whole = mpmath.zeros(size + 1)
    whole[:size, :size], whole[:size, size] = a, b
    found = mpmath.expm(whole * time)
    return found[:size, :size] * x + found[:size, size]


def generator(model: ModalModel, stiffness: float) -> tuple[mpmath.matrix, mpmath.matrix]:
    """a and b of the motion of (q, q') with the contact closed; stiffness 0 is flight."""
    n, phi = model.n_modes, [mpmath.mpf(float(p)) for p in model.phi]
    a, b = mpmath.zeros(2 * n), mpmath.zeros(2 * n, 1)
    for i in range(n):
        a[i, n + i], a[n + i, n + i] = 1, -mpmath.mpf(float(model.decay_rate[i]))
        for j in range(n):
            a[n + i, j] = -mpmath.mpf(stiffness) * phi[i] * phi[j]
        a[n + i, i] -= mpmath.mpf(float(model.omega[i])) ** 2
        b[n + i] = mpmath.mpf(stiffness) * phi[i] * mpmath.mpf(GAP)
    return a, b


def crossed(model: ModalModel, stiffness: float, x: mpmath.matrix, guess: float) -> tuple:
    """The state when the tip is next at the gap, and that time, by Newton's method from a guess."""
    n, (a, b) = model.n_modes, generator(model, stiffness)
    phi = [mpmath.mpf(float(p)) for p in model.phi]
    time, x = mpmath.mpf(guess), after(a, b, x, mpmath.mpf(guess))
    for _ in range(5):
        depth = sum(phi[i] * x[i] for i in range(n)) - mpmath.mpf(GAP)
        step = -depth / sum(phi[i] * x[n + i] for i in range(n))
        time, x = time + step, after(a, b, x, step)
    return x, time


def error_of_collision(model: ModalModel, stiffness: float, speed: float = SPEED) -> tuple[float, Trajectory]:
    """Error of the state after the first collision, as a velocity over the largest, and the run.

    Every mode starts from its rest position with `speed`; the run ends between release and next touch.
    """
    n = model.n_modes
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=GAP, law=LinearContact(stiffness=stiffness)))
    start = State(displacement=np.zeros(n), velocity=np.full(n, speed))
    impacts = simulate(oscillator, start, duration=0.05).impacts
    touch, release = float(impacts.start[0]), float(impacts.end[0])
    later = float(impacts.start[1]) if len(impacts) > 1 else 0.05
    length = min(0.5 * (release + later), 1.5 * release - 0.5 * touch + 1e-3)
    run = simulate(oscillator, start, duration=length)
    end = float(run.end.time)
    with mpmath.workdps(DIGITS):
        x, begun = crossed(model, 0.0, mpmath.matrix([0] * n + [speed] * n), touch)
        x, lasted = crossed(model, stiffness, x, release - touch)
        x = after(*generator(model, 0.0), x, mpmath.mpf(end) - begun - lasted)
        found = [mpmath.mpf(float(value)) for value in (*run.end.displacement, *run.end.velocity)]
        weight = [*np.maximum(model.omega, 1.0 / end), *np.ones(n)]
        off = max(abs(w * (f - e)) for w, f, e in zip(weight, found, x, strict=True))
        return float(off / max(abs(x[n + i]) for i in range(n))), run


W = float(spring(3).omega[1])
FIRST, DECAY = float(spring(3).omega[0]), float(spring(3).decay_rate[0])
CASES = {
    "ordinary": spring(3),
    "zeta = 1": second(W, 2.0 * W),
    "zeta one rounding above 1": second(W, float(np.nextafter(2.0 * W, np.inf))),
    "zeta one rounding below 1": second(W, float(np.nextafter(2.0 * W, 0.0))),
    "zeta = 1 + 1e-12": second(W, 2.0 * W * (1.0 + 1e-12)),
    "zeta = 1 - 1e-8": second(W, 2.0 * W * (1.0 - 1e-8)),
    "repeated": second(FIRST, DECAY),
    "repeated to 1e-15": second(FIRST * (1.0 + 1e-15), DECAY),
    "repeated to 1e-8": second(FIRST * (1.0 + 1e-8), DECAY),
    "zero frequency": second(0.0, 0.0),
    "zero frequency, drag": second(0.0, 30.0),
    "zeta = 1e-15": second(W, 2e-15 * W),
    "zeta = 1e2": second(W, 2e2 * W),
    "zeta = 1e3": second(W, 2e3 * W),
}


@pytest.mark.parametrize("name", CASES)
def test_a_collision_of_a_spring_with_a_degenerate_mode_keeps_its_digits(name):
    assert error_of_collision(CASES[name], 1e5)[0] < 3e-14 < Exact.accuracy


def worst(model: ModalModel, part: float, starts: int) -> tuple[float, float]:
    """Largest error over some starts, a part in a hundred apart in speed (rounding is a matter of luck), and
    the size of it that the precision of the tip's place lets expect [1]."""
    stiffness = part * modal_stiffness(model)
    found = [error_of_collision(model, stiffness, SPEED * (1.0 + 0.01 * j)) for j in range(starts)]
    assert all(run.evaluations <= 8 for _error, run in found)  # however stiff
    omega_c = math.sqrt(stiffness * float(model.phi @ model.phi))
    return max(error for error, _run in found), omega_c * EPS * GAP / float(found[0][1].impacts.approach[0])


def test_digits_go_as_the_root_of_the_stiffness():
    errors = {}
    for part in (1e4, 1e7, 1e8, 1e12, 1e16):
        errors[part], theory = worst(spring(1), part, 6)
        assert 0.02 * theory < errors[part] < 1.5 * theory
    assert errors[1e7] < Exact.accuracy < errors[1e16]
    assert math.log10(errors[1e16] / errors[1e8]) / 8 == pytest.approx(0.5, abs=0.07)


@pytest.mark.parametrize("part", [1e4, *slow(1e8, 1e12)])
def test_more_modes_lose_no_more_digits(part):
    error, theory = worst(spring(5), part, 2)
    assert error < 1.5 * theory and (error < Exact.accuracy or part > 1e7)


def test_a_lasting_contact_of_too_many_steps_is_refused():
    """One mode pressed on the stop for a whole period: near 3e12 k_modal that takes 1e6 steps."""
    model = spring(1)
    for part, refused in ((1e9, False), (4e12, True)):
        law = LinearContact(stiffness=part * modal_stiffness(model))
        oscillator, rest = at_rest_on(model, law, 1.0)
        start = State(displacement=rest * (1.0 + 1e-6), velocity=np.zeros(1))
        if refused:
            with pytest.raises(ContactTooStiff):
                simulate(oscillator, start, periods=1)
        else:
            assert len(simulate(oscillator, start, periods=1).impacts) == 1
