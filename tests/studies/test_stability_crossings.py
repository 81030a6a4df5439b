"""Crossings that methods miss and impacts that accumulate: theory against what the methods do."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact import Regime, simulate
from contact.integrators import INTEGRATORS, CentralDifference, Exact, GeneralisedAlpha, MoreauJean
from studies.crossings import Swing
from studies.scene import model_of, read_scene
from studies.stability import accumulation
from studies.stability.missed_crossings import (
    OVERSHOOTS,
    RESTITUTION,
    invented,
    of_package,
    of_scipy,
    share_missed,
    share_wrong,
    swing_of,
    tried,
)

SCENE = read_scene("letter")
ONE = swing_of(SCENE)
SIX = Swing.of(model_of(SCENE).truncated(6), ONE.oscillator.stop, 0.2)
PERIOD = 2.0 * math.pi / float(ONE.oscillator.model.omega[0])


@pytest.mark.parametrize("swing", [ONE, SIX], ids=["one mode", "six modes"])
def test_the_crossing_is_where_it_was_put(swing):
    """Closed form against a fine sampling of the motion that the start state makes; one crossing in all."""
    model, gap, lead = swing.oscillator.model, swing.oscillator.stop.gap, float(swing.leads(3)[1])
    for overshoot in (0.1, 1e-3):
        start, time = swing.start(overshoot, lead), np.linspace(0.0, lead + swing.tail, 40_001)
        turn = np.multiply.outer(time, model.omega)
        tip = np.cos(turn) @ (model.phi * start.displacement)
        tip += np.sin(turn) @ (model.phi * start.velocity / model.omega)
        assert tip / gap - 1.0 == pytest.approx(swing.height_at(overshoot, time - lead), abs=1e-12)
        assert np.count_nonzero(np.diff(tip > gap)) == 2
        assert tip.max() / gap - 1.0 == pytest.approx(overshoot, rel=1e-4)


def test_shares_are_those_of_a_parabola_seen_at_a_grid():
    """Grids at 20 000 phases laid over d = D - a t^2/2, against the formulas; a = gap = 1, step 0.1."""
    step, phase = np.array([0.1]), (np.arange(20_000) + 0.5) / 20_000
    grid = step[0] * (phase[:, None] + np.arange(-6, 6))
    for overshoot in (1e-6, 1e-4, 3e-4, 1e-3, 2e-3):
        depth, rate = overshoot - 0.5 * grid**2, -grid
        acts = (depth + 0.5 * step * rate > 0) & (rate - step + RESTITUTION * rate > 0)
        for seen, percussions in ((depth > 0, False), (acts, True)):
            theory = float(share_missed(overshoot, step, 1.0, percussions))
            assert 1 - np.any(seen, axis=1).mean() == pytest.approx(theory, abs=2e-4)
    strikes = of_package(SCENE, MoreauJean, {"step": 0.1 / ONE.pace})
    for part, touches in ((0.98, True), (1.02, False)):
        depth = -part * invented(strikes) - 0.5 * grid**2
        assert np.any((depth - 0.5 * step * grid > 0) & (-grid - step - RESTITUTION * grid > 0)) == touches


@pytest.mark.parametrize("modes", [1, 6])
@pytest.mark.parametrize("name", [name for name, kind in INTEGRATORS.items() if kind.certified])
def test_exact_methods_miss_none_and_invent_none(name, modes):
    trial = of_package(SCENE, INTEGRATORS[name], {})
    if modes == 6:
        trial = replace(trial, swing=SIX)
    for overshoot in (*OVERSHOOTS, *-OVERSHOOTS):
        assert share_wrong(trial, float(overshoot), 6) == 0.0, overshoot


@pytest.mark.parametrize("kind", [GeneralisedAlpha, MoreauJean])
def test_a_grid_misses_what_theory_says(kind):
    trial = of_package(SCENE, kind, {"step": PERIOD / 100})
    for overshoot in (1e-3, 3e-4, 1e-4, 1e-5, 1e-7):
        theory = float(share_missed(overshoot, trial.spacings, ONE.pace, trial.percussions))
        assert share_wrong(trial, overshoot, 200) == pytest.approx(theory, abs=0.02)


def test_central_difference_swings_too_high():
    """By (h omega)^2/8: crossings 0.9 of that below the gap are seen at some phase, at 1.1 of it at none."""
    trial = of_package(SCENE, CentralDifference, {"step": PERIOD / 100})
    assert invented(trial) == pytest.approx((2 * math.pi / 100) ** 2 / 8, rel=1e-9)
    for part, seen in ((0.9, True), (1.1, False)):
        assert (share_wrong(trial, -part * invented(trial), 200) > 0.0) == seen


@pytest.mark.parametrize(("tolerance", "half"), [(1e-8, 1e-2), (1e-12, 1e-3)])
def test_dop853_misses_half_of_all_crossings_of_one_per_cent_of_the_gap(tolerance, half):
    """At 1e-8; at 1e-12 half of those of 0.1 %. Theory from the spacing of its steps."""
    trial = of_scipy(SCENE, "DOP853", tolerance)
    assert 0.3 < float(share_missed(half, trial.spacings, ONE.pace)) < 0.7
    share = {depth: share_wrong(trial, depth, 32) for depth in (10 * half, half, half / 100)}
    assert share[10 * half] == 0.0 and 0.3 < share[half] < 0.8 and share[half / 100] > 0.8


def test_a_solver_finds_a_deep_crossing_where_it_is():
    lead, omega = float(ONE.leads(1)[0]), float(ONE.oscillator.model.omega[0])
    touch = ONE.touch(of_scipy(SCENE, "DOP853", 1e-10).method, 0.2, lead)
    assert touch == pytest.approx(-math.acos(1 / 1.2) / omega, rel=1e-7)


def test_rows_of_methods_without_and_with_looks():
    """An exact method has nothing to report; looks h apart miss half of the crossings of a h^2/(32 gap)."""
    rows, arrays = tried(of_package(SCENE, Exact, {}), 4)
    assert not any(np.any(shares) for shares in arrays.values())
    assert all(row.measured is row.theory is row.refused is None for row in rows)
    trial = of_package(SCENE, GeneralisedAlpha, {"step": PERIOD / 100})
    (half, _invented), arrays = tried(trial, 4)
    assert half.theory == pytest.approx((2 * math.pi / 100) ** 2 / 32, rel=1e-9)
    assert half.refused is False and len(arrays) == 2


# accumulation


@pytest.mark.parametrize("e", [0.3, 0.7, 0.99])
def test_the_ball_rests_when_theory_says_although_its_impacts_have_no_end(e):
    found, impacts = accumulation.time_of_rest(e)
    assert found == pytest.approx(accumulation.rest_time(e), rel=3e-9)
    assert impacts == pytest.approx({0.3: 12, 0.7: 40, 0.99: 1407}[e], abs=3)
    assert accumulation.rest_time(0.7) == pytest.approx(2.55863, abs=5e-6)


def test_a_loop_over_solver_events_falls_through_the_floor_at_the_75th_bounce_where_the_default_lies():
    how, times = accumulation.event_loop(0.7, 1e-6)
    assert how == "falls through" and times.size == pytest.approx(75, abs=2)
    assert 0 < accumulation.rest_time(0.7) - times[-1] < 1e-9
    run = simulate(accumulation.ball(0.7), duration=1.5 * accumulation.rest_time(0.7))
    assert abs(run.end.displacement[0] - 1.0) < 1e-14 and run.end.regime == Regime.SUSTAINED
