"""A table in a text: rows of numbers below the words that are their heading.

Lines that begin with # or % are comments, and empty lines are skipped. The separator and the decimal mark are
those with which most cells are numbers. The columns of the table hold numbers in the second half of the text.
`_first_row` finds where the table begins, and `_heading` reads the words above it. From there on every line
is a row, NaN where a cell of it is no number.
"""

import csv
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from studies.shell.tables.formats import Format, format_of
from studies.shell.tables.units import is_unit, split

Array = NDArray[np.float64]
MARKS = {"\t": "tabs", ";": "semicolons", ",": "commas", " ": "blanks"}
LOOKED_AT = 400  # lines to choose the separator by
LEAST = 0.25  # share of numbers in a column of the table
NOTE = re.compile(r"([^=:]*?)\s*[=:]\s*(.+)")
STAMP = re.compile(r"(?:(\d{4}-\d\d-\d\d)[T ])?(\d\d?:\d\d:\d\d)(?:[.,](\d{1,9}))?(?:Z|[+-]\d\d:?\d\d)?")


@dataclass(frozen=True, eq=False)
class Table:
    """A table as it was found; `rows` of shape (n_rows, n_columns) are NaN where a cell is no finite number.

    `names` and `units` are as written: "column 1", ... without a heading, "" without a unit. `lines` are the
    lines of the rows in the file and `places` the columns in it, from 0. `cell(row, column)` is a cell as
    written, and `notes` are comments such as `name = value`. `step` and `start` [s] are None and 0 if the
    file does not state them.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: Array
    lines: NDArray[np.int64]
    recognised: str
    places: tuple[int, ...]
    cell: Callable[[int, int], str] = lambda row, column: "nan"
    step: float | None = None
    start: float = 0.0
    notes: Mapping[str, str] = field(default_factory=dict)


class Numbers:
    """Cells to numbers. Stamps (2024-03-01T00:00:00.5, 12:30:01.25) are seconds since the first one."""

    first: np.datetime64 | None = None

    def of(self, cell: str) -> float:
        """The number in a cell, NaN for words."""
        try:
            return float(cell)
        except ValueError:
            stamp = STAMP.fullmatch(cell.strip(' "'))
        date, clock, digits = stamp.groups() if stamp else ("no stamp", "", "")
        try:
            since = np.datetime64(f"{date or '2000-01-01'}T{clock:0>8}.{digits or 0}", "ns")
        except ValueError:
            return math.nan
        self.first = self.first or since
        return float((since - self.first) / np.timedelta64(1, "s"))


def cells_of(line: str, mark: str, comma: bool = False) -> list[str]:
    """The cells of a line; with decimal commas, points in their place."""
    text = line.replace(",", ".") if comma else line
    if '"' not in text:
        return text.split(None if mark == " " else mark)
    return next(csv.reader([text.strip(" ")], delimiter=mark, skipinitialspace=True), [])


def _written(lines: Sequence[str]) -> tuple[str, bool]:
    """The separator, and whether decimals have commas: with which most cells are numbers."""

    def gain(way: tuple[str, bool]) -> int:
        rows = [[cell for cell in cells_of(line, *way) if cell.strip()] for line in lines]
        isnumber = [["\t" not in cell and math.isfinite(Numbers().of(cell)) for cell in row] for row in rows]
        return sum(max(0, 2 * sum(row) - len(row)) for row in isnumber)  # numbers less words, row by row

    return max([*((mark, False) for mark in MARKS), *((mark, True) for mark in "\t; ")], key=gain)


def _first_row(isnumber: NDArray[np.bool_], cells: list[list[str]], first: int) -> int | None:
    """The row with which the table begins, or None; `isnumber` is about its columns, from `first` on.

    It is the first of three rows in succession with numbers in all columns: one or two such rows may be part
    of a heading. If there are no three, two or one are enough. The table begins earlier where the rows above
    have some numbers and no word in the first column: they lost a number. A heading may come again.
    """
    whole = isnumber.all(axis=1)
    runs = (np.convolve(whole, np.ones(need), "valid") == need for need in (3, 2, 1))
    begin = next((int(np.argmax(run)) for run in runs if run.any()), None)
    empty = np.array([not row[first].strip() for row in cells])
    part = isnumber.any(axis=1) & (isnumber[:, 0] | empty)
    while begin and part[begin - 1]:
        begin -= 1
    return cells.index(cells[begin - 1]) + 1 if begin else begin  # below the first such heading


def _heading(words: list[list[str]], columns: NDArray[np.int64], form: Format) -> tuple[list[str], list[str]]:
    """Names and units of the columns, from the rows of words above the table.

    The last row is the heading if it has a word for the last column. If it holds only units, or the step and
    the start below their labels, the row above is the heading. Units are in the heading, in that row of
    units, or beside the format's label for them.
    """
    empty = [""] * columns.size
    above, below = [empty, empty, *([row[i] for i in columns] for row in words)][-2:]
    isunits = any(above) and any(below) and all(is_unit(cell) or not cell for cell in below)
    names, line = (above, below) if isunits or form.start in [[], [], *words][-2] else (below, empty)
    if not names[-1]:
        names, line = [f"column {i + 1}" for i in range(columns.size)], empty
    beside = next((row for row in words if row[0] == form.units), [])
    labelled = [beside[i] or beside[1] if beside and i else "" for i in columns]
    units = [split(name)[1] or a or b for name, a, b in zip(names, line, labelled, strict=True)]
    return names, [unit.strip(" []()") for unit in units]


def _stated(words: list[list[str]], label: str) -> float | None:
    """The number below a label, or beside it if it is the first cell of its row."""
    for row, after in pairwise([*words, []]):
        if label in row:
            i = row.index(label)
            found = [Numbers().of(cell.replace(",", ".")) for cell in (after[i : i + 1] if i else row)]
            return next(filter(math.isfinite, found), None)
    return None


def read_text(text: str, encoding: str = "") -> Table:
    """The table in a text; InvalidValue with what was seen if there is none."""
    form, numbers = format_of(text), Numbers()
    comments, numbered = list[str](), list[tuple[int, str]]()
    for n, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith(("#", "%")):
            comments.append(line.strip("#% \t"))
        elif line.strip(" ,;\t"):
            numbered.append((n, line))
    lines = [line for _, line in numbered]
    if not lines:
        raise InvalidValue("is empty; give a table of numbers with a heading")
    mark, comma = _written(lines[:: max(1, len(lines) // LOOKED_AT)])
    cells, half = [cells_of(line, mark, comma) for line in lines], len(lines) // 2
    width = int(np.median([len(row) for row in cells[half:]]))
    empty = [""] * width
    cells = [row if len(row) == width else (row + empty)[:width] for row in cells]
    values = np.array([numbers.of(cell) for row in cells for cell in row]).reshape(len(cells), width)
    values[~np.isfinite(values)] = math.nan
    isnumber = np.isfinite(values)
    columns = np.flatnonzero(np.mean(isnumber[half:], axis=0) > LEAST)
    begin = _first_row(isnumber[:, columns], cells, columns[0]) if columns.size else None
    if begin is None:
        seen = " | ".join(line.strip()[:40] for line in lines[:3])
        what = "give columns of numbers with a heading, one row for each sample"
        raise InvalidValue(f"holds no table of numbers: its first lines are {seen!r}; {what}")
    above = lines[:begin] or [line for line in comments[-1:] if len(cells_of(line, mark)) == width]
    words = [[cell.strip().strip('"') for cell in cells_of(line, mark)] + empty for line in above]
    names, units = _heading(words, columns, form)
    if len(names) > 1 and names[0].lower() in ("", "unnamed: 0"):  # the index of pandas
        columns, names, units = columns[1:], names[1:], units[1:]
    body = cells[begin:]
    how = [form.name, MARKS[mark] + (", decimal comma" if comma else ""), encoding]
    return Table(
        tuple(names),
        tuple(units),
        rows=values[begin:, columns],
        lines=np.array([n for n, _ in numbered[begin:]]),
        recognised="; ".join(filter(None, how)),
        places=tuple(columns.tolist()),
        cell=lambda row, column: body[row][columns[column]].strip()[:40],
        step=_stated(words, form.step),
        start=_stated(words, form.start) or 0.0,
        notes={note[1]: note[2] for note in map(NOTE.match, comments) if note},
    )
