"""A store as npz and csv: the same cells, whole or absent, with memory that does not grow."""

from __future__ import annotations

import csv
import json
import tracemalloc

import numpy as np
import pytest

from studies import export
from studies.instruments.atomic_file import RecordError
from studies.instruments.sweep import columns_file
from studies.instruments.sweep.columns_file import write_csv, write_npz
from studies.instruments.sweep.store import Store
from studies.instruments.sweep.tasks import Batch, Cell

PLAN = {"study": "test"}


def fill(path, columns: int, steps: int) -> None:
    with Store.begin(path, PLAN) as store:
        for column in range(columns):
            excesses = tuple(0.001 * i - 0.01 / 3 for i in range(steps))
            here = Batch(column=column, frequency=20 + column / 7, direction=("up", "down")[column % 2],
                         first_step=0, excesses=excesses, state=None)  # fmt: skip
            store.add(here, [
                Cell(period=i % 5, impacts=i % 3, cycles=32 * i, reason="went, \"wrong\"" if i == 1 else "",
                     state=None if i == 1 else np.array([i, column, np.pi]).astype("<f8").tobytes())
                for i in range(steps)
            ])  # fmt: skip


def test_npz_and_csv_hold_the_same_cells(tmp_path, capsys):
    store = tmp_path / "s.sqlite"
    fill(store, 4, 7)
    assert export.main([str(store), "--states"]) == 0
    assert export.main([str(store), "--to", "csv", "--states", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["status"], answer["cells"]) == ("done", 28)
    arrays = np.load(tmp_path / "s.npz")
    with (tmp_path / "s.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 28
    assert arrays["column"].tolist() == [c for c in range(4) for _ in range(7)]
    assert arrays["step"].tolist() == 4 * list(range(7))
    for name in ("frequency_hz", "excess", "period", "impacts", "cycles", "step", "column"):
        assert [float(row[name]) for row in rows] == arrays[name].tolist()
    assert [row["reason"] for row in rows] == arrays["reason"].tolist()
    assert rows[1]["reason"] == 'went, "wrong"'
    assert [row["direction"] for row in rows] == [("up", "down")[way] for way in arrays["direction"]]
    states = np.array([[float(row[f"state_{k}"]) for k in range(3)] for row in rows])
    np.testing.assert_array_equal(states, arrays["state"])
    np.testing.assert_array_equal(states[0], [0.0, 0.0, np.pi])
    assert np.all(np.isnan(states[1]))


def test_shards_are_exported_as_one(tmp_path):
    fill(tmp_path / "whole.sqlite", 4, 3)
    with Store.read(tmp_path / "whole.sqlite") as whole:
        rows = list(whole.rows())
    for k in (0, 1):
        with Store.begin(tmp_path / f"{k}.sqlite", PLAN) as part:
            for row in rows:
                if row[0] // 2 == k:
                    here = Batch(column=row[0], frequency=row[1], direction=row[2], first_step=row[3],
                                 excesses=(row[4],), state=None)  # fmt: skip
                    cell = Cell(period=row[5], impacts=row[6], cycles=row[7], reason=row[8], state=row[9])
                    part.add(here, [cell])
    names = [str(tmp_path / name) for name in ("1.sqlite", "0.sqlite")]
    assert export.main([*names, "--out", str(tmp_path / "both.csv")]) == 0
    assert export.main([str(tmp_path / "whole.sqlite"), "--out", str(tmp_path / "one.csv")]) == 0
    assert (tmp_path / "both.csv").read_bytes() == (tmp_path / "one.csv").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir() if p.name.startswith(".")) == []


def test_wrong_use_is_one_sentence(tmp_path, capsys):
    (tmp_path / "text").write_text("x" * 5000)
    fill(tmp_path / "s.sqlite", 1, 2)
    for argv, words in (
        ([str(tmp_path / "absent.sqlite")], "there is no store"),
        ([str(tmp_path / "text")], "is not the store of a sweep"),
        ([str(tmp_path / "s.sqlite"), "--out", str(tmp_path / "no" / "x.csv")], "cannot be written"),
    ):
        assert export.main(argv) == 2
        out, err = capsys.readouterr()
        assert words in err and err.count("\n") == 1 and out == ""


@pytest.mark.parametrize("write", [write_csv, write_npz])
def test_a_failure_leaves_no_file(tmp_path, write, monkeypatch):
    fill(tmp_path / "s.sqlite", 2, 5)
    with Store.read(tmp_path / "s.sqlite") as store:
        rows = Store.rows

        def broken(self):
            yield next(rows(self))
            raise OSError(5, "Input/output error")

        monkeypatch.setattr(Store, "rows", broken)
        with pytest.raises(RecordError, match="cannot be written: Input/output error"):
            write(store, tmp_path / f"x.{write.__name__[6:]}")
    assert [p.name for p in tmp_path.iterdir() if not p.name.startswith("s.sqlite")] == []


def test_memory_does_not_grow_with_the_store(tmp_path, monkeypatch):
    monkeypatch.setattr(columns_file, "CHUNK", 64)
    peaks = []
    for steps in (500, 500, 2_500):  # the first one pays for imports
        path = tmp_path / f"{steps}.sqlite"
        fill(path, 1, steps)
        with Store.read(path) as store:
            tracemalloc.start()
            assert write_npz(store, tmp_path / "x.npz") == steps
            assert write_csv(store, tmp_path / "x.csv") == steps
            peaks.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
    assert peaks[2] < 1.2 * peaks[1]
