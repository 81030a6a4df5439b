"""The numbers of one collision, as the single-mode description has them.

With the incoming and the outgoing virtual motion of ``contact.collision``,

    t_in, v_in   upward crossing of the gap by the incoming virtual motion, next to the first impact
    t_out        first downward crossing of the gap by the outgoing virtual motion, after its peak

    restitution = -(velocity at t_out) / v_in,   delay = t_out - t_in,
    kick = -(jump of the mode-1 tip velocity) / v_in,   shift = jump of the mode-1 tip displacement,

both jumps referred to t_in by the free flow of mode 1.

If the incoming peak stays below the gap (`forced_by_ringing`), the kick is given as a velocity.  Restitution
and delay do not exist then, nor if the outgoing motion never reaches the gap.  ``docs/theory/collision.md``
derives the relation of the two pairs.
"""

import math
from typing import Any

import numpy as np

from beam.record import record
from contact.flight.modal_flow import free_flow, propagate
from contact.flight.numbers import INVERSE_OMEGA, Numbers
from contact.flight.tip import tip_rounding
from contact.impacts import Impacts
from contact.state import ImpactKind
from contact.virtual_motion import VirtualMotion


@record(eq=True)
class Collision:
    """One approach of the tip to the stop, with all its impacts and their effect on mode 1.

    Parameters
    ----------
    time : float
        Time t_in of the approach; the first touch if `forced_by_ringing` [s].
    end : float
        Last release of the tip [s].
    approach : float
        Approach velocity v_in of the virtual motion; NaN if `forced_by_ringing` [m/s].
    restitution : float
        The letter's tau; NaN where it does not exist [1].
    delay : float
        Time delay t_out - t_in; NaN where it does not exist [s].
    kick : float
        Kick of the mode-1 tip velocity over v_in; NaN if `forced_by_ringing` [1].
    kick_velocity : float
        Kick of the mode-1 tip velocity, positive away from the stop [m/s].
    shift : float
        Jump of the mode-1 tip displacement at t_in [m].
    deceleration : float
        Minus the second derivative of the incoming virtual motion at t_in [m/s^2].
    impacts : int
        Number of impacts in the collision.
    contact_time : float
        Total time of contact [s].
    first_touch : float
        Time of the first touch [s].
    real_approach : float
        True tip velocity at the first touch [m/s].
    ringing : float
        Amplitude of the free motion of the higher modes at the tip before the collision [m].
    energy_to_higher_modes : float
        Energy gained by the free motion of all modes but mode 1 [J].
    energy_lost : float
        Energy lost in the contact itself [J].
    impulse : float
        Impulse of the stop over all touches [N s].
    peak_force : float
        Largest contact force; NaN under a law that acts at once [N].
    forced_by_ringing : bool
        Whether the virtual motion alone would not have touched the stop.
    returns : bool
        Whether the outgoing virtual motion reaches the gap.

    See Also
    --------
    collisions : The collisions of a trajectory.
    first_collision : The first collision of a motion.
    Impacts : The touches of a motion, one by one.

    Notes
    -----
    The virtual motion of the tip is its steady forced motion plus the free motion of mode 1, as if there were
    no stop.  The incoming one continues the motion before the collision, the outgoing one that after it.

    - t_in is the time at which the incoming virtual motion crosses the gap upwards, and v_in its velocity.
    - t_out is the time at which the outgoing virtual motion crosses the gap downwards.
    - The restitution is the speed at t_out over v_in.

    Restitution and delay do not exist if the collision is `forced_by_ringing`, or if the outgoing virtual
    motion does not reach the gap.

    Examples
    --------
    A soft stop: mode 1 comes back with less speed, after a time in contact:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop, first_collision
    >>> law = LinearContact.with_restitution(stiffness=1e6, restitution=0.5, mass=1.0)
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=law),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... ).with_excess(0.01)
    >>> found = first_collision(oscillator)
    >>> print(f"tau = {found.restitution:.3f}, delay = {1e3 * found.delay:.2f} ms")
    tau = 0.827, delay = 1.45 ms
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


def length_between(numbers: Numbers, impacts: Impacts, first: Any, last: Any) -> Any:
    """Time from the start of one touch to the release of another, to rounding in a run of any length [s]."""
    stretches = impacts.stretch[last] - impacts.stretch[first]
    return stretches * numbers.period + (impacts.end_clock[last] - impacts.clock[first])


def _higher_energy(numbers: Numbers, k: int, u: np.ndarray, v: np.ndarray) -> float:
    """Energy of the free motion of all modes but mode 1, which is number `k` [J]."""
    return float(0.5 * np.sum(np.delete(v, k) ** 2 + np.delete(numbers.omega * u, k) ** 2))


def numbers_of_collision(
    numbers: Numbers, k: int, impacts: Impacts, rows: slice, outgoing: VirtualMotion
) -> Collision:
    """The numbers of the collision of these impacts."""
    first, last, single = rows.start, rows.stop - 1, outgoing.numbers
    touch, length = float(impacts.start[first]), float(length_between(numbers, impacts, first, last))
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
        contact_time=float(np.sum(length_between(numbers, impacts, rows, rows))),
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
