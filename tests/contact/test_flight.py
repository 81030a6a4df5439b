"""Closed-form flights against matrix exponentials of 50 digits, and the bounds that the search relies on."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from oscillators import modes_on_stop, newton, spring

from contact import ImpactOscillator, State, simulate
from contact.flight import modal_flow
from contact.flight.elementary import EPS, exponential, sine_cosine
from contact.flight.modal_flow import flow_matrix, mode_acceleration, propagate
from contact.flight.numbers import COSINE, LOAD, OFFSET, SINE, Numbers, damped_frequency, numbers_of
from contact.flight.tip import tip_rounding, tip_state

MODES = {  # omega [rad/s], c [1/s]
    "undamped": (150.0, 0.0),
    "under-damped": (150.0, 3.56),
    "heavily under-damped": (150.0, 270.0),
    "under-damped within 1e-4": (150.0, 300.0 * (1 - 1e-4)),
    "under-damped within 1e-8": (150.0, 300.0 * (1 - 1e-8)),
    "under-damped within 1e-12": (150.0, 300.0 * (1 - 1e-12)),
    "one rounding below critical": (150.0, math.nextafter(300.0, 0.0)),
    "critical": (150.0, 300.0),
    "one rounding above critical": (150.0, math.nextafter(300.0, 400.0)),
    "over-damped within 1e-12": (150.0, 300.0 * (1 + 1e-12)),
    "over-damped within 1e-8": (150.0, 300.0 * (1 + 1e-8)),
    "over-damped within 1e-4": (150.0, 300.0 * (1 + 1e-4)),
    "over-damped": (150.0, 650.0),
    "creeping": (1.5, 4000.0),
    "no frequency, damped": (0.0, 30.0),
    "no frequency": (0.0, 0.0),
}


def flow(omega: float, decay: float, time: float) -> np.ndarray:
    """The flow of the package, (2, 2)."""
    return np.array(flow_matrix(omega, decay, *damped_frequency(omega, decay), time)).reshape(2, 2)


def exact_flow(omega: float, decay: float, time: float) -> np.ndarray:
    """exp(A t) of A = (0, 1; -omega^2, -c) in 60 digits, rounded once."""
    with mp.workdps(60):
        matrix = mp.matrix([[0, 1], [-(mp.mpf(omega) ** 2), -mp.mpf(decay)]]) * mp.mpf(time)
        return np.array(mp.expm(matrix).tolist(), dtype=float)


def rate(omega: float, decay: float) -> float:
    """The rate that makes displacement and velocity comparable [1/s]."""
    return max(omega, 0.5 * decay) or 1.0


def difference(a: np.ndarray, b: np.ndarray, scale: float) -> float:
    """Largest difference of two flows relative to the larger, entries made dimensionless with `scale`."""
    weight = np.array([[1.0, scale], [1.0 / scale, 1.0]])
    return float(np.max(np.abs(a - b) * weight) / np.max(np.abs(b) * weight))


def oscillator(omega: list[float], decay: list[float], **others) -> ImpactOscillator:
    k = 1.0 + np.arange(len(omega))
    return modes_on_stop(omega, decay, **dict(phi=7.0 / k, participation=0.1 / k) | others)


@pytest.mark.parametrize("name", MODES)
def test_flow_is_the_matrix_exponential(name):
    omega, decay = MODES[name]
    for turns in (1e-9, 1e-3, 0.3, 1.0, 7.7, 40.0):
        time = turns / rate(omega, decay)
        wanted = exact_flow(omega, decay, time)
        assert difference(flow(omega, decay, time), wanted, rate(omega, decay)) < 4 * EPS * (2 + turns)


@pytest.mark.parametrize("decay", [0.0, 1e-4, 0.02])
def test_phase_keeps_its_digits_over_1e5_radians(decay):
    generator = np.random.default_rng(3)
    for phase in 10 ** generator.uniform(4, 5.1, 12):
        omega = float(generator.uniform(100, 1e4))
        time = float(phase / omega)
        # a phase formed as one double is off by up to 1e5 EPS/2 = 1e-11
        assert difference(flow(omega, decay, time), exact_flow(omega, decay, time), omega) < 4 * EPS


def test_slow_decay_of_a_creeping_mode_keeps_its_digits():
    """omega^2/c, not c/2 - sqrt(...): long after the fast part is gone the slow one still has 13 digits."""
    omega, decay = 1.0, 1e5
    for time in (1e-2, 1e2, 1e5):
        computed, exact = flow(omega, decay, time), exact_flow(omega, decay, time)
        np.testing.assert_allclose(computed[:, 0], exact[:, 0], rtol=1e-13)


def exact_state(
    system: ImpactOscillator, k: int, q: float, v: float, start: float, time: float
) -> np.ndarray:
    """(q, v, a) of mode k at drive time start + time by the exponential of a five-dimensional system."""
    with mp.workdps(40):
        model, drive = system.model, system.drive
        omega, c, gamma = (mp.mpf(float(x[k])) for x in (model.omega, model.decay_rate, model.participation))
        w = mp.mpf(drive.angular_frequency if drive else 0.0)
        z = mp.mpf(drive.amplitude if drive else 0.0)
        g = mp.mpf(float(system.load[k]) if system.load is not None else 0.0)
        unit = w if w > 0 else mp.mpf(1)
        # unknowns q w, v, sin, cos, 1: entries of similar size
        matrix = mp.matrix(5, 5)
        matrix[0, 1] = unit
        matrix[1, 0], matrix[1, 1], matrix[1, 2], matrix[1, 4] = -(omega**2) / unit, -c, gamma * z * w * w, g
        matrix[2, 3], matrix[3, 2] = w, -w
        first = mp.matrix([mp.mpf(q) * unit, v, mp.sin(w * mp.mpf(start)), mp.cos(w * mp.mpf(start)), 1])
        last = mp.expm(matrix * mp.mpf(time)) * first
        return np.array([float(last[0] / unit), float(last[1]), float((matrix * last)[1])])


DRIVEN, LOADED = {"drive": (21.5, 2e-3)}, {"load": [3.0, -20.0, 500.0, 2.0, -4.0]}
CASES = {"drive": DRIVEN, "drive and load": DRIVEN | LOADED, "load": LOADED, "neither": {}}


@pytest.mark.parametrize("name", CASES)
def test_flight_of_many_modes_is_the_exponential_of_the_whole_system(name):
    """Under-, critically and over-damped modes and two of zero frequency, one of them without damping."""
    system = oscillator([150.0, 400.0, 900.0, 0.0, 0.0], [3.56, 800.0, 2500.0, 0.0, 25.0], **CASES[name])
    motion, generator = system.numbers(), np.random.default_rng(5)
    for start, time in ((0.0, 1e-3), (0.01, 0.02), (0.04, 0.006), (0.0, 0.0465)):
        q, v = generator.normal(size=5) * 1e-3, generator.normal(size=5) * 0.1
        s, c = math.sin(motion.drive * start), math.cos(motion.drive * start)
        u = q - motion.row(OFFSET) - motion.row(SINE) * s - motion.row(COSINE) * c
        du = v - motion.drive * (motion.row(SINE) * c - motion.row(COSINE) * s)
        propagate(motion, u, du, time, u, du)
        s, c = math.sin(motion.drive * (start + time)), math.cos(motion.drive * (start + time))
        exact = np.array([exact_state(system, k, q[k], v[k], start, time) for k in range(5)])
        size = np.max(np.abs(exact), axis=0)
        displacement = u + motion.row(OFFSET) + motion.row(SINE) * s + motion.row(COSINE) * c
        velocity = du + motion.drive * (motion.row(SINE) * c - motion.row(COSINE) * s)
        acceleration = np.array([mode_acceleration(motion, k, u[k], du[k]) for k in range(5)])
        acceleration -= motion.drive**2 * (motion.row(SINE) * s + motion.row(COSINE) * c)
        for computed, column in zip((displacement, velocity, acceleration), range(3), strict=True):
            assert np.max(np.abs(computed - exact[:, column])) < 1e-12 * size[column]
        tip = np.array(tip_state(motion, start + time, u, du))
        expected = system.model.phi @ exact - np.array([system.stop.gap, 0.0, 0.0])
        rounding = 1e-12 * np.abs(system.model.phi) @ np.abs(exact) + [1e-14, 0, 0]
        assert np.all(np.abs(tip - expected) < rounding)


@pytest.mark.parametrize(
    "product", [1e-12, 1e-6, 9.99e-3, 0.01052, 0.0168, 0.1, 0.49, 0.51, 0.99, 1.01, 30.0]
)
def test_constant_load_on_a_free_body_with_drag(product):
    """x'' + c x' = g from rest: g (t - (1 - exp(-ct))/c)/c, with c t through the switch of the formula."""
    time = 0.25
    system = oscillator([0.0], [product / time], load=[9.81], phi=1.0)
    u, v = np.zeros(1), np.zeros(1)
    propagate(system.numbers(), u, v, time, u, v)
    with mp.workdps(60):
        c, t, g = mp.mpf(product / time), mp.mpf(time), mp.mpf(9.81)
        assert v[0] == pytest.approx(float(g * (1 - mp.exp(-c * t)) / c), rel=4 * EPS)
        assert u[0] == pytest.approx(float(g * (t - (1 - mp.exp(-c * t)) / c) / c), rel=4 * EPS)


