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
        height, velocity, acceleration = tip_at(self.motion, self.clock, self.u, self.v, s)
        return height, velocity, acceleration

    def height(self, s: float) -> float:
        """Height over the gap [m]."""
        return self.at(s)[0]

    def velocity(self, s: float) -> float:
        """Its rate [m/s]."""
        return self.at(s)[1]

    def extrema(self, low: float, high: float, sign: float) -> list[float]:
        """Times in [low, high] where the velocity goes through zero from `sign` to -`sign`."""
        count = max(2, math.ceil(SAMPLES * (high - low) / self.motion.period))
        grid = np.linspace(low, high, count + 1)
        speed = np.array([sign * self.velocity(s) for s in grid])
        turns = np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))
        return [_root(self.velocity, grid[i], grid[i + 1]) for i in turns]

    def peak_near(self, s: float) -> float:
        """The peak next to `s`, NaN if there is none within most of a period."""
        peaks = self.extrema(s - NEAR * self.motion.period, s + NEAR * self.motion.period, 1.0)
        return min(peaks, key=lambda peak: abs(peak - s), default=math.nan)

    def crossing(self, peak: float, direction: float) -> float:
        """The crossing of the gap next to `peak` on its rising (-1) or falling (+1) side, NaN if none [s]."""
        if self.height(peak) <= 0.0:
            return peak
        step = self.motion.period / SAMPLES
        near, far = peak, peak + direction * step
        for _ in range(SAMPLES):
            if self.height(far) < 0.0:
                return _root(self.height, min(near, far), max(near, far))
            near, far = far, far + direction * step
        return math.nan


def _root(function: object, low: float, high: float) -> float:
    """A root in [low, high] to rounding (times count from the touch, so that it may lie at zero)."""
    from scipy.optimize import brentq  # slow to import

    return float(brentq(function, low, high, xtol=1e-18, rtol=8.9e-16, maxiter=300))


def deviations(motion: Motion, time: float, q: np.ndarray, q_rate: np.ndarray) -> np.ndarray:
    """Deviations (u, v) of the modal state (q, q') from the steady motion at a time, shape (2, n_modes)."""
    steady = steady_motion(motion, np.array([math.fmod(time, motion.period)]))
    return np.array([q, q_rate]) - np.array(steady)[:, 0]
