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
from studies.shell.tables.units import COUNT_WORDS, is_time, known, plain, split

FEWEST: dict[Kind, int] = {"strobe": 4, "motion": 40, "transitions": 1}  # rows that each kind needs
LARGEST, LATEST = 1e6, 1e15  # largest size of a number, in the unit of its column, and of a time [s]
LEAST, MOST = 1e-15, 1e9  # sizes of a unit, in SI
COARSE = 0.02  # step of rounded stamps over the time between two rows, above which rows are evenly spaced
SAME = 0.95  # share of equal steps above which the others are faults and no rounding
DAY = 86400.0  # [s]
FAR = 100.0  # first stamp over the span of the record, above which times begin at the first row
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?", re.I)
UNIT = re.compile(rf"(?:.+=)?\s*({NUMBER.pattern})?\s*([^\s=]+)", re.I)  # mm, V=mm, V=5e-3 m
RATE = re.compile(rf"({NUMBER.pattern})\s*(k?)", re.I)  # 2000 Hz, 2 kHz
RATES = re.compile(r"rate|sampling|abtast|\bfs\b|\bodr\b", re.I)  # names of notes that say a rate


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
        numbers = [str(i + 1) for i in self.table.places]
        for way in (names, [split(one)[0] for one in names], numbers):
            if way.count(name.strip().lower()) == 1:
                return way.index(name.strip().lower())
            if way.count(name.strip().lower()) > 1:
                raise self.refuse(f"has several columns {name.strip()[:40]!r}: choose by number, {numbers}")
        raise self.refuse(f"has no column {name.strip()[:40]!r}; it has {self.listed(range(len(names)))}")

    def listed(self, places: range | list[int]) -> str:
        """Columns for a sentence."""
        found = [repr(self.table.names[i]) for i in places]
        return ", ".join(found[:8]) + (f" and {len(found) - 8} more" if len(found) > 8 else "")

    def chosen(self) -> tuple[int | None, int]:
        """The columns of the time (None: there is none) and of the channel."""
        table, width = self.table, len(self.table.names)
        times = [i for i in range(width) if is_time(table.names[i], table.units[i])]
        if table.names[0] == "column 1" and not times and width > 1:  # no heading
            first = table.rows[np.isfinite(table.rows[:, 0]), 0][:50]
            times = [0] if np.all(np.diff(first) >= 0.0) and first[-1] > first[0] else []
        if self.columns is not None:
            *given, value = (self.place(name) for name in self.columns.split(","))
            if len(given) > 1 or value in given:
                raise InvalidValue(f"columns is {self.columns!r}; it must be TIME,VALUE or one VALUE")
            return next((i for i in [*given, *times] if i != value), None), value
        counts = [i for i in range(width) if i not in times and self.counted(i)]
        counts = counts if width > len(times) + len(counts) else []  # x alone is a channel
        clocks = [*times, *counts]
        rest = [i for i in range(width) if i not in clocks]
        if not rest:
            raise self.refuse(f"has no channel beside its time; its columns are {self.listed(times)}")
        if len(rest) > 1:
            what = f"{len(rest)} channels, {self.listed(rest)}"
            example = ",".join(str(table.places[i] + 1) for i in [*clocks[:1], rest[0]])
            raise self.refuse(f"has {what}: choose one, as in --columns {example}")
        return next(iter(clocks), None), rest[0]

    def channel(self, i: int) -> tuple[str, float, str]:
        """The column of a record that channel i is, the size of its unit, and how the unit is written."""
        written, stated = self.table.units[i], known(self.table.units[i])
        dimension, size = stated
        if self.unit is not None:
            found = UNIT.fullmatch(self.unit.strip())
            dimension, size = known(found[2]) if found else ("", 1.0)
            size *= float(found[1] or 1.0) if found else 1.0
            if dimension not in CHANNELS.values() or not LEAST < abs(size) < MOST:
                raise InvalidValue(f"unit is {self.unit!r}; it must be such as mm, m/s, g or V=5e-3 m")
            symbol, equals, _ = self.unit.partition("=")
            alike = plain(written).lower().startswith(plain(symbol).lower())  # V, Volt
            if equals and written and symbol.strip() != "1" and not alike:
                raise self.refuse(f"has the unit {written!r}, but unit is {self.unit!r}")
            differs = stated[0] and stated != (dimension, size)
            written = self.unit.strip() + (f" (the file says {written})" if differs else "")
        if dimension not in CHANNELS.values():
            what = f"the unit {written!r}" if written else "no unit"
            example = f"{written}=5e-3 m" if written else "mm, or how much 1 is: --unit 1=5e-3 m"
            raise self.refuse(f"has {what} for the channel {self.table.names[i]!r}: give --unit {example}")
        return next(column for column, unit in CHANNELS.items() if unit == dimension), size, written

    def counted(self, i: int) -> bool:
        """Whether column i counts samples: by its name, without a unit, in steps of one."""
        named = split(self.table.names[i])[0].lower() in COUNT_WORDS and not known(self.table.units[i])[0]
        values = self.table.rows[np.isfinite(self.table.rows[:, i]), i]
        return named and values.size > 1 and float(np.median(np.diff(values))) == 1.0

    def times(self, i: int | None) -> tuple[Array, str]:
        """The times of all rows [s], and in words where they are from."""
        table = self.table
        if i is not None and self.rate is None and not self.counted(i):
            name, written = split(table.names[i])[0], table.units[i]
            if written and not known(written)[0] and not re.fullmatch(r"[hmsyd:./ _-]*", written, re.I):
                raise self.refuse(
                    f"has the unit {written!r} for the time {name!r}; it must be s, ms, min or h"
                )
            unit = next((one for one in (table.units[i], name) if known(one)[0]), "s")  # millis, ...
            dimension, size = known(unit)
            if dimension != "s":
                raise self.refuse(f"has the unit {unit!r} for the time {name!r}: choose another column")
            return table.rows[:, i] * size, f"over {name!r} in {plain(unit)}"
        step, source = table.step, "the step in the file"
        for name, value in table.notes.items():
            if (found := RATE.match(value)) and RATES.search(name) and float(found[1]) > 0.0:
                step, source = 1.0 / (float(found[1]) * (1e3 if found[2] else 1.0)), f"the note {name!r}"
        if self.rate is not None:
            step, source = 1.0 / self.rate, "the given rate"
        if step is None or not 0.0 < step < math.inf:
            what = "no time" if i is None else f"only the count {table.names[i]!r} for a time"
            raise self.refuse(f"has {what}: give --rate HZ")
        count = np.arange(1.0 * len(table.rows))
        if i is not None and self.counted(i):
            count = table.rows[:, i] - np.nanmin(table.rows[:, i])
        return table.start + count * step, f"at {source}"

    def positive(self, name: str) -> float | None:
        """The number above zero in a note, None if there is no such note."""
        text = self.table.notes.get(name, "")
        number = float(text) if NUMBER.fullmatch(text) else 0.0
        if text and not 0.0 < number <= LARGEST:
            valid = f"it must be a number above zero and at most {LARGEST:g}"
            raise InvalidValue(f"the note {name} of {self.path} is {text[:40]!r}; {valid}")
        return number or None

    def first(self, lost: NDArray[np.bool_], *columns: int | None) -> str:
        """Line and text of the first row that is lost, of these columns."""
        row = int(np.argmax(lost))
        places = [i for i in columns if i is not None and np.isnan(self.table.rows[row, i])]
        return f"line {self.table.lines[row]}, {self.table.cell(row, places[0])!r}"

    def motion(self) -> Record:
        """The record of one channel over time; rows without a number or with a repeated time are left out."""
        time, value = self.chosen()
        column, size, unit = self.channel(value)
        times, over = self.times(time)
        if time is not None and ":" in self.table.cell(0, time):  # a time of day, past midnight
            times = times + DAY * np.append(0.0, np.cumsum(np.diff(times) < -0.5 * DAY))
        times, rounded = evened(times)
        rows, notes, n = np.column_stack([times, self.table.rows[:, value] * size]), [*rounded], len(times)
        lost = np.asarray(np.isnan(rows).any(axis=1))
        if lost.any():
            count, at = f"{np.sum(lost)} of {n} rows", f"the first is {self.first(lost, time, value)}"
            if np.sum(lost) > 0.5 * n:
                raise self.refuse(f"has no number in {count}: {at}")
            notes.append(f"{count} hold no number and are left out: {at}")
        kept = np.flatnonzero(~lost)
        steps = np.diff(times[kept])
        falls, again = kept[1:][steps < 0.0], kept[1:][steps == 0.0]
        if falls.size:
            at = f"{times[falls[0]]:.12g} s in line {self.table.lines[falls[0]]}"
            raise self.refuse(f"has the time {at}; times must rise")
        if again.size:
            at = f"the first is line {self.table.lines[again[0]]}"
            if again.size > 0.5 * n:
                what = f"{again.size} of {n} rows that repeat the time before"
                raise self.refuse(f"has {what}: its times are too coarse, so give --rate HZ")
            notes.append(f"{again.size} of {n} rows repeat the time before and are left out: {at}")
        kept = np.setdiff1d(kept, again)
        rate = 1.0 / np.median(steps[steps > 0.0]) if len(kept) > 1 else math.nan
        what = f"{split(self.table.names[value])[0]!r} in {unit} {over}, {len(kept)} rows at {rate:.6g} Hz"
        record = Record(columns=("time_s", column), rows=rows[kept], notes=tuple(notes))
        if self.columns is self.unit is self.rate is None and self.table.names == record.columns:
            return record
        return replace(record, reading=f"read as {self.table.recognised}: {what}")


