"""One page with the results of all studies, to read, print and pass on.

Gathered: the answers to the questions that the letter raises, the letter point by point, for
each study its account, figures and tables, what was assumed, and versions. Nothing is computed and no result
is typed in (``studies.shell.page``).

Run:     python -m studies report [--site] [--out DIR]     DIR is the folder of results
Writes:  DIR/report/index.html; with --site DIR/site, that page with the documentation of the packages
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path

from studies.shell.options import Parser, tool
from studies.shell.page import in_words, write_page
from studies.shell.page.documentation import module_names, write_site
from studies.shell.programs import COMMAND


def report(given: Namespace) -> tuple[str, Mapping[str, object]]:
    """Write the page, and the site."""
    path, found, missing = write_page(given.out)
    faults = [fault for stored in found for fault in stored.faults]
    lines, studies = [*faults, in_words(path, found, missing)], [stored.study for stored in found]
    answer = {"page": path, "studies": studies, "missing": missing, "faults": faults}
    if given.site:
        answer["site"] = write_site(given.out, path, module_names())
        lines.append(f"documentation: {answer['site']}")
    return "\n".join(lines), answer


def main(argv: Sequence[str] | None = None) -> int:
    """Write the page; returns 0, or 2 for wrong use and where there are no results."""
    parser = Parser(f"{COMMAND} report", __doc__ or "")
    parser.add_argument("--out", type=Path, default=Path("results"), metavar="DIR", help="folder of results")
    parser.add_argument("--site", action="store_true", help="write the documentation, too (needs pdoc)")
    return tool(parser, argv, report)
