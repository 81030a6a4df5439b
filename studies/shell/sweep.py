"""Many columns of cells on any executor, stored as they are made: a sweep survives a kill and goes on.

    columns = sweep(run, "beam-120x120", settings, frequencies, compute)

    results/STUDY/NAME/settings.json     all that the numbers depend on
                       00017.npz         column 17, written when it was made, complete or absent

A column is what `compute` returns for one argument: named arrays. The columns are independent: any executor
(`run.pool`) computes them in any order with the same result. What is there is not computed again; other
settings in the same folder are refused.
"""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from itertools import islice
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from studies.shell.files import json_text, source, write_atomically
from studies.shell.run import Run

Column = Mapping[str, NDArray[np.generic]]
A = TypeVar("A")

AHEAD = 2
"""Columns handed out for each worker: one computed, one waiting."""

SETTINGS = "settings.json"

MOST_REASONS = 20  # failures with a sentence of their own; all are in the columns


def _path(folder: Path, number: int) -> Path:
    return folder / f"{number:05d}.npz"


def _read(path: Path) -> Column | None:
    """The column in a file; None if it is not there, or is none."""
    try:
        with np.load(path) as file:
            return dict(file)
    except (OSError, ValueError, KeyError, EOFError):
        return None


def _begin(folder: Path, settings: Mapping[str, object], fresh: bool) -> None:
    """A folder for a sweep with these settings; ValueError if it holds another one."""
    if fresh:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    path, wanted = folder / SETTINGS, json.loads(json_text(settings))
    if path.exists():
        there = json.loads(path.read_text(encoding="utf-8"))
        if there != wanted:
            other = [key for key in sorted({*there, *wanted}) if there.get(key) != wanted.get(key)]
            raise InvalidValue(
                f"{folder} holds a sweep with another {', '.join(other)}: begin anew with --fresh, or "
                "choose another folder with --out"
            )
    write_atomically(path, (json_text(settings) + "\n").encode())


def sweep(
    run: Run,
    name: str,
    settings: Mapping[str, object],
    arguments: Sequence[A],
    compute: Callable[[A], Column],
    *,
    fresh: bool = False,
) -> list[Column]:
    """Compute the columns that are not stored yet; returns all of them in order.

    Parameters
    ----------
    run : Run
    name : str
        Of the folder in the folder of the run.
    settings : mapping, in terms of JSON
        All that the numbers depend on besides the source, which is added; another mapping in the same folder
        is refused, and so are columns of another source.
    arguments : sequence
        One for each column.
    compute : callable
        From an argument to named arrays; for processes and clusters it and the arguments can be pickled.
    fresh : bool
        Forget what is stored.

    Raises
    ------
    ValueError
        If other settings are stored in the folder.
    """
    folder = run.path(name, "The finished columns, from which an interrupted run goes on.")
    _begin(folder, {"columns": len(arguments), "source": source(), **settings}, fresh)
    stored = (_read(_path(folder, number)) for number in range(len(arguments)))
    columns = {number: column for number, column in enumerate(stored) if column is not None}
    missing = [number for number in range(len(arguments)) if number not in columns]
    if not missing:
        return list(columns.values())
    waiting, flight = iter(missing), dict[Future[Column], int]()
    with run.pool() as pool, run.progress(f"columns of {name}", len(missing)) as tick:
        while True:
            for number in islice(waiting, AHEAD * run.workers - len(flight)):
                flight[pool.submit(compute, arguments[number])] = number
            if not flight:
                return [columns[number] for number in range(len(arguments))]
            for future in wait(flight, return_when=FIRST_COMPLETED).done:
                stream, number = io.BytesIO(), flight.pop(future)
                np.savez_compressed(stream, **future.result())  # type: ignore[arg-type]
                write_atomically(_path(folder, number), stream.getvalue())
                stream.seek(0)
                columns[number] = dict(np.load(stream))
                tick()


def note_failures(run: Run, failed: Iterable[tuple[str, str]]) -> None:
    """Every failed cell counts, as (where, reason); the first are said."""
    for where, reason in failed:
        run.failed(where, reason, say=len(run.failures) < MOST_REASONS)
