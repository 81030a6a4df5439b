"""Derivatives of a simulated motion with respect to its start and the numbers of its oscillator.

The variational replay (``contact.sensitivity.replay``) takes tangents of (u, v, S, C): the deviations
u = q - q_s(t, p), and the drive S = Z sin(w t), C = Z cos(w t).  The derivative of the steady motion q_s is
added again for states (q, q').  Strobes move with the drive: t = n/f.
"""

from collections.abc import Sequence

import numpy as np

from beam.parameters import Array, InvalidValue, record, require_array, require_kind
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.sensitivity.change import Change, Sensitivities
from contact.sensitivity.replay import Replay, deviation_rates_at_strobe
from contact.simulation import simulate
from contact.state import Regime, State
from contact.trajectory import Trajectory


@record
class MotionDerivatives:
    """A simulated motion with its derivatives with respect to its start and P parameters.

    The last axis of each array has first the 2 n_modes numbers (q, q') of the start, then the P parameters.
    `motion_derivatives` returns it.

    Parameters
    ----------
    trajectory : Trajectory
        The simulated motion.
    impact_time : ndarray, shape (n_impacts, 2 n_modes + P)
        Derivatives of the times at which touches begin [s].
    strobes : ndarray, shape (n_strobes, 2 n_modes, 2 n_modes + P)
        Derivatives of the states (q, q') at the strobes, which move with the drive frequency.
    states : ndarray, shape (n_times, 2 n_modes, 2 n_modes + P)
        Derivatives of the states (q, q') at the requested times, which stay fixed.
    """

    trajectory: Trajectory
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
    """Return the derivatives of a motion with respect to its start and P parameters.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The driven oscillator, with one stop.
    state : State
        State from which the motion starts, off the stop.
    changes : sequence of Change, optional
        The P parameters, each a direction in which the numbers of the oscillator change.
    periods : int
        Length of the run in drive periods.
    times : ndarray, shape (n_times,), optional
        Rising times within the run at which states are wanted [s].

    Returns
    -------
    MotionDerivatives
        The motion, and derivatives of its impact times, its strobes and its states at `times`.

    Raises
    ------
    TypeError
        If `oscillator` is no ImpactOscillator, `state` is no State, or `changes` holds anything but Change
        objects.
    ValueError
        If the state is in contact with the stop, if a change does not fit the oscillator, or for arguments
        that ``contact.simulate`` refuses.
    NoDerivative
        If the motion grazes the stop, or comes to rest on it.
    ContactError
        If the motion cannot be followed.
    """
    require_one_stop(oscillator, "derivatives")
    require_kind("state", state, State, "a State")
    if state.regime != Regime.OUTSIDE:
        raise InvalidValue(f"regime of the state is {state.regime}; it must be 0, off the stop")
    wanted = require_array("times", () if times is None else times, "s", dimensions=1, words="a rising array")
    several = Sensitivities(oscillator=oscillator, changes=changes)
    trajectory, n = simulate(oscillator, state, periods=periods, times=wanted), oscillator.n_modes
    replay = Replay(several, trajectory, state)
    replay.tangent = _tangent_of_state(several, state.time)
    times, place = np.unique([*trajectory.strobe_time, *wanted, trajectory.end.time], return_inverse=True)
    ends = [trajectory.strobe_time.size, trajectory.strobe_time.size + wanted.size]
    strobes, states, _end = np.split(replay.along(times)[place], ends)
    states[:, :, 2 * n :] += several.steady(wanted)
    strobes[:, :, 2 * n :] += several.steady(0.0)
    number = np.round(trajectory.strobe_time / oscillator.period)
    q = np.hstack([trajectory.strobe_displacement, trajectory.strobe_velocity])
    rates = deviation_rates_at_strobe(oscillator, q, False)
    for i in np.flatnonzero(replay.touching(trajectory.strobe_time)):
        rates[i] = deviation_rates_at_strobe(oscillator, q[i], True)
    strobes[:, :, 2 * n :] += np.multiply.outer(number[:, None] * rates, several.period)
    found = np.array([replay.impact_time[i] for i in range(len(trajectory.impacts))])
    impact_time = found.reshape(-1, 2 * n + len(several.changes))
    return MotionDerivatives(trajectory=trajectory, impact_time=impact_time, strobes=strobes, states=states)


def _tangent_of_state(several: Sensitivities, time: float) -> Array:
    """Derivatives of (u, v, S, C) at the start with respect to (q, q') there and the parameters."""
    n, count, drive = several.oscillator.n_modes, len(several.changes), several.oscillator.driven
    sine, cosine = np.sin(drive.angular_frequency * time), np.cos(drive.angular_frequency * time)
    tangent = np.zeros((2 * n + 2, 2 * n + count))
    tangent[: 2 * n, : 2 * n], tangent[: 2 * n, 2 * n :] = np.eye(2 * n), -several.steady(time)
    quadrature = drive.amplitude * time * several.frequency
    tangent[2 * n, 2 * n :] = several.amplitude * sine + quadrature * cosine
    tangent[2 * n + 1, 2 * n :] = several.amplitude * cosine - quadrature * sine
    return tangent
