"""Published numbers: the study, and each source by another route."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from contact import (
    LinearContact,
    NewtonRestitution,
    NotPeriodic,
    State,
    Stop,
    StroboscopicMap,
    orbits,
    simulate,
)
from studies.methods.validation import __main__ as program
from studies.methods.validation import bars
from studies.methods.validation.one_mode import PUBLISHED, SPEEDS, bifurcation, driven
from studies.methods.validation.printed import compared
from studies.methods.validation.two_beams import both_beams


@pytest.mark.parametrize(("ours", "verdict"), [(1.05, "agrees"), (0.85, "differs"), (1.0, "agrees")])
def test_verdicts(ours, verdict):
    assert compared("a", "b", 1.0, ours, 0.1).verdict == verdict


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
    assert wrong == ["f at 0.00650108 J [Hz]", "right, mode 5 [Hz]"]
    assert [row["verdict"] for row in ran.rows("rows")] == [row["verdict"] for row in ran.summary["rows"]]


def closed_form(w: mp.mpf, doubling: bool) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """F/F_g, impact speed and determinant of Ghosh and Simpson's p2 at its fold or doubling.

    Before the impact the deviation from steady motion is s v, and the steady velocity b w v; the trace of
    flow times saltation matrix [[-e, 0], [(1 + e) (force - x)/v, -e]] is linear in 1/v.
    """
    c, e, time = mp.mpf("0.04"), mp.mpf("0.9"), 4 * mp.pi / w
    wd, decay = mp.sqrt(1 - c * c / 4), mp.exp(-c * time / 2)
    sine, cosine = decay * mp.sin(wd * time) / wd, decay * mp.cos(wd * time)
    distance = 1 - 2 * cosine + decay**2
    s = -(1 + e) * sine / distance
    b = (1 + (1 + e) * (cosine - c / 2 * sine - decay**2) / distance) / w
    v = s / (s * s + b * b)
    if doubling:
        rest = (1 + (e * decay) ** 2 - 2 * e * cosine) / (sine * (1 + e))
        v = w * w / (rest - (1 - w * w) * s + c * b * w)
    return mp.sqrt((1 - s * v) ** 2 + (b * v) ** 2), v, (e * decay) ** 2


@pytest.mark.parametrize("w", PUBLISHED)
def test_bifurcations_of_ghosh_and_simpson_in_50_digits(w: float) -> None:
    """Place, speed, multipliers and slope over w, located and differentiated, against the closed form."""
    doubling, orbit = w in SPEEDS, bifurcation(w)
    with mp.workdps(50):
        level, speed, determinant = closed_form(mp.mpf(w), doubling)
        slope = mp.diff(lambda x: closed_form(x, doubling)[0], mp.mpf(w))
    rates = orbits.doubling_derivatives if doubling else orbits.excess_derivatives
    assert orbit.excess == pytest.approx(float(level - 1), abs=1e-12 if doubling else 2e-15)
    assert orbit.speed == pytest.approx(float(speed), rel=2e-11)
    assert np.prod(orbit.multipliers).real == pytest.approx(float(determinant), rel=1e-14)
    assert orbit.multipliers[0].real == pytest.approx(-1.0 if doubling else 1.0, abs=1e-11)
    assert rates(orbit, [orbits.Change(frequency=0.5 / math.pi)])[0] == pytest.approx(float(slope), rel=1e-10)


def test_folds_touch_grazing_quadratically() -> None:
    """Distance below grazing over squared distance in w tends to half the closed form's second derivative."""
    with mp.workdps(50):
        resonance = mp.mpf("0.8") * mp.sqrt(1 - mp.mpf("0.02") ** 2)
        constant = float(mp.diff(lambda x: closed_form(x, False)[0], resonance, 2) / 2)
    steps = np.array([4e-4, 2e-4, 1e-4])
    found = np.array([bifurcation(float(resonance) - step).excess for step in steps]) / steps**2
    assert (8 * found[2] - 6 * found[1] + found[0]) / 3 == pytest.approx(constant, rel=1e-6)


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


class LatticeBar:
    """d'Alembert with dx = dt = h, L = T = 1: u_j(t + h) + u_j(t - h) = u_(j+1) + u_(j-1); `force` is F/J
    on the end j = 0."""

    def __init__(self, cells: int, *, speed: float, held: bool = False) -> None:
        self.h, self.held = 1.0 / cells, held
        self.now = np.zeros(cells + 1)
        self.before = self.now - speed * self.h

    def advance(self, force: float = 0.0) -> float:
        """Place of the end after a step."""
        around = np.concatenate([[self.now[1]], self.now, [self.now[-2]]])
        after = around[2:] + around[:-2] - self.before
        after[0] = after[0] + 2.0 * force * self.h
        if self.held:
            after[-1] = 0.0
        self.before, self.now = self.now, after
        return float(after[0])


def test_two_bars_with_a_spring_between_are_the_motion_of_two_lattices():
    lag, errors = 0.01, []
    for cells in (500, 1000, 2000):
        first, second = LatticeBar(cells, speed=-1.0), LatticeBar(cells, speed=0.0, held=True)
        place, depth = [0.0], [0.0, 0.0]
        for _ in range(6 * cells):
            push = max(depth[-2], 0.0) / (2.0 * lag)  # of a step before: two halves would not decay together
            place.append(first.advance(push))
            depth.append(second.advance(-push) - place[-1])
        exact = bars.met(np.arange(6 * cells + 1) / cells, 1.0, lag)
        errors.append(np.abs(place - exact).max())
    np.testing.assert_allclose(np.array(errors[:-1]) / errors[1:], 2.0, atol=0.3)
    assert errors[-1] < 3e-4


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