@pytest.mark.filterwarnings("ignore:frequency of the drive:beam.SuspiciousValue")
@pytest.mark.parametrize("n_modes", [1, 3, 20])
def test_rounding_bound_holds_and_is_not_idle(n_modes):
    """The error of the tip displacement against 40 digits stays below its bound, and within 20 of it."""
    generator, worst = np.random.default_rng(n_modes), 0.0
    for amplitude, free in [(2e-3, 1e-3), (0.1, 0.0)] * 20:  # m, of the base and of what is free
        omega = 150.0 * 10 ** np.sort(generator.uniform(0, 2, n_modes))
        decay = omega * 10 ** generator.uniform(-4, 0.6, n_modes)
        phi, participation = generator.normal(size=(2, n_modes))
        motion = modes_on_stop(omega, decay, 7 * phi, participation, drive=(21.5, amplitude)).numbers()
        u, v = generator.normal(size=n_modes) * free, generator.normal(size=n_modes) * free * omega
        start, bound = float(generator.uniform(0, 0.02)), tip_rounding(motion, u, v)
        later_u, later_v = np.empty(n_modes), np.empty(n_modes)
        for time in (float(x) for x in generator.uniform(0, 0.02, 6)):
            with mp.workdps(40):
                w, instant = mp.mpf(motion.drive), mp.mpf(start) + mp.mpf(time)
                exact = mp.mpf(motion.level) + mp.mpf(motion.tip_sine) * mp.sin(w * instant)
                exact += mp.mpf(motion.tip_cosine) * mp.cos(w * instant)
                for k in range(n_modes):
                    c, o, t = mp.mpf(motion.decay[k]), mp.mpf(motion.omega[k]), mp.mpf(time)
                    root = mp.sqrt(mp.mpc(c * c / 4 - o * o))
                    plus, minus = -c / 2 + root, -c / 2 - root
                    a, b = mp.mpf(u[k]), mp.mpf(v[k])
                    first, second = b - minus * a, b - plus * a
                    free = (first * mp.exp(plus * t) - second * mp.exp(minus * t)) / (plus - minus)
                    exact += mp.mpf(motion.phi[k]) * mp.re(free)
                propagate(motion, u, v, time, later_u, later_v)
                height = tip_state(motion, start + time, later_u, later_v)[0]
                error = float(abs(mp.mpf(height) - exact))
            assert error <= bound
            worst = max(worst, error / bound)
    assert worst > 1 / 20


