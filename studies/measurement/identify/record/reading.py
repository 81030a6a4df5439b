"""A record from a file: which column is the time and which the channel, both in SI units.

The headings of `HEADINGS` are records as they stand. Any other table with a time, or a step or rate, and one
channel is a motion: a displacement, velocity or acceleration by the unit of the channel.
"""

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from studies.measurement.identify.record.records import (
    CHANNELS,
    HEADINGS,
    NOTES,
    Array,
    Kind,
    NoAnswer,
    Record,
)
from studies.shell.tables.binary import read_table
from studies.shell.tables.text import Table
from studies.shell.tables.units import COUNT_WORDS, UNITS, is_time, plain, split

FEWEST: dict[Kind, int] = {"strobe": 4, "motion": 40, "transitions": 1}  # rows that each kind needs
LARGEST, LATEST = 1e6, 1e15  # largest size of a number, in the unit of its column, and of a time [s]
FAR = 100.0  # first stamp over the span of the record, above which times begin at the first row
UNIT = re.compile(r"([-+]?[\d.]+(?:e[-+]?\d+)?)?\s*(\S+)", re.I)
KHZ = re.compile(r"([\d.]+(?:e[+-]?\d+)?)\s*(k?)", re.I)
RATES = re.compile(r"rate|sampling|abtast|\bfs\b|\bodr\b", re.I)  # names of notes that say a rate


def _float(text: str | None) -> float:
    """The number in a text; 1 for an empty one, 0 for words."""
    try:
        number = float(text or 1.0)
    except ValueError:
        return 0.0
    return number if math.isfinite(number) else 0.0


