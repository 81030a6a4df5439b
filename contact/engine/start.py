"""A run of the exact motion: its start, the call of the event loop, and its errors."""

import numpy as np

from beam.parameters import InvalidValue
from contact.engine import event_loop as loop
from contact.engine.recorder import grown, recorder_for, trajectory_of
from contact.errors import Chatter, ContactError, ContactTooStiff, UnresolvedCrossing
from contact.flight.modal_flow import steady_motion, tip_rounding, tip_state
from contact.flight.motion import Motion
from contact.flight.sampled_crossing import Samples
from contact.oscillator import ImpactOscillator
from contact.touch import TOUCHES, force
from contact.touch.passage import STATE, open_touch
from contact.trajectory import OUTSIDE, SUSTAINED, WAITING, ImpactKind, Regime, Run, State, Trajectory

HELD_WITHIN = 1e3  # largest distance from the gap of a tip that rests on the wall, in rounding bounds

FAILURES: dict[int, tuple[type[ContactError], str]] = {
    loop.FAILED_CROSSING: (UnresolvedCrossing, ""),
    loop.FAILED_CHATTER: (Chatter, f"more than {loop.MOST_IMPACTS} in one drive period"),
    loop.FAILED_STEPS: (ContactTooStiff, f"more than {loop.MOST_STEPS} steps in one drive period"),
    loop.FAILED_SERIES: (ContactTooStiff, "its power series gives no step of finite length above zero"),
}
"""The error for each failure status of `advance`, and its detail."""


def start_of(
    motion: Motion,
    state: State,
    period: int,
    clock: float,
    *,
    steady: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (u, v) of `state` from the steady motion, and the `STATE` of a run that starts there.

    `steady` is the steady displacement and velocity at the start, if known, each of shape (n_modes,).
    ValueError is raised if the state has another number of modes, or lies behind the stop of an impact law,
    or if its regime is unknown to the law or does not fit the position of the tip.
    """
    modes, known = state.displacement.size, TOUCHES[motion.law].REGIMES
    if modes != motion.size:
        raise InvalidValue(f"displacement of the state has {modes} modes; the model has {motion.size}")
    q, q_rate = steady_motion(motion, clock) if steady is None else steady
    u, v = state.displacement - q, state.velocity - q_rate
    runs = np.zeros(1, dtype=STATE)
    regime = int(state.regime)
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    rounding = tip_rounding(motion, u, v)
    near = HELD_WITHIN * rounding
    if regime not in known:
        words = f"with this contact law it must be one of {known}"
        raise InvalidValue(f"regime of the state is {regime}; {words}")
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
    runs[0] = (regime, 0, period, 0, 0, clock, state.wait, state.rebound, -1.0, -1.0)
    return u, v, runs


def state_of(motion: Motion, runs: np.ndarray, displacement: np.ndarray, velocity: np.ndarray) -> State:
    """The state of a run as a `State`, given its modal displacement and velocity."""
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
    """The error for a failure status of `advance`."""
    clock = float(runs[0]["clock"])
    height, velocity, _acceleration = tip_state(motion, clock, u, v)
    error, detail = FAILURES[status]
    time = int(runs[0]["period"]) * motion.period + clock
    return error(time=time, gap=-height, velocity=velocity, detail=detail)


def exact_trajectory(oscillator: ImpactOscillator, run: Run, samples: Samples | None = None) -> Trajectory:
    """The motion of `run`, event by event.

    Crossings of the stop are proved, or with `samples` detected at these.
    Raises ValueError as `start_of` does, and UnresolvedCrossing, Chatter or ContactTooStiff if the motion
    cannot be followed.
    """
    motion, n = oscillator.motion(), oscillator.n_modes
    u, v, runs = start_of(motion, run.start, run.first, run.clock)
    recorder = recorder_for(run, n)
    if runs[0]["regime"] != OUTSIDE:
        kind = ImpactKind.STAY if runs[0]["regime"] == SUSTAINED else ImpactKind.UNDER_WAY
        open_touch(recorder, run.first, run.clock, np.nan, int(kind), u, v)
        recorder.marks["impacts"] = 0  # it did not begin in this period
    while True:
        status = loop.advance(motion, u, v, runs, run.last, run.clock_end, recorder, samples)
        if status != loop.LOG_FULL:
            break
        recorder = grown(recorder)
    if status != loop.DONE:
        raise failure(status, motion, runs, u, v)
    q, q_rate = steady_motion(motion, run.clock_end)
    end = state_of(motion, runs, u + q, v + q_rate)
    evaluations = int(runs[0]["evaluations"])
    return trajectory_of(recorder, run, end, oscillator, evaluations=evaluations, deviations=True)
