"""Measured records: three kinds, distinguished by their heading (`HEADINGS`), and synthetic ones.

x is the displacement of the tip relative to the base, and the base moves as Z sin(2 pi f t). Strobe points
begin at a strobe, a displacement at any time; stamps that begin far from zero count from the first row. Lines
that begin with # are skipped, but the first two kinds take their drive from `# frequency_hz = 22.2` and
`# amplitude_m = 0.002`. The noise is that of the read-out, independent from row to row: of x one sigma [m],
of v 2 pi f sigma; of an excess the error in the table or the letter's amplitude stability.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from contact import ContactError, ImpactOscillator, StroboscopicMap, simulate
from contact.orbits import Shooting, onset_orbit
from studies import letter

Array = NDArray[np.float64]
Kind = Literal["strobe", "motion", "transitions"]

READ_OUT = 0.5e-6  # noise of the read-out of synthetic records, and the default unit of residuals [m]
HEADINGS: dict[tuple[str, ...], Kind] = {
    ("x_m",): "strobe",
    ("x_m", "v_m_per_s"): "strobe",
    ("time_s", "x_m"): "motion",
    ("time_s", "v_m_per_s"): "motion",
    ("time_s", "a_m_per_s2"): "motion",
    ("frequency_hz", "period", "excess"): "transitions",
    ("frequency_hz", "period", "excess", "error"): "transitions",
}
CHANNELS = {"x_m": "m", "v_m_per_s": "m/s", "a_m_per_s2": "m/s²"}
"""What a motion may be recorded as: displacement, velocity or acceleration, with its SI unit."""
SI = [*CHANNELS.values()]
NOTES = ("frequency_hz", "amplitude_m")
FEWEST = {"strobe": 4, "motion": 40, "transitions": 1}  # rows that each kind needs
LARGEST, LATEST = 1e6, 1e15  # largest size of a number, in the unit of its column, and of a time [s]
FAR = 100.0  # first stamp over the span of the record, above which times begin at the first row


class NoAnswer(ContactError):
    """A record that cannot answer, with what was found in it."""

    def __init__(self, sentence: str) -> None:
        self.time = self.gap = self.velocity = math.nan
        RuntimeError.__init__(self, sentence)


class Undetermined(NoAnswer):
    """A record that a model fits, and that does not determine its parameters."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """A record: its `columns`, `rows` of shape (n_rows, n_columns), and the drive where it is known.

    `frequency` [Hz] and `amplitude` [m] are None where the record has no such line; `origin` [s] is what was
    subtracted from its times; a sensor on the `ground` reads the motion of the base as well; `notes` say
    what was changed of it for a fit.
    """

    columns: tuple[str, ...]
    rows: Array
    frequency: float | None = None
    amplitude: float | None = None
    origin: float = 0.0
    ground: bool = False
    notes: tuple[str, ...] = ()

    @property
    def order(self) -> int:
        """Which derivative of the displacement in time a motion has: 0, 1 or 2."""
        return [*CHANNELS].index(self.columns[-1]) if self.kind == "motion" else 0

    @property
    def unit(self) -> str:
        """The SI unit of what is observed: m, m/s, m/s² or, of an excess, 1."""
        return "1" if self.kind == "transitions" else CHANNELS.get(self.columns[-1], "m")

    @property
    def kind(self) -> Kind:
        """Which of the three kinds it is."""
        return HEADINGS[self.columns]

    @property
    def observed(self) -> Array:
        """What a model has to give, shape (n_rows, 1 or 2): x [m] and perhaps v [m/s], or excess [1]; a view
        of the rows."""
        first = {"strobe": 0, "motion": 1, "transitions": 2}[self.kind]
        return self.rows[:, first : len(self.columns) if self.kind == "strobe" else first + 1]

    def units(self, noise: float) -> Array:
        """Standard deviation of each observed number if that of x is `noise`; shape of `observed`."""
        if self.kind == "transitions":
            return self.rows[:, 3:] if len(self.columns) > 3 else np.full((len(self.rows), 1), noise)
        each = [1.0, 2.0 * math.pi * (self.frequency or 1.0)][: self.observed.shape[1]]
        return np.broadcast_to(noise * np.array(each), self.observed.shape)

    def noisy(self, seed: int, noise: float = READ_OUT) -> Self:
        """The record with normal noise on what is observed, standard deviations as in `units`."""
        found = replace(self, rows=self.rows.copy())
        random = np.random.default_rng(seed)
        found.observed[:] += random.standard_normal(self.observed.shape) * self.units(noise)
        return found

    def text(self) -> str:
        """The record as CSV."""
        notes = zip(NOTES, (self.frequency, self.amplitude), strict=True)
        lines = [f"# {name} = {value!r}" for name, value in notes if value is not None]
        cells = (",".join(f"{number:.10g}" for number in row) for row in self.rows)
        return "\n".join([*lines, ",".join(self.columns), *cells]) + "\n"


def read_record(path: Path) -> Record:
    """The record in a CSV file; ValueError with one sentence on what is wrong with it."""
    try:
        lines = [line.strip() for line in path.read_text(encoding="utf-8-sig").splitlines()]
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
        raise InvalidValue(f"the record {path} cannot be read: {reason}") from error
    notes = dict[str, float]()
    for line in lines:
        name, equals, value = (part.strip() for part in line.lstrip("#").partition("="))
        if line.startswith("#") and equals and name in NOTES:
            notes[name] = _number(value, f"the note {name}", path)
            if notes[name] <= 0.0:
                raise InvalidValue(f"the note {name} of {path} is {notes[name]:g}; it must be above zero")
    kept = [line for line in lines if line and not line.startswith("#")]
    heading = tuple(word.strip().lower() for word in kept[0].split(",")) if kept else ()
    if heading not in HEADINGS:
        known = "; ".join(",".join(names) for names in HEADINGS)
        found = f"has the heading {','.join(heading)[:60]!r}" if kept else "is empty"
        raise InvalidValue(f"the record {path} {found}; its heading must be one of {known}")
    numbers = list[float]()
    for i, row in enumerate((line.split(",") for line in kept[1:]), 1):
        if len(row) != len(heading):
            raise InvalidValue(f"row {i} of {path} has {len(row)} cells, the heading {len(heading)}")
        cells = zip(heading, row, strict=True)
        numbers += [_number(cell, f"{name} in row {i}", path) for name, cell in cells]
    rows = np.array(numbers, dtype=float).reshape(-1, len(heading))
    record = Record(columns=heading, rows=rows, frequency=notes.get(NOTES[0]), amplitude=notes.get(NOTES[1]))
    _check(record, path)
    first, last = rows[[0, -1], 0]
    if record.kind == "motion" and abs(first) > FAR * (last - first):
        record = replace(record, rows=rows - [first, 0.0], origin=float(first))
    return record


def _number(text: str, place: str, path: Path) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not abs(number) <= (most := LATEST if place.startswith("time_s") else LARGEST):
        valid = f"it must be a number of at most {most:g} in size"
        raise InvalidValue(f"{place} of {path} is {text.strip()[:40]!r}; {valid}")
    return number


def _check(record: Record, path: Path) -> None:
    """ValueError for rows that no record of its kind has."""
    rows, fewest = record.rows, FEWEST[record.kind]
    if len(rows) < fewest:
        raise InvalidValue(f"the record {path} has {len(rows)} rows; one of its kind needs {fewest} at least")
    if record.kind == "motion":
        falling = np.flatnonzero(np.diff(rows[:, 0]) <= 0.0)
        if falling.size:
            row = int(falling[0]) + 2
            raise InvalidValue(f"time_s of {path} is {rows[row - 1, 0]:g} s in row {row}; times must rise")
        if np.all(rows[:, 1] == rows[0, 1]):
            raise NoAnswer(f"the displacement in {path} is {rows[0, 1]:g} m in all rows; a record must move")
    if record.kind == "transitions":
        wrong = (rows[:, 0] <= 0.0) | (rows[:, 1] % 1 != 0) | (rows[:, 1] < 1) | (rows[:, 2] <= -1.0)
        wrong |= np.any(rows[:, 3:] <= 0.0, axis=1)
        if np.any(wrong):
            needs = "a frequency above 0 Hz, a whole period, an excess above -1 and an error above 0"
            raise InvalidValue(f"row {int(np.argmax(wrong)) + 1} of {path} needs {needs}")


def synthetic(
    kind: Kind,
    oscillator: ImpactOscillator,
    transitions: tuple[tuple[float, int], ...] = tuple(letter.PERIODS.items()),
    *,
    seed: int | None = None,
    noise: float | None = None,
    periods: int = 40,
    velocity: bool = False,
) -> Record:
    """What an oscillator at its drive gives to measure, with `noise` [m, or excess] unless `seed` is None.

    The motion is the one it settles on from just below grazing, recorded for so many drive `periods`, as
    strobe points perhaps with their `velocity`, or 90 times a drive period and some more, so that not every
    impact meets a row in the same way. A table has the folds of `transitions` (frequency [Hz], m).
    """
    drive = oscillator.driven
    if kind == "transitions":
        there = [replace(oscillator, drive=replace(drive, frequency=f)) for f, _ in transitions]
        pairs = zip(there, transitions, strict=True)
        folds = [Shooting(oscillator=one, m=m).fold() for one, (_, m) in pairs]
        found = [[*at, one.excess] for at, one in zip(transitions, folds, strict=True) if one is not None]
        record = Record(columns=("frequency_hz", "period", "excess"), rows=np.array(found))
    else:
        start = onset_orbit(StroboscopicMap(oscillator=oscillator), oscillator.excess).end
        strobes = kind == "strobe"
        begin, each = round(start.time * drive.frequency) / drive.frequency, 1.0 if strobes else 90.09
        times = np.arange(int(periods * each)) / (each * drive.frequency)
        motion = simulate(oscillator, start, periods=periods + 1, times=np.maximum(start.time, begin + times))
        tips = [oscillator.tip(one) for one in (motion.displacement, motion.velocity)[: 1 + velocity]]
        columns = ("x_m", "v_m_per_s")[: 1 + velocity] if strobes else ("time_s", "x_m")
        rows = np.column_stack(tips if strobes else [times, tips[0]])
        record = Record(columns=columns, rows=rows, frequency=drive.frequency, amplitude=drive.amplitude)
    usual = letter.AMPLITUDE_STABILITY if kind == "transitions" else READ_OUT
    return record if seed is None else record.noisy(seed, usual if noise is None else noise)