@pytest.mark.parametrize("amplitude", [0.0, 1e-9, 2e-4, 3.0])
def test_numbers_at_another_amplitude_are_those_made_for_it(amplitude):
    """And none are left of a part that was replaced."""
    first = spring(3, newton(0.1), drive=(21.5, 1e-3))
    for other in (first, replace(first, drive=replace(first.drive, frequency=23.0)), first.with_excess(0.1)):
        _ = other.numbers()
        found, drive, model = other.with_amplitude(amplitude).numbers(), other.drive, other.model
        numbers = dict(drive=drive.angular_frequency, period=drive.period, load=first.load)
        numbers |= dict(gap=first.stop.gap, response=amplitude * other.steady_response())
        made = numbers_of(model.omega, model.decay_rate, model.phi, law=first.stop.law, **numbers)
        for name, value in made._asdict().items():
            assert getattr(found, name) == pytest.approx(value, rel=1e-13, abs=0.0), name


def test_steady_motion_stays_steady():
    """Started on its steady motion the spring shows the same state at each of 2000 strobes, to rounding."""
    system = oscillator([150.0, 960.0], [3.56, 20.0], drive=(21.5, 1e-4))
    motion = system.numbers()
    start = State(displacement=motion.row(COSINE), velocity=motion.drive * motion.row(SINE))
    run = simulate(system, start, periods=2000)
    assert np.max(np.abs(run.strobe_displacement - motion.row(COSINE))) == 0.0
    assert np.max(np.abs(run.strobe_velocity - motion.drive * motion.row(SINE))) == 0.0


