"""SciPy, heyoka and CVODE, each from one event to the next.

For SciPy and CVODE an event is a change of sign between two steps, so that pairs of crossings within a step
are missed; no longest step is set, as in most uses. heyoka looks for the roots of the Taylor polynomial of a
step. Under Hertz's law its series in time does not exist at the touch, where the force goes like t^(3/2), but
it does in sigma, dt = s dsigma with s = sqrt(d) (K. F. Sundman, Acta Math. 36 (1913) 105):

    dq/dsigma = s v,   dv/dsigma = s (f - phi k s^3),   ds/dsigma = d'/2,   dt/dsigma = s.

Touch and release are regular points; a wanted time within a contact is an event t = target. Compiling takes
0.05 to 0.4 s and is no part of the cost of a step: heyoka's integrators are kept for each number of modes,
kind of equation and tolerance, in each thread, with all physical numbers as run-time parameters.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np

from contact import HertzContact, ImpactOscillator, LinearContact, NewtonRestitution, Trajectory
from contact.integrators import Integrator, Run
from studies.peers.equations import EPS, Array, Equations
from studies.peers.pieces import Advance, Piece, pieced

__all__ = ["FAMILIES", "SOLVERS", "CvodeSolver", "HeyokaTaylor", "ScipySolver"]

SOLVERS = ("RK45", "DOP853", "Radau", "LSODA")
FAMILIES = ("BDF", "Adams")
LAWS = (NewtonRestitution.code, LinearContact.code, HertzContact.code)
NO_LIMIT = "none to choose: the error control shortens the steps"

MOST_STEPS = 1_000_000
"""Bound of the steps of one piece, far beyond what a drive period takes at any tolerance."""

FAR = 1e30
"""End of a piece in sigma, never reached: an event ends it [s m^-1/2]."""

_kept = threading.local()


def _check(tolerance: float, least: float, module: str) -> None:
    """ValueError unless the library takes `tolerance`, ImportError if it is missing."""
    if not (isinstance(tolerance, int | float) and least <= tolerance < 1):
        raise ValueError(f"tolerance is {tolerance}; it must lie between {least:g} and 1")
    if find_spec(module) is None:
        raise ImportError(
            f'{module} is not installed; it comes with the extra peers: pip install -e ".[peers]"'
        )


@dataclass(frozen=True, kw_only=True)
class ScipySolver(Integrator):
    """solve_ivp with events: Runge-Kutta pairs of order 5 (RK45) and 8 (DOP853), Radau IIA with the exact
    Jacobian, LSODA (Adams and BDF); `tolerance` is relative [1]."""

    solver: str = "DOP853"
    tolerance: float = 1e-10
    name: ClassVar[str] = "scipy"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = LAWS
    limit: ClassVar[str] = NO_LIMIT
    source: ClassVar[str] = "P. Virtanen et al., Nature Methods 17 (2020) 261"

    def __post_init__(self) -> None:
        if self.solver not in SOLVERS:
            raise ValueError(f"solver is {self.solver!r}; it must be one of {', '.join(SOLVERS)}")
        _check(self.tolerance, 2.5e-14, "scipy")  # solve_ivp replaces tolerances below 100 rounding units

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are those of the right-hand side."""
        return pieced(oscillator, run, self.tolerance, self._advance)

    def _advance(self, e: Equations) -> Advance:
        from scipy.integrate import solve_ivp

        def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
            def watched(t: float, state: Array) -> float:
                return e.surface(contact, begin, t, state)

            setattr(watched, "terminal", True)  # noqa: B010
            setattr(watched, "direction", 1)  # noqa: B010
            more: dict[str, Any] = {}
            if self.solver == "LSODA" or (self.solver == "Radau" and contact and e.hertz):
                more["jac"] = lambda t, state: e.jacobian(contact, state)
            elif self.solver == "Radau":
                more["jac"] = e.jacobian(contact, y)  # constant
            with np.errstate(all="ignore"):  # trial steps too long may overflow, and are rejected
                found = solve_ivp(
                    lambda t, state: e.rates(contact, t, state, np.empty(2 * e.n)), (begin, times[-1]), y,
                    method=self.solver, t_eval=times, rtol=e.tolerance, atol=e.absolute, events=watched,
                    **more,
                )  # fmt: skip
            samples = found.y.T if len(found.t) else np.empty((0, 2 * e.n))
            if not found.success:
                reached, last = (found.t[-1], samples[-1]) if len(found.t) else (begin, y)
                raise e.failed(float(reached), last, f"{self.solver} past this time: {found.message}")
            if found.status == 0:
                return Piece(float(times[-1]), samples[-1].copy(), False, samples, int(found.nfev))
            return Piece(float(found.t_events[0][-1]), np.array(found.y_events[0][-1]), True, samples,
                         int(found.nfev))  # fmt: skip

        return advance


