"""What is wrong with a record of displacement: before a fit, and by the residuals of one.

A motion that repeats after m periods of a drive of frequency f has lines at k f/m only. Impacts make corners:
a row still agrees with the parabola through the three rows before it or after it. Noise is independent from
row to row. Times in s, readings and residuals (reading less prediction) in m, each of shape (rows,).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq
from scipy.optimize import minimize_scalar
from scipy.signal import medfilt

from studies.measurement.identify.spectrum import NEAR, count_of, orbit_of, peaks, repetition, scatter

Array = NDArray[np.float64]

STRONG, RESOLVED, UNRESOLVED = 0.3, 0.05, 0.3
"""Height of the drive's line over the strongest (settled motions: above 0.7). Part of 1/span by which other
lines move one in a record of three orbits and in a shorter one."""
STICKING, STRAY, SURE, ALIKE, MANY = 6.0, 12.0, 8.0, 0.025, 6000
"""Rows at an extreme reading over rows at the next (turning point: 2.4, flat: 5.3). Standard deviations of an
outlier (corners: 8), of an estimate that is no chance. Part that an orbit leaves (noise of 1 %: 0.016); rows
by which a filter is seen."""
MISREAD = {1.0: "", 1e-3: "in kHz", 2.0 * math.pi: "in rad/s", 60.0: "in 1/min", 2.0: "2 f", 0.5: "f/2"}
MISREAD[1e3] = "right if time_s is in ms: divide it by 1e3"
MISREAD[1e6] = "right if time_s is in µs: divide it by 1e6"
"""What a given drive may be, by its ratio to that of the record."""


def drive_found(times: Array, values: Array, frequency: float) -> tuple[float, str] | None:
    """The drive by the record [Hz] and a sentence, if the given `frequency` is not that of a strong line."""
    lines, heights = peaks(times, values)
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


def poor_rows(times: Array, values: Array, off: Array, frequency: float) -> list[str]:
    """Saturation, by extreme readings, and outliers: rows `off` at more than one phase, unlike impacts."""
    readings, counts = np.unique(values, return_counts=True)
    stuck = [end for end, step in ((0, 1), (-1, -1)) if counts[end] > STICKING * (counts[end + step] + 0.5)]
    where = [f"{1e3 * readings[end]:.4g} mm in {counts[end]} of {values.size} rows" for end in stuck]
    found = [f"readings stick at {one}: the sensor or the recorder saturates" for one in where]
    rows, phase = np.flatnonzero(off > STRAY), np.exp(2j * math.pi * frequency * times[off > 0.5 * STRAY])
    if 0 < rows.size < 3 or (rows.size and abs(phase.mean()) < 0.8):
        first = f"the first in row {rows[0] + 1} at {times[rows[0]]:.4g} s: {STRAY:g} standard deviations off"
        found.append(f"{rows.size} of {times.size} rows are outliers, {first}")
    return found


def defects(times: Array, values: Array, frequency: float | None) -> list[str]:
    """What the record alone shows, with the drive `frequency` [Hz] if it is given; empty if it is sound."""
    if np.ptp(values) == 0.0:
        return ["the record is constant"]
    rows, span, line = times.size, float(times[-1] - times[0]), float(peaks(times, values)[0][0])
    other = drive_found(times, values, frequency) if frequency else None
    cycles = (other[0] if other else frequency or line) * span * rows / (rows - 1)
    pace = f"{rows / cycles:.2g} rows a drive period: the sampling ({(rows - 1) / span:.3g} Hz) is too slow"
    size = np.array([part.std() for part in np.array_split(values, max(1, min(8, int(line * span))))])
    fall = size[0] / max(size[-1], 1e-300)  # below 2 for a settled motion
    decays = size.size > 3 and (fall > 20.0 or (fall > 3.0 and bool(np.all(np.diff(size) < 0.0))))
    sentences = {
        f"the record has {rows} rows of {cycles:.2g} drive periods; it must have at least 3": cycles < 2.99,
        f"there are {pace}: aliasing": rows < 2.0 * cycles,
        f"the record is a free decay: no line of it lasts, it falls to 1/{fall:.2g}": decays,
    }
    found = [sentence for sentence, true in sentences.items() if true]
    return found + poor_rows(times, values, off_neighbours(times, values)[0], line)


def added(times: Array, residuals: Array, pace: float, part: float = 0.0) -> list[str]:
    """A hum and a drift that last, the same in each third of a record, beside what repeats with the orbit; a
    hum that has this `part` of the variance."""
    span, rows, found = float(times[-1] - times[0]), times.size, list[str]()
    t, thirds = (times - times.mean()) / span, np.array_split(np.arange(rows), 3)
    waves = np.exp(2j * math.pi * pace * np.outer(np.arange(1, 1 + min(29, count_of(times, pace))), times))
    matrix = np.vstack([t, t**0, waves.real, waves.imag]).T
    slope, *_ = coefficients = lstsq(matrix, residuals)[0]
    rest = residuals - matrix @ coefficients
    at = float(peaks(times, rest)[0][0])
    tones = [2.0 * np.mean((rest * np.exp(-2j * math.pi * at * times))[third]) for third in thirds]
    tone, apart = np.mean(tones), abs(at - pace * max(1, round(at / pace))) * span
    lasts = apart > 1.0 and max(np.abs(tones - tone)) < 0.5 * abs(tone)
    if lasts and abs(tone) / math.sqrt(2.0) > max(SURE / math.sqrt(rows), part) * rest.std():
        found = [f"a line at {at:.4g} Hz of {1e3 * abs(tone):.2g} mm that is no harmonic of the orbit: hum"]
    slopes = [np.polyfit(t[third], (rest + slope * t)[third], 1)[0] / slope for third in thirds]
    if abs(slope) * math.sqrt(rows / 12) > SURE * rest.std() and min(slopes) > 0.5:
        found.append(f"a drift of {1e3 * slope / span:.2g} mm/s")
    return found


def walked(times: Array, values: Array, frequency: float, period: int) -> list[str]:
    """A drive that is off: the orbit of another frequency leaves less of the record."""
    span, lines = times[-1] - times[0], peaks(times, values)[0]
    near = lines[np.argmin(np.abs(lines - frequency))] + np.array([-0.1, 0.1]) / span
    best = minimize_scalar(lambda at: orbit_of(times, values, at / period)[1], bounds=near, method="bounded")
    if best.fun > 0.8 * orbit_of(times, values, frequency / period)[1]:
        return []
    walk = f"{2.0 * math.pi * abs(best.x - frequency) * span:.2g} rad"
    return [f"the phase of the drive walks by {walk}: the drive is at {best.x:.7g} Hz, not {frequency:.7g}"]


def filtered(times: Array, values: Array, predicted: Array, pace: float) -> list[str]:
    """A filter of one pole: predictions over readings, line by line, have squares 1 + (nu/corner)^2."""
    (read, noise), known = orbit_of(times, values, pace, MANY), orbit_of(times, predicted, pace, MANY)[0]
    error = noise / math.sqrt(2.0 * min(times.size, MANY))
    order = 1 + np.flatnonzero(np.abs(known[1:]) > 10.0 * error)
    if order.size < 6:
        return []
    square, nu = np.abs(known[order] / read[order]) ** 2, pace * order
    weight = 0.5 / np.hypot(error / np.abs(read[order]), 3e-4) / square
    (slope, level), spread = np.polyfit(nu**2, square, 1, w=weight, cov="unscaled")
    left, gain = np.sum((weight * (square - level - slope * nu**2)) ** 2), slope**2 / spread[0, 0]
    if min(slope, level) <= 0.0 or gain < max(SURE**2, 2.3 * left):
        return []
    return [f"lines fall below the predicted ones as by a low-pass near {math.sqrt(level / slope):.0f} Hz"]


def wanders(times: Array, values: Array, residuals: Array, frequency: float) -> list[str]:
    """Whether residuals fade or the record does not repeat: a transient or chaos."""
    parts = np.array_split(np.arange(times.size), max(1, min(8, int(frequency * (times[-1] - times[0])))))
    size = np.array([residuals[part].std() for part in parts])
    quiet = int(np.argmin(size > 3.0 * np.median(size)))
    if len(parts) > 3 and quiet > 0 and np.all(size[quiet:] < 3.0 * np.median(size)):
        return [f"the residuals fade within the first {times[parts[quiet][0]] - times[0]:.2g} s: a transient"]
    left = scatter(times, values, frequency)
    if left.min() > max(ALIKE * values.std(), 3.0 * off_neighbours(times, values)[1]):
        return [f"the record does not repeat within {left.size} drive periods"]
    return []


def contradictions(times: Array, values: Array, residuals: Array, frequency: float, period: int) -> list[str]:
    """What residuals show that are no noise; the drive is at `frequency` [Hz], a `period` 0 is unknown."""
    period = period or repetition(times, values, frequency)
    pace, bare = frequency / period, np.abs(residuals - medfilt(residuals, 5))
    off = 3.0 * off_neighbours(times, values)[0]
    stray = np.minimum(bare / (1.4826 * np.median(bare[bare > 0.0])), off)
    found = added(times, residuals, pace) + poor_rows(times, values, stray, frequency)
    found += walked(times, values, frequency, period)
    found = found or filtered(times, values, values - residuals, pace)
    found = found or wanders(times, values, residuals, frequency)
    return found or ["the model is too small for the record"]
