"""A study as a program: options, exit codes, streams, results, and what an interruption leaves."""

import csv
import importlib
import json
import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest

from beam import InvalidValue
from contact import NotPeriodic
from studies import ROOT
from studies.shell.columns import UNITS, columns_of
from studies.shell.digits import written
from studies.shell.files import write_atomically
from studies.shell.scene import Scene, of_the_letter, read_scene
from studies.shell.study import Run, study


@dataclass(frozen=True, kw_only=True)
class Cell:
    """A row with every kind of cell."""

    number: int
    value: Annotated[float | None, "speed of the ball [m/s]; none at rest"]
    word: str
    good: bool
    pair: Mapping[str, float]


FAULTS = {error.__name__: error for error in (ValueError, TypeError, IndexError, KeyError, StopIteration)}


@study(quick={"points": 2})
def small(
    scene: Scene,
    run: Run,
    *,
    points: Annotated[int, "rows of the table"] = 3,
    excess: float = 0.1,
    frequency: float | None = None,
    colour: Literal["red", "blue"] = "red",
    span: tuple[float, float] = (0.0, 1.0),
    fail: bool = False,
    what: str = "",
):
    """A study that stores something of every kind."""
    if what == "value":
        raise InvalidValue("the value is\nwrong")
    if what in FAULTS:
        raise FAULTS[what]("a fault of the program")
    if what == "contact":
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail="no orbit")
    if what.startswith("interrupt"):
        run.text("kept.txt", "kept", "A word.")
        try:
            raise KeyboardInterrupt
        finally:
            if what == "interrupt of a file":
                raise ValueError("a file that was being written cannot be closed")
    rows = []
    for n in run.track(range(points), "rows"):
        value = None if n else np.float64(np.nan)
        rows.append(Cell(number=n, value=value, word="a,b", good=n > 0, pair={"low": float(n)}))
    run.table("rows", rows, "Rows.", of=Cell)
    run.arrays("numbers", "x [m].", x=np.arange(3.0))
    if fail:
        run.failed("cell 1", ValueError("no number"))
    print("a line of a careless library")
    found = {"rows": rows, "bad": np.array([1.0, math.inf]), "folder": run.folder}
    return {"options": [points, excess, frequency, colour, span], **found}


def start(*argv: str, out: Path) -> tuple[int, Path]:
    """Exit code, and the folder of results."""
    return small.main([*argv, "--out", str(out)]), out / "small"


def summary_of(folder: Path) -> dict:
    return json.loads((folder / "summary.json").read_text())


