"""Derivatives of the modal numbers: by the frequency equation, differences and what they keep."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest
from straight_frame import uniform_beam

import beam

STRIP = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=1.15e-3)
LENGTH = 0.13
OWN = STRIP.mass_per_length * LENGTH
THREE = beam.ModalModel(
    omega=[154, 1000, 3100], decay_rate=[60, 20, 90], phi=[6, 8, 9], participation=[0.1, 0.05, 0.03]
)
ARRAYS = [field.name for field in fields(beam.ModalChange)]

Numbers = dict[str, np.ndarray]


@cache
def letter_u(mass: float = 6e-3, modulus: float = beam.BRASS.youngs_modulus) -> beam.Modes:
    """A flat U, its legs partly taped, with frequencies from strain energies, which rounding spares."""
    sheet = replace(STRIP, material=replace(beam.BRASS, youngs_modulus=modulus))
    taped = replace(sheet, layer=beam.Layer(material=beam.DAMPING_TAPE, thickness=0.2e-3))
    spring = beam.flat_u(
        leg_length=LENGTH,
        bend_radius=9e-3,
        section=sheet,
        tip=beam.Tip(mass=mass),
        damped_section=taped,
        damped_span=(0.0, 0.08),
    )
    modes = beam.natural_modes(beam.assemble(spring), 8)
    energies = modes.discretization.strain_energies(modes.shapes).sum(axis=(0, 1))
    return replace(modes, omega=np.sqrt(2.0 * energies))


def differences(of: Callable[[float], Numbers], at: float, step: float) -> Numbers:
    """Central differences of order 8."""
    found = {name: np.zeros_like(value) for name, value in of(at).items()}
    for i, weight in enumerate((4 / 5, -1 / 5, 4 / 105, -1 / 280), start=1):
        above, below = of(at + i * step), of(at - i * step)
        for name in found:
            found[name] += weight / step * (above[name] - below[name])
    return found


def agree(change: beam.ModalChange, model: Callable[[float], beam.ModalModel], at: float, tol: float) -> None:
    """To this part of the number itself over the parameter; ten times as much in what K x goes into."""
    found = differences(lambda x: {name: getattr(model(x), name) for name in ARRAYS}, at, 0.05 * at)
    for name in ARRAYS:
        error = (getattr(change, name) - found[name]) * at / np.abs(getattr(model(at), name))
        assert np.abs(error).max() < tol * (10.0 if name == "decay_rate" else 1.0), (name, error)


def seen(model: beam.ModalModel) -> Numbers:
    """What the changes speak of."""
    first = np.sqrt(model.omega[:1] ** 2 - 0.25 * model.decay_rate[:1] ** 2)
    return {
        "period": 2.0 * np.pi / first,
        "hz": model.frequencies_hz,
        "rates": model.decay_rate,
        "overtones": model.omega[1:] / model.omega[0],
        "ratios": 0.5 * model.decay_rate / model.omega,
        "phi": model.phi,
        "participation": model.participation,
    }


KEPT = {"period": [0], "overtones": [0, 0]}


@pytest.mark.parametrize(
    ("change", "moved"),
    [
        (beam.free_period_change(THREE), KEPT | {"period": [1], "rates": [0, 0, 0]}),
        (beam.free_period_change(THREE, ratios_kept=True), KEPT | {"period": [1], "ratios": [0, 0, 0]}),
        (beam.decay_rate_change(THREE), KEPT | {"rates": [1, 0, 0]}),
        (beam.decay_rate_change(THREE, 2), KEPT | {"rates": [0, 0, 1]}),
        (beam.decay_rate_change(THREE, None), KEPT | {"rates": [1, 1 / 3, 1.5]}),
        (beam.damping_ratio_change(THREE), KEPT | {"ratios": [1, 1, 1]}),
        (beam.damping_ratio_change(THREE, 0), KEPT | {"ratios": [1, 0, 0]}),
        (beam.frequency_change(THREE, 1), {"hz": [0, 1, 0], "rates": [0, 0, 0]}),
    ],
)
def test_a_change_moves_its_own_parameter_and_keeps_the_others(change, moved):
    """Its own by 1 per unit; shapes are no business of theirs."""
    size = max(np.abs(getattr(change, name) / getattr(THREE, name)).max() for name in ARRAYS)

    def along(step: float) -> Numbers:
        return seen(replace(THREE, **{n: getattr(THREE, n) + step * getattr(change, n) for n in ARRAYS}))

    found, at = differences(along, 0.0, 1e-3 / size), seen(THREE)
    for name, expected in {"phi": [0, 0, 0], "participation": [0, 0, 0], **moved}.items():
        assert np.abs((found[name] - expected) / at[name]).max() < 1e-11 * size, name


def test_without_damping_all_modes_get_the_same() -> None:
    """There is no proportion to keep; the frequencies do not move to first order."""
    change = beam.decay_rate_change(replace(THREE, decay_rate=np.zeros(3)), None)
    assert np.array_equal(change.decay_rate, np.ones(3)) and not np.any(change.omega)


@pytest.mark.parametrize("ratio", [0.1, 0.3, 1.0])
def test_frequencies_of_a_cantilever_with_a_ball(ratio: float) -> None:
    """1 + cos x cosh x + (M/m_b) x (cos x sinh x - sin x cosh x) = 0 at x = beta L, differentiated."""
    spring = beam.cantilever(length=LENGTH, section=STRIP, tip=beam.Tip(mass=ratio * OWN))
    modes = beam.natural_modes(beam.assemble(spring, 60), 4)
    change = beam.tip_mass_change(modes, beam.ConstantRatio(ratio=0.01))
    x = beam.exact_modes(uniform_beam(STRIP, LENGTH, beam.Tip(mass=ratio * OWN)), 4).wave_numbers * LENGTH
    c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
    by_x = c * sh - s * ch + ratio * (c * sh - s * ch - 2.0 * x * s * sh)
    by_ratio = x * (c * sh - s * ch)
    np.testing.assert_allclose(change.omega * OWN / modes.omega, -2.0 / x * by_ratio / by_x, rtol=1e-6)
    np.testing.assert_allclose(change.decay_rate, 0.02 * change.omega, rtol=1e-12)


@pytest.mark.parametrize(
    "damping",
    [
        beam.MeasuredDecay(decay_rate=3.56),
        beam.MeasuredDecay(decay_rate=3.56, others=beam.ConstantLossFactor(loss_factor=0.02), scaled=False),
        beam.StripDamping(),
        beam.Rayleigh(mass_coefficient=1.0, stiffness_coefficient=1e-6),
    ],
)
def test_mass_and_modulus_of_the_letters_spring_by_differences(damping: beam.Damping) -> None:
    """Of K x rounding takes four digits, so that what a modulus does to shapes is known to fewer."""
    modes, modulus = letter_u(), beam.BRASS.youngs_modulus
    agree(beam.tip_mass_change(modes, damping), lambda x: beam.reduce(letter_u(mass=x), damping), 6e-3, 1e-8)
    stiffer, own = letter_u(modulus=2.0 * modulus).discretization, modes.discretization
    more = (stiffer.stiffness - own.stiffness) / modulus
    lossy = (stiffer.loss_stiffness - own.loss_stiffness) / modulus
    change = beam.mode_changes(modes, damping, stiffness=more, loss_stiffness=lossy)
    agree(change, lambda x: beam.reduce(letter_u(modulus=x), damping), modulus, 1e-7)


class Tabulated:
    """A rule that gives what it was given, whatever the modes."""

    def decay_rates(self, modes: beam.Modes) -> np.ndarray:
        return np.full(modes.omega.size, 2.0)


def test_what_has_no_derivative_is_refused() -> None:
    modes, rule = letter_u(), beam.ConstantRatio(ratio=0.01)
    with pytest.raises(ValueError, match="Tabulated"):
        beam.tip_mass_change(modes, Tabulated())
    with pytest.raises(ValueError, match="twice"):
        beam.tip_mass_change(replace(modes, omega=np.repeat(modes.omega[::2], 2)), rule)
    ends = {"supports": ("pinned", "free"), "tip_at": 0.1}
    floating = beam.straight_strip(length=0.1, section=STRIP, tip=beam.Tip(mass=1e-3), **ends)
    free = beam.natural_modes(beam.assemble(floating, 10), 3)
    assert beam.tip_mass_change(free, rule).omega[0] == 0.0
    with pytest.raises(ValueError, match="rigid"):
        beam.mode_changes(free, rule, stiffness=free.discretization.mass)
    with pytest.raises(ValueError, match="does not swing"), pytest.warns(UserWarning, match="decay_rate"):
        beam.free_period_change(replace(THREE, decay_rate=[310.0, 1.0, 1.0]))