def test_a_free_flight_keeps_phase_and_energy_for_1e5_periods():
    """Its rounding is the same in every period, of about EPS each."""
    omega = 2.0 * math.pi * 24.5
    system = modes_on_stop(omega, gap=0.1)
    start = State(displacement=np.full(1, 0.01), velocity=np.zeros(1))
    run = simulate(system, start, periods=100_000)
    for n in (1, 100, 10_000, 100_000):
        with mp.workdps(30):
            angle = mp.mpf(omega) * n * mp.mpf(system.period)
            turn = complex(mp.cos(angle), mp.sin(angle))
        found = complex(run.strobe_displacement[n - 1, 0], -run.strobe_velocity[n - 1, 0] / omega) / 0.01
        change = np.log(found / turn)
        assert abs(change.imag) < 10 * EPS * (n + 1) and abs(change.real) < 5 * EPS * (n + 1)


def ladder(n: int, damping: float, load: float = 0.0) -> Numbers:
    omega = 154.0 * (2.0 * np.arange(1.0, n + 1.0) - 1.0) ** 2
    omega[0] = 0.0 if load else omega[0]
    return modes_on_stop(omega, damping * omega, drive=21.5, load=load * (omega == 0)).numbers()


@pytest.mark.parametrize("modes", [1, 7, 8, 20])
@pytest.mark.parametrize(
    "damping, load, longest", [(0.01, 0.0, 0.1), (0.0, 0.0, 2e3), (2.5, 0.0, 0.1), (0.01, 3.0, 0.1)]
)
def test_modes_carried_side_by_side_are_those_carried_one_by_one(modes, damping, load, longest):
    """Also where they are not carried side by side: over-damped or loaded modes, phases beyond 5e5."""
    motion, generator = ladder(modes, damping, load), np.random.default_rng(modes)
    carried = modal_flow.new_flight(motion)
    size = np.maximum(motion.omega, 1.0)
    u, v = generator.standard_normal(modes) / size, generator.standard_normal(modes)
    modal_flow.load_state(carried, u, v)
    for t in longest * 10 ** generator.uniform(-6, 0, 40):
        modal_flow.flow(motion, carried, 0, carried.shape[1], t)
        for k in range(modes):
            x, y = modal_flow.mode_flow(motion.modes, k, u[k], v[k], t)
            scale = abs(v[k]) + size[k] * abs(u[k]) + abs(motion.row(LOAD)[k]) * t
            assert abs(carried[modal_flow.U, k] - x) * size[k] <= 1e-15 * scale
            assert abs(carried[modal_flow.V, k] - y) <= 1e-15 * scale


def test_sine_cosine_and_exponential_are_good_to_one_unit_in_the_last_place():
    generator, worst = np.random.default_rng(2), np.zeros(3)
    with mp.workdps(50):
        for _ in range(4000):
            phase = float(generator.choice([-1, 1]) * 10 ** generator.uniform(-6, 6.5))
            rest = float(generator.uniform(-1, 1) * 1e-16 * abs(phase))
            exact = mp.mpf(phase) + mp.mpf(rest)
            size = 1.5 if abs(phase) < 5e5 else 1e4  # beyond, the library's result is turned by `rest`
            x = -float(10 ** generator.uniform(-6, 2.85))
            found = (*sine_cosine(phase, rest), exponential(x))
            for place, true in enumerate((mp.sin(exact), mp.cos(exact), mp.exp(x))):
                error = abs(float((mp.mpf(found[place]) - true) / math.ulp(abs(float(true)))))
                worst[place] = max(worst[place], error / (size if place < 2 else 1.5))
    assert np.all(worst < 1.0) and sine_cosine(0.0, 0.0) == (0.0, 1.0)
    assert exponential(0.0) == 1.0 and exponential(-800.0) == 0.0
