"""Amplitude spectrum of a periodic signal and its peaks.

A signal of period P, sampled over a whole number of periods, is a sum of lines at the multiples of 1/P,

    x(t) = a_0 + sum_j a_j cos(2 pi j t / P + phase_j),

and the discrete Fourier transform gives a_j without leakage and without a window.  Lines above half the
sampling frequency fold down; sampling fast enough is the caller's part.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.signal import find_peaks

__all__ = ["lines_of", "peaks_of"]

CLEAR, LOUD = 1e-3, 1e-7
"""Least part of the largest line at which a peak away from the modes, and one at a mode, is told."""


def lines_of(signal: np.ndarray, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and amplitudes, in the unit of the signal, of its lines.

    Parameters
    ----------
    signal : ndarray, shape (n_samples,)
        At equal steps over a whole number of periods, the last step before the end left out.
    duration : float
        Of the stretch [s].
    """
    transform = np.fft.rfft(signal) / signal.size
    amplitude = np.abs(transform)
    amplitude[1:] *= 2.0
    if signal.size % 2 == 0:
        amplitude[-1] *= 0.5
    return np.arange(amplitude.size) / duration, amplitude


def peaks_of(
    frequency: np.ndarray, amplitude: np.ndarray, modes_hz: np.ndarray, width: float
) -> list[dict[str, Any]]:
    """The strongest peak at each mode, numbered from 1, and all others that are loud; by rising frequency.

    A peak is a line that is higher than both its neighbours, the constant part left out.  At a mode means
    within `width` [Hz] of its frequency.
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
        {"frequency_hz": float(frequency[i]), "amplitude_m": float(amplitude[i]), "mode": modes.get(int(i))}
        for i in places if int(i) in modes or amplitude[i] >= loud
    ]
