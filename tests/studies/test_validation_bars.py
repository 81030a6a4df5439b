"""Bars: their exact motions by a second route, their modes and their response against closed forms."""

from __future__ import annotations

import math
import types
from dataclasses import replace

import numpy as np
import pytest

from beam import ModalModel
from contact import ContactError, HarmonicDrive, ImpactOscillator, LinearContact, State, Stop, simulate
from contact.orbits import Shooting
from studies.validation import bars

QUIET = types.SimpleNamespace(quick=True, track=lambda items, label: items, failed=pytest.fail)


@pytest.mark.parametrize("held", [False, True])
def test_linear_elements_tend_to_the_exact_modes_from_above_with_the_square_of_their_length(held):
    """omega (1 + (omega h)^2/24 + ...), and end values alike."""
    found = np.array([np.array(bars.elements(n, held))[:, :4] for n in (20, 40, 80)])
    off = found - np.array(bars.series(4, held))
    moving = slice(0 if held else 1, None)
    assert np.all(off[:, 0, moving] > 0.0) and np.all(found[:, 0, : moving.start] == 0.0)
    ratio = off[:-1, :, moving] / off[1:, :, moving]
    np.testing.assert_allclose(ratio, 4.0, atol=0.15)
    omega = bars.series(4, held)[0][moving]
    np.testing.assert_allclose(off[2, 0, moving], omega**3 / 24 / 80**2, rtol=0.01)


class LatticeBar:
    """d'Alembert with dx = dt = h, L = T = 1: u_j(t + h) + u_j(t - h) = u_(j+1) + u_(j-1); `pull` accelerates
    all points, `force` is F/J on the end j = 0."""

    def __init__(self, cells: int, *, speed: float, pull: float = 0.0, held: bool = False) -> None:
        self.h, self.held, self.pull = 1.0 / cells, held, pull / cells**2
        self.now = np.zeros(cells + 1)
        self.before = self.now - speed * self.h + 0.5 * self.pull

    def advance(self, force: float = 0.0, floor: float = -math.inf) -> float:
        """Place of the end after a step that may not bring it below `floor`."""
        around = np.concatenate([[self.now[1]], self.now, [self.now[-2]]])
        after = around[2:] + around[:-2] - self.before + self.pull
        after[0] = max(after[0] + 2.0 * force * self.h, floor)
        if self.held:
            after[-1] = 0.0
        self.before, self.now = self.now, after
        return float(after[0])


def test_characteristics_of_the_bouncing_bar_are_the_motion_of_a_lattice():
    errors, transits = [], 32
    for cells in (120, 480):
        bar = LatticeBar(cells, speed=0.0, pull=-bars.GRAVITY * bars.TRANSIT**2)
        found = bars.FALL + np.array([0.0, *(bar.advance(floor=-bars.FALL) for _ in range(transits * cells))])
        errors.append(np.abs(found[:: cells // bars.STEPS] - bars.lower_end(transits)).max())
    assert max(errors) < 1e-7


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


def test_off_the_wall_the_bar_answers_as_a_bar():
    """F L/(E A) tan(b)/b with b = omega T, far from resonance; damping changes it by 1e-3."""
    rates = np.array([5.0e4, 5.6e4, 7.2e4, 8.0e4])
    found = bars.scan(QUIET, bars.series(200, True), 1.0, rates, 400)
    b, static = rates * 0.13 / math.sqrt(210e9 / 7800.0), 25e3 * 0.13 / (210e9 * 15.6e-4)
    np.testing.assert_allclose(found, static * np.abs(np.tan(b) / b) / 2e-4, rtol=3e-3)


@pytest.mark.parametrize(("wall", "start"), [(4.0, 63500), (20.0, 64400)])
def test_the_peak_of_a_scan_is_where_the_orbits_fold(wall, start):
    """Orbits by shooting, upwards in frequency until the multiplier comes to 1; a scan falls off earlier."""
    wave, mass, modes = math.sqrt(210e9 / 7800.0) / 0.13, 7800.0 * 15.6e-4 * 0.13, bars.elements(20, True)
    omega, phi = wave * modes[0], modes[1] / math.sqrt(mass)
    model = ModalModel(omega=omega, decay_rate=2 * 0.0075 * omega, phi=phi, participation=phi)
    stop = Stop(gap=2e-4, law=LinearContact(stiffness=wall * 210e9 * 15.6e-4 / 0.13))

    def at(rate: float) -> Shooting:
        drive = HarmonicDrive(frequency=rate / math.tau, amplitude=25e3 / rate**2)
        bar = ImpactOscillator(model=model, stop=stop, drive=drive)
        return Shooting(oscillator=bar, period=1, impacts=1)

    rate, step, settled = float(start), 20.0, State.rest(20)
    for here in range(62000, start + 1, 50):
        settled = replace(simulate(at(here).oscillator, settled, periods=300).end, time=0.0)
    orbit = at(rate).from_state(settled)
    while step > 0.05:
        try:
            orbit = at(rate + step).at_excess(at(rate + step).oscillator.excess, orbit)
            rate += step
        except ContactError:
            step *= 0.5
    rates = np.arange(6.2e4, 7.0e4, 50.0)
    peak = rates[np.argmax(bars.scan(QUIET, modes, wall, rates, 250))]
    assert abs(orbit.multipliers[0] - 1.0) < 5e-3 and 0.0 < rate - peak < 150.0
