"""heyoka: adaptive Taylor series, compiled for the equations at hand, restarted at every event.

The method expands the solution in time up to the order that its tolerance asks for (16 at 1e-13), chooses the
step from the last terms, and finds events as roots of the Taylor polynomial of what is watched, all of them
within a step (F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614).

Under Hertz's law the series in time does not exist at the touch: with d ~ t the force goes like t^(3/2).
It does exist in sigma, dt = s d(sigma) with s = sqrt(d) (K. F. Sundman's substitution, Acta Math. 36 (1913)
105):

    dq/dsigma = s v,   dv/dsigma = s (f - phi N),   N = k s^3 (1 + chi d'),   ds/dsigma = d'/2,
    dt/dsigma = s,     dW/dsigma = s N d'

since d' ds/dt follows from 2 s s' = d'.  All of it is polynomial but for the drive's sine, and s passes
through zero with the slope d'/2, so that touch and release are regular points.  s is integrated beside q and
agrees with sqrt(phi q - gap) within the tolerance.  A wanted time within a contact is an event t = target.
What is left out is a contact that begins without speed, where ds/dsigma vanishes; it ends in an error.

Compiling takes 0.05 to 0.4 s and is no part of the cost of a step: integrators are kept for each number of
modes, kind of equation and tolerance, with all physical numbers as run-time parameters, in each thread.
"""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, ClassVar, NamedTuple

import numpy as np

from contact.errors import ContactError
from contact.integrators.method import Integrator, Run
from contact.laws import HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import CONTACT, INSIDE, OUTSIDE, SUSTAINED, Trajectory
from studies.instruments.peers.pieces import Advance, Piece, pieced_trajectory
from studies.instruments.peers.problem import Problem, check_tolerance

__all__ = ["HeyokaTaylor"]

EPS = 2.220446049250313e-16

MOST_STEPS = 1_000_000
"""Bound of the steps of one piece; a contact that begins without speed never gets off s = 0."""

FAR = 1e30
"""End of a piece in sigma, never reached: an event ends it [s m^-1/2]."""

_kept = threading.local()


class Kind(NamedTuple):
    """What the compiled code of an integrator depends on."""

    n_modes: int
    regime: int
    law: int
    driven: bool
    loaded: bool
    dissipative: bool
    tolerance: float


def _compiled(kind: Kind) -> Any:
    """The integrator of `kind`, compiled once in each thread."""
    kept = _kept.__dict__.setdefault("integrators", {})
    if kind not in kept:
        kept[kind] = _integrator(kind)
    return kept[kind]


def _integrator(kind: Kind) -> Any:
    """The equations of `kind`; parameters in the order of `_parameters`."""
    import heyoka as hy

    n = kind.n_modes
    q = [hy.expression(f"q_{k:03d}") for k in range(n)]
    v = [hy.expression(f"v_{k:03d}") for k in range(n)]
    s, clock, work = hy.make_vars("s", "t", "w")
    stiffness, decay, phi, constant, push = ([hy.par[i * n + k] for k in range(n)] for i in range(5))
    frequency, phase, gap, compliance, number0, number1, rounding, target = (
        hy.par[5 * n + i] for i in range(8)
    )
    hertz = kind.regime == CONTACT and kind.law == HERTZ
    swing = hy.sin(frequency * (clock if hertz else hy.time) + phase) if kind.driven else None

    def flight(k: int) -> Any:
        terms = [-decay[k] * v[k], -stiffness[k] * q[k]]
        if swing is not None:
            terms.append(push[k] * swing)
        if kind.loaded:
            terms.append(constant[k])
        return hy.sum(terms)

    depth = hy.sum([phi[k] * q[k] for k in range(n)]) - gap
    rate = hy.sum([phi[k] * v[k] for k in range(n)])
    linear = number0 * depth + number1 * rate if kind.dissipative else number0 * depth
    force: Any = None
    if hertz:
        force = number0 * s * s * s * (1.0 + number1 * rate) if kind.dissipative else number0 * s * s * s
    elif kind.regime == CONTACT:
        force = linear
    elif kind.regime == SUSTAINED:
        force = hy.sum([phi[k] * flight(k) for k in range(n)]) / compliance

    stretch = s if hertz else 1.0
    pushed = [flight(k) if force is None else flight(k) - phi[k] * force for k in range(n)]
    system = [(q[k], stretch * v[k]) for k in range(n)] + [(v[k], stretch * pushed[k]) for k in range(n)]
    if kind.dissipative:
        system.append((work, stretch * force * rate if kind.regime == CONTACT else hy.expression(0.0)))
    rising, falling = hy.event_direction.positive, hy.event_direction.negative
    if hertz:
        system += [(s, 0.5 * rate), (clock, s)]
        watched = [(s, falling), (clock - target, rising)]
    elif kind.regime == OUTSIDE:
        watched = [(depth - rounding, rising)]
    elif kind.regime == INSIDE:
        watched = [(depth, falling), (linear, rising)]
    else:
        watched = [(force, falling)]
    return hy.taylor_adaptive(
        system, [0.0] * len(system), tol=kind.tolerance,
        t_events=[hy.t_event(surface, direction=way) for surface, way in watched],
    )  # fmt: skip


