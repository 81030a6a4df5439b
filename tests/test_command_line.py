"""The rim of the studies: command line, record, progress, figures, import guard."""

from __future__ import annotations

import ast
import csv
import errno
import io
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import studies
from contact.errors import ContactError
from studies.instruments import atomic_file, programs
from studies.instruments import record as record_module
from studies.instruments.atomic_file import RecordError, write_atomically
from studies.instruments.command_line import run_study
from studies.instruments.figures import LINES, MARKERS, PALETTE, label, new_figure, points, save, series
from studies.instruments.interruption import PATIENCE, Interruption
from studies.instruments.programs import FOLDER, named_by, names
from studies.instruments.progress import INTERVAL, Progress, duration, rate_of
from studies.instruments.record import Record, git_state, plain, versions
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import spring_of


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


def test_suspicious_values_are_told_once_and_kept(tmp_path, capsys):
    def run(scene, request):
        scene.replace({"tip.mass_kg": 1.0})
        spring_of(scene.replace({"tip.mass_kg": 1.0}))  # what a study varies is its own affair
        return {}

    overrides = ("--set", "stop.gap_m=0.05", "--set", "tip.mass_kg=0.05")
    assert call(run, tmp_path, *overrides, "--json") == 0
    out, err = capsys.readouterr()
    told = [line for line in err.splitlines() if line.startswith("warning: ")]
    assert len(told) == 2 and "stop.gap_m is 0.05 m" in told[0] and "heavier than the strip" in told[1]
    summary, manifest = (json.loads((tmp_path / "example" / f"{n}.json").read_text())
                         for n in ("summary", "manifest"))  # fmt: skip
    assert summary["warnings"] == manifest["warnings"] == json.loads(out)["warnings"]
    assert [f"warning: {sentence}" for sentence in summary["warnings"]] == told
    assert call(run, tmp_path) == 0
    assert "warning" not in capsys.readouterr().err.lower()
    assert json.loads((tmp_path / "example" / "summary.json").read_text())["warnings"] == []


def test_help_says_what_the_study_does_in_groups(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(sys.modules[__name__], "__doc__", "An example.\n\n" + "Claim: it is so. " * 12
                        + "\n\n    x = 1    a formula " + "word " * 20)  # fmt: skip

    def options(parser):
        parser.add_argument("--modes", type=int, help="modes")

    assert call(found, tmp_path, "--help", options=options) == 0
    out = capsys.readouterr().out
    assert max(len(line) for line in out.splitlines()) <= 80
    for words in ("Claim: it is so.", "    x = 1    a formula", "options of this study:", "the scene:",
                  "how it runs:", "where the results go:"):  # fmt: skip
        assert words in out
    assert out.index("--modes") < out.index("--scene") < out.index("--quick") < out.index("--out")


@pytest.mark.parametrize("name", [n for n in names() if "run_study(" in (FOLDER / f"{n}.py").read_text()])
def test_every_study_says_in_its_docstring_how_long_it_runs_and_what_it_leaves(name):
    account = ast.get_docstring(ast.parse((FOLDER / f"{name}.py").read_text())) or ""
    assert "utputs" in account or "summary.json" in account, "no outputs"
    assert re.search(r"\d+ (s|min)\b|minute|second", account), "no run time"


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--height", "nan"], "argument --height: must be a finite number, not 'nan'"),
        (["--height=-inf"], "must be a finite number, not '-inf'"),
        (["--height", "tall"], "must be a finite number, not 'tall'"),
        (["--points", "0"], "argument --points: must be a whole number of at least 1, not '0'"),
        (["--points", "1.5"], "must be a whole number of at least 1, not '1.5'"),
        (["--points"], "argument --points: expected one argument"),
        (["--kind", "x"], "argument --kind: invalid choice: 'x'"),
    ],
)
def test_wrong_numbers_for_options_of_a_study_are_one_sentence(tmp_path, capsys, argv, words):
    def options(parser):
        parser.add_argument("--height", type=float, default=1.0)
        parser.add_argument("--points", type=int, default=3)
        parser.add_argument("--kind", choices=("a", "b"), default="a")

    assert call(found, tmp_path, *argv, options=options) == 2
    assert words in refused(capsys)


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--quik"], "there is no option --quik; did you mean --quick?"),
        (["--zzz"], "unrecognized argument --zzz"),
        (["stray"], "unrecognized argument stray"),
        (["--set", "stop.gap_m"], "--set needs section.key=value"),
        (["--set", "stop.gap_mm=1"], "the nearest valid key is stop.gap_m"),
        (["--scene", "/"], "cannot be read"),
        (["--scene", "lettre"], "there is no scene 'lettre'"),
    ],
)
def test_slips_are_answered_with_what_was_meant(tmp_path, capsys, argv, words):
    assert call(found, tmp_path, *argv) == 2
    assert words in refused(capsys)


def test_out_may_not_be_a_file(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert run_study("example", "An example.", found, ["--out", str(tmp_path / "file")]) == 2
    assert "results cannot be written to the folder" in refused(capsys)


def program(*words: str, **options: Any) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        cwd=studies.ROOT, **options,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["-m", "studies.transitons"], "did you mean python -m studies.transitions?"),
        (["-m", "studies", "transitons"], "did you mean python -m studies.transitions?"),
        (["-m", "studies", "modes"], "a study runs as python -m studies.modes"),
        (["-m", "studies.zzzzzz"], "there is no study zzzzzz; the studies are adequacy, "),
    ],
)
def test_an_unknown_study_is_answered_with_the_nearest(words, sentence):
    with program(*words) as process:
        out, err = process.communicate(timeout=60)
    assert process.returncode == 2 and out == ""
    assert sentence in err and err.count("\n") == 1


