"""SUNDIALS CVODE through scikit-sundae, restarted at every touch and release that its root finding notices.

Variable-step, variable-order multistep methods in Nordsieck form: Adams-Moulton up to order 12 or BDF up to
order 5, each with Newton's iteration on the exact Jacobian (A. C. Hindmarsh et al., ACM Trans. Math. Softw.
31 (2005) 363).  Roots are changes of sign between two steps; a restart begins at order 1, which is what many
impacts cost a multistep method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np

from contact.errors import ContactError
from contact.integrators.method import Integrator, Run
from contact.laws import HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import Trajectory
from studies.instruments.peers.equations import jacobian, rates, surfaces
from studies.instruments.peers.pieces import Advance, Piece, pieced_trajectory
from studies.instruments.peers.problem import Problem, check_tolerance

__all__ = ["FAMILIES", "SundialsCvode"]

FAMILIES = ("BDF", "Adams")

LEAST_TOLERANCE = 1e-15
MOST_STEPS = 1_000_000
"""Bound of the steps between two times; the library's own is 500, which one drive period can exceed."""

ROOT, STOPPED = 2, 1
"""Codes with which CVODE returns at a root and at the end that it was given."""


def _solver(problem: Problem, family: str) -> Advance:
    from sksundae.cvode import CVODE

    modes, scalars, size, looks = problem.modes, problem.scalars, problem.size, problem.looks

    def advance(regime: int, begin: float, y: np.ndarray, times: np.ndarray) -> Piece:
        def right(t: float, state: np.ndarray, out: np.ndarray) -> None:
            rates(t, state, out, modes, scalars, regime)

        def slopes(t: float, state: np.ndarray, _rates: np.ndarray, out: np.ndarray) -> None:
            jacobian(t, state, out, modes, scalars, regime)

        def surface(t: float, state: np.ndarray, out: np.ndarray) -> None:
            if looks is not None:
                looks.append(t)
            surfaces(t, state, out, modes, scalars, regime, begin)

        setattr(surface, "direction", [1, 1])  # noqa: B010
        # a new one for each piece: the library keeps, and reads again, every event that one has ever found
        cvode: Any = CVODE(
            right, method=family, rtol=problem.tolerance, atol=problem.absolute, jacfn=slopes,
            eventsfn=surface, num_events=2, max_num_steps=MOST_STEPS,
        )  # fmt: skip
        cvode.init_step(begin, y)
        samples: list[np.ndarray] = []
        for time in times:
            found = cvode.step(time, tstop=times[-1])
            if not found.success:
                raise problem.failed(ContactError, found.t, found.y, f"CVODE {family}: {found.message}")
            if found.status == ROOT:
                number = int(np.flatnonzero(found.i_events[-1])[0])
                states = np.array(samples).reshape(-1, size)
                return Piece(float(found.t), found.y, number, states, int(found.nfev))
            samples.append(found.y)
        return Piece(float(times[-1]), samples[-1].copy(), -1, np.array(samples), int(found.nfev))

    return advance


@dataclass(frozen=True, kw_only=True)
class SundialsCvode(Integrator):
    """CVODE with root finding, restarted at every touch and release.

    Parameters
    ----------
    tolerance : float
        Relative tolerance; the absolute ones follow from it, see ``problem`` [1].
    family : {"BDF", "Adams"}
    looks : list of float, optional
        If given, filled with the times at which the solver has looked for events, since the run's start [s].
    """

    tolerance: float = 1e-10
    family: str = "BDF"
    looks: list[float] | None = field(default=None, repr=False, compare=False)
    name: ClassVar[str] = "sundials"
    library: ClassVar[str] = "sksundae"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = (NEWTON, LINEAR, HERTZ)
    limit: ClassVar[str] = "none to choose: the error control shortens the steps; crossings may be missed"
    source: ClassVar[str] = "A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363"

    def __post_init__(self) -> None:
        if self.family not in FAMILIES:
            raise ValueError(f"family is {self.family!r}; it must be one of {', '.join(FAMILIES)}")
        check_tolerance(self.tolerance, LEAST_TOLERANCE)
        if find_spec(self.library) is None:
            raise ImportError(
                'scikit-sundae is not installed; it comes with the extra peers: pip install -e ".[peers]"'
            )

    @property
    def label(self) -> str:
        """Name of the solver in tables and figures."""
        return f"CVODE {self.family}"

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are those of the right-hand side."""
        return pieced_trajectory(
            oscillator, run, tolerance=self.tolerance, looks=self.looks,
            solver=lambda problem: _solver(problem, self.family),
        )  # fmt: skip
