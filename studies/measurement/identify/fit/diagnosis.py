"""What residuals show that is no noise: a hum, a drift, a filter, a wrong drive, a transient or chaos.

The lines of an orbit are at multiples of its `base` frequency [Hz]. Noise is independent from row to row.
Residuals are readings less predictions. Times in s, all others in the unit of the record, each of shape
(rows,).
"""

import math

import numpy as np
from scipy.linalg import lstsq
from scipy.optimize import minimize_scalar
from scipy.signal import medfilt

from studies.measurement.identify.record.records import SI, Array
from studies.measurement.identify.record.soundness import ALIKE, off_neighbours, poor_rows
from studies.measurement.identify.record.spectrum import count_of, orbit_of, peaks, repetition, scatter
from studies.shell.digits import in_unit

SURE = 8.0  # standard deviations of an estimate that is no chance
MANY = 6000  # rows by which a filter is seen


def added(times: Array, residuals: Array, base: float, part: float = 0.0, order: int = 0) -> list[str]:
    """A hum and a drift that last, the same in each third of a record, beside what repeats with the orbit; a
    hum that has this `part` of the variance."""
    span, rows, found = float(times[-1] - times[0]), times.size, list[str]()
    t, thirds = (times - times.mean()) / span, np.array_split(np.arange(rows), 3)
    waves = np.exp(2j * math.pi * base * np.outer(np.arange(1, 1 + min(29, count_of(times, base))), times))
    matrix = np.vstack([t, t**0, waves.real, waves.imag]).T
    slope, *_ = coefficients = lstsq(matrix, residuals)[0]
    rest = residuals - matrix @ coefficients
    at = float(peaks(times, rest)[0][0])
    tones = [2.0 * np.mean((rest * np.exp(-2j * math.pi * at * times))[third]) for third in thirds]
    tone, apart = np.mean(tones), abs(at - base * max(1, round(at / base))) * span
    lasts = apart > 1.0 and max(np.abs(tones - tone)) < 0.5 * abs(tone)
    if lasts and abs(tone) / math.sqrt(2.0) > max(SURE / math.sqrt(rows), part) * rest.std():
        size = in_unit(abs(tone), SI[order], 2)
        found = [f"a line at {at:.4g} Hz of {size} that is no harmonic of the orbit: hum"]
    slopes = [np.polyfit(t[third], (rest + slope * t)[third], 1)[0] / slope for third in thirds]
    if abs(slope) * math.sqrt(rows / 12) > SURE * rest.std() and min(slopes) > 0.5:
        found.append(f"a drift of {in_unit(slope / span, SI[order], 2)}/s")
    return found


def walked(times: Array, values: Array, frequency: float, m: int, order: int) -> list[str]:
    """A drive that is off: the orbit of another frequency leaves less of the record."""
    span, lines = times[-1] - times[0], peaks(times, values, order)[0]
    near = lines[np.argmin(np.abs(lines - frequency))] + np.array([-0.1, 0.1]) / span
    best = minimize_scalar(lambda at: orbit_of(times, values, at / m)[1], bounds=near, method="bounded")
    if best.fun > 0.8 * orbit_of(times, values, frequency / m)[1]:
        return []
    walk = f"{2.0 * math.pi * abs(best.x - frequency) * span:.2g} rad"
    return [f"the phase of the drive walks by {walk}: the drive is at {best.x:.7g} Hz, not {frequency:.7g}"]


def filtered(times: Array, values: Array, predicted: Array, base: float) -> list[str]:
    """A filter of one pole: predictions over readings, line by line, have squares 1 + (nu/corner)^2."""
    (read, noise), known = orbit_of(times, values, base, MANY), orbit_of(times, predicted, base, MANY)[0]
    error = noise / math.sqrt(2.0 * min(times.size, MANY))
    order = 1 + np.flatnonzero(np.abs(known[1:]) > 10.0 * error)
    if order.size < 6:
        return []
    square, nu = np.abs(known[order] / read[order]) ** 2, base * order
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


def contradictions(
    times: Array, values: Array, residuals: Array, frequency: float, m: int, order: int = 0
) -> list[str]:
    """What residuals show that are no noise; the drive is at `frequency` [Hz], a `period` 0 is unknown."""
    m = m or repetition(times, values, frequency)
    base, bare = frequency / m, np.abs(residuals - medfilt(residuals, 5))
    off = 3.0 * off_neighbours(times, values)[0]
    stray = np.minimum(bare / (1.4826 * np.median(bare[bare > 0.0])), off)
    found = added(times, residuals, base, order=order) + poor_rows(times, values, stray, frequency, order)
    found += walked(times, values, frequency, m, order)
    found = found or filtered(times, values, values - residuals, base)
    found = found or wanders(times, values, residuals, frequency)
    return found or ["the model is too small for the record"]
