"""Splitting: exact flights and kicks, order under smooth and kinked forces, limits of stability, energy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.errors import StepTooLarge
from contact.flight.motion import COSINE, SINE, Motion
from contact.integrators.splitting import (
    COMPOSITIONS,
    Splitting,
    first_instability,
    spectral_radius,
    step_matrix,
)
from contact.integrators.splitting_step import Composition, kick, tip_at, tip_rate
from contact.laws import ContactLaw, HertzContact, HuntCrossley, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.stability.lasting_contact import growth

OMEGA = np.array([154.0, 940.0, 2370.0, 4500.0])
PHI = np.array([9.0, 8.0, 7.5, 7.0])
SOFT, HARD = LinearContact(stiffness=1e6), HertzContact(stiffness=3e8)
DASHPOT, LOSSY = LinearContact(stiffness=1e6, damping=20.0), HuntCrossley(stiffness=3e8, dissipation=0.3)


def spring(
    law: ContactLaw, *, n: int = 4, ratio: float = 0.0, gap: float = 0.002, driven: bool = False,
    load: float = 0.0,
) -> ImpactOscillator:  # fmt: skip
    omega, phi = OMEGA[:n], PHI[:n]
    model = ModalModel(omega=omega, decay_rate=2 * ratio * omega, phi=phi, participation=0.01 * phi)
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=gap, law=law), drive=HarmonicDrive(frequency=22.2) if driven else None,
        load=load * phi if load else None,
    )  # fmt: skip
    return oscillator.with_excess(0.02) if driven else oscillator


def moving(*, speed: float = 1.2, n: int = 4, place: float = 0.0017) -> State:
    """Mode 1 alone, on its way to the stop."""
    one = np.eye(n)[0] / PHI[0]
    return State(displacement=place * one, velocity=speed * one)


def apart(a: State, b: State) -> float:
    """Difference of two states as a tip velocity [m/s]."""
    n = a.displacement.size
    return float(
        np.hypot(
            PHI[:n] * OMEGA[:n] * (a.displacement - b.displacement), PHI[:n] * (a.velocity - b.velocity)
        ).max()
    )


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_a_contact_that_stays_closed_is_followed_with_the_full_order(order, damping):
    """Against the matrix exponential of the linear motion in contact."""
    oscillator = spring(LinearContact(stiffness=1e6, damping=damping), ratio=0.01)
    motion, n, time = oscillator.motion(), 4, 2e-3
    phi = PHI[:, None]
    stiff, decay = np.diag(OMEGA**2) + 1e6 * phi @ phi.T, np.diag(motion.decay) + damping * phi @ phi.T
    exact = expm(time * np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -decay]]))
    weight = np.concatenate([OMEGA, np.ones(n)])
    steps = np.array([100, 200, 400]) * (4 if order == 2 else 1)
    errors = []
    for count in steps:
        one = step_matrix(motion, COMPOSITIONS[order], time / count, 1e6, damping)
        error = weight[:, None] * (np.linalg.matrix_power(one, count) - exact) / weight
        errors.append(np.abs(error).max())
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    assert rates == pytest.approx(order, abs=0.06)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("law", [SOFT, DASHPOT], ids=["spring", "dashpot"])
def test_the_march_is_the_step_matrix(order, law):
    """Tip pressed on the stop: the difference of two marches is a power of the step matrix."""
    oscillator = spring(law, ratio=0.01, gap=0.0, load=100.0)
    method = Splitting(step=1e-5, order=order)
    rest = np.linalg.solve(np.diag(OMEGA**2) + 1e6 * np.outer(PHI, PHI), 100.0 * PHI)
    shift = np.concatenate([1e-3 * rest, 1e-3 * OMEGA * np.abs(rest)])
    ends = []
    for s in (0.0 * shift, shift):
        start = State(displacement=rest + s[:4], velocity=s[4:])
        end = simulate(oscillator, start, duration=7e-5, method=method).end
        assert end.regime == 1
        ends.append(np.concatenate([end.displacement, end.velocity]))
    change = ends[1] - ends[0]
    power = np.linalg.matrix_power(
        step_matrix(oscillator.motion(), COMPOSITIONS[order], 1e-5, 1e6, law.damping), 7
    )
    assert change == pytest.approx(power @ shift, rel=1e-8, abs=1e-11 * np.abs(shift).max())


@pytest.mark.parametrize("law", [SOFT, DASHPOT, HARD, LOSSY], ids=["spring", "dashpot", "Hertz", "lossy"])
@pytest.mark.parametrize("rate", [1.5, -0.9])
def test_a_kick_solves_its_equation(law, rate):
    """r' = -Phi N(d, r) at frozen depth, and the energy handed to the stop."""
    oscillator = spring(law)
    motion, depth, time = oscillator.motion(), 2e-4, 3e-4
    v = rate * PHI / motion.compliance
    k, c = law.numbers

    def force(r: float) -> float:
        return max(0.0, k * depth + c * r) if law.code == SOFT.code else k * depth**1.5 * (1 + c * r)

    def slope(_time: float, y: np.ndarray) -> list[float]:
        return [-motion.compliance * force(y[0]), force(y[0]) * y[0]]

    exact = solve_ivp(slope, (0, time), [rate, 0.0], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    taken = kick(motion, (depth, 0.0, 1.0), v, time)
    assert PHI @ v == pytest.approx(exact[0], rel=1e-10)
    assert taken == pytest.approx(exact[1], rel=1e-9)


def test_a_dashpot_that_would_pull_does_nothing():
    oscillator = spring(DASHPOT)
    v = -11.0 * PHI / oscillator.motion().compliance  # k d + c d' = 200 - 220 N
    before = v.copy()
    assert kick(oscillator.motion(), (2e-4, 0.0, 1.0), v, 3e-4) == 0.0
    assert np.array_equal(v, before)


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
    assert apart(run.end, exact.end) < 1e-11


def test_a_falling_body_is_followed_through_its_contact():
    """A mode without stiffness, under its weight, on a spring: the closed form of a mass on a spring."""
    model = ModalModel(omega=np.zeros(1), decay_rate=np.zeros(1), phi=np.ones(1), participation=np.zeros(1))
    law = LinearContact(stiffness=1e4)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=1.0, law=law), load=np.array([9.81]))
    run = simulate(oscillator, State.rest(1), duration=1.0, method=Splitting(step=1e-5))
    assert run.impacts.start[0] == pytest.approx(math.sqrt(2 / 9.81), rel=1e-13)
    speed, w = math.sqrt(2 * 9.81), 100.0
    length = 2 * (math.pi - math.atan(speed * w / 9.81)) / w
    assert run.impacts.end[0] - run.impacts.start[0] == pytest.approx(length, rel=1e-5)
    assert run.impacts.rebound[0] == pytest.approx(-speed, rel=1e-5)
    assert abs(run.impacts.loss[0]) < 1e-4 * 9.81


