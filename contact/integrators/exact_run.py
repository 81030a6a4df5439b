"""A run of the exact motion: the event loop called, its log turned into named arrays."""

from __future__ import annotations

import numpy as np

from contact.errors import Chatter, ContactError, ContactTooStiff, UnresolvedCrossing
from contact.flight import Motion, steady_motion, tip_rounding, tip_state
from contact.impact_log import (
    CLOCK,
    END,
    END_PERIOD,
    EVALUATIONS,
    IMPACT,
    IN,
    INTEGERS,
    KIND,
    LOG_FIELDS,
    LOGGED,
    LOST,
    OUT,
    REBOUND,
    REGIME,
    SAMPLED,
    SEARCH,
    START,
    START_PERIOD,
    WAIT,
)
from contact.integrators.event_loop import (
    DONE,
    FAILED_CHATTER,
    FAILED_STEPS,
    LOG_FULL,
    MOST_IMPACTS,
    MOST_STEPS,
    advance,
)
from contact.integrators.method import Run
from contact.laws import DELAYED, HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.series import CONTACT, INSIDE, OUTSIDE, SUSTAINED, WAITING
from contact.trajectory import Impacts, State, Trajectory

__all__ = ["deviations", "exact_trajectory", "failure"]


def deviations(
    motion: Motion, state: State, clock: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (u, v) of `state` from the steady motion, and the bookkeeping arrays of a run's start.

    Raises
    ------
    ValueError
        If the state has another number of modes, or lies behind the stop of an impact law.
    """
    if state.displacement.size != motion.omega.size:
        raise ValueError(
            f"displacement of the state has {state.displacement.size} modes; "
            f"the model has {motion.omega.size}"
        )
    q, q_rate = steady_motion(motion, np.array([clock]))
    u, v = state.displacement - q[0], state.velocity - q_rate[0]
    integers = np.zeros(INTEGERS, dtype=np.int64)
    floats = np.array([clock, 0.0, 0.0, state.wait, state.rebound])
    integers[REGIME] = state.regime
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    _refuse_regime(motion, state.regime, height, tip_rounding(motion, u, v))
    if state.regime == OUTSIDE and height > tip_rounding(motion, u, v):
        if motion.law in (NEWTON, DELAYED):
            raise ValueError(
                f"displacement of the state puts the tip {height:.3g} m behind the stop; with an impact law "
                "it must start on the near side"
            )
        integers[REGIME] = CONTACT if motion.number0 * height + motion.number1 * velocity > 0 else INSIDE
    return u, v, integers, floats


HELD_WITHIN = 1e3
"""How far from the gap a tip that is said to rest on the wall may be, in rounding bounds."""


def _refuse_regime(motion: Motion, regime: int, height: float, rounding: float) -> None:
    """ValueError for a regime that the law does not know, or that does not fit where the tip is."""
    known = {
        NEWTON: (OUTSIDE, SUSTAINED), LINEAR: (OUTSIDE, CONTACT, INSIDE), HERTZ: (OUTSIDE, CONTACT),
        DELAYED: (OUTSIDE, WAITING),
    }[motion.law]
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


def failure(
    status: int, motion: Motion, index: int, floats: np.ndarray, u: np.ndarray, v: np.ndarray
) -> ContactError:
    """The error that belongs to a status of `advance`."""
    height, velocity, _acceleration = tip_state(motion, floats[CLOCK], u, v)
    place = {"time": index * motion.period + floats[CLOCK], "gap": -height, "velocity": velocity}
    if status == FAILED_CHATTER:
        error = Chatter(**place, detail=f"more than {MOST_IMPACTS} in one drive period")
        q, q_rate = steady_motion(motion, floats[:1])
        error.displacement, error.velocities = u + q[0], v + q_rate[0]
        return error
    if status == FAILED_STEPS:
        return ContactTooStiff(**place, detail=f"more than {MOST_STEPS} steps in one drive period")
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
    first, clock, last, clock_end = run.first, run.clock, run.last, run.clock_end
    u, v, integers, floats = deviations(motion, run.start, clock)
    integers[SEARCH] = search
    _height, velocity, _acceleration = tip_state(motion, clock, u, v)
    capacity = 64
    log, log_state = np.empty((capacity, LOG_FIELDS)), np.empty((capacity, 4 * n))
    if integers[REGIME] != OUTSIDE:
        log[0] = [first, clock, first, np.nan, velocity, np.nan, np.nan, IMPACT]
        log_state[0] = np.concatenate([u, v, np.full(2 * n, np.nan)])
        integers[LOGGED] = 1
    strobes, counts = np.empty((last - first, 2 * n)), np.zeros(last - first, dtype=np.int64)
    samples = np.empty((run.times.size, 2 * n))
    index = first
    while True:
        done = index - first
        status, index = advance(
            motion, u, v, integers, floats, index, last - index, clock_end, strobes[done:], counts[done:],
            log, log_state, run.sample_period, run.sample_clock, samples,
        )
        if status != LOG_FULL:
            break
        log, log_state = (
            np.concatenate([log, np.empty_like(log)]),
            np.concatenate([log_state, np.empty_like(log_state)]),
        )
    if status != DONE:
        raise failure(status, motion, index, floats, u, v)

    samples[integers[SAMPLED] :] = np.concatenate([u, v])  # times at the very end of the run
    logged = int(integers[LOGGED])
    log, log_state = log[:logged], log_state[:logged]
    start_clock, end_clock = log[:, START], log[:, END]
    q_in, v_in = steady_motion(motion, start_clock)
    q_out, v_out = steady_motion(motion, end_clock)
    impacts = Impacts(
        start=log[:, START_PERIOD] * motion.period + start_clock,
        end=log[:, END_PERIOD] * motion.period + end_clock,
        approach=log[:, IN].copy(),
        rebound=log[:, OUT].copy(),
        loss=log[:, LOST].copy(),
        kind=log[:, KIND].astype(np.int64),
        displacement_start=log_state[:, :n] + q_in,
        velocity_start=log_state[:, n : 2 * n] + v_in,
        displacement_end=log_state[:, 2 * n : 3 * n] + q_out,
        velocity_end=log_state[:, 3 * n :] + v_out,
    )
    q_strobe, v_strobe = steady_motion(motion, np.zeros(last - first))
    q_sample, v_sample = steady_motion(motion, run.sample_clock)
    q_end, v_end = steady_motion(motion, np.array([clock_end]))
    return Trajectory(
        end=State(
            displacement=u + q_end[0], velocity=v + v_end[0], time=last * motion.period + clock_end,
            regime=int(integers[REGIME]), wait=float(floats[WAIT]), rebound=float(floats[REBOUND]),
        ),
        strobe_time=np.arange(first + 1, last + 1) * motion.period,
        strobe_displacement=strobes[:, :n] + q_strobe,
        strobe_velocity=strobes[:, n:] + v_strobe,
        strobe_impacts=counts,
        time=run.times,
        displacement=samples[:, :n] + q_sample,
        velocity=samples[:, n:] + v_sample,
        impacts=impacts,
        evaluations=int(integers[EVALUATIONS]),
    )