def test_modules_below_the_studies_are_no_unknown_study():
    assert named_by(["-m", "studies.instruments.adequacy.memory"]) is None
    assert named_by(["-X", "dev", "-m", "studies.modes", "--quick"]) is None
    assert named_by(["-m", "pytest", "-m", "studies.none"]) is None
    assert named_by(["-mstudies.none"]) == "none"


@pytest.mark.parametrize("options", [["--dump-scene"], ["--dump-scene", "--json"], ["--help"]])
def test_a_reader_that_has_seen_enough_is_no_error(options):
    with program("-m", "studies.modes", *options) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()  # before a line has been written
        err = process.stderr.read()
        process.wait(timeout=60)
    assert process.returncode == 0 and err == ""


@pytest.mark.parametrize("stream", [1, 2])
def test_a_closed_stream_is_no_error(stream):
    command = f"{shlex.quote(sys.executable)} -m studies.modes --dump-scene --json {stream}>&-"
    outcome = subprocess.run(
        ["sh", "-c", command], capture_output=True, text=True, cwd=studies.ROOT, timeout=60, check=False
    )
    assert outcome.returncode == 0
    assert outcome.stderr == "" and (stream == 1 or json.loads(outcome.stdout)["study"] == "modes")


def test_ctrl_c_while_a_program_is_importing_is_one_line():
    with program("-X", "importtime", "-m", "studies.modes") as process:
        assert process.stderr is not None
        while "numpy" not in process.stderr.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in err
    told = [line for line in err.splitlines() if not line.startswith("import time:")]
    assert told == ["interrupted; nothing was stored; go on with: python -X importtime -m studies.modes"]


def test_an_interruption_lost_in_a_callback_is_not_told(monkeypatch):
    """The compiler's callbacks swallow it; what else they swallow is told as ever."""
    told: list[type] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda lost: told.append(lost.exc_type))
    with Interruption(lambda: None):
        for kind in (KeyboardInterrupt, ValueError):
            sys.unraisablehook(SimpleNamespace(exc_type=kind))
    assert told == [ValueError]
    sys.unraisablehook(SimpleNamespace(exc_type=KeyboardInterrupt))
    assert told == [ValueError, KeyboardInterrupt]


def interrupted(name: str, tmp_path: Path, number: int = signal.SIGINT) -> None:
    """Start a study, interrupt it in the middle, and look at what it says and leaves."""
    folder = tmp_path / (programs.MAIN if name == "studies" else name.removeprefix("studies."))
    with program("-m", name, "--quick", "--out", str(tmp_path)) as process:
        while not folder.exists() and process.poll() is None:
            time.sleep(0.02)
        time.sleep(0.5)
        begun, running = time.monotonic(), process.poll() is None
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    if not running or process.returncode == 0:  # done before the signal came
        assert process.returncode == 0
        return
    assert process.returncode == 130, err
    assert time.monotonic() - begun < PATIENCE + 5.0
    assert "Traceback" not in err and "Error" not in err, err
    last = err.splitlines()[-1]
    assert last.startswith(f"python -m {name}: interrupted after ")
    assert last.endswith(f"; what was stored is in {folder}; go on with: "
                         f"python -m {name} --quick --out {tmp_path}")  # fmt: skip
    assert json.loads((folder / "summary.json").read_text())["status"] == "interrupted"
    assert not list(folder.glob(".*")), "half-written files are left"


QUICKLY_TRIED = ("studies", "studies.hysteresis", "studies.stability")
"""Threads that go on computing, processes, and the main job."""


@pytest.mark.parametrize("name", QUICKLY_TRIED)
def test_ctrl_c_in_the_middle_of_a_study(name, tmp_path):
    interrupted(name, tmp_path)


def test_a_request_to_end_is_an_interruption_too(tmp_path):
    interrupted("studies.claims", tmp_path, signal.SIGTERM)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [n for n in names() if "run_study(" in (FOLDER / f"{n}.py").read_text() and n != programs.MAIN]
)
def test_ctrl_c_in_the_middle_of_every_study(name, tmp_path):
    interrupted(f"studies.{name}", tmp_path)


def test_interruptions_wait_while_results_are_written_and_end_loops_before():
    left: list[str] = []
    with Interruption(lambda: left.append("left")) as interruption:
        with interruption.calm():
            signal.raise_signal(signal.SIGINT)
        assert interruption.count == 1
    with Interruption(lambda: left.append("left")) as interruption:
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        interruption.end_program(130)  # of a program only: this test goes on
    assert left == [] and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_versions_name_the_optional_packages_that_are_there(monkeypatch):
    assert {"numpy", "mpmath", "numba"} <= set(versions())
    monkeypatch.setattr(record_module, "OPTIONAL", ("pytest", "no-such-package"))
    found = versions()
    assert found["pytest"] == pytest.__version__ and "no-such-package" not in found


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
