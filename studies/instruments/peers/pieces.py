"""A motion put together from pieces: a solver integrates to the next event, here it is said what follows.

    off the wall --d = 0--> Newton's law: v_k -> v_k - phi_k (1 + e) d'/sum phi^2, then off the wall again
                            or held, once the next hop would be lower than the tolerance allows for
                        --> force laws: in contact
    in contact   --N = 0--> off the wall;  inside, if a dashpot has let go behind the wall
    inside       --d = 0--> off the wall;  --N = 0--> in contact again
    held         --N = 0--> off the wall
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from contact.errors import Chatter, Diverged, UnresolvedCrossing
from contact.integrators.equation import contact_force
from contact.integrators.method import Run
from contact.laws import HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import CONTACT, INSIDE, OUTSIDE, SUSTAINED, ImpactKind, State, Trajectory
from studies.instruments.peers.problem import Problem, problem_of
from studies.instruments.peers.touch_log import TouchLog

__all__ = ["Advance", "Piece", "pieced_trajectory"]

EPS = 2.220446049250313e-16

MOST_IMPACTS = 10_000
"""Bound of impacts in one period: hops lower than the tolerance are not followed, so a longer sequence is not
on its way to rest within any patience."""

MOST_STALLS = 50
"""Bound of pieces in a row without a duration; the regimes of a regular motion alternate at most twice."""


class Piece(NamedTuple):
    """How far a solver came: time, state, number of the event (-1 if none), states at the times that it has
    passed, and what it has spent."""

    end: float
    state: np.ndarray
    event: int
    samples: np.ndarray
    evaluations: int


Advance = Callable[[int, float, np.ndarray, np.ndarray], Piece]
"""advance(regime, begin, y, times) -> Piece: to the first event of `regime` or to the last of `times`."""


def _at_the_wall(problem: Problem, y: np.ndarray, *, rest: bool = False) -> np.ndarray:
    """The state with the tip exactly at the gap, and at rest there if asked for."""
    e, n = problem.equation, problem.equation.phi.size
    depth, rate = problem.tip(y)
    there = y.copy()
    there[:n] -= e.phi * depth / e.compliance
    if rest:
        there[n : 2 * n] -= e.phi * rate / e.compliance
    return there


def _pull(problem: Problem, s: float, y: np.ndarray) -> float:
    """Acceleration of the tip towards the stop when no force acts there [m/s^2]."""
    e, n = problem.equation, problem.equation.phi.size
    swing = math.sin(e.drive * (e.clock + s))
    return float(e.phi @ (e.constant + e.push * swing - e.decay * y[n : 2 * n] - e.stiffness * y[:n]))


def _touch(problem: Problem, log: TouchLog, s: float, y: np.ndarray) -> tuple[int, np.ndarray]:
    """Regime and state after the tip has met the stop."""
    e, n = problem.equation, problem.equation.phi.size
    _depth, approach = problem.tip(y)
    y = _at_the_wall(problem, y)  # the root finding leaves a trace of penetration, which would be found again
    log.touch(s, y)
    if e.law != NEWTON:
        y[2 * n :] = 0.0
        return CONTACT, y
    rebound = e.number0 * approach
    y[n : 2 * n] -= e.phi * (approach + rebound) / e.compliance
    log.release(s, y, 0.5 * (approach - rebound) * (approach + rebound) / e.compliance)
    pull, lost_in_error = _pull(problem, s, y), float(np.abs(e.phi) @ problem.absolute[:n])
    if e.number0 < 1.0 and rebound * rebound <= 2.0 * pull * lost_in_error:
        log.touch(s, y, ImpactKind.STAY, counted=False)
        return SUSTAINED, _at_the_wall(problem, y, rest=True)
    return OUTSIDE, y


def _first_regime(problem: Problem, log: TouchLog, regime: int, y: np.ndarray) -> tuple[int, np.ndarray]:
    """Regime and state in which the run begins."""
    e = problem.equation
    known = {
        NEWTON: (OUTSIDE, SUSTAINED), LINEAR: (OUTSIDE, CONTACT, INSIDE), HERTZ: (OUTSIDE, CONTACT)
    }[e.law]  # fmt: skip
    if regime not in known:
        raise ValueError(f"regime of the state is {regime}; with this contact law it must be one of {known}")
    depth, rate = problem.tip(y)
    if regime == OUTSIDE and depth > problem.rounding:
        if e.law == NEWTON:
            raise ValueError(
                f"displacement of the state puts the tip {depth:.3g} m behind the stop; with an impact law "
                "it must start on the near side"
            )
        pushed = e.law == HERTZ or contact_force(e, depth, rate) > 0.0
        regime = CONTACT if pushed else INSIDE
    elif regime == OUTSIDE and depth >= -problem.rounding:
        if rate > 0.0:
            return _touch(problem, log, 0.0, y)
        if rate == 0.0 and _pull(problem, 0.0, y) > 0.0:
            regime = SUSTAINED if e.law == NEWTON else CONTACT
    if regime != OUTSIDE:
        log.touch(0.0, y, counted=False)
    return regime, y


def _next_regime(
    problem: Problem, log: TouchLog, regime: int, event: int, s: float, y: np.ndarray
) -> tuple[int, np.ndarray]:
    """Regime and state after an event."""
    e = problem.equation
    if regime == OUTSIDE:
        # a tip that has left the stop without speed may cross it once more within rounding: that is no touch
        n = e.phi.size
        rounding = 4.0 * EPS * float(np.abs(e.phi) @ np.abs(y[n : 2 * n]))
        return _touch(problem, log, s, y) if problem.tip(y)[1] > rounding else (OUTSIDE, y)
    if regime == CONTACT and e.law == LINEAR and e.number1 > 0.0:
        return INSIDE, y
    if regime == INSIDE and event == 1:
        return CONTACT, y
    if regime == SUSTAINED:
        y = _at_the_wall(problem, y, rest=True)
        opened = log.rows[-1][2]
        log.release(s, y, 0.5 * opened * opened / e.compliance)
        return OUTSIDE, y
    log.release(s, y)
    return OUTSIDE, y


def pieced_trajectory(
    oscillator: ImpactOscillator,
    run: Run,
    *,
    tolerance: float,
    solver: Callable[[Problem], Advance],
    looks: list[float] | None = None,
) -> Trajectory:
    """The motion of `run`, piece by piece.

    Parameters
    ----------
    oscillator : ImpactOscillator
    run : Run
    tolerance : float
        Relative tolerance of the solver.
    solver : callable
        From the problem to what advances it by one piece.
    looks : list of float, optional
        Filled with the times at which the solver looks for events [s].

    Raises
    ------
    ValueError
        For a start behind the stop under an impact law.
    Chatter, UnresolvedCrossing, Diverged, ContactError
        Where the solver gave up or got nowhere.
    """
    n, period = oscillator.n_modes, oscillator.period
    problem = problem_of(oscillator, run, tolerance, looks)
    log, advance = TouchLog(problem), solver(problem)
    y = np.zeros(problem.size)
    y[:n], y[n : 2 * n] = run.start.displacement, run.start.velocity
    regime, y = _first_regime(problem, log, int(run.start.regime), y)

    passed = np.arange(run.first + 1, run.last + 1)
    strobe = np.clip((passed - run.first) * period - run.clock, 0.0, run.length)
    sample = np.clip((run.sample_period - run.first) * period + run.sample_clock - run.clock, 0.0, run.length)
    times, place = np.unique(np.concatenate([strobe, sample, [run.length]]), return_inverse=True)
    states = np.empty((times.size, problem.size))
    s, reached, spent, stalls = 0.0, 0, 0, 0
    slack = 8.0 * EPS * run.length
    while True:
        while reached < times.size and times[reached] <= s + slack:
            states[reached] = y
            reached += 1
        if reached == times.size:
            break
        piece = advance(regime, s, y, times[reached:])
        spent += piece.evaluations
        states[reached : reached + len(piece.samples)] = piece.samples
        reached += len(piece.samples)
        stalls = stalls + 1 if piece.end <= s + slack else 0
        s, y = piece.end, piece.state
        if not np.all(np.isfinite(y)):
            raise problem.failed(Diverged, s, np.nan_to_num(y))
        if piece.event < 0:
            continue
        regime, y = _next_regime(problem, log, regime, piece.event, s, y)
        if stalls > MOST_STALLS:
            raise problem.failed(UnresolvedCrossing, s, y, "the solver finds one event after another there")
        if len(log.begun) > MOST_IMPACTS and s - log.begun[-MOST_IMPACTS] < period:
            raise problem.failed(Chatter, s, y, f"more than {MOST_IMPACTS} in one period")

    counts = np.bincount(np.searchsorted(strobe, log.begun), minlength=passed.size + 1)[: passed.size]
    at_strobe, at_sample, end = np.split(states[place], [passed.size, passed.size + sample.size])
    return Trajectory(
        end=State(
            displacement=end[0, :n], velocity=end[0, n : 2 * n], time=run.last * period + run.clock_end,
            regime=regime,
        ),
        strobe_time=passed * period,
        strobe_displacement=at_strobe[:, :n],
        strobe_velocity=at_strobe[:, n : 2 * n],
        strobe_impacts=counts.astype(np.int64),
        time=run.times,
        displacement=at_sample[:, :n],
        velocity=at_sample[:, n : 2 * n],
        impacts=log.impacts(),
        evaluations=spent,
    )  # fmt: skip
