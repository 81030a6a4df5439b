"""The restitution of a spring and dashpot, and of a ball that bounces."""

import math

import numpy as np
import pytest
from oscillators import modes_on_stop, newton
from whole_motions import falling_body

from contact import LinearContact, State, damping_ratio, restitution_from_bounces, simulate
from contact.restitution import log_restitution


def published(zeta: float) -> float:
    """Schwager and Poeschel, Granular Matter 9 (2007) 465, Eq. (21), in its three branches; omega_0 = 1."""
    root = math.sqrt(abs(1.0 - zeta**2))
    if zeta == 1.0:
        return math.exp(-2.0)
    if zeta > 1.0:
        return math.exp(-zeta / root * math.log((zeta + root) / (zeta - root)))
    angle = math.atan(2.0 * zeta * root / (2.0 * zeta**2 - 1.0))
    return math.exp(-zeta / root * (angle + (math.pi if zeta < math.sqrt(0.5) else 0.0)))


@pytest.mark.parametrize("zeta", [0.01, 0.3, 0.8, 0.999, 1.0, 1.2, 4.0])
def test_the_restitution_is_the_published_one_and_that_of_a_simulated_mass(zeta: float) -> None:
    """With e = exp(-zeta omega_0 t) the force lasts t, and the mass then flies out of the stop at e v."""
    law = LinearContact(stiffness=1e6, damping=2.0 * zeta * math.sqrt(1e6 * 4.0))
    thrown = State(displacement=[0.0], velocity=[1.0])
    hit = simulate(modes_on_stop(0.0, phi=0.5, law=law), thrown, duration=0.5).impacts
    e = math.exp(log_restitution(zeta))
    lasts = (2.0 * zeta - math.log(e) / zeta) / math.sqrt(1e6 / 4.0)
    assert e == pytest.approx(published(zeta), rel=1e-12)
    assert -hit.rebound[0] / hit.approach[0] == pytest.approx(e, rel=1e-11)
    assert hit.end[0] - hit.start[0] == pytest.approx(lasts, rel=1e-10)
    assert hit.loss[0] == pytest.approx(0.5 * (1.0 - e * e), rel=1e-9)
    made = LinearContact.with_restitution(stiffness=1e6, restitution=e, mass=4.0)
    assert made.damping == pytest.approx(law.damping, rel=1e-12)


def test_the_inverse_holds_from_elastic_to_almost_plastic() -> None:
    """Near e = 1 it is (1 - e)/pi; e = exp(-2) is critical."""
    assert damping_ratio(1.0) == 0.0
    assert damping_ratio(1.0 - 2.0**-40) == pytest.approx(2.0**-40 / math.pi, rel=1e-11)
    assert damping_ratio(math.exp(-2.0)) == pytest.approx(1.0, rel=1e-14)
    for e in (1e-12, 1e-3, 0.13, 0.14, 0.5, 0.999):
        assert math.exp(log_restitution(damping_ratio(e))) == pytest.approx(e, rel=1e-13)


@pytest.mark.parametrize("e", [0.6, 0.9])
def test_simulated_bounces_have_the_restitution_of_the_law(e: float) -> None:
    bounces = simulate(falling_body(0.3, newton(e)), State.rest(1), duration=2.0).impacts.start[:7]
    found = restitution_from_bounces(bounces)
    assert found.restitution == pytest.approx(e, rel=1e-12) and found.standard_error < 1e-12
    three = restitution_from_bounces(bounces[:3])
    assert three.restitution == pytest.approx(e, rel=1e-12) and math.isnan(three.standard_error)


def test_the_standard_error_is_the_spread_of_repeated_measurements() -> None:
    """400 series of seven bounces, timed to 0.1 ms: their spread is known to 3.5 %, and is below that of the
    ratio of two intervals."""
    times, rng = np.cumsum(0.4 * 0.8 ** np.arange(7)), np.random.default_rng(2)
    measured = times + 1e-4 * rng.standard_normal((400, 7))
    found = np.array([restitution_from_bounces(row) for row in measured])
    spread, ratios = found[:, 0].std(), np.diff(measured)[:, 1] / np.diff(measured)[:, 0]
    assert abs(found[:, 0].mean() - 0.8) < 4.0 * spread / 20.0 and spread < 0.7 * ratios.std()
    assert math.sqrt(np.mean(found[:, 1] ** 2)) == pytest.approx(spread, rel=0.14)
