"""Families of periodic orbits followed over the drive amplitude, with their folds and other events.

The curve is that of ``contact.orbits.branches.amplitude_curve``.  Down to grazing a step changes the approach
velocity by a factor.  With several touches this velocity can turn round along the curve.
"""

from dataclasses import replace

from beam.parameters import require, require_within
from contact.orbits.branches.amplitude_curve import at_graze, branch_ended, curve_through, downhill, entered
from contact.orbits.branches.branch import SMALLEST, Branch, branch_of
from contact.orbits.branches.events import Event
from contact.orbits.families.newton_family import NewtonFamily, require_family, require_orbit
from contact.orbits.families.touch_orbit import PeriodicOrbit

GREATEST_STEP = 10.0  # longest step of log v: over four decades at once


def follow(
    family: NewtonFamily,
    start: PeriodicOrbit | None = None,
    *,
    low: float | None = None,
    high: float | None = None,
    step: float = 0.1,
) -> Branch:
    """Follow the branch of a family through an orbit, over all approach velocities or from `low` to `high`.

    With one touch, the approach velocity rises along the branch.  With several touches, it can turn round.

    Parameters
    ----------
    family : Shooting
        The family whose orbits are followed; the drive amplitude of its oscillator does not matter.
    start : PeriodicOrbit, optional
        An orbit of the family, from which the branch is followed both ways.  By default one is looked for.
    low, high : float, optional
        Range of the approach velocity of the first touch, which must enclose the start [m/s].  By default
        `low` is 1e-6 times 2 pi f gap, nearly a graze.  `high` is 100 times 2 pi f gap, where the gap hardly
        matters.
    step : float, optional
        Longest step of arc length, from 1e-9 to 10 [1]; near grazing, of the logarithm of the velocity.

    Returns
    -------
    Branch
        The orbits of the branch, its events, and why it ends.  It stops after 20 s of processor time.

    Raises
    ------
    TypeError, ValueError
        If `start` is no orbit of the Shooting family, outside of `low` to `high`, or `step` is out of range.
    NotPeriodic
        If Newton's method finds no orbit at the start.
    BranchEnded
        If no start is given, and no orbit of the family is found.

    See Also
    --------
    Branch.plot : A picture of the branch.
    fold_of : The fold of a family.
    follow_path : The branch along a path of oscillators, such as a response curve.
    Shooting : The family of orbits under any contact law.

    Examples
    --------
    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop
    >>> from contact.orbits import Shooting, follow
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> law = LinearContact.with_restitution(stiffness=1e7, restitution=0.3, mass=1.0)
    >>> stop, drive = Stop(gap=11.9e-3, law=law), HarmonicDrive(frequency=21.5)
    >>> family = Shooting(oscillator=ImpactOscillator(model=spring, stop=stop, drive=drive), m=4)
    >>> follow(family, family.at_speed(0.6), low=0.2, high=2.0)
    Branch(26 orbits p4, 20 admissible, 9 of them stable
        fold at -0.00730, grazing at 0.0121
        ended_low=range
        ended_high=range)
    """
    require_family(family)
    if start is not None:
        require_orbit(family, "start", start, member=True)
    require_within("step", step, "[1]", low=SMALLEST, high=GREATEST_STEP)
    curve = curve_through(entered(family) if start is None else start, family)
    slowest = curve.slowest if low is None else require_within("low", low, "m/s")
    fastest = curve.fastest if high is None else require_within("high", high, "m/s")
    speed = curve.like.speed
    words = f"low and high are {slowest} and {fastest} m/s; they must enclose the start, {speed:g} m/s"
    words += ", which was looked for: give one of family.at_speed" if start is None else ""
    require(0 < slowest < speed < fastest, words)
    curve = replace(curve, slowest=slowest, fastest=fastest)
    branch = branch_of(curve, curve.start(), step, step)[0]
    ends = _placed(branch.ended_low, branch.orbits[0]), _placed(branch.ended_high, branch.orbits[-1])
    return replace(branch, ended_low=ends[0], ended_high=ends[1])


def _placed(ended: str, last: PeriodicOrbit) -> str:
    """Why a branch ends, in words, with the place of its last orbit."""
    if ended in ("range", "closed"):
        return ended
    return f"{ended}; last orbit at {last.speed:.6g} m/s, excess {last.excess:.6g}"


def first_event(family: NewtonFamily, start: PeriodicOrbit, lowest: float) -> Event | None:
    """Return the event that ends an orbit when the drive amplitude is lowered.

    An orbit ends by "grazing" where one of its touches becomes a graze.  Under a soft contact without a fold,
    this is where the first touch is slower than 1e-6 times 2 pi f gap.

    Parameters
    ----------
    family : Shooting
        The family to which the orbit belongs.
    start : PeriodicOrbit
        The orbit that is followed towards lower amplitudes.
    lowest : float
        Excess F/F_g - 1 down to which the branch is followed, above -1 [1].

    Returns
    -------
    Event or None
        The first event, or None if none is met down to `lowest`.  It can lie a part of a step below `lowest`.

    Raises
    ------
    TypeError, ValueError
        If `start` is no PeriodicOrbit of the Shooting family `family`, or `lowest` is no number above -1.
    BranchEnded
        If the branch ends for another reason, which the message names.  Its `orbit` is the last orbit.
    NotPeriodic
        If Newton's method finds no orbit at the start.
    """
    require_family(family)
    require_orbit(family, "start", start, member=True)
    require_within("lowest", lowest, "[1]", above=-1)
    last = start
    for leg in downhill(family, start):
        if leg.events:
            return leg.events[0]
        last = leg.points[-1].orbit if leg.points else last
        if last.excess < lowest:
            return None
        if leg.ended and not at_graze(leg.ended, last):
            raise branch_ended(last, f"the branch ends before an event: {leg.ended}")
    return Event(kind="grazing", orbit=last)