def test_a_run_leaves_summary_manifest_tables_and_arrays(tmp_path):
    code, folder = start(out=tmp_path)
    assert code == 0
    summary, manifest = summary_of(folder), json.loads((folder / "manifest.json").read_text())
    assert (summary["status"], summary["failed_cells"], summary["bad"]) == ("done", 0, [1.0, None])
    row = dict(number=1, value=None, word="a,b", good=True, pair={"low": 1.0})
    assert summary["rows"][1] == row
    assert summary["folder"] == str(folder)
    assert summary["settings"]["points"] == 3 and summary["provenance"]["stop.gap_m"] == "calibrated"
    assert set(manifest["files"]) == {path.name for path in folder.iterdir()}
    assert manifest["parameters"]["stop"]["gap_m"] == 0.011883925614219
    columns = json.loads((folder / "columns.json").read_text())
    speed = {"name": "value_m_per_s", "heading": "speed of the ball", "unit": "m/s", "note": "none at rest"}
    assert columns["rows.csv"]["holds"] == "Rows." and columns["rows.csv"]["columns"][1] == speed
    assert columns["numbers.npz"] == {"holds": "x [m].", "arrays": {"x": [3]}}
    assert set(columns) == set(manifest["files"])
    assert manifest["versions"]["numpy"] and {"commit", "dirty"} == set(manifest["git"])
    with (folder / "rows.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0]) == ["number", "value_m_per_s", "word", "good", "pair_low"]
    assert rows[1] == dict(zip(rows[0], ["1", "", "a,b", "True", "1.0"], strict=True))
    assert np.load(folder / "numbers.npz")["x"].tolist() == [0.0, 1.0, 2.0]


def test_keyword_arguments_are_options(tmp_path):
    argv = ["--points", "4", "--excess=-0.5", "--frequency", "22.2", "--colour", "blue", "--span", "1", "2"]
    _, folder = start(*argv, out=tmp_path)
    assert summary_of(folder)["options"] == [4, -0.5, 22.2, "blue", [1.0, 2.0]]
    _, folder = start("--quick", out=tmp_path)
    assert summary_of(folder)["options"] == [2, 0.1, None, "red", [0.0, 1.0]]
    _, folder = start("--quick", "--points", "5", out=tmp_path)
    assert summary_of(folder)["options"][0] == 5


WRONG_USE = {
    "--pionts 3": "--points",
    "--points 0": "--points",
    "--excess nan": "--excess",
    "--colour green": "--colour",
    "--span 1": "--span",
    "stray": "stray",
    "--set stop.gpa_m=1": "stop.gap_m",
    "--scene lettre": "letter",
    "--what value": "the value is wrong",
}


@pytest.mark.parametrize("argv", WRONG_USE)
def test_wrong_use_is_one_sentence_and_exit_code_2(tmp_path, capsys, argv):
    code, _ = start(*argv.split(), out=tmp_path)
    out, err = capsys.readouterr()
    (line,) = [line for line in err.splitlines() if not line.startswith("warning: ")]
    assert code == 2 and WRONG_USE[argv] in line and out == ""


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert small.main(["--out", str(tmp_path / "file")]) == 2
    assert "file" in capsys.readouterr().err


def test_failed_cells_are_kept_and_bring_exit_code_3(tmp_path):
    code, folder = start("--fail", out=tmp_path)
    assert code == 3 and summary_of(folder)["failures"] == ["cell 1: no number"]
    code, folder = start("--what", "contact", out=tmp_path)
    assert code == 3 and summary_of(folder)["failed_cells"] == 1 and summary_of(folder)["status"] == "failed"


def test_an_interrupted_run_keeps_what_it_stored_and_says_how_to_go_on(tmp_path, capsys):
    code, folder = start("--what", "interrupt of a file", out=tmp_path)
    err = capsys.readouterr().err
    assert code == 130 and (folder / "kept.txt").read_text() == "kept"
    assert summary_of(folder)["status"] == "interrupted"
    assert f"python -m studies small --what 'interrupt of a file' --out {tmp_path}" in err


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_program_is_no_wrong_use(tmp_path, letter_scene, fault):
    """Nor a failed cell."""
    with pytest.raises(FAULTS[fault]):
        start("--what", fault, out=tmp_path)

    def cell(number: int) -> int:
        raise FAULTS[fault]("a fault of the program")

    run = Run(study="x", folder=tmp_path, scene=letter_scene, command="")
    with pytest.raises((FAULTS[fault], RuntimeError)):
        run.attempt(cell, [1], "cells")


@pytest.mark.parametrize(
    ("argv", "code"), [("", 0), ("--fail", 3), ("--what value", 2), ("--what interrupt", 130)]
)
def test_json_is_one_object_and_nothing_else_on_standard_output(tmp_path, capsys, argv, code):
    assert start("--json", *argv.split(), out=tmp_path)[0] == code
    answer = json.loads(capsys.readouterr().out)
    assert answer["schema"] == 3 and answer["exit_code"] == code


def test_suspicious_values_are_printed_and_kept(tmp_path, capsys):
    _, folder = start("--set", "scan.born_excess=0.5", out=tmp_path)
    assert "warning: scan.born_excess" in capsys.readouterr().err
    assert sum("scan.born_excess" in doubt for doubt in summary_of(folder)["warnings"]) == 1


def test_help_prints_the_docstring_and_the_dump_the_scene(tmp_path, capsys):
    assert small.main(["--help"]) == 0
    assert __doc__ in capsys.readouterr().out
    assert small.main(["--dump-scene", "--set", "stop.gap_m=0.011"]) == 0
    assert "gap_m = 0.011\n" in capsys.readouterr().out
    assert small.main(["--dump-scene", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["scene"]["stop"]["gap_m"] == 0.011883925614219


def test_what_a_study_may_not_store_is_refused(tmp_path, letter_scene):
    run = Run(study="transitions", folder=tmp_path, scene=letter_scene, command="")
    run.verdict("p3", "agrees", found="p3")
    with pytest.raises(KeyError):
        run.verdict("torsion", "agrees", found="")
    with pytest.raises(KeyError):
        run.verdict("no point", "agrees", found="")
    with pytest.raises(TypeError, match="set"):
        run.json("no_json", {"numbers": {1}}, "A set.")
    with pytest.raises(TypeError, match="a cell is one value"):
        run.table("pairs", [Cell(number=1, value=(0.0, 1.0), word="", good=True, pair={})], "Pairs.", of=Cell)
    run.finding("The beam has p10 in Eq. (1) and Fig. 2, 3 times the map's.")
    for sentences in (["It is 1.5 to 2."], ["It is so."] * 3):
        with pytest.raises(ValueError, match="findings"):
            [run.finding(sentence) for sentence in sentences]
    with pytest.raises(ValueError, match="no rows"):
        run.close("done", {})
    for name in ("failures", "failed_cells", "verdicts", "findings", "model_choice", "warnings", "status"):
        with pytest.raises(ValueError, match=name):
            run.close("done", {"rows": [], name: []})
    kept = run.close("done", {"rows": []})["verdicts"]
    assert kept == {"p3": {"verdict": "agrees", "found": "p3", "note": "", "figure": ""}}


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_what_the_letter_says_is_kept_of_its_spring_only(tmp_path):
    own = ["modes.count=3", "scan.points=5", "contact.law=newton", "single_mode.decay_rate_per_s=3.6"]
    other = ["stop.gap_m=1e-6", "tip.mass_kg=0", "spring.thickness_m=7e-4", "single_mode.decay_rate_per_s=5"]
    assert all(of_the_letter(read_scene(name)) for name in ("letter", "tight_fold", "measured_modes"))
    assert [of_the_letter(read_scene("letter", [one])) for one in own + other] == [True] * 4 + [False] * 4
    run = Run(study="transitions", folder=tmp_path, scene=read_scene("steel_ruler"), command="")
    run.verdict("p3", "agrees", found="p3")
    assert not run.close("done", {"rows": []})["verdicts"] and not run.letters


def test_each_table_says_what_its_columns_hold_even_without_rows(tmp_path, letter_scene):
    run, calls = Run(study="transitions", folder=tmp_path, scene=letter_scene, command=""), 0
    for path in (ROOT / "studies").rglob("*.py"):
        for call in re.findall(r"run\.table\((?:[^()]|\([^()]*\))*\)", path.read_text()):
            module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
            kind, calls = eval(re.search(r"of=([\w.]+)", call)[1], vars(module)), calls + 1
            columns = columns_of(kind, [])
            names = ",".join(column.name for column in columns) + "\n"
            assert run.table("empty", [], "None.", of=kind, show=()).read_text() == names
            assert kind.__name__ != "Row" and len({column.heading for column in columns}) == len(columns)
            for column in columns:
                assert not re.search(r"\w\w_|_\w\w", column.heading) and column.unit in {"", *UNITS}, column
                assert column.unit or not column.field.endswith(("_hz", "_s", "_kg")), column
    assert calls > 40
    with pytest.raises(TypeError, match="rows of one dataclass"):
        run.table("others", [calls], "Others.", of=Cell)


NUMBERS = {-6.2729e-4: "−6.273 × 10⁻⁴", 99999.6: "1 × 10⁵", -0.0119: "−0.0119", -0.0: "0", 40: "40"}
NUMBERS |= {9.9996: "10", 1.05e11: "1.05 × 10¹¹", math.inf: "∞"}


@pytest.mark.parametrize("value", NUMBERS)
def test_a_number_is_written_in_four_digits_and_reads_back(value):
    text = written(value)
    assert text == NUMBERS[value]
    back = text.replace("−", "-").replace("∞", "inf").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    assert float(back.replace(" × 10", "e")) == pytest.approx(value, rel=5e-4)


def test_files_are_complete_or_absent(tmp_path, monkeypatch):
    path = tmp_path / "result.txt"
    write_atomically(path, b"old")

    def fails(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fails)
    with pytest.raises(OSError, match=r"result\.txt"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old" and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("place", ["moon", "ssh://there", "dask://127.0.0.1:1"])
def test_an_executor_that_is_not_there_is_refused(tmp_path, letter_scene, place, monkeypatch):
    monkeypatch.setattr("studies.shell.executors.PATIENCE", 0.2)
    run = Run(study="x", folder=tmp_path, scene=letter_scene, command="", executor=place)
    with pytest.raises(ValueError), run.pool():
        pass
