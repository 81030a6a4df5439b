"""The chart: cells against closed forms, the store behind it, and a figure that can be told apart."""

from __future__ import annotations

import json

import numpy as np
import pytest

from contact.orbits.ends import orbit_end
from contact.orbits.settling import settle
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from studies import chart
from studies.instruments.chart.cells import Cells, fold_agreement
from studies.instruments.chart.figure import colour_of_impacts, colour_of_period, draw
from studies.instruments.chart.overlays import bands_in, folds_of_beam, folds_of_single_mode
from studies.instruments.chart.plane import KNEE, Plane
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.record import Record
from studies.instruments.scene_file import read_scene

SMALL = ("--points", "3", "60", "--frequencies", "20.9", "22.2", "--excesses", "-0.02", "0.01")


def study(folder, capsys, *argv, code: int = 0):
    assert chart.main([*SMALL, *argv, "--out", str(folder), "--json"]) == code
    return json.loads(capsys.readouterr().out)


def arrays(folder):
    return dict(np.load(folder / "chart" / "chart_single_mode.npz"))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    assert chart.main([*SMALL, "--out", str(folder)]) == 0
    return folder


def test_upwards_nothing_is_touched_before_grazing_and_p_m_is_born_there(whole):
    found = arrays(whole)
    up = {name: found[name][0] for name in ("period", "impacts", "cycles")}
    below, born = found["excess"] < -1e-9, np.searchsorted(found["excess"], 1e-3)
    assert np.all(up["period"][:, below] == 1) and np.all(up["impacts"][:, below] == 0)
    assert np.all(up["cycles"][:, below] == 0)
    assert up["period"][:, born].tolist() == [3, 4, 5] and up["impacts"][:, born].tolist() == [1, 1, 1]


