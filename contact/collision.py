"""Collisions: impacts grouped as the single-mode description sees them.

The letter (1996) describes a spring with many modes by one mode, a restitution tau and a time delay.  Its
virtual motion is the steady forced tip motion plus the free deviation of mode 1, the wall ignored:

    y(t) = x_s(t) + phi_1 u_1(t) - gap

Before a collision this is the incoming virtual motion, after it the outgoing one; each is continued both ways
by the free flow of mode 1.  A collision holds all impacts from a first touch until the next minimum of the
outgoing virtual motion, and is final when that minimum has passed.  With

    t_in, v_in   upward crossing of the gap by the incoming virtual motion, next to the first impact
    t_out        first downward crossing of the gap by the outgoing one, behind its peak

    restitution = -(velocity at t_out) / v_in,   delay = t_out - t_in,
    kick = -(jump of the mode-1 tip velocity) / v_in,   shift = jump of the mode-1 tip displacement,

both jumps referred to t_in by mode 1's free flow.  To leading order in v_in, with a the deceleration of the
tip,

    restitution^2 = (1 - kick)^2 + 2 a shift / v_in^2,   delay = (v_in / a)(1 + restitution - kick).

If the incoming peak stays below the gap, the ringing of higher modes made the touch (`forced_by_ringing`):
then there is no restitution and no delay, and the kick is given as a velocity.  If the outgoing motion never
reaches the gap, restitution and delay do not exist either, but the kick does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beam.parameters import require_kind, require_whole
from contact.flight.modal_flow import propagate, steady_motion, tip_rounding
from contact.flight.motion import Motion, single_mode, without_load
from contact.flight.tip_search import tip_at
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import ImpactKind, State, Trajectory

__all__ = ["Collision", "before_collision", "collisions", "first_collision"]

REAL_AGAINST_VIRTUAL = 0.01
"""Relative difference of real and virtual approach speed beyond which a collision is flagged."""

_SAMPLES = 96
"""Samples per drive period in which the peaks and minima of the virtual motion are bracketed: it moves at
the drive frequency and that of mode 1, which is of the same order, so a bracket holds one extremum."""


@dataclass(frozen=True, kw_only=True)
class Collision:
    """One approach of the tip to the stop, as mode 1 feels it.

    Parameters
    ----------
    time : float
        t_in, or the first touch if `forced_by_ringing` [s].
    end : float
        Last release of the tip [s].
    approach : float
        v_in; NaN if `forced_by_ringing` [m/s].
    restitution : float
        The letter's tau; NaN where it does not exist [1].
    delay : float
        t_out - t_in; NaN where it does not exist [s].
    kick : float
        Kick of the mode-1 tip velocity over v_in [1]; NaN if `forced_by_ringing`.
    kick_velocity : float
        The same as a velocity, positive away from the stop [m/s].
    shift : float
        Jump of the mode-1 tip displacement at t_in [m].
    deceleration : float
        a, minus the second derivative of the incoming virtual motion at t_in [m/s^2].
    impacts : int
        Touches in the collision.
    contact_time : float
        Total time of touch [s].
    first_touch, real_approach : float
        Time [s] and true tip velocity [m/s] of the first touch.
    ringing : float
        Amplitude of the free motion of the higher modes at the tip before the collision [m].
    energy_to_higher_modes : float
        Gain of the free motion of the modes above the first [J].
    energy_lost : float
        Energy lost in the contact itself [J].
    forced_by_ringing : bool
        The virtual motion alone would not have touched.
    returns : bool
        The outgoing virtual motion reaches the gap.
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
    forced_by_ringing: bool
    returns: bool

    @property
    def real_differs(self) -> bool:
        """Whether real and virtual approach speed differ by more than 1 %."""
        return not abs(self.real_approach / self.approach - 1.0) <= REAL_AGAINST_VIRTUAL


class _Virtual:
    """The virtual motion through the mode-1 deviation (u, v) at `clock` after a strobe; times s count from
    there."""

    def __init__(self, motion: Motion, clock: float, u: float, v: float) -> None:
        self.motion, self.clock = motion, clock
        self.u, self.v = np.array([u]), np.array([v])

    def height(self, s: float) -> float:
        return float(tip_at(self.motion, self.clock, self.u, self.v, s)[0])

    def velocity(self, s: float) -> float:
        return float(tip_at(self.motion, self.clock, self.u, self.v, s)[1])

    def acceleration(self, s: float) -> float:
        return float(tip_at(self.motion, self.clock, self.u, self.v, s)[2])

    def extrema(self, low: float, high: float, sign: float) -> list[float]:
        """Times in [low, high] where the velocity goes through zero from `sign` to -`sign`."""
        count = max(2, math.ceil(_SAMPLES * (high - low) / self.motion.period))
        grid = np.linspace(low, high, count + 1)
        speed = np.array([sign * self.velocity(s) for s in grid])
        turns = np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))
        return [_root(self.velocity, grid[i], grid[i + 1]) for i in turns]


