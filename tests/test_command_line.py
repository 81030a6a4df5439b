"""The rim of the studies: command line, record, progress, figures, import guard."""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import studies
from contact.errors import ContactError
from studies.instruments import atomic_file
from studies.instruments.atomic_file import RecordError, write_atomically
from studies.instruments.command_line import run_study
from studies.instruments.figures import LINES, MARKERS, PALETTE, label, new_figure, points, save, series
from studies.instruments.progress import INTERVAL, Progress, duration, rate_of
from studies.instruments.record import Record, git_state, plain
from studies.instruments.scene import Scene


def found(scene, request):
    request.record.write_arrays("gaps", gap=np.array([scene.stop.gap_m]))
    print("a stray word")
    return {"gap_m": scene.stop.gap_m, "nothing": float("nan"), "quick": request.quick}


def call(run, tmp_path, *argv, **options):
    return run_study("example", "An example.", run, ["--out", str(tmp_path), *argv], **options)


def test_a_run_stores_results_and_where_they_come_from(tmp_path, capsys):
    assert call(found, tmp_path, "--set", "stop.gap_m=0.012", "--quick") == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert "python -m studies.example: done" in err and "a stray word" in err
    folder = tmp_path / "example"
    assert sorted(file.name for file in folder.iterdir()) == ["gaps.npz", "manifest.json", "summary.json"]
    summary = json.loads((folder / "summary.json").read_text())
    assert {name: summary[name] for name in ("gap_m", "nothing", "quick")} == {
        "gap_m": 0.012, "nothing": None, "quick": True
    }
    assert summary["provenance"]["stop.gap_m"] == "given"
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["parameters"]["stop"] == {"gap_m": 0.012}
    assert manifest["command"] == (
        f"python -m studies.example --out {tmp_path} --set stop.gap_m=0.012 --quick"
    )
    assert manifest["versions"]["numpy"] == np.__version__
    assert manifest["wall_time_s"] >= 0.0
    assert manifest["files"] == ["gaps.npz", "manifest.json", "summary.json"]
    assert np.load(folder / "gaps.npz")["gap"] == 0.012


def test_json_is_one_object_and_nothing_else(tmp_path, capsys):
    assert call(found, tmp_path, "--json") == 0
    out, err = capsys.readouterr()
    answer = json.loads(out)
    assert (answer["schema"], answer["study"], answer["exit_code"]) == (1, "example", 0)
    assert answer["nothing"] is None
    assert "a stray word" in err


STUDY = """
import os, subprocess, sys, time
from studies.instruments.command_line import run_study

def run(scene, request):
    subprocess.run([sys.executable, "-c", "print('from another process')"], check=True)
    os.write(1, b"from below")
    request.record.write_arrays("half", x=[1.0])
    if request.options.wait:
        print("waiting", file=sys.stderr, flush=True)
        time.sleep(60)
    return {"threads": os.environ["OMP_NUM_THREADS"]}

def options(parser):
    parser.add_argument("--wait", action="store_true")

raise SystemExit(run_study("example", "An example.", run, options=options))
"""


def start(tmp_path, *argv):
    environment = {name: value for name, value in os.environ.items() if name not in studies.THREAD_VARIABLES}
    environment["PYTHONPATH"] = str(studies.ROOT)
    return subprocess.Popen(
        [sys.executable, "-c", STUDY, "--out", str(tmp_path), *argv],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, cwd=tmp_path,
    )


def test_json_stays_clean_when_other_processes_print(tmp_path):
    with start(tmp_path, "--json") as study:
        out, err = study.communicate(timeout=60)
    assert study.returncode == 0, err
    assert json.loads(out)["threads"] == "1"
    assert "from another process" in err and "from below" in err


def test_an_interrupted_study_keeps_what_it_has_and_says_how_to_go_on(tmp_path):
    with start(tmp_path, "--wait", "--set", "contact.law=hertz", "--json") as study:
        assert study.stderr is not None
        while "waiting" not in study.stderr.readline():
            assert study.poll() is None
        study.send_signal(signal.SIGINT)
        out, err = study.communicate(timeout=60)
    assert study.returncode == 130
    assert json.loads(out)["status"] == "interrupted"
    assert f"python -m studies.example --out {tmp_path} --wait --set contact.law=hertz --json" in err
    assert "Traceback" not in err
    assert json.loads((tmp_path / "example" / "manifest.json").read_text())["status"] == "interrupted"
    assert (tmp_path / "example" / "half.npz").exists()


