"""Outside solvers behind the interface of the package's own methods, to be compared with them.

    ScipySolver(solver="DOP853", tolerance=1e-10)    SciPy's solve_ivp: RK45, DOP853, Radau, LSODA
    HeyokaTaylor(tolerance=1e-12)                    heyoka: adaptive Taylor series, compiled
    CvodeSolver(family="Adams", tolerance=1e-10)     SUNDIALS CVODE by scikit-sundae: Adams or BDF

With the penetration d = sum phi_k q_k - gap they integrate y = (q, v),

    q_k' = v_k,   v_k' = P_k sin(w t) - c_k v_k - omega_k^2 q_k - phi_k N,   N = 0, k d or k d^(3/2),

from one touch (d rising through zero) or release (d falling) to the next, which their own root finding has to
notice, and are started anew there. Nothing is shared with the exact methods but the parameters.

Absolute tolerances are those of one energy: with V the largest of |q'|, |omega q| over the start, the steady
motion and a swing that reaches the stop, velocities get tolerance V, displacements tolerance V/omega_k.
Dashpots, constant loads and other laws are refused; a tip that comes to rest on the stop ends in an error.

heyoka and scikit-sundae are the extra `peers`; no solver is imported before a run needs it.
"""

from __future__ import annotations

from importlib.util import find_spec

from contact.integrators import Integrator
from studies.peers.solvers import FAMILIES, SOLVERS, CvodeSolver, HeyokaTaylor, ScipySolver

__all__ = ["CvodeSolver", "HeyokaTaylor", "ScipySolver", "all_solvers", "missing_solvers"]

LIBRARIES = {"scipy": "scipy", "heyoka": "heyoka", "sundials": "sksundae"}
"""The module of each library."""


def missing_solvers() -> list[str]:
    """Libraries that are not installed; nothing is imported to find out."""
    return sorted(name for name, module in LIBRARIES.items() if find_spec(module) is None)


def all_solvers(tolerance: float) -> dict[str, Integrator]:
    """Every solver of the libraries installed at one `tolerance` [1], by its label."""
    missing = missing_solvers()
    found: dict[str, Integrator] = {}
    if "scipy" not in missing:
        found |= {f"scipy {solver}": ScipySolver(solver=solver, tolerance=tolerance) for solver in SOLVERS}
    if "heyoka" not in missing:
        found["heyoka Taylor"] = HeyokaTaylor(tolerance=tolerance)
    if "sundials" not in missing:
        found |= {f"CVODE {family}": CvodeSolver(family=family, tolerance=tolerance) for family in FAMILIES}
    return found
