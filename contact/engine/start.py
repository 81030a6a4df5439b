"""A run of the exact motion: where it may start, the event loop called, and how it fails."""

from __future__ import annotations

import numpy as np

from beam.parameters import InvalidValue
from contact.engine.event_loop import (
    DONE,
    FAILED_CHATTER,
    FAILED_CROSSING,
    FAILED_SERIES,
    FAILED_STEPS,
    LOG_FULL,
    MOST_IMPACTS,
    MOST_STEPS,
    STATE,
    advance,
)
from contact.engine.recorder import grown, open_touch, recorder_for, trajectory_of
from contact.errors import Chatter, ContactError, ContactTooStiff, UnresolvedCrossing
from contact.flight.modal_flow import steady_motion, tip_rounding, tip_state
from contact.flight.motion import Motion
from contact.oscillator import ImpactOscillator
from contact.touch import TOUCHES, force
from contact.trajectory import OUTSIDE, SUSTAINED, WAITING, ImpactKind, Regime, Run, State, Trajectory

HELD_WITHIN = 1e3
"""How far from the gap a tip that is said to rest on the wall may be, in rounding bounds."""

FAILURES: dict[int, tuple[type[ContactError], str]] = {
    FAILED_CROSSING: (UnresolvedCrossing, ""),
    FAILED_CHATTER: (Chatter, f"more than {MOST_IMPACTS} in one drive period"),
    FAILED_STEPS: (ContactTooStiff, f"more than {MOST_STEPS} steps in one drive period"),
    FAILED_SERIES: (ContactTooStiff, "its power series gives no step of finite length above zero"),
}
"""The error that belongs to a status of `advance`, and its detail."""


def start_of(
    motion: Motion,
    state: State,
    period: int,
    clock: float,
    *,
    search: int = 0,
    steady: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (u, v) of `state` from the steady motion, and a run (`STATE`) that starts there.

    `steady` is the steady displacement and velocity at the start, if they are known, each (n_modes,).

    Raises
    ------
    ValueError
        If the state has another number of modes, a regime that the law does not know or that does not fit
        where the tip is, or lies behind the stop of an impact law.
    """
    if state.displacement.size != motion.size:
        raise InvalidValue(
            f"displacement of the state has {state.displacement.size} modes; the model has {motion.size}"
        )
    q, q_rate = steady_motion(motion, clock) if steady is None else steady
    u, v = state.displacement - q, state.velocity - q_rate
    runs = np.zeros(1, dtype=STATE)
    regime = int(state.regime)
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    rounding, known = tip_rounding(motion, u, v), TOUCHES[motion.law].REGIMES
    near = HELD_WITHIN * rounding
    if regime not in known:
        raise InvalidValue(
            f"regime of the state is {regime}; with this contact law it must be one of {known}"
        )
    if regime != OUTSIDE and (height < -near or (height > near and regime in (SUSTAINED, WAITING))):
        raise InvalidValue(
            f"regime of the state is {regime}, but the tip is {height:.3g} m past the stop; it must be at "
            "the gap, in contact at the gap or beyond"
        )
    if regime == OUTSIDE and height > rounding:
        if Regime.CONTACT not in known:
            raise InvalidValue(
                f"displacement of the state puts the tip {height:.3g} m behind the stop; with an impact law "
                "it must start on the near side"
            )
        pushes = Regime.INSIDE not in known or force(motion, height, velocity) > 0.0
        regime = Regime.CONTACT if pushes else Regime.INSIDE
    runs[0] = (regime, 0, period, 0, search, 0, clock, state.wait, state.rebound, -1.0, -1.0)
    return u, v, runs


def state_of(motion: Motion, runs: np.ndarray, displacement: np.ndarray, velocity: np.ndarray) -> State:
    """The state where a run stands."""
    run = runs[0]
    return State(
        displacement=displacement,
        velocity=velocity,
        time=int(run["period"]) * motion.period + run["clock"],
        regime=int(run["regime"]),
        wait=float(run["wait"]),
        rebound=float(run["rebound"]),
    )


def failure(status: int, motion: Motion, runs: np.ndarray, u: np.ndarray, v: np.ndarray) -> ContactError:
    """The error that belongs to a status of `advance`."""
    clock = float(runs[0]["clock"])
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    error, detail = FAILURES[status]
    time = int(runs[0]["period"]) * motion.period + clock
    return error(time=time, gap=-height, velocity=velocity, detail=detail)


def exact_trajectory(oscillator: ImpactOscillator, run: Run, *, search: int = 0) -> Trajectory:
    """The motion of `run`, followed event by event.

    Crossings of the stop are proved (`search` 0) or looked for at `search` instants of each drive period.

    Raises
    ------
    ValueError
        If the start does not fit the model or lies behind the stop of an impact law.
    UnresolvedCrossing, Chatter, ContactTooStiff
        Where the motion could not be followed; see ``contact.errors``.
    """
    motion, n = oscillator.motion(), oscillator.n_modes
    u, v, runs = start_of(motion, run.start, run.first, run.clock, search=search)
    recorder = recorder_for(run, n)
    if runs[0]["regime"] != OUTSIDE:
        kind = ImpactKind.STAY if runs[0]["regime"] == SUSTAINED else ImpactKind.UNDER_WAY
        open_touch(recorder, run.first, run.clock, np.nan, int(kind), u, v)
        recorder.marks["impacts"] = 0  # it did not begin in this period
    while True:
        status = advance(motion, u, v, runs, run.last, run.clock_end, recorder)
        if status != LOG_FULL:
            break
        recorder = grown(recorder)
    if status != DONE:
        raise failure(status, motion, runs, u, v)
    q, q_rate = steady_motion(motion, run.clock_end)
    end = state_of(motion, runs, u + q, v + q_rate)
    evaluations = int(runs[0]["evaluations"])
    return trajectory_of(recorder, run, end, oscillator, evaluations=evaluations, deviations=True)
