"""Sweeps: stored as they are made, gone on with after any end, the same on every executor."""

import json
import os
import random
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from studies.shell.run import Run
from studies.shell.scene import read_scene
from studies.shell.sweep import sweep

SETTINGS = {"model": "toy", "rows": 3}


@dataclass(frozen=True)
class Powers:
    """A column that anyone can check; slow, so that a kill meets it."""

    seconds: float = 0.0

    def __call__(self, x: float) -> dict[str, np.ndarray]:
        time.sleep(self.seconds)
        return {"x": np.array(x), "power": x ** np.arange(3.0), "row": np.arange(3)}


def run_in(folder: Path, executor: str = "", workers: int = 2) -> Run:
    scene = read_scene("letter")
    return Run(study="toy", folder=folder, scene=scene, command="", executor=executor, workers=workers)


def powers_in(columns) -> list[list[float]]:
    return [column["power"].tolist() for column in columns]


ARGUMENTS = [0.5 * k for k in range(24)]
EXPECTED = [[x**0, x, x**2] for x in ARGUMENTS]


@pytest.mark.parametrize("executor", ["threads", pytest.param("processes", marks=pytest.mark.slow)])
def test_columns_are_the_same_on_every_executor(tmp_path, executor):
    columns = sweep(run_in(tmp_path, executor), "toy", SETTINGS, ARGUMENTS, Powers())
    assert powers_in(columns) == EXPECTED


def test_columns_are_the_same_on_a_cluster(tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", dashboard_address=None
    ) as cluster:
        address = cluster.scheduler_address.removeprefix("tcp://")
        columns = sweep(run_in(tmp_path, f"dask://{address}"), "toy", SETTINGS, ARGUMENTS, Powers())
    assert powers_in(columns) == EXPECTED


def test_what_is_there_is_not_computed_again(tmp_path):
    made: list[float] = []

    def counted(x: float) -> dict[str, np.ndarray]:
        made.append(x)
        return Powers()(x)

    run = run_in(tmp_path)
    sweep(run, "toy", SETTINGS, ARGUMENTS[:5], counted)
    (tmp_path / "toy" / "00001.npz").unlink()
    (tmp_path / "toy" / "00003.npz").write_bytes(b"damaged")
    assert powers_in(sweep(run, "toy", SETTINGS, ARGUMENTS[:5], counted)) == EXPECTED[:5]
    assert sorted(made) == sorted([*ARGUMENTS[:5], ARGUMENTS[1], ARGUMENTS[3]])


def test_another_sweep_in_the_same_folder_is_refused_unless_it_begins_anew(tmp_path, monkeypatch):
    """Columns that older source has made are another sweep."""
    run = run_in(tmp_path)
    sweep(run, "toy", SETTINGS, ARGUMENTS[:2], Powers())
    with pytest.raises(ValueError, match="rows"):
        sweep(run, "toy", {**SETTINGS, "rows": 4}, ARGUMENTS[:2], Powers())
    sweep(run, "toy", {**SETTINGS, "rows": 4}, ARGUMENTS[:2], Powers(), fresh=True)
    assert json.loads((tmp_path / "toy" / "settings.json").read_text())["rows"] == 4
    monkeypatch.setattr("studies.shell.sweep.source", lambda: "another")
    with pytest.raises(ValueError, match="another source"):
        sweep(run, "toy", {**SETTINGS, "rows": 4}, ARGUMENTS[:2], Powers())


def test_a_failure_of_the_program_ends_the_sweep_and_keeps_what_is_there(tmp_path):
    def fails(x: float) -> dict[str, np.ndarray]:
        if x == ARGUMENTS[4]:
            raise RuntimeError("out of luck")
        return Powers()(x)

    run = run_in(tmp_path, workers=1)
    with pytest.raises(RuntimeError):
        sweep(run, "toy", SETTINGS, ARGUMENTS[:8], fails)
    assert len(list((tmp_path / "toy").glob("[0-9]*.npz"))) >= 3
    assert powers_in(sweep(run, "toy", SETTINGS, ARGUMENTS[:8], Powers())) == EXPECTED[:8]


def test_kills_are_survived(tmp_path):
    """A child process sweeps and is killed at random, four times; then it is left to finish.

    Two threads need 0.96 s for all columns, the four runs end within 0.32 s: none can finish on any machine.
    """
    rng = random.Random(5)
    for kill in range(5):
        child = os.fork()
        if child == 0:
            code = 1
            try:
                sweep(run_in(tmp_path), "toy", SETTINGS, ARGUMENTS, Powers(seconds=0.08))
                code = 0
            finally:
                os._exit(code)
        if kill < 4:
            time.sleep(rng.uniform(0.0, 0.08))
            os.kill(child, signal.SIGKILL)
        assert os.waitpid(child, 0)[1] == (signal.SIGKILL if kill < 4 else 0)
        for path in (tmp_path / "toy").glob("[0-9]*.npz"):
            assert set(np.load(path)) == {"x", "power", "row"}
    assert powers_in(map(np.load, sorted((tmp_path / "toy").glob("[0-9]*.npz")))) == EXPECTED
