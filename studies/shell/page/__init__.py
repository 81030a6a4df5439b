"""One page of everything that the studies stored, to read, print and pass on: results/report/index.html.

On top stand the spring, the form of the studies, a picture, and how many points of the letter agree. Then
come the studies by chapter: each with its verdicts, its figures, at most three sentences, and folded what is
long: tables, films, the account of the study, notes. Nothing is said here of any study: titles and accounts
are docstrings, sentences and verdicts come from its summary, figures, tables and what each column holds from
its columns.json. A page made from other results says other things, and what is the letter's stands on the
page of the letter's spring only.

``words`` writes numbers, cells and prose as print; ``page.html.j2`` is the template.  The page is a chapter
of the site (``docs/conf.py``).

The page is one file that needs no network: pictures and style are inside, and its content policy forbids
every request. What is missing or broken in the results becomes a sentence on the page.
"""

from __future__ import annotations

import base64
import csv
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import count, islice
from pathlib import Path
from typing import NamedTuple

from jinja2 import Environment, FileSystemLoader

from beam import InvalidValue
from studies import letter
from studies.shell.files import write_atomically
from studies.shell.page import words
from studies.shell.programs import CHAPTERS, COMMAND, FOLDER, account_of, chapter, first_line, studies
from studies.shell.scene.values import KEYS

MOST_ROWS = 40
"""Of a table on the page; a longer one is named and left to its file."""

MOST_IN_SHORT = 5
"""Sentences on top of the page: the first finding of the first studies."""

LARGEST_PICTURE = 4_000_000
"""Bytes of a picture or film that goes into the page; a larger one is linked."""

VERDICTS = {
    "agrees": "agree",
    "in part": "agree in part",
    "differs": "differ",
    "fitted": "agree, for the spring was fitted to them",
    "open": "open, for the letter prints no number or the study has not run",
}
"""A verdict, and what the points with it do."""

SET_OUT = re.compile(r"^(    |(Run|Writes):)", re.MULTILINE)
"""In a paragraph whose lines are not to be filled: a formula, a table, a list of commands."""

LETTERS = re.compile(r"letter|Figs?\. \d")
OF_A_FIGURE = re.compile(r"^(Fig\. \d of the letter): (.)")
"""What speaks of the letter; the head of a title that does."""


@dataclass(frozen=True, kw_only=True)
class Shown:
    """A picture, `source` a data URI or a link; or a table with headings and notes, cut off if long."""

    name: str
    caption: str
    number: int = 0
    source: str = ""
    width: int = 0
    headings: Sequence[tuple[str, str]] = ()
    rows: Sequence[Sequence[str]] = ()
    long: bool = False


@dataclass(kw_only=True)
class Stored:
    """What a study left, as far as it can be read."""

    study: str
    summary: Mapping[str, object] = field(default_factory=dict)
    manifest: Mapping[str, object] = field(default_factory=dict)
    columns: Mapping[str, object] = field(default_factory=dict)
    figures: list[Shown] = field(default_factory=list)
    films: list[Shown] = field(default_factory=list)
    tables: list[Shown] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    @property
    def letters(self) -> bool:
        """Whether its spring is the letter's."""
        return self.manifest.get("of_the_letter") is True

    @property
    def files(self) -> list[str]:
        """The names of its files, in the order in which they were written."""
        return _list(self.manifest.get("files"))

    @property
    def title(self) -> str:
        """The first line of its docstring; that it is a figure of the letter only for the letter's spring."""
        line = account_of(self.study).partition("\n")[0].rstrip(".")
        return line if self.letters else OF_A_FIGURE.sub(lambda match: match[2].upper(), line)

    @property
    def account(self) -> list[tuple[bool, str]]:
        """The paragraphs of its docstring, and whether their lines are to be filled."""
        blocks = account_of(self.study).split("\n\n")[1:]
        own = [one for one in blocks if self.letters or not LETTERS.search(one) or one.startswith("Run:")]
        return [(not SET_OUT.search(block), block) for block in own]

    @property
    def notes(self) -> list[str]:
        """Warnings, failed cells, and what could not be read."""
        return [*_list(self.summary.get("warnings")), *_list(self.summary.get("failures")), *self.faults]

    @property
    def findings(self) -> list[str]:
        """What came out, in sentences."""
        return _list(self.summary.get("findings"))

    @property
    def verdicts(self) -> Mapping[str, Mapping[str, object]]:
        """Point of the letter -> what was found; none for another spring."""
        found = _object(self.summary.get("verdicts")) if self.letters else {}
        return {key: _object(found[key]) for key in letter.POINTS if key in found}


