"""Crossings that methods miss and impacts that accumulate: theory against what the methods do."""

import math
from dataclasses import replace

import numpy as np
import pytest

from contact import Regime, simulate
from contact.integrators import INTEGRATORS, CentralDifference, Exact, GeneralisedAlpha, MoreauJean
from studies.methods.crossings import Crossing
from studies.methods.stability import accumulation, missed_crossings
from studies.methods.stability.missed_crossings import OVERSHOOTS, invented, of_package, share_wrong, tried
from studies.shell.scene import model_of, read_scene

SCENE = read_scene("letter")
ONE = missed_crossings.crossing_of(SCENE)
SIX = Crossing.of(model_of(SCENE).truncated(6), ONE.oscillator.stop, 0.2)
PERIOD = 2.0 * math.pi / float(ONE.oscillator.model.omega[0])


@pytest.mark.parametrize("crossing", [ONE, SIX], ids=["one mode", "six modes"])
def test_the_crossing_is_where_it_was_put(crossing):
    """Closed form against a fine sampling of the motion that the start state makes; one crossing in all."""
    model, gap, lead = crossing.oscillator.model, crossing.oscillator.stop.gap, float(crossing.leads(3)[1])
    for overshoot in (0.1, 1e-3):
        start, time = crossing.start(overshoot, lead), np.linspace(0.0, lead + crossing.tail, 40_001)
        turn = np.multiply.outer(time, model.omega)
        tip = np.cos(turn) @ (model.phi * start.displacement)
        tip += np.sin(turn) @ (model.phi * start.velocity / model.omega)
        assert tip / gap - 1.0 == pytest.approx(crossing.height_at(overshoot, time - lead), abs=1e-12)
        assert np.count_nonzero(np.diff(tip > gap)) == 2
        assert tip.max() / gap - 1.0 == pytest.approx(overshoot, rel=1e-4)


@pytest.mark.parametrize("modes", [1, 6])
@pytest.mark.parametrize("name", [name for name, kind in INTEGRATORS.items() if kind.certified])
def test_exact_methods_miss_none_and_invent_none(name, modes):
    trial = of_package(SCENE, INTEGRATORS[name], {})
    if modes == 6:
        trial = replace(trial, crossing=SIX)
    for overshoot in (*OVERSHOOTS, *-OVERSHOOTS):
        assert share_wrong(trial, float(overshoot), 6) == 0.0, overshoot


@pytest.mark.parametrize("kind", [GeneralisedAlpha, MoreauJean])
def test_a_grid_misses_what_theory_says(kind):
    trial = of_package(SCENE, kind, {"step": PERIOD / 100})
    for overshoot in (1e-3, 3e-4, 1e-4, 1e-5, 1e-7):
        theory = float(missed_crossings.share_missed(overshoot, trial.step, ONE.rate, trial.percussions))
        assert share_wrong(trial, overshoot, 200) == pytest.approx(theory, abs=0.02)


@pytest.mark.parametrize("kind", [CentralDifference, MoreauJean])
def test_a_touch_is_invented_as_far_below_the_stop_as_theory_says(kind):
    """At 0.9 of that undershoot at some phase, at 1.1 of it at none."""
    trial = of_package(SCENE, kind, {"step": PERIOD / 100})
    for part, seen in ((0.9, True), (1.1, False)):
        assert (share_wrong(trial, -part * invented(trial), 200) > 0.0) == seen


def test_dop853_misses_half_of_all_crossings_of_one_per_cent_of_the_gap():
    """At 1e-8; nearly all of those that are a hundred times shallower."""
    trial = missed_crossings.of_scipy(SCENE, "DOP853", 1e-8)
    share = {depth: share_wrong(trial, depth, 32) for depth in (1e-1, 1e-2, 1e-4)}
    assert share[1e-1] == 0.0 and 0.3 < share[1e-2] < 0.8 and share[1e-4] > 0.8


def test_rows_of_methods_without_and_with_looks():
    """An exact method has nothing to report; looks h apart miss half of the crossings of a h^2/(32 gap)."""
    rows, arrays = tried(of_package(SCENE, Exact, {}), 4)
    assert not any(np.any(shares) for shares in arrays.values())
    assert all(row.measured is row.theory is row.refused is None for row in rows)
    trial = of_package(SCENE, GeneralisedAlpha, {"step": PERIOD / 100})
    (half, _invented), arrays = tried(trial, 4)
    assert half.theory == pytest.approx((2 * math.pi / 100) ** 2 / 32, rel=1e-9)
    assert half.refused is False and len(arrays) == 2


@pytest.mark.parametrize("e", [0.3, 0.7, 0.99])
def test_the_ball_rests_when_theory_says_although_its_impacts_have_no_end(e):
    found, impacts = accumulation.time_of_rest(e)
    assert found == pytest.approx(accumulation.rest_time(e), rel=3e-9)
    assert impacts == pytest.approx({0.3: 12, 0.7: 40, 0.99: 1441}[e], abs=3)
    assert accumulation.rest_time(0.7) == pytest.approx(2.55863, abs=5e-6)


def test_a_loop_over_solver_events_falls_through_the_floor_at_the_75th_bounce_where_the_default_lies():
    how, times = accumulation.event_loop(0.7, 1e-6)
    assert how == "falls through" and times.size == pytest.approx(75, abs=2)
    assert 0 < accumulation.rest_time(0.7) - times[-1] < 1e-9
    run = simulate(accumulation.ball(0.7), duration=1.5 * accumulation.rest_time(0.7))
    assert abs(run.end.displacement[0] - 1.0) < 1e-14 and run.end.regime == Regime.SUSTAINED
