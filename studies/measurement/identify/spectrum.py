"""Lines of a record: harmonics of an orbit, possible drive frequencies, and its repetition."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MOST_HARMONICS, LONGEST = 90, 12
"""Harmonics of an orbit and its drive periods at most."""

SAME, NEAR = 1.3, 3e-3
"""An orbit leaves at most so much of the least scatter; part by which a given drive frequency may be off."""

LINES, DRIVES, HIGH, ENOUGH = 6, 4, 0.05, 1500
"""Lines of the spectrum that give an orbit, harmonics of it that may be the drive, their least part of the
highest; rows that show whether a record repeats."""


ROUND = 1e-11
"""Part by which the diagonal of normal equations is raised: harmonics that the rows do not show are small."""


def harmonics(times: Array, values: Array, pace: float, count: int) -> tuple[Complex, float]:
    """Y_0 to Y_count of the base frequency `pace` [Hz], and the standard deviation of what they leave."""
    turn = np.exp(2j * math.pi * pace * times)
    waves = np.multiply.accumulate(np.broadcast_to(turn, (count, times.size)), axis=0)
    matrix = np.vstack([np.ones(times.size), waves.real, waves.imag])
    normal, moments = matrix @ matrix.T, matrix @ values
    normal[np.diag_indices_from(normal)] *= 1.0 + ROUND  # where rows are missing
    found = np.linalg.solve(normal, moments)  # much faster than by the matrix itself
    rest, spare = values - found @ matrix, max(times.size - found.size, 1)
    coefficients = 0.5 * (found[1 : count + 1] - 1j * found[count + 1 :])
    return np.append(found[0] + 0j, coefficients), math.sqrt(float(rest @ rest) / spare)


def count_of(times: Array, pace: float) -> int:
    """How many harmonics of `pace` [Hz] the rows resolve, within `MOST_HARMONICS`."""
    rate = (times.size - 1) / (times[-1] - times[0])
    return max(2, int(min(MOST_HARMONICS, 0.42 * rate / pace, min(times.size, ENOUGH) // 6)))


def line(times: Array, values: Array, frequency: float, near: float) -> float:
    """The strongest line of the spectrum within a part `near` of a frequency [Hz]."""
    span, off = times[-1] - times[0], (values - values.mean()) * np.hanning(times.size)

    def power(at: Array) -> Array:
        return np.abs(np.exp(-2j * math.pi * np.outer(at, times - times[0])) @ off)

    grid = np.linspace(
        frequency * (1 - near), frequency * (1 + near), max(9, int(12 * frequency * near * span))
    )
    best, step = float(grid[np.argmax(power(grid))]), float(grid[1] - grid[0])
    for _ in range(12):
        low, middle, high = power(best + step * np.array([-1.0, 0.0, 1.0]))
        bend = low - 2.0 * middle + high
        best += step * float(np.clip(0.5 * (low - high) / bend, -1.0, 1.0)) if bend < 0.0 else 0.0
        step *= 0.4
    return best


def drives(times: Array, values: Array, given: float | None) -> list[tuple[float, int]]:
    """Drive frequencies [Hz] that a record may have, each with its period m; several if none is `given`."""
    if given is not None:
        found = line(times, values, given, NEAR)
        return [(found, repetition(times, values, found))]
    rate = (times.size - 1) / (times[-1] - times[0])
    even = np.linspace(times[0], times[-1], times.size)
    spectrum = np.abs(np.fft.rfft((np.interp(even, times, values) - values.mean()) * np.hanning(times.size)))
    peaks = np.flatnonzero((spectrum[1:-1] > spectrum[:-2]) & (spectrum[1:-1] >= spectrum[2:])) + 1
    strongest = peaks[np.argsort(-spectrum[peaks])][:LINES]
    step = rate / times.size
    lines = [line(times, values, float(i) * step, 1.0 / i) for i in strongest if i > 1]
    rows = sample(times)
    paces = [one / m for one in lines for m in range(1, LONGEST // 2 + 1)]
    scatter = [harmonics(times[rows], values[rows], pace, count_of(times, pace))[1] for pace in paces]
    base = max(pace for pace, size in zip(paces, scatter, strict=True) if size < SAME * min(scatter))
    heights = np.abs(harmonics(times, values, base, min(LONGEST, count_of(times, base)))[0][1:])
    likely = [int(m) + 1 for m in np.argsort(-heights)[:DRIVES] if heights[m] > HIGH * heights.max()]
    return [(line(times, values, m * base, 0.5 / (m * base * (times[-1] - times[0]))), m) for m in likely]


def sample(times: Array) -> NDArray[np.int64]:
    """Rows at random that show whether a record repeats; equal steps would hide some of its waves."""
    random = np.random.default_rng(0)
    return np.sort(random.choice(times.size, min(times.size, ENOUGH), replace=False))


def repetition(times: Array, values: Array, frequency: float) -> int:
    """Drive periods after which a record repeats."""
    most, rows = max(1, min(LONGEST, int((times[-1] - times[0]) * frequency / 1.5))), sample(times)
    paces = [frequency / m for m in range(1, most + 1)]
    scatter = [harmonics(times[rows], values[rows], pace, count_of(times, pace))[1] for pace in paces]
    return int(np.argmax(np.array(scatter) < SAME * min(scatter))) + 1
