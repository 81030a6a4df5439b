"""The virtual motion of the single-mode description: the wall ignored, only mode 1 free.

``contact.collision`` has its equation.
"""

import math

import numpy as np

from contact.flight.numbers import WEIGHT, Numbers
from contact.flight.tip_search import peaks_of_flight, tip_at

NEAR = 0.6  # drive periods within which the hump of a virtual motion belongs to a collision


class VirtualMotion:
    """The virtual motion through the mode-1 deviation (u, v) at `clock` after a strobe.

    Times s count from there; `numbers` has mode 1 only.
    """

    def __init__(self, numbers: Numbers, clock: float, u: float, v: float) -> None:
        self.numbers, self.clock = numbers, clock
        self.u, self.v = np.array([u]), np.array([v])

    def at(self, s: float) -> tuple[float, float, float]:
        """Height over the gap [m], velocity and acceleration."""
        found: tuple[float, float, float] = tip_at(self.numbers, self.clock, self.u, self.v, s)
        return found

    def extrema(self, low: float, high: float, sign: float) -> list[float]:
        """Times in [low, high] where the velocity goes through zero from `sign` to -`sign`."""
        numbers, modes = self.numbers, self.numbers.modes.copy()
        modes[WEIGHT] *= sign  # the valleys of a motion are the peaks of the motion upside down
        sine, cosine = sign * numbers.tip_sine, sign * numbers.tip_cosine
        signed = numbers._replace(modes=modes, tip_sine=sine, tip_cosine=cosine)
        return peaks_of_flight(signed, self.clock, self.u, self.v, (low, high), True).tolist()

    def peak_near(self, s: float) -> float:
        """Time of the peak next to `s`; NaN if there is none within `NEAR` periods."""
        peaks = self.extrema(s - NEAR * self.numbers.period, s + NEAR * self.numbers.period, 1.0)
        return min(peaks, key=lambda peak: abs(peak - s), default=math.nan)

    def crossing(self, peak: float, direction: float) -> float:
        """Time of the crossing of the gap next to `peak`, to rounding [s].

        `direction` is -1 for its rising and +1 for its falling side.  NaN if none lies within a drive period.
        """
        from scipy.optimize import brentq  # slow to import

        near, far = peak, peak + direction * self.numbers.period
        if self.at(peak)[0] <= 0.0:
            return peak
        for low in [*self.extrema(min(near, far), max(near, far), -1.0)[:: int(direction)], far]:
            if self.at(low)[0] < 0.0:
                tight = {"xtol": 1e-18, "rtol": 8.9e-16, "maxiter": 300}
                return float(brentq(lambda s: self.at(s)[0], near, low, **tight))
            near = low
        return math.nan