def test_the_first_touch_is_a_root_of_the_exact_flow():
    """However long the step is against the periods of the modes, the touch is that of the exact flight."""
    oscillator = spring(HARD, ratio=0.002)
    start = State(displacement=moving().displacement, velocity=[0.12, 0.02, -0.01, 0.01])
    exact = simulate(oscillator, start, duration=2e-3).impacts
    for step in (1e-6, 1e-5, 1e-4):
        method = Splitting(step=step, beyond_limit=True)
        run = simulate(oscillator, start, duration=2e-3, method=method).impacts
        assert run.start[0] == pytest.approx(exact.start[0], abs=1e-15)
        assert run.velocity_start[0] == pytest.approx(exact.velocity_start[0], abs=1e-12)
        assert run.approach[0] == pytest.approx(exact.approach[0], rel=1e-12)


@pytest.mark.parametrize("order", [2, 4])
def test_dense_output_in_contact_has_the_order_of_the_method(order):
    """A state between two grid points of a lasting contact, against the exact motion."""
    oscillator = spring(SOFT, ratio=0.01, gap=0.0, load=100.0)
    rest = np.linalg.solve(np.diag(OMEGA**2) + 1e6 * np.outer(PHI, PHI), 100.0 * PHI)
    start = State(displacement=1.2 * rest, velocity=np.zeros(4))
    errors = []
    for step in (2e-5, 1e-5, 5e-6):
        times = 5e-4 + step * np.array([0.21, 0.5, 0.83])
        arguments = {"duration": 6e-4, "times": times}
        exact = simulate(oscillator, start, **arguments)
        run = simulate(oscillator, start, **arguments, method=Splitting(step=step, order=order))
        errors.append(np.abs(run.velocity - exact.velocity).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(order, abs=0.5)


def collision_errors(law: ContactLaw, order: int, steps: np.ndarray, tries: int) -> np.ndarray:
    """Root mean square, over places of the touch within the step, of the error after one collision [m/s]."""
    oscillator, shifts = spring(law), np.random.default_rng(3)
    errors = np.zeros(steps.size)
    for i, step in enumerate(steps):
        for j in range(tries):
            ahead = 1e-4 + step * (j + shifts.uniform()) / tries
            start = simulate(oscillator, moving(), duration=ahead).end
            start = State(displacement=start.displacement, velocity=start.velocity)
            exact = simulate(oscillator, start, duration=5.5e-4)
            assert len(exact.impacts) == 1 and exact.end.regime == 0
            method = Splitting(
                step=step * (1.0 + 0.1 * shifts.uniform()), order=order, beyond_limit=True
            )
            run = simulate(oscillator, start, duration=5.5e-4, method=method)
            errors[i] += apart(run.end, exact.end) ** 2
    return np.sqrt(errors / tries)


@pytest.mark.parametrize(
    ("law", "order", "observed"),
    [(HARD, 2, 2.0), (HARD, 4, 2.5), (LOSSY, 2, 2.0), (SOFT, 2, 2.0), (SOFT, 4, 2.0), (DASHPOT, 2, 1.0),
     (DASHPOT, 4, 1.0)],
)  # fmt: skip
def test_order_in_a_collision(law, order, observed):
    """A force that begins as d^p costs h^(p + 1) at the touch and at the release."""
    steps = (1e-6 if order == 2 else 4e-6) * 2.0 ** -np.arange(5)
    errors = collision_errors(law, order, steps, 32)
    rate = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert rate == pytest.approx(observed, abs=0.25)


def closed_form_limit(motion: Motion, step: float, damping: float = 0.0) -> float:
    """k_crit of order 2 for omega h < pi, with a dashpot in the contact [N/m].

    An eigenvector to the eigenvalue -1 satisfies for each mode, whose flow over the step h is (A, B; C, D)
    with determinant e, u = phi J B/(1 + A + D + e), v = phi J (D + e)/(1 + A + D + e), J = s (k phi.u + c
    phi.v), s = (1 - exp(-c Phi h))/(c Phi); hence k = (1/s - c phi.v/J)/(phi.u/J).
    """
    modes = zip(motion.omega, motion.decay, strict=True)
    flows = [expm(step * np.array([[0, 1], [-(w**2), -c]])) for w, c in modes]
    weight = motion.phi**2 / np.array([1 + np.trace(flow) + np.linalg.det(flow) for flow in flows])
    x = sum(w * flow[0, 1] for w, flow in zip(weight, flows, strict=True))
    y = sum(w * (flow[1, 1] + np.linalg.det(flow)) for w, flow in zip(weight, flows, strict=True))
    rate = damping * motion.compliance
    acts = -math.expm1(-rate * step) / rate if rate > 0 else step
    return float((1 / acts - damping * y) / x)


def random_beam(seed: int, n: int, ratio: float) -> ImpactOscillator:
    """Modes with frequencies and tip values as they come."""
    random = np.random.default_rng(seed)
    omega = np.sort(random.uniform(100.0, 5000.0, n))
    model = ModalModel(
        omega=omega, decay_rate=2 * ratio * omega, phi=random.uniform(1.0, 10.0, n),
        participation=0.1 * np.ones(n),
    )  # fmt: skip
    return ImpactOscillator(model=model, stop=Stop(gap=0.01, law=SOFT))


@pytest.mark.parametrize(
    ("ratio", "damping"), [(0.0, 0.0), (0.0, 30.0), (0.02, 0.0), (0.02, 30.0), (1.5, 5.0)]
)
def test_the_closed_form_of_the_limit_is_the_spectral_radius_of_the_step(ratio, damping):
    """Order 2, omega h < pi, also with modal damping (under- and over-critical) and with a dashpot."""
    for seed in range(6):
        motion = random_beam(seed, 5, ratio).motion()
        step = (0.3, 1.0, 2.0)[seed % 3] / motion.omega[-1]
        limit = closed_form_limit(motion, step, damping)
        assert limit == pytest.approx(first_instability(motion, COMPOSITIONS[2], step, damping), rel=1e-5)


def symmetric(*parts: float) -> Composition:
    """Steps of order 2 one after the other."""
    kicks = np.convolve(parts, [0.5, 0.5])
    return Composition(flows=np.array(parts), kicks=kicks)


def test_of_three_compositions_the_one_chosen_errs_least_and_bears_most():
    """A free body on a spring, equal numbers of kicks: what ``splitting`` says of Suzuki's and Yoshida's."""
    third, p = 1 / (2 - 2 ** (1 / 3)), 1 / (4 - 4 ** (1 / 3))
    others = {"Suzuki": symmetric(p, p, 1 - 4 * p, p, p), "Yoshida": symmetric(third, 1 - 2 * third, third)}
    model = ModalModel(omega=np.zeros(1), decay_rate=np.zeros(1), phi=np.ones(1), participation=np.zeros(1))
    motion = ImpactOscillator(model=model, stop=Stop(gap=0.01, law=SOFT)).motion()
    errors, limits = {}, {}
    for name, composition in {"ours": COMPOSITIONS[4], **others}.items():
        step = 0.02 * composition.flows.size
        once = step_matrix(motion, composition, step, 1.0)
        exact = np.array([[math.cos(step), math.sin(step)], [-math.sin(step), math.cos(step)]])
        errors[name] = np.abs(once - exact).max() / step
        limits[name] = first_instability(motion, composition, step) / (4 / 0.02**2)
    assert errors["Suzuki"] / errors["ours"] == pytest.approx(140, rel=0.05)
    assert errors["Yoshida"] / errors["ours"] == pytest.approx(420, rel=0.05)
    assert [limits[name] for name in ("ours", "Suzuki", "Yoshida")] == pytest.approx(
        [0.0695, 0.0740, 0.0688], abs=5e-5
    )
    stiffness = np.linspace(0.069, 0.2, 40_000)
    radius = spectral_radius(motion, COMPOSITIONS[4], 0.02 * 6, stiffness * 4 / 0.02**2)
    tongue = radius[stiffness < 0.17]
    assert tongue.max() == pytest.approx(1.0024, abs=1e-4)
    unstable = stiffness[radius > 1 + 1e-7]
    assert unstable[unstable < 0.17].max() == pytest.approx(0.0697, abs=5e-5)
    assert unstable[unstable > 0.08].min() == pytest.approx(0.175, abs=5e-4)


def test_without_damping_the_limit_is_a_sum_of_tangents():
    motion = random_beam(7, 6, 0.0).motion()
    for angle in (0.5, 2.0, 3.0, 3.14):
        step = angle / motion.omega[-1]
        tangents = np.sum(motion.phi**2 * np.tan(motion.omega * step / 2) / (2 * motion.omega))
        limit = first_instability(motion, COMPOSITIONS[2], step)
        assert limit == pytest.approx(1 / (step * tangents), rel=1e-9)
    # a short step: central difference on the free body that the tip is for a moment
    step = 1e-3 / motion.omega[-1]
    limit = first_instability(motion, COMPOSITIONS[2], step)
    assert limit == pytest.approx(4 / (step**2 * motion.compliance), rel=1e-6)


def test_beyond_pi_the_limit_is_a_resonance_of_step_and_contact():
    """One mode: k h phi^2 |sin theta| / omega = 2 (1 - |cos theta|) or 2 (1 + ...), whichever root is met."""
    model = ModalModel(omega=[1000.0], decay_rate=[0.0], phi=[5.0], participation=[0.1])
    motion = ImpactOscillator(model=model, stop=Stop(gap=0.01, law=SOFT)).motion()
    for angle in (4.0, 5.5, 7.5):
        step = angle / 1000.0
        # z = cos(theta) - k h phi^2 sin(theta) / (2 omega) leaves [-1, 1] upwards where sin(theta) < 0
        room = (1 - math.cos(angle)) if math.sin(angle) < 0 else (1 + math.cos(angle))
        exact = 2 * 1000.0 * room / (step * 25.0 * abs(math.sin(angle)))
        assert Splitting(step=step).critical_stiffness(motion) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("ratio", [0.0, 0.02])
@pytest.mark.parametrize("order", [2, 4])
def test_the_first_instability_is_not_preceded_by_another(order, ratio):
    """Against 4000 spectral radii below the limit, and one just beyond it; order 2 by the closed form too."""
    for seed in range(6):
        motion = random_beam(seed, 4, ratio).motion()
        step = (0.3, 1.0, 2.5)[seed % 3] / motion.omega[-1]
        limit = first_instability(motion, COMPOSITIONS[order], step)
        below = spectral_radius(motion, COMPOSITIONS[order], step, np.geomspace(1e-3, 0.9999, 4000) * limit)
        assert below.max() < 1 + 1e-6
        assert spectral_radius(motion, COMPOSITIONS[order], step, (1 + 1e-5) * limit) > 1 + 1e-6
        if order == 2:
            assert limit == pytest.approx(closed_form_limit(motion, step), rel=1e-9)


@pytest.mark.parametrize(("order", "damping"), [(2, 0.0), (2, 20.0), (4, 0.0)])
def test_a_lasting_contact_grows_beyond_the_limit_at_the_rate_of_the_step_matrix(order, damping):
    law = LinearContact(stiffness=1e6, damping=damping)
    motion = spring(law).motion()
    step = 3e-5 * order
    limit = Splitting(step=step, order=order).critical_stiffness(motion)
    for part, grown in ((0.9995, False), (1.0005, True)):
        oscillator = spring(LinearContact(stiffness=part * limit, damping=damping), gap=0.0, load=100.0)
        rest = np.linalg.solve(np.diag(OMEGA**2) + part * limit * np.outer(PHI, PHI), 100.0 * PHI)
        pressed = State(displacement=rest, velocity=0.0 * rest)
        rate = growth(oscillator, pressed, Splitting(step=step, order=order))
        radius = spectral_radius(motion, COMPOSITIONS[order], step, part * limit, damping)
        if grown:
            assert radius > 1.0005
            assert rate == pytest.approx(math.log(radius), rel=0.2)
        else:
            assert radius <= 1 + 1e-7 and rate < 2e-4


def test_what_is_refused():
    with pytest.raises(ValueError, match="order is 3; it must be 2 or 4"):
        Splitting(step=1e-5, order=3)
    with pytest.raises(ValueError, match="step is 0"):
        Splitting(step=0.0)
    with pytest.raises(TypeError, match="follows LinearContact, HertzContact or HuntCrossley"):
        simulate(
            spring(NewtonRestitution(local_restitution=0.5)), duration=1e-3, method=Splitting(step=1e-5)
        )
    method = Splitting(step=3e-4)
    limit = method.critical_stiffness(spring(SOFT).motion())
    assert simulate(spring(LinearContact(stiffness=0.99 * limit)), moving(), duration=2e-3, method=method)
    with pytest.raises(StepTooLarge, match="it bears"):
        simulate(spring(LinearContact(stiffness=1.01 * limit)), moving(), duration=2e-3, method=method)


def test_a_hertz_contact_is_refused_when_it_becomes_too_stiff():
    oscillator = spring(HARD)
    deepest = (simulate(oscillator, moving(), duration=3e-4).end.displacement @ PHI) - 0.002
    stiffest = 1.5 * 3e8 * math.sqrt(deepest)  # at least
    step = 2.0 / math.sqrt(oscillator.motion().compliance * stiffest)
    with pytest.raises(StepTooLarge, match="too stiff") as refused:
        simulate(oscillator, moving(), duration=1e-2, method=Splitting(step=1.2 * step))
    assert 1.5 * 3e8 * math.sqrt(-refused.value.gap) > Splitting(step=1.2 * step).critical_stiffness(
        oscillator.motion()
    )


def left_alone(oscillator: ImpactOscillator, near: State, method: Splitting) -> State:
    """The state that a step leaves as it is: in a closed contact the step is affine, x' = M x + ..."""
    after = simulate(oscillator, near, duration=method.step, method=method).end
    x, new = (np.concatenate([state.displacement, state.velocity]) for state in (near, after))
    stiffness = oscillator.stop.law.numbers[0]
    matrix = step_matrix(oscillator.motion(), COMPOSITIONS[method.order], method.step, stiffness)
    rest = x + np.linalg.solve(np.eye(x.size) - matrix, new - x)
    return State(displacement=rest[: x.size // 2], velocity=rest[x.size // 2 :])


@pytest.mark.parametrize("order", [2, 4])
def test_the_energy_of_a_closed_contact_does_not_drift(order):
    """2e5 steps at half the limit: what is seen in the first tenth is seen in the last."""
    method = Splitting(step=3e-5 * order / 2, order=order)
    stiffness = 0.5 * method.critical_stiffness(spring(SOFT).motion())
    oscillator = spring(LinearContact(stiffness=stiffness), gap=0.0, load=100.0)
    place = np.linalg.solve(np.diag(OMEGA**2) + stiffness * np.outer(PHI, PHI), 100.0 * PHI)
    rest = left_alone(oscillator, State(displacement=place, velocity=0.0 * place), method)
    start = State(displacement=rest.displacement * [1.3, 0.9, 1.2, 0.9], velocity=rest.velocity)
    count = 200_000
    times = method.step * np.arange(1, count + 1)
    run = simulate(oscillator, start, duration=times[-1], times=times, method=method)
    assert len(run.impacts) == 1 and run.end.regime == 1
    tip = run.displacement @ PHI
    energy = (
        oscillator.energy(run.displacement, run.velocity) + 0.5 * stiffness * tip**2 - 100.0 * tip
    )
    first, last = energy[: count // 10], energy[-count // 10 :]
    spread = first.max() - first.min()
    assert spread > 1e-6 * np.abs(first).mean()  # the method's own ripple is there
    assert abs(last.mean() - first.mean()) < 0.01 * spread
    assert last.max() - last.min() == pytest.approx(spread, rel=0.05)


def energy_steps(law: ContactLaw, order: int, step: float, periods: int) -> np.ndarray:
    """What the energy of a lossless beam changes by from touch to touch, over the energy."""
    oscillator = spring(law)
    start = State(displacement=-0.006 / PHI[0] * np.eye(4)[0], velocity=np.zeros(4))
    run = simulate(oscillator, start, periods=periods, method=Splitting(step=step, order=order)).impacts
    whole = oscillator.energy(start.displacement, start.velocity)
    return np.diff(oscillator.energy(run.displacement_start, run.velocity_start)) / whole


@pytest.mark.parametrize(("law", "power"), [(SOFT, 2.0), (HARD, 2.5)], ids=["linear", "Hertz"])
@pytest.mark.parametrize("order", [2, 4])
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
    assert count >= 10_000
    assert abs(walks[2].mean()) < 4 * sizes[2] / math.sqrt(count)
    assert abs(walks[2].sum()) < 4 * sizes[2] * math.sqrt(count) < 0.03


def test_a_touch_between_two_grid_points_is_written_down():
    """Order 4 may find the tip behind the stop at an inner kick only."""
    oscillator = spring(LinearContact(stiffness=1e3), n=1)
    a = moving(n=1, speed=0.12, place=0.0019)
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


def test_kicks_see_depth_and_rate_of_the_driven_tip():
    oscillator = spring(HARD, driven=True)
    motion, clock = oscillator.motion(), 0.0123
    u, v = np.array([1e-4, 2e-5, -1e-5, 3e-6]), np.array([0.01, -0.02, 0.03, 0.01])
    angle = motion.drive * clock
    q = u + motion.row(SINE) * math.sin(angle) + motion.row(COSINE) * math.cos(angle)
    rate = v + motion.drive * (motion.row(SINE) * math.cos(angle) - motion.row(COSINE) * math.sin(angle))
    assert tip_at(motion, u, clock) == pytest.approx(
        (PHI @ q - 0.002, math.sin(angle), math.cos(angle)), rel=1e-12
    )
    assert tip_rate(motion, v, math.sin(angle), math.cos(angle)) == pytest.approx(PHI @ rate, rel=1e-12)
