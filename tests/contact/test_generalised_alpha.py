"""Newmark, Hilber-Hughes-Taylor and generalised-alpha: the step, its order, its energy and its limits."""

import dataclasses
import math

import numpy as np
import pytest
from oscillators import GAP, OMEGA, THROWN, at_rest_on, modes_on_stop, spring
from scipy.optimize import brentq
from whole_motions import DASHPOT, HERTZ, LOSSY, SPRING, accelerations

from contact import ContactLaw, ImpactOscillator, LinearContact, State, simulate
from contact.integrators import GeneralisedAlpha
from contact.integrators.fixed_step import stiffness_at
from contact.integrators.generalised_alpha import AlphaParameters, limit, stable

NEWMARK = dict(), dict(beta=0.0), dict(beta=1 / 6), dict(beta=0.5, gamma=0.8), dict(beta=0.1, gamma=0.7)
FORMS = [GeneralisedAlpha.newmark(step=1.0, **numbers) for numbers in NEWMARK]
FORMS += [GeneralisedAlpha.hht(step=1.0, alpha=alpha) for alpha in (0.1, 1 / 3)]
FORMS += [GeneralisedAlpha.with_dissipation(step=1.0, rho=rho) for rho in (0.0, 0.8, 1.0)]
FORMS += [GeneralisedAlpha(step=1.0, beta=0.175, gamma=0.75, alpha_f=0.2)]  # p2 p1 = p3 y decides


def factors(parameters: AlphaParameters, size: float, decay: float = 0.0) -> np.ndarray:
    """The roots z of the polynomial in ``generalised_alpha`` for h omega = `size` and h c = `decay`, (3,)."""
    alpha_m, alpha_f, beta, gamma, _eta = parameters
    inertia = np.convolve([1.0 - alpha_m, alpha_m], [1.0, -2.0, 1.0])
    spring = size**2 * np.array([beta, 0.5 + gamma - 2.0 * beta, 0.5 - gamma + beta])
    dashpot = decay * np.array([gamma, 1.0 - 2.0 * gamma, gamma - 1.0])
    return np.asarray(np.roots(inertia + np.convolve([1.0 - alpha_f, alpha_f], spring + dashpot)))


