"""Derivatives of orbits, their folds, doublings and grazings, and of simulated motions: against closed forms
in 50 digits, invariances, and differences."""

import math
from collections.abc import Callable, Sequence

import mpmath as mp
import numpy as np
import pytest
from letters_spring import FOLDED_GAP, folded_strip
from oscillators import ARRAYS, MODES, equation_1, many_modes, newton
from random_families import random_change
from simulated_orbit import DELAYED, EQUATION_1, LAWS, beam, on_stop

import contact
from beam import ModalChange
from contact import orbits
from contact.flight.numbers import numbers_of
from contact.flight.variation import flow_derivative
from contact.orbits import Change, Shooting, fold_of

T, MU, TAU, GAP = 40.80e-3, 3.56, 0.1, 0.0107
H = mp.mpf("1e-18")
"""Step of differences in 50 digits: their error is its square."""


def of_modes(size: int, **rates: object) -> ModalChange:
    return ModalChange(**{name: np.broadcast_to(rates.get(name, 0.0), size) for name in ARRAYS})


def of_equation_1(frequency: float) -> list[Change]:
    """Changes with free period, decay rate, restitution, gap, drive frequency and amplitude."""
    omega = math.hypot(2 * math.pi / T, MU / 2)
    period = of_modes(1, omega=-((2 * math.pi / T) ** 2) / (T * omega))
    decay = of_modes(1, omega=MU / (4 * omega), decay_rate=1.0)
    others = {"law": (1.0, 0.0), "gap": 1.0, "frequency": 1.0, "amplitude": 1.0}
    return [Change(model=period), Change(model=decay), *(Change(**{name: x}) for name, x in others.items())]


def exact_flow(square: mp.mpf, c: mp.mpf, t: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf, mp.mpf]:
    """The matrix that takes (q, q') of a mode through t, row by row; at critical damping too."""
    root = mp.sqrt(c * c / 4 - square + mp.mpf("1e-50"))
    low, high = mp.exp((root - c / 2) * t), mp.exp((-root - c / 2) * t)
    sn, cn = mp.re((low - high) / (2 * root)), mp.re((low + high) / 2)
    return cn + c / 2 * sn, sn, -square * sn, cn - c / 2 * sn


def exact_slopes(of: Callable[[list], list[mp.mpf]], point: Sequence[float]) -> np.ndarray:
    """Derivatives in 50 digits, a column for each number of the point."""
    columns = []
    for j in range(len(point)):
        ends = [of([mp.mpf(x) + (i == j) * step for i, x in enumerate(point)]) for step in (H, -H)]
        columns.append([float((a - b) / (2 * H)) for a, b in zip(*ends, strict=True)])
    return np.array(columns).T


@pytest.mark.parametrize("name", [*MODES, "nearly critical"])
def test_flow_of_a_mode_against_differentiation_in_50_digits(name: str) -> None:
    modes = MODES.get(name, {"omega": [600.0], "decay_rate": [1200.0 - 1e-7]})
    law, rates = newton(0.0), modes["decay_rate"]
    table = numbers_of(modes["omega"], rates, np.ones(len(rates)), law=law, gap=1.0).modes
    for k, (omega, decay) in enumerate(zip(modes["omega"], rates, strict=True)):
        unit = max(1.0, omega) ** np.array([1, 0, 1, 1])
        for t in (1e-5, 3e-3, 0.2):
            with mp.workdps(90):
                point = [mp.mpf(omega) ** 2, mp.mpf(decay)]
                exact = exact_slopes(lambda x, t=t: exact_flow(*x, t), point)
                largest = max(abs(float(x)) for x in exact_flow(*point, t))
            for direction, power, column in zip(np.eye(2), (2, 1), exact.T, strict=True):
                found = np.array(flow_derivative(table, k, *direction, t))
                assert np.all(np.abs(found - column) < 2e-13 * (np.abs(column) + largest * t**power * unit))


