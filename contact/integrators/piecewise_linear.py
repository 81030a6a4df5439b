"""Exact motion of a spring that meets a linear stop.

Off the stop the modes are uncoupled and have closed forms; in contact, the system is linear as well, and its
matrix exponential is summed as a power series to rounding (``contact.linear_lanes``). The instants between
the two are roots certified by bounds. The error is that of rounding, and there is no step that could be too
large.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact.integrators.exact_run import exact_trajectory
from contact.integrators.method import Integrator, Run
from contact.laws import LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory

__all__ = ["PiecewiseLinear"]


@dataclass(frozen=True, kw_only=True)
class PiecewiseLinear(Integrator):
    """Exact motion of a spring that meets a linear stop."""

    name: ClassVar[str] = "piecewise-linear"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = (LINEAR,)
    certified: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-12
    limit: ClassVar[str] = "none"
    source: ClassVar[str] = (
        "S. W. Shaw, P. J. Holmes, J. Sound Vib. 90 (1983) 129, for one mode; the series is the package's own"
    )

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`, exact to rounding."""
        return exact_trajectory(oscillator, run)
