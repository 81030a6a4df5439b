"""The store of a sweep: one SQLite file, written by one process while others may read it.

    meta     key TEXT PRIMARY KEY, value TEXT
                 "schema"      number of this layout, SCHEMA
                 "plan"        JSON: what was asked for, with the scene and the program (``program.program``)
    columns  number INTEGER PRIMARY KEY, frequency_hz REAL, direction TEXT ("up" or "down")
    cells    column_number INTEGER, step INTEGER    place in the scan, 0 first; both are the primary key
             excess REAL                            F/F_g - 1
             period INTEGER                         drive periods of the settled orbit, 0 for none
             impacts INTEGER                        in one such period
             cycles INTEGER                         drive periods spent
             reason TEXT                            why the computation failed, "" if it did not
             state BLOB                             end state, float64 little-endian (NULL: none was reached)

The steps of a column are there without gaps from 0 on, because a batch is stored after those before it and in
one transaction.  The journal is a write-ahead log: a process that is killed leaves what it has committed,
and the next one to open the file sees exactly that.  (The system may lose the last seconds in a power
failure; the file stays sound and those cells are computed again.)

Errors of the disk arrive as `RecordError`, one sentence; what was stored before is kept.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

from studies.instruments.atomic_file import RecordError, reason_of
from studies.instruments.sweep.tasks import Batch, Cell
from studies.instruments.sweep.words import not_the_same

__all__ = ["SCHEMA", "Row", "Store", "StoreMismatch", "remove_store"]

SCHEMA = 1

PATIENCE = 60.0
"""Seconds to wait for a reader that holds the file."""

Row = tuple[int, float, str, int, float, int, int, int, str, bytes | None]
"""column number, frequency_hz, direction, step, excess, period, impacts, cycles, reason, state"""

LAYOUT = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE columns (number INTEGER PRIMARY KEY, frequency_hz REAL NOT NULL, direction TEXT NOT NULL);
CREATE TABLE cells (
    column_number INTEGER NOT NULL, step INTEGER NOT NULL, excess REAL NOT NULL, period INTEGER NOT NULL,
    impacts INTEGER NOT NULL, cycles INTEGER NOT NULL, reason TEXT NOT NULL, state BLOB,
    PRIMARY KEY (column_number, step)
) WITHOUT ROWID;
"""

ROWS = """
SELECT column_number, frequency_hz, direction, step, excess, period, impacts, cycles, reason, state
FROM cells JOIN columns ON columns.number = cells.column_number ORDER BY column_number, step
"""


class StoreMismatch(ValueError):
    """A store holds the cells of another sweep; the message is one sentence."""


def _log_of(path: Path) -> Path:
    return path.with_name(path.name + "-wal")


def remove_store(path: Path) -> None:
    """Remove a store with all that it holds, if there is one."""
    for file in (path, _log_of(path), path.with_name(path.name + "-shm")):
        try:
            file.unlink(missing_ok=True)
        except OSError as error:
            raise RecordError(f"{file} cannot be removed: {reason_of(error)}") from error