def _object(value: object) -> Mapping[str, object]:
    return value if isinstance(value, dict) else {}


def _list(value: object) -> list[str]:
    return [str(one) for one in value] if isinstance(value, list) else []


def read_stored(folder: Path, numbers: Iterator[int]) -> Stored:
    """What lies in the folder of one study; each figure takes the next of the `numbers`."""
    stored = Stored(study=folder.name)
    for name in ("summary", "manifest", "columns"):
        try:
            setattr(stored, name, _object(json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))))
        except (OSError, ValueError) as error:
            stored.faults.append(f"{folder.name}/{name}.json cannot be read: {error}")
    for name in stored.files:
        about, path = _object(stored.columns.get(name)), folder / name
        try:
            if path.suffix == ".png":
                stored.figures.append(_picture(path, about, next(numbers)))
            elif path.suffix == ".gif":
                stored.films.append(_picture(path, about, 0))
            elif path.suffix == ".csv":
                stored.tables.append(_table(path, about))
        except (OSError, ValueError, csv.Error) as error:
            stored.faults.append(f"{folder.name}/{name} cannot be read: {error}")
    return stored


def _picture(path: Path, about: Mapping[str, object], number: int) -> Shown:
    """A picture, linked if it is large."""
    content, source = path.read_bytes(), f"../{path.parent.name}/{path.name}"
    if len(content) <= LARGEST_PICTURE:
        source = f"data:image/{path.suffix[1:]};base64,{base64.b64encode(content).decode('ascii')}"
    width = int.from_bytes(content[16:20], "big") if path.suffix == ".png" else 0  # of its header
    caption = str(about.get("holds") or "")
    return Shown(name=path.stem, caption=caption, number=number, source=source, width=width)


def _table(path: Path, about: Mapping[str, object]) -> Shown:
    """A table without the columns that are empty in every row."""
    with path.open(newline="", encoding="utf-8") as stream:
        names, *rows = list(islice(csv.reader(stream), MOST_ROWS + 2)) or [[]]
    listed = about.get("columns")
    known = [_object(one) for one in listed] if isinstance(listed, list) else []
    known = known if len(known) == len(names) else [{"heading": words.cell(name)} for name in names]
    full = [n for n in range(len(names)) if any(row[n] for row in rows if len(row) == len(names))]
    units = [f" ({one['unit']})" if one.get("unit") else "" for one in known]
    headings = [(f"{known[n].get('heading')}{units[n]}", str(known[n].get("note") or "")) for n in full]
    shown = [[row[n] for n in full] for row in rows if len(row) == len(names)]
    caption, long = str(about.get("holds") or path.name), len(rows) > MOST_ROWS
    return Shown(name=path.stem, caption=caption, headings=headings, rows=shown, long=long)


def read_results(results: Path) -> list[Stored]:
    """The results of all studies that have any, by chapter; InvalidValue if there are none."""
    numbers = count(1)
    there = [results / name for name in studies() if (results / name / "summary.json").exists()]
    if not there:
        raise InvalidValue(f"there are no results in {results}: run {COMMAND} first")
    return [read_stored(folder, numbers) for folder in there]


