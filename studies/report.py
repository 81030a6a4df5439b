"""One page with the results of all studies, to read, print and pass on.

Gathered: the answers to the questions that the letter raises, the letter point by point, for
each study its account, figures and tables, what was assumed, and versions. Nothing is computed and no result
is typed in (``studies.shell.page``).

Run:     python -m studies report [--out DIR]     DIR is the folder of results
Writes:  DIR/report/index.html
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path

from studies.shell.options import Parser, tool
from studies.shell.page import in_words, write_page
from studies.shell.programs import COMMAND


def report(given: Namespace) -> tuple[str, Mapping[str, object]]:
    """Write the page."""
    path, found, missing = write_page(given.out)
    faults, studies = (
        [fault for stored in found for fault in stored.faults],
        [stored.study for stored in found],
    )
    answer = {"page": path, "studies": studies, "missing": missing, "faults": faults}
    return "\n".join([*faults, in_words(path, found, missing)]), answer


def main(argv: Sequence[str] | None = None) -> int:
    """Write the page; returns 0, or 2 for wrong use and where there are no results."""
    parser = Parser(f"{COMMAND} report", __doc__ or "")
    parser.add_argument("--out", type=Path, default=Path("results"), metavar="DIR", help="folder of results")
    return tool(parser, argv, report)
