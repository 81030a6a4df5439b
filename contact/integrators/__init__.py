"""Methods for the motion with contacts, one a file; ``INTEGRATORS`` lists them by name.

The exact methods take no step: ``EventDriven``, ``PiecewiseLinear``, ``ContactSeries``.  The others are made
with one, e.g. ``CentralDifference(step=1e-6)``.
"""

from contact.integrators.central_difference import CentralDifference
from contact.integrators.contact_series import ContactSeries
from contact.integrators.event_driven import EventDriven
from contact.integrators.method import Integrator, Run
from contact.integrators.piecewise_linear import PiecewiseLinear

__all__ = [
    "INTEGRATORS",
    "CentralDifference",
    "ContactSeries",
    "EventDriven",
    "Integrator",
    "PiecewiseLinear",
    "Run",
    "method_for",
]

INTEGRATORS: dict[str, type[Integrator]] = {
    method.name: method for method in (EventDriven, PiecewiseLinear, ContactSeries, CentralDifference)
}
"""Every method of the package by its name."""

_EXACT = (EventDriven(), PiecewiseLinear(), ContactSeries())


def method_for(law: int) -> Integrator:
    """The exact method of the contact law with code `law`."""
    return next(method for method in _EXACT if method.accepts(law))