def refused(capsys) -> str:
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1 and "Traceback" not in err
    return err


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--no-such-option"], "--no-such-option"),
        (["--workers", "0"], "--workers: must be a whole number of at least 1, not '0'"),
        (["--workers", "two"], "'two'"),
        (["--set"], "--set"),
        (["--set", "stop.gap_m=-1"], "stop.gap_m must be"),
        (["--set", "stop.gap=1"], "stop.gap_m"),
        (["--scene", "absent.toml"], "No such file"),
        (["--qui"], "--qui"),
    ],
)
def test_wrong_use_is_one_sentence(tmp_path, capsys, argv, words):
    assert call(found, tmp_path, *argv) == 2
    assert words in refused(capsys)
    assert not (tmp_path / "example").exists()


@pytest.mark.parametrize("error", [ValueError, TypeError])
def test_input_refused_by_the_study_is_one_sentence(tmp_path, capsys, monkeypatch, error):
    def run(scene, request):
        raise error("thickness must be greater than 0 (unit m),\nnot -1")

    assert call(run, tmp_path) == 2
    assert refused(capsys) == "python -m studies.example: thickness must be greater than 0 (unit m), not -1\n"
    monkeypatch.setenv("GRAZING_SPRING_TRACEBACK", "1")
    assert call(run, tmp_path) == 2
    assert "Traceback" in capsys.readouterr().err


def test_a_refusal_with_json_is_an_object_too(tmp_path, capsys):
    assert call(found, tmp_path, "--json", "--set", "stop.gap_m=-1") == 2
    answer = json.loads(capsys.readouterr().out)
    assert answer["exit_code"] == 2 and "stop.gap_m" in answer["error"]


def test_defects_are_not_taken_for_wrong_use(tmp_path):
    def run(scene, request):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        call(run, tmp_path)


def test_failed_cells_and_failed_computations_exit_with_3(tmp_path, capsys, monkeypatch):
    assert call(lambda scene, request: {"failed_cells": 2}, tmp_path) == 3
    assert call(lambda scene, request: {"failed_cells": 0}, tmp_path) == 0

    class Failed(ContactError):
        def __init__(self) -> None:
            RuntimeError.__init__(self, "no crossing at t = 1 s")

        def __str__(self) -> str:
            return "no crossing at t = 1 s"

    def run(scene, request):
        raise Failed

    capsys.readouterr()
    assert call(run, tmp_path, "--json") == 3
    answer = json.loads(capsys.readouterr().out)
    assert answer["failure"] == "Failed: no crossing at t = 1 s"


def test_dump_scene_prints_toml_and_runs_nothing(tmp_path, capsys):
    assert call(found, tmp_path, "--dump-scene", "--set", "stop.gap_m=0.02") == 0
    assert tomllib.loads(capsys.readouterr().out)["stop"]["gap_m"] == 0.02
    assert call(found, tmp_path, "--dump-scene", "--json") == 0
    assert json.loads(capsys.readouterr().out)["scene"]["stop"]["gap_m"] == 0.0106993324
    assert list(tmp_path.iterdir()) == []


def test_help_and_options_of_the_study(tmp_path, capsys):
    def options(parser):
        parser.add_argument("--modes", type=int)

    assert call(found, tmp_path, "--help", options=options) == 0
    out, err = capsys.readouterr()
    assert "--modes" in out and err == ""

    def run(scene, request):
        return {"modes": request.options.modes}

    assert call(run, tmp_path, "--modes", "7", "--json", options=options) == 0
    assert json.loads(capsys.readouterr().out)["modes"] == 7


def test_a_folder_that_takes_no_files_is_told_before_the_run(tmp_path, capsys):
    (tmp_path / "example").write_text("a file, not a folder")

    def run(scene, request):
        raise AssertionError("the study has been started")

    assert call(run, tmp_path) == 2
    assert "results cannot be written to the folder" in refused(capsys)


