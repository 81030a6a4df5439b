"""Derivatives of the modal numbers: by the frequency equation, sum rules, differences and what they keep."""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

import beam

STRIP = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=1.15e-3)
LENGTH = 0.13
OWN = STRIP.mass_per_length * LENGTH
THREE = beam.ModalModel(
    omega=[154, 1000, 3100], decay_rate=[60, 20, 90], phi=[6, 8, 9], participation=[0.1, 0.05, 0.03]
)
ARRAYS = [field.name for field in fields(beam.ModalChange)]


def letter_u(mass: float = 6e-3, modulus: float = beam.BRASS.youngs_modulus) -> beam.Modes:
    """A flat U, its legs partly taped, with frequencies from strain energies, which rounding spares."""
    sheet = replace(STRIP, material=replace(beam.BRASS, youngs_modulus=modulus))
    taped = replace(sheet, layer=beam.Layer(material=beam.DAMPING_TAPE, thickness=0.2e-3))
    spring = beam.flat_u(
        leg_length=LENGTH, bend_radius=9e-3, section=sheet, tip=beam.Tip(mass=mass), damped_section=taped,
        damped_span=(0.0, 0.08),
    )  # fmt: skip
    modes = beam.natural_modes(beam.assemble(spring), 8)
    energies = modes.discretization.strain_energies(modes.shapes).sum(axis=(0, 1))
    return replace(modes, omega=np.sqrt(2.0 * energies))


def differences(model: Callable[[float], beam.ModalModel], at: float, step: float) -> dict[str, np.ndarray]:
    """Central differences of order 8."""
    found = {name: np.zeros(model(at).n_modes) for name in ARRAYS}
    for i, weight in enumerate((4 / 5, -1 / 5, 4 / 105, -1 / 280), start=1):
        above, below = model(at + i * step), model(at - i * step)
        for name in ARRAYS:
            found[name] += weight / step * (getattr(above, name) - getattr(below, name))
    return found


def agree(
    change: beam.ModalChange, found: dict[str, np.ndarray], model: beam.ModalModel, at: float, tol: float
) -> None:
    """To this part of the number itself over the parameter; ten times as much in what K x goes into."""
    for name in ARRAYS:
        error = (getattr(change, name) - found[name]) * at / np.abs(getattr(model, name))
        assert np.abs(error).max() < tol * (10.0 if name == "decay_rate" else 1.0), (name, error)


def test_period_and_decay_rate_are_those_of_equation_1() -> None:
    """Overtones take no part; a large decay rate, so that its share in omega is seen."""
    period, rate = 40.8e-3, 35.6
    model = beam.single_mode(free_period=period, decay_rate=rate)
    assert model.free_period == pytest.approx(period, rel=1e-14)
    by_period = differences(lambda x: beam.single_mode(free_period=x, decay_rate=rate), period, 1e-2 * period)
    by_rate = differences(lambda x: beam.single_mode(free_period=period, decay_rate=x), rate, 1e-2 * rate)
    agree(beam.free_period_change(model), by_period, model, period, 1e-12)
    agree(beam.decay_rate_change(model), by_rate, model, rate, 1e-12)


def seen(model: beam.ModalModel) -> dict[str, np.ndarray]:
    """What the changes speak of."""
    return {
        "period": np.array([model.free_period]), "hz": model.frequencies_hz, "rates": model.decay_rate,
        "overtones": model.omega[1:] / model.omega[0], "ratios": 0.5 * model.decay_rate / model.omega,
    }  # fmt: skip


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
def test_a_change_moves_its_own_parameter_and_keeps_the_others(
    change: beam.ModalChange, moved: dict[str, list[float]]
) -> None:
    size = max(np.abs(getattr(change, name) / getattr(THREE, name)).max() for name in ARRAYS)

    def along(step: float) -> dict[str, np.ndarray]:
        return seen(replace(THREE, **{n: getattr(THREE, n) + step * getattr(change, n) for n in ARRAYS}))

    step, at = 1e-4 / size, seen(THREE)
    above, below = along(step), along(-step)
    for name, expected in moved.items():
        found, wanted = 0.5 * (above[name] - below[name]) / at[name], step * np.array(expected) / at[name]
        np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-11, err_msg=name)


