"""Planted crossings: their geometry, the shares that theory gives, and what each kind of method sees."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from contact.integrators import INTEGRATORS, CentralDifference, Integrator
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.moreau_jean import MoreauJean
from studies.instruments.peers import HeyokaTaylor, ScipyMethod, available
from studies.instruments.record import Record
from studies.instruments.scene_file import read_scene
from studies.instruments.stability import crossing_trials, missed_crossings
from studies.instruments.stability.crossing_trials import swings, trials
from studies.instruments.stability.missed_crossings import OVERSHOOTS, draw, measure
from studies.instruments.stability.planted_crossings import (
    RESTITUTION,
    Swing,
    half_missed,
    half_missed_by_percussions,
    invented_by_percussions,
    share_missed,
    share_missed_by_percussions,
)

SCENE = read_scene("letter", [])
SWINGS = swings(SCENE)
PERIOD = 2 * math.pi / float(SWINGS["one"].omega[0])


@pytest.mark.parametrize("case", SWINGS)
def test_the_crossing_is_where_it_was_planted(case: str) -> None:
    """Closed form against a fine sampling of the motion that the start state makes."""
    swing = SWINGS[case]
    lead = float(swing.leads(3)[1])
    for overshoot in (0.1, 1e-3):
        start = swing.start(overshoot, lead)
        time = np.linspace(0.0, lead + swing.tail, 400_001)
        tip = np.zeros_like(time)
        for k, omega in enumerate(swing.omega):
            swung = start.displacement[k] * np.cos(omega * time)
            tip += swing.phi[k] * (swung + start.velocity[k] / omega * np.sin(omega * time))
        assert np.ptp(time[tip > swing.gap]) == pytest.approx(
            np.diff(swing.first_crossing(overshoot))[0], abs=3 * time[1]
        )
        ups = np.flatnonzero((tip[:-1] <= swing.gap) & (tip[1:] > swing.gap))
        assert ups.size == 1 and time[ups[0]] - lead == pytest.approx(
            swing.first_crossing(overshoot)[0], abs=2 * time[1]
        )
        assert tip.max() / swing.gap - 1.0 == pytest.approx(overshoot, rel=1e-6)
    width = 2.0 * math.sqrt(2e-8) / swing.pace
    assert np.diff(swing.first_crossing(1e-8))[0] == pytest.approx(width, rel=1e-6)


def test_shares_are_those_of_a_parabola_seen_at_a_grid() -> None:
    """Grids at 20 000 phases laid over d = D - a t^2/2, against the formulas; a = gap = 1, step 0.1."""
    step, phase = 0.1, (np.arange(20_000) + 0.5) / 20_000
    grid = step * (phase[:, None] + np.arange(-6, 6))
    for overshoot in (1e-6, 1e-4, 3e-4, 1e-3, 2e-3):
        depth, rate = overshoot - 0.5 * grid**2, -grid
        seen = np.any(depth > 0, axis=1)
        theory = float(share_missed(overshoot, np.array([step]), 1.0))
        assert 1 - seen.mean() == pytest.approx(theory, abs=2e-4)
        reached = depth + 0.5 * step * rate > 0
        acts = reached & (rate - step + RESTITUTION * rate > 0)
        theory = float(share_missed_by_percussions(overshoot, step, 1.0))
        assert 1 - np.any(acts, axis=1).mean() == pytest.approx(theory, abs=2e-4)
    edge = invented_by_percussions(step, 1.0)
    for undershoot, touches in ((0.98 * edge, True), (1.02 * edge, False)):
        depth, rate = -undershoot - 0.5 * grid**2, -grid
        acts = (depth + 0.5 * step * rate > 0) & (rate - step + RESTITUTION * rate > 0)
        assert np.any(acts) == touches
    spacings = np.array([0.1, 0.1, 0.2])
    assert float(share_missed(half_missed(spacings, 1.0), spacings, 1.0)) == pytest.approx(0.5)
    assert half_missed(np.array([0.1]), 2.0) == pytest.approx(0.04 / 32)
    half = half_missed_by_percussions(0.1, 2.0)
    assert float(share_missed_by_percussions(half, 0.1, 2.0)) == pytest.approx(0.5)


@pytest.mark.parametrize("case", SWINGS)
@pytest.mark.parametrize("name", [name for name, kind in INTEGRATORS.items() if kind.certified])
def test_exact_methods_miss_none_and_invent_none(name: str, case: str) -> None:
    swing, method = SWINGS[case], INTEGRATORS[name]()
    for overshoot in (*OVERSHOOTS, *-OVERSHOOTS):
        verdict = swing.verdict(method, float(overshoot), runs=6, slack=1e-6 / swing.pace)
        assert verdict.wrong == verdict.failed == 0, overshoot


def looks(overshoot: float) -> float:
    return float(share_missed(overshoot, np.array([PERIOD / 100]), 2 * math.pi / PERIOD))


def percussions(overshoot: float) -> float:
    return float(share_missed_by_percussions(overshoot, PERIOD / 100, 2 * math.pi / PERIOD))


@pytest.mark.parametrize(
    "method, theory",
    [(GeneralisedAlpha(step=PERIOD / 100), looks), (MoreauJean(step=PERIOD / 100), percussions)],
)
def test_a_grid_misses_what_theory_says(method: Integrator, theory: Callable[[float], float]) -> None:
    for overshoot in (1e-3, 3e-4, 1e-4, 1e-5, 1e-7):
        share = SWINGS["one"].verdict(method, overshoot, runs=200, slack=PERIOD / 50).share
        assert share == pytest.approx(theory(overshoot), abs=0.02)


def test_central_difference_swings_too_high() -> None:
    """By (h omega)^2/8: crossings 0.9 of that below the gap are seen at some phase, at 1.1 of it at none."""
    method, most = CentralDifference(step=PERIOD / 100), (2 * math.pi / 100) ** 2 / 8
    assert SWINGS["one"].verdict(method, -0.9 * most, runs=200, slack=PERIOD / 50).wrong > 0
    assert SWINGS["one"].verdict(method, -1.1 * most, runs=200, slack=PERIOD / 50).wrong == 0


def test_error_control_looks_away() -> None:
    """DOP853 at 1e-8 passes half of the crossings of 1 % of the gap, at 1e-12 half of those of 0.1 %."""
    swing = SWINGS["one"]

    def missed(tolerance: float, overshoot: float) -> float:
        method = ScipyMethod(solver="DOP853", tolerance=tolerance)
        return swing.verdict(method, overshoot, runs=24, slack=0.2 * PERIOD).share

    assert 0.3 < missed(1e-8, 1e-2) < 0.85 and missed(1e-8, 1e-4) > 0.9
    assert missed(1e-12, 1e-2) == 0.0 and missed(1e-12, 1e-5) > 0.8


@pytest.mark.skipif("heyoka" not in available(), reason="heyoka is not installed")
@pytest.mark.parametrize("case", SWINGS)
def test_roots_of_the_series_are_all_found(case: str) -> None:
    swing, method = SWINGS[case], HeyokaTaylor(tolerance=1e-15)
    for overshoot in (1e-1, 1e-4, 1e-8, 1e-12, -1e-12):
        assert swing.verdict(method, overshoot, runs=12, slack=1e-5 / swing.pace).wrong == 0


def test_every_method_is_tried_and_the_rows_hold_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The study itself, four phases, without the slower outside solvers."""
    monkeypatch.setattr(crossing_trials, "QUICK", ("scipy DOP853",))
    monkeypatch.setattr(missed_crossings, "OVERSHOOTS", 10.0 ** -np.arange(1.0, 10.0, 2.0))
    findings = measure(quick=True, scene=SCENE)
    tried = {trial.label for trial in trials(SWINGS["one"], quick=True)}
    assert {limit.method for limit in findings.limits} == tried and set(INTEGRATORS) <= {
        label.split(",")[0] for label in tried
    }
    by_row = {(limit.method, limit.case): limit for limit in findings.limits}
    for case in ("one mode", "6 modes"):
        for name, kind in INTEGRATORS.items():
            if kind.certified:
                for what in ("half of the crossings missed", "touches invented"):
                    assert by_row[name, f"{what}, {case}"].measured is None
        row = by_row["scipy DOP853", f"half of the crossings missed, {case}"]
        assert row.theory is not None and row.measured is not None and row.refused is False
        assert row.measured == pytest.approx(row.theory, rel=1.0)

    record = Record(study="missed", folder=tmp_path, scene=SCENE, command="")
    draw(findings, record)
    assert set(record.files) == {f"missed_crossings{end}" for end in (".png", ".pdf", "_drawn.csv")}


def test_phases_fill_the_interval_evenly() -> None:
    swing: Swing = SWINGS["one"]
    leads = np.sort(swing.leads(40))
    assert leads[0] >= swing.lead and leads[-1] <= swing.lead + swing.spread
    assert np.diff(leads).max() < 3 * swing.spread / 40
