"""Harmonic motion of the base that carries the spring and the stop.

    z(t) = Z sin(2 pi f t)

with amplitude Z [m] and frequency f [Hz]; strobes at t_n = n/f (letter 1996, Fig. 2).
"""

import math
from dataclasses import dataclass

import numpy as np

from beam.parameters import final, require_array, require_within


@final
@dataclass(frozen=True, kw_only=True)
class HarmonicDrive:
    """Base motion ``amplitude * sin(2 pi frequency t)``.

    Parameters
    ----------
    frequency : float
        Drive frequency, above zero [Hz].
    amplitude : float
        Amplitude of the base displacement, zero or more [m].
    """

    frequency: float
    amplitude: float = 0.0

    def __post_init__(self) -> None:
        require_within("frequency of the drive", self.frequency, "Hz", above=0)
        require_within("amplitude of the drive", self.amplitude, "m", low=0)

    @property
    def angular_frequency(self) -> float:
        """2 pi f [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @property
    def period(self) -> float:
        """1/f [s]."""
        return 1.0 / self.frequency

    def components(self, time: float) -> np.ndarray:
        """(S, C) = amplitude (sin, cos)(2 pi f time), the sine and cosine part of the drive at a time [m]."""
        angle = self.angular_frequency * time
        return self.amplitude * np.array([math.sin(angle), math.cos(angle)])

    def displacement(self, time: float | np.ndarray) -> np.ndarray:
        """Base displacement at `time` [s], same shape [m]."""
        times = require_array("time", time, "s", words="a time or an array of times")
        return self.amplitude * np.sin(self.angular_frequency * times)
