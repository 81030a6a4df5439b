"""The section of one study: claim, figures, tables, agreement with the letter, what came out, run, files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from studies.instruments.progress import duration
from studies.instruments.report import pictures
from studies.instruments.report.entry import Entry, asked, found_on
from studies.instruments.report.markup import Table, escaped, items, prose, sentence
from studies.instruments.report.stored import PICTURES, Stored
from studies.instruments.report.turnable import Turnable

FILM = ".gif"
TALL = 0.75
"""Height over width from which a figure needs a page of its own when printed."""

ALT_WORDS = 140
"""Characters of a caption that serve as the alternative text of its figure."""


@dataclass(kw_only=True)
class Space:
    """Where the page lies, and how many bytes of pictures it still takes."""

    folder: Path
    left: int = pictures.MOST_BYTES

    def link(self, path: Path, words: str) -> str:
        return f'<a href="{escaped(pictures.link_to(path, self.folder))}">{escaped(words)}</a>'


def first_words(caption: str) -> str:
    """What a figure shows, as text without markup."""
    plain = caption.replace("p_", "p").replace("_", "")
    return plain if len(plain) <= ALT_WORDS else plain[:ALT_WORDS].rsplit(" ", 1)[0] + " ..."


def image(path: Path, caption: str, space: Space) -> str:
    """A picture that opens enlarged; a link where the page would grow too large, or a sentence."""
    try:
        picture = pictures.read(path)
    except pictures.NoPicture as error:
        return f'<p class="faults">{escaped(error)}</p>'
    if len(picture.content) > space.left:
        return f"<p>{space.link(path, path.name)}: not embedded, the page would grow too large.</p>"
    space.left -= len(picture.content)
    size = f'width="{picture.width}" height="{picture.height}"'
    tall = ' class="tall"' if picture.height > TALL * picture.width else ""
    return (
        f'<button type="button" class="zoom" title="enlarge"><img src="{picture.uri}" {size}{tall} '
        f'alt="{escaped(first_words(caption))}"></button>'
    )


def figure(paths: Sequence[Path], caption: str, space: Space) -> str:
    """One picture or a gallery of several under one caption, with links to the printable files."""
    film = all(path.suffix == FILM for path in paths)
    printable = [] if film else [path.with_suffix(".pdf") for path in paths]
    links = "".join(f" {space.link(path, 'pdf')}" for path in printable if path.exists())
    several = len(paths) > 1
    drawn = "".join(
        image(path, f"{path.stem.replace('_', ' ')}: {caption}" if several else caption, space)
        for path in paths
    )
    kind = ' class="gallery"' if several else ""
    block = f"<figure{kind}>{drawn}<figcaption>{prose(caption)}{links}</figcaption></figure>"
    if film:
        return f'<details class="film" open><summary>In motion</summary>{block}</details>'
    return block


def figures(entry: Entry, stored: Stored, space: Space) -> list[str]:
    """The study's figures: declared ones first and in their order, then whatever else it stored."""
    left = {path.name if path.suffix == FILM else path.stem: path for path in stored.pictures()}
    drawn = []
    for pattern, caption in entry.captions.items():
        fit = [name for name in left if fnmatch(name, pattern)]
        if fit:
            drawn.append(figure([left.pop(name) for name in fit], caption, space))
    return drawn + [
        figure([path], f"{path.stem.replace('_', ' ').capitalize()}.", space) for path in left.values()
    ]


def tables(entry: Entry, stored: Stored) -> str:
    """The study's tables, or one sentence if what it stored has another shape."""
    if not stored.summary:
        return ""
    found: Sequence[Table] | None = asked(lambda: entry.tables(stored.summary))
    drawn = None if found is None else asked(lambda: "".join(table.html() for table in found))
    if drawn is None:
        return f'<p class="faults">The stored summary of {escaped(stored.study)} does not hold its table.</p>'
    return drawn


def verdict_mark(verdict: str) -> str:
    return f'<span class="verdict {verdict.replace(" ", "-")}">{verdict}</span>'


def with_letter(entry: Entry, stored: Stored) -> str:
    """The points of the letter that this study speaks to."""
    lines = []
    for point in sorted(entry.points, key=lambda point: point.order):
        finding = found_on(point, stored, entry.study)
        here = {"map": finding.map, "Eq. (1)": finding.single_mode, "beam": finding.beam}
        told = [f"{name} {value}" for name, value in {"letter": point.letter, **here}.items() if value]
        values = f' <span class="values">{"; ".join(told)}.</span>' if any(here.values()) else ""
        why = f" {sentence(finding.why)}" if finding.why else ""
        lines.append(
            f"<li>{verdict_mark(finding.verdict)} <strong>{escaped(point.where)}:</strong> "
            f"{prose(point.says)}{why}{values}</li>"
        )
    return f'<h4>With the letter</h4><ul class="with-letter">{"".join(lines)}</ul>' if lines else ""


def facts(stored: Stored) -> str:
    """Command, run time, date and model of the run."""
    manifest = stored.manifest
    parts = []
    if manifest.get("command"):
        parts.append(f"<code>{escaped(manifest['command'])}</code>")
    if isinstance(manifest.get("wall_time_s"), int | float):
        parts.append(f"took {duration(float(manifest['wall_time_s']))}")
    if manifest.get("begun"):
        parts.append(escaped(str(manifest["begun"])[:16].replace("T", " ")) + " UTC")
    if stored.quick:
        parts.append("small form (--quick)")
    choice = stored.summary.get("model_choice")
    if choice:
        parts.append(prose(str(choice)))
    return f'<p class="facts">{"; ".join(parts)}</p>' if parts else ""


def files(stored: Stored, space: Space) -> str:
    """Links to the numbers of a study."""
    names: Any = stored.manifest.get("files")
    shown = [str(name) for name in names] if isinstance(names, list) else []
    there = [
        stored.folder / name
        for name in shown
        if Path(name).suffix not in (*PICTURES, ".pdf") and (stored.folder / name).exists()
    ]
    if not there:
        return ""
    return '<p class="files">Stored: ' + ", ".join(space.link(path, path.name) for path in there) + "</p>"


def turning(found: Turnable | str | None) -> str:
    """Buttons that turn a mode in the page, or the sentence that says what they need."""
    if found is None:
        return ""
    if isinstance(found, str):
        return f'<p class="facts">{prose(found[0].upper() + found[1:])}.</p>'
    buttons = "".join(
        f'<button type="button" value="{number}" aria-pressed="false">{escaped(name)}</button>'
        for number, (name, _data) in enumerate(found.scenes)
    )
    words = "Turn a mode in space: drag; the wheel changes its size."
    return f'<div class="turn" hidden><p class="facts">{words}</p>{buttons}</div>'


def section(entry: Entry, stored: Stored, space: Space, turn: Turnable | str | None = None) -> str:
    """Everything about one study."""
    first, *others = figures(entry, stored, space) or [""]
    said: Mapping[str, Any] = stored.summary
    came_out = asked(lambda: items(list(entry.findings(said)))) if said else ""
    faults = items(stored.faults, "faults")
    return (
        f'<section class="study" id="study-{escaped(entry.study)}"><h3>{prose(entry.title)}</h3>'
        f'<p class="claim">{prose(entry.claim)}</p>{faults}{first}{tables(entry, stored)}{"".join(others)}'
        f"{turning(turn)}{with_letter(entry, stored)}"
        + (f"<h4>What came out</h4>{came_out}" if came_out else "")
        + f"{facts(stored)}{files(stored, space)}</section>"
    )