def _root(function: object, low: float, high: float) -> float:
    """A root in [low, high] to rounding (times count from the touch, so that it may lie at zero)."""
    from scipy.optimize import brentq  # slow to import

    return float(brentq(function, low, high, xtol=1e-18, rtol=8.9e-16, maxiter=300))


def _crossing(virtual: _Virtual, peak: float, direction: float) -> float:
    """The crossing of the gap next to `peak` on its rising (-1) or falling (+1) side [s]."""
    if virtual.height(peak) <= 0.0:
        return peak
    step = virtual.motion.period / _SAMPLES
    near, far = peak, peak + direction * step
    for _ in range(_SAMPLES):
        if virtual.height(far) < 0.0:
            return _root(virtual.height, min(near, far), max(near, far))
        near, far = far, far + direction * step
    return math.nan


def _higher_energy(motion: Motion, u: np.ndarray, v: np.ndarray) -> float:
    """Energy of the free motion above the first mode [J]."""
    return float(0.5 * np.sum(v[1:] ** 2 + (motion.omega[1:] * u[1:]) ** 2))


def _ringing(motion: Motion, u: np.ndarray, v: np.ndarray) -> float:
    """Amplitude of the free motion of the higher modes at the tip [m]."""
    omega = motion.omega[1:]
    oscillating = omega > 0
    amplitude = np.hypot(u[1:], np.where(oscillating, v[1:] / np.where(oscillating, omega, 1.0), 0.0))
    return float(np.sum(np.abs(motion.phi[1:]) * amplitude))


def collisions(
    oscillator: ImpactOscillator, trajectory: Trajectory, *, unfinished: str = "refuse"
) -> list[Collision]:
    """Group the impacts of a trajectory into collisions.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The one that made the trajectory; its first mode is the letter's single mode.
    trajectory : Trajectory
    unfinished : {"refuse", "drop"}
        What to do with a last collision that is not final when the trajectory ends.

    Returns
    -------
    list of Collision, in the order of time.

    Raises
    ------
    ValueError
        For an unfinished last collision, unless it may be dropped.
    """
    require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    require_kind("trajectory", trajectory, Trajectory, "a Trajectory, from simulate")
    if unfinished not in ("refuse", "drop"):
        raise ValueError(f'unfinished is {unfinished!r}; it must be "refuse" or "drop"')
    motion = oscillator.motion()
    single = single_mode(motion)
    impacts = trajectory.impacts
    rows = np.flatnonzero(impacts.kind != ImpactKind.GRAZE)
    found: list[Collision] = []
    position = 0
    while position < rows.size:
        first = last = rows[position]
        position += 1
        while True:
            if not math.isfinite(impacts.end[last]):
                minimum = math.inf
            else:
                clock = math.fmod(impacts.end[last], motion.period)
                q, q_rate = steady_motion(motion, np.array([clock]))
                outgoing = _Virtual(
                    single, clock,
                    impacts.displacement_end[last, 0] - q[0, 0], impacts.velocity_end[last, 0] - q_rate[0, 0],
                )
                minima = outgoing.extrema(0.0, 2.0 * motion.period, -1.0)
                minimum = impacts.end[last] + (minima[0] if minima else math.inf)
            if position < rows.size and impacts.start[rows[position]] < minimum:
                last = rows[position]
                position += 1
                continue
            break
        if minimum > trajectory.end.time:
            if unfinished == "drop":
                break
            raise ValueError(
                f"trajectory ends at {trajectory.end.time:.6g} s, before the collision that began at "
                f"{impacts.start[first]:.6g} s is final; run it about one drive period longer"
            )
        found.append(_measure(motion, single, trajectory, int(first), int(last), outgoing))
    return found


