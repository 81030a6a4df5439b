"""Exact motion under any contact law, event by event; touches are proved, or looked for by sampling.

Between touches every mode has a closed form (``contact.flight``), as in the letter (1996), note [11].  An
impact law acts at once; a force law is followed through the contact by a power series (``contact.touch``).
Nothing is discretised: the error is rounding, and no step can be too large.  The two methods of this
file differ only in the search for the next touch.

`Exact` proves that it misses none, by a search of the package (``contact.flight.crossing``).

`SampledFlight` is the scheme of that note: "An efficient numerical scheme for solving Eq. (1) in the presence
of grazing impacts uses the analytical solutions for the motion between impacts".  It samples the tip at k
instants of each drive period (``contact.flight.sampled_crossing``).  One mode needs few samples.  With N
modes k has to follow the ringing of the highest, and nothing shows that it was too small.
"""

import math
from typing import ClassVar

from beam.parameters import record, require_whole
from contact.engine.plan import Plan
from contact.engine.start import exact_trajectory
from contact.flight.sampled_crossing import samples_of
from contact.integrators.method import Integrator
from contact.oscillator import ImpactOscillator
from contact.touch import LAWS
from contact.trajectory import Trajectory

EXACT_NAMES = {code: file.METHOD for code, file in LAWS.items()}  # names of the exact method with each law
MOST_POINTS = 10**9  # largest number of samples per drive period, which take some minutes


@record(eq=True)
class Exact(Integrator):
    """Exact motion under any contact law, event by event; it has no fixed time step."""

    name: ClassVar[str] = "exact"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = tuple(LAWS)
    certified: ClassVar[bool] = True
    accuracy: ClassVar[float] = 1e-12

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """The motion of `plan`, exact to rounding."""
        return exact_trajectory(oscillator, plan)


@record(eq=True)
class SampledFlight(Integrator):
    """Exact flights, with crossings detected by sampling.

    A touch between two samples can be missed.

    Parameters
    ----------
    points : int
        Number of samples per drive period, one or more; without a drive, per period of the lowest mode.

    Raises
    ------
    ValueError
        If `points` is no whole number from 1 to 10^9.
    TypeError
        If `points` is no number.
    """

    points: int
    name: ClassVar[str] = "sampled-flight"
    order: ClassVar[float] = math.inf
    laws: ClassVar[tuple[int, ...]] = Exact.laws
    accuracy: ClassVar[float] = Exact.accuracy

    def __post_init__(self) -> None:
        points = require_whole("points", self.points, "samples per drive period", high=MOST_POINTS)
        object.__setattr__(self, "points", points)

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """The motion of `plan`, exact to rounding if no crossing is missed."""
        return exact_trajectory(oscillator, plan, samples_of(oscillator.numbers(), self.points))
