"""Everything that the studies stored, as one page to read, print and pass on.

Gathered: the two answers (hysteresis; what higher modes do to a collision), the letter point by point, for
each study its account, figures and tables, what was assumed, versions, and the studies that have not been
run. Nothing is computed and no result is typed in (``studies.page``).

Run:     python -m studies.report [--out DIR]     2 s; DIR is the folder of results (default: results)
Writes:  DIR/report/index.html
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from studies.files import json_text
from studies.page import write_page
from studies.record import SCHEMA

COMMAND = "python -m studies.report"


def main(argv: Sequence[str] | None = None) -> int:
    """Write the page; returns 0, or 2 for wrong use and where there are no results."""
    parser = argparse.ArgumentParser(
        prog=COMMAND, description=__doc__, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--out", type=Path, default=Path("results"), metavar="DIR", help="folder of results")
    parser.add_argument("--json", action="store_true", help="print what was done as one JSON object")
    try:
        given = parser.parse_args(argv)
    except SystemExit as leaving:
        return 0 if leaving.code in (None, 0) else 2
    answer: dict[str, object] = {"schema": SCHEMA, "study": "report"}
    try:
        path, found, missing = write_page(given.out)
    except (ValueError, OSError) as error:
        print(f"{COMMAND}: {error}", file=sys.stderr)
        if given.json:
            print(json_text({**answer, "status": "refused", "error": str(error), "exit_code": 2}))
        return 2
    faults = [fault for stored in found for fault in stored.faults]
    for sentence in [*faults, *([f"not run: {', '.join(missing)}"] if missing else [])]:
        print(sentence, file=sys.stderr)
    print(f"{COMMAND}: {len(found)} studies, {path.stat().st_size / 1e6:.1f} MB in {path}", file=sys.stderr)
    if given.json:
        studies = [stored.study for stored in found]
        done = {"status": "done", "page": path, "studies": studies, "missing": missing, "faults": faults}
        print(json_text({**answer, **done, "exit_code": 0}))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
