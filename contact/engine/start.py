"""A run of the exact motion: its start, the call of the event loop, and its errors."""

from dataclasses import replace

import numpy as np

from beam.parameters import InvalidValue, require
from contact import touch
from contact.engine import contacts
from contact.engine import event_loop as loop
from contact.engine.plan import Plan
from contact.engine.recorder import grown, recorder_for, trajectory_of
from contact.errors import Chatter, ContactError, ContactTooStiff, TouchedAtOnce, UnresolvedCrossing
from contact.flight.elementary import EPS
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import LOAD, Numbers, views_of
from contact.flight.sampled_crossing import Samples
from contact.flight.tip import tip_rounding, tip_state
from contact.oscillator import ImpactOscillator
from contact.state import INSIDE, OUTSIDE, SUSTAINED, WAITING, ImpactKind, Regime, State
from contact.touch import LAWS, force, strike
from contact.touch.passage import STATE, open_touch
from contact.touch.sets import new_sets
from contact.trajectory import Trajectory

HELD_WITHIN = 1e3  # largest distance from the gap of a tip that rests on the wall, in rounding bounds
FAST = 1e300  # a rate at which any dashpot pulls more than a spring pushes [m/s]

FAILURES: dict[int, tuple[type[ContactError], str]] = {
    contacts.FAILED_CROSSING: (UnresolvedCrossing, ""),
    contacts.FAILED_CHATTER: (Chatter, f"more than {loop.MOST_IMPACTS} in one drive period"),
    contacts.FAILED_STEPS: (ContactTooStiff, f"more than {contacts.MOST_STEPS} steps in one drive period"),
    contacts.FAILED_SECOND: (TouchedAtOnce, ""),
    contacts.FAILED_SERIES: (ContactTooStiff, "its power series gives no step of finite length above zero"),
}
"""The error for each failure status of `advance`, and its detail."""


def first_motion(numbers: Numbers, clock: float, u: np.ndarray, v: np.ndarray) -> tuple[int, bool]:
    """How a tip on the stop begins to move if the stop does not act on it.

    Returns the order of the first derivative of the tip displacement that is not zero within rounding, 1 for
    its velocity, 2 and 3, and whether it leads away from the stop; 4 if no such derivative is known.
    """
    w, square, decay, load = numbers.drive, numbers.omega**2, numbers.decay, numbers.row(LOAD)
    drive = np.sin(w * clock) * numbers.tip_sine + np.cos(w * clock) * numbers.tip_cosine
    turned = np.cos(w * clock) * numbers.tip_sine - np.sin(w * clock) * numbers.tip_cosine
    size = abs(numbers.tip_sine) + abs(numbers.tip_cosine)
    low, high, low_size, high_size = u, v, np.abs(u), np.abs(v)  # modes: two successive derivatives, bounds
    for order, steady in enumerate((w * turned, -(w**2) * drive, -(w**3) * turned), start=1):
        value = steady + numbers.tip(high)
        if abs(value) > 4.0 * EPS * (w**order * size + numbers.most_at_tip(high_size)):
            return order, bool(value < 0.0)
        low, high = high, load - decay * high - square * low
        low_size, high_size = high_size, np.abs(load) + decay * high_size + square * low_size
        load = np.zeros_like(load)  # it is constant
    return 4, False


