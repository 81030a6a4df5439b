"""Splitting: exact flights, a contact that stays closed, limits of stability, energy."""

import math

import numpy as np
import pytest
from oscillators import at_rest_on, modes_on_stop, slow
from scipy.linalg import expm

from contact import ContactLaw, HertzContact, ImpactOscillator, LinearContact, State, simulate
from contact.flight.numbers import Numbers
from contact.integrators import Splitting
from contact.integrators.splitting import COMPOSITIONS, first_instability, spectral_radius, step_matrix

OMEGA = np.array([154.0, 940.0, 2370.0, 4500.0])
PHI = np.array([9.0, 8.0, 7.5, 7.0])
SOFT, HARD = LinearContact(stiffness=1e6), HertzContact(stiffness=3e8)
DASHPOT = LinearContact(stiffness=1e6, damping=20.0)


def spring(law: ContactLaw, *, n: int = 4, ratio: float = 0.0, driven: bool = False) -> ImpactOscillator:
    omega, phi, drive = OMEGA[:n], PHI[:n], 22.2 if driven else None
    return modes_on_stop(omega, 2 * ratio * omega, phi, 0.01 * phi, law=law, gap=0.002, drive=drive)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_a_contact_that_stays_closed_is_followed_with_the_full_order(order, damping):
    """Against the matrix exponential of the linear motion in contact."""
    oscillator = spring(LinearContact(stiffness=1e6, damping=damping), ratio=0.01)
    numbers, n, time = oscillator.numbers(), 4, 2e-3
    phi = PHI[:, None]
    stiff, decay = np.diag(OMEGA**2) + 1e6 * phi @ phi.T, np.diag(numbers.decay) + damping * phi @ phi.T
    exact = expm(time * np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -decay]]))
    weight = np.concatenate([OMEGA, np.ones(n)])
    steps = np.array([100, 200, 400]) * (4 if order == 2 else 1)
    errors = []
    for count in steps:
        one = step_matrix(numbers, COMPOSITIONS[order], time / count, 1e6, damping)
        error = weight[:, None] * (np.linalg.matrix_power(one, count) - exact) / weight
        errors.append(np.abs(error).max())
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    assert rates == pytest.approx(order, abs=0.06)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("law", [SOFT, DASHPOT], ids=["spring", "dashpot"])
def test_the_march_is_the_step_matrix(order, law):
    """Tip pressed on the stop: the difference of two marches is a power of the step matrix."""
    oscillator, rest = at_rest_on(spring(law, ratio=0.01).model, law, 100.0)
    shift = np.concatenate([1e-3 * rest, 1e-3 * OMEGA * np.abs(rest)])
    ends = []
    for s in (0.0 * shift, shift):
        start = State(displacement=rest + s[:4], velocity=s[4:])
        end = simulate(oscillator, start, duration=7e-5, method=Splitting(step=1e-5, order=order)).end
        assert end.regime == 1
        ends.append(np.concatenate([end.displacement, end.velocity]))
    change = ends[1] - ends[0]
    once = step_matrix(oscillator.numbers(), COMPOSITIONS[order], 1e-5, law.stiffness, law.damping)
    power = np.linalg.matrix_power(once, 7)
    assert change == pytest.approx(power @ shift, rel=1e-8, abs=1e-11 * np.abs(shift).max())


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("step", [1e-6, 2.3e-3], ids=["short", "longer than the periods of two modes"])
def test_flights_are_exact_at_any_step(order, step):
    """Driven below grazing, with strobes and samples off the grid; short steps are taken many at once."""
    oscillator = spring(HertzContact(stiffness=1.0), ratio=0.01, driven=True).with_excess(-0.6)
    start = State(displacement=[1e-5, -1e-5, 5e-6, 0.0], velocity=[0.005, 0.01, -0.02, 0.01])
    times = np.sort(np.random.default_rng(1).uniform(0.0, 0.2, 40))
    arguments = {"duration": 0.21, "times": times}
    exact = simulate(oscillator, start, **arguments)
    run = simulate(oscillator, start, **arguments, method=Splitting(step=step, order=order))
    assert len(run.impacts) == len(exact.impacts) == 0
    for name in ("displacement", "velocity", "strobe_displacement", "strobe_velocity"):
        ours, theirs = getattr(run, name), getattr(exact, name)
        assert ours == pytest.approx(theirs, abs=2e-12 * np.abs(theirs).max())
    off = OMEGA * (run.end.displacement - exact.end.displacement), run.end.velocity - exact.end.velocity
    assert np.max(PHI * np.hypot(*off)) < 1e-11


