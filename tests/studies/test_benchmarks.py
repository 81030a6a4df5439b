"""The benchmarks: what they count is what they say; no test here depends on a time."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from contact import StroboscopicMap, simulate
from studies.benchmarks.__main__ import HEADING, SHOWN, cost_table, ratios_of
from studies.benchmarks.cases import Row, carry, error_of, flows_of, heyoka_orbits, in_turns
from studies.peers import missing_solvers
from studies.scene import Scene, beam_at, single_mode_at

README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")
needs_heyoka = pytest.mark.skipif("heyoka" in missing_solvers(), reason="heyoka is not installed")


def test_the_floor_carries_the_modes(letter_scene: Scene) -> None:
    """Ten periods by matrices are ten periods of free motion; sums above the bound are counted."""
    oscillator = beam_at(letter_scene.replace({"modes.count": 8}), 21.5).with_excess(-0.3)
    steady = StroboscopicMap(oscillator=oscillator).steady()
    u, v = np.linspace(1e-6, 1e-7, 8), np.linspace(1e-4, -1e-4, 8)
    moved = type(steady)(displacement=steady.displacement + u, velocity=steady.velocity + v)
    end = simulate(oscillator, moved, periods=10).end
    assert carry(flows_of(oscillator), 0.0, u, v, 10) == 10
    np.testing.assert_allclose(u, end.displacement - steady.displacement, rtol=1e-8, atol=1e-16)
    np.testing.assert_allclose(v, end.velocity - steady.velocity, rtol=1e-8, atol=1e-13)
    assert carry(flows_of(oscillator), 1e9, u, v, 10) == 0


def test_runs_are_timed_in_turns() -> None:
    order: list[str] = []
    spent = in_turns({name: (lambda _periods, name=name: order.append(name), 5) for name in "ab"}, 3)
    assert order == ["a", "b"] * 4 and set(spent) == {"a", "b"} and min(spent.values()) >= 0.0


@needs_heyoka
def test_bare_heyoka_is_on_the_same_orbit(letter_scene: Scene) -> None:
    """It reaches the p5 of the package, alone and in a batch: it is a peer, not a straw man."""
    oscillator = single_mode_at(letter_scene, 22.2).with_excess(0.02)
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = strobed.orbit(strobed.steady(), 2000).end
    cycle = strobed.tip(strobed.orbit(settled, 5).points)
    single, taylor = heyoka_orbits([oscillator])
    batch, batched = heyoka_orbits([oscillator, oscillator.with_excess(0.0201)])
    single(2000)
    batch(2000)
    for theirs in (taylor.state[0], batched.state[0, 0]):
        assert np.min(np.abs(cycle - theirs * oscillator.model.phi[0])) < 1e-8 * oscillator.stop.gap


@needs_heyoka
def test_error_of_heyoka_falls_with_its_tolerance(letter_scene: Scene) -> None:
    oscillator = beam_at(letter_scene.replace({"modes.count": 4}), 21.5).with_excess(0.013)
    coarse, fine = error_of(oscillator, 1e-5), error_of(oscillator, 1e-9)
    assert 1e-13 < fine < 1e-3 * coarse < 1e-6


def beam(tool: str, modes: int, microseconds: float, **more: float) -> Row:
    """A row of the beam with Hertz contact."""
    fields = {"excess": 0.013, "frequency_hz": 21.5, "modes": modes, "us_per_period": microseconds, **more}
    return Row(case="beam, hertz contact", tool=tool, **fields)  # type: ignore[arg-type]


def test_table_and_ratios_are_those_of_the_rows() -> None:
    """Medians over frequencies; growth from 8 to 32 modes."""
    times = {"grazing-spring": (0.03, 0.05, 0.9), "floor": (0.01, 0.01, 0.01), "heyoka": (3.0, 4.0, 27.0)}
    single = [
        Row(case="single mode", tool=tool, modes=1, excess=0.02, frequency_hz=f, us_per_period=cost)
        for tool, costs in times.items()
        for f, cost in zip((20.9, 21.5, 22.2), costs, strict=True)
    ]
    rows = [
        *single,
        beam("grazing-spring", 8, 12.3, us_per_collision=45.6), beam("grazing-spring", 32, 24.6),
        beam("floor", 8, 0.1), beam("floor", 32, 0.4), beam("heyoka", 8, 2345.0, tolerance=1e-7, error=2e-9),
    ]  # fmt: skip
    heading, _rule, first, eight = cost_table(rows)
    assert heading == HEADING
    assert [cell.strip() for cell in first.split("|")[2:7]] == ["1", "50 ns", "-", "10 ns", "4 us"]
    assert eight.split(" | ")[1:] == ["8", "12 us", "46 us", "100 ns", "2.3 ms", "2e-09 |"]
    assert ratios_of(rows) == pytest.approx({
        "single_mode_least": 30.0, "single_mode_median": 80.0, "single_mode_largest": 100.0,
        "hertz_growth_with_modes": 0.5,
    })  # fmt: skip


def test_the_readme_shows_the_cases_of_the_table() -> None:
    """Its times are of one machine; its rows are the program's."""
    (block,) = re.findall(rf"^{re.escape(HEADING)}\n(.*?)\n\n", README, flags=re.MULTILINE | re.DOTALL)
    shown = [tuple(cell.strip() for cell in line.split("|")[1:3]) for line in block.splitlines()[1:]]
    assert shown == [(words, str(modes)) for _case, words, counts in SHOWN for modes in counts]
