"""`python -m studies --all`: what runs, what is not run again, what a failure or an interruption leaves."""

import json
import signal
import subprocess
import sys
import time
from argparse import Namespace

import pytest

from studies import ROOT
from studies.experiment.chart.__main__ import chart
from studies.shell import every_study, programs
from studies.shell.files import fingerprint
from studies.shell.scene import read_scene


@pytest.fixture
def run_all(tmp_path, monkeypatch, capsys):
    """`run_all(*argv)`: its answer and what it says of two studies; the second refuses the free period."""
    monkeypatch.setattr(every_study, "studies", lambda: ["sweep", "breakdown"])

    def run(*argv: str) -> tuple[dict, str]:
        scene = ["--set", "single_mode.free_period_s=0.06", "--set", "modes.count=2"]
        code = every_study.main(["--all", "--json", "--quick", *scene, "--out", str(tmp_path), *argv])
        out, err = capsys.readouterr()
        answer = json.loads(out)
        assert answer["exit_code"] == code and "Traceback" not in err
        return answer, err

    return run


def test_a_failure_is_printed_and_what_is_stored_is_not_run_again(run_all, tmp_path):
    answer, err = run_all()
    assert (answer["exit_code"], answer["exit_codes"]) == (3, {"sweep": 0, "breakdown": 2})
    assert "python -m studies breakdown: " in err and "free_period_s" in err
    assert (tmp_path / "report" / "index.html").exists()
    measured, known = programs.run_times(tmp_path / "run_times.csv"), programs.run_times()
    every_study.keep_times({"sweep": 7.0}, True, tmp_path / "table.csv")
    assert programs.run_times(tmp_path / "table.csv")["sweep"] == (known["sweep"][0], 7.0)
    assert measured["sweep"][1] > 0.0 and measured["breakdown"] == known["breakdown"]
    manifest = json.loads((tmp_path / "sweep" / "manifest.json").read_text())
    answer, _ = run_all()
    assert (answer["stored"], answer["exit_codes"]) == (["sweep"], {"breakdown": 2})
    assert json.loads((tmp_path / "sweep" / "manifest.json").read_text()) == manifest


@pytest.mark.parametrize(
    ("stored", "arguments"),
    [
        ({"status": "done"}, None),
        ({"status": "interrupted"}, []),
        ({"status": "done", "fingerprint": "of another source"}, ["--fresh"]),
        ([1], ["--fresh"]),
    ],
)
def test_a_sweep_goes_on_where_it_was_interrupted_but_not_with_columns_of_another_source(
    tmp_path, stored, arguments
):
    scene, given = read_scene("letter"), Namespace(out=str(tmp_path), quick=False, style="paper", fresh=False)
    same = fingerprint(scene.values(), {"quick": False, "style": "paper", **chart.defaults(False)})
    assert every_study.arguments_of("chart", scene, given, []) == ["--fresh"]
    stored = {"fingerprint": same, **stored} if isinstance(stored, dict) else stored
    (tmp_path / "chart").mkdir()
    (tmp_path / "chart" / "manifest.json").write_text(json.dumps(stored))
    assert every_study.arguments_of("chart", scene, given, []) == arguments
    other = read_scene("letter", ["stop.gap_m=0.0117"])
    assert every_study.arguments_of("chart", other, given, []) == ["--fresh"]
    given.fresh = True
    assert every_study.arguments_of("chart", scene, given, []) == ["--fresh"]


@pytest.mark.parametrize(
    ("argv", "named"),
    [(["--full"], "--full"), (["--set", "stop.gpa_m=1"], "stop.gap_m"), (["--scene", "lettre"], "letter")],
)
def test_wrong_use_is_refused_before_anything_runs(tmp_path, capsys, argv, named):
    assert every_study.main(["--all", "--out", str(tmp_path), *argv]) == 2
    err = capsys.readouterr().err
    assert named in err and err.count("\n") == 1 and list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_an_interrupted_series_keeps_what_is_stored_and_says_how_to_go_on(tmp_path):
    """By Ctrl-C; that SIGTERM does the same to a program is tested of one study."""
    command = [sys.executable, "-m", "studies", "--all", "--out", str(tmp_path), "--json"]
    series = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(600):
        if (tmp_path / "transitions").exists() or series.poll() is not None:
            break
        time.sleep(0.1)
    time.sleep(1.0)  # a study that has made its folder is ready for signals a moment later
    series.send_signal(signal.SIGINT)
    out, err = series.communicate(timeout=60)
    assert series.returncode == 130 == json.loads(out)["exit_code"], err
    assert json.loads((tmp_path / "transitions" / "summary.json").read_text())["status"] == "interrupted"
    assert f"go on with: python -m studies --all --out {tmp_path}" in err and "Traceback" not in err
