"""SciPy's solve_ivp, restarted at every touch and release that its event detection notices.

``RK45`` and ``DOP853`` are explicit Runge-Kutta pairs of order 5 and 8 (J. R. Dormand, P. J. Prince,
J. Comput. Appl. Math. 6 (1980) 19; E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential
Equations I (1993), sec. II.10), ``Radau`` is Radau IIA of order 5 (E. Hairer, G. Wanner, Solving Ordinary
Differential Equations II (1996), sec. IV.8), here with the exact Jacobian, and ``LSODA`` switches between
Adams and BDF (L. R. Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136).

An event is a change of sign between two steps, and its time the root of the interpolant of the step: pairs of
crossings within one step are missed.  Steps are as long as the error control lets them be; no longest step is
set, as in most uses.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from contact.errors import ContactError
from contact.integrators.method import Integrator, Run
from contact.laws import HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import CONTACT, INSIDE, Trajectory
from studies.instruments.peers.equations import jacobian, rates, surfaces
from studies.instruments.peers.pieces import Advance, Piece, pieced_trajectory
from studies.instruments.peers.problem import Problem, check_tolerance

__all__ = ["SOLVERS", "ScipyMethod"]

SOLVERS = ("RK45", "DOP853", "Radau", "LSODA")

LEAST_TOLERANCE = 2.5e-14
"""solve_ivp replaces relative tolerances below 100 rounding units."""


def _watch(problem: Problem, regime: int, begin: float) -> list[Callable[[float, np.ndarray], float]]:
    """The events of `regime` for a piece from `begin`."""
    values = np.empty(2)
    modes, scalars, looks = problem.modes, problem.scalars, problem.looks

    def event(number: int) -> Callable[[float, np.ndarray], float]:
        def surface(t: float, y: np.ndarray) -> float:
            if looks is not None:
                looks.append(t)
            surfaces(t, y, values, modes, scalars, regime, begin)
            return float(values[number])

        setattr(surface, "terminal", True)  # noqa: B010
        setattr(surface, "direction", 1)  # noqa: B010
        return surface

    return [event(number) for number in range(2 if regime == INSIDE else 1)]


def _solver(problem: Problem, solver: str) -> Advance:
    from scipy.integrate import solve_ivp

    modes, scalars, size = problem.modes, problem.scalars, problem.size
    linear = problem.equation.law != HERTZ

    def advance(regime: int, begin: float, y: np.ndarray, times: np.ndarray) -> Piece:
        def right(t: float, state: np.ndarray) -> np.ndarray:
            out = np.empty(size)
            rates(t, state, out, modes, scalars, regime)
            return out

        def slopes(t: float, state: np.ndarray) -> np.ndarray:
            out = np.empty((size, size))
            jacobian(t, state, out, modes, scalars, regime)
            return out

        more: dict[str, Any] = {}
        if solver == "LSODA":
            more["jac"] = slopes
        elif solver == "Radau":
            constant = size == 2 * modes.shape[1] and (linear or regime != CONTACT)
            more["jac"] = slopes(begin, y) if constant else slopes
        with np.errstate(all="ignore"):  # trial steps that are far too long may overflow, and are rejected
            found = solve_ivp(
                right, (begin, times[-1]), y, method=solver, t_eval=times, rtol=problem.tolerance,
                atol=problem.absolute, events=_watch(problem, regime, begin), **more,
            )  # fmt: skip
        if found.status < 0 or not found.success:
            reached = begin if not len(found.t) else float(found.t[-1])
            last = y if not len(found.t) else found.y[:, -1]
            raise problem.failed(ContactError, reached, last, f"{solver} past this time: {found.message}")
        samples = found.y.T if len(found.t) else np.empty((0, size))
        if found.status == 0:
            return Piece(float(times[-1]), samples[-1].copy(), -1, samples, int(found.nfev))
        number = next(i for i, at in enumerate(found.t_events) if len(at))
        end, state = float(found.t_events[number][-1]), np.array(found.y_events[number][-1])
        return Piece(end, state, number, samples, int(found.nfev))

    return advance


@dataclass(frozen=True, kw_only=True)
class ScipyMethod(Integrator):
    """solve_ivp with events, restarted at every touch and release.

    Parameters
    ----------
    solver : {"DOP853", "RK45", "Radau", "LSODA"}
    tolerance : float
        Relative tolerance; the absolute ones follow from it, see ``problem`` [1].
    looks : list of float, optional
        If given, filled with the times at which the solver has looked for events, since the run's start [s].
    """

    solver: str = "DOP853"
    tolerance: float = 1e-10
    looks: list[float] | None = field(default=None, repr=False, compare=False)
    name: ClassVar[str] = "scipy"
    library: ClassVar[str] = "scipy"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = (NEWTON, LINEAR, HERTZ)
    limit: ClassVar[str] = "none to choose: the error control shortens the steps; crossings may be missed"
    source: ClassVar[str] = "P. Virtanen et al., Nature Methods 17 (2020) 261"

    def __post_init__(self) -> None:
        if self.solver not in SOLVERS:
            raise ValueError(f"solver is {self.solver!r}; it must be one of {', '.join(SOLVERS)}")
        check_tolerance(self.tolerance, LEAST_TOLERANCE)

    @property
    def label(self) -> str:
        """Name of the solver in tables and figures."""
        return f"scipy {self.solver}"

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are those of the right-hand side."""
        return pieced_trajectory(
            oscillator, run, tolerance=self.tolerance, looks=self.looks,
            solver=lambda problem: _solver(problem, self.solver),
        )  # fmt: skip
