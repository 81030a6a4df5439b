"""Times as a stretch and a clock.

A *stretch* goes from one strobe to the next and is numbered by the strobe that begins it.  The *clock* is the
time since that strobe [s].  A million drive periods then cost no digits of the phase of the drive.
"""

import numpy as np

from contact.flight.elementary import EPS


def split_time(time: float | np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """The stretch and the clock of times [s], for a drive `period` [s]: two arrays of their shape."""
    stretch = np.floor(time / period)
    clock = time - stretch * period
    # a time within rounding of a strobe belongs to that strobe
    late = clock > period * (1 - 4 * EPS * np.maximum(stretch, 1))
    stretch, clock = np.where(late, stretch + 1, stretch), np.where(late, 0.0, np.maximum(clock, 0.0))
    clock = np.where(clock <= 4 * EPS * stretch * period, 0.0, clock)
    return stretch.astype(np.int64), clock