@dataclass(frozen=True)
class Source:
    """A table of a file, and what the user said of it."""

    path: Path
    table: Table
    columns: str | None
    unit: str | None
    rate: float | None

    def refuse(self, words: str) -> InvalidValue:
        """The refusal of this file."""
        return InvalidValue(f"the record {self.path} {words}")

    def place(self, name: str) -> int:
        """The column of this name, or of this number from 1."""
        names = [one.lower() for one in self.table.names]
        short = [split(one)[0].lower() for one in self.table.names]
        for known in (names, short, [str(i + 1) for i in range(len(names))]):
            if known.count(name.strip().lower()) == 1:
                return known.index(name.strip().lower())
        raise self.refuse(f"has no column {name.strip()[:40]!r}; it has {self.listed(range(len(names)))}")

    def listed(self, places: range | list[int]) -> str:
        """Columns for a sentence."""
        found = [repr(self.table.names[i]) for i in places]
        return ", ".join(found[:8]) + (f" and {len(found) - 8} more" if len(found) > 8 else "")

    def chosen(self) -> tuple[int | None, int]:
        """The columns of the time (None: there is none) and of the channel."""
        table, width = self.table, len(self.table.names)
        times = [i for i in range(width) if is_time(table.names[i], table.units[i])]
        if self.columns is not None:
            *given, value = (self.place(name) for name in self.columns.split(","))
            if len(given) > 1 or value in given:
                raise InvalidValue(f"columns is {self.columns!r}; it must be TIME,VALUE or one VALUE")
            return next(iter([*given, *times]), None), value
        counts = [i for i in range(width) if i not in times and self.counted(i)]
        counts = counts if width > len(times) + len(counts) else []  # x alone is a channel
        if not table.headed and not times and width > 1 and np.all(np.diff(table.rows[:50, 0]) > 0.0):
            times = [0]
        rest = [i for i in range(width) if i not in times and i not in counts]
        if len(rest) != 1:
            if not rest:
                raise self.refuse(
                    f"has a time and no channel beside it; its columns are {self.listed(range(width))}"
                )
            example = f"--columns {','.join(str(i + 1) for i in [*times[:1], *counts[:1]][:1] + rest[:1])}"
            raise self.refuse(f"has {len(rest)} channels, {self.listed(rest)}: choose one, as in {example}")
        return next(iter([*times, *counts]), None), rest[0]

    def channel(self, i: int) -> tuple[str, float, str]:
        """The column of a record that channel i is, the size of its unit, and how the unit is written."""
        name, written = self.table.names[i], self.table.units[i]
        dimension, size = UNITS.get(plain(written), ("", 1.0))
        if self.unit is not None:
            recorded, equals, per = self.unit.rpartition("=")
            found = UNIT.fullmatch(per.strip())
            known, many = (
                UNITS.get(plain(found[2]), ("", 1.0)) if found else ("", 1.0),
                _float(found[1] if found else ""),
            )
            if known[0] not in CHANNELS.values() or (equals and not recorded.strip()) or not many:
                raise InvalidValue(f"unit is {self.unit!r}; it must be such as mm, m/s, g or V=5e-3 m")
            dimension, size = known[0], known[1] * many
            written = self.unit.strip()
        if dimension not in CHANNELS.values():
            what = f"the unit {written!r}" if written else "no unit"
            example = (
                f"--unit {written or '1'}=5e-3 m"
                if written
                else "--unit mm, or how much 1 is: --unit 1=5e-3 m"
            )
            raise self.refuse(f"has {what} for the channel {name!r}: give {example}")
        return next(column for column, unit in CHANNELS.items() if unit == dimension), size, written

    def counted(self, i: int) -> bool:
        """Whether column i counts samples: by its name, without a unit, in steps of one."""
        unknown = plain(self.table.units[i]) not in UNITS
        named = unknown and split(self.table.names[i])[0].lower() in COUNT_WORDS
        values = self.table.rows[np.isfinite(self.table.rows[:, i]), i]
        return named and values.size > 1 and float(np.median(np.diff(values))) == 1.0

    def times(self, i: int | None) -> tuple[Array, str]:
        """The times of all rows [s], and in words where they are from."""
        table = self.table
        if i is not None and not self.counted(i):
            if self.rate is not None:
                raise InvalidValue(
                    f"rate is {self.rate:g} Hz, but {table.names[i]!r} of {self.path} is its time"
                )
            name, written = split(table.names[i])[0], plain(table.units[i])
            written = written if written in UNITS else plain(name)
            dimension, size = UNITS.get(written, ("s", 1.0))
            if dimension != "s":
                raise self.refuse(f"has the unit {written!r} for the time {name!r}: choose another column")
            return table.rows[:, i] * size, f"over {name!r} in {written if written in UNITS else 's'}"
        step, source = table.step, "the step in the file"
        for name, value in table.notes.items():
            if (found := KHZ.match(value)) and RATES.search(name):
                step, source = 1.0 / (float(found[1]) * (1e3 if found[2] else 1.0)), f"the note {name!r}"
        if self.rate is not None:
            step, source = 1.0 / self.rate, "the given rate"
        if step is None or not 0.0 < step < math.inf:
            what = "no time" if i is None else f"only the count {table.names[i]!r} for a time"
            raise self.refuse(f"has {what}: give --rate HZ")
        count: Array = (
            np.arange(1.0 * len(table.rows)) if i is None else table.rows[:, i] - np.nanmin(table.rows[:, i])
        )
        return table.start + count * step, f"at {source}"

    def positive(self, name: str) -> float | None:
        """The number above zero in a note, None if there is no such note."""
        if name not in self.table.notes:
            return None
        number = _float(self.table.notes[name])
        if not 0.0 < number <= LARGEST:
            valid = f"it must be a number above zero and at most {LARGEST:g}"
            raise InvalidValue(f"the note {name} of {self.path} is {self.table.notes[name][:40]!r}; {valid}")
        return number

    def first(self, wrong: NDArray[np.bool_], *places: int | None) -> str:
        """Line and text of the first row that is wrong."""
        line = int(self.table.lines[int(np.argmax(wrong))])
        texts = [
            self.table.lost.get((line, -1 if i is None else i))
            for i in places or range(len(self.table.names))
        ]
        return f"line {line}, {next((text for text in texts if text is not None), '')!r}"

    def motion(self) -> Record:
        """The record of one channel over time; rows without a number or with a repeated time are left out."""
        time, value = self.chosen()
        column, size, written = self.channel(value)
        times, over = self.times(time)
        rows, notes = np.column_stack([times, self.table.rows[:, value] * size]), list[str]()
        lost, n = np.asarray(np.isnan(rows).any(axis=1)), len(rows)
        if lost.any():
            count, at = f"{int(np.sum(lost))} of {n} rows", self.first(lost, time, value)
            if np.sum(lost) > 0.5 * n:
                raise self.refuse(f"has no number in {count}: the first is {at}")
            notes.append(f"{count} hold no number and are left out: the first is {at}")
        kept = np.flatnonzero(~lost)
        steps = np.diff(times[kept])
        if np.any(steps < 0.0):
            i = int(kept[int(np.argmax(steps < 0.0)) + 1])
            raise self.refuse(
                f"has the time {times[i]:.12g} s in line {self.table.lines[i]}; times must rise"
            )
        if np.any(steps == 0.0):
            i = int(kept[int(np.argmax(steps == 0.0)) + 1])
            where = f"the first is line {self.table.lines[i]}"
            notes.append(
                f"{int(np.sum(steps == 0.0))} of {n} rows repeat the time before and are left out: {where}"
            )
            kept, steps = kept[np.append(True, steps > 0.0)], steps[steps > 0.0]
        rate = 1.0 / float(np.median(steps)) if steps.size else math.nan
        name = split(self.table.names[value])[0]
        said = f"read as {self.table.recognised}: {name!r} in {written} {over}, {len(kept)} rows"
        said += f" at {rate:.6g} Hz"
        if self.columns is self.unit is self.rate is None and self.table.names == ("time_s", column):
            said = ""
        columns = ("time_s", column)
        return Record(columns=columns, rows=rows[kept], notes=tuple(notes), reading=said)


