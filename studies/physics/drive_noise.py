"""Noise of the drive amplitude, and which period the impacts of a noisy motion show.

In drive period n the amplitude is (1 + x)(1 + e_n) times that at grazing, x the excess that is set.  e_n is
Gaussian and stationary.  It is white, or a drift of correlation time t_c with the memory exp(-1/(f t_c)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.shell.options import Within

SMALL, TIMES = Within(0, 0.02, open=True), Within(0, 1e9, "s")
"""Of noise and of the step of a scan; of the correlation time of a drift."""

DRIFTS = (0.0, 100.0, 3600.0)  # correlation times that are looked at [s], 0 for white noise

QUIET = 64
"""Drive periods without impact beyond which the motion counts as p_1: longer than any period that counts."""

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class DriveNoise:
    """Noise of the drive amplitude.

    Parameters
    ----------
    stability : float
        Standard deviation of the amplitude over itself [1].
    correlation_s : float
        Correlation time of the drift [s]; 0 for white noise.
    """

    stability: float
    correlation_s: float = 0.0

    @property
    def name(self) -> str:
        """The kind of noise, for a table."""
        return f"drift of {self.correlation_s:g} s" if self.correlation_s else "white"

    def memory(self, frequency_hz: float) -> float:
        """Correlation of the noise in neighbouring drive periods."""
        return math.exp(-1.0 / (frequency_hz * self.correlation_s)) if self.correlation_s else 0.0

    def drift(self, frequency_hz: float, dice: np.random.Generator) -> Drift:
        """The noise of one run."""
        return Drift(self.stability, self.memory(frequency_hz), dice)


class Drift:
    """e_n of one run, piece by piece, of standard deviation `deviation`."""

    def __init__(self, deviation: float, memory: float, dice: np.random.Generator) -> None:
        self.deviation, self.memory, self.dice = deviation, memory, dice
        self.last = float(dice.standard_normal())

    def next(self, count: int) -> Array:
        """The next `count` values."""
        fresh = self.dice.standard_normal(count)
        if self.memory == 0.0:
            return self.deviation * fresh
        from scipy.signal import lfilter  # slow to import

        source, memory = math.sqrt(1.0 - self.memory**2), self.memory
        found, _ = lfilter([source], [1.0, -memory], fresh, zi=[memory * self.last])
        self.last = float(found[-1])
        return np.asarray(self.deviation * found)


def watched(impacts: NDArray[np.int64], m: int) -> tuple[float, float]:
    """Share of the drive periods in which p_m is seen (p_1 for m = 0), and when it is broken first.

    The second number is the part of the periods before the first break, and 1 without one.
    """
    size, hits = impacts.size, np.flatnonzero(impacts)
    if m == 0:
        gaps = np.diff(hits, prepend=0, append=size)
        return float(gaps[gaps > QUIET].sum() / size), float(hits[0] / size) if hits.size else 1.0
    regular = np.diff(hits) == m
    kept = hits if regular.all() else hits[: int(np.argmin(regular)) + 1]
    last = int(kept[-1]) + m if kept.size else 0
    return float(m * np.count_nonzero(regular) / size), min(last / size, 1.0)
