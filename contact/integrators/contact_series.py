"""Exact flights, contacts by a power series of high order.

In contact under a law with the power 3/2 the motion is not smooth where the tip touches the stop. With dt =
sqrt(d) d(sigma) all equations become polynomial, and a series of order 20 in sigma, with steps that put the
neglected terms below rounding, passes touch and release alike (``contact.hertz_lanes``). The error is that
of rounding, and there is no step that could be too large.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact.integrators.exact_run import exact_trajectory
from contact.integrators.method import Integrator, Run
from contact.laws import HERTZ
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory

__all__ = ["ContactSeries"]


@dataclass(frozen=True, kw_only=True)
class ContactSeries(Integrator):
    """Exact flights, contacts by a power series of high order."""

    name: ClassVar[str] = "contact-series"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = (HERTZ,)
    certified: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-12
    limit: ClassVar[str] = "none"
    source: ClassVar[str] = "the package's own; the substitution is Sundman's, Acta Math. 36 (1913) 105"

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`, exact to rounding."""
        return exact_trajectory(oscillator, run)
