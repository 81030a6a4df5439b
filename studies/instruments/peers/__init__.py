"""Outside solvers behind the interface of the package's own methods, to be compared with them.

    ScipyMethod(solver="DOP853", tolerance=1e-10)    SciPy's solve_ivp: RK45, DOP853, Radau, LSODA
    HeyokaTaylor(tolerance=1e-12)                    heyoka: adaptive Taylor series, compiled
    SundialsCvode(tolerance=1e-10, family="Adams")   SUNDIALS CVODE: BDF or Adams

Each integrates the modal equations (``equations``) from one touch or release to the next, which its own root
finding has to notice, and is started anew there (``pieces``).  Nothing is shared with the exact methods but
the parameters.  heyoka and scikit-sundae are optional; they are imported when a solver is made.

The SciPy and SUNDIALS wrappers call the right-hand side from Python, compiled; heyoka compiles it into its
steps.  Of Runge-Kutta codes compiled as a whole, numbalsoda's DOP853 has no events and is left out for that;
numbakit-ode has not been tried.
"""

from __future__ import annotations

from importlib.util import find_spec

from contact.integrators.method import Integrator
from studies.instruments.peers.heyoka_taylor import HeyokaTaylor
from studies.instruments.peers.scipy_method import SOLVERS, ScipyMethod
from studies.instruments.peers.sundials_cvode import FAMILIES, SundialsCvode

__all__ = ["PEERS", "HeyokaTaylor", "ScipyMethod", "SundialsCvode", "available", "lineup"]

PEERS: dict[str, type[ScipyMethod] | type[HeyokaTaylor] | type[SundialsCvode]] = {
    peer.name: peer for peer in (ScipyMethod, HeyokaTaylor, SundialsCvode)
}
"""The wrapper of each library by its name; all are made with ``tolerance=``."""


def available() -> tuple[str, ...]:
    """Names in `PEERS` whose library is installed; nothing is imported to find out."""
    return tuple(name for name, peer in PEERS.items() if find_spec(peer.library) is not None)


def lineup(tolerance: float) -> dict[str, Integrator]:
    """Every solver of the libraries installed, at one `tolerance`, by its label."""
    installed = available()
    every: list[ScipyMethod | HeyokaTaylor | SundialsCvode] = []
    if "scipy" in installed:
        every += [ScipyMethod(solver=solver, tolerance=tolerance) for solver in SOLVERS]
    if "heyoka" in installed:
        every += [HeyokaTaylor(tolerance=tolerance)]
    if "sundials" in installed:
        every += [SundialsCvode(tolerance=tolerance, family=family) for family in FAMILIES]
    return {peer.label: peer for peer in every}
