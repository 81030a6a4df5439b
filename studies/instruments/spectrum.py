"""Amplitude spectrum of a periodic signal and its peaks.

A signal of period P, sampled N times over a whole number of periods, is a sum of lines at the multiples of 1/P,

    x(t) = a_0 + sum_j a_j cos(2 pi j t / P + phase_j),

and the discrete Fourier transform gives a_j without leakage and without a window.  Lines above half the sampling
frequency fold down; sampling fast enough is the caller's part.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.signal import find_peaks

__all__ = ["lines_of", "peaks_at_modes", "peaks_of"]

LOUD = 1e-4
"""A peak is told if it is at least this part of the largest line."""


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


def peaks_of(frequency: np.ndarray, amplitude: np.ndarray, spacing: float) -> list[dict[str, float]]:
    """Local maxima of the lines, at least `spacing` [Hz] apart and not below `LOUD` of the largest."""
    step = float(frequency[1] - frequency[0])
    padded = np.concatenate([[0.0], amplitude[1:], [0.0]])
    found, _ = find_peaks(padded, height=LOUD * float(amplitude[1:].max()), distance=max(1.0, spacing / step))
    return [{"frequency_hz": float(frequency[i]), "amplitude_m": float(amplitude[i])} for i in found]


def peaks_at_modes(peaks: Sequence[dict[str, float]], modes_hz: np.ndarray, width: float) -> list[dict[str, Any]]:
    """The peaks, each with the number of the mode (from 1) next to it within `width` [Hz], or None."""
    told = []
    for peak in peaks:
        nearest = int(np.argmin(np.abs(modes_hz - peak["frequency_hz"])))
        close = abs(modes_hz[nearest] - peak["frequency_hz"]) <= width
        told.append({**peak, "mode": nearest + 1 if close else None})
    return told