def exact_orbit(m: int) -> Callable[[Sequence[float]], list[mp.mpf]]:
    """Closed form of the p_m node of Eq. (1): excess, time and speed of the impact, trace and determinant of
    its monodromy matrix, and tip displacement and velocity at the m strobes after it."""

    def orbit(numbers: Sequence[float]) -> list[mp.mpf]:
        t, mu, tau, gap, f, amplitude = (mp.mpf(x) for x in numbers)
        w, square = 2 * mp.pi * f, (2 * mp.pi / t) ** 2 + mu * mu / 4

        def flow(s: mp.mpf) -> mp.matrix:
            a, b, c, d = exact_flow(square, mu, s)
            return mp.matrix([[a, b], [c, d]])

        response = w**2 / (square - w * w + 1j * mu * w)
        n, shrink = flow(m / f), mp.exp(-mu * m / f)
        per = (n - shrink * mp.eye(2)) * mp.matrix([0, -(1 + tau)]) / (1 - n[0, 0] - n[1, 1] + shrink)
        a, b = per[0], (1 - per[1]) / w
        size = amplitude * abs(response)
        # (gap - a v)^2 + (b v)^2 = size^2, the larger root
        half, both = a * gap, a * a + b * b
        v = (half + mp.sqrt(half * half - both * (gap * gap - size * size))) / both
        psi = mp.atan2(gap - a * v, b * v)
        time = (psi - mp.arg(response)) / w
        time -= mp.floor(time * f) / f
        after, points = mp.matrix([a * v, per[1] * v - (1 + tau) * v]), []
        for j in range(1, m + 1):
            deviation, turn = flow(j / f - time) * after, amplitude * response
            points += [deviation[0] + mp.im(turn), deviation[1] + w * mp.re(turn)]
        # saltation of Newton's law on (u, u'), then the flow: accelerations of the deviation before and
        # after, and of the steady motion
        before, behind = (-square * x[0] - mu * x[1] for x in (per * v, after))
        steady = -w * w * (gap - a * v)
        jump = mp.matrix([[-tau, 0], [(tau * (before + steady) + behind + steady) / v, -tau]])
        monodromy = n * jump
        return [size / gap - 1, time, v, monodromy[0, 0] + monodromy[1, 1], mp.det(monodromy), *points]

    return orbit


@pytest.mark.parametrize(("frequency", "m", "excess"), [(22.2, 5, 4e-3), (20.9, 3, -5e-4), (23.4, 11, 1e-3)])
def test_orbit_of_equation_1_against_its_closed_form_in_50_digits(frequency, m, excess):
    oscillator = equation_1(frequency, newton(TAU), gap=GAP)
    node = contact.MaximalFamily(oscillator=oscillator, m=m).orbits(excess)[-1]
    family = Shooting(oscillator=oscillator, m=m)
    orbit = family.at_excess(excess, family.at_speed(node.speed))
    changes = of_equation_1(frequency)
    found = orbits.orbit_derivatives(orbit, changes)
    ours = [found.excess, found.time, found.speed, *found.strobes_changed.reshape(-1, 6)]
    point = (T, MU, TAU, GAP, frequency, orbit.amplitude)
    with mp.workdps(50):
        here = np.array([float(x) for x in exact_orbit(m)(point)])
        there = exact_slopes(exact_orbit(m), point)
    pair = orbit.multipliers.sum().real, orbit.multipliers.prod().real
    values = [orbit.excess, orbit.phase, orbit.speed, *pair, *found.strobes.reshape(-1)]
    assert values == pytest.approx(here, rel=1e-9, abs=1e-14)
    exact, sizes = (np.delete(rows, (3, 4), axis=0) for rows in (there, np.abs(values)))
    allowed = np.abs(exact) + np.multiply.outer(sizes, 1 / np.array(point))
    assert np.max(np.abs(ours - exact) / allowed) < 1e-10


CASES = {f"{row[0]:.2f} Hz": (equation_1(row[0], gap=GAP), row[1]) for row in EQUATION_1}
CASES |= {name: (many_modes(name, restitution=0.3), 4) for name in ("three modes", "an overdamped mode")}


