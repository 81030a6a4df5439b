"""The page: answers, the letter point by point, the studies, what was assumed, versions and run times.

One HTML file with its pictures, style and script inside. Its content policy forbids every request, so that a
browser would refuse what the page does not contain.
"""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.instruments.report import assumed
from studies.instruments.report.answers import ANSWERS, told
from studies.instruments.report.entry import NOT_RUN, VERDICTS, Entry, Finding, Point, found_on
from studies.instruments.report.ground import runs, settings
from studies.instruments.report.markup import escaped, items, prose, scrolling, sentence
from studies.instruments.report.script import JAVASCRIPT
from studies.instruments.report.section import Space, section, verdict_mark
from studies.instruments.report.stored import Stored
from studies.instruments.report.style import CSS
from studies.instruments.report.turnable import Turnable

POLICY = (
    "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'"
)
"""What a browser may load for the page: nothing that is not in it."""

TITLE = "Grazing impacts of a leaf spring"
MEGABYTE = 1e6


@dataclass(frozen=True, kw_only=True)
class Contents:
    """What goes into the page: entries in order, results by study, studies there are no results of."""

    entries: Sequence[Entry]
    stored: Mapping[str, Stored]
    missing: Sequence[Entry]
    made: str
    turn: Turnable | str | None = None

    def shown(self) -> list[Entry]:
        return [entry for entry in self.entries if entry.study in self.stored]

    def results(self) -> list[Stored]:
        """Results with a manifest, in the order of the page."""
        return [self.stored[entry.study] for entry in self.shown() if self.stored[entry.study].manifest]


def findings(contents: Contents) -> list[tuple[Entry, Point, Finding]]:
    """Every point of the letter, in its order, with what was found on it."""
    rows = [
        (entry, point, found_on(point, contents.stored.get(entry.study), entry.study))
        for entry in contents.entries
        for point in entry.points
    ]
    return sorted(rows, key=lambda row: row[1].order)


def header(contents: Contents, rows: Sequence[tuple[Entry, Point, Finding]]) -> str:
    counts = Counter(finding.verdict for _entry, _point, finding in rows)
    tally = " &ensp;".join(
        f"{verdict_mark(verdict)}&nbsp;{counts[verdict]}" for verdict in VERDICTS if counts[verdict]
    )
    notes, shown = assumed.warnings(contents.results()), len(contents.shown())
    return (
        f"<header><h1>{TITLE}</h1>"
        '<p class="lead">A vibrating brass spring that just begins to touch a steel plate, computed beside '
        "the letter <cite>Generic behavior of grazing impact oscillators</cite> (1996): the Nordmark map, "
        "the single mode of its Eq. (1), and the elastic beam with its modes.</p>"
        f'<p class="facts">{shown} of {shown + len(contents.missing)} studies. '
        f"{len(rows)} points of the letter: &ensp;{tally}</p>{items(notes, 'notes')}</header>"
    )


def answers(contents: Contents) -> str:
    drawn = []
    for answer in ANSWERS:
        blocks = []
        for part in answer.parts:
            stored = contents.stored.get(part.study)
            said, tables = told(part, stored)
            link = f' <a href="#study-{part.study}">More</a>' if stored is not None else ""
            blocks.append(f"<p>{prose(said)}{link}</p>" + "".join(table.html() for table in tables))
        drawn.append(f'<h3 id="answer-{answer.key}">{prose(answer.question)}</h3>{"".join(blocks)}')
    return f'<section id="answers"><h2>In short</h2>{"".join(drawn)}</section>'


def letter(rows: Sequence[tuple[Entry, Point, Finding]], contents: Contents) -> str:
    heads = ("where", "what the letter says", "letter", "map", "Eq. (1)", "beam", "verdict")
    lines = []
    for entry, point, finding in rows:
        command = finding.verdict == NOT_RUN
        why = f"<code>{escaped(finding.why)}</code>" if command else sentence(finding.why)
        name = escaped(point.where)
        if entry.study in contents.stored:
            name = f'<a href="#study-{entry.study}">{name}</a>'
        cells = "".join(
            f"<td>{cell or '&ndash;'}</td>"
            for cell in (point.letter, finding.map, finding.single_mode, finding.beam)
        )
        lines.append(
            f'<tr><th scope="row">{name}</th><td class="says">{prose(point.says)}'
            + (f'<span class="why">{why}</span>' if why else "")
            + f"</td>{cells}<td>{verdict_mark(finding.verdict)}</td></tr>"
        )
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    table = f'<table class="points"><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table>'
    return (
        '<section id="letter"><h2>The letter, point by point</h2>'
        + scrolling(table, f"Agreement and disagreement with the letter. {VERDICT_WORDS}")
        + "</section>"
    )