def evened(times: Array) -> tuple[Array, list[str]]:
    """Times of evenly spaced rows where a clock has rounded most of them, and a note; else the times."""
    kept = np.flatnonzero(np.isfinite(times))
    each = np.round(np.diff(times[kept]) / np.diff(kept), 9) if kept.size > 2 else np.zeros(1)
    steps = np.unique(each)
    if not 1 < steps.size < 6 or np.mean(each == np.median(each)) > SAME:
        return times, []
    clock, line = float(np.diff(steps).min()), np.polyfit(kept, times[kept], 1)
    even = np.asarray(np.polyval(line, np.arange(times.size)), dtype=float)
    slope, off = float(line[0]), float(np.abs(even - times)[kept].max())
    if not clock > COARSE * slope or off > 1.01 * clock or slope * times.size < 50.0 * clock:
        return times, []
    note = f"stamps are multiples of {clock:.3g} s: rows are taken as evenly spaced by {slope:.6g} s"
    return even, [note]


def read_record(
    path: Path, *, columns: str | None = None, unit: str | None = None, rate: float | None = None
) -> Record:
    """The record in a file; InvalidValue with one sentence on what is wrong with it.

    `columns` are TIME,VALUE or VALUE by name or number, `unit` of the channel replaces the file's, and `rate`
    [Hz] gives times in place of the file's.
    """
    table = read_table(path)
    source, heading = Source(path, table, columns, unit, rate), tuple(name.lower() for name in table.names)
    frequency, amplitude = (source.positive(name) for name in NOTES)
    if columns is unit is rate is None and HEADINGS.get(heading, "motion") != "motion":
        record = Record(columns=heading, rows=table.rows)
        lost = np.asarray(np.isnan(table.rows).any(axis=1))
        if lost.any():
            raise source.refuse(f"has {source.first(lost, *range(len(heading)))}, which is no number")
    else:
        record = source.motion()
    _check(record, source)
    first, last = record.rows[[0, -1], 0]
    if record.kind == "motion" and abs(first) > FAR * (last - first):
        record = replace(record, rows=record.rows - [first, 0.0], origin=float(first))
    return replace(record, frequency=frequency, amplitude=amplitude)


