"""Modes from poles and residues, against frequency responses that are made by another route."""

import doctest

import numpy as np
import pytest

import beam

SPRING = beam.cantilever(
    length=0.13, section=beam.StripSection(material=beam.BRASS, width=0.012, thickness=1e-3)
)


@pytest.mark.parametrize("response", ["displacement", "velocity", "acceleration"])
def test_residues_fitted_to_responses_of_a_cantilever_give_its_modes(response):
    """The responses are solutions with stiffness and mass; only numbers of the test enter the fit."""
    modes = beam.natural_modes(beam.assemble(SPRING, 20), 3)
    true = beam.reduce(modes, beam.ConstantRatio(ratio=0.02))
    order = ["displacement", "velocity", "acceleration"].index(response)
    s = 1j * np.geomspace(0.3 * true.omega[0], 1.5 * true.omega[-1], 300)[:, None]
    shapes = 1.0 / (s**2 + true.decay_rate * s + true.omega**2)
    seen = (
        s**order
        * np.stack([shapes * true.phi**2, -shapes * true.participation * true.phi]).sum(axis=2)[..., None]
    )
    poles = true.omega * (-0.02 + 1j * np.sqrt(1.0 - 0.02**2))
    one, two = 1.0 / (s - poles), 1.0 / (s - poles.conj())
    columns = np.hstack([one + two, 1j * (one - two), np.ones_like(s), s])  # real and imaginary parts, rest
    stacked = np.vstack([columns.real, columns.imag])
    scale = np.linalg.norm(stacked, axis=0)
    fits = [np.linalg.lstsq(stacked / scale, np.vstack([y.real, y.imag]))[0][:, 0] / scale for y in seen]
    force, base = (fit[:3] + 1j * fit[3:6] for fit in fits)
    model = beam.ModalModel.from_residues(
        poles=poles, force_residues=force, base_residues=base, response=response, tip_mass=0.01
    )
    signs = np.sign(true.phi)
    for name, wanted in (("phi", abs(true.phi)), ("participation", signs * true.participation)):
        np.testing.assert_allclose(getattr(model, name), wanted, rtol=1e-6)
    np.testing.assert_allclose([model.omega, model.decay_rate], [true.omega, true.decay_rate], rtol=1e-12)
    assert model.tip_mass == model.points["tip"].mass == 0.01


def test_a_residue_with_a_doubtful_phase_is_warned_of_and_the_real_part_is_taken():
    test = dict(poles=[-1 + 100j], force_residues=[-0.2j * np.exp(0.3j)], base_residues=[0.0])
    with pytest.warns(beam.SuspiciousValue, match="phase in mode 1 that is 17 degrees off"):
        model = beam.ModalModel.from_residues(**test)
    assert model.phi[0] ** 2 == pytest.approx(0.2 * 200.0 * np.cos(0.3)) and model.participation[0] == 0.0


def test_its_example_runs():
    (example,) = doctest.DocTestFinder(recurse=False).find(beam.ModalModel.from_residues, "from_residues")
    outcome = doctest.DocTestRunner().run(example)
    assert outcome.attempted == 3 and outcome.failed == 0
