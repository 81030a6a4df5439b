"""Closed-form maximal orbits against integrations and 50-digit arithmetic that share no code with them."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from oscillators import MODES
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq
from simulated_orbit import EQUATION_1

from beam import ModalModel, single_mode
from contact import HarmonicDrive, ImpactOscillator, LinearContact, NewtonRestitution, Stop
from contact.maximal_orbits import fold as map_fold
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily, SingleImpactOrbit

T, MU, TAU = 0.0408, 3.56, 0.1


def equation_1(frequency: float, period: int, **changes: float) -> MaximalFamily:
    numbers = dict(free_period=T, decay_rate=MU, restitution=TAU) | changes
    law = NewtonRestitution(local_restitution=numbers.pop("restitution"))
    oscillator = ImpactOscillator(
        model=single_mode(**numbers), stop=Stop(gap=1.0, law=law), drive=HarmonicDrive(frequency=frequency)
    )
    return MaximalFamily(oscillator=oscillator, period=period)


def many_modes(name: str, *, period: int = 3, restitution: float = 0.35) -> MaximalFamily:
    return family_of(MODES[name], 20.5, period, restitution)


def family_of(modes: dict, frequency: float, period: int, restitution: float, gap: float = 0.012):
    oscillator = ImpactOscillator(
        model=ModalModel(**{key: np.array(value) for key, value in modes.items()}),
        drive=HarmonicDrive(frequency=frequency),
        stop=Stop(gap=gap, law=NewtonRestitution(local_restitution=restitution)),
    )
    return MaximalFamily(oscillator=oscillator, period=period)


def flown(orbit: SingleImpactOrbit, times: np.ndarray | float) -> np.ndarray:
    """Modal (q, q') at drive times from the touch to the next, by exponentials, shape (2, n_modes, ...)."""
    model, w, times = orbit.oscillator.model, orbit.oscillator.drive.angular_frequency, np.asarray(times)
    rows = []
    for k, (omega, c) in enumerate(zip(model.omega, model.decay_rate, strict=True)):
        since = times.ravel() - orbit.phase
        free = np.array([expm(np.array([[0.0, 1.0], [-(omega**2), -c]]) * s) @ orbit.after[k] for s in since])
        phase = orbit.amplitude * orbit.oscillator.steady_response()[k] * np.exp(1j * w * times.ravel())
        rows.append([phase.imag + free[:, 0], w * phase.real + free[:, 1]])
    return np.array(rows).transpose(1, 0, 2).reshape((2, len(rows), *times.shape))


def tip(orbit: SingleImpactOrbit, times: np.ndarray) -> tuple:
    return tuple(np.tensordot(orbit.oscillator.model.phi, part, 1) for part in flown(orbit, times))


def residual(orbit: SingleImpactOrbit) -> float:
    """Largest relative mismatch of the closed orbit: gap, speed, Newton's law, return of modes."""
    model, stop = orbit.oscillator.model, orbit.oscillator.stop
    after, arrival = flown(orbit, orbit.phase), flown(orbit, orbit.phase + orbit.duration)
    x, v = model.phi @ arrival[0], model.phi @ arrival[1]
    jump = arrival[1] - (1 + stop.law.local_restitution) * model.phi / (model.phi @ model.phi) * v
    mismatch = [abs(x / stop.gap - 1), abs(v / orbit.speed - 1)]
    for found, wanted in ((arrival[0], after[0]), (jump, after[1])):
        mismatch.append(np.max(np.abs(found - wanted)) / np.max(np.abs(wanted)))
    return float(max(mismatch))


def integrate(family: MaximalFamily, amplitude: float, state: np.ndarray, start: float, end: float) -> tuple:
    """Modal equations by DOP853 with Newton's law as an event: final state and impacts (time, speed)."""
    model, stop = family.oscillator.model, family.oscillator.stop
    omega, rate, phi, participation = model.omega, model.decay_rate, model.phi, model.participation
    w, n = family.oscillator.drive.angular_frequency, len(omega)

    def motion(t, y):
        return np.concatenate(
            [y[n:], participation * amplitude * w**2 * math.sin(w * t) - rate * y[n:] - omega**2 * y[:n]]
        )

    def wall(t, y):
        return phi @ y[:n] - stop.gap

    wall.terminal, wall.direction = True, 1
    impacts = []
    while True:
        run = solve_ivp(
            motion, (start, end), state, "DOP853", events=wall, rtol=1e-12, atol=1e-14, max_step=0.003
        )
        state = run.y[:, -1].copy()
        if run.status != 1:
            return state, impacts
        start, speed = run.t[-1], phi @ state[n:]
        impacts.append((start, speed))
        state[n:] -= (1 + stop.law.local_restitution) * speed * phi / (phi @ phi)
        state[:n] -= phi / (phi @ phi) * max(0.0, phi @ state[:n] - stop.gap) * (1 + 1e-12)


@pytest.mark.parametrize(("frequency", "period"), [place[:2] for place in EQUATION_1])
def test_folds_of_equation_1_in_fifty_digits(frequency: float, period: int) -> None:
    """F as a function of the impact time alone: periodicity and x = gap fix the rest; its minimum is F_m."""
    at_fold = equation_1(frequency, period).fold()
    assert residual(at_fold) < 1e-11
    with mp.workdps(50):
        half, f, tau = mp.mpf(MU) / 2, mp.mpf(frequency), mp.mpf(TAU)
        pole = mp.mpc(-half, 2 * mp.pi / mp.mpf(T))
        w = 2 * mp.pi * f
        steady = 1 / (abs(pole) ** 2 - w**2 + 2j * half * w)
        span = mp.e ** (pole * period / f)

        # x = F Im(steady e^{iwt}) + Re(c e^{pole s}) with s since the impact; unknown F, Re c, Im c, v
        def amplitude(time):
            e = steady * mp.e ** (1j * w * time)
            rows, right = [], [1, 1, 0, 0]  # gap = 1 at both ends, velocity -tau v and v there
            rows.append([e.imag, 1, 0, 0])
            rows.append([e.imag, span.real, -span.imag, 0])
            rate = [(w * e.real), pole.real, -pole.imag]
            arrive = pole * span
            rows.append([rate[0], rate[1], rate[2], tau])
            rows.append([w * e.real, arrive.real, -arrive.imag, -1])
            return mp.lu_solve(mp.matrix(rows), mp.matrix(right))[0]

        start = mp.mpf(at_fold.phase)
        best = mp.findroot(lambda time: mp.diff(amplitude, time), start + mp.mpf("1e-6"))
        excess = abs(amplitude(best)) * abs(steady) - 1
    assert abs(at_fold.excess - float(excess)) < 1e-14
    assert at_fold.phase == pytest.approx(float(best), abs=1e-11)


def test_ratio_to_the_map_at_a_band_edge() -> None:
    """(1 - tau g)^2/((1 + tau^2 g)(1 + g)), not one: the map drops terms of the order of b^2."""
    for period, tau, expected in ((3, 0.1, 0.476), (5, 0.1, None), (4, 0.8, None)):
        upper = 2 * period / ((2 * period + 1) * T)
        g = math.exp(-MU * period / (2 * upper))
        limit = (1 - tau * g) ** 2 / ((1 + tau**2 * g) * (1 + g))
        assert expected is None or limit == pytest.approx(expected, abs=5e-4)
        errors = []
        for below in (1e-3, 1e-4):
            frequency = upper * (1 - below)
            chart = NordmarkMap.from_frequencies(
                drive_frequency=frequency, free_period=T, decay_rate=MU, restitution=tau
            )
            exact = equation_1(frequency, period, restitution=tau).fold().excess
            errors.append(abs(chart.excess(map_fold(chart, period).rho) / exact - limit))
        assert errors[1] < 0.15 * errors[0] and errors[1] < 2e-3


def test_determinant_is_that_of_a_period_with_an_impact() -> None:
    frequency = 20.90
    for period in (1, 3, 5):
        orbit = equation_1(frequency, period).orbit(0.3)
        assert np.linalg.det(orbit.monodromy()) == pytest.approx(math.exp(-MU * period / frequency) * TAU**2)
    single = np.linalg.det(equation_1(frequency, 1).orbit(0.3).monodromy())
    assert single == pytest.approx(0.0084338, abs=5e-8)  # what y' = -gamma x would make 0.84338


@pytest.mark.parametrize("name", MODES)
def test_orbits_close_under_integration(name: str) -> None:
    """Start just after the impact, integrate over m/f: one impact, at the end, at the predicted speed."""
    family = many_modes(name)
    at_fold = family.fold()
    assert at_fold is not None
    for speed in (1.3 * at_fold.speed, 0.7 * at_fold.speed):
        orbit = family.orbit(speed)
        assert residual(orbit) < 1e-9
        grazing = family.oscillator.grazing_amplitude()
        assert orbit.amplitude == pytest.approx((1 + orbit.excess) * grazing, rel=1e-15)
        start = flown(orbit, orbit.phase).ravel()
        end = orbit.phase + orbit.duration
        before, none = integrate(family, orbit.amplitude, start, orbit.phase, end - 1e-9)
        assert none == [] and np.allclose(flown(orbit, end - 1e-9).ravel(), before, rtol=1e-6, atol=1e-9)
        _, impacts = integrate(family, orbit.amplitude, start, orbit.phase, end + 1e-4)
        assert len(impacts) == 1
        assert impacts[0][0] == pytest.approx(end, abs=1e-10)
        assert impacts[0][1] == pytest.approx(speed, rel=1e-8)


@pytest.mark.parametrize("name", [*MODES, "equation 1"])
@pytest.mark.parametrize("factor", [1.5, 0.6])
def test_multipliers_are_those_of_integrated_neighbours(name: str, factor: float) -> None:
    """Central differences of the motion over m/f from mid-flight to mid-flight, across one impact."""
    family = equation_1(20.9, 3) if name == "equation 1" else many_modes(name)
    orbit = family.orbit(factor * family.fold().speed)
    omega = family.oscillator.model.omega
    n = len(omega)
    middle = orbit.phase + 0.5 * orbit.duration
    centre = flown(orbit, middle).ravel()
    sizes = np.concatenate([np.full(n, 1.0), np.maximum(omega, 1.0)]) * 1e-6 * np.abs(centre[0])
    columns = []
    for k, size in enumerate(sizes):
        ends = []
        for sign in (1, -1):
            shifted = centre.copy()
            shifted[k] += sign * size
            ends.append(integrate(family, orbit.amplitude, shifted, middle, middle + orbit.duration)[0])
        columns.append((ends[0] - ends[1]) / (2 * size))
    found = np.linalg.eigvals(np.column_stack(columns))
    expected = orbit.multipliers
    for value in expected[np.abs(expected) > 1e-4]:
        assert np.min(np.abs(found - value)) < 2e-4 * max(1.0, abs(value))
    assert np.max(np.abs(found)) == pytest.approx(abs(expected[0]), rel=2e-4)
    assert orbit.stable == (np.max(np.abs(found)) < 1)
    assert orbit.stable == (factor > 1)


def test_many_modes_with_one_tip_value_are_equation_1() -> None:
    """A second mode that the tip does not see changes nothing, even if it is rigid and undamped."""
    plain = equation_1(21.5, 4)
    modes = dict(
        omega=[*plain.oscillator.model.omega, 0.0], decay_rate=[MU, 0.0], phi=[2.0, 0.0],
        participation=[0.5, 1.0],
    )  # fmt: skip
    family = family_of(modes, 21.5, 4, TAU, gap=0.01)
    assert family.fold().excess == pytest.approx(plain.fold().excess, rel=1e-12)
    assert family.fold().speed / 0.01 == pytest.approx(plain.fold().speed, rel=1e-12)


def test_another_law_needs_its_restitution_told() -> None:
    plain = many_modes("three modes")
    soft = replace(plain.oscillator, stop=Stop(gap=0.012, law=LinearContact(stiffness=1e6)))
    told = MaximalFamily.from_oscillator(soft, period=3, restitution=0.35)
    assert told.fold().excess == plain.fold().excess
    with pytest.raises(TypeError, match="restitution"):
        MaximalFamily.from_oscillator(soft, period=3)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"omega": [0.0, 960.0, 2690.0]}, r"omega\[0\]"),
        ({"omega": [154.0, 6 * math.pi * 21.0, 2690.0], "decay_rate": [3.56, 0.0, 80.0]}, r"omega\[1\]"),
        ({"omega": [2 * math.pi * 21.0, 960.0, 2690.0], "decay_rate": [0.0, 0.0, 0.0]}, "frequency"),
    ],
)
def test_a_mode_without_a_return_is_named(changes: dict[str, object], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        family_of(MODES["three modes"] | changes, frequency=21.0, period=3, restitution=0.35)


def test_of_fig_5_a_second_impact_ends_the_orbits_below_grazing() -> None:
    """19.65 Hz: p3 exists below grazing only, between its fold and the excess of a second impact."""
    for tau, lowest, end in ((0.1, -0.132, -0.13097), (0.05, -0.116, -0.11282)):
        family = equation_1(19.65, 3, free_period=0.0412, restitution=tau)
        assert family.fold().excess == pytest.approx(lowest, abs=1e-3)
        below, above = (family.orbits(end + side * 2e-5)[-1] for side in (-1, 1))
        assert below.stable and below.admissible and not above.admissible
        assert highest_between(below) < 1 < highest_between(above)


def highest_between(orbit: SingleImpactOrbit) -> float:
    """Largest tip displacement over gap at interior peaks of the flight, by dense sampling and parabolas."""
    times = np.linspace(orbit.phase, orbit.phase + orbit.duration, 300 * orbit.period)
    x = tip(orbit, times)[0] / orbit.oscillator.stop.gap
    inner = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    before, at, after = x[inner - 1], x[inner], x[inner + 1]
    return float(np.max(at - (after - before) ** 2 / (8 * (before - 2 * at + after))))


@pytest.mark.parametrize(("frequency", "period", "_fold", "excess", "digit"), EQUATION_1)
def test_the_orbits_of_equation_1_gain_a_second_impact(
    frequency: float, period: int, _fold: float, excess: float, digit: float
) -> None:
    """The certified search against dense sampling, and the excess at which both change their answer."""
    family = equation_1(frequency, period)
    speed = family.fold().speed
    for factor in (1e-3, 0.1, 1.0):
        assert family.orbit(factor * speed).admissible and highest_between(family.orbit(factor * speed)) < 1
    peaks = brentq(
        lambda v: highest_between(family.orbit(v)) - 1,
        speed,
        100 * speed if frequency == 22.60 else 12 * speed,
        xtol=1e-7 * speed,
    )
    assert abs(family.excess(peaks) - excess) <= 0.6 * digit
    good, bad = 0.9 * peaks, 1.1 * peaks
    assert family.orbit(good).admissible and not family.orbit(bad).admissible
    while bad / good > 1 + 1e-9:
        middle = math.sqrt(good * bad)
        good, bad = (middle, bad) if family.orbit(middle).admissible else (good, middle)
    assert good == pytest.approx(peaks, rel=1e-5)


@pytest.mark.parametrize("name", ["three modes", "an overdamped mode"])
@pytest.mark.parametrize("restitution", [0.0, 0.35])
def test_certified_flights_of_many_modes_agree_with_dense_sampling(name: str, restitution: float) -> None:
    answers = []
    for period in (1, 3):
        family = many_modes(name, period=period, restitution=restitution)
        for speed in np.geomspace(1e-3, 3.0, 7) * family.oscillator.unit_speed:
            orbit = family.orbit(speed)
            times = orbit.phase + orbit.duration * np.linspace(1e-3, 1 - 1e-3, 2001)
            top = float(np.max(tip(orbit, times)[0])) / family.oscillator.stop.gap - 1
            if abs(top) < 1e-4:
                continue  # sampling cannot tell
            assert orbit.admissible == (top < 0), (period, speed)
            answers.append(orbit.admissible)
    assert any(answers) and not all(answers)


def test_slow_orbits_are_certified_down_to_grazing() -> None:
    family = equation_1(20.90, 3)
    for part in (1e-2, 1e-4, 1e-6):
        assert family.orbit(part * family.oscillator.unit_speed).admissible
