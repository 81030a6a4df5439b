"""What moves p10 at 23.40 Hz, cause by cause."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from beam import single_mode
from contact import StroboscopicMap
from studies import letter
from studies.scene import single_mode_at
from studies.sensitivity.p10 import causes_of, cubic, distorted, period_of, row_of

FINE = {"rtol": 1e-11, "atol": 1e-14}


def test_recoil_has_the_frequencies_and_the_mobility_of_two_bodies():
    """(w^2 - l)(w_s^2 - l) = l^2 Gamma^2/m; an impulse meets the reduced mass; q still follows the base."""
    gamma, phi, mass = 0.17, 7.7, 2.0
    one = replace(single_mode(free_period=0.04, decay_rate=0.0), phi=[phi], participation=[gamma])
    both, square, own = one.on_exciter(mass=mass, suspension_hz=9.0), one.omega[0] ** 2, (18.0 * np.pi) ** 2
    assert both.omega**2 == pytest.approx(np.sort(np.roots(
        [1.0 - gamma**2 / mass, -square - own, square * own])), rel=1e-12)  # fmt: skip
    assert both.phi @ both.phi == pytest.approx(phi**2 / (1.0 - gamma**2 / mass), rel=1e-12)
    w = 2.0 * np.pi * 23.4
    answer = both.participation / (both.omega**2 - w**2)
    relative = (both.phi @ answer) / (both.participation @ answer / mass)
    assert relative == pytest.approx(phi * gamma * w**2 / (square - w**2), rel=1e-11)


def test_a_heavy_exciter_gives_the_spring_back(letter_model):
    heavy = letter_model.on_exciter(mass=1e9, suspension_hz=5.0, damping_ratio=0.1)
    for name in ("omega", "decay_rate"):
        assert getattr(heavy, name)[1:] == pytest.approx(getattr(letter_model, name), rel=1e-7)
    assert np.abs(heavy.phi)[1:] == pytest.approx(letter_model.phi, rel=1e-7)
    with pytest.raises(ValueError, match="mass"):
        letter_model.on_exciter(mass=0.01, suspension_hz=5.0)


@pytest.mark.parametrize(("order", "phase"), [(2, 0.0), (7, 4.0)])
def test_a_harmonic_moves_eq_1_as_another_integrator_says(letter_scene, order, phase):
    f, ratio, gap = 23.40, 0.01, letter_scene.stop.gap_m
    start = distorted(partial(single_mode_at, letter_scene), order, ratio, phase, f)
    assert start.at(-1e-6).orbit(start.at(-1e-6).steady(), 3).impacts.sum() == 0
    assert start.at(1e-6).orbit(start.at(1e-6).steady(), 3).impacts.sum() > 0
    there = start.at(2e-3)
    points = there.orbit(there.steady(), 24)
    model, w = there.oscillator.model, 2.0 * np.pi * f
    sizes = there.oscillator.driven.amplitude * np.array([1.0, ratio])
    turns, phases = w * np.array([1.0, order]), np.array([0.0, phase])

    def rate(t, y):
        pull = np.sum(sizes * turns**2 * np.sin(turns * t + phases))
        return [y[1], pull - model.decay_rate[0] * y[1] - model.omega[0] ** 2 * y[0]]

    def touch(t, y):
        return y[0] - gap

    touch.terminal, touch.direction = True, 1.0
    # the whole steady motion in closed form
    answer = sizes * turns**2 * np.exp(1j * phases) / (
        model.omega[0] ** 2 - turns**2 + 1j * model.decay_rate[0] * turns)  # fmt: skip
    y, t, hits = np.array([answer.imag.sum(), (turns * answer).real.sum()]), 0.0, 0
    while t < 24 / f:
        run = solve_ivp(rate, (t, 24 / f), y, "DOP853", events=touch, max_step=0.01 / f, **FINE)
        t, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            y, hits = np.array([gap * (1.0 - 1e-15), -0.1 * y[1]]), hits + 1
    assert hits == points.impacts.sum() == 3
    assert there.tip(points.points)[-1] == pytest.approx(y[0], abs=1e-6 * gap)


@pytest.mark.filterwarnings("ignore:mass of the tip is 10 kg")
def test_a_leaf_that_curves_across_stiffens_as_its_curvature_says(letter_scene):
    """A heavy tip bends it to y'' = 3 (1 - s/L) x/L^2: b = (nu^2 b^4/(30 t^2)) 27/(5 L^4)."""
    leaf = {"spring.kind": "cantilever", "tip.mass_kg": 10.0, "spring.tape_thickness_m": 0.0}
    leaf = letter_scene.replace(leaf)
    keys, width = leaf.spring, 0.02
    more = cubic(leaf, width).stiffness - cubic(leaf).stiffness
    expected = (keys.poisson_ratio * width**2 / keys.thickness_m) ** 2 / 30.0 * 5.4 / keys.leg_length_m**4
    assert more == pytest.approx(expected, rel=1e-3)


def test_p10_is_born_from_where_it_should_be(letter_scene, letter_model):
    """4e-3 at 40.80 ms and 2.5e-3 at 40.78 ms; recoil of a base on which T was measured changes nothing."""
    causes = {cause[0]: cause for cause in causes_of(letter_scene, letter_model)}
    row = partial(row_of, letter_scene, 1.05)
    plain, shorter = row(causes["Eq. (1)"]), row(causes["T -0.02 ms"])
    assert plain.p10_from == pytest.approx(4e-3, rel=0.05) and plain.born == (11, 11, 10, 10)
    assert shorter.p10_from == pytest.approx(2.5e-3, rel=0.05)
    assert plain.six_from == plain.p10_from and plain.six_to < plain.p10_to
    recoil = row(causes["recoil of 2 kg on 15 Hz, T on it"])
    assert recoil.p10_from == pytest.approx(plain.p10_from, rel=0.06)
    assert recoil.effective_period_s == pytest.approx(40.80e-3, abs=2e-6)
    assert row(causes["map"]).p10_from is None


@pytest.mark.parametrize(("period", "six"), [(40.70e-3, 0), (40.72e-3, 1), (40.74e-3, 1), (40.76e-3, 0)])
def test_all_six_at_1e_3_need_an_effective_period_of_40_71_to_40_745_ms(letter_scene, period, six):
    scene = letter_scene.replace({"single_mode.free_period_s": period})
    found = [period_of(StroboscopicMap(oscillator=single_mode_at(scene, f)), 1e-3) for f in letter.PERIODS]
    assert (found == list(letter.PERIODS.values())) == six
