"""A store as columns in one file: npz for programs, csv for people.

One row a cell, by column and step:

    column, frequency_hz, direction, step, excess, period, impacts, cycles, reason, state

with `direction` "up" or "down" in csv and 0 or 1 in npz; `state` (2 n_modes + 3 numbers: q, q', regime, wait,
rebound; NaN where none was reached) only if asked for.  Rows pass one by one, so that memory does not depend
on the size of the store; the file is complete or absent.
"""

from __future__ import annotations

import csv
import io
import os
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from operator import itemgetter
from pathlib import Path
from typing import IO, Any

import numpy as np

from studies.instruments.atomic_file import RecordError, reason_of
from studies.instruments.sweep.store import Row, Store
from studies.instruments.sweep.tasks import DIRECTIONS

__all__ = ["NAMES", "write_csv", "write_npz"]

NAMES = (
    "column", "frequency_hz", "direction", "step", "excess", "period", "impacts", "cycles", "reason", "state"
)  # fmt: skip
REASON, STATE = NAMES.index("reason"), NAMES.index("state")
CHUNK = 4096
"""Rows turned into bytes at a time."""


def _state(row: Row, width: int) -> np.ndarray:
    state: Any = row[STATE]
    return np.full(width, np.nan) if state is None else np.frombuffer(state, dtype="<f8")


def write_csv(store: Store, path: Path, *, states: bool = False) -> int:
    """Write the cells of `store` to `path`; returns their number."""
    with store.snapshot(), _complete_or_absent(path) as stream:
        text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        width = store.widest()[1] // 8 if states else 0
        writer.writerow([*NAMES[:STATE], *(f"state_{k}" for k in range(width))])
        count = 0
        for count, row in enumerate(store.rows(), start=1):  # noqa: B007
            values = [repr(float(x)) for x in _state(row, width)] if width else []
            writer.writerow([*row[:STATE], *values])
        text.flush()
        text.detach()
    return count


def write_npz(store: Store, path: Path, *, states: bool = False) -> int:
    """Write the cells of `store` to `path`; returns their number."""
    with store.snapshot(), _complete_or_absent(path) as stream:
        count, (longest, widest) = store.count(), store.widest()
        kinds: dict[str, tuple[Any, tuple[int, ...], Callable[[Row], Any]]] = {}
        for place, name in enumerate(NAMES[:STATE]):
            real = name in ("frequency_hz", "excess")
            kinds[name] = (np.dtype("<f8" if real else "<i8"), (), itemgetter(place))
        kinds["direction"] = (np.dtype("<i8"), (), lambda row: DIRECTIONS.index(row[2]))
        kinds["reason"] = (np.dtype(f"<U{max(1, longest)}"), (), lambda row: row[REASON])
        if states:
            kinds["state"] = (np.dtype("<f8"), (widest // 8,), lambda row: _state(row, widest // 8))
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name, (kind, shape, value) in kinds.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                    header = {"descr": kind.str, "fortran_order": False, "shape": (count, *shape)}
                    np.lib.format.write_array_header_2_0(member, header)
                    for rows in _chunks(store):
                        member.write(np.array([value(row) for row in rows], dtype=kind).tobytes())
    return count


def _chunks(store: Store) -> Iterator[list[Row]]:
    chunk: list[Row] = []
    for row in store.rows():
        chunk.append(row)
        if len(chunk) == CHUNK:
            yield chunk
            chunk = []
    if chunk:
        yield chunk


@contextmanager
def _complete_or_absent(path: Path) -> Iterator[IO[bytes]]:
    """A file that takes the name `path` when everything is in it."""
    temporary: Path | None = None
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as stream:
            temporary = Path(stream.name)
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    except BaseException as error:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError) and not isinstance(error, RecordError):
            raise RecordError(f"{path} cannot be written: {reason_of(error)}") from error
        raise