@pytest.mark.parametrize("name", CASES)
def test_folds_under_newtons_law_move_as_their_closed_form_does(name: str) -> None:
    """F_m/F_g = 1/sqrt(1 + (s/b)^2) of ``contact.orbits.families.single_impact``, with every number of every
    mode, restitution and drive frequency; gap, participation and amplitude say nothing."""
    oscillator, m = CASES[name]
    model, tau, f = oscillator.model, oscillator.stop.law.numbers[0], oscillator.driven.frequency
    n = model.n_modes

    def excess(numbers: Sequence[float]) -> list[mp.mpf]:
        """From omega_k, c_k, phi_k, restitution and frequency."""
        *rows, tau, f = (mp.mpf(x) for x in numbers)
        omega, decay, phi = rows[:n], rows[n : 2 * n], rows[2 * n :]
        t, p, r, mobility = m / f, mp.mpf(0), mp.mpf(0), sum(x * x for x in phi)
        for k in range(n):
            first, sn, _, last = exact_flow(omega[k] ** 2, decay[k], t)
            shrink, kick = mp.exp(-decay[k] * t), -(1 + tau) * phi[k] / mobility
            closing = 1 - first - last + shrink
            p += phi[k] * sn * kick / closing
            r += phi[k] * (last - shrink) * kick / closing
        ratio = p * 2 * mp.pi * f / (1 - r)
        return [1 / mp.sqrt(1 + ratio * ratio) - 1]

    def unit(array: str, k: int) -> Change:
        return Change(model=of_modes(n, **{array: np.eye(n)[k]}))

    changes = [unit(array, k) for array in ARRAYS for k in range(n)]
    changes += [Change(law=(1.0, 0.0)), Change(frequency=1.0), Change(gap=1.0), Change(amplitude=1.0)]
    fold = fold_of(Shooting(oscillator=oscillator, m=m))
    found = orbits.excess_derivatives(fold, changes)
    with mp.workdps(50):
        point = np.array([*model.omega, *model.decay_rate, *model.phi, tau, f])
        assert fold.excess == pytest.approx(float(excess(point)[0]), rel=1e-9)
        ours, exact = np.delete(found, [*range(3 * n, 4 * n), -2, -1]), exact_slopes(excess, point)[0]
    # the place of the fold is good to 1e-12 of the speed, its excess to the square of it
    assert np.all(np.abs(ours - exact) < np.maximum(2e-9 * np.abs(exact), 1e-12 / (point + 1.0)))
    still = [*(found[3 * n : 4 * n] * model.participation), found[-2] * oscillator.stop.gap]
    assert np.max(np.abs([*still, found[-1] * fold.amplitude])) < 1e-12


def in_other_units(oscillator: contact.ImpactOscillator) -> list[Change]:
    """Changes that amount to other units of time, length and modal coordinates."""
    model, law, gap = oscillator.model, oscillator.stop.law, oscillator.stop.gap
    amplitude, n = oscillator.driven.amplitude, model.n_modes
    first, second = law.numbers
    time, length, modal = {  # powers of the law's numbers in the three units
        "HertzContact": ((2, 0), (-0.5, 0), (-2, 0)),
        "HuntCrossley": ((2, -1), (-0.5, -1), (-2, 0)),
        "LinearContact": ((2, 1), (0, 0), (-2, -2)),
    }.get(type(law).__name__, ((0, 0), (0, 0), (0, 0)))
    if isinstance(law, contact.DelayedRestitution):
        second, time = law.delay, (0, -1)
    laws = [(first * a, second * b) for a, b in (time, length, modal)]
    faster = of_modes(n, omega=model.omega, decay_rate=model.decay_rate)
    heavier = of_modes(n, phi=model.phi, participation=-model.participation)
    others = dict(frequency=oscillator.driven.frequency), dict(gap=gap, amplitude=amplitude), {}
    models = dict(model=faster), {}, dict(model=heavier)
    return [Change(law=law, **one, **model) for law, one, model in zip(laws, others, models, strict=True)]


def every_number(oscillator: contact.ImpactOscillator) -> list[Change]:
    """Each number of the oscillator changed by itself, by as much as it is."""
    model, law, n = oscillator.model, oscillator.stop.law.numbers, oscillator.n_modes
    modal = [of_modes(n, **{name: np.diag(getattr(model, name))[k]}) for name in ARRAYS for k in range(n)]
    drive = Change(frequency=oscillator.driven.frequency), Change(amplitude=oscillator.driven.amplitude)
    others = Change(gap=oscillator.stop.gap), Change(law=(law[0], 0.0)), Change(law=(0.0, law[1]))
    return [*(Change(model=model) for model in modal), *drive, *others]


@pytest.mark.parametrize("name", [*LAWS, "constant"])
def test_other_units_change_nothing_but_units(name: str) -> None:
    """Excess and multipliers stay, at given speed in the new units and at given amplitude.

    These are sums of derivatives by every number that cancel; rounding is measured by the sizes of its parts.
    """
    oscillator = equation_1(22.2, DELAYED[name], gap=GAP) if name in DELAYED else beam(22.20, LAWS[name], 10)
    orbit = Shooting(oscillator=oscillator, m=5).at_speed(0.1 * oscillator.unit_speed)
    found = orbits.orbit_derivatives(orbit, in_other_units(orbit.oscillator))
    parts = orbits.orbit_derivatives(orbit, every_number(orbit.oscillator))
    n = oscillator.n_modes
    powers = np.stack([np.repeat([0.0, 1.0], n), np.ones(2 * n), -np.ones(2 * n)], axis=1)
    expected = {
        "excess": np.zeros(3),
        "time": -orbit.phase * np.array([1, 0, 0]),
        "speed": orbit.speed * np.array([1, 1, 0]),
        "strobes_changed": found.strobes[:, :, None] * powers,
    }
    bounds = {"excess": 1e-14, "time": 2e-13, "speed": 2e-13, "strobes_changed": 2e-11}
    for what, exact in expected.items():
        size = np.abs(getattr(parts, what)).sum(axis=-1, keepdims=True)
        assert np.max(np.abs(getattr(found, what) - exact) / size) < bounds[what], what