def test_a_full_disk_is_one_sentence_and_leaves_the_old_file(tmp_path, capsys, monkeypatch):
    path = write_atomically(tmp_path / "old.json", b"old")

    def full(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(atomic_file.os, "fsync", full)
    with pytest.raises(RecordError, match=r"old\.json cannot be written: No space left on device"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert [file.name for file in tmp_path.iterdir()] == ["old.json"]
    assert call(found, tmp_path) == 2
    assert "No space left on device" in capsys.readouterr().err.splitlines()[-1]


def record(tmp_path: Path) -> Record:
    command = "python -m studies.example"
    return Record(study="example", folder=tmp_path / "example", scene=Scene(), command=command)


def test_plain_values():
    value = {"a": np.float64("inf"), "b": np.arange(2), "c": (1, np.nan), 3: np.bool_(True), "p": Path("x")}
    assert plain(value) == {"a": None, "b": [0, 1], "c": [1, None], "3": True, "p": "x"}
    with pytest.raises(TypeError, match="complex"):
        plain(1j)


def test_tables_and_arrays(tmp_path):
    writer = record(tmp_path)
    path = writer.write_table("periods", {"frequency (Hz)": [20.9, 21.5], "period": np.array([3, 4])})
    with path.open(newline="") as stream:
        assert list(csv.reader(stream)) == [["frequency (Hz)", "period"], ["20.9", "3"], ["21.5", "4"]]
    with pytest.raises(ValueError, match="equal lengths, not a 1, b 2"):
        writer.write_table("odd", {"a": [1], "b": [1, 2]})
    with pytest.raises(TypeError, match="objects"):
        writer.write_arrays("odd", things=np.array([object()]))
    with pytest.raises(ValueError, match="plain file name"):
        writer.write_json("../odd", {})
    assert writer.files == ["periods.csv"]


def git(folder: Path, *words: str) -> None:
    identity = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", "-C", str(folder), *identity, *words], check=True, capture_output=True)


def test_git_state_is_that_of_the_checkout_itself(tmp_path):
    assert git_state(tmp_path) == {"commit": None, "dirty": None}
    git(tmp_path, "init")
    (tmp_path / "a").write_text("a")
    git(tmp_path, "add", "a")
    git(tmp_path, "commit", "-m", "a")
    clean = git_state(tmp_path)
    assert len(clean["commit"]) == 40 and clean["dirty"] is False
    (tmp_path / "a").write_text("b")
    assert git_state(tmp_path) == {**clean, "dirty": True}
    (tmp_path / "inside").mkdir()
    assert git_state(tmp_path / "inside") == {"commit": None, "dirty": None}


def test_figures_are_the_same_bytes_each_time(tmp_path):
    def draw(name: str) -> list[bytes]:
        figure, axes = new_figure()
        axes.plot([0, 1], [0, 1], **series(1), label="upward scan")
        axes.plot([0, 1], [1, 0], **points(2), label="downward scan")
        label(axes.xaxis, "excess")
        label(axes.yaxis, "tip displacement", "mm")
        axes.legend()
        assert axes.get_ylabel() == "tip displacement (mm)" and axes.get_xlabel() == "excess"
        assert axes.yaxis.label.get_fontsize() >= 7.0
        return [path.read_bytes() for path in save(figure, tmp_path, name)]

    png, pdf = draw("first")
    assert [png, pdf] == draw("second")
    assert png.startswith(b"\x89PNG") and pdf.startswith(b"%PDF") and b"CreationDate" not in pdf


def test_series_differ_in_more_than_colour():
    assert len(set(PALETTE)) == len(set(MARKERS)) == len(set(LINES)) == 8
    with pytest.raises(ValueError, match="0 to 7, not 8"):
        series(8)


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_progress_tells_a_line_now_and_then():
    clock, stream = Clock(), io.StringIO()
    with Progress("scan", total=10, stream=stream, clock=clock) as progress:
        for _ in range(10):
            clock.now += 0.4 * INTERVAL
            progress.advance()
    lines = stream.getvalue().splitlines()
    assert lines[0] == "scan: 3 of 10, 12 s each, 1 min 24 s left"
    assert lines[-1] == "scan: 10 of 10, done in 2 min 00 s"
    assert len(lines) == 4


def test_progress_draws_a_bar_on_a_terminal():
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    with Progress("scan [amplitude]", total=2, stream=stream) as progress:
        progress.advance(2)
    assert "scan [amplitude]" in stream.getvalue() and "2/2" in stream.getvalue()


def test_durations_and_rates():
    assert [duration(seconds) for seconds in (8, 200, 7500)] == ["8 s", "3 min 20 s", "2 h 05 min"]
    assert [rate_of(0, 5.0), rate_of(10, 5.0), rate_of(2, 5.0)] == ["no rate yet", "2 per s", "2.5 s each"]


def import_studies(tmp_path: Path, *path: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, path))}
    return subprocess.run(
        [sys.executable, "-c", "import studies, sys; print('beam' in sys.modules)"],
        capture_output=True, text=True, cwd=tmp_path, env=environment, timeout=60, check=False,
    )


@pytest.mark.parametrize("name", ["beam", "contact"])
def test_a_foreign_package_of_the_same_name_is_refused(tmp_path, name):
    foreign = tmp_path / "foreign"
    (foreign / name).mkdir(parents=True)
    (foreign / name / "__init__.py").write_text("raise SystemExit('the foreign package has been imported')")
    outcome = import_studies(tmp_path, foreign, studies.ROOT)
    assert outcome.returncode == 1
    last = outcome.stderr.splitlines()[-1]
    assert last.startswith(f"ImportError: the package '{name}' in ") and f"pip uninstall {name}" in last
    assert "has been imported" not in outcome.stderr
    outcome = import_studies(tmp_path, studies.ROOT, foreign)
    assert outcome.stdout == "False\n", outcome.stderr


def test_a_missing_package_is_named(tmp_path):
    with pytest.raises(ImportError, match="no_such_package"):
        studies.refuse_foreign_packages(["no_such_package"])