def dense_motion(
    spring: ImpactOscillator, method: GeneralisedAlpha, start: State, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """The same method written down with matrices, its contact force by bisection at the tip."""
    model, law, h = spring.model, spring.stop.law, method.step
    n = spring.n_modes
    stiffness, damping, phi = np.diag(model.omega**2), np.diag(model.decay_rate), np.asarray(model.phi)
    flight, (k, extra) = accelerations(spring), law.numbers[:2]

    def force(q: np.ndarray, v: np.ndarray) -> float:
        depth, rate = phi @ q - spring.stop.gap, phi @ v
        if depth <= 0:
            return 0.0
        if isinstance(law, LinearContact):
            return float(max(0.0, k * depth + extra * rate))
        return float(k * depth**1.5 * (1 + extra * rate))

    m, f, beta, gamma = method.alpha_m, method.alpha_f, method.beta, method.gamma
    q, v = np.array(start.displacement), np.array(start.velocity)
    a = total = flight(start.time, q, v) - phi * force(q, v)
    matrix = (1 - m) * np.eye(n) + (1 - f) * (gamma * h * damping + beta * h**2 * stiffness)
    for i in range(steps):
        q_old = q + h * v + h**2 * (0.5 - beta) * a
        v_old = v + h * (1 - gamma) * a
        known = f * total - m * a + (1 - f) * flight(start.time + (i + 1) * h, q_old, v_old)

        def end(contact: float, known=known, q_old=q_old, v_old=v_old) -> tuple[np.ndarray, ...]:
            new = np.linalg.solve(matrix, known - (1 - f) * phi * contact)
            return q_old + beta * h**2 * new, v_old + gamma * h * new, new

        def balance(contact: float, end=end) -> float:
            return contact - force(*end(contact)[:2])

        first, contact = force(*end(0.0)[:2]), 0.0
        if first != 0.0:
            contact = float(brentq(balance, 0.0, first * (1 + 1e-9), xtol=1e-13, rtol=1e-15))
        q, v, a = end(contact)
        total = flight(start.time + (i + 1) * h, q, v) - phi * force(q, v)
    return q, v


@pytest.mark.parametrize(
    ("form", "law"),
    [*((form, law) for form in (0, 1, 4, 5, 8) for law in (SPRING, HERTZ, LOSSY)), (0, DASHPOT)],
)
def test_the_step_is_that_of_the_matrix_equations(form: int, law: ContactLaw) -> None:
    """Also where a dashpot lets go of the tip before it has left."""
    beam = spring(3, law, drive=None if law is DASHPOT else (21.5, 1e-4))
    method = dataclasses.replace(FORMS[form], step=4e-5)
    steps = 340
    through = simulate(beam, THROWN, duration=steps * method.step, method=method)
    q, v = dense_motion(beam, method, THROWN, steps)
    assert len(through.impacts) >= 1
    # the tip force is good to 1e-15 of N; a contact multiplies what that leaves by less than a thousand
    np.testing.assert_allclose(through.end.displacement, q, rtol=0, atol=1e-12 * GAP)
    np.testing.assert_allclose(through.end.velocity, v, rtol=0, atol=1e-11 * np.abs(v).max())
    assert law is not DASHPOT or through.impacts.loss[0] > 0


@pytest.mark.parametrize("form", range(len(FORMS)))
def test_flight_multiplies_by_the_roots(form: int) -> None:
    """A single mode: the sampled motion obeys the recurrence whose roots are the multipliers."""
    method = dataclasses.replace(FORMS[form], step=1e-3)
    single, times = modes_on_stop(150.0, 9.0, law=SPRING, gap=1.0), method.step * np.arange(1, 12)
    start = State(displacement=np.array([0.1]), velocity=np.array([3.0]))
    motion = simulate(single, start, duration=12e-3, times=times, method=method).displacement[:, 0]
    polynomial = np.poly(factors(method.parameters, 0.150, 0.009))
    residual = np.convolve(motion, polynomial, mode="valid")
    assert np.abs(residual).max() < 1e-13 * np.abs(motion).max()


@pytest.mark.parametrize("form", range(len(FORMS)))
@pytest.mark.parametrize("decay", [0.0, 0.3])
def test_the_limit_is_where_the_radius_leaves_one(form: int, decay: float) -> None:
    """Routh and Hurwitz against the roots themselves; `decay` is c/omega."""
    method = FORMS[form]

    def holds(size: float) -> bool:
        return bool(stable(method.parameters, np.array(size), np.array(decay * size)))

    sizes = np.geomspace(1e-2, 1e4, 241)
    radii = [np.max(np.abs(factors(method.parameters, size, decay * size))) for size in sizes]
    by_roots = np.array(radii) <= 1 + 1e-7
    by_test = np.array([holds(size) for size in sizes])
    largest = limit(method.parameters)
    inner = 0 < largest < math.inf
    away = np.abs(np.log(sizes / largest)) > 1e-3 if inner else np.ones(sizes.size, dtype=bool)
    assert np.array_equal(by_roots[away], by_test[away])
    if decay == 0.0:
        assert np.array_equal(by_test[away], sizes[away] < largest)
    elif largest == math.inf:
        assert by_test.all()


def test_limits_known_in_closed_form() -> None:
    for beta, gamma in ((0.0, 0.5), (0.1, 0.5), (1 / 6, 0.5), (0.0, 0.7), (0.3, 0.8)):
        method = GeneralisedAlpha.newmark(step=1.0, beta=beta, gamma=gamma)
        assert limit(method.parameters) == pytest.approx(1 / math.sqrt(gamma / 2 - beta), rel=1e-14)
    assert limit(GeneralisedAlpha.newmark(step=1.0, beta=0.25, gamma=0.4).parameters) == 0.0
    # T. J. R. Hughes, The Finite Element Method (1987), ch. 9, with damping ratio xi
    method, xi = GeneralisedAlpha.newmark(step=1.0, beta=0.1, gamma=0.7), 0.15
    lead, half = 0.7 / 2 - 0.1, xi * (0.7 - 0.5)
    largest = (half + math.sqrt(lead + half**2)) / lead
    for factor, good in ((1 - 1e-9, True), (1 + 1e-9, False)):
        size = factor * largest
        assert bool(stable(method.parameters, np.array(size), np.array(2 * xi * size))) is good
    # in a lasting contact: the stiffness at which the highest frequency of the closed contact is 2/h
    explicit, motion = GeneralisedAlpha.newmark(step=1.9 / OMEGA[2], beta=0.0), spring(3, SPRING).numbers()
    highest = stiffness_at(motion, (2 / explicit.step) ** 2)
    assert explicit.critical_stiffness(motion) == pytest.approx(highest, rel=1e-12)


def test_the_trapezoidal_rule_keeps_the_energy_of_a_lasting_contact() -> None:
    """Started inside a linear stop that it never leaves; rho = 0.5 loses some."""
    beam, rest = at_rest_on(spring(3, SPRING, damping=0.0).model, SPRING, 800.0)
    start = State(displacement=rest, velocity=np.array([0.01, -0.02, 0.01]))
    times = np.linspace(0.0, 0.2, 41)[1:]

    def energies(method: GeneralisedAlpha) -> np.ndarray:
        motion = simulate(beam, start, duration=0.2, times=times, method=method)
        assert np.all(motion.displacement @ beam.model.phi > 0)
        states, speeds = motion.displacement - rest, motion.velocity
        return np.asarray(beam.energy(states, speeds) + 0.5 * 3e5 * (states @ beam.model.phi) ** 2)

    begun = 0.5 * float(start.velocity @ start.velocity)
    kept = energies(GeneralisedAlpha.newmark(step=1e-3))
    np.testing.assert_allclose(kept, begun, rtol=1e-11)
    lost = energies(GeneralisedAlpha.with_dissipation(step=1e-3, rho=0.5))
    assert lost[-1] < 0.9 * begun