VERDICT_WORDS = (
    "Fitted: the scene was calibrated to that number, so that it agrees by construction. Not printed: the "
    "letter names the quantity and gives no value."
)


def missing(contents: Contents) -> str:
    if not contents.missing:
        return ""
    lines = "".join(
        f"<li>{prose(entry.title)}: <code>python -m studies.{escaped(entry.study)}</code></li>"
        for entry in contents.missing
    )
    return f'<section id="missing"><h2>Not run</h2><p>No results are stored of:</p><ul>{lines}</ul></section>'


def navigation(contents: Contents) -> str:
    def listed(pairs: Sequence[tuple[str, str]]) -> str:
        return (
            "<ol>" + "".join(f'<li><a href="#{key}">{prose(name)}</a></li>' for key, name in pairs) + "</ol>"
        )

    first = [("answers", "In short"), ("letter", "The letter, point by point")]
    last = [("assumed", "What was assumed")] if contents.results() else []
    last += [("runs", "Versions and run times")]
    last += [("missing", "Not run")] if contents.missing else []
    shown = [(f"study-{entry.study}", entry.title) for entry in contents.shown()]
    return (
        '<nav aria-label="Contents"><details class="stay" open><summary>Contents</summary>'
        f"<h2>Results</h2>{listed(first)}<h2>Studies</h2>{listed(shown)}<h2>Ground</h2>{listed(last)}</details></nav>"
    )


ENLARGED = (
    '<dialog id="enlarged" aria-label="Enlarged figure"><div class="bar"><p></p>'
    + "".join(
        f'<button type="button" value="{value}" aria-label="{name}">{sign}</button>'
        for value, name, sign in (
            ("smaller", "smaller", "&minus;"),
            ("larger", "larger", "+"),
            ("fit", "fit to the window", "fit"),
            ("close", "close", "close"),
        )
    )
    + '</div><div class="stage"><img src="data:," alt=""></div></dialog>'
)


def _viewer(turn: Turnable | str | None) -> str:
    """Viewer and scenes as inert text; the script unpacks them when a button asks for it."""
    if not isinstance(turn, Turnable):
        return ""
    packed = {"viewer": base64.b64encode(turn.viewer.encode()).decode("ascii")}
    packed |= {f"scene-{number}": data for number, (_name, data) in enumerate(turn.scenes)}
    return "".join(f'<script type="text/plain" id="{key}">{data}</script>' for key, data in packed.items())


def html(contents: Contents, folder: Path) -> str:
    """The whole page, which will lie in `folder`."""
    space, rows = Space(folder=folder), findings(contents)
    sections = "".join(
        section(entry, contents.stored[entry.study], space, contents.turn if entry.study == "modes" else None)
        for entry in contents.shown()
    )
    body = (
        '<a class="skip" href="#answers">To the results</a><div class="page">'
        f"{navigation(contents)}{header(contents, rows)}<main>{answers(contents)}{letter(rows, contents)}"
        f'<section id="studies"><h2>The studies</h2>{sections}</section>'
        f"{settings(contents.results())}{runs(contents.results())}{missing(contents)}</main>"
    )
    scripts = f"{_viewer(contents.turn)}<script>{JAVASCRIPT}</script></body></html>\n"
    start = (
        '<!doctype html><html lang="en-GB"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{TITLE}</title><link rel="icon" href="data:,"><style>{CSS}</style></head><body>'
    )
    size = (len(start) + len(body.encode()) + len(scripts)) / MEGABYTE
    turned = isinstance(contents.turn, Turnable)
    viewer = (
        " The modes are turned by vtk.js (Kitware, BSD licence), which lies in the page." if turned else ""
    )
    footer = (
        f"<footer><p>Written by <code>python -m studies.report</code> on {escaped(contents.made)}; this page "
        f"has {size:.1f} MB and loads nothing else.{viewer}</p></footer></div>{ENLARGED}"
    )
    return f"{start}{body}{footer}{scripts}"