def start_of(
    numbers: Numbers,
    state: State,
    stretch: int,
    clock: float,
    *,
    steady: tuple[np.ndarray, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Deviations (u, v) of `state` from the steady motion, and the `STATE` of a run that starts there.

    `steady` is the steady displacement and velocity at the start, if known, each of shape (n_modes,).
    A state OUTSIDE whose tip lies on the stop within rounding finds its regime by the motion of the tip, see
    ``contact.simulation.simulate``.

    ValueError is raised if the state has another number of modes, or lies behind the stop of an impact law,
    or if its regime is unknown to the law or does not fit the position of the tip.
    """
    modes, known = state.displacement.size, LAWS[numbers.law].REGIMES
    if modes != numbers.size:
        raise InvalidValue(f"displacement of the state has {modes} modes; the model has {numbers.size}")
    q, q_rate = steady_motion(numbers, clock) if steady is None else steady
    u, v = state.displacement - q, state.velocity - q_rate
    runs = np.zeros(1, dtype=STATE)
    regime = int(state.regimes.get(state.stop, OUTSIDE))
    height, velocity, _acceleration = tip_state(numbers, clock, u, v)
    rounding = tip_rounding(numbers, u, v)
    near = HELD_WITHIN * rounding
    behind = regime == INSIDE or (regime == OUTSIDE and height > rounding)
    if behind and INSIDE in known and force(numbers, 1.0, -FAST) != 0.0:  # the force is never cut at zero
        known = tuple(each for each in known if each != INSIDE)
    if regime not in known:
        words = f"with this contact law it must be one of {known}"
        raise InvalidValue(f"regime of the state is {regime}; {words}")
    if regime != OUTSIDE and (height < -near or (height > near and regime in (SUSTAINED, WAITING))):
        words = "past the stop; it must be at the gap, in contact at the gap or beyond"
        raise InvalidValue(f"regime of the state is {regime}, but the tip is {height:.3g} m {words}")
    if regime == OUTSIDE and height > rounding:
        if Regime.CONTACT not in known:
            words = "behind the stop; with an impact law it must start on the near side"
            raise InvalidValue(f"displacement of the state puts the tip {height:.3g} m {words}")
        pushes = INSIDE not in known or force(numbers, height, velocity) > 0.0
        regime = Regime.CONTACT if pushes else INSIDE
    runs[0] = (regime, 0, state.stop, stretch, 0, 0, clock, state.wait, state.rebound, -1.0, -1.0)
    if regime == OUTSIDE and height >= -rounding:
        order, leaves = first_motion(numbers, clock, u, v)
        if leaves:
            runs[0]["contact_order"] = order
        elif order > 1:  # at order 1 the first flight meets the stop at once
            regime = SUSTAINED if SUSTAINED in known else strike(numbers, runs[0], u, v, 0.0)[0]
            runs[0]["regime"] = regime
            runs[0]["memory0"] = -1.0
    return u, v, runs


def start_of_several(
    numbers: Numbers, state: State, stretch: int, clock: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`start_of` with several stops: the `STATE` of the run, and behind it of each stop.

    TouchedAtOnce is raised if two of them act and one has a law that is followed alone.
    """
    views, regimes = views_of(numbers), state.regimes
    words = f"it must be the number of one of {len(views)} stops, from 0 on"
    require(state.stop < len(views), f"stop of the state is {state.stop} [1]; {words}")
    starts = [replace(state, regime=regimes.get(j, OUTSIDE), stop=j) for j in range(len(views))]
    found = [start_of(seen, own, stretch, clock) for seen, own in zip(views, starts, strict=True)]
    u, v, stops = *found[0][:2], np.concatenate([runs for _u, _v, runs in found])
    acting = np.flatnonzero(stops["regime"] != OUTSIDE)
    run = stops[acting[:1]] if acting.size else stops[:1].copy()
    run["contact_order"] = 1  # the first step settles the stops
    runs = np.concatenate((run, stops))
    if acting.size > 1 and not all(touch.joins(views[j]) for j in acting):
        raise failure(contacts.FAILED_SECOND, numbers, runs, u, v)
    return u, v, runs


def state_of(numbers: Numbers, runs: np.ndarray, displacement: np.ndarray, velocity: np.ndarray) -> State:
    """The state of a run as a `State`, given its modal displacement and velocity."""
    run, regimes = runs[0], runs["regime"][1:]
    return State(
        displacement=displacement,
        velocity=velocity,
        time=int(run["stretch"]) * numbers.period + run["clock"],
        regime=tuple(regimes.tolist()) if np.sum(regimes > 0) > 1 else int(run["regime"]),
        wait=float(run["wait"]),
        rebound=float(run["rebound"]),
        stop=int(run["stop"]) if run["regime"] != OUTSIDE else 0,
    )


def failure(status: int, numbers: Numbers, runs: np.ndarray, u: np.ndarray, v: np.ndarray) -> ContactError:
    """The error for a failure status of `advance`."""
    clock, stop = float(runs[0]["clock"]), int(runs[0]["stop"])
    views, (error, detail) = views_of(numbers), FAILURES[status]
    height, velocity, _acceleration = tip_state(views[stop], clock, u, v)
    if error is TouchedAtOnce:
        near = HELD_WITHIN * tip_rounding(views[stop], u, v)
        met = [str(j) for j, one in enumerate(views) if tip_state(one, clock, u, v)[0] >= -near]
        detail = f"these are stops {' and '.join(met)}"
    time = int(runs[0]["stretch"]) * numbers.period + clock
    return error(time=time, gap=-height, velocity=velocity, detail=detail)


def exact_trajectory(oscillator: ImpactOscillator, plan: Plan, samples: Samples | None = None) -> Trajectory:
    """The motion of `plan`, event by event.

    Crossings of the stop are proved, or with `samples` detected at these.
    Raises ValueError as `start_of` does, and UnresolvedCrossing, Chatter or ContactTooStiff if the motion
    cannot be followed.
    """
    numbers, n = oscillator.stacked(), oscillator.n_modes
    starts = start_of_several if len(oscillator.stops) > 1 else start_of
    u, v, runs = starts(numbers, plan.start, plan.first, plan.clock)
    recorder = recorder_for(plan, n, len(oscillator.stops))
    for each in runs[-len(oscillator.stops) :]:
        if each["regime"] != OUTSIDE:
            stays = each["regime"] == SUSTAINED
            kind, approach = (ImpactKind.STAY, 0.0) if stays else (ImpactKind.UNDER_WAY, np.nan)
            open_touch(recorder, each["stop"], plan.first, plan.clock, approach, int(kind), u, v)
    recorder.marks["impacts"] = 0  # none of them began in this period
    sets = new_sets(numbers, runs[1:]) if runs.size > 1 else None
    while True:
        status = loop.advance(numbers, u, v, runs, plan.last, plan.clock_end, recorder, samples, sets)
        if status != loop.LOG_FULL:
            break
        recorder = grown(recorder)
    if status != loop.DONE:
        raise failure(status, numbers, runs, u, v)
    q, q_rate = steady_motion(numbers, plan.clock_end)
    end = state_of(numbers, runs, u + q, v + q_rate)
    return trajectory_of(recorder, plan, end, oscillator, runs[0]["evaluations"], deviations=True)
