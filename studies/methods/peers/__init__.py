"""Outside solvers behind the interface of the package's own methods, to be compared with them.

    OutsideSolver(solver="scipy DOP853", tolerance=1e-10)      and all others of `SOLVERS`

scipy      solve_ivp with events: Runge-Kutta pairs of order 5 (RK45) and 8 (DOP853), Radau IIA with the exact
           Jacobian, LSODA (Adams and BDF)
heyoka     adaptive Taylor series, compiled, with events
sundials   CVODE by scikit-sundae: Adams-Moulton up to order 12 or BDF up to order 5, Newton's iteration on
           the exact Jacobian, with root finding; a restart begins at order 1

They integrate from one touch or release to the next, which their own root finding has to notice, and are
started anew there. Nothing is shared with the exact methods but the
parameters. Dashpots, constant loads and other laws are refused; a tip that rests on the stop ends in
an error.

No library is imported before a plan needs it.

`piecewise`   the equations of a flight and of a contact, and the motion from one event to the next
`adapters`    SciPy, heyoka and CVODE, each from one event to the next
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import ClassVar

from beam import InvalidValue
from contact import HertzContact, ImpactOscillator, LinearContact, NewtonRestitution, Trajectory
from contact.integrators import Integrator, Plan
from studies.methods.peers.adapters import cvode_pieces, heyoka_pieces, scipy_pieces
from studies.methods.peers.piecewise import Advance, Equations, pieced
from studies.shell.programs import needs

LIBRARIES = {"scipy": ("scipy", 2.5e-14), "heyoka": ("heyoka", 2.3e-16), "sundials": ("sksundae", 1e-15)}
"""The module of each library, and the least tolerance that it takes (solve_ivp replaces smaller ones)."""

SOLVERS: dict[str, tuple[str, Callable[[Equations], Advance]]] = {
    "scipy RK45": ("scipy", lambda e: scipy_pieces(e, "RK45")),
    "scipy DOP853": ("scipy", lambda e: scipy_pieces(e, "DOP853")),
    "scipy Radau": ("scipy", lambda e: scipy_pieces(e, "Radau")),
    "scipy LSODA": ("scipy", lambda e: scipy_pieces(e, "LSODA")),
    "heyoka Taylor": ("heyoka", heyoka_pieces),
    "CVODE BDF": ("sundials", lambda e: cvode_pieces(e, "BDF")),
    "CVODE Adams": ("sundials", lambda e: cvode_pieces(e, "Adams")),
}
"""Library and adapter of each solver."""


def missing_solvers() -> list[str]:
    """Libraries that are not installed; nothing is imported to find out."""
    return sorted(name for name, (module, _least) in LIBRARIES.items() if find_spec(module) is None)


def installed_solvers() -> list[str]:
    """The names in `SOLVERS` of those whose library is there."""
    return [name for name, (library, _adapter) in SOLVERS.items() if library not in missing_solvers()]


@dataclass(frozen=True, kw_only=True)
class OutsideSolver(Integrator):
    """A solver of `SOLVERS` at a relative `tolerance` of one step [1], which sets heyoka's order too."""

    solver: str
    tolerance: float
    name: ClassVar[str] = "outside"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = (NewtonRestitution.code, LinearContact.code, HertzContact.code)
    source: ClassVar[str] = (
        "P. Virtanen et al., Nature Methods 17 (2020) 261; F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. "
        "504 (2021) 2614; A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363"
    )

    def __post_init__(self) -> None:
        if self.solver not in SOLVERS:
            raise InvalidValue(f"solver is {self.solver!r}; it must be one of {', '.join(SOLVERS)}")
        module, least = LIBRARIES[SOLVERS[self.solver][0]]
        if not (isinstance(self.tolerance, int | float) and least <= self.tolerance < 1):
            raise InvalidValue(f"tolerance is {self.tolerance}; it must lie between {least:g} and 1")
        if find_spec(module) is None:
            raise ImportError(needs(f"{module} is not installed: {self.solver}", "heyoka scikit-sundae"))

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """The motion of `plan`; evaluations are of the right-hand side, heyoka's its Taylor steps."""
        return pieced(oscillator, plan, self.tolerance, SOLVERS[self.solver][1])
