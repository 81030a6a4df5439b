"""Two measured beams: exact frequencies, numbers derived before, and the detached branch by other routes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from contact import simulate
from contact.integrators import CentralDifference
from studies.methods.validation.responses import harmonic
from studies.methods.validation.two_beams import GAP, LEVELS, Rig, backbone, both_beams, carried

E, DENSITY, WIDTH = 210e9, 7720.0, 0.060


def transfer(omega: float, length: float, stiffness: float, mass: float) -> np.ndarray:
    """(w, slope, EI w", its slope) across a piece with EI [N m^2] and mass per length [kg/m]."""
    flow = np.zeros((4, 4))
    flow[0, 1], flow[1, 2], flow[2, 3], flow[3, 0] = 1.0, 1.0 / stiffness, 1.0, mass * omega**2
    return expm(flow * length)


def bare(omega: float, length: float, factor: float = 1.0) -> np.ndarray:
    """A piece of 6 mm."""
    return transfer(omega, length, factor * E * WIDTH * 0.006**3 / 12, DENSITY * WIDTH * 0.006)


def left_end(hertz: float) -> float:
    """Zero where moment and shear vanish at the free end of the left beam."""
    omega, nut = 2 * np.pi * hertz, np.eye(4)
    nut[3, 0] = 0.0133 * omega**2
    height = 0.006 + 0.001 * 40 / 60
    mass = DENSITY * WIDTH * 0.006 + 0.0427 / 0.040
    plate = transfer(omega, 0.040, 0.75 * E * WIDTH * height**3 / 12, mass)
    whole = bare(omega, 0.0115) @ nut @ bare(omega, 0.051) @ plate @ bare(omega, 0.290)
    return float(np.linalg.det(whole[2:, 2:]))


def right_end(hertz: float) -> float:
    """The same for the right beam; the mini-beam takes its share of moment and shear at its root."""
    omega, share = 2 * np.pi * hertz, np.eye(4)
    height, added = 0.006 + 0.0135 * 40 / 60, 0.0307 * 40 / 97 + 0.0606 + 0.0543 + 0.0819
    mass = DENSITY * WIDTH * 0.006 + added / 0.040
    clamp = transfer(omega, 0.040, 0.108 * E * WIDTH * height**3 / 12, mass)
    mini = transfer(omega, 0.057, 1.07 * E * 0.040 * 0.001**3 / 12, 0.0307 / 0.097)
    share[2:, :2] = np.linalg.solve(mini[2:, 2:], mini[2:, :2])
    whole = bare(omega, 0.0625, 1.08) @ share @ clamp @ bare(omega, 0.290, 1.08)
    return float(np.linalg.det(whole[2:, 2:]))


def test_frequencies_are_those_of_exact_transfer_matrices():
    """The finite elements and the tie add nothing to what the beam model itself misses (mode 5: 4 %)."""
    for modes, end in zip(both_beams(), (left_end, right_end), strict=True):
        for hertz in modes.frequencies_hz:
            exact = brentq(end, (1 - 1e-4) * hertz, (1 + 1e-4) * hertz, xtol=1e-12 * hertz)
            assert hertz == pytest.approx(exact, rel=2e-6)


def test_tip_values_and_participations():
    """Derived before from the same geometry by another program, to the digits that were kept."""
    left, right = both_beams()
    assert left.phi[:4] == pytest.approx([1.734, 1.550, 1.422, 1.187], abs=6e-4)
    assert left.participation[:4] == pytest.approx([0.849, -0.456, 0.265, -0.192], abs=6e-4)
    assert right.phi[:5] == pytest.approx([1.551, 3.945, 12.01, 0.489, 0.174], abs=6e-3)
    assert right.participation[:5] == pytest.approx([0.944, -0.445, 0.118, -0.259, -0.192], abs=6e-4)


def test_damping_lets_the_lowest_acceleration_just_reach_the_gap():
    """At resonance mode 1 of the right beam alone moves phi Gamma a / (2 zeta omega^2)."""
    rig, (_, right) = Rig(), both_beams()
    driven = rig.at(1.0, LEVELS[0])
    alone = right.phi[0] * right.participation[0] * LEVELS[0] / (2 * rig.first * (2 * np.pi * 28.20) ** 2)
    assert 1.0 + driven.excess == pytest.approx(alone / driven.stop.gap, rel=0.03)
    assert abs(driven.excess) < 0.03


def test_the_mini_beam_as_a_spring_is_as_stiff_as_its_beam():
    """3 E I/l^3 of the 51 mm from root to contact, softened by what the right beam's higher modes give."""
    _, stop = Rig().contact
    inertia = 0.040 * 0.001**3 / 12
    assert 0.8 < stop.law.stiffness / (3 * 1.07 * E * inertia / 0.051**3) < 1.3


def test_response_over_gap_depends_on_acceleration_over_gap():
    driven = Rig().at(1.0, 0.03)
    wide = replace(driven, stop=replace(driven.stop, gap=2 * driven.stop.gap))
    wide = wide.with_amplitude(2 * driven.driven.amplitude)
    few, many = (simulate(x, periods=120) for x in (driven, wide))
    assert len(few.impacts) == len(many.impacts) > 3
    assert many.end.displacement == pytest.approx(2 * few.end.displacement, rel=1e-6, abs=1e-12)


def test_the_detached_curve_is_closed_and_time_steps_stay_on_it():
    """At 0.0305 m/s^2; it is apart from the response, and central differences repeat its stable orbits."""
    rig = Rig()
    response, upper = rig.response(LEVELS[2]), rig.upper(LEVELS[2])
    assert upper.ended_low == upper.ended_high == "closed" and response.ended_high != "closed"
    assert sorted(event.kind for event in upper.events) == ["fold", "fold", "torus"]
    assert max(response.parameters) < min(upper.parameters)
    assert max(abs(harmonic(orbit, "beam")) for orbit in response.orbits) < 1.35 * GAP
    stable = [orbit for orbit in upper.orbits if orbit.stable]
    assert len(stable) >= 10
    for orbit in stable[2::6]:
        driven, start = orbit.oscillator, replace(orbit.strobe_state(), time=0.0)
        method = CentralDifference(step=driven.period / 4000)
        end = simulate(driven, start, periods=300, method=method).end
        unit = np.max(np.abs(start.displacement))
        assert np.max(np.abs(end.displacement - start.displacement)) < 2e-3 * unit


@pytest.mark.slow
def test_more_damping_joins_the_curves():
    damped = Rig(others=0.003)
    assert max(damped.response(LEVELS[2]).parameters) > 1.018
    assert damped.upper(LEVELS[2]).ended_high != "closed"


def test_the_backbone_lags_by_a_quarter_period():
    """A scan upwards at the acceleration of a point on it arrives there; without contact it is resonance."""
    rig = Rig()
    (place, _), (size, _), (level, _) = backbone(rig, np.array([1.004, 1.006]))
    found = carried(rig, [(x, level) for x in (1.0, 1.001, 1.002, 1.003, place)])
    assert found[-1][1] == pytest.approx(size, rel=0.01)
    free = rig.at(1.0, 0.5 * LEVELS[0]).tip_response()
    assert np.angle(free, deg=True) == pytest.approx(-90.0, abs=5.0)