def _measure(
    motion: Motion, single: Motion, trajectory: Trajectory, first: int, last: int, outgoing: _Virtual
) -> Collision:
    """The numbers of the collision from impact `first` to impact `last`."""
    impacts, period = trajectory.impacts, motion.period
    touch, release = float(impacts.start[first]), float(impacts.end[last])
    clock = math.fmod(touch, period)
    q, q_rate = steady_motion(motion, np.array([clock]))
    u_in, v_in = impacts.displacement_start[first] - q[0], impacts.velocity_start[first] - q_rate[0]
    incoming = _Virtual(single, clock, u_in[0], v_in[0])

    # the hump of the incoming virtual motion that belongs to the touch
    peaks = incoming.extrema(-0.6 * period, 0.6 * period, 1.0)
    peak = min(peaks, key=abs) if peaks else math.nan
    forced = not (peaks and incoming.height(peak) > 0.0)
    s_in = 0.0 if forced else _crossing(incoming, peak, -1.0)
    speed = math.nan if forced else incoming.velocity(s_in)

    # jump of mode 1 over the collision, carried back to t_in
    u_free, v_free = np.empty_like(u_in), np.empty_like(v_in)
    propagate(motion, u_in, v_in, release - touch, u_free, v_free)
    jump = np.array([outgoing.u[0] - u_free[0]]), np.array([outgoing.v[0] - v_free[0]])
    propagate(without_load(single), jump[0], jump[1], touch + s_in - release, *jump)
    shift, kick_velocity = float(single.phi[0] * jump[0][0]), -float(single.phi[0] * jump[1][0])

    # the outgoing hump around t_in, and its fall through the gap
    back = touch + s_in - release
    peaks_out = outgoing.extrema(back - 0.6 * period, back + 0.6 * period, 1.0)
    peak_out = min(peaks_out, key=lambda s: abs(s - back)) if peaks_out else math.nan
    returns = bool(peaks_out) and outgoing.height(peak_out) >= -tip_rounding(single, outgoing.u, outgoing.v)
    restitution = delay = math.nan
    if returns and not forced:
        s_out = _crossing(outgoing, peak_out, 1.0)
        restitution, delay = -outgoing.velocity(s_out) / speed, s_out - back

    q_end, q_end_rate = steady_motion(motion, np.array([math.fmod(release, period)]))
    u_out = impacts.displacement_end[last] - q_end[0]
    v_out = impacts.velocity_end[last] - q_end_rate[0]
    between = slice(first, last + 1)
    counted = impacts.kind[between] == ImpactKind.IMPACT
    return Collision(
        time=touch + s_in,
        end=release,
        approach=speed,
        restitution=restitution,
        delay=delay,
        kick=kick_velocity / speed,
        kick_velocity=kick_velocity,
        shift=shift,
        deceleration=-incoming.acceleration(s_in),
        impacts=int(np.count_nonzero(counted)),
        contact_time=float(np.sum((impacts.end - impacts.start)[between])),
        first_touch=touch,
        real_approach=float(impacts.approach[first]),
        ringing=_ringing(motion, u_in, v_in),
        energy_to_higher_modes=_higher_energy(motion, u_out, v_out) - _higher_energy(motion, u_free, v_free),
        energy_lost=float(np.sum(impacts.loss[between])),
        forced_by_ringing=forced,
        returns=returns,
    )


def first_collision(
    oscillator: ImpactOscillator, state: State | None = None, *, periods: int = 64
) -> Collision:
    """The first collision from `state`, or from the steady motion that the wall has not yet disturbed.

    Started from the steady motion at an excess above zero, this is the collision that ends the p1 orbit, with
    all higher modes at their steady amplitude: the cleanest measure of restitution, delay and kick.

    Parameters
    ----------
    oscillator : ImpactOscillator
    state : State, optional
    periods : int
        Drive periods within which the collision must be final.

    Raises
    ------
    ValueError
        If the tip does not touch the stop, or the collision is not final, within `periods`.
    """
    require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    periods = require_whole("periods", periods, "drive periods")
    start = before_collision(oscillator) if state is None else state
    for length in sorted({min(3, periods), periods}):
        trajectory = simulate(oscillator, start, periods=length)
        found = collisions(oscillator, trajectory, unfinished="drop")
        if found:
            return found[0]
    raise ValueError(f"periods is {periods}; no collision was final within them")


def before_collision(oscillator: ImpactOscillator) -> State:
    """The steady motion, at the time of its lowest tip displacement in the first drive period.

    Parameters
    ----------
    oscillator : ImpactOscillator
        A driven one; ValueError without a drive.
    """
    if oscillator.drive is None:
        raise ValueError("drive is None; without one there is no steady motion that touches, so give a state")
    motion = oscillator.motion()
    lowest = math.atan2(-motion.tip_sine, -motion.tip_cosine) % (2 * math.pi) / motion.drive
    q, q_rate = steady_motion(motion, np.array([lowest]))
    return State(displacement=q[0], velocity=q_rate[0], time=lowest)


