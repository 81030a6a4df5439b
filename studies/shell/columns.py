"""Tables for other programs: one value a cell, and what each column holds.

A row is a frozen dataclass. A field says what it holds, and its unit, in its type:

    delay_s: Annotated[float, "time delay [s]; none where mode 1 does not come back"]

What stands before the bracket is the heading on the page; a note may follow after a semicolon. A pure number
has no bracket. The names in `USUAL` need no words. In the file a column has the name of its field, and behind
it the unit: `approach` in m/s is `approach_m_per_s`. A mapping becomes a column for each of its keys.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import re
import sys
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

UNITS = {"Hz": "hz", "s": "s", "m": "m", "kg": "kg", "m/s": "m_per_s", "m/s^2": "m_per_s2", "1/s": "per_s"}
UNITS |= {"mm": "mm", "mm/s": "mm_per_s", "J": "j", "N": "newton", "N s": "newton_s", "µs": "us", "ms": "ms"}
UNITS |= {"kg^(-1/2)": "per_sqrt_kg", "kg^(1/2)": "sqrt_kg", "kg^(-1/2) m^(-1)": "per_sqrt_kg_m"}
"""Unit -> the end of a column's name."""

USUAL = {"frequency_hz": "drive frequency [Hz]", "excess": "excess F/F_g - 1"}
USUAL |= {"m": "period m; 0 for a motion without a period", "restitution": "restitution tau"}
"""Field -> its words, where the row gives none."""

WORDS = re.compile(r"(?P<heading>[^\[;]*[^\[; ]) *(\[(?P<unit>[^\]]+)\])?(; (?P<note>.+))?")


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column: the field of the rows, for a mapping the `key`; its name in the file, heading, unit, note."""

    field: str
    key: str = ""
    heading: str
    unit: str
    note: str

    @property
    def name(self) -> str:
        """Field, key and unit, once each."""
        parts = [self.field, self.key, "" if self.key else UNITS.get(self.unit, "")]
        name = "_".join(part for part in parts[:2] if part)
        return name if not parts[2] or name.endswith(f"_{parts[2]}") else f"{name}_{parts[2]}"

    def cell(self, row: object) -> object:
        """The value of a row in this column; None where there is none."""
        value = getattr(row, self.field)
        value = (value or {}).get(self.key) if self.key else value
        value = value.item() if isinstance(value, np.generic) else value
        if isinstance(value, float) and not np.isfinite(value):
            return None
        if value is None or isinstance(value, bool | int | float | str):
            return value
        kinds = type(row).__name__, type(value).__name__
        raise TypeError(f"{self.field} of {kinds[0]} is a {kinds[1]}: a cell is one value")


def usual_words(name: str) -> str:
    """Words made from the name of a field that has none, with the unit that ends the name."""
    ends = [unit for unit, end in UNITS.items() if name.endswith(f"_{end}")]
    unit = max(ends, key=lambda unit: len(UNITS[unit]), default="")
    stem = name.removesuffix(f"_{UNITS[unit]}" if unit else "").replace("_", " ")
    return USUAL.get(name, f"{stem} [{unit}]" if unit else stem)


def columns_of(kind: type, rows: Sequence[object], words: Mapping[str, str] | None = None) -> list[Column]:
    """The columns of rows that are instances of the dataclass `kind`; `words` are for those that say none."""
    if not dataclasses.is_dataclass(kind) or {type(row) for row in rows} - {kind}:
        raise TypeError(f"a table needs rows of one dataclass, {kind.__name__}, not {set(map(type, rows))}")
    hints, found = typing.get_type_hints(kind, include_extras=True), list[Column]()
    for name in (entry.name for entry in dataclasses.fields(kind)):
        said = [part for part in getattr(hints[name], "__metadata__", ()) if isinstance(part, str)]
        text = (words or {}).get(name) or (said[0] if said else usual_words(name))
        match = WORDS.fullmatch(text)
        if match is None:
            raise ValueError(f"{name} of {kind.__name__} has the words {text!r}, not: words [unit]; note")
        about = {key: value or "" for key, value in match.groupdict().items()}
        cells = [cell for row in rows if isinstance(cell := getattr(row, name), Mapping)]
        keys = dict.fromkeys(str(key) for cell in cells for key in cell)
        if not keys:
            found.append(Column(field=name, **about))
        for key in keys:
            heading = f"{about['heading']}, {key.replace('_', ' ')}"
            found.append(Column(field=name, key=key, **{**about, "heading": heading}))
    return found


def csv_text(columns: Sequence[Column], rows: Sequence[object]) -> str:
    """The table, names first; an empty cell for None and for what is not finite."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(column.name for column in columns)
    writer.writerows([column.cell(row) for column in columns] for row in rows)
    return stream.getvalue()


def print_table(
    columns: Sequence[Column], rows: Sequence[object], caption: str, show: Sequence[str] | None
) -> None:
    """The table on the terminal: the fields and properties `show` of the rows, by default every column."""
    from rich.console import Console
    from rich.table import Table

    shown = list[tuple[str, Callable[[Any], object]]]()
    for field in dict.fromkeys([one.field for one in columns] if show is None else show):
        own = [(one.name, one.cell) for one in columns if one.field == field]
        shown += own or [(field, attrgetter(field))]  # a property is text for a person
    if shown:
        table = Table(title=caption, title_justify="left", box=None, pad_edge=False)
        for heading, _ in shown:
            table.add_column(heading, justify="right", overflow="fold")
        for row in rows:
            table.add_row(*(_shown(cell(row)) for _, cell in shown))
        width = None if sys.stderr.isatty() else 200
        Console(file=sys.stderr, width=width, markup=False, highlight=False).print(table)


def _shown(value: object) -> str:
    """A cell of a table on the terminal."""
    if value is None or isinstance(value, bool):
        return {None: "-", True: "yes", False: "no"}[value]
    return f"{value:.5g}" if isinstance(value, float) else str(value)