def read_record(
    path: Path, *, columns: str | None = None, unit: str | None = None, rate: float | None = None
) -> Record:
    """The record in a file; InvalidValue with one sentence on what is wrong with it.

    `columns` are TIME,VALUE or VALUE by name or number, `unit` of the channel replaces the file's, and `rate`
    [Hz] gives times where there are none.
    """
    table = read_table(path)
    source, heading = Source(path, table, columns, unit, rate), tuple(name.lower() for name in table.names)
    drive = [source.positive(name) for name in NOTES]
    if columns is unit is rate is None and HEADINGS.get(heading, "motion") != "motion":
        record = Record(columns=heading, rows=table.rows)
        lost = np.asarray(np.isnan(table.rows).any(axis=1))
        if lost.any():
            raise source.refuse(f"has {source.first(lost)}, which is no number")
    else:
        record = source.motion()
    _check(record, source)
    first, last = record.rows[[0, -1], 0]
    if record.kind == "motion" and abs(first) > FAR * (last - first):
        record = replace(record, rows=record.rows - [first, 0.0], origin=float(first))
    return replace(record, frequency=drive[0], amplitude=drive[1])


def _check(record: Record, source: Source) -> None:
    """Refuse rows that no record of its kind has."""
    rows, fewest = record.rows, FEWEST[record.kind]
    limits = np.array([LATEST if name == "time_s" else LARGEST for name in record.columns])
    if (large := np.abs(rows) > limits).any():
        i, k = (int(one) for one in np.argwhere(large)[0])
        valid = f"it must be a number of at most {limits[k]:g} in size"
        raise InvalidValue(f"{record.columns[k]} in row {i + 1} of {source.path} is {rows[i, k]:g}; {valid}")
    if len(rows) < fewest:
        raise source.refuse(f"has {len(rows)} rows; one of its kind needs {fewest} at least")
    if record.kind == "motion" and np.all(rows[:, 1] == rows[0, 1]):
        what = f"{rows[0, 1]:g} {record.unit} in all rows"
        raise NoAnswer(f"the reading in {source.path} is {what}; a record must move")
    if record.kind == "transitions":
        wrong = (rows[:, 0] <= 0.0) | (rows[:, 1] % 1 != 0) | (rows[:, 1] < 1) | (rows[:, 2] <= -1.0)
        wrong |= np.any(rows[:, 3:] <= 0.0, axis=1)
        if np.any(wrong):
            needs = "a frequency above 0 Hz, a whole period, an excess above -1 and an error above 0"
            raise InvalidValue(f"row {int(np.argmax(wrong)) + 1} of {source.path} needs {needs}")
