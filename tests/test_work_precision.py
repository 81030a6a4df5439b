"""The work-precision study: front, ladders, costs, planted crossings, and the shape of what it returns."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contact.collision import first_collision
from contact.errors import StepTooLarge
from contact.integrators import INTEGRATORS, CentralDifference, method_for
from contact.laws import HERTZ, LINEAR, LinearContact
from contact.stop import Stop
from studies import work_precision
from studies.instruments import peers
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene_file import read_scene
from studies.instruments.work_precision import model_error
from studies.instruments.work_precision.cost import cost_of
from studies.instruments.work_precision.crossings import OVERSHOOTS, missed_share, plants
from studies.instruments.work_precision.errors import MEASURES, Yardstick, yardstick_of
from studies.instruments.work_precision.front import cheapest, front
from studies.instruments.work_precision.measures import rows_of
from studies.instruments.work_precision.methods import STEPPED, Line, Setting, lines_for, missing_peers
from studies.instruments.work_precision.model_error import balanced_step
from studies.instruments.work_precision.orders import measured_order
from studies.instruments.work_precision.problems import (
    EXCESS,
    FREQUENCY,
    driven_problem,
    linear_beam,
    problems_of,
    swung_problem,
)
from studies.instruments.work_precision.words import verdict_of

SCENE = read_scene("letter", [])
FEW_MODES = SCENE.replace({"modes.count": 4})


def row(error: float | None, cost: float | None, **more: object) -> dict[str, object]:
    return {"error": error, "us_per_period": cost, "method": "", "setting": "", **more}


# ------------------------------------------------------------------------------------------------ the front


def test_front_of_planted_rows() -> None:
    best = [row(1e-2, 1.0), row(1e-5, 3.0), row(1e-5, 3.0), row(1e-9, 40.0)]
    beaten = [row(1e-2, 1.1), row(1e-1, 0.999e1), row(1e-5, 4.0), row(1e-9, 41.0), row(1.0, 39.0)]
    nothing = [row(None, 1e-3), row(1e-12, None), row(math.nan, 1e-3)]
    found = front([*nothing, *beaten, *best])
    assert found == best
    assert cheapest([*beaten, *best], 1e-4)["us_per_period"] == 3.0  # type: ignore[index]
    assert cheapest([*beaten, *best], 1e-2)["us_per_period"] == 1.0  # type: ignore[index]
    assert cheapest([*beaten, *best], 1e-10) is None
    assert front(nothing) == []


@given(st.lists(st.tuples(st.floats(1e-16, 1.0), st.floats(1e-6, 10.0)), min_size=1, max_size=40))
def test_front_by_its_definition(points: list[tuple[float, float]]) -> None:
    rows = [row(error, cost) for error, cost in points]
    found = {(r["error"], r["us_per_period"]) for r in front(rows)}
    for e, c in set(points):
        dominated = any(a <= e and b <= c and (a < e or b < c) for a, b in points)
        assert ((e, c) in found) != dominated


def test_verdict_names_what_beats_the_default() -> None:
    base = {"failed": "", "family": "outside", "accuracy": 1e-10, "missed": 0.0}
    default = row(1e-12, 10.0, default=True, **base)
    slower = row(1e-13, 50.0, default=False, **{**base, "setting": "slower"})
    assert verdict_of([default, slower])["faster_and_as_accurate"] == []
    found = verdict_of([default, slower, row(1e-12, 7.0, default=False, **{**base, "setting": "faster"})])
    assert found["faster_and_as_accurate"] == [", faster"] and not found["on_front"]
    assert found["outside_cost_ratio"] == pytest.approx(0.7) and found["within_accuracy"]
    coarse = verdict_of([{**default, "error": 1e-9}, slower])
    assert not coarse["within_accuracy"] and coarse["on_front"]


def test_balanced_step_of_a_power_law() -> None:
    steps = [1e-4 / 4**k for k in range(5)]
    errors = [math.nan, *(30.0 * h**2 for h in steps[1:])]
    assert balanced_step(steps, errors, 30.0 * (7e-6) ** 2) == pytest.approx(7e-6)
    assert math.isnan(balanced_step(steps, errors, 1.0))


# --------------------------------------------------------------------------------------------- the problems


def test_linear_contact_lasts_as_long_as_that_of_hertz() -> None:
    oscillator = linear_beam(FEW_MODES, FREQUENCY, EXCESS)
    assert oscillator.stop.law.code == LINEAR and oscillator.excess == pytest.approx(EXCESS, rel=1e-9)
    hertz = beam_of(FEW_MODES, FREQUENCY).with_excess(EXCESS)
    assert hertz.stop.law.code == HERTZ
    wanted = first_collision(hertz).contact_time
    assert first_collision(oscillator).contact_time == pytest.approx(wanted, rel=1e-11)


@pytest.fixture(scope="module")
def measured() -> tuple[Yardstick, list[dict[str, object]]]:
    """Four modes, linear contact: central difference on its ladder, and the exact method."""
    oscillator = linear_beam(FEW_MODES, FREQUENCY, EXCESS)
    yardstick = yardstick_of(driven_problem("linear", "four modes", oscillator))
    rows: list[dict[str, object]] = []
    for line in lines_for(yardstick.problem):
        if line.label in ("piecewise-linear", "central difference"):
            settings = line.settings[:5]
            rows += rows_of(yardstick, replace(line, settings=settings), repeats=1)
    return yardstick, rows


def test_rows_show_the_order_stated() -> None:
    """The swung beam touches where its run begins, on the grid: nothing scatters about the second order."""
    yardstick = yardstick_of(swung_problem())
    (line,) = [x for x in lines_for(yardstick.problem) if x.label == "central difference"]
    rows = rows_of(yardstick, replace(line, settings=line.settings[1:5]), repeats=1)
    assert not any(r["failed"] for r in rows) and {r["order"] for r in rows} == {2.0}
    assert measured_order(rows) == pytest.approx(2.0, abs=0.15)
    assert measured_order(rows, "error_time") == pytest.approx(2.0, abs=0.15)
    # more steps cost more, and each is an evaluation
    counts = np.array([r["evaluations_per_period"] for r in rows])
    np.testing.assert_allclose(counts[1:] / counts[:-1], 4.0, rtol=0.01)
    assert rows[-1]["us_per_period"] > 4 * rows[0]["us_per_period"]


def test_the_exact_method_is_at_rounding_in_every_measure(measured: tuple) -> None:
    yardstick, rows = measured
    (exact,) = [r for r in rows if r["default"]]
    assert exact["certified"] and exact["missed"] == 0.0
    for name in MEASURES[:-1]:
        assert exact[name] < 1e-11
        assert yardstick.reference_error[name] < 0.01 * max(exact[name], 1e-17)
    assert exact["error"] < exact["accuracy"]


def test_a_refused_step_is_a_row_with_its_sentence(measured: tuple) -> None:
    yardstick, rows = measured
    refused = [r for r in rows if r["failed"]]
    assert refused and all(r["failed"].startswith("StepTooLarge: the time step") for r in refused)
    assert all(r[name] is None for r in refused for name in (*MEASURES, "us_per_period"))
    with pytest.raises(StepTooLarge):
        cost_of(yardstick.problem, CentralDifference(step=refused[0]["value"]))


def test_slow_settings_are_rows_that_say_so(measured: tuple) -> None:
    yardstick, _rows = measured
    settings = tuple(
        Setting(value=h, words=f"{h:g}", method=CentralDifference(step=h)) for h in (1e-5, 1e-6, 1e-10)
    )
    line = Line(label="x", family=STEPPED, growth=1e4, settings=settings)
    rows = rows_of(yardstick, line, slowest=1e-3, repeats=1)
    assert rows[0]["failed"] == "" and all(r["failed"].startswith("not run: a period") for r in rows[1:])
    assert len(rows) == 3


def test_every_setting_fits_the_law_of_its_problem() -> None:
    seen = set()
    for problem in (
        driven_problem("single mode", "", single_mode_oscillator(SCENE, FREQUENCY).with_excess(EXCESS)),
        driven_problem("hertz", "", beam_of(FEW_MODES, FREQUENCY).with_excess(EXCESS), fold=False),
        swung_problem(),
    ):
        for quick in (False, True):
            lines = lines_for(problem, quick=quick)
            assert len({line.label for line in lines}) == len(lines)
            kinds = [type(setting.method) for line in lines for setting in line.settings]
            assert kinds.count(type(method_for(problem.law))) == 1
            for line in lines:
                assert all(setting.method.accepts(problem.law) for setting in line.settings)
                values = [setting.value for setting in line.settings]
                assert len(values) == 1 or all(np.diff(values) < 0)
                seen |= {setting.method.name for setting in line.settings}
    assert {method.name for method in INTEGRATORS.values()} <= seen


def test_outside_solvers_that_are_missing_are_left_out_and_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(peers, "available", lambda: ("scipy",))
    labels = {line.label for line in lines_for(swung_problem()) if line.family == "outside"}
    assert labels == {f"scipy {solver}" for solver in peers.SOLVERS}
    assert missing_peers() == ["heyoka", "sundials"]


# ----------------------------------------------------------------------------------------- planted crossings


def test_planted_crossings_are_there_and_wide_ones_are_not_missed() -> None:
    """Certified flights find each once; a grid can only miss what is narrower than its step."""
    oscillator = linear_beam(FEW_MODES, FREQUENCY, EXCESS)
    planted = plants(oscillator)
    assert {plant.overshoot for plant in planted} == set(OVERSHOOTS)
    assert missed_share(method_for(LINEAR), planted) == (0.0, 0.0)
    soft = [
        replace(plant, oscillator=replace(plant.oscillator, stop=Stop(
            gap=oscillator.stop.gap, law=LinearContact(stiffness=10.0)
        ))) for plant in planted
    ]  # fmt: skip
    w = oscillator.drive.angular_frequency
    shares = []
    for step in (1e-3, 1e-4, 1e-5):
        share, largest = missed_share(CentralDifference(step=step), soft)
        assert share is not None and largest is not None
        shares.append(share)
        # 2 sqrt(2 h)/w is the widest crossing of that overshoot; the ringing ones are narrower
        narrowest = 2 * math.sqrt(2 * largest / (w**2 * (1 + (oscillator.model.omega[1] / w) ** 2)))
        assert narrowest < 1.5 * step
    assert shares == sorted(shares, reverse=True) and shares[0] > shares[-1]


# ---------------------------------------------------------------------------------------------- the program


def small_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """One mode, a few settings: the whole way through the program."""
    one = single_mode_oscillator(SCENE, FREQUENCY).with_excess(EXCESS)
    problems = [
        driven_problem("single mode", "Eq. (1)", one),
        driven_problem("linear", "four modes", linear_beam(FEW_MODES, FREQUENCY, EXCESS)),
    ]
    monkeypatch.setattr(work_precision, "problems_of", lambda scene: problems)
    monkeypatch.setattr(
        work_precision, "lines_for",
        lambda problem, quick: [
            replace(line, settings=line.settings[:2]) for line in lines_for(problem, quick=quick)
            if line.family != "outside"
        ],
    )  # fmt: skip
    monkeypatch.setattr(model_error, "COUNTS_QUICK", (1, 2))


def test_the_program_stores_what_it_says(monkeypatch: pytest.MonkeyPatch, tmp_path, capsys) -> None:
    small_form(monkeypatch)
    assert work_precision.main(["--quick", "--json", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    summary = json.loads(said.out)
    assert summary["study"] == "work_precision" and summary["status"] == "done"
    assert {r["problem"] for r in summary["rows"]} == {"single mode", "linear"}
    for r in summary["rows"]:
        assert {*MEASURES, "method", "setting", "us_per_period", "evaluations_per_period", "failed"} <= set(r)
    for name in ("single mode", "linear"):
        points = summary["front"][name]
        costs, errors = [p["us_per_period"] for p in points], [p["error"] for p in points]
        assert costs == sorted(costs) and errors == sorted(errors, reverse=True) and points
        assert summary["verdict"][name]["within_accuracy"]
        # the most accurate of the rows is at the end of the front
        assert errors[-1] == min(r["error"] for r in summary["rows"] if r["problem"] == name and r["error"])
        worst = max(summary["reference_error"][name].values())
        assert worst < 0.01 * max(errors[-1], 1e-17)
    assert [r["modes"] for r in summary["model_error"]] == [1, 2]
    folder = tmp_path / "work_precision"
    with open(folder / "rows.csv", encoding="utf-8", newline="") as stream:
        assert len(list(csv.DictReader(stream))) == len(summary["rows"])
    for name in ("work_precision", "other_errors", "model_error"):
        assert (folder / f"{name}.png").stat().st_size > 10_000 and (folder / f"{name}.pdf").exists()
    assert "the front" in said.err and "accuracy of" in said.err


@pytest.mark.slow
def test_no_outside_solver_is_faster_and_as_accurate(tmp_path, capsys) -> None:
    """The whole of --quick: four problems, every method, outside solvers where installed."""
    assert work_precision.main(["--quick", "--json", "--out", str(tmp_path)]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert set(summary["verdict"]) == {problem.name for problem in problems_of(SCENE)}
    for verdict in summary["verdict"].values():
        assert verdict["within_accuracy"]
        # the letter's sampled search proves less than the certified one and costs as much, or a little less
        faster = [name for name in verdict["faster_and_as_accurate"] if not name.startswith("sampled flight")]
        assert faster == []