@pytest.mark.parametrize("order", [2, 4])
def test_dense_output_in_contact_has_the_order_of_the_method(order):
    """A state between two grid points of a lasting contact, against the exact motion."""
    oscillator, rest = at_rest_on(spring(SOFT, ratio=0.01).model, SOFT, 100.0)
    start, errors = State(displacement=1.2 * rest, velocity=np.zeros(4)), []
    for step in (2e-5, 1e-5, 5e-6):
        times = 5e-4 + step * np.array([0.21, 0.5, 0.83])
        arguments = {"duration": 6e-4, "times": times}
        exact = simulate(oscillator, start, **arguments)
        run = simulate(oscillator, start, **arguments, method=Splitting(step=step, order=order))
        errors.append(np.abs(run.velocity - exact.velocity).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(order, abs=0.5)


def closed_form_limit(numbers: Numbers, step: float, damping: float = 0.0) -> float:
    """k_crit of order 2 for omega h < pi, with a dashpot in the contact [N/m].

    An eigenvector to the eigenvalue -1 satisfies for each mode, whose flow over the step h is (A, B; C, D)
    with determinant e, u = phi J B/(1 + A + D + e), v = phi J (D + e)/(1 + A + D + e), J = s (k phi.u + c
    phi.v), s = (1 - exp(-c Phi h))/(c Phi); hence k = (1/s - c phi.v/J)/(phi.u/J).
    """
    modes = zip(numbers.omega, numbers.decay, strict=True)
    flows = [expm(step * np.array([[0, 1], [-(w**2), -c]])) for w, c in modes]
    weight = numbers.phi**2 / np.array([1 + np.trace(flow) + np.linalg.det(flow) for flow in flows])
    x = sum(w * flow[0, 1] for w, flow in zip(weight, flows, strict=True))
    y = sum(w * (flow[1, 1] + np.linalg.det(flow)) for w, flow in zip(weight, flows, strict=True))
    rate = damping * numbers.inverse_mass
    acts = -math.expm1(-rate * step) / rate if rate > 0 else step
    return float((1 / acts - damping * y) / x)


def test_beyond_pi_the_limit_is_a_resonance_of_step_and_contact():
    """One mode: k h phi^2 |sin theta| / omega = 2 (1 - |cos theta|) or 2 (1 + ...), whichever root is met."""
    numbers = modes_on_stop(1000.0, phi=5.0, law=SOFT).numbers()
    for angle in (4.0, 5.5, 7.5):
        step = angle / 1000.0
        # z = cos(theta) - k h phi^2 sin(theta) / (2 omega) leaves [-1, 1] upwards where sin(theta) < 0
        reach = (1 - math.cos(angle)) if math.sin(angle) < 0 else (1 + math.cos(angle))
        exact = 2 * 1000.0 * reach / (step * 25.0 * abs(math.sin(angle)))
        assert Splitting(step=step).critical_stiffness(numbers) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("ratio, damping", [(0.0, 0.0), (0.0, 30.0), (0.02, 0.0), (0.02, 30.0), (1.5, 5.0)])
@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("radii", [1000, *slow(4000)])
def test_the_first_instability_is_not_preceded_by_another(order, ratio, damping, radii):
    """Against spectral radii below the limit, and one just beyond it; order 2 by the closed form too."""
    for seed in range(3):
        random = np.random.default_rng(seed)
        omega, phi = np.sort(random.uniform(100.0, 5000.0, 4)), random.uniform(1.0, 10.0, 4)
        numbers = modes_on_stop(omega, 2 * ratio * omega, phi, 0.1, law=SOFT).numbers()
        step, steps = (0.3, 1.0, 2.5)[seed % 3] / numbers.omega[-1], COMPOSITIONS[order]
        limit = first_instability(numbers, steps, step, damping)
        below = np.geomspace(1e-3, 0.9999, radii) * limit
        assert spectral_radius(numbers, steps, step, below, damping).max() < 1 + 1e-6
        assert spectral_radius(numbers, steps, step, (1 + 1e-5) * limit, damping) > 1 + 1e-7
        if order == 2:
            digits = 1e-5 if damping or ratio > 1 else 1e-9
            assert limit == pytest.approx(closed_form_limit(numbers, step, damping), rel=digits)


def energy_steps(law: ContactLaw, order: int, step: float, periods: int) -> np.ndarray:
    """What the energy of a lossless beam changes by from touch to touch, over the energy."""
    oscillator = spring(law)
    start = State(displacement=-0.006 / PHI[0] * np.eye(4)[0], velocity=np.zeros(4))
    run = simulate(oscillator, start, periods=periods, method=Splitting(step=step, order=order)).impacts
    whole = oscillator.energy(start.displacement, start.velocity)
    return np.diff(oscillator.energy(run.displacement_start, run.velocity_start)) / whole


@pytest.mark.parametrize(("law", "power"), [(SOFT, 2.0), *slow((HARD, 2.5))], ids=["linear", "Hertz"])
@pytest.mark.parametrize("order", [2, *slow(4)])
def test_over_1e4_contacts_the_energy_wanders_without_drift(law, order, power):
    """Kinks of the force at touch and release give energy steps of order h^(p + 1), of either sign.

    They add up as those of a random walk, whose mean is zero within its error: symplecticity forbids the
    drift, not the walk.
    """
    finest = 2.5e-6 * (1 if order == 2 else 3)
    walks = [energy_steps(law, order, finest * 2**i, 1000) for i in (2, 1)]
    walks.append(energy_steps(law, order, finest, 6000))
    sizes = np.array([np.sqrt(np.mean(walk**2)) for walk in walks])
    assert np.log2(sizes[0] / sizes[2]) / 2 == pytest.approx(power, abs=0.25)
    count = walks[2].size
    assert count >= 10_000 and abs(walks[2].mean()) < 4 * sizes[2] / math.sqrt(count)
    assert abs(walks[2].sum()) < 4 * sizes[2] * math.sqrt(count) < 0.03


def test_a_touch_between_two_grid_points_is_written_down():
    """Order 4 may find the tip behind the stop at an inner kick only."""
    oscillator = spring(LinearContact(stiffness=1e3), n=1)
    a = State(displacement=[0.0019 / PHI[0]], velocity=[0.12 / PHI[0]])
    exact = simulate(oscillator, a, duration=1e-2)
    length = exact.impacts.end[0] - exact.impacts.start[0]
    ahead = exact.impacts.start[0] - 0.05 * length
    start = simulate(oscillator, a, duration=ahead).end
    start = State(displacement=start.displacement, velocity=start.velocity)
    method = Splitting(step=1.2 * length, order=4, beyond_limit=True)
    run = simulate(oscillator, start, duration=4 * length, method=method)
    assert len(run.impacts) == 1
    assert run.impacts.start[0] == 0.0 and run.impacts.end[0] == pytest.approx(1.2 * length)
    assert run.impacts.velocity_end[0] != pytest.approx(run.impacts.velocity_start[0], rel=1e-3)
