"""Methods for the motion with contacts, one a file; ``INTEGRATORS`` lists them by name.

``Exact`` takes no step; by name it is "event-driven", "piecewise-linear" or "contact-series" as well, as it
is known with an impact law, a linear contact and Hertz's law.  ``SampledFlight`` is exact but for the touches
that it misses (letter 1996, note [11]).  The others are made with a step, ``CentralDifference(step=1e-6)``,
and refuse one beyond their limit of stability.
"""

from contact.integrators.central_difference import CentralDifference
from contact.integrators.exact import EXACT_NAMES, Exact
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.method import Integrator
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.integrators.sampled_flight import SampledFlight
from contact.integrators.splitting import Splitting
from contact.trajectory import Run

__all__ = [
    "EXACT_NAMES",
    "INTEGRATORS",
    "CentralDifference",
    "Exact",
    "GeneralisedAlpha",
    "Integrator",
    "MoreauJean",
    "NonsmoothGeneralisedAlpha",
    "Run",
    "SampledFlight",
    "Splitting",
]

STEPPED = (Splitting, CentralDifference, GeneralisedAlpha, MoreauJean, NonsmoothGeneralisedAlpha)

INTEGRATORS: dict[str, type[Integrator]] = {
    **dict.fromkeys(EXACT_NAMES.values(), Exact),
    **{method.name: method for method in (Exact, SampledFlight, *STEPPED)},
}
"""Every method of the package by its name."""
