"""A table in a text: the rows of numbers below the words that are their heading.

The separator (tab, semicolon, comma, blanks) and the decimal mark are those with which most cells are
numbers. The columns of the table are those that mostly hold numbers; it begins with the first three rows that
are whole, and what follows is part of it. The last line of words above is the heading, or a line of units
below it. Stamps (2024-03-01T00:00:00.5, 12:30:01.25) count in seconds from the first one.
"""

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from studies.shell.tables.formats import Format, format_of
from studies.shell.tables.units import is_unit, split

Array = NDArray[np.float64]
MARKS = {"\t": "tabs", ";": "semicolons", ",": "commas", " ": "blanks"}
LOOKED_AT, WHOLE, SEEN, MOST = 400, 3, 3, 1000
"""Lines to choose the separator by, whole rows that begin a table, lines shown, cells kept as text."""
LEAST = 0.25  # share of numbers in a column
_STAMP = re.compile(r"(?:(\d{4}-\d\d-\d\d)[T ])?(\d\d?:\d\d:\d\d)(?:[.,](\d{1,9}))?(Z|[+-]\d\d:?\d\d)?$")


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """A table as it was found; `rows` of shape (n_rows, n_columns) are NaN where a cell is no finite number.

    `names` are headings as written, `units` as well, "" if none; `lines` are the lines of the rows in the
    file, `lost` texts of the first cells that are no numbers by (line, column). `step` and `start` [s] are
    None and 0 if the file does not state them; `headed` is False if it has no heading.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Array
    recognised: str
    lines: NDArray[np.int64]
    lost: Mapping[tuple[int, int], str] = field(default_factory=dict)
    step: float | None = None
    start: float = 0.0
    notes: Mapping[str, str] = field(default_factory=dict)
    headed: bool = True


class Numbers:
    """Cells to numbers; stamps count from the first one."""

    first: int | None = None

    def of(self, cell: str) -> float:
        """The number, or seconds since the first stamp, or NaN."""
        try:
            number = float(cell)
            return number if math.isfinite(number) else math.nan
        except ValueError:
            found = _STAMP.match(cell.strip(' "'))
        try:
            if found is None:
                return math.nan
            whole = datetime.fromisoformat(f"{found[1] or '2000-01-01'}T{found[2]:0>8}{found[4] or '+00:00'}")
        except ValueError:
            return math.nan
        since = whole - datetime(2000, 1, 1, tzinfo=UTC)
        stamp = (since.days * 86400 + since.seconds) * 10**9 + int((found[3] or "0").ljust(9, "0"))
        self.first = stamp if self.first is None else self.first
        return (stamp - self.first) / 1e9


def cells_of(line: str, mark: str, comma: bool = False) -> list[str]:
    """The cells of a line; with decimal commas, points in their place."""
    text = line.replace(",", ".") if comma else line
    if '"' in text:
        return next(
            csv.reader([text.strip() if mark == " " else text], delimiter=mark, skipinitialspace=True), []
        )
    return text.split() if mark == " " else text.split(mark)


def _written(lines: Sequence[str]) -> tuple[str, bool]:
    """The separator, and whether decimals have commas: with which most cells are numbers."""

    def gain(way: tuple[str, bool]) -> int:
        rows = ([cell for cell in cells_of(line, *way) if cell.strip()] for line in lines)
        numbers = (
            (sum("\t" not in cell and math.isfinite(Numbers().of(cell)) for cell in row), len(row))
            for row in rows
        )
        return sum(max(0, 2 * n - of) for n, of in numbers)  # numbers less words, where this is above 0

    return max(
        ((mark, comma) for comma in (False, True) for mark in MARKS if not comma or mark != ","), key=gain
    )


def read_text(text: str, encoding: str, source: object) -> Table:
    """The table in a text; InvalidValue with what was seen if there is none."""
    found = format_of(text)
    lines, comments, notes = list[tuple[int, str]](), list[str](), dict[str, str]()
    for n, line in enumerate(text.splitlines(), 1):
        if line.lstrip()[:1] in ("#", "%") or (line[:1] == ";" and line[1:2].strip(" ;,\t")[:1].isalpha()):
            comments.append(line.lstrip("#%; \t"))
            name, _, value = (part.strip() for part in re.split(r"([=:])", comments[-1] + "=", maxsplit=1))
            notes |= {name: value.rstrip("=")} if value.rstrip("=") else {}
        elif line.strip(" ,;\t"):
            lines.append((n, line))
    if not lines:
        raise InvalidValue(f"the record {source} is empty; give a table of numbers with a heading")
    mark, comma = _written([line for _, line in lines[:: max(1, len(lines) // LOOKED_AT)]])
    number, raw = Numbers(), [cells_of(line, mark, comma) for _, line in lines]
    rows = list[list[float]]()
    for row in raw:
        try:
            rows.append([float(cell) for cell in row])
        except ValueError:
            rows.append([number.of(cell) for cell in row])
    width = int(np.median([len(row) for row in rows[len(rows) // 2 :]]))
    values = np.array([(row + [math.nan] * width)[:width] for row in rows], dtype=float)
    values[~np.isfinite(values)] = math.nan
    isnumber = np.isfinite(values)
    columns = np.flatnonzero(
        np.sum(isnumber[len(rows) // 2 :], axis=0) > LEAST * (len(rows) - len(rows) // 2)
    )
    begin = _begin(isnumber, raw, columns, found)
    if begin and (again := [i for i in range(begin - 1) if lines[i][1] == lines[begin - 1][1]]):
        begin = again[0] + 1  # a heading that is repeated
    if not columns.size or begin is None:
        seen = " | ".join(line.strip()[:40] for _, line in lines[:SEEN])
        raise InvalidValue(
            f"the record {source} holds no table of numbers: its first lines are {seen!r}; "
            "give columns of numbers with a heading, one row for each sample"
        )
    words = [cells_of(line, mark) for _, line in lines[:begin]]
    if not words and comments and len(cells_of(comments[-1], mark)) == width:
        words = [cells_of(comments[-1], mark)]
    head = Heading(words, columns, found, number)
    kept, body = head.kept(values[begin:, columns]), np.array([n for n, _ in lines[begin:]])
    lost = {
        (int(body[i]), int(k)): "".join(raw[begin + i][columns[kept[k]] :][:1]).strip()[:40]
        for i, k in np.argwhere(~isnumber[begin:, columns[kept]])[:MOST]
    }
    how = [found.name, MARKS[mark] + (", decimal comma" if comma else ""), *([encoding] if encoding else [])]
    return Table(
        names=tuple(head.names[i] for i in kept),
        units=tuple(head.units[i] for i in kept),
        rows=values[begin:, columns[kept]],
        recognised="; ".join(how),
        lines=body,
        lost=lost,
        step=head.stated(found.step),
        start=head.stated(found.start) or 0.0,
        notes=notes,
        headed=head.headed,
    )


def _begin(
    isnumber: NDArray[np.bool_], raw: list[list[str]], columns: NDArray[np.int64], form: Format
) -> int | None:
    """The first row of the table: three whole rows follow, or rows that lost a number come before them."""
    others = [i for i in range(isnumber.shape[1]) if i not in columns]
    texts = {i for i in others if sum(len(row) > i and row[i].strip() != "" for row in raw) > 0.5 * len(raw)}
    whole = np.all(isnumber[:, columns], axis=1)
    lone = [i for i in others if i not in texts and not form.beside]
    for i in range(min(len(raw), 300) if lone else 0):
        whole[i] &= not any(len(raw[i]) > k and raw[i][k].strip() for k in lone)
    counts = (np.convolve(whole, np.ones(need), "valid") == need for need in range(WHOLE, 0, -1))
    runs = next((found for found in map(np.flatnonzero, counts) if found.size), None)
    if runs is None:
        return None
    begin = int(runs[0])
    while (
        begin
        and isnumber[begin - 1, columns].any()
        and (
            isnumber[begin - 1, columns[0]]
            or not "".join(raw[begin - 1][columns[0] : columns[0] + 1]).strip()
        )
        and not any(len(raw[begin - 1]) > k and raw[begin - 1][k].strip() for k in lone)
    ):
        begin -= 1
    return begin


class Heading:
    """Names and units of the columns of a table, from the lines of words above it."""

    def __init__(
        self, words: list[list[str]], columns: NDArray[np.int64], form: Format, number: Numbers
    ) -> None:
        self.words = [[cell.strip().strip('"') for cell in row] for row in words]
        self.number, last = number, int(columns[-1])
        full = [row for row in self.words if len(row) > last]
        over, below = ([[], [], *full][-2:]) if full and self.words[-1] is full[-1] else ([], [])
        here = [[row[i] if len(row) > i else "" for i in columns] for row in (over, below)]
        under = bool(over) and all(is_unit(cell) or not cell for cell in here[1]) and any(here[1])
        ruled = bool(form.step in over and form.step in below) or form.start in over
        names = here[0] if under or ruled else here[1]
        self.headed = any(names)
        self.names = list(form.names) or (
            names if self.headed else [f"column {i + 1}" for i in range(columns.size)]
        )
        named = [split(name)[1] for name in self.names]
        line = here[1] if under or ruled else [""] * columns.size
        said = next((row for row in self.words if row and row[0] == form.units), [])
        side = [
            said[i] if 0 < i < len(said) and said[i] else said[1] if i and len(said) > 1 else ""
            for i in columns
        ]
        self.units = [(a or b or c).strip(" []()") for a, b, c in zip(named, line, side, strict=True)]

    def kept(self, values: Array) -> NDArray[np.int64]:
        """The columns without an unnamed index 0, 1, 2 ..."""
        index = self.headed and self.names[0].lower() in ("", "unnamed: 0")
        return np.arange(len(self.names))[1 if index and len(self.names) > 1 else 0 :]

    def stated(self, label: str) -> float | None:
        """The number beside a label, or below it."""
        for row, after in pairwise([*self.words, []]):
            if label in row:
                i = row.index(label)
                for cell in [*after[i : i + 1], *row[i + 1 :]] if i else row[i + 1 :]:
                    if math.isfinite(found := self.number.of(cell.replace(",", "."))):
                        return found
        return None