@dataclass(frozen=True, kw_only=True)
class CvodeSolver(Integrator):
    """CVODE: Adams-Moulton up to order 12 or BDF up to order 5, Newton's iteration on the exact Jacobian,
    with root finding; a restart begins at order 1. `tolerance` is relative [1]."""

    family: str = "BDF"
    tolerance: float = 1e-10
    name: ClassVar[str] = "sundials"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = LAWS
    limit: ClassVar[str] = NO_LIMIT
    source: ClassVar[str] = "A. C. Hindmarsh et al., ACM Trans. Math. Softw. 31 (2005) 363"

    def __post_init__(self) -> None:
        if self.family not in FAMILIES:
            raise ValueError(f"family is {self.family!r}; it must be one of {', '.join(FAMILIES)}")
        _check(self.tolerance, 1e-15, "sksundae")

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are those of the right-hand side."""
        return pieced(oscillator, run, self.tolerance, self._advance)

    def _advance(self, e: Equations) -> Advance:
        from sksundae.cvode import CVODE

        def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
            def right(t: float, state: Array, out: Array) -> None:
                e.rates(contact, t, state, out)

            def slopes(t: float, state: Array, _rates: Array, out: Array) -> None:
                out[:] = e.jacobian(contact, state)

            def watched(t: float, state: Array, out: Array) -> None:
                out[0] = e.surface(contact, begin, t, state)

            setattr(watched, "direction", [1])  # noqa: B010
            # a new one for each piece: the library keeps, and reads again, every event that one has found
            cvode: Any = CVODE(
                right, method=self.family, rtol=e.tolerance, atol=e.absolute, jacfn=slopes, eventsfn=watched,
                num_events=1, max_num_steps=MOST_STEPS,
            )  # fmt: skip
            cvode.init_step(begin, y)
            samples: list[Array] = []
            for time in times:
                found = cvode.step(time, tstop=times[-1])
                if not found.success:
                    raise e.failed(found.t, found.y, f"CVODE {self.family}: {found.message}")
                if found.status == 2:  # a root
                    passed = np.array(samples).reshape(-1, 2 * e.n)
                    return Piece(float(found.t), found.y, True, passed, int(found.nfev))
                samples.append(found.y)
            return Piece(float(times[-1]), samples[-1].copy(), False, np.array(samples), int(found.nfev))

        return advance


@dataclass(frozen=True, kw_only=True)
class HeyokaTaylor(Integrator):
    """heyoka's Taylor integrator with terminal events; `tolerance`, of one step, sets the order too [1]."""

    tolerance: float = 1e-12
    name: ClassVar[str] = "heyoka"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = LAWS
    limit: ClassVar[str] = "none to choose: the step follows from the last terms of the series"
    source: ClassVar[str] = "F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614"

    def __post_init__(self) -> None:
        _check(self.tolerance, EPS, "heyoka")

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are Taylor steps, of the order that the tolerance asks for."""
        return pieced(oscillator, run, self.tolerance, self._advance)

    def _advance(self, e: Equations) -> Advance:
        import heyoka as hy

        numbers = np.concatenate([e.modes.ravel(), e.scalars, [e.rounding, 0.0]])

        def made(contact: bool) -> Any:
            kept = _kept.__dict__.setdefault("integrators", {})
            kind = (e.n, contact, contact and e.hertz, self.tolerance)
            if kind not in kept:
                kept[kind] = _compiled(*kind)
            kept[kind].pars[:] = numbers[: kept[kind].pars.size]  # up to the last one that occurs
            kept[kind].reset_cooldowns()
            return kept[kind]

        def ended(outcome: Any, s: float, y: Array) -> int:
            """Number of the event, -1 at the end of the piece."""
            number = -1 - int(outcome)
            if 0 <= number < 2:
                return number
            if outcome == hy.taylor_outcome.time_limit:
                return -1
            raise e.failed(s, y, f"heyoka: {outcome!r}")

        def in_time(taylor: Any, begin: float, y: Array, times: Array) -> Piece:
            taylor.time = begin
            taylor.state[:] = y
            outcome, _h, _low, steps, _dense, grid = taylor.propagate_grid(
                np.concatenate([[begin], times]), max_steps=MOST_STEPS
            )
            if ended(outcome, taylor.time, taylor.state) < 0:
                return Piece(float(times[-1]), grid[-1].copy(), False, grid[1:], steps)
            return Piece(float(taylor.time), taylor.state.copy(), True, grid[1:], steps)

        def in_sigma(taylor: Any, begin: float, y: Array, times: Array) -> Piece:
            taylor.time = 0.0
            taylor.state[:] = [*y, math.sqrt(max(0.0, e.tip(y)[0])), begin]
            samples: list[Array] = []
            spent, number = 0, 1
            for target in times:
                taylor.pars[-1] = target
                taylor.reset_cooldowns()
                outcome, _h, _low, steps, _dense, _state = taylor.propagate_for(FAR, max_steps=MOST_STEPS)
                spent += steps
                number = ended(outcome, float(taylor.state[-1]), taylor.state[:-2])
                if number == 0:
                    break
                samples.append(taylor.state[:-2].copy())
            passed = np.array(samples).reshape(-1, 2 * e.n)
            end = float(times[-1]) if number else float(taylor.state[-1])
            return Piece(end, taylor.state[:-2].copy(), number == 0, passed, spent)

        def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
            return (in_sigma if contact and e.hertz else in_time)(made(contact), begin, y, times)

        return advance


def _compiled(n: int, contact: bool, sigma: bool, tolerance: float) -> Any:
    """heyoka's integrator for a flight, a linear contact, or a Hertz contact in sigma."""
    import heyoka as hy

    q, v = ([hy.expression(f"{name}_{k:03d}") for k in range(n)] for name in "qv")
    s, clock = hy.make_vars("s", "t")
    stiffness, decay, phi, push = ([hy.par[i * n + k] for k in range(n)] for i in range(4))
    frequency, phase, gap, number, rounding, target = (hy.par[4 * n + i] for i in range(6))
    swing = hy.sin(frequency * (clock if sigma else hy.time) + phase)
    depth = hy.sum([phi[k] * q[k] for k in range(n)]) - gap
    rate = hy.sum([phi[k] * v[k] for k in range(n)])
    force = number * s * s * s if sigma else number * depth
    stretch = s if sigma else 1.0
    pulls = [
        [push[k] * swing, -decay[k] * v[k], -stiffness[k] * q[k], *([-phi[k] * force] if contact else [])]
        for k in range(n)
    ]
    system = [(q[k], stretch * v[k]) for k in range(n)] + [
        (v[k], stretch * hy.sum(pulls[k])) for k in range(n)
    ]
    rising, falling = hy.event_direction.positive, hy.event_direction.negative
    if sigma:
        system += [(s, 0.5 * rate), (clock, s)]
        watched = [(s, falling), (clock - target, rising)]
    else:
        watched = [(depth, falling)] if contact else [(depth - rounding, rising)]
    return hy.taylor_adaptive(
        system, [0.0] * len(system), tol=tolerance,
        t_events=[hy.t_event(surface, direction=way) for surface, way in watched],
    )  # fmt: skip
