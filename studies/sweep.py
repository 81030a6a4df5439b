"""Many columns of cells on any executor, stored as they are made: a sweep survives a kill and goes on.

    columns = sweep(run, "beam-120x120", settings, frequencies, compute, shard=Shard.of("2/8"))

    results/STUDY/NAME/settings.json     all that the numbers depend on
                       00017.npz         column 17, written when it was made, complete or absent

A column is what `compute` returns for one argument: named arrays. The columns have nothing to do with one
another: any executor (`run.pool`) computes them in any order with the same result. What is there is not
computed again; other settings in the same folder are refused. Shards of one sweep (a job array) write into
the same folder, k/n takes the columns k - 1, k - 1 + n, ..., so that neighbours, which cost about the same,
are shared out.
"""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from studies.files import json_text, source, write_atomically
from studies.record import Run

Column = Mapping[str, NDArray[np.generic]]
A = TypeVar("A")

AHEAD = 2
"""Columns handed out for each worker: one computed, one waiting."""

SETTINGS = "settings.json"


@dataclass(frozen=True, kw_only=True)
class Shard:
    """Part `number` of `count` of a sweep."""

    number: int = 1
    count: int = 1

    @staticmethod
    def of(text: str) -> Shard:
        """From k/n."""
        found = re.fullmatch(r"(\d+)/(\d+)", text, re.ASCII)
        if found is None or not 1 <= int(found[1]) <= int(found[2]):
            raise InvalidValue(f"shard is {text!r}; it must be k/n with 1 <= k <= n, for instance 2/8")
        return Shard(number=int(found[1]), count=int(found[2]))


def _path(folder: Path, number: int) -> Path:
    return folder / f"{number:05d}.npz"


def _read(path: Path) -> Column | None:
    """The column in a file; None if it is not there, or is none."""
    try:
        with np.load(path) as file:
            return dict(file)
    except (OSError, ValueError, KeyError, EOFError):
        return None


def read_columns(folder: Path) -> tuple[dict[str, object], list[tuple[int, Column]]]:
    """The settings of a sweep and its columns with their numbers, as far as they are there.

    Raises
    ------
    ValueError
        If the folder holds no sweep.
    """
    try:
        settings = json.loads((folder / SETTINGS).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InvalidValue(
            f"there is no sweep in {folder}: it needs {SETTINGS} and columns 00000.npz, ..."
        ) from error
    columns = ((int(path.stem), _read(path)) for path in sorted(folder.glob("[0-9]*.npz")))
    return settings, [(number, column) for number, column in columns if column is not None]


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
    shard: Shard | None = None,
    fresh: bool = False,
) -> list[Column | None]:
    """Compute the columns of `shard` (all by default) that are not stored yet; returns all that are there,
    in order.

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
    shard : Shard, optional
    fresh : bool
        Forget what is stored.

    Raises
    ------
    ValueError
        If other settings are stored in the folder.
    """
    folder, part = run.path(name), Shard() if shard is None else shard
    _begin(folder, {"columns": len(arguments), "source": source(), **settings}, fresh)
    columns = [_read(_path(folder, number)) for number in range(len(arguments))]
    missing = [n for n in range(part.number - 1, len(arguments), part.count) if columns[n] is None]
    if not missing:
        return columns
    waiting, flight = iter(missing), dict[Future[Column], int]()
    with run.pool() as pool, run.progress(f"columns of {name}", len(missing)) as tick:
        while True:
            for number in islice(waiting, AHEAD * run.workers - len(flight)):
                flight[pool.submit(compute, arguments[number])] = number
            if not flight:
                return columns
            for future in wait(flight, return_when=FIRST_COMPLETED).done:
                stream, path = io.BytesIO(), _path(folder, flight[future])
                np.savez_compressed(stream, **future.result())  # type: ignore[arg-type]
                write_atomically(path, stream.getvalue())
                columns[flight.pop(future)] = _read(path)
                tick()
