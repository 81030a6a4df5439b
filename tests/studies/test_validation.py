"""Published numbers: the study, and each source by another route."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from contact import LinearContact, NewtonRestitution, NotPeriodic, State, Stop, StroboscopicMap, simulate
from studies.methods.validation import __main__ as program
from studies.methods.validation.model import both_beams, driven


def test_every_source_is_compared_and_one_that_fails_is_a_failed_row(run_study, monkeypatch):
    def lost():
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail="as a test has it")

    monkeypatch.setattr(program, "SOURCES", {"lost": lost, **program.SOURCES})
    ran = run_study("validation", "--quick")
    assert ran.code == 3 and "as a test has it" in ran.summary["failures"][0]
    assert {each["source"]: each["agrees"] for each in ran.summary["sources"]} == {
        "Ghosh and Simpson": 21,
        "COCO 15.2": 1,
        "SDND122": 0,
        "Aberdeen rig": 1,
        "SDNL111": 5,
        "Woiwode and Krack 2024": 8,
    }
    wrong = [row["quantity"] for row in ran.summary["rows"] if row["verdict"] == "differs"]
    assert "but 2 agree" in ran.summary["findings"][0]
    assert wrong == ["frequency at 0.00650108 J", "right beam, mode 5"]
    assert [row["verdict"] for row in ran.rows("rows")] == [row["verdict"] for row in ran.summary["rows"]]
    (free,) = [row for row in ran.summary["rows"] if row["source"] == "SDND122"]
    assert f"closed form {free['ours']:.9f} Hz" in free["note"]


@pytest.mark.parametrize("w", [1.0, 0.7, 0.3])
def test_grazing_of_coco_is_where_simulated_motions_begin_to_touch(w: float) -> None:
    """Steady motion 1e-12 below and above."""
    stop = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.8))
    for excess in (-1e-12, 1e-12):
        strobed = StroboscopicMap(oscillator=driven(w, 0.1, stop)).at(excess)
        assert len(simulate(strobed.oscillator, strobed.steady(), periods=1).impacts) == (excess > 0)


@pytest.mark.parametrize("e", [0.6, 6.50108, 1e3])
def test_free_oscillation_against_a_spring_by_quadrature(e: float) -> None:
    """Half periods as integrals of dx/speed, x = turning point -+ s^2."""
    free = replace(driven(0.5, 0.0, Stop(gap=1.0, law=LinearContact(stiffness=5.0))), drive=None)
    far, root = mp.sqrt(2 * mp.mpf(e)), mp.sqrt(12 * mp.mpf(e) - 5)  # turning points -far, (5 + root)/6
    off = mp.quad(lambda s: 2 / mp.sqrt(2 * far - s * s), [0, mp.sqrt(far + 1)])
    on = mp.quad(lambda s: 2 / mp.sqrt(2 * root - 6 * s * s), [0, mp.sqrt((root - 1) / 6)])
    start = State(displacement=np.array([-math.sqrt(2 * e)]), velocity=np.zeros(1))
    period = np.diff(simulate(free, start, duration=15.0).impacts.start)[0]
    assert period == pytest.approx(float(2 * (off + on)), rel=1e-14)


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
