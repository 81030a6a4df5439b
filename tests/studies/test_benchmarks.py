"""The benchmarks: what they count is what they say; no test here depends on a time."""

from __future__ import annotations

import numpy as np
import pytest

from contact import StroboscopicMap
from studies.methods.benchmarks import BEAM, HEYOKA, OURS, SINGLE, Row, heyoka_orbit, in_turns, ratios_of
from studies.methods.peers import missing_solvers
from studies.shell.scene import Scene, single_mode_at

needs_heyoka = pytest.mark.skipif("heyoka" in missing_solvers(), reason="heyoka is not installed")


def test_runs_are_timed_in_turns() -> None:
    order: list[str] = []
    spent = in_turns({name: (lambda _periods, name=name: order.append(name), 5) for name in "ab"}, 3)
    assert order == ["a", "b"] * 4 and set(spent) == {"a", "b"} and min(spent.values()) >= 0.0


@needs_heyoka
def test_bare_heyoka_is_on_the_same_orbit(letter_scene: Scene) -> None:
    """It reaches the p5 of the package: it is a peer, not a straw man."""
    oscillator = single_mode_at(letter_scene, 22.2).with_excess(0.02)
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = strobed.orbit(strobed.steady(), 2000).end
    cycle = strobed.tip(strobed.orbit(settled, 5).points)
    orbit, taylor = heyoka_orbit(oscillator)
    orbit(2000)
    assert np.min(np.abs(cycle - taylor.state[0] * oscillator.model.phi[0])) < 1e-8 * oscillator.stop.gap


def test_ratios_are_those_of_the_rows() -> None:
    """heyoka over ours at each frequency; growth of the touching beam from 8 to 32 modes."""
    times = {OURS: (0.03, 0.05, 0.9), HEYOKA: (3.0, 4.0, 27.0)}
    rows = [
        Row(case=SINGLE, tool=tool, modes=1, excess=0.02, frequency_hz=f, us_per_period=cost)
        for tool, costs in times.items()
        for f, cost in zip((20.9, 21.5, 22.2), costs, strict=True)
    ]
    beam = Row(case=BEAM, tool=OURS, modes=8, excess=0.013, frequency_hz=21.5, us_per_period=12.3)
    for changed in (
        {},
        {"modes": 32, "us_per_period": 24.6},
        {"tool": HEYOKA, "us_per_period": 2345.0},
        {"case": "beam, no touch", "modes": 64},
    ):
        rows.append(Row(**{**vars(beam), **changed}))
    assert ratios_of(rows) == pytest.approx(
        {
            "single_mode_least": 30.0,
            "single_mode_median": 80.0,
            "single_mode_largest": 100.0,
            "hertz_growth_with_modes": 0.5,
        }
    )
