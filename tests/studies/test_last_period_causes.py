"""The causes that can move p10 at 23.40 Hz, one by one."""

from dataclasses import replace

import numpy as np
import pytest

from beam import single_mode
from studies.experiment.last_period.causes import causes_of, cubic, effect_of


def test_recoil_has_the_frequencies_and_the_mobility_of_two_bodies():
    """(w^2 - l)(w_s^2 - l) = l^2 Gamma^2/m; an impulse meets the reduced mass; q still follows the base."""
    gamma, phi, mass, w = 0.17, 7.7, 2.0, 2.0 * np.pi * 23.4
    one = replace(single_mode(free_period=0.04, decay_rate=0.0), phi=[phi], participation=[gamma])
    both, square, own = one.on_exciter(mass=mass, suspension_hz=9.0), one.omega[0] ** 2, (18.0 * np.pi) ** 2
    roots = np.roots([1.0 - gamma**2 / mass, -square - own, square * own])
    assert both.omega**2 == pytest.approx(np.sort(roots), rel=1e-12)
    assert both.phi @ both.phi == pytest.approx(phi**2 / (1.0 - gamma**2 / mass), rel=1e-12)
    answer = both.participation / (both.omega**2 - w**2)
    relative = (both.phi @ answer) / (both.participation @ answer / mass)
    assert relative == pytest.approx(phi * gamma * w**2 / (square - w**2), rel=1e-11)


def test_a_heavy_exciter_gives_the_spring_back_and_one_measured_on_it_keeps_mode_1(letter_model):
    heavy = letter_model.on_exciter(mass=1e9, suspension_hz=5.0, damping_ratio=0.1)
    light = letter_model.on_exciter(mass=2.0, suspension_hz=15.0, damping_ratio=0.1, measured_on_it=True)
    for name in ("omega", "decay_rate", "phi"):
        assert np.abs(getattr(heavy, name))[1:] == pytest.approx(getattr(letter_model, name), rel=1e-7)
    assert [light.omega[1], light.decay_rate[1]] == pytest.approx([letter_model.omega[0], 3.56], rel=1e-9)
    with pytest.raises(ValueError, match="mass"):
        letter_model.on_exciter(mass=0.01, suspension_hz=5.0)


@pytest.mark.filterwarnings("ignore:mass of the tip is 10 kg")
def test_a_leaf_that_curves_across_stiffens_as_its_curvature_says(letter_scene):
    """A heavy tip bends it to y'' = 3 (1 - s/L) x/L^2: b = (nu^2 b^4/(30 t^2)) 27/(5 L^4)."""
    changes = {"spring.kind": "cantilever", "tip.mass_kg": 10.0, "spring.tape_thickness_m": 0.0}
    leaf = letter_scene.replace(changes)
    more, keys = cubic(leaf, 0.02).stiffness - cubic(leaf).stiffness, leaf.spring
    expected = (keys.poisson_ratio * 0.02**2 / keys.thickness_m) ** 2 / 30.0 * 5.4 / keys.leg_length_m**4
    assert more == pytest.approx(expected, rel=1e-3)


@pytest.fixture(scope="module")
def causes(letter_scene, letter_model):
    """By name."""
    return {cause.words: cause for cause in causes_of(letter_scene, letter_model)}


def test_p10_is_born_from_where_it_should_be(letter_scene, causes):
    nordmark, plain = (effect_of(letter_scene, 1.1, causes[name]) for name in ("map", "Eq. (1)"))
    assert nordmark.p10_from is None and [*plain.born.values()] == [11, 11, 10, 10]
    assert plain.p10_from == plain.six_from == pytest.approx(4e-3, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "excess"), [("T -0.02 ms", 2.5e-3), ("recoil of 2 kg on 15 Hz, T on it", 4e-3)]
)
def test_recoil_of_a_base_on_which_t_was_measured_moves_nothing(letter_scene, causes, name, excess):
    assert effect_of(letter_scene, 1.05, causes[name]).p10_from == pytest.approx(excess, rel=0.05)
