"""Methods for the motion with contacts; ``INTEGRATORS`` lists them by name.

``Exact`` has no fixed time step.  Its other names are "event-driven" (impact laws), "piecewise-linear"
(linear contact) and "contact-series" (Hertz's law).  ``SampledFlight`` looks for touches at samples only, as
the letter did (1996, note [11]); otherwise it is exact.  The others are made with a step, as in
``CentralDifference(step=1e-6)``, and refuse a step beyond their limit of stability.

`method`, `fixed_step`, `grid`   what all methods share; the methods with a step; their grid of steps
`exact`                          ``Exact`` and ``SampledFlight``
`central_difference`             explicit, for contact forces
`generalised_alpha`              implicit, with numerical damping at high frequencies
`moreau_jean`                    for impact laws, by percussions
`nonsmooth_generalised_alpha`    generalised-alpha with percussions
`splitting`, `splitting_step`    exact flights and contact forces in turn

How to add a method with a time step
    1. Its file here: a child of ``fixed_step.FixedStep`` with its equations, its limit of stability
       (`critical_stiffness`) and its loop over the steps (`time_loop`).  The loop ends each step with
       ``grid.end_contact_step``, which finds touches and releases on a cubic and writes them down.
       ``central_difference`` is the shortest example.  A method with an interpolation of its own, or with
       percussions, gets another end of the step from ``grid.make_end_step``.
    2. Its class in `STEPPED` below.
    3. A test of its order.  ``tests/contact/test_integrators.py`` holds every method of the table to the
       common contract.
"""

from contact.engine.plan import Plan
from contact.integrators.central_difference import CentralDifference
from contact.integrators.exact import EXACT_NAMES, Exact, SampledFlight
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.method import Integrator
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.integrators.splitting import Splitting

STEPPED = (Splitting, CentralDifference, GeneralisedAlpha, MoreauJean, NonsmoothGeneralisedAlpha)

INTEGRATORS: dict[str, type[Integrator]] = {
    **dict.fromkeys(EXACT_NAMES.values(), Exact),
    **{method.name: method for method in (Exact, SampledFlight, *STEPPED)},
}
"""Every method of the package by its name."""

__all__ = ["INTEGRATORS", "Integrator", "Plan"]
__all__ += sorted({kind.__name__ for kind in INTEGRATORS.values()})
