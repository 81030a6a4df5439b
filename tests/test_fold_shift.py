"""The shift of a fold by one run of a method, against the fold of the method's own map."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.integrators import CentralDifference
from contact.laws import HuntCrossley, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from studies.instruments.work_precision.fold_shift import FIRST_ORDER, FoldTest, flat, fold_test
from studies.instruments.work_precision.problems import FoldPoint, fold_point

GAP, PERIODS, FREQUENCY = 0.01, 4, 21.5

Map = Callable[[np.ndarray, float], np.ndarray]


def single_mode(law: object) -> ImpactOscillator:
    """Eq. (1) with T = 40.80 ms, mu = 3.56 1/s and another law at the wall."""
    model = ModalModel(
        omega=np.array([math.hypot(2 * math.pi / 0.0408, 1.78)]), decay_rate=np.array([3.56]), phi=np.ones(1),
        participation=np.ones(1),
    )  # fmt: skip
    drive = HarmonicDrive(frequency=FREQUENCY)
    return ImpactOscillator(model=model, stop=Stop(gap=GAP, law=law), drive=drive).with_excess(0.01)  # type: ignore[arg-type]


def scaled_map(fold: FoldPoint, scale: np.ndarray, method: CentralDifference | None) -> Map:
    """The m-period map of a method in scaled coordinates; the amplitude in units of the grazing amplitude."""
    unit = fold.oscillator.grazing_amplitude()

    def image(x: np.ndarray, amplitude: float) -> np.ndarray:
        start = replace(fold.state, displacement=scale[:1] * x[:1], velocity=scale[1:] * x[1:])
        driven = fold.oscillator.with_amplitude(amplitude * unit)
        return flat(simulate(driven, start, periods=fold.periods, method=method).end) / scale

    return image


def own_fold(image: Map, x: np.ndarray, amplitude: float, right: np.ndarray, span: float) -> float:
    """Amplitude at the fold of `image`: least A on the curve of its fixed points, by bordering.

    The curve is followed in s = right.(x - x*): for each s Newton's method solves P(x, A) = x for (x, A);
    then the minimum of the cubic through A(s) at seven places.
    """
    places = span * np.linspace(-1.0, 1.0, 7)
    start, found = np.append(x, amplitude), []

    def residual(z: np.ndarray, s: float) -> np.ndarray:
        return np.append(image(z[:2], z[2]) - z[:2], right @ (z[:2] - x) - s)

    for s in places:
        z = start + np.append(s * right, 0.0)
        jacobian = np.empty((3, 3))
        for j in range(3):
            step = np.zeros(3)
            step[j] = 1e-5
            jacobian[:, j] = (residual(z + step, s) - residual(z - step, s)) / 2e-5
        for _ in range(60):
            change = np.linalg.solve(jacobian, residual(z, s))
            z = z - change
            if np.max(np.abs(change)) < 1e-14:
                break
        assert np.max(np.abs(residual(z, s))) < 1e-12
        found.append(z[2])
    cubic = np.polynomial.Polynomial.fit(places, found, 3)
    turns = [t.real for t in cubic.deriv().roots() if abs(t.imag) < 1e-12 and abs(t.real) <= span]
    assert len(turns) == 1 and cubic.deriv(2)(turns[0]) > 0
    return float(cubic(turns[0]))


@pytest.fixture(scope="module")
def soft() -> tuple[FoldTest, np.ndarray, np.ndarray, float]:
    """A stop that loses speed as in the letter, with contacts of a millisecond; scales, right vector."""
    law = HuntCrossley.with_restitution(stiffness=1e9, restitution=0.4, velocity=0.4)
    fold = fold_point(single_mode(law), PERIODS)
    assert fold is not None and fold.excess < -1e-3
    test = fold_test(fold)
    scale = np.array([GAP, GAP * 2 * math.pi * FREQUENCY])
    image = scaled_map(fold, scale, None)
    x = flat(fold.state) / scale
    amplitude = 1.0 + fold.excess
    step = 1e-6
    columns = [
        (image(x + step * e, amplitude) - image(x - step * e, amplitude)) / (2 * step) for e in np.eye(2)
    ]
    _left, _values, rows = np.linalg.svd(np.eye(2) - np.array(columns).T)
    return test, scale, rows[-1], amplitude


def test_the_fold_of_the_exact_map_is_where_the_orbit_is(soft: tuple) -> None:
    test, scale, right, amplitude = soft
    image = scaled_map(test.fold, scale, None)
    found = own_fold(image, flat(test.fold.state) / scale, amplitude, right, 2e-3)
    assert found == pytest.approx(amplitude, abs=1e-9)
    assert test.singular < 1e-6
    assert abs(test.shift(simulate(test.fold.oscillator, test.fold.state, periods=PERIODS).end)) < 1e-14


def test_first_order_is_right_to_second_order_in_the_defect(soft: tuple) -> None:
    """Steps of central difference from a sixteenth of a contact down: what (a) leaves falls as its square."""
    test, scale, right, amplitude = soft
    shifts, left = [], []
    for steps in (800, 3200, 12800):
        method = CentralDifference(step=1 / (FREQUENCY * steps))
        image = scaled_map(test.fold, scale, method)
        whole = own_fold(image, flat(test.fold.state) / scale, amplitude, right, 0.02) - amplitude
        run = simulate(test.fold.oscillator, test.fold.state, periods=PERIODS, method=method)
        first = test.shift(run.end)
        shifts.append(abs(first))
        left.append(abs(whole - first))
    assert shifts[0] > 15 * shifts[2]
    constants = np.array(left) / np.array(shifts) ** 2
    np.testing.assert_allclose(constants, constants.mean(), rtol=0.2)
    # at the bound up to which the first order is trusted it is right to a thirtieth
    assert constants.max() * FIRST_ORDER * abs(test.fold.excess) < 1 / 25


def test_a_shift_as_large_as_the_fold_is_deep_is_not_trusted(soft: tuple) -> None:
    test = soft[0]
    assert not test.within_first_order(0.11 * test.fold.excess)
    assert test.within_first_order(0.09 * test.fold.excess)


def test_amplitude_enters_as_it_should() -> None:
    """The exact map at another restitution is a map like any other: its fold is known in closed form."""
    hard = single_mode(NewtonRestitution(local_restitution=0.1))
    fold = fold_point(hard, PERIODS)
    assert fold is not None
    test = fold_test(fold)
    ratios = []
    for change in (1e-3, 1e-4):
        law = NewtonRestitution(local_restitution=0.1 + change)
        other = replace(fold.oscillator, stop=Stop(gap=GAP, law=law))
        moved = fold_point(replace(hard, stop=Stop(gap=GAP, law=law)), PERIODS)
        assert moved is not None
        first = test.shift(simulate(other, fold.state, periods=PERIODS).end)
        exact = moved.excess - fold.excess
        ratios.append(abs(first - exact) / exact**2)
        assert first == pytest.approx(exact, rel=0.02)
    assert ratios[1] == pytest.approx(ratios[0], rel=0.05)  # what is left is of second order