def slopes(observed: Callable[[float], list[np.ndarray]], step: float) -> list[np.ndarray]:
    """Differences of order four of everything observed."""
    ends = zip(*(observed(j * step) for j in (1, -1, 2, -2)), strict=True)
    return [(8 * (a - b) - (c - d)) / (12 * step) for a, b, c, d in ends]


@pytest.mark.parametrize("name", [*LAWS, "elastic"])
def test_a_simulated_motion_against_differences(name: str) -> None:
    """Impact times, strobes and states, some of them within a touch, along a direction in all numbers and the
    start; the differences are of order four."""
    alone = name in DELAYED
    strip = None if alone else on_stop(folded_strip(6), 22.20, LAWS[name], gap=FOLDED_GAP)
    at_rest = strip or equation_1(22.2, DELAYED[name], gap=GAP)
    oscillator, rng, n = at_rest.with_excess(0.02), np.random.default_rng(7), at_rest.n_modes
    change, kicked = random_change(oscillator, rng), 1e-5 * rng.normal(size=(2, n))
    start = contact.State(displacement=np.full(n, 1e-5), velocity=np.zeros(n))
    first = contact.simulate(oscillator, start, periods=5).impacts
    within = np.where(first.end > first.start, 0.4 * (first.end - first.start), 1e-4)
    times = np.sort([0.013, 0.1, *(first.start + within)[:2], 0.21])

    def observed(step: float) -> list[np.ndarray]:
        q, v = np.stack([start.displacement, start.velocity]) + step * kicked
        moved = contact.State(displacement=q, velocity=v)
        run = contact.simulate(change.applied(oscillator, step), moved, periods=5, times=times)
        pairs = (run.strobe_displacement, run.strobe_velocity), (run.displacement, run.velocity)
        return [run.impacts.start, *(np.hstack(pair) for pair in pairs)]

    found = orbits.motion_derivatives(oscillator, start, [change], periods=5, times=times)
    direction = np.concatenate([kicked.reshape(-1), [1.0]])
    assert len(found.trajectory.impacts) >= 2
    ours = (found.impact_time, found.strobes, found.states)
    for exact, difference in zip((one @ direction for one in ours), slopes(observed, 1e-7), strict=True):
        assert np.max(np.abs(difference - exact) / np.abs(exact).max(axis=0)) < 2e-5


def test_orbits_and_folds_of_the_letters_spring_under_hertz_against_differences() -> None:
    oscillator = beam(22.20, LAWS["hertz"], modes=10)
    family, rng = Shooting(oscillator=oscillator, m=5), np.random.default_rng(3)
    fold = fold_of(family)
    orbit = family.at_speed(1.5 * fold.speed, fold)
    change = random_change(orbit.oscillator, rng)
    found = orbits.orbit_derivatives(orbit, [change])
    ours = [found.time, found.speed, orbits.excess_derivatives(fold, [change])]

    def observed(step: float) -> list:
        moved = change.applied(orbit.oscillator, step)
        near, beside = Shooting(oscillator=moved, m=5), moved.excess
        there = near.at_excess(beside, orbit)
        return [there.phase, there.speed, fold_of(near, fold).excess]

    differences = slopes(observed, 1e-7)
    for exact, difference, allowed in zip(ours, differences, (1e-6, 1e-6, 1e-4), strict=True):
        assert difference == pytest.approx(exact, rel=allowed)


def test_where_there_is_no_derivative_a_sentence_says_so() -> None:
    oscillator = equation_1(22.2, gap=GAP)
    family = Shooting(oscillator=oscillator, m=5)
    exact = contact.MaximalFamily(oscillator=oscillator, m=5).fold()
    with pytest.raises(contact.NoDerivative, match="fold"):
        orbits.orbit_derivatives(family.at_speed(exact.speed), of_equation_1(22.2))
    grazing = oscillator.with_excess(0.0)
    steady = grazing.steady_response() * grazing.driven.amplitude
    start = contact.State(displacement=steady.imag, velocity=grazing.driven.angular_frequency * steady.real)
    with pytest.raises(contact.NoDerivative, match="grazes"):
        orbits.motion_derivatives(grazing, start, periods=1)
    for name, wrong in {"model": of_modes(2, omega=1.0), "law": (0.0, 1.0)}.items():
        with pytest.raises(ValueError, match=name):
            orbits.orbit_derivatives(family.at_speed(exact.speed), [Change(**{name: wrong})])
