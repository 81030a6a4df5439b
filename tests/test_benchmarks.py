"""The benchmarks: what they count is what they say; no test here depends on a time."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.flight.modal_flow import propagate
from contact.stroboscope import StroboscopicMap
from studies import benchmarks
from studies.instruments.benchmarks.bare_heyoka import batch_of, orbit_of
from studies.instruments.benchmarks.beam import slope_of
from studies.instruments.benchmarks.cost_table import HEADING, SHOWN, cost_table, seconds_told
from studies.instruments.benchmarks.floor import carry, flows_of
from studies.instruments.benchmarks.timing import in_turns
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.peers import available
from studies.instruments.scene_file import read_scene

SCENE = read_scene()
README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def test_the_floor_carries_the_modes() -> None:
    """Ten periods by matrices are ten periods in closed form; sums above the bound are counted."""
    oscillator = beam_of(SCENE, 21.5)
    motion, n = oscillator.motion(), oscillator.n_modes
    u, v = np.linspace(1e-3, 1e-4, n), np.linspace(0.1, -0.1, n)
    there, rate = u.copy(), v.copy()
    propagate(motion, u, v, 10 * motion.period, there, rate)
    assert carry(flows_of(oscillator), np.ones(n), 0.0, u, v, 10) == 10
    np.testing.assert_allclose(u, there, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(v, rate, rtol=1e-9, atol=1e-12)
    assert carry(flows_of(oscillator), np.ones(n), 1e9, u, v, 10) == 0


def test_runs_are_timed_in_turns() -> None:
    order: list[str] = []
    runs = {name: (lambda name=name: order.append(name)) for name in "ab"}
    spent = in_turns(runs, 3)
    assert order == ["a", "b"] * 4 and set(spent) == {"a", "b"} and min(spent.values()) >= 0.0


def test_growth_with_modes() -> None:
    assert slope_of([1, 10, 20], [5.0, 3.0, 6.0]) == pytest.approx(1.0)


@pytest.mark.skipif("heyoka" not in available(), reason="heyoka is not installed")
def test_bare_heyoka_is_on_the_same_orbit(monkeypatch: pytest.MonkeyPatch) -> None:
    """It finds as many impacts as the package on p5: it is a peer, not a straw man."""
    import heyoka as hy

    found: list[object] = []
    adaptive, batch = hy.taylor_adaptive, hy.taylor_adaptive_batch


    def kept(make: Any) -> Any:
        return lambda *a, **k: found.append(make(*a, **k)) or found[-1]

    monkeypatch.setattr(hy, "taylor_adaptive", kept(adaptive))
    monkeypatch.setattr(hy, "taylor_adaptive_batch", kept(batch))
    oscillator = single_mode_oscillator(SCENE, 22.2).with_excess(0.02)
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = strobed.orbit(strobed.steady(), 2000).end
    cycle = np.sort(strobed.orbit(settled, 5).points[:, 0])
    orbit_of(oscillator)(2000)
    theirs = found[-1].state[0] * oscillator.model.phi[0]  # type: ignore[attr-defined]
    assert np.min(np.abs(cycle - theirs)) < 1e-8 * oscillator.stop.gap
    batch_of([oscillator, oscillator.with_excess(0.0201)])(2000)
    lanes = found[-1].state[0] * oscillator.model.phi[0]  # type: ignore[attr-defined]
    assert np.min(np.abs(cycle - lanes[0])) < 1e-8 * oscillator.stop.gap


def test_the_study_gives_rows_and_ratios(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--quick", "--json", "--out", str(tmp_path)]
    assert benchmarks.main([*arguments, *(["--peers"] if "heyoka" in available() else [])]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {"schema", "rows", "ratios", "first_call"} <= answer.keys()
    for row in answer["rows"]:
        assert {"case", "tool", "modes", "us_per_period", "error", "missed"} <= row.keys()
        assert row["us_per_period"] > 0
    beam = [r for r in answer["rows"] if r["case"] == "beam, hertz contact" and r["modes"] == 8]
    mine = next(row for row in beam if row["tool"] == "grazing-spring")
    assert mine["error"] < 1e-10 and mine["missed"] == 0.0
    assert answer["ratios"]["single_mode_over_floor"] > 0
    assert (tmp_path / "benchmarks" / "costs.png").exists()
    table = (tmp_path / "benchmarks" / "costs.md").read_text(encoding="utf-8")
    assert seconds_told(mine["us_per_period"]) in table and HEADING in README


def test_the_table_of_costs_is_that_of_the_rows() -> None:
    """Medians over frequencies; a row at another excess or tolerance stays out."""
    blank = {"error": None, "missed": None, "us_per_collision": None, "tolerance": None}
    one = {**blank, "case": "single mode", "tool": "grazing-spring", "modes": 1, "excess": 0.02}
    single = [{**one, "us_per_period": t} for t in (0.03, 0.05, 0.9)]
    beam = {**blank, "case": "beam, hertz contact", "modes": 8}
    rows = [
        *single,
        {**beam, "tool": "grazing-spring", "us_per_period": 12.3, "us_per_collision": 45.6, "excess": 0.013},
        {**beam, "tool": "grazing-spring", "us_per_period": 99.0, "excess": 0.1},
        {**beam, "tool": "heyoka", "us_per_period": 2345.0, "excess": 0.013, "tolerance": 1e-7}
        | {"error": 2e-9},
        {**beam, "tool": "heyoka", "us_per_period": 1.0, "excess": 0.013, "tolerance": 1e-4},
    ]
    heading, _rule, first, eight = cost_table(rows, 0.013, 1e-7)
    assert heading == HEADING
    assert [cell.strip() for cell in first.split("|")[2:5]] == ["1", "50 ns", "-"]
    assert [cell.strip() for cell in eight.split("|")[2:8]] == ["8", "12 us", "46 us", "-", "2.3 ms", "2e-09"]


def test_the_readme_shows_the_cases_of_the_table() -> None:
    """Its times are of one machine; its rows are the program's."""
    (block,) = re.findall(rf"^{re.escape(HEADING)}\n(.*?)\n\n", README, flags=re.MULTILINE | re.DOTALL)
    shown = [tuple(cell.strip() for cell in line.split("|")[1:3]) for line in block.splitlines()[1:]]
    assert shown == [(words, str(modes)) for _case, words, ladder in SHOWN for modes in ladder]
