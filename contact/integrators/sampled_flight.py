"""The scheme of the letter: exact flights, crossings looked for at a few instants of each drive period.

"An efficient numerical scheme for solving Eq. (1) in the presence of grazing impacts uses the analytical
solutions for the motion between impacts" (letter 1996, note [11]): positions at t_1, ..., t_k of each drive
period and at the turning points that their velocities betray.  Everything but the search is that of the exact
methods, so that the motion is exact to rounding as long as no crossing is missed.  One is missed when the tip
turns twice between two samples and is off the stop at both; with one mode few samples do, with the ringing of
N modes k has to follow the highest of them (``contact.flight.sampled_crossing``), and nothing tells when
it was too small.  ``Exact`` proves that it misses none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from beam.parameters import require_whole
from contact.engine.start import exact_trajectory
from contact.integrators.exact import Exact
from contact.integrators.method import Integrator
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

MOST_POINTS = 10**9
"""Samples per drive period: some minutes for each."""


@dataclass(frozen=True, kw_only=True)
class SampledFlight(Integrator):
    """Exact flights, crossings detected by sampling.

    Parameters
    ----------
    points : int
        Samples per drive period [1]; without a drive, per period of the lowest mode.
    """

    points: int
    name: ClassVar[str] = "sampled-flight"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = Exact.laws
    certified: ClassVar[bool] = False
    accuracy: ClassVar[float] = 1e-12

    def __post_init__(self) -> None:
        points = require_whole("points", self.points, "samples per drive period", high=MOST_POINTS)
        object.__setattr__(self, "points", points)

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`, exact to rounding if no crossing is missed."""
        return exact_trajectory(oscillator, run, search=int(self.points))
