"""The cells of a sweep as one file that other programs read.

    python -m studies.export results/chart/single_mode-400x400.sqlite               -> the same name, .npz
    python -m studies.export results/chart/*-of-8.sqlite --to csv --out chart.csv   shards of one sweep as one

Reads while the sweep is still running, too, and then gives what is there.  Output: one .npz or .csv file; its
columns and their units are in ``studies.instruments.sweep.columns_file``, the store itself in
``studies.instruments.sweep.store``.  Run time: a second for 100 000 cells; memory does not depend on their
number.  Command: python -m studies.export STORE [STORE ...] [--to csv] [--out FILE].  Exit codes: 0 done, 2
wrong use or a file that cannot be read or written, 130 interrupted.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from studies.instruments.command_line import DONE, INTERRUPTED, WRONG_USE
from studies.instruments.record import SCHEMA
from studies.instruments.sweep.columns_file import write_csv, write_npz
from studies.instruments.sweep.store import Store

FORMATS = {"npz": write_npz, "csv": write_csv}
COMMAND = "python -m studies.export"


def export(stores: Sequence[Path], path: Path, *, form: str, states: bool) -> int:
    """Write the cells of `stores`, shards of one sweep, to `path`; returns their number."""
    write = FORMATS[form]
    if len(stores) == 1:
        with Store.read(stores[0]) as store:
            return write(store, path, states=states)
    with Store.read(stores[0]) as first:
        plan = first.plan()
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        with Store.begin(Path(folder) / "gathered.sqlite", plan) as whole:
            for name in stores:
                with Store.read(name) as part:
                    whole.gather(part)
            return write(whole, path, states=states)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=COMMAND, description="Write the cells of a sweep from its store.", allow_abbrev=False
    )
    parser.add_argument("stores", nargs="+", type=Path, metavar="STORE",
                        help="one store, or shards of one sweep")
    parser.add_argument("--to", choices=sorted(FORMATS), default=None,
                        help="format (default: that of --out, or npz)")
    parser.add_argument("--out", type=Path, default=None, metavar="FILE",
                        help="file to write (default: the name of the first store with another ending)")
    parser.add_argument("--states", action="store_true", help="with the end states")
    parser.add_argument("--json", action="store_true", help="print what was done as one JSON object")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Export from the command line."""
    try:
        arguments = _parser().parse_args(argv)
    except SystemExit as leaving:
        return DONE if leaving.code in (None, 0) else WRONG_USE
    ending = "" if arguments.out is None else arguments.out.suffix[1:]
    if ending and ending not in FORMATS and arguments.to is None:
        print(f"{COMMAND}: --out ends in .{ending}; it must end in .csv or .npz, or --to say which",
              file=sys.stderr)
        return WRONG_USE
    form = arguments.to or ending or "npz"
    path = arguments.out or arguments.stores[0].with_suffix(f".{form}")
    try:
        count = export(arguments.stores, path, form=form, states=arguments.states)
    except (ValueError, OSError) as error:
        print(f"{COMMAND}: {error}", file=sys.stderr)
        if arguments.json:
            print(json.dumps({"schema": SCHEMA, "study": "export", "status": "refused", "error": str(error)}))
        return WRONG_USE
    except KeyboardInterrupt:
        print(f"{COMMAND}: interrupted; nothing was written", file=sys.stderr)
        return INTERRUPTED
    print(f"{COMMAND}: {count} cells in {path}", file=sys.stderr)
    if arguments.json:
        answer = {"schema": SCHEMA, "study": "export", "status": "done", "cells": count, "file": str(path)}
        print(json.dumps(answer))
    return DONE


if __name__ == "__main__":
    raise SystemExit(main())
