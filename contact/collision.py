"""Collisions: impacts grouped as the single-mode description sees them.

The letter (1996) describes a spring with many modes by one mode, a restitution tau and a time delay.  Its
virtual motion is the steady forced tip motion plus the free deviation of mode 1, the wall ignored:

    y(t) = x_s(t) + phi_1 u_1(t) - gap

Mode 1 is the mode that carries most of a static force on the tip (``ModalModel.leading_mode``).  The incoming
virtual motion is that before a collision, the outgoing one that after it; the free flow of mode 1 continues
each both ways.  A collision holds all impacts from a first touch until the next minimum of the outgoing
virtual motion, and is final when that minimum has passed.  With

    t_in, v_in   upward crossing of the gap by the incoming virtual motion, next to the first impact
    t_out        first downward crossing of the gap by the outgoing virtual motion, after its peak

    restitution = -(velocity at t_out) / v_in,   delay = t_out - t_in,
    kick = -(jump of the mode-1 tip velocity) / v_in,   shift = jump of the mode-1 tip displacement,

both jumps referred to t_in by the free flow of mode 1.  To leading order in v_in, with a the deceleration of
the tip,

    restitution^2 = (1 - kick)^2 + 2 a shift / v_in^2,   delay = (v_in / a)(1 + restitution - kick).

If the incoming peak stays below the gap, the ringing of higher modes made the touch (`forced_by_ringing`).
Restitution and delay do not exist then, and the kick is given as a velocity.  If the outgoing motion never
reaches the gap, restitution and delay do not exist either, but the kick does.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from beam.parameters import InvalidValue, require, require_kind, require_whole
from contact.flight.modal_flow import free_flow, propagate, steady_motion
from contact.flight.numbers import INVERSE_OMEGA, LOAD, Numbers, with_only_mode
from contact.flight.tip import tip_rounding
from contact.impacts import Impacts
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.simulation import simulate
from contact.trajectory import ImpactKind, State, Trajectory
from contact.virtual_motion import VirtualMotion


@dataclass(frozen=True, kw_only=True)
class Collision:
    """One approach of the tip to the stop, as mode 1 feels it.

    Parameters
    ----------
    time, end : float
        t_in, or the first touch if `forced_by_ringing`; last release of the tip [s].
    approach : float
        v_in; NaN if `forced_by_ringing` [m/s].
    restitution, delay : float
        The letter's tau [1], and t_out - t_in [s]; NaN where they do not exist.
    kick, kick_velocity : float
        Kick of the mode-1 tip velocity over v_in, NaN if `forced_by_ringing` [1]; and this kick itself,
        positive away from the stop [m/s].
    shift : float
        Jump of the mode-1 tip displacement at t_in [m].
    deceleration : float
        a, minus the second derivative of the incoming virtual motion at t_in [m/s^2].
    impacts, contact_time : int, float
        Touches in the collision, and their total time [s].
    first_touch, real_approach : float
        Time [s] and true tip velocity [m/s] of the first touch.
    ringing : float
        Amplitude of the free motion of the higher modes at the tip before the collision [m].
    energy_to_higher_modes, energy_lost : float
        Gain of the free motion of all modes but mode 1, and loss in the contact itself [J].
    impulse, peak_force : float
        Impulse of the stop over all touches [N s], and the largest contact force [N]; the force is NaN under
        a law that acts at once.
    forced_by_ringing, returns : bool
        The virtual motion alone would not have touched; the outgoing virtual motion reaches the gap.
    """

    time: float
    end: float
    approach: float
    restitution: float
    delay: float
    kick: float
    kick_velocity: float
    shift: float
    deceleration: float
    impacts: int
    contact_time: float
    first_touch: float
    real_approach: float
    ringing: float
    energy_to_higher_modes: float
    energy_lost: float
    impulse: float
    peak_force: float
    forced_by_ringing: bool
    returns: bool


def _higher_energy(numbers: Numbers, k: int, u: np.ndarray, v: np.ndarray) -> float:
    """Energy of the free motion of all modes but mode 1, which is number `k` [J]."""
    return float(0.5 * np.sum(np.delete(v, k) ** 2 + np.delete(numbers.omega * u, k) ** 2))


def collisions(trajectory: Trajectory, *, unfinished: str = "refuse") -> list[Collision]:
    """Group the impacts of a trajectory into collisions, in the order of time.

    A collision that had begun before the trajectory is left out.  ValueError is raised for an unfinished last
    collision, unless it may be dropped.

    Parameters
    ----------
    trajectory : Trajectory
    unfinished : {"refuse", "drop"}
        What to do with a last collision that is not final when the trajectory ends.
    """
    trajectory = require_kind("trajectory", trajectory, Trajectory, "a Trajectory, from simulate")
    oscillator, impacts = trajectory.oscillator, trajectory.impacts
    numbers, k = oscillator.numbers(), oscillator.model.leading_mode
    single = with_only_mode(numbers, k)
    words = "load drives a higher mode of zero frequency; for a virtual motion it must be zero there"
    require(not np.delete(numbers.row(LOAD), k).any(), words)
    require(unfinished in ("refuse", "drop"), f'unfinished is {unfinished!r}; it must be "refuse" or "drop"')
    rows = np.flatnonzero(impacts.kind != ImpactKind.GRAZE).tolist()
    stays, found = impacts.kind == ImpactKind.STAY, list[Collision]()
    while rows:
        first = last = rows.pop(0)
        outgoing, minimum = _outgoing(single, k, impacts, last)
        while rows and (stays[rows[0]] or -_length(numbers, impacts, rows[0], last) < minimum):
            last = rows.pop(0)
            outgoing, minimum = _outgoing(single, k, impacts, last)
        under_way = stays[first] or math.isnan(impacts.approach[first])  # when the run began
        if not impacts.end[last] + minimum <= trajectory.end.time:
            if unfinished == "drop" or under_way:
                break
            given = f"{trajectory.end.time:.6g} s, before the collision that began at"
            words = f"{impacts.start[first]:.6g} s is final; run it about one drive period longer"
            raise InvalidValue(f"trajectory ends at {given} {words}")
        if not under_way:
            found.append(_measure(numbers, k, impacts, slice(first, last + 1), outgoing))
    return found


def _length(numbers: Numbers, impacts: Impacts, first: Any, last: Any) -> Any:
    """Time from the start of one touch to the release of another, to rounding in a run of any length [s]."""
    stretches = impacts.stretch[last] - impacts.stretch[first]
    return stretches * numbers.period + (impacts.end_clock[last] - impacts.clock[first])


def _outgoing(single: Numbers, k: int, impacts: Impacts, last: int) -> tuple[VirtualMotion, float]:
    """The virtual motion after an impact, and the time from there to its next minimum [s].

    The time is infinite if the contact has not ended or no minimum comes within two drive periods.
    """
    clock = math.fmod(impacts.end_clock[last], single.period)
    virtual = VirtualMotion(single, clock, *impacts.deviations_end[last, :, k])
    minima = virtual.extrema(0.0, 2.0 * single.period, -1.0) if math.isfinite(clock) else []
    return virtual, minima[0] if minima else math.inf


def _measure(numbers: Numbers, k: int, impacts: Impacts, rows: slice, outgoing: VirtualMotion) -> Collision:
    """The numbers of the collision of these impacts."""
    first, last, single = rows.start, rows.stop - 1, outgoing.numbers
    touch, length = float(impacts.start[first]), float(_length(numbers, impacts, first, last))
    (u_in, v_in), (u_out, v_out) = impacts.deviations_start[first], impacts.deviations_end[last]
    incoming = VirtualMotion(single, float(impacts.clock[first]), u_in[k], v_in[k])

    # the hump of the incoming virtual motion that belongs to the touch
    peak, (height, rate, _) = incoming.peak_near(0.0), incoming.at(0.0)
    # a virtual motion that makes the touch itself crosses the gap there, though another peak may be nearer
    itself = rate > 0.0 and abs(height) <= 2.0 * tip_rounding(single, incoming.u, incoming.v)
    forced = not itself and (math.isnan(peak) or not incoming.at(peak)[0] > 0.0)
    s_in = 0.0 if forced or itself else incoming.crossing(peak, -1.0)
    speed = math.nan if forced else incoming.at(s_in)[1]

    # jump of mode 1 over the collision, carried back to t_in
    u_free, v_free, back = np.empty_like(u_in), np.empty_like(v_in), s_in - length
    propagate(numbers, u_in, v_in, length, u_free, v_free)
    jump = np.array([outgoing.u[0] - u_free[k], outgoing.v[0] - v_free[k]])
    shift, change = single.tip(free_flow(single, back) @ jump).tolist()

    # the outgoing hump around t_in, and its fall through the gap
    peak = outgoing.peak_near(back)
    rounding = tip_rounding(single, outgoing.u, outgoing.v)
    returns = not math.isnan(peak) and outgoing.at(peak)[0] >= -rounding
    restitution = delay = math.nan
    if returns and not forced:
        s_out = peak if outgoing.at(peak)[0] <= rounding else outgoing.crossing(peak, 1.0)
        restitution, delay = -outgoing.at(s_out)[1] / speed, s_out - back

    force = float(np.fmax.reduce(impacts.peak_force[rows]))
    gained = _higher_energy(numbers, k, u_out, v_out) - _higher_energy(numbers, k, u_free, v_free)
    amplitudes = np.hypot(u_in, v_in * numbers.row(INVERSE_OMEGA))  # of zero frequency, the displacement
    amplitudes[k] = 0.0
    return Collision(
        time=touch + s_in,
        end=float(impacts.end[last]),
        approach=speed,
        restitution=restitution,
        delay=delay,
        kick=-change / speed,
        kick_velocity=-change,
        shift=shift,
        deceleration=-incoming.at(s_in)[2],
        impacts=int(np.count_nonzero(impacts.kind[rows] == ImpactKind.IMPACT)),
        contact_time=float(np.sum(_length(numbers, impacts, rows, rows))),
        first_touch=touch,
        real_approach=float(impacts.approach[first]),
        ringing=numbers.most_at_tip(amplitudes),
        energy_to_higher_modes=gained,
        energy_lost=float(np.sum(impacts.loss[rows])),
        impulse=float(np.sum(impacts.impulse[rows])),
        peak_force=math.nan if np.isnan(force) else force,  # one object, so that equal collisions are equal
        forced_by_ringing=forced,
        returns=returns,
    )


def first_collision(
    oscillator: ImpactOscillator, state: State | None = None, *, periods: int = 64
) -> Collision:
    """The first collision of an `oscillator` from `state`, or from the steady motion (`before_collision`).

    Started from the steady motion at an excess above zero, this is the collision that ends the p1 orbit, with
    all higher modes at their steady amplitude: the cleanest measure of restitution, delay and kick.

    ValueError is raised unless the tip touches the stop, and the collision is final, within `periods` drive
    periods.
    """
    periods = require_whole("periods", periods, "drive periods")
    start = before_collision(oscillator) if state is None else state
    for length in sorted({min(3, periods), periods}):
        trajectory = simulate(oscillator, start, periods=length)
        found = collisions(trajectory, unfinished="drop")
        if found:
            return found[0]
    raise InvalidValue(f"periods is {periods}; no collision was final within them")


def before_collision(oscillator: ImpactOscillator) -> State:
    """The steady motion of a driven `oscillator`, where the tip is lowest in the first drive period."""
    require_one_stop(oscillator, "a collision")
    _ = oscillator.mean_height  # refuses an oscillator without a steady motion
    numbers = oscillator.numbers()
    lowest = math.atan2(-numbers.tip_sine, -numbers.tip_cosine) % (2 * math.pi) / numbers.drive
    q, q_rate = steady_motion(numbers, lowest)
    return State(displacement=q, velocity=q_rate, time=lowest)
