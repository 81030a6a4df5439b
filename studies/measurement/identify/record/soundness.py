"""What is wrong with a record before any search: rows, drive and units.

A motion that repeats after m periods of a drive of frequency f has lines at k f/m only. Impacts make corners:
a row still agrees with the parabola through the three rows before it or after it. Times in s, readings in m,
each of shape (rows,).
The order is 0 for a displacement, 1 for a velocity, 2 for an acceleration.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from beam import InvalidValue
from contact import ImpactOscillator
from studies.measurement.identify.record.records import SI, Array, NoAnswer, Record
from studies.measurement.identify.record.spectrum import NEAR, peaks, scatter
from studies.physics.parameters import parameters_of, with_values
from studies.shell.digits import in_unit

STRONG = 0.3  # height of the drive's line over the strongest; settled motions: above 0.7
RESOLVED, UNRESOLVED = 0.05, 0.3  # parts of 1/span by which other lines move one: of three orbits, of fewer
ALIKE = 0.025  # part of a record that an orbit leaves; noise of 1 %: 0.016
STICKING = 6.0  # rows at an extreme reading over rows at the next; turning point: 2.4, flat: 5.3
STRAY = 12.0  # standard deviations of an outlier; corners: 8

MOST, DENSE = 20_000, 40  # rows that are fitted at most; rows a drive period that are left of more
OFF = 0.01  # part by which the given drive frequency may be off
APART = 100.0  # ratio of an amplitude to that of grazing which may be one of units
BEYOND = 10.0  # largest strobe point over the gap

MISREAD = {1.0: "", 1e-3: "in kHz", 2.0 * math.pi: "in rad/s", 60.0: "in 1/min", 2.0: "2 f", 0.5: "f/2"}
MISREAD[1e3] = "right if time_s is in ms: divide it by 1e3"
MISREAD[1e6] = "right if time_s is in µs: divide it by 1e6"
"""What a given drive may be, by its ratio to that of the record."""

RATIOS = (
    ("milli{}", "1000", 1e3, 3.0, ("gap", "amplitude", "free_period")),
    ("micro{}", "1e6", 1e6, 3.0, ("gap", "amplitude", "free_period")),
    ("units of g", "9.81", 9.81, 1.01, ("amplitude",)),
    ("an angular frequency", "2 pi", 2.0 * math.pi, 1.01, ("free_period", "frequency")),
)
"""Units, their ratio, by which factor another may differ and still be one (10 is none), and of what."""
WRONG = {"amplitude": 30.0, "gap": 300.0}  # ratios that only a wrong unit explains


def drive_found(times: Array, values: Array, frequency: float, order: int = 0) -> tuple[float, str] | None:
    """The drive by the record [Hz] and a sentence, if the given `frequency` is not that of a strong line."""
    lines, heights = peaks(times, values, order)
    lines, span = lines[heights > STRONG], float(times[-1] - times[0])
    rate = (times.size - 1) / span
    seen = abs(frequency - rate * round(frequency / rate)) if frequency < 2.0 * rate else frequency
    off, short = float(np.min(np.abs(lines - seen))), lines[0] * span < 6.0 and 0.3 < frequency * span < 2.0
    if np.ptp(values) == 0.0 or short or off <= max(NEAR * frequency, RESOLVED / span):
        return None
    if off * span < UNRESOLVED and scatter(times, values, float(lines[0])).min() > ALIKE * values.std():
        return None
    for at in lines.tolist():
        for factor, words in MISREAD.items():
            part = frequency / (factor * at) - 1.0
            if abs(part) < (0.01 if words else 0.15):
                how = words or f"off by {100.0 * part:+.3g} %"
                return at, f"the given drive of {frequency:.6g} Hz is {how}: the record's is f = {at:.6g} Hz"
    at = float(lines[0])
    return at, f"the strongest line is at {at:.6g} Hz, none at the given {frequency:.6g} Hz"


def off_neighbours(times: Array, values: Array) -> tuple[Array, float]:
    """How far rows are off both parabolas beside them, over the noise, and the noise [m], by the median."""
    t, x = ([one[i : one.size - 3 + i] for i in range(4)] for one in (times, values))
    weights = 1.0 / np.array([np.prod([a - b for b in t if b is not a], axis=0) for a in t])
    third = np.sum(weights * x, axis=0) / np.linalg.norm(weights, axis=0)  # divided difference, as a reading
    noise = max(1.4826 * float(np.median(np.abs(third))), 1e-4 * float(np.ptp(values)))
    before, after = np.append(np.zeros(3), third), np.append(-third, np.zeros(3))
    return np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0) / noise, noise


def poor_rows(times: Array, values: Array, off: Array, frequency: float, order: int = 0) -> list[str]:
    """Saturation, by extreme readings, and outliers: rows `off` at more than one phase, unlike impacts."""
    readings, counts = np.unique(values, return_counts=True)
    stuck = [end for end, step in ((0, 1), (-1, -1)) if counts[end] > STICKING * (counts[end + step] + 0.5)]
    where = [f"{in_unit(readings[end], SI[order])} in {counts[end]} of {values.size} rows" for end in stuck]
    found = [f"readings stick at {one}: the sensor or the recorder saturates" for one in where]
    rows, phase = np.flatnonzero(off > STRAY), np.exp(2j * math.pi * frequency * times[off > 0.5 * STRAY])
    if order < 2 and (0 < rows.size < 3 or (rows.size and abs(phase.mean()) < 0.8)):  # contacts are pulses
        place = f"the first in row {rows[0] + 1} at {times[rows[0]]:.4g} s"
        first = f"{place}: more than {STRAY:g} standard deviations off"
        found.append(f"{rows.size} of {times.size} rows are outliers, {first}")
    return found


def defects(times: Array, values: Array, frequency: float | None, order: int = 0) -> list[str]:
    """What the record alone shows, with the drive `frequency` [Hz] if it is given; empty if it is sound."""
    if np.ptp(values) == 0.0:
        return ["the record is constant"]
    rows, span, line = times.size, float(times[-1] - times[0]), float(peaks(times, values, order)[0][0])
    other = drive_found(times, values, frequency, order) if frequency else None
    cycles = (other[0] if other else frequency or line) * span * rows / (rows - 1)
    sampled = f"{rows / cycles:.2g} rows a drive period: the sampling ({(rows - 1) / span:.3g} Hz)"
    size = np.array([part.std() for part in np.array_split(values, max(1, min(8, int(line * span))))])
    fall = size[0] / max(size[-1], 1e-300)  # below 2 for a settled motion
    decays = size.size > 3 and (fall > 20.0 or (fall > 3.0 and bool(np.all(np.diff(size) < 0.0))))
    sentences = {
        f"the record has {rows} rows of {cycles:.2g} drive periods; it must have at least 3": cycles < 2.99,
        f"there are {sampled} is too slow: aliasing": rows < 2.0 * cycles,
        f"the record is a free decay: no line of it lasts, it falls to 1/{min(fall, 9999.0):.0f}": decays,
    }
    found = [sentence for sentence, true in sentences.items() if true]
    return found + poor_rows(times, values, off_neighbours(times, values)[0], line, order)


def sound(record: Record, oscillator: ImpactOscillator) -> tuple[Record, ImpactOscillator]:
    """The rows of a displacement that are fitted, and the oscillator at the drive that they show.

    NoAnswer is raised for defects, InvalidValue for a drive of another record; `notes` say what was changed.
    """
    (times, x), given = record.rows.T, record.frequency
    if faults := defects(times, x, given, record.order):
        raise NoAnswer("; ".join(faults))
    if given and (other := drive_found(times, x, given, record.order)):
        if abs(given / other[0] - 1.0) > OFF:
            raise InvalidValue(other[1])
        record = replace(
            record, frequency=other[0], notes=(*record.notes, f"{other[1]}, where the fit begins")
        )
        oscillator = with_values(oscillator, {"frequency": other[0]})
    if (rows := times.size) > MOST:
        dense = float(rows / ((times[-1] - times[0]) * (record.frequency or oscillator.driven.frequency)))
        step = max(1, min(-(-rows // MOST), int(dense / DENSE)))
        kept = record.rows[::step][:MOST]
        note = f"1 row in {step} of {rows} is fitted, up to {kept[-1, 0]:.6g} s: {len(kept)} rows"
        record = replace(record, rows=kept, notes=(*record.notes, note))
    return record, oscillator


def unit_of(found: float, given: float, what: str) -> str | None:
    """Words for the unit that either the record or the given value of `what` has by mistake."""
    base, ratio = "seconds" if "period" in what else "metres", max(found / given, given / found)
    for unit, number, factor, near, whose in RATIOS:
        if what in whose and 1.0 / near < ratio / factor < near:
            return f"a factor of {number}, so one of the two is in {unit.format(base)}"
    return (
        f"a factor of {ratio:.2g}: one of the two has a wrong unit"
        if ratio > WRONG.get(what, ratio)
        else None
    )


def require_units(record: Record, oscillator: ImpactOscillator, found: Mapping[str, float]) -> None:
    """InvalidValue if the ratio of two units is between given values and the ones `found` in the record."""
    for name in ("amplitude" if record.amplitude else "gap", "free_period"):
        known, where = parameters_of(oscillator)[name], "as given" if name == "amplitude" else "in the scene"
        if name in found and (words := unit_of(found[name], known.value, name)):
            both = f"{found[name]:.4g} {known.unit} by the record and {known.value:.4g} {known.unit} {where}"
            raise InvalidValue(f"{name} is {both}: {words}")


def require_strobe_units(record: Record, oscillator: ImpactOscillator) -> None:
    """InvalidValue if strobe points are far beyond the stop, or the amplitude is far from grazing."""
    farthest, gap = float(np.abs(record.observed[:, 0]).max()), oscillator.stop.gap
    if farthest > BEYOND * gap:
        unit = "millimetres: divide by 1000" if farthest < 3e4 * gap else "micrometres: divide by 1e6"
        both = f"x_m reaches {farthest:.4g} m, where the gap is {gap:.4g} m"
        raise InvalidValue(f"{both}: the record looks like {unit}")
    given, least = record.amplitude or 0.0, oscillator.grazing_amplitude()
    if given > APART * least or 0.0 < given < least / APART:
        both = f"the given amplitude is {given:.4g} m, but the tip meets the stop from {least:.4g} m on"
        raise InvalidValue(f"{both}: --drive takes Hz and mm")
