"""Lines of a record: harmonics of an orbit, possible drive frequencies, and its repetition."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft
from scipy.signal import detrend, find_peaks

from studies.measurement.identify.record.records import Array, Record

Complex = NDArray[np.complex128]

MOST_HARMONICS, LONGEST = 90, 12  # harmonics of an orbit and its drive periods at most
SAME, JUMPS = 1.3, 2.0  # an orbit leaves at most so much of the least scatter; of a velocity, which jumps
NEAR = 3e-3  # part by which a given drive frequency may be off
LINES, DRIVES = 6, 4  # lines of the spectrum that give an orbit; harmonics of it that may be the drive
HIGH = 0.05  # least part of the highest harmonic that one of the drive has
ENOUGH = 1500  # rows that show whether a record repeats
ROUND = 1e-11  # relative addition to the diagonal of normal equations: unseen harmonics are small


def peaks(times: Array, values: Array, order: int = 0) -> tuple[Array, Array]:
    """Frequencies [Hz] of the lines of a record, the strongest first, and their heights over its height, as a
    displacement has them: the record is its derivative of this order."""
    rows, span = times.size, float(times[-1] - times[0])
    even = detrend(np.interp(np.linspace(times[0], times[-1], rows), times, values))
    size = next_fast_len(8 * rows, real=True)
    height = np.log(np.abs(rfft(even * np.hanning(rows), size)) + 1e-300)
    first = int(1.5 * size / rows)  # below it are the mean and a drift
    tops = find_peaks(height[first:])[0]
    at = first + (tops if tops.size else np.zeros(1, int))
    low, middle, high = (height[at + way] for way in (-1, 0, 1))
    moved = 0.5 * (low - high) / np.minimum(low - 2.0 * middle + high, -1e-9)
    lines = (at + np.clip(moved, -1.0, 1.0)) * (rows - 1) / (span * size)
    size_of = middle - order * np.log(lines)
    found = np.argsort(-size_of)
    return lines[found], np.exp(size_of[found] - size_of[found[0]])


def harmonics(times: Array, values: Array, base: float, count: int) -> tuple[Complex, float]:
    """Y_0 to Y_count of the base frequency `base` [Hz], and the standard deviation of what they leave."""
    turn = np.exp(2j * math.pi * base * times)
    waves = np.multiply.accumulate(np.broadcast_to(turn, (count, times.size)), axis=0)
    matrix = np.vstack([np.ones(times.size), waves.real, waves.imag])
    normal, moments = matrix @ matrix.T, matrix @ values
    normal[np.diag_indices_from(normal)] *= 1.0 + ROUND  # where rows are missing
    found = np.linalg.solve(normal, moments)  # much faster than by the matrix itself
    rest, spare = values - found @ matrix, max(times.size - found.size, 1)
    coefficients = 0.5 * (found[1 : count + 1] - 1j * found[count + 1 :])
    return np.append(found[0] + 0j, coefficients), math.sqrt(float(rest @ rest) / spare)


def count_of(times: Array, base: float) -> int:
    """How many harmonics of `base` [Hz] the rows resolve, within `MOST_HARMONICS`."""
    rate = (times.size - 1) / (times[-1] - times[0])
    return max(2, int(min(MOST_HARMONICS, 0.42 * rate / base, min(times.size, ENOUGH) // 6)))


def orbit_of(times: Array, values: Array, base: float, most: int = ENOUGH) -> tuple[Complex, float]:
    """Lines of an orbit that repeats with `base` [Hz], as far as rows resolve, and what they leave [m]; of so
    many rows at most, at random: equal steps hide some lines."""
    rows = np.sort(np.random.default_rng(0).permutation(times.size)[:most])
    return harmonics(times[rows], values[rows], base, count_of(times, base))


def scatter(times: Array, values: Array, frequency: float) -> Array:
    """What orbits of 1, 2, ... drive periods leave of a record [m], up to 12, if it has 1.5 of them."""
    most = max(1, min(LONGEST, int((times[-1] - times[0]) * frequency / 1.5)))
    return np.array([orbit_of(times, values, frequency / m)[1] for m in range(1, most + 1)])


def repetition(times: Array, values: Array, frequency: float, same: float = SAME) -> int:
    """Drive periods after which a record repeats, or nearly so."""
    left = scatter(times, values, frequency)
    return int(np.argmax(left < same * left.min())) + 1


def drives(record: Record) -> list[tuple[float, int]]:
    """Drive frequencies [Hz] that a motion may have, each with its period m; several if none is known."""
    (times, values), same = record.rows.T, JUMPS if record.order == 1 else SAME
    lines, given = peaks(times, values, record.order)[0], record.frequency

    def nearest(frequency: float) -> float:
        return float(lines[np.argmin(np.abs(lines - frequency))])

    if given is not None:
        near = nearest(given)
        found = near if abs(near / given - 1.0) < NEAR else given
        return [(found, repetition(times, values, found, same))]
    tried = [one / m for one in lines[:LINES].tolist() for m in range(1, LONGEST // 2 + 1)]
    left = np.array([orbit_of(times, values, base)[1] for base in tried])
    base = max(one for one, size in zip(tried, left, strict=True) if size < same * left.min())
    heights = np.abs(harmonics(times, values, base, min(LONGEST, count_of(times, base)))[0][1:])
    likely = [int(m) + 1 for m in np.argsort(-heights)[:DRIVES] if heights[m] > HIGH * heights.max()]
    return [(nearest(m * base), m) for m in likely]
