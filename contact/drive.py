"""Harmonic motion of the base that carries the spring and the stop.

    z(t) = Z sin(2 pi f t)

with amplitude Z [m] and frequency f [Hz]; strobes at t_n = n/f (letter 1996, Fig. 2).
"""

import math

import numpy as np

from beam.parameters import final, record, require_array, require_within


@final
@record(eq=True)
class HarmonicDrive:
    """Harmonic motion of the base, ``amplitude * sin(2 pi frequency t)``.

    Parameters
    ----------
    frequency : float
        Drive frequency, above zero [Hz].
    amplitude : float
        Amplitude of the base displacement, zero or more [m].

    Raises
    ------
    ValueError
        If the frequency is not above zero, the amplitude is negative, or one of them is not finite.
    TypeError
        If one of them is no number.

    See Also
    --------
    ImpactOscillator : A spring on a moving base, with stops.
    ImpactOscillator.with_excess : The same oscillator with an amplitude relative to grazing.

    Examples
    --------
    The period, and the base displacement at time zero and a quarter of a period later:

    >>> from contact import HarmonicDrive
    >>> drive = HarmonicDrive(frequency=22.2, amplitude=1.5e-3)
    >>> print(f"{1e3 * drive.period:.2f} ms")
    45.05 ms
    >>> print(1e3 * drive.displacement([0.0, 0.25 * drive.period]).round(6), "mm")
    [0.  1.5] mm
    """

    frequency: float
    amplitude: float = 0.0

    def __post_init__(self) -> None:
        require_within("frequency of the drive", self.frequency, "Hz", above=0)
        require_within("amplitude of the drive", self.amplitude, "m", low=0)

    @property
    def angular_frequency(self) -> float:
        """Angular frequency 2 pi f [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @property
    def period(self) -> float:
        """Drive period 1/f [s]."""
        return 1.0 / self.frequency

    def components(self, time: float) -> np.ndarray:
        """Return (S, C) = amplitude (sin, cos)(2 pi f time) at a `time` [s], shape (2,) [m]."""
        angle = self.angular_frequency * time
        return self.amplitude * np.array([math.sin(angle), math.cos(angle)])

    def displacement(self, time: float | np.ndarray) -> np.ndarray:
        """Return the base displacement [m] at `time` [s], with the shape of `time`."""
        times = require_array("time", time, "s", words="a time or an array of times")
        return self.amplitude * np.sin(self.angular_frequency * times)
