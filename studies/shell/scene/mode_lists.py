"""The lists of [modal_data]: which of them describe the modes, and how a file gives them.

A file has a heading with names of lists, and below it one line of numbers for each mode, in the units of the
keys. Commas, semicolons or tabs separate the cells. With the last two, numbers may have decimal commas, if
none has a point. Further columns, blank lines, and lines that begin with # are skipped.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Collection, Sequence
from pathlib import Path

from studies.shell.scene.key import SceneError, shown
from studies.shell.scene.keys import MODE_LISTS

RATES, RATIOS, TIP = MODE_LISTS[1:2], ("damping_ratios",), MODE_LISTS[2:]
RESIDUES = ("force_residues_re", "force_residues_im", "base_residues_re", "base_residues_im")
ALTERNATIVES = ((MODE_LISTS[:1],), (RATES, RATIOS), (TIP, RESIDUES))
"""Of each entry, exactly one group of lists is given."""
LISTS = tuple(name for groups in ALTERNATIVES for group in groups for name in group)
SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}


def fault_of(given: Collection[str]) -> str:
    """What is wrong with these lists as a description of the modes, or ""."""
    for groups in ALTERNATIVES:
        begun = [[name for name in group if name in given] for group in groups]
        if all(begun) and len(groups) > 1:
            return f"has {begun[0][0]} and {begun[1][0]}, two descriptions of one thing: drop one of them"
        group = next((whole for whole, part in zip(groups, begun, strict=True) if part), groups[0])
        if missing := [name for name in group if name not in given]:
            others = "" if any(begun) else "".join(f" (or else {', '.join(one)})" for one in groups[1:])
            return f"has no {', '.join(missing)}{others}"
    return ""


def lists_in(file: str) -> dict[str, list[float]]:
    """The lists in a file; SceneError with the place of what is wrong."""
    try:
        return _columns(Path(file).read_text(encoding="utf-8-sig").split("\n"))
    except (OSError, ValueError, csv.Error) as error:
        words = "it is not text in UTF-8" if isinstance(error, UnicodeError) else str(error)
        reason = getattr(error, "strerror", None) or words
        raise SceneError(f"modal_data.file {shown(file)} cannot be read: {reason}") from error


def _columns(text: Sequence[str]) -> dict[str, list[float]]:
    """The lists in the lines of a file; ValueError with the place of what is wrong."""
    lines = [(n, line) for n, line in enumerate(text, 1) if line.strip(" ,;\t")[:1] not in ("", "#")]
    if len(lines) < 2:
        raise ValueError("it needs a heading, and below it a line of numbers for each mode")
    mark = max(SEPARATORS, key=lines[0][1].count)
    cells = [next(csv.reader([line], delimiter=mark, skipinitialspace=True)) for _, line in lines]
    heading, *rows = ([word.strip() for word in row] for row in cells)
    if fault := fault_of(heading):
        split = f"separated by {SEPARATORS[mark]}" if len(heading) > 1 else "without comma, semicolon or tab"
        raise ValueError(f"it {fault}; its heading is {', '.join(heading)[:200]}, {split}")
    columns, points = {name: heading.index(name) for name in LISTS if name in heading}, False
    for (n, _), row in zip(lines[1:], rows, strict=True):
        if len(row) != len(heading):
            words = f"separated by {SEPARATORS[mark]}, and the heading has {len(heading)}"
            raise ValueError(f"line {n} has {len(row)} cells {words}")
        points |= any("." in row[place] for place in columns.values())
    comma = "." if mark == "," or points else ","
    found = {name: list[float]() for name in columns}
    for (n, _), row in zip(lines[1:], rows, strict=True):
        for name, place in columns.items():
            try:
                found[name].append(float(row[place].replace(comma, ".")))
            except ValueError:
                found[name].append(math.nan)
            if not math.isfinite(found[name][-1]):
                raise ValueError(f"line {n}, column {name}: {shown(row[place])} is no number")
    return found
