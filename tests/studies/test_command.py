"""The command of the studies: wrong use, what an import changes, and what a signal leaves."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from studies import ROOT
from studies.__main__ import main
from studies.shell.programs import names


def test_an_unknown_study_is_answered_with_the_nearest_and_the_chapters(capsys):
    assert main(["transitons"]) == 2
    out, err = capsys.readouterr()
    assert "did you mean transitions?" in err and not out and all(f"    {name} " in err for name in names())


def test_a_script_without_options_refuses_them(capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["tour", "--scene"])
    assert "--scene is refused" in capsys.readouterr().err


PROCESSES = {
    "studies.experiment.hysteresis --help": (2, "a study runs as python -m studies NAME; --list gives"),
    "studies": (1, "pip uninstall beam"),
}


@pytest.mark.parametrize("argv", PROCESSES)
def test_a_study_as_a_module_and_a_foreign_package_of_the_same_name_are_refused(tmp_path, argv):
    code, words = PROCESSES[argv]
    (tmp_path / "beam").mkdir()
    (tmp_path / "beam" / "__init__.py").write_text("")
    command, place = [sys.executable, "-m", *argv.split()], ROOT if code == 2 else tmp_path
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=place, env=env, capture_output=True, text=True)
    assert done.returncode == code and words in done.stderr and not done.stdout


def test_importing_the_studies_changes_nothing():
    """Environment, signals, streams and filters of warnings are as they were."""
    code = """
import os, signal, sys, warnings
seen = lambda: (dict(os.environ), signal.getsignal(signal.SIGINT), list(warnings.filters), sys.stderr)
before = seen()
import studies
assert seen() == before
"""
    env = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=env, check=True)


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_signal_ends_a_program_with_what_it_stored(tmp_path, number):
    """A chart that would take minutes; interrupted when its first column is there, it stores a summary."""
    command = [sys.executable, *"-m studies chart --points 4000 60 --json --out".split(), str(tmp_path)]
    pipes = dict(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    program = subprocess.Popen(command, cwd=ROOT, text=True, **pipes)
    store = tmp_path / "chart" / "single_mode-4000x60"
    for _ in range(1200):
        if list(store.glob("[0-9]*.npz")) or program.poll() is not None:
            break
        time.sleep(0.1)
    program.send_signal(number)
    out, err = program.communicate(timeout=60)
    assert program.returncode == 130, err
    assert json.loads(out)["status"] == "interrupted" and "Traceback" not in err
    assert "go on with: python -m studies chart --points 4000 60" in err
    assert json.loads((tmp_path / "chart" / "summary.json").read_text())["status"] == "interrupted"
    for path in store.glob("[0-9]*.npz"):
        assert np.load(path)["m"].shape == (2, 60)
