"""Decay rates: closed rules, and strain energies against complex eigenvalues."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eig

import beam

BARE = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=0.65e-3)
GLUED = replace(BARE, layer=beam.Layer(material=beam.DAMPING_TAPE, thickness=0.2e-3))


@pytest.fixture(scope="module")
def modes() -> beam.Modes:
    cover = dict(damped_section=GLUED, damped_span=(0.01, 0.07))
    shape = dict(leg_length=0.13, bend_radius=7.5e-3, section=BARE, tip=beam.Tip(mass=4e-3))
    return beam.natural_modes(beam.assemble(beam.folded_u(**shape, **cover), 6), 12)


def test_closed_rules(modes: beam.Modes) -> None:
    omega = modes.omega
    np.testing.assert_allclose(beam.ConstantRatio(ratio=0.01).decay_rates(modes), 0.02 * omega)
    np.testing.assert_allclose(beam.ConstantLossFactor(loss_factor=0.02).decay_rates(modes), 0.02 * omega)
    rayleigh = beam.Rayleigh(mass_coefficient=3.0, stiffness_coefficient=1e-6)
    np.testing.assert_allclose(rayleigh.decay_rates(modes), 3.0 + 1e-6 * omega**2)


def test_one_section_throughout_has_one_loss_factor() -> None:
    leaf = beam.cantilever(length=0.13, section=GLUED, tip=beam.Tip(mass=1e-3))
    modes = beam.natural_modes(beam.assemble(leaf, 30), 10)
    np.testing.assert_allclose(modes.loss_factors(), GLUED.bending_loss_factor, rtol=1e-9)


def test_strain_energy_is_the_first_order_of_complex_stiffness(modes: beam.Modes) -> None:
    """With K (1 + i eta) the eigenvalues are omega^2 (1 + i eta_k); the energy formula drops only eta^2."""
    model, errors = modes.discretization, []
    for scale in (1.0, 0.5):
        stiffness = (model.stiffness + 1j * scale * model.loss_stiffness).toarray()
        inverse = eig(model.mass.toarray(), stiffness, right=False)
        values = 1.0 / inverse[np.argsort(-np.abs(inverse))][:12]
        errors.append(np.abs(values.imag / values.real / scale - modes.loss_factors()))
    assert np.all(errors[0] < 1e-2 * modes.loss_factors())
    assert np.log2(errors[0].max() / errors[1].max()) == pytest.approx(2.0, abs=0.2)


def test_where_the_layer_lies_decides_which_mode_it_damps(modes: beam.Modes) -> None:
    eta = modes.loss_factors()
    assert np.all(eta > beam.BRASS.loss_factor) and np.all(eta < GLUED.bending_loss_factor)
    assert eta.max() > 1.2 * eta.min()
    np.testing.assert_allclose(beam.StripDamping().decay_rates(modes), eta * modes.omega, rtol=1e-9)


def test_measured_decay_scales_the_rule_or_replaces_mode_1(modes: beam.Modes) -> None:
    rule = beam.StripDamping().decay_rates(modes)
    scaled = beam.MeasuredDecay(decay_rate=3.56).decay_rates(modes)
    assert scaled[0] == pytest.approx(3.56, rel=1e-12)
    np.testing.assert_allclose(scaled / rule, 3.56 / rule[0], rtol=1e-12)
    others = beam.ConstantRatio(ratio=0.01)
    replaced = beam.MeasuredDecay(decay_rate=3.56, others=others, scaled=False).decay_rates(modes)
    np.testing.assert_allclose(replaced[1:], others.decay_rates(modes)[1:], rtol=1e-12)
    assert replaced[0] == 3.56


def test_measured_decay_speaks_of_the_first_coupled_mode(modes: beam.Modes) -> None:
    swapped = replace(modes, coupled=~modes.coupled)
    rates = beam.MeasuredDecay(decay_rate=2.0).decay_rates(swapped)
    assert rates[1] == pytest.approx(2.0, rel=1e-12) and rates[0] != pytest.approx(2.0, rel=1e-3)


def test_a_rule_that_cannot_be_scaled_is_refused(modes: beam.Modes) -> None:
    with pytest.raises(ValueError, match="others"):
        beam.MeasuredDecay(decay_rate=1.0, others=beam.ConstantRatio(ratio=0.0)).decay_rates(modes)
    with pytest.raises(ValueError, match="modes"):
        beam.MeasuredDecay(decay_rate=1.0).decay_rates(replace(modes, coupled=0 * modes.omega > 0))
