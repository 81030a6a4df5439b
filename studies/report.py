"""Everything that the studies stored, as one page to read, print and pass on.

Gathered: for each study its claim, figures and table, the points of the letter that it speaks to, command,
run time and settings; in front of them the two answers (hysteresis; what higher modes do to a collision) and
the letter point by point; behind them what was assumed, versions, and the studies that have not been run.
Nothing is computed here but what a table needs, and no result is typed in: a page made from other results
says other things.

The page is one file that needs no network: pictures, style and script are inside, and its content policy
forbids every request. Figures open enlarged. With the extra `web` the modes of `studies.modes` can be turned
in it. What is missing or broken in the results becomes a sentence on the page.

Run time: a second. Command: python -m studies.report [--out DIR]. Output: DIR/report/index.html, DIR being
the folder of results (default: results). Exit codes: 0 done, 2 wrong use or no results at all.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from studies.instruments.command_line import DONE, INTERRUPTED, WRONG_USE
from studies.instruments.record import SCHEMA
from studies.instruments.report.writing import write_report

COMMAND = "python -m studies.report"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=COMMAND, description="Gather the stored results in one page.", allow_abbrev=False
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("results"),
        metavar="DIR",
        help="folder of results; the page goes into its own folder there (default: results)",
    )
    parser.add_argument("--json", action="store_true", help="print what was done as one JSON object")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Write the report from the command line."""
    try:
        arguments = _parser().parse_args(argv)
    except SystemExit as leaving:
        return DONE if leaving.code in (None, 0) else WRONG_USE
    try:
        report = write_report(arguments.out)
    except (ValueError, OSError) as error:
        print(f"{COMMAND}: {error}", file=sys.stderr)
        if arguments.json:
            print(json.dumps({"schema": SCHEMA, "study": "report", "status": "refused", "error": str(error)}))
        return WRONG_USE
    except KeyboardInterrupt:
        print(f"{COMMAND}: interrupted; nothing was written", file=sys.stderr)
        return INTERRUPTED
    for sentence in (*report.faults, *report.warnings):
        print(sentence, file=sys.stderr)
    if report.missing:
        print(f"not run: {', '.join(report.missing)}", file=sys.stderr)
    print(
        f"{COMMAND}: {len(report.studies)} studies, {report.size / 1e6:.1f} MB in {report.path}",
        file=sys.stderr,
    )
    if arguments.json:
        print(
            json.dumps(
                {
                    "schema": SCHEMA,
                    "study": "report",
                    "status": "done",
                    "page": str(report.path),
                    "bytes": report.size,
                    "studies": report.studies,
                    "missing": report.missing,
                    "warnings": report.warnings,
                    "faults": report.faults,
                    "turnable": report.turnable,
                }
            )
        )
    return DONE


if __name__ == "__main__":
    raise SystemExit(main())
