"""Writing the page: from a folder of results to results/report/index.html.

write_report(Path("results"))     Report: where the page is, how large, what it holds and lacks
told_report(Path("results"))      the same as one sentence, whatever happens
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from studies import ROOT
from studies.instruments.atomic_file import make_folder, write_atomically
from studies.instruments.report import assumed
from studies.instruments.report.declared import DECLARED, WITHOUT_SUMMARY
from studies.instruments.report.entry import Entry
from studies.instruments.report.page import Contents, html
from studies.instruments.report.stored import OWN_FOLDER, Stored, read_all
from studies.instruments.report.turnable import Turnable, turnable

PAGE = "index.html"
HERE = ROOT / "studies"


class NoResults(ValueError):
    """There is nothing to report; the message is one sentence."""


@dataclass(frozen=True, kw_only=True)
class Report:
    """The page that was written, and what it says about itself."""

    path: Path
    size: int
    studies: list[str]
    missing: list[str]
    warnings: list[str]
    faults: list[str]
    turnable: bool


def first_sentence(study: str) -> str:
    """What the docstring of a study says first; empty if there is no such study."""
    source = HERE / f"{study}.py"
    try:
        text = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or ""
    except (OSError, SyntaxError, ValueError):
        return ""
    return " ".join(text.split("\n\n")[0].split())


def entries(stored: Sequence[str]) -> list[Entry]:
    """The declared studies, and those stored that no declaration knows."""
    known = {entry.study for entry in DECLARED}
    others = [
        Entry(
            study=name,
            title=name.replace("_", " ").capitalize(),
            claim=first_sentence(name) or "No description.",
        )
        for name in stored
        if name not in known
    ]
    return [*DECLARED, *others]


def not_run(listed: Sequence[Entry], stored: Sequence[str]) -> list[Entry]:
    """Studies that exist here and have stored nothing."""
    return [
        entry
        for entry in listed
        if entry.study not in stored
        and entry.study not in WITHOUT_SUMMARY
        and (HERE / f"{entry.study}.py").exists()
    ]


def _turned(stored: dict[str, Stored]) -> Turnable | str | None:
    modes = stored.get("modes")
    mesh = None if modes is None else modes.folder / "modes.vtu"
    return turnable(mesh) if mesh is not None and mesh.exists() else None


def write_report(results: Path) -> Report:
    """Read the folder of results, write its page; `NoResults` if there are none."""
    stored = read_all(results) if results.is_dir() else {}
    if not stored:
        raise NoResults(
            f"no results in the folder {results}: run `python -m studies` first, or name another with --out"
        )
    listed = entries(list(stored))
    contents = Contents(
        entries=listed,
        stored=stored,
        missing=not_run(listed, list(stored)),
        made=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        turn=_turned(stored),
    )
    folder = make_folder(results / OWN_FOLDER)
    path = write_atomically(folder / PAGE, html(contents, folder).encode("utf-8"))
    return Report(
        path=path,
        size=path.stat().st_size,
        studies=[entry.study for entry in contents.shown()],
        missing=[entry.study for entry in contents.missing],
        warnings=assumed.warnings(contents.results()),
        faults=[fault for entry in contents.shown() for fault in stored[entry.study].faults],
        turnable=isinstance(contents.turn, Turnable),
    )


def told_report(results: Path) -> str:
    """Write the page at the end of another program; one that cannot be written is a sentence, no failure."""
    try:
        report = write_report(results)
    except (ValueError, OSError) as error:
        return f"no report: {error}"
    return f"report: {report.path} ({report.size / 1e6:.1f} MB, {len(report.studies)} of the studies)"