class Store:
    """An open store.

    Use `Store.begin` to write one, new or to be gone on with, and `Store.read` for one that is there.
    """

    def __init__(self, path: Path, *, writes: bool) -> None:
        self.path = path
        with self._telling():
            self._connection = self._opened("mode=rwc" if writes else "mode=ro")
            try:
                self._connection.execute("SELECT 1 FROM sqlite_master").fetchone()
            except sqlite3.OperationalError:
                if writes or _log_of(path).exists():
                    raise
                # the folder takes no files, not even the log's index: then nobody can be writing there
                self._connection.close()
                self._connection = self._opened("mode=ro&immutable=1")
            if writes:
                self._connection.execute("PRAGMA journal_mode = WAL")
                self._connection.execute("PRAGMA synchronous = NORMAL")

    def _opened(self, mode: str) -> sqlite3.Connection:
        address = f"{self.path.resolve().as_uri()}?{mode}"
        return sqlite3.connect(address, uri=True, timeout=PATIENCE, isolation_level=None)

    @classmethod
    def begin(cls, path: Path, plan: Mapping[str, Any]) -> Store:
        """The store at `path` for the sweep `plan` (in terms of JSON), made if it is not there.

        Raises
        ------
        StoreMismatch
            If it holds the cells of another sweep; the message names the values that differ.
        """
        store = cls(path, writes=True)
        try:
            with store._transaction() as run:
                if not run("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                    for statement in LAYOUT.split(";")[:-1]:
                        run(statement)
                    run("INSERT INTO meta VALUES ('schema', ?)", (str(SCHEMA),))
                    run("INSERT INTO meta VALUES ('plan', ?)", (json.dumps(plan, sort_keys=True),))
            store.require(plan)
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def read(cls, path: Path) -> Store:
        """The store at `path`, to be read only; ValueError if there is none."""
        if not path.is_file():
            raise ValueError(f"there is no store {path}")
        store = cls(path, writes=False)
        try:
            store.plan()
        except BaseException:
            store.close()
            raise
        return store

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the log is folded into it."""
        with self._telling():
            self._connection.close()

    def plan(self) -> dict[str, Any]:
        """What was asked for; StoreMismatch for a file that is no store of ours."""
        with self._telling():
            meta = dict(self._connection.execute("SELECT key, value FROM meta").fetchall())
        if meta.get("schema") != str(SCHEMA):
            raise StoreMismatch(
                f"{self.path} has layout {meta.get('schema')} of a store, and this program reads {SCHEMA}"
            )
        found: dict[str, Any] = json.loads(meta["plan"])
        return found

    def require(self, plan: Mapping[str, Any]) -> None:
        """StoreMismatch unless the store is that of `plan`."""
        sentence = not_the_same(self.path, self.plan(), json.loads(json.dumps(plan)))
        if sentence:
            raise StoreMismatch(sentence)

    def add(self, batch: Batch, cells: Sequence[Cell]) -> None:
        """Store the cells of a batch, all or none; cells that are there already stay as they are."""
        rows = [
            (batch.column, batch.first_step + i, excess, c.period, c.impacts, c.cycles, c.reason, c.state)
            for i, (excess, c) in enumerate(zip(batch.excesses, cells, strict=True))
        ]
        with self._transaction() as run:
            run(
                "INSERT OR IGNORE INTO columns VALUES (?, ?, ?)",
                (batch.column, batch.frequency, batch.direction),
            )
            self._connection.executemany("INSERT OR IGNORE INTO cells VALUES (?, ?, ?, ?, ?, ?, ?, ?)", rows)

    def gather(self, other: Store) -> int:
        """Take over the cells of another store of the same sweep; returns how many that had."""
        self.require(other.plan())
        count = 0
        with self._transaction() as run:
            for row in other.rows():
                number, frequency, direction, *rest = row
                if rest[0] == 0:
                    run("INSERT OR IGNORE INTO columns VALUES (?, ?, ?)", (number, frequency, direction))
                run("INSERT OR IGNORE INTO cells VALUES (?, ?, ?, ?, ?, ?, ?, ?)", (number, *rest))
                count += 1
        return count

    def reached(self, column: int) -> tuple[int, bytes | None]:
        """Steps done in a column, and the state after the last of them."""
        with self._telling():
            row = self._connection.execute(
                "SELECT step, state FROM cells WHERE column_number = ? ORDER BY step DESC LIMIT 1", (column,)
            ).fetchone()
        return (0, None) if row is None else (row[0] + 1, row[1])

    def count(self) -> int:
        """Cells stored."""
        with self._telling():
            return int(self._connection.execute("SELECT count(*) FROM cells").fetchone()[0])

    def failed(self) -> int:
        """Cells whose computation failed."""
        with self._telling():
            query = "SELECT count(*) FROM cells WHERE reason <> ''"
            return int(self._connection.execute(query).fetchone()[0])

    def widest(self) -> tuple[int, int]:
        """Longest reason (characters) and longest state (bytes)."""
        with self._telling():
            query = "SELECT coalesce(max(length(reason)), 0), coalesce(max(length(state)), 0) FROM cells"
            reason, state = self._connection.execute(query).fetchone()
        return int(reason), int(state)

    def rows(self) -> Iterator[Row]:
        """All cells by column and step, a few at a time in memory."""
        with self._telling():
            yield from self._connection.execute(ROWS)

    @contextmanager
    def snapshot(self) -> Iterator[None]:
        """Several readings of one state of the store, whatever is written meanwhile."""
        with self._telling():
            self._connection.execute("BEGIN")
        try:
            yield
        finally:
            with self._telling():
                self._connection.execute("ROLLBACK")

    @contextmanager
    def _transaction(self) -> Iterator[Any]:
        """All statements run in it take effect, or none."""
        with self._telling():
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield self._connection.execute
                self._connection.execute("COMMIT")
            except BaseException:
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            if "not a database" in str(error) or "no such table" in str(error):
                raise StoreMismatch(f"{self.path} is not the store of a sweep") from error
            raise RecordError(
                f"the store {self.path} cannot be used: {error}; what was stored before is kept"
            ) from error
