"""The store of a sweep: what is stored stays; what differs is refused; what went wrong is told."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

import pytest

from studies.instruments.atomic_file import RecordError
from studies.instruments.sweep.store import Store, StoreMismatch
from studies.instruments.sweep.tasks import Batch, Cell

PLAN = {"study": "test", "scene": {"stop": {"gap_m": 0.01}, "drive": {"frequencies_hz": [22.2]}}}


def batch(column: int = 0, first: int = 0, count: int = 3) -> Batch:
    return Batch(
        column=column, frequency=20.0 + column, direction=("up", "down")[column % 2], first_step=first,
        excesses=tuple(0.01 * (first + i) for i in range(count)), state=None,
    )


def cells(count: int = 3, *, reason: str = "", size: int = 8) -> list[Cell]:
    return [
        Cell(period=i + 1, impacts=1, cycles=32, reason=reason, state=bytes([i]) * size) for i in range(count)
    ]


def test_what_goes_in_comes_out_in_order_and_exactly(tmp_path):
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store:
        assert store.reached(0) == (0, None)
        store.add(batch(column=1), cells())
        store.add(batch(column=0, first=0), cells())
        failed = Cell(period=0, impacts=0, cycles=1, reason="no", state=None)
        store.add(batch(column=0, first=3, count=1), [failed])
        assert store.reached(0) == (4, None) and store.reached(1) == (3, b"\x02" * 8)
        assert (store.count(), store.failed(), store.widest()) == (7, 1, (2, 8))
    with Store.read(tmp_path / "s.sqlite") as store:
        rows = list(store.rows())
        assert store.plan() == PLAN
    assert [(row[0], row[3]) for row in rows] == [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2)]
    assert rows[1] == (0, 20.0, "up", 1, 0.01, 2, 1, 32, "", b"\x01" * 8)
    assert rows[3][5:] == (0, 0, 1, "no", None)


def test_a_batch_is_stored_whole_or_not_at_all(tmp_path):
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store:
        store.add(batch(), cells())
        broken = [*cells(2), Cell(period=object(), impacts=1, cycles=1, reason="", state=b"")]  # type: ignore[arg-type]
        with pytest.raises(RecordError, match=r"s\.sqlite cannot be used"):
            store.add(batch(first=3), broken)
        assert store.reached(0)[0] == store.count() == 3
        store.add(batch(first=3), cells())
        assert store.count() == 6


def test_another_sweep_is_refused_and_the_fields_are_named(tmp_path):
    Store.begin(tmp_path / "s.sqlite", PLAN).close()
    other = {"study": "test", "scene": {"stop": {"gap_m": 0.02}, "drive": {"frequencies_hz": [22.2, 23.0]}}}
    with pytest.raises(StoreMismatch) as refusal:
        Store.begin(tmp_path / "s.sqlite", other)
    sentence = str(refusal.value)
    assert "scene.stop.gap_m was 0.01 and is 0.02" in sentence
    assert "scene.drive.frequencies_hz was [22.2] and is [22.2, 23.0]" in sentence
    assert "scene.study" not in sentence and "\n" not in sentence
    Store.begin(tmp_path / "s.sqlite", PLAN).close()


def test_a_key_that_one_side_lacks_is_named_too(tmp_path):
    Store.begin(tmp_path / "s.sqlite", PLAN).close()
    with pytest.raises(StoreMismatch, match="model was None and is beam"):
        Store.begin(tmp_path / "s.sqlite", {**PLAN, "model": "beam"})


def test_what_is_no_store_is_refused(tmp_path):
    (tmp_path / "text").write_text("not a database, but long enough to have a header" * 20)
    with pytest.raises(StoreMismatch, match="not the store of a sweep"):
        Store.read(tmp_path / "text")
    with pytest.raises(ValueError, match="there is no store"):
        Store.read(tmp_path / "absent.sqlite")


def test_a_full_disk_is_one_sentence_and_loses_nothing(tmp_path):
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store:
        store.add(batch(), cells())
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        with pytest.raises(RecordError) as failure:
            store.add(batch(first=3), cells(size=100_000))
        assert "disk is full; what was stored before is kept" in str(failure.value)
        assert "\n" not in str(failure.value)
        assert store.count() == 3
    with Store.read(tmp_path / "s.sqlite") as store:
        assert [row[9] for row in store.rows()] == [b"\x00" * 8, b"\x01" * 8, b"\x02" * 8]


@pytest.fixture
def nobody():
    """Without the rights of the superuser, to whom no folder is closed."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.fixture
def closed_folder():
    """A folder with a store in it that takes no files any more."""
    folder = Path(tempfile.mkdtemp())
    with Store.begin(folder / "s.sqlite", PLAN) as store:
        store.add(batch(), cells())
    (folder / "s.sqlite").chmod(0o444)
    folder.chmod(0o555)
    yield folder
    folder.chmod(0o755)
    shutil.rmtree(folder)


def test_a_read_only_folder_is_one_sentence_and_can_still_be_read(closed_folder, nobody):
    for name in ("s.sqlite", "new.sqlite"):
        with pytest.raises(RecordError, match=r"cannot be used: .*; what was stored before is kept"):
            Store.begin(closed_folder / name, PLAN).add(batch(first=3), cells())
    with Store.read(closed_folder / "s.sqlite") as store:
        assert store.count() == 3


def test_readers_see_what_is_there_while_it_is_written(tmp_path):
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store:
        store.add(batch(), cells())
        with Store.read(tmp_path / "s.sqlite") as reader, reader.snapshot():
            assert reader.count() == 3
            store.add(batch(first=3), cells())
            assert len(list(reader.rows())) == 3
            assert store.count() == 6


def test_shards_are_gathered_and_strangers_refused(tmp_path):
    with Store.begin(tmp_path / "whole.sqlite", PLAN) as whole:
        for k in (0, 1):
            with Store.begin(tmp_path / f"{k}.sqlite", PLAN) as part:
                part.add(batch(column=k), cells())
                assert whole.gather(part) == 3
        assert [row[:4] for row in whole.rows()] == [
            (0, 20.0, "up", 0), (0, 20.0, "up", 1), (0, 20.0, "up", 2),
            (1, 21.0, "down", 0), (1, 21.0, "down", 1), (1, 21.0, "down", 2),
        ]  # fmt: skip
        with Store.begin(tmp_path / "other.sqlite", {**PLAN, "study": "other"}) as other:
            with pytest.raises(StoreMismatch, match="study"):
                whole.gather(other)
