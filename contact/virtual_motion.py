"""The motion as the single-mode description continues it: the wall ignored, only mode 1 free.

    y(t) = x_s(t) + phi_1 u_1(t) - gap,

the steady forced tip motion x_s and the free deviation u_1 of mode 1 (``contact.collision``).
"""

from __future__ import annotations

import math

import numpy as np

from contact.flight.modal_flow import steady_motion
from contact.flight.motion import Motion
from contact.flight.tip_search import tip_at

__all__ = ["VirtualMotion", "deviations"]

SAMPLES = 96
"""Samples per drive period in which the peaks and minima of a virtual motion are bracketed: it moves at
the drive frequency and that of mode 1, which is of the same order, so a bracket holds one extremum."""

NEAR = 0.6
"""Drive periods within which the hump of a virtual motion belongs to a collision."""


class VirtualMotion:
    """The one through the mode-1 deviation (u, v) at `clock` after a strobe; times s count from there.

    `motion` has the first mode only.
    """

    def __init__(self, motion: Motion, clock: float, u: float, v: float) -> None:
        self.motion, self.clock = motion, clock
        self.u, self.v = np.array([u]), np.array([v])

    def at(self, s: float) -> tuple[float, float, float]:
        """Height over the gap [m], velocity and acceleration."""
        found: tuple[float, float, float] = tip_at(self.motion, self.clock, self.u, self.v, s)
        return found

    def root(self, order: int, low: float, high: float) -> float:
        """A root of height (0) or velocity (1) in [low, high], to rounding: it may lie at zero, the touch."""
        from scipy.optimize import brentq  # slow to import

        return float(brentq(lambda s: self.at(s)[order], low, high, xtol=1e-18, rtol=8.9e-16, maxiter=300))

    def extrema(self, low: float, high: float, sign: float) -> list[float]:
        """Times in [low, high] where the velocity goes through zero from `sign` to -`sign`."""
        count = max(2, math.ceil(SAMPLES * (high - low) / self.motion.period))
        grid = np.linspace(low, high, count + 1)
        speed = np.array([sign * self.at(s)[1] for s in grid])
        turns = np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))
        return [self.root(1, grid[i], grid[i + 1]) for i in turns]

    def peak_near(self, s: float) -> float:
        """The peak next to `s`, NaN if there is none within most of a period."""
        peaks = self.extrema(s - NEAR * self.motion.period, s + NEAR * self.motion.period, 1.0)
        return min(peaks, key=lambda peak: abs(peak - s), default=math.nan)

    def crossing(self, peak: float, direction: float) -> float:
        """The crossing of the gap next to `peak` on its rising (-1) or falling (+1) side, NaN if none [s]."""
        if self.at(peak)[0] <= 0.0:
            return peak
        step = self.motion.period / SAMPLES
        near, far = peak, peak + direction * step
        for _ in range(SAMPLES):
            if self.at(far)[0] < 0.0:
                return self.root(0, min(near, far), max(near, far))
            near, far = far, far + direction * step
        return math.nan


def deviations(motion: Motion, time: float, q: np.ndarray, q_rate: np.ndarray) -> np.ndarray:
    """Deviations (u, v) of the modal state (q, q') from the steady motion at a time, shape (2, n_modes)."""
    return np.array([q, q_rate]) - steady_motion(motion, math.fmod(time, motion.period))