@pytest.mark.parametrize("ratio", [0.1, 0.3, 1.0])
def test_frequencies_of_a_cantilever_with_a_ball(ratio: float) -> None:
    """1 + cos x cosh x + (M/m_b) x (cos x sinh x - sin x cosh x) = 0 at x = beta L, differentiated."""
    spring = beam.cantilever(length=LENGTH, section=STRIP, tip=beam.Tip(mass=ratio * OWN))
    modes = beam.natural_modes(beam.assemble(spring, 60), 4)
    change = beam.tip_mass_change(modes, beam.ConstantRatio(ratio=0.01))
    uniform = beam.UniformBeam(
        length=LENGTH, bending_stiffness=STRIP.bending_stiffness, mass_per_length=STRIP.mass_per_length,
        tip_mass=ratio * OWN,
    )  # fmt: skip
    x = beam.exact_modes(uniform, 4).wave_numbers * LENGTH
    c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
    by_x = c * sh - s * ch + ratio * (c * sh - s * ch - 2.0 * x * s * sh)
    by_ratio = x * (c * sh - s * ch)
    np.testing.assert_allclose(change.omega * OWN / modes.omega, -2.0 / x * by_ratio / by_x, rtol=1e-6)
    np.testing.assert_allclose(change.decay_rate, 0.02 * change.omega, rtol=1e-12)


def test_mass_of_mode_1_at_the_tip_adds_up_to_the_table() -> None:
    """1/phi_1^2 over the mass of the strip: its derivative, integrated by Gauss's rule."""
    printed = {0.1: 0.3457, 0.2: 0.4433, 0.3: 0.5419, 0.5: 0.7402, 1.0: 1.2383}
    x, weight = np.polynomial.legendre.leggauss(3)
    for low, high in zip(list(printed)[:-1], list(printed)[1:], strict=True):
        rise = 0.0
        for at, part in zip(low + 0.5 * (high - low) * (1.0 + x), 0.5 * (high - low) * weight, strict=True):
            spring = beam.cantilever(length=LENGTH, section=STRIP, tip=beam.Tip(mass=at * OWN))
            modes = beam.natural_modes(beam.assemble(spring, 20), 1)
            change = beam.tip_mass_change(modes, beam.ConstantRatio(ratio=0.01))
            rise += part * -2.0 * change.phi[0] / modes.phi[0] ** 3
        assert rise == pytest.approx(printed[high] - printed[low], abs=1.1e-4)


def test_sum_rules_differentiated() -> None:
    """Over all modes of a mesh sums of compliance and translation stay, that of 1/M gains with the mesh."""
    mass, errors = 0.3 * OWN, []
    for elements in (20, 40, 80):
        spring = beam.cantilever(length=LENGTH, section=STRIP, tip=beam.Tip(mass=mass))
        modes = beam.natural_modes(beam.assemble(spring, elements), 2 * elements)
        d = beam.tip_mass_change(modes, beam.ConstantRatio(ratio=0.0))
        phi, gamma, omega = modes.phi, modes.participation, modes.omega
        compliance = 2.0 * phi / omega * (d.phi / omega - phi / omega**2 * d.omega)
        for terms in (compliance, d.participation * phi + gamma * d.phi):
            assert abs(terms.sum()) < 1e-8 * np.abs(terms).sum()
        errors.append(2.0 * mass**2 * phi @ d.phi + 1.0)
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 1.0, atol=0.1)


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
    mass, modulus = 6e-3, beam.BRASS.youngs_modulus
    modes = letter_u()
    model = beam.reduce(modes, damping)
    found = differences(lambda x: beam.reduce(letter_u(mass=x), damping), mass, 0.05 * mass)
    agree(beam.tip_mass_change(modes, damping), found, model, mass, 1e-8)
    found = differences(lambda x: beam.reduce(letter_u(modulus=x), damping), modulus, 0.05 * modulus)
    stiffer, own = letter_u(modulus=2.0 * modulus).discretization, modes.discretization
    more = (stiffer.stiffness - own.stiffness) / modulus
    lossy = (stiffer.loss_stiffness - own.loss_stiffness) / modulus
    change = beam.mode_changes(modes, damping, stiffness=more, loss_stiffness=lossy)
    agree(change, found, model, modulus, 1e-7)


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
    with pytest.raises(ValueError, match="mode is 3"):
        beam.frequency_change(THREE, 3)
    with pytest.raises(ValueError, match="does not swing"), pytest.warns(UserWarning, match="decay_rate"):
        beam.free_period_change(replace(THREE, decay_rate=[310.0, 1.0, 1.0]))
    with pytest.raises(ValueError, match="phi has shape"):
        beam.ModalChange(omega=[1.0, 2.0], decay_rate=[0.0, 0.0], phi=[0.0], participation=[0.0, 0.0])
