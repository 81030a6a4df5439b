"""A run of the exact motion: where it may start, the event loop called, and how it fails."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.errors import Chatter, ContactError, ContactTooStiff, UnresolvedCrossing
from contact.event_loop import (
    DONE,
    FAILED_CHATTER,
    FAILED_SERIES,
    FAILED_STEPS,
    LOG_FULL,
    MOST_IMPACTS,
    MOST_STEPS,
    STATE,
    advance,
)
from contact.flight.modal_flow import steady_motion, tip_rounding, tip_state
from contact.flight.motion import Motion
from contact.oscillator import ImpactOscillator
from contact.recorder import grown, open_touch, recorder_for, trajectory_of
from contact.touch import TOUCHES, force
from contact.trajectory import CONTACT, IMPACT, INSIDE, OUTSIDE, SUSTAINED, WAITING, Run, State, Trajectory

__all__ = ["exact_trajectory", "failure", "start_of", "state_of"]

HELD_WITHIN = 1e3
"""How far from the gap a tip that is said to rest on the wall may be, in rounding bounds."""


def start_of(
    motion: Motion, state: State, period: int, clock: float, *, search: int = 0,
    steady: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Deviations (u, v) of `state` from the steady motion, and a run (`STATE`) that starts there.

    `steady` is the steady displacement and velocity at the start, if they are known, each (n_modes,).

    Raises
    ------
    ValueError
        If the state has another number of modes, or lies behind the stop of an impact law.
    """
    if state.displacement.size != motion.size:
        raise ValueError(
            f"displacement of the state has {state.displacement.size} modes; the model has {motion.size}"
        )
    if steady is None:
        steady = tuple(x[0] for x in steady_motion(motion, np.array([clock])))
    u, v = state.displacement - steady[0], state.velocity - steady[1]
    runs = np.zeros(1, dtype=STATE)
    regime = int(state.regime)
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    rounding = tip_rounding(motion, u, v)
    _refuse_regime(motion, regime, height, rounding)
    if regime == OUTSIDE and height > rounding:
        known = TOUCHES[motion.law].REGIMES
        if CONTACT not in known:
            raise ValueError(
                f"displacement of the state puts the tip {height:.3g} m behind the stop; with an impact law "
                "it must start on the near side"
            )
        pushes = INSIDE not in known or force(motion, height, velocity) > 0.0
        regime = CONTACT if pushes else INSIDE
    runs[0] = (regime, 0, period, 0, search, 0, clock, state.wait, state.rebound, -1.0, -1.0)
    return u, v, runs


def state_of(motion: Motion, runs: np.ndarray, displacement: np.ndarray, velocity: np.ndarray) -> State:
    """The state where a run stands."""
    run = runs[0]
    return State(
        displacement=displacement, velocity=velocity, time=int(run["period"]) * motion.period + run["clock"],
        regime=int(run["regime"]), wait=float(run["wait"]), rebound=float(run["rebound"]),
    )  # fmt: skip


def _refuse_regime(motion: Motion, regime: int, height: float, rounding: float) -> None:
    """ValueError for a regime that the law does not know, or that does not fit where the tip is."""
    known = TOUCHES[motion.law].REGIMES
    if regime not in known:
        raise ValueError(f"regime of the state is {regime}; with this contact law it must be one of {known}")
    if regime in (SUSTAINED, WAITING) and abs(height) > HELD_WITHIN * rounding:
        raise ValueError(
            f"regime of the state is {regime}, held on the stop, but the tip is {abs(height):.3g} m away "
            "from it; it must be at the gap"
        )
    if regime in (CONTACT, INSIDE) and height < -HELD_WITHIN * rounding:
        raise ValueError(
            f"regime of the state is {regime}, behind the stop, but the tip is {-height:.3g} m before it; it "
            "must be at the gap or beyond"
        )


def failure(status: int, motion: Motion, runs: np.ndarray, u: np.ndarray, v: np.ndarray) -> ContactError:
    """The error that belongs to a status of `advance`."""
    run = runs[0]
    clock = float(run["clock"])
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    place: dict[str, Any] = {
        "time": int(run["period"]) * motion.period + clock, "gap": -height, "velocity": velocity
    }  # fmt: skip
    if status == FAILED_CHATTER:
        return Chatter(**place, detail=f"more than {MOST_IMPACTS} in one drive period")
    if status == FAILED_STEPS:
        return ContactTooStiff(**place, detail=f"more than {MOST_STEPS} steps in one drive period")
    if status == FAILED_SERIES:
        return ContactTooStiff(**place, detail="its power series gives no step of finite length above zero")
    return UnresolvedCrossing(**place)


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
        velocity = tip_state(motion, run.clock, u, v)[1]
        open_touch(recorder, run.first, run.clock, velocity, IMPACT, u, v)
        recorder.marks["impacts"] = 0  # it did not begin in this period
    while True:
        status = advance(motion, u, v, runs, run.last, run.clock_end, recorder)
        if status != LOG_FULL:
            break
        recorder = grown(recorder)
    if status != DONE:
        raise failure(status, motion, runs, u, v)
    q, q_rate = steady_motion(motion, np.array([run.clock_end]))
    end = state_of(motion, runs, u + q[0], v + q_rate[0])
    evaluations = int(runs[0]["evaluations"])
    return trajectory_of(recorder, run, end, motion.period, evaluations=evaluations, motion=motion)
