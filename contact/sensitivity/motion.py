"""How a simulated motion depends on its start and on the numbers of its oscillator.

The tangents of (u, v, S, C) are carried from touch to touch (``contact.sensitivity.replay``).  They start
from those of the deviations, u = q - q_s(t, p), and of the drive, S = Z sin(w t), C = Z cos(w t); where the
state is asked for, the steady motion's own change is added again.  Strobes move with the drive: t = n/f.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam.parameters import InvalidValue, require_array, require_kind
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Change, Changes
from contact.sensitivity.replay import Retraced, pace_of_deviations
from contact.simulation import simulate
from contact.trajectory import Regime, State, Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionDerivatives:
    """A simulated motion and its derivatives with respect to its start (q, q') and P parameters.

    Parameters
    ----------
    run : Trajectory
        The motion.
    impact_time : ndarray, shape (n_impacts, 2 n_modes + P)
        Those of the times at which its touches begin [s].
    strobes : ndarray, shape (n_strobes, 2 n_modes, 2 n_modes + P)
        Those of the states (q, q') at the strobes.
    states : ndarray, shape (n_times, 2 n_modes, 2 n_modes + P)
        Those of the states at the times that were asked for, which stay as they are.
    """

    run: Trajectory
    impact_time: Array
    strobes: Array
    states: Array


def motion_derivatives(
    oscillator: ImpactOscillator,
    state: State,
    changes: Sequence[Change] = (),
    *,
    periods: int,
    times: Array | None = None,
) -> MotionDerivatives:
    """How a motion from `state` depends on that state and on the numbers of the oscillator.

    Parameters
    ----------
    oscillator : ImpactOscillator
        A driven one.
    state : State
        Off the stop.
    changes : sequence of Change
    periods : int
        Length of the run in drive periods.
    times : array_like, optional
        Rising times within the run at which states are wanted [s].

    Raises
    ------
    ValueError
        If the state is in touch with the stop, and as ``contact.simulate`` does.
    NoDerivative
        If the motion grazes the stop, or comes to rest on it.
    """
    require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    require_kind("state", state, State, "a State")
    if state.regime != Regime.OUTSIDE:
        raise InvalidValue(f"regime of the state is {int(state.regime)}; it must be 0, off the stop")
    wanted = require_array("times", () if times is None else times, "s", dimensions=1, words="a rising array")
    several = Changes(oscillator=oscillator, changes=changes)
    run, n = simulate(oscillator, state, periods=periods, times=wanted), oscillator.n_modes
    count = len(several.changes)
    amplitude, w = oscillator.driven.amplitude, oscillator.driven.angular_frequency
    sine, cosine = np.sin(w * state.time), np.cos(w * state.time)
    tangent = np.zeros((2 * n + 2, 2 * n + count))
    tangent[: 2 * n, : 2 * n], tangent[: 2 * n, 2 * n :] = np.eye(2 * n), -several.steady(state.time)
    turned = amplitude * state.time * several.pace
    tangent[2 * n, 2 * n :] = several.amplitude * sine + turned * cosine
    tangent[2 * n + 1, 2 * n :] = several.amplitude * cosine - turned * sine

    traced = Retraced(several, run, state)
    traced.tangent = tangent

    times, place = np.unique([*run.strobe_time, *wanted, run.end.time], return_inverse=True)
    ends = [run.strobe_time.size, run.strobe_time.size + wanted.size]
    strobes, states, _end = np.split(traced.along(times)[place], ends)
    states[:, :, 2 * n :] += several.steady(wanted)
    strobes[:, :, 2 * n :] += several.steady(0.0)
    q = np.hstack([run.strobe_displacement, run.strobe_velocity])
    pace = pace_of_deviations(oscillator, q, False)
    for i in np.flatnonzero(traced.touching(run.strobe_time)):
        pace[i] = pace_of_deviations(oscillator, q[i], True)
    number = np.round(run.strobe_time / oscillator.period)
    strobes[:, :, 2 * n :] += np.multiply.outer(number[:, None] * pace, several.of_period)
    late = np.array([traced.late[i] for i in range(len(run.impacts))]).reshape(-1, 2 * n + count)
    return MotionDerivatives(run=run, impact_time=late, strobes=strobes, states=states)