def test_downwards_p_m_ends_in_the_step_that_holds_the_closed_form_of_its_fold(whole):
    found, scene = arrays(whole), read_scene()
    for k, (frequency, period) in enumerate(zip(found["frequency_hz"], (3, 4, 5), strict=True)):
        oscillator = single_mode_oscillator(scene, float(frequency))
        fold = MaximalFamily.from_oscillator(oscillator, period=period).fold()
        on = (found["period"][1, k] == period) & (found["impacts"][1, k] == 1)
        lowest = int(np.flatnonzero(on)[0])
        assert found["excess"][lowest - 1] < fold.excess <= found["excess"][lowest]
        # next below a fold impacts can go on for thousands of periods, longer than the bound
        assert np.all(found["impacts"][1, k, : lowest // 2] == 0)
    summary = json.loads((whole / "chart" / "summary.json").read_text())
    assert summary["folds_seen"] == summary["folds_met"] == 3
    assert summary["failed_cells"] == 0 and summary["cells"] == 360


def test_a_shifted_fold_would_be_noticed(whole):
    found = arrays(whole)
    cells = Cells(frequencies=found["frequency_hz"], excesses=found["excess"], period=found["period"],
                  impacts=found["impacts"], cycles=found["cycles"])  # fmt: skip
    oscillator = single_mode_oscillator(read_scene(), 22.2)
    folds = folds_of_single_mode(oscillator, cells.frequencies, -0.02)
    mine = [fold for fold in folds if (round(fold["frequency_hz"], 2), fold["period"]) in
            ((20.9, 3), (21.55, 4), (22.2, 5))]  # fmt: skip
    assert fold_agreement(cells, mine) == (3, 3)
    shifted = [{**fold, "excess": 0.7 * fold["excess"]} for fold in mine]
    assert fold_agreement(cells, shifted)[0] == 0


def test_the_same_command_goes_on_and_another_scene_is_refused(whole, capsys, monkeypatch):
    monkeypatch.setattr(Record, "write_figure", lambda self, figure, name: None)
    before = arrays(whole)
    again = study(whole, capsys)
    assert again["computed_now"] == 0 and again["cells"] == 360
    assert all(np.array_equal(before[name], values) for name, values in arrays(whole).items())
    refusal = study(whole, capsys, "--set", "single_mode.restitution=0.2", code=2)
    assert "scene.single_mode.restitution was 0.1 and is 0.2" in refusal["error"]
    refusal = study(whole, capsys, "--cycles", "300", code=2)
    assert "settling.most_cycles was 8192 and is 300" in refusal["error"]
    fresh = study(whole, capsys, "--fresh")
    assert fresh["computed_now"] == 360
    assert all(np.array_equal(before[name], values) for name, values in arrays(whole).items())


def test_shards_make_the_same_chart(whole, tmp_path, capsys):
    for k in (2, 1):
        part = study(tmp_path, capsys, "--shard", f"{k}/2")
        assert part["store"] == f"single_mode-3x60-{k}-of-2.sqlite"
        assert part["computed_now"] == part["cells"] == {1: 240, 2: 120}[k]
    assert not (tmp_path / "chart" / "chart_single_mode.png").exists()
    assert study(tmp_path, capsys)["computed_now"] == 0
    wanted = arrays(whole)
    assert all(np.array_equal(wanted[name], values) for name, values in arrays(tmp_path).items())
    assert (tmp_path / "chart" / "chart_single_mode.png").stat().st_size > 10_000


def test_folds_of_the_beam_lie_where_a_scan_loses_the_orbit():
    """The same fold by continuation in the chart and by a scan: p_5 of the beam at 22.2 Hz."""
    scene = read_scene("letter", ["modes.count=3"])
    bands = [band for band in bands_in(scene, 19.5, 24.0) if band.period == 5]
    folds = folds_of_beam(beam_of(scene, 22.2), tuple(bands), np.linspace(22.1, 22.3, 9), -0.15)
    assert 6 <= len(folds) <= 9 and {fold["period"] for fold in folds} == {5}
    excess = np.array([fold["excess"] for fold in folds])
    assert np.all(np.diff(excess) > 0) and np.all(excess < 0)
    middle = folds[4]
    strobed = StroboscopicMap(oscillator=beam_of(scene, middle["frequency_hz"]))
    start = settle(strobed.at(2e-3), strobed.at(-1e-3).steady(), most_cycles=2000)
    end = orbit_end(strobed, start.end, 2e-3, most_cycles=2000, relative=0.005)
    assert end is not None and end.period == 5
    assert middle["excess"] == pytest.approx(end.excess, rel=0.01)


def test_the_grid_is_fine_where_the_folds_are():
    grid = Plane(columns=400, rows=400).grid()
    excesses = np.array(grid.excesses)
    steps = np.diff(excesses)
    assert (excesses[0], excesses[-1]) == (-0.15, 0.1)
    assert (grid.frequencies[0], grid.frequencies[-1]) == (19.5, 24.0)
    assert steps.min() == pytest.approx(1e-4, rel=0.05) and steps.max() < 3.1e-3
    assert abs(excesses[int(np.argmin(steps))]) < 1.5 * KNEE
    with pytest.raises(ValueError, match="2 or more"):
        Plane(columns=1, rows=400)
    with pytest.raises(ValueError, match="excesses of the chart"):
        Plane(columns=4, rows=4, excesses=(0.1, -0.1))


def test_periods_that_meet_have_colours_that_differ():
    def apart(a, b):
        return max(abs(x - y) for x, y in zip(a, b, strict=True))

    for period in range(1, 27):
        mine = colour_of_period(period, 1)
        for other in {period + 1, 2 * period} - {period}:
            if other <= 28:
                assert apart(mine, colour_of_period(other, 1)) > 0.15, (period, other)
        for special in (colour_of_period(0, 3), colour_of_period(1, 0), colour_of_period(-1, -1)):
            assert apart(mine, special) > 0.1
    greys = [sum(colour_of_impacts(2, impacts)) for impacts in (1, 2, 3, 4, 6, 9)]
    assert np.all(np.diff(greys) < -0.1)  # they differ in lightness, which any eye and a grey copy shows


def test_every_large_region_says_its_period_and_failed_cells_are_marked():
    shape = (2, 40, 40)
    period, impacts = np.ones(shape, dtype=int), np.zeros(shape, dtype=int)
    period[1, 5:20, 10:30], impacts[1, 5:20, 10:30] = 3, 1
    period[1, 22:38, 10:30], impacts[1, 22:38, 10:30] = 8, 2
    period[1, 0, 0] = impacts[1, 0, 0] = -1
    grid = Plane(columns=40, rows=40).grid()
    cells = Cells(frequencies=np.array(grid.frequencies), excesses=np.array(grid.excesses), period=period,
                  impacts=impacts, cycles=impacts)  # fmt: skip
    figure = draw(cells, (), (), title="test")
    words = [[text.get_text() for text in axis.texts] for axis in figure.axes]
    assert words == [[], ["p$_{8}$", "p$_{3}$"], [], ["2", "1"]]
    assert [text.get_text() for text in figure.legends[0].get_texts()][-1] == "failed"
    crosses = [line for line in figure.axes[1].lines if line.get_marker() == "x"]
    assert crosses[0].get_xdata().tolist() == [19.5]
