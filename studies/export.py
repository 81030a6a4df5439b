"""The cells of a sweep as one file that other programs read.

    python -m studies.export results/chart/single_mode-400x400               -> the same name, .csv
    python -m studies.export results/chart/single_mode-400x400 --out chart.npz

A csv has one line a cell: the arrays of each column (frequency_hz, direction, excess, period, impacts,
cycles, reason for the chart) broadcast against one another. An npz has them stacked, one entry a column
along the first axis. What a running sweep has stored so far is given, too. Exit codes: 0 done, 2 wrong use
or a file that cannot be read or written.

Run:     python -m studies.export FOLDER [--to csv|npz] [--out FILE]     1 s for 100 000 cells
Writes:  FILE
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from studies.files import json_text, write_atomically
from studies.record import SCHEMA
from studies.sweep import Column, read_columns

COMMAND = "python -m studies.export"


def csv_of(columns: Sequence[Column]) -> bytes:
    """One line a cell."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns[0])
    for column in columns:
        cells = np.broadcast_arrays(*column.values())
        writer.writerows(zip(*(array.ravel().tolist() for array in cells), strict=True))
    return stream.getvalue().encode()


def npz_of(columns: Sequence[Column]) -> bytes:
    """The arrays of all columns, stacked."""
    stream = io.BytesIO()
    stacked = {name: np.stack([column[name] for column in columns]) for name in columns[0]}
    np.savez_compressed(stream, **stacked)  # type: ignore[arg-type]
    return stream.getvalue()


FORMATS = {"csv": csv_of, "npz": npz_of}


def export(folder: Path, path: Path, form: str) -> int:
    """Write the columns of the sweep in `folder` to `path`; returns their number."""
    _, columns = read_columns(folder)
    if not columns:
        raise ValueError(f"no column of the sweep in {folder} is there yet")
    write_atomically(path, FORMATS[form]([column for _, column in columns]))
    return len(columns)


def main(argv: Sequence[str] | None = None) -> int:
    """Export from the command line."""
    parser = argparse.ArgumentParser(
        prog=COMMAND, description=__doc__, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of a sweep")
    parser.add_argument("--to", choices=sorted(FORMATS), help="format (default: that of --out, or csv)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="file to write (default: beside the folder)")
    parser.add_argument("--json", action="store_true", help="print what was done as one JSON object")
    try:
        given = parser.parse_args(argv)
    except SystemExit as leaving:
        return 0 if leaving.code in (None, 0) else 2
    answer: dict[str, object] = {"schema": SCHEMA, "study": "export"}
    try:
        ending = given.out.suffix[1:] if given.out else ""
        if ending and ending not in FORMATS and given.to is None:
            raise ValueError(f"--out ends in .{ending}; it must end in .csv or .npz, or --to say which")
        form = given.to or ending or "csv"
        path = given.out or given.folder.with_name(f"{given.folder.name}.{form}")
        count = export(given.folder, path, form)
    except (ValueError, OSError) as error:
        print(f"{COMMAND}: {error}", file=sys.stderr)
        if given.json:
            print(json_text({**answer, "status": "refused", "error": str(error), "exit_code": 2}))
        return 2
    print(f"{COMMAND}: {count} columns in {path}", file=sys.stderr)
    if given.json:
        print(json_text({**answer, "status": "done", "columns": count, "file": path, "exit_code": 0}))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
