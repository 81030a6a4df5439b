"""Frozen records of named values, which print with units.

    @record
    class HarmonicDrive:
        ...

    HarmonicDrive(frequency=22.2 Hz, amplitude=0.00263 m)

A record is a frozen, keyword-only dataclass. It prints its fields that differ from their defaults, in eight
lines at most; an array prints as its shape and range. Units are read from the docstring of the class, where
they stand in brackets beside each parameter. A notebook shows a table.
"""

import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from functools import cache
from html import escape
from typing import Any, dataclass_transform

import numpy as np

WIDEST, LINES, NESTED, SHORT = 100, 8, 75, 4
"""Characters of a line, and lines, of a record; characters of a record within a record; numbers of an array
that are all shown."""

ROWS = 12
"""Rows of a table in a notebook."""

Record = Any  # an instance of a record, or one of its values
PARAMETER = re.compile(r"^(\w+(?:, \w+)*) : .*\n((?:    .*\n|\n)*)", re.MULTILINE)
UNIT = re.compile(r"\[(1\]|(?:1/|m|kg|s|Hz|N|Pa|J|rad)[^\],]*)")


@dataclass_transform(kw_only_default=True, frozen_default=True, eq_default=False, field_specifiers=(field,))
def record(kind: Record = None, *, eq: bool = False, init: bool = True) -> Record:
    """Make a class a frozen, keyword-only dataclass that prints with units; `eq` compares by value."""

    def made(cls: type) -> type:
        for name, method in (("__repr__", in_words), ("_repr_html_", as_table)):
            if name not in vars(cls):
                setattr(cls, name, method)
        return dataclass(frozen=True, kw_only=True, eq=eq, init=init)(cls)

    return made if kind is None else made(kind)


@cache
def units_of(kind: type) -> dict[str, str]:
    """Return the unit of each field in the docstring of a class, from the brackets beside it."""
    found = dict[str, str]()
    for names, text in PARAMETER.findall(inspect.cleandoc(kind.__doc__ or "") + "\n"):
        each, units = names.split(", "), [unit.replace("1]", "") for unit in UNIT.findall(text)]
        found |= dict(zip(each, units if len(units) >= len(each) else units[:1] * len(each), strict=False))
    return found


def in_words(one: Record) -> str:
    """Return the fields of a record with their units, in `LINES` lines at most."""
    parts = [f"{name}={text}" for name, text in _entries(one)]
    line = f"{type(one).__name__}({', '.join(parts)})"
    if len(line) <= WIDEST:
        return line
    kept = parts if len(parts) < LINES else parts[: LINES - 2]
    others = ", ".join(part.partition("=")[0] for part in parts[len(kept) :])
    lines = [f"{type(one).__name__}(", *kept, *([f"and {others}"] if others else [])]
    return "\n    ".join(line if len(line) <= WIDEST else f"{line[: WIDEST - 3]}..." for line in lines) + ")"


def as_table(one: Record) -> str:
    """Return a record as tables in HTML: its fields, and row by row its arrays that have one length."""
    columns = {each.name: getattr(one, each.name) for each in fields(one) if each.repr}
    columns = {name: x for name, x in columns.items() if isinstance(x, np.ndarray) and x.ndim == 1}
    if len(columns) < 2 or len({column.size for column in columns.values()}) > 1:
        columns = {}
    rest = ((name, text) for name, text in _entries(one) if name not in columns)
    rows = "".join(f"<tr><th>{name}</th><td>{escape(text)}</td></tr>" for name, text in rest)
    table = f"<table><caption>{type(one).__name__}</caption>{rows}</table>"
    return table + rows_in_html(columns, units_of(one.__class__))


def rows_in_html(columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> str:
    """Return columns of one length as a table in HTML, which shows the first `ROWS` rows."""
    count = max((column.size for column in columns.values()), default=0)
    heads = (name if units.get(name, "1") == "1" else f"{name} [{units[name]}]" for name in columns)
    rows = ["".join(f"<th>{head}</th>" for head in heads)]
    for row in zip(*(column[:ROWS] for column in columns.values()), strict=True):
        rows.append("".join(f"<td>{_number(value)}</td>" for value in row))
    rows += [f"<td colspan={len(columns)}>and {count - ROWS} more</td>"] if count > ROWS else []
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>" if columns else ""


def _entries(one: Record) -> Iterator[tuple[str, str]]:
    """Name and text of the fields that differ from their defaults."""
    units = units_of(one.__class__)
    for each in fields(one):
        value = getattr(one, each.name)
        if each.repr and not (value is each.default or (np.isscalar(value) and value == each.default)):
            yield each.name, _text(value, units.get(each.name, ""))


def _text(value: Record, unit: str) -> str:
    """A value with its unit, in a few words."""
    if isinstance(value, np.ndarray) and (value.ndim != 1 or value.size > SHORT):
        numbers = value[np.isfinite(value)] if value.dtype.kind in "iuf" else value[:0].ravel()
        ends = f", {_number(numbers.min())} to {_number(numbers.max())} {unit}" if numbers.size else ""
        return f"{value.dtype} of shape {value.shape}{ends}".rstrip()
    if isinstance(value, list | tuple | np.ndarray):
        line = ", ".join(_text(each, "") for each in value[:SHORT])
        kinds = " and ".join(dict.fromkeys(type(each).__name__ for each in value))
        short = len(value) <= SHORT and len(line) <= NESTED
        return f"({line}) {unit}".rstrip() if short else f"{len(value)} times {kinds}"
    if isinstance(value, Mapping):
        return f"{{{', '.join(map(str, value))}}}"
    if type(value).__repr__ is in_words:
        return _cut(value)
    plain = isinstance(value, float | int | np.number) and not isinstance(value, bool | Enum)
    text = f"{_number(value)} {unit}".rstrip() if plain else ""
    text = text or getattr(value, "__name__", "") or repr(value)
    return text if len(text) <= WIDEST and "\n" not in text else f"{type(value).__name__}(...)"


def _cut(one: Record) -> str:
    """A record within another one: the fields for which `NESTED` characters are enough."""
    line, left = f"{type(one).__name__}(", False
    for name, text in _entries(one):
        longer = f"{line}{'' if line.endswith('(') else ', '}{name}={text}"
        line, left = (line, True) if len(longer) > NESTED else (longer, left)
    return f"{line}{', ' if left and not line.endswith('(') else ''}{'...' if left else ''})"


def _number(value: Record) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
