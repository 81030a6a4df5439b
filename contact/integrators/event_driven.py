"""Exact event-driven motion under an impact law.

Between impacts every mode has a closed form (``contact.flight``), the next touch is found by a certified
search (``contact.crossing``), and the impact acts at once (``contact.newton``); accumulating impacts are
summed to the end and followed by the stay on the stop. Nothing is discretised: the error is that of rounding,
and there is no step that could be too large.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact.integrators.exact_run import exact_trajectory
from contact.integrators.method import Integrator, Run
from contact.laws import DELAYED, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory

__all__ = ["EventDriven"]


@dataclass(frozen=True, kw_only=True)
class EventDriven(Integrator):
    """Exact event-driven motion under an impact law."""

    name: ClassVar[str] = "event-driven"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = (NEWTON, DELAYED)
    certified: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-12
    limit: ClassVar[str] = "none"
    source: ClassVar[str] = (
        "flights in closed form as in the letter (1996), note [11]; the search is the package's own"
    )

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`, exact to rounding."""
        return exact_trajectory(oscillator, run)
