"""Measured records: three kinds, distinguished by their heading (`HEADINGS`), and synthetic ones.

x is the displacement of the tip relative to the base, and the base moves as Z sin(2 pi f t). Strobe points
begin at a strobe, a displacement at any time. The first two kinds take their drive from the lines
`# frequency_hz = 22.2` and `# amplitude_m = 0.002`. The noise is that of the read-out, independent from row
to row: of x one sigma [m], of v 2 pi f sigma; of an excess the error in the table or the letter's amplitude
stability.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

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
    subtracted from its times; a sensor on the `ground` reads the motion of the base as well; `notes` say what
    was changed of it for a fit, `reading` how its file was understood.
    """

    columns: tuple[str, ...]
    rows: Array
    frequency: float | None = None
    amplitude: float | None = None
    origin: float = 0.0
    ground: bool = False
    notes: tuple[str, ...] = ()
    reading: str = ""

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
