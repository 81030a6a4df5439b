"""One page of everything that the studies stored, to read, print and pass on: results/report/index.html.

The template (page.html.j2) has generic sections: the answers to the letter's questions, the letter point
by point, then each study with its docstring, figures and tables, and last what the results rest on. Nothing
is said here of any study: titles and accounts are docstrings, figures and captions come from its manifest,
tables from its csv files, verdicts and answers from its summary. A page made from other results says other
things.

The page is one file that needs no network: pictures and style are inside, and its content policy forbids
every request. What is missing or broken in the results becomes a sentence on the page.
"""

from __future__ import annotations

import base64
import csv
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path

from jinja2 import Environment, FileSystemLoader

from beam import InvalidValue
from studies import letter
from studies.shell.files import write_atomically
from studies.shell.programs import ALL, COMMAND, account_of, studies

MOST_ROWS, MOST_COLUMNS = 40, 12
"""Of a table on the page; a longer one is named and left to its file."""

LARGEST_PICTURE = 4_000_000
"""Bytes of a picture or film that goes into the page; a larger one is linked."""

SET_OUT = re.compile(r"^(    |(Run|Writes):)", re.MULTILINE)
"""In a paragraph whose lines are not to be filled: a formula, a table, a list of commands."""


@dataclass(frozen=True, kw_only=True)
class Shown:
    """A figure or film, `source` a data URI or a link; or a table, the first of its `rows` the headings."""

    name: str
    caption: str
    source: str = ""
    rows: Sequence[Sequence[str]] = ()


@dataclass(kw_only=True)
class Stored:
    """What a study left, as far as it can be read."""

    study: str
    summary: Mapping[str, object] = field(default_factory=dict)
    manifest: Mapping[str, object] = field(default_factory=dict)
    shown: list[Shown] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    @property
    def account(self) -> list[tuple[str, str]]:
        """The docstring of the study, "prose" or "as it is" with each paragraph."""
        blocks = account_of(self.study).split("\n\n")
        return [("as it is" if SET_OUT.search(block) else "prose", block) for block in blocks]


def _object(value: object) -> Mapping[str, object]:
    return value if isinstance(value, dict) else {}


def read_stored(folder: Path) -> Stored:
    """What lies in the folder of one study."""
    stored = Stored(study=folder.name)
    for name in ("summary", "manifest"):
        try:
            setattr(stored, name, _object(json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))))
        except (OSError, ValueError) as error:
            stored.faults.append(f"{folder.name}/{name}.json cannot be read: {error}")
    captions = _object(stored.manifest.get("captions"))
    listed = stored.manifest.get("files")
    stored.files = [str(name) for name in listed] if isinstance(listed, list) else []
    for name in sorted(stored.files, key=lambda name: name.endswith(".csv")):
        try:
            shown = _shown(folder / name, str(captions.get(name) or ""))
            stored.shown += [shown] if shown else []
        except (OSError, ValueError, csv.Error) as error:
            stored.faults.append(f"{folder.name}/{name} cannot be read: {error}")
    return stored


def _shown(path: Path, caption: str) -> Shown | None:
    """What the page shows of a file: a picture, linked if it is large, or a table that is not too large."""
    if path.suffix == ".csv":
        with path.open(newline="", encoding="utf-8") as stream:
            rows = list(islice(csv.reader(stream), MOST_ROWS + 2))
        fits = 0 < len(rows) <= MOST_ROWS + 1 and len(rows[0]) <= MOST_COLUMNS
        return Shown(name=path.name, caption=caption, rows=rows) if fits else None
    if path.suffix not in (".png", ".gif"):
        return None
    source = f"../{path.parent.name}/{path.name}"
    if path.stat().st_size <= LARGEST_PICTURE:
        content = base64.b64encode(path.read_bytes()).decode("ascii")
        source = f"data:image/{path.suffix[1:]};base64,{content}"
    return Shown(name=path.name, caption=caption, source=source)


def _shortened(cell: str) -> str:
    """A number to five digits, anything else as it is."""
    try:
        return cell if cell.lstrip("-").isdigit() else f"{float(cell):.5g}"
    except ValueError:
        return cell


def read_results(results: Path) -> list[Stored]:
    """The results of all studies that have any, the main one first.

    Raises
    ------
    ValueError
        If there are none.
    """
    found = [read_stored(results / name) for name in studies() if (results / name / "summary.json").exists()]
    if not found:
        raise InvalidValue(f"there are no results in {results}: run {COMMAND} first")
    return found


def _points(stored: Mapping[str, Stored]) -> Iterator[dict[str, object]]:
    """The letter point by point, with what the studies that are there found."""
    for key, point in letter.POINTS.items():
        if point.study in stored:
            found = _object(_object(stored[point.study].summary.get("verdicts")).get(key))
            yield {"verdict": "not stored", "found": "", "note": "", **found, "point": point}


def _answers(stored: Mapping[str, Stored]) -> Iterator[tuple[str, list[str]]]:
    """The questions of the letter that a study has answered, with what the studies say."""
    for key, (question, answering) in letter.QUESTIONS.items():
        there = [stored[study].summary.get("answers") for study in answering if study in stored]
        if said := [str(answers[key]) for answers in map(_object, there) if answers.get(key)]:
            yield question, said


def write_page(results: Path) -> tuple[Path, list[Stored], list[str]]:
    """Write results/report/index.html; returns its path, what is on it, and which studies are not."""
    found = read_results(results)
    by_name = {stored.study: stored for stored in found}
    missing = [name for name in studies() if name not in by_name]
    points = list(_points(by_name))
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["shortened"] = _shortened
    text = environment.get_template("page.html.j2").render(
        stored=found,
        missing=missing,
        command=COMMAND,
        points=points,
        unjudged=len(letter.POINTS) - len(points),
        tally=Counter(str(point["verdict"]) for point in points),
        answers=list(_answers(by_name)),
        made=f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
    )
    folder = results / "report"
    folder.mkdir(parents=True, exist_ok=True)
    return write_atomically(folder / "index.html", text.encode()), found, missing


def told_page(results: Path) -> str:
    """Write the page and say so; a page that cannot be written is no reason for a study to fail."""
    try:
        path, found, missing = write_page(results)
    except (OSError, ValueError) as error:
        return f"no page: {error}"
    return in_words(path, found, missing)


def in_words(path: Path, found: Sequence[Stored], missing: Sequence[str]) -> str:
    """The page in one sentence, with the command that completes it."""
    count = f"{len(found)} of {len(found) + len(missing)}" if missing else f"all {len(found)}"
    size = f"page of {count} studies, {path.stat().st_size / 1e6:.1f} MB: {path}"
    return f"{size}; {ALL} makes the rest" if missing else size
