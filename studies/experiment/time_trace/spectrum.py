"""Lines of a periodic signal and its peaks.

A signal of period P, sampled over a whole number of periods, is a sum of lines at the multiples of 1/P,

    x(t) = a_0 + sum_j a_j cos(2 pi j t / P + phase_j),

and the discrete Fourier transform gives a_j without leakage and without a window.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

CLEAR, LOUD = 1e-3, 1e-7
"""Least part of the largest line at which a peak away from the modes, and one at a mode, is told."""

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A line higher than its neighbours [m or rad], and the mode (from 1) it belongs to."""

    frequency_hz: float
    amplitude: float
    mode: int | None


def lines_of(signal: Array, duration: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes, in the unit of the signal, of its lines.

    `signal`, shape (n_samples,), lies at equal steps over a whole number of periods that last `duration` [s],
    the last step before the end left out.
    """
    amplitude = np.abs(np.fft.rfft(signal) / signal.size)
    amplitude[1 : (signal.size + 1) // 2] *= 2.0
    return np.arange(amplitude.size) / duration, amplitude


def peaks_of(frequency: Array, amplitude: Array, modes_hz: Array, width: float) -> list[Peak]:
    """The strongest peak at each mode, within `width` [Hz], and all others that are loud; by rising
    frequency.

    A peak is a line that is higher than both its neighbours, the constant part left out.
    """
    padded = np.concatenate([[0.0], amplitude[1:], [0.0]])
    places, _ = find_peaks(padded, height=LOUD * float(amplitude[1:].max()))
    modes: dict[int, int] = {}
    for number, at in enumerate(modes_hz, start=1):
        near = [int(i) for i in places if abs(frequency[i] - at) <= width]
        if near:
            modes.setdefault(max(near, key=lambda i: float(amplitude[i])), number)
    loud = CLEAR * float(amplitude[1:].max())
    return [
        Peak(frequency_hz=float(frequency[i]), amplitude=float(amplitude[i]), mode=modes.get(int(i)))
        for i in places
        if int(i) in modes or amplitude[i] >= loud
    ]
