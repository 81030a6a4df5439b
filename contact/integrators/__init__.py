"""Methods for the motion with contacts, one a file; ``INTEGRATORS`` lists them by name.

The exact methods take no step: ``EventDriven`` for impact laws, ``PiecewiseLinear`` for a linear contact,
``ContactSeries`` for Hertz's law and Hunt and Crossley's.  ``SampledFlight`` is exact but for the touches
that it misses (letter 1996, note [11]).  The others are made with a step, ``CentralDifference(step=1e-6)``,
and refuse one beyond their limit of stability.
"""

from contact.integrators.central_difference import CentralDifference
from contact.integrators.contact_series import ContactSeries
from contact.integrators.event_driven import EventDriven
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.method import Integrator, Run
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.integrators.piecewise_linear import PiecewiseLinear
from contact.integrators.sampled_flight import SampledFlight
from contact.integrators.splitting import Splitting

__all__ = [
    "INTEGRATORS",
    "CentralDifference",
    "ContactSeries",
    "EventDriven",
    "GeneralisedAlpha",
    "Integrator",
    "MoreauJean",
    "NonsmoothGeneralisedAlpha",
    "PiecewiseLinear",
    "Run",
    "SampledFlight",
    "Splitting",
    "method_for",
]

INTEGRATORS: dict[str, type[Integrator]] = {
    method.name: method
    for method in (
        EventDriven,
        PiecewiseLinear,
        ContactSeries,
        SampledFlight,
        Splitting,
        CentralDifference,
        GeneralisedAlpha,
        MoreauJean,
        NonsmoothGeneralisedAlpha,
    )
}
"""Every method of the package by its name."""

_EXACT = (EventDriven(), PiecewiseLinear(), ContactSeries())


def method_for(law: int) -> Integrator:
    """The exact method of the contact law with code `law`."""
    return next(method for method in _EXACT if method.accepts(law))
