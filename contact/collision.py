"""Collisions: impacts grouped as the single-mode description sees them.

The virtual motion is the steady forced tip motion plus the free deviation of mode 1, the wall ignored:

    y(t) = x_s(t) + phi_1 u_1(t) - gap

Mode 1 carries most of a static force on the tip (``ModalModel.leading_mode``).  A collision holds all impacts
from a first touch until the next minimum of the outgoing virtual motion, that after the last impact.  It is
final when that minimum has passed.

Derivation: ``docs/theory/collision.md``.
"""

import math

import numpy as np

from beam.parameters import InvalidValue, require, require_kind, require_whole
from contact.collision_numbers import Collision, length_between, numbers_of_collision
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import LOAD, Numbers, with_only_mode
from contact.impacts import Impacts
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.simulation import simulate
from contact.state import ImpactKind, State
from contact.trajectory import Trajectory
from contact.virtual_motion import VirtualMotion


def collisions(trajectory: Trajectory, *, unfinished: str = "refuse") -> list[Collision]:
    """Group the impacts of a trajectory into collisions, in the order of time.

    A collision that had begun before the trajectory is left out.

    Parameters
    ----------
    trajectory : Trajectory
        Motion of an oscillator with one stop at the tip.
    unfinished : {"refuse", "drop"}
        Whether a last collision that is not final when the trajectory ends is refused or left out.

    Returns
    -------
    list of Collision
        The collisions; an empty list if there are none.

    Raises
    ------
    ValueError
        If the last collision is not final and may not be dropped, or `unfinished` is another word.  If the
        oscillator has other stops, or its load drives a higher mode of zero frequency.
    TypeError
        If `trajectory` is no Trajectory.

    See Also
    --------
    Collision : The numbers of one collision.
    first_collision : The first collision of a motion.
    simulate : The motion of an oscillator, with its impacts.

    Examples
    --------
    With one mode and Newton's law each collision is one impact, without delay:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop
    >>> from contact import collisions, simulate
    >>> law = NewtonRestitution(local_restitution=0.1)
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=law),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... ).with_excess(0.01)
    >>> found = collisions(simulate(oscillator, periods=500), unfinished="drop")
    >>> print(f"{found[-1].approach:.3f} m/s, {found[-1].restitution:.3f}, {found[-1].impacts}")
    0.611 m/s, 0.100, 1
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
        while rows and (stays[rows[0]] or -length_between(numbers, impacts, rows[0], last) < minimum):
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
            found.append(numbers_of_collision(numbers, k, impacts, slice(first, last + 1), outgoing))
    return found


def _outgoing(single: Numbers, k: int, impacts: Impacts, last: int) -> tuple[VirtualMotion, float]:
    """The virtual motion after an impact, and the time from there to its next minimum [s].

    The time is infinite if the contact has not ended or no minimum comes within two drive periods.
    """
    clock = math.fmod(impacts.end_clock[last], single.period)
    virtual = VirtualMotion(single, clock, *impacts.deviations_end[last, :, k])
    minima = virtual.extrema(0.0, 2.0 * single.period, -1.0) if math.isfinite(clock) else []
    return virtual, minima[0] if minima else math.inf


def first_collision(
    oscillator: ImpactOscillator, state: State | None = None, *, periods: int = 64
) -> Collision:
    """Return the first collision of a motion, by default from the steady motion.

    From the steady motion, at an excess above zero, this collision ends the p1 orbit.  All higher modes then
    have their steady amplitude.  It is the cleanest measure of restitution, delay and kick.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Spring with one stop at the tip.
    state : State, optional
        State at the start; by default that of `before_collision`.
    periods : int
        Largest length of the motion in drive periods.

    Returns
    -------
    Collision
        The first collision that is final within these periods.

    Raises
    ------
    ValueError
        If no collision is final within these periods, or the oscillator has other stops or no steady motion.
    TypeError
        If an argument is of another kind.
    ContactError
        If `simulate` cannot follow the motion.
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
    """Return the state of the steady motion where the tip is lowest in the first drive period.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven spring with one stop at the tip.

    Returns
    -------
    State
        State of the steady motion, with its time [s].

    Raises
    ------
    ValueError
        If the base is at rest, a load makes a mode drift, or there are other stops.
    TypeError
        If `oscillator` is no ImpactOscillator.
    """
    require_one_stop(oscillator, "a collision")
    _ = oscillator.mean_height  # refuses an oscillator without a steady motion
    numbers = oscillator.numbers()
    lowest = math.atan2(-numbers.tip_sine, -numbers.tip_cosine) % (2 * math.pi) / numbers.drive
    q, q_rate = steady_motion(numbers, lowest)
    return State(displacement=q, velocity=q_rate, time=lowest)
