"""Bars: their exact motions by a second route, their modes and their response against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from contact import State, simulate
from studies.methods.validation import bars
from studies.methods.validation.responses import followed


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
    bars_at = [bars.at_wall(bars.series(200, True), 1.0, rate) for rate in rates]
    found = [abs(bar.tip_response()) * bar.drive.amplitude for bar in bars_at]
    b, static = rates * 0.13 / math.sqrt(210e9 / 7800.0), 25e3 * 0.13 / (210e9 * 15.6e-4)
    np.testing.assert_allclose(found, static * np.abs(np.tan(b) / b), rtol=3e-3)


def test_stability_changes_at_events_only():
    """Twenty modes: two tori, where a pair of multipliers leaves the unit circle and comes back; folds."""
    path = partial(bars.at_wall, bars.elements(20, True), 4.0)
    branch = followed(path, 6.25e4, low=5.8e4, high=7.4e4, step=0.3)
    met = [event.parameter for event in branch.events if event.kind != "grazing"]
    neighbours = list(pairwise(zip(branch.parameters, branch.orbits, strict=True)))
    flips = [sorted((p, q)) for (p, a), (q, b) in neighbours if a.stable != b.stable]
    assert len(flips) >= 3
    last = -1 if branch.orbits[-1].stable else None  # that fold is next to the graze
    for low, high in flips[:last]:
        assert any(low - 100.0 < place < high + 100.0 for place in met)
    tori = [event.orbit for event in branch.events if event.kind == "torus"]
    assert len(tori) == 2
    for orbit in tori:
        assert abs(orbit.multipliers[0]) == pytest.approx(1.0, abs=1e-9) and orbit.multipliers[0].imag != 0.0


@pytest.mark.parametrize("wall", [0.4, pytest.param(4.0, marks=pytest.mark.slow)])
def test_a_raised_frequency_falls_off_where_the_response_turns(wall):
    """Simulated, the state carried along, in steps of 50 rad/s: to the turning frequency."""
    modes = bars.elements(20, True)
    branch = followed(partial(bars.at_wall, modes, wall), 6.25e4, low=5.8e4, high=7.4e4, step=0.3)
    turn = max(event.parameter for event in branch.events if event.kind == "fold")
    rate, state, peaks = 6.25e4, State.rest(20), []
    for rate in np.arange(6.25e4, turn + 300.0, 50.0):
        bar = bars.at_wall(modes, wall, rate)
        run = simulate(bar, replace(state, time=0.0), periods=250)
        state = run.end
        peaks.append(run.impacts.start.size and run.impacts.start[-1] > 200 * bar.period)
    assert not peaks[-1] and all(peaks[: np.argmin(peaks)])
    last = 6.25e4 + 50.0 * (np.argmin(peaks) - 1)
    assert -150.0 < last - turn < 50.0  # a step beyond it may linger
