"""The cells of a sweep as one file that other programs read.

    python -m studies.export results/chart/single_mode-400x400               -> the same name, .csv

The csv has one line a cell: the arrays of each column (frequency_hz, direction, excess, period, impacts,
cycles, reason for the chart) broadcast against one another. What a running sweep has stored so far is given,
too. Exit codes: 0 done, 2 wrong use or a file that cannot be read or written.

Run:     python -m studies.export FOLDER [--out FILE]
Writes:  FILE
"""

from __future__ import annotations

import csv
import io
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from beam import InvalidValue
from studies.files import write_atomically
from studies.options import Parser, tool
from studies.sweep import Column, read_columns


def csv_of(columns: Sequence[Column]) -> bytes:
    """One line a cell."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns[0])
    for column in columns:
        cells = np.broadcast_arrays(*column.values())
        writer.writerows(zip(*(array.ravel().tolist() for array in cells), strict=True))
    return stream.getvalue().encode()


def export(given: Namespace) -> tuple[str, Mapping[str, object]]:
    """Write the columns of the sweep in a folder."""
    path = given.out or given.folder.with_name(f"{given.folder.name}.csv")
    if path.suffix != ".csv":
        raise InvalidValue(f"--out is {path}; it must end in .csv")
    _, columns = read_columns(given.folder)
    if not columns:
        raise InvalidValue(f"no column of the sweep in {given.folder} is there yet")
    write_atomically(path, csv_of([column for _, column in columns]))
    return f"{len(columns)} columns in {path}", {"columns": len(columns), "file": path}


def main(argv: Sequence[str] | None = None) -> int:
    """Export from the command line."""
    parser = Parser("python -m studies.export", __doc__ or "")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of a sweep")
    parser.add_argument("--out", type=Path, metavar="FILE", help="file to write (default: beside the folder)")
    return tool(parser, argv, export)


if __name__ == "__main__":
    raise SystemExit(main())