def _check(record: Record, source: Source) -> None:
    """Refuse rows that no record of its kind has."""
    rows, fewest = record.rows, FEWEST[record.kind]
    limits = np.array([LATEST if name == "time_s" else LARGEST for name in record.columns])
    for i, k in np.argwhere(np.abs(rows) > limits)[:1]:
        valid = f"it must be a number of at most {limits[k]:g} in size"
        raise InvalidValue(f"{record.columns[k]} in row {i + 1} of {source.path} is {rows[i, k]:g}; {valid}")
    if len(rows) < fewest:
        raise source.refuse(f"has {len(rows)} rows; one of its kind needs {fewest} at least")
    if record.kind == "motion" and np.all(rows[:, 1] == rows[0, 1]):
        what = f"{rows[0, 1]:g} {record.unit} in all rows"
        raise NoAnswer(f"the reading in {source.path} is {what}; a record must move")
    if record.kind == "transitions":
        right = (rows[:, 0] > 0.0) & (rows[:, 1] % 1 == 0) & (rows[:, 1] >= 1) & (rows[:, 2] > -1.0)
        right &= np.all(rows[:, 3:] > 0.0, axis=1)
        if not right.all():
            needs = "a frequency above 0 Hz, a whole period, an excess above -1 and an error above 0"
            raise InvalidValue(f"row {int(np.argmin(right)) + 1} of {source.path} needs {needs}")
