"""Exact motion under any contact law, event by event.

Between touches every mode has a closed form (``contact.flight``), and the next touch is found by a certified
search.  An impact law acts at once, accumulating impacts are summed to the end and followed by the stay on
the stop (event-driven); a force law is followed through the contact by a power series to rounding, in time
where the force is linear (piecewise-linear), else in a variable in which it is smooth (contact series)
(``contact.touch``).  Nothing is discretised: the error is that of rounding, and there is no step that could
be too large.  Flights are those of the letter (1996), note [11], a linear stop is that of S. W. Shaw, P. J.
Holmes, J. Sound Vib. 90 (1983) 129; the search and the series are the package's own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from contact.engine.start import exact_trajectory
from contact.integrators.method import Integrator
from contact.oscillator import ImpactOscillator
from contact.touch import TOUCHES
from contact.trajectory import Run, Trajectory

EXACT_NAMES = {code: file.METHOD for code, file in TOUCHES.items()}
"""What the method is called with each law."""


@dataclass(frozen=True, kw_only=True)
class Exact(Integrator):
    """Exact motion under any contact law."""

    name: ClassVar[str] = "exact"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = tuple(TOUCHES)
    certified: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-12

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`, exact to rounding."""
        return exact_trajectory(oscillator, run)