def _parameters(problem: Problem) -> np.ndarray:
    e = problem.equation
    turned = e.drive * e.clock
    single = [e.drive, turned, e.gap, e.compliance, e.number0, e.number1, problem.rounding, 0.0]
    return np.concatenate([problem.modes.ravel(), single])


def _check(problem: Problem, outcome: Any, events: int, ended: Any, s: float, y: np.ndarray) -> int:
    """Number of the event, or -1 for the end of the piece."""
    number = -1 - int(outcome)
    if 0 <= number < events:
        return number
    if outcome == ended:
        return -1
    raise problem.failed(ContactError, s, np.nan_to_num(y), f"heyoka: {outcome!r}")


def _solver(problem: Problem, tolerance: float) -> Advance:
    import heyoka as hy

    e, n, size = problem.equation, problem.equation.phi.size, problem.size
    parameters = _parameters(problem)
    ended = hy.taylor_outcome.time_limit
    ready: dict[int, Any] = {}

    def integrator(regime: int) -> Any:
        if regime not in ready:
            driven, loaded = bool(np.any(e.push != 0.0)), bool(np.any(e.constant != 0.0))
            kind = Kind(n, regime, e.law, driven, loaded, size > 2 * n, tolerance)
            ready[regime] = _compiled(kind)
            ready[regime].pars[:] = parameters[: ready[regime].pars.size]  # up to the last one that occurs
        ready[regime].reset_cooldowns()
        return ready[regime]

    def in_time(regime: int, begin: float, y: np.ndarray, times: np.ndarray) -> Piece:
        taylor = integrator(regime)
        taylor.time = begin
        taylor.state[:] = y
        outcome, _h, _low, steps, _dense, grid = taylor.propagate_grid(
            np.concatenate([[begin], times]), max_steps=MOST_STEPS * times.size
        )
        events = 2 if regime == INSIDE else 1
        number = _check(problem, outcome, events, ended, taylor.time, taylor.state)
        if number < 0:
            return Piece(float(times[-1]), grid[-1].copy(), -1, grid[1:], steps)
        return Piece(float(taylor.time), taylor.state.copy(), number, grid[1:], steps)

    def in_sigma(regime: int, begin: float, y: np.ndarray, times: np.ndarray) -> Piece:
        taylor = integrator(regime)
        taylor.time = 0.0
        taylor.state[:size] = y
        taylor.state[size] = math.sqrt(max(0.0, problem.tip(y)[0]))
        taylor.state[size + 1] = begin
        samples: list[np.ndarray] = []
        spent = 0
        for target in times:
            taylor.pars[5 * n + 7] = target
            outcome, _h, _low, steps, _dense, _state = taylor.propagate_for(FAR, max_steps=MOST_STEPS)
            spent += steps
            number = _check(problem, outcome, 2, None, taylor.state[size + 1], taylor.state[:size])
            if number == 0:
                end = float(taylor.state[size + 1])
                return Piece(end, taylor.state[:size].copy(), 0, np.array(samples).reshape(-1, size), spent)
            samples.append(taylor.state[:size].copy())
            taylor.reset_cooldowns()
        return Piece(float(times[-1]), samples[-1].copy(), -1, np.array(samples), spent)

    def advance(regime: int, begin: float, y: np.ndarray, times: np.ndarray) -> Piece:
        return (in_sigma if regime == CONTACT and e.law == HERTZ else in_time)(regime, begin, y, times)

    return advance


@dataclass(frozen=True, kw_only=True)
class HeyokaTaylor(Integrator):
    """heyoka's Taylor integrator with terminal events, restarted at every touch and release.

    Parameters
    ----------
    tolerance : float
        Of one step, relative; it sets the order as well [1].
    """

    tolerance: float = 1e-12
    name: ClassVar[str] = "heyoka"
    library: ClassVar[str] = "heyoka"
    order: ClassVar[float] = math.nan
    laws: ClassVar[tuple[int, ...]] = (NEWTON, LINEAR, HERTZ)
    limit: ClassVar[str] = "none to choose: the step follows from the last terms of the series"
    source: ClassVar[str] = "F. Biscani, D. Izzo, Mon. Not. R. Astron. Soc. 504 (2021) 2614"

    def __post_init__(self) -> None:
        check_tolerance(self.tolerance, EPS)
        if find_spec(self.library) is None:
            raise ImportError(
                'heyoka is not installed; it comes with the extra peers: pip install -e ".[peers]"'
            )

    @property
    def label(self) -> str:
        """Name of the solver in tables and figures."""
        return "heyoka Taylor"

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; evaluations are Taylor steps, of the order that the tolerance asks for."""
        return pieced_trajectory(
            oscillator, run, tolerance=self.tolerance, solver=lambda problem: _solver(problem, self.tolerance)
        )