class Judged(NamedTuple):
    """A point of the letter, its verdict, and the place on the page that shows it."""

    key: str
    point: letter.Statement
    verdict: str
    found: str
    note: str
    place: str


def judged_points(studied: Sequence[Stored]) -> list[Judged]:
    """The letter point by point; open where no study that is there says more."""
    by_name = {stored.study: stored for stored in studied if stored.letters}
    points = []
    for key, point in letter.POINTS.items():
        stored = by_name.get(point.study)
        about, figures = (stored.verdicts.get(key, {}), stored.figures) if stored else ({}, [])
        named = [figure for figure in figures if figure.name == about.get("figure")] or figures
        place = f"figure-{named[0].number}" if named else f"study-{point.study}" if stored else f"point-{key}"
        verdict, found, note = (str(about.get(name) or "") for name in ("verdict", "found", "note"))
        points.append(Judged(key, point, verdict if verdict in VERDICTS else "open", found, note, place))
    return points


def ground(stored: Stored) -> Iterator[tuple[str, str, str]]:
    """What each key of the scene means, its value and where that comes from."""
    origins = _object(stored.manifest.get("provenance"))
    for section, entries in _object(stored.manifest.get("parameters")).items():
        for name, value in _object(entries).items():
            key, origin = f"{section}.{name}", str(origins.get(f"{section}.{name}") or "")
            shown = origin not in ("letter", "assumed") or section in ("spring", "tip", "stop", "contact")
            if key in KEYS and shown:
                yield KEYS[key].meaning, words.quantity(value, KEYS[key].unit), origin


def write_page(results: Path) -> tuple[Path, list[Stored], list[str]]:
    """Write results/report/index.html; returns its path, what is on it, and which studies are not."""
    found = read_results(results)
    missing = [name for name in studies() if name not in {stored.study for stored in found}]
    letters = any(stored.letters for stored in found)
    points = judged_points(found) if letters else []
    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)
    first = found[0]
    environment.filters |= {"prose": words.prose, "cell": words.cell}
    titles = [first_line(FOLDER / name / "__init__.py").rstrip(".") for name in CHAPTERS]
    parts = [[one for one in found if one.study in chapter(name)] for name in CHAPTERS]
    text = environment.get_template("page.html.j2").render(
        first=first,
        letters=letters,
        chapters=[(title, own) for title, own in zip(titles, parts, strict=True) if own],
        picture=next((figure for one in found for figure in one.figures), None),
        rig=next((figure for one in found for figure in one.figures if figure.name == "rig"), None),
        short=[(one.study, one.findings[0]) for one in found if one.findings][:MOST_IN_SHORT],
        small=[stored.study for stored in found if _object(stored.summary.get("settings")).get("quick")],
        others=[one.study for one in found if one.manifest.get("size") != first.manifest.get("size")],
        count=len(found),
        missing=missing,
        command=words.command_for_the_rest(str(first.manifest.get("command") or "")),
        points=points,
        verdicts=VERDICTS,
        ground=list(ground(first)),
        made=f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
    )
    folder = results / "report"
    folder.mkdir(parents=True, exist_ok=True)
    return write_atomically(folder / "index.html", text.encode()), found, missing


def page_sentence(results: Path) -> str:
    """Write the page and say so; a page that cannot be written is no reason for a study to fail."""
    try:
        path, found, missing = write_page(results)
    except (OSError, ValueError) as error:
        return f"no page: {error}"
    return in_words(path, found, missing)


def in_words(path: Path, found: Sequence[Stored], missing: Sequence[str]) -> str:
    """The page in one sentence, with the command that completes it."""
    count = f"{len(found)} of {len(found) + len(missing)}" if missing else f"all {len(found)}"
    page = f"page of {count} studies, {path.stat().st_size / 1e6:.1f} MB: {path}"
    command = words.command_for_the_rest(str(found[0].manifest.get("command") or ""))
    return f"{page}; {command} makes the rest" if missing else page
