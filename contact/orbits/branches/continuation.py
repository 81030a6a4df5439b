"""Families of periodic orbits followed over the drive amplitude, with their folds and other events.

The curve is that of ``contact.orbits.branches.amplitude_curve``.  Down to grazing a step changes the approach
velocity by a factor.  With several touches this velocity can turn round along the curve.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from beam.parameters import require, require_array, require_kind, require_within
from contact.errors import ContactError, NotPeriodic
from contact.orbits.branches.amplitude_curve import (
    GREATEST_SPEED,
    AmplitudeCurve,
    at_graze,
    branch_ended,
    downhill,
    whole_branch,
)
from contact.orbits.branches.branch import SMALLEST, Branch, branch_of
from contact.orbits.branches.events import Event
from contact.orbits.families.kick import SPEEDS
from contact.orbits.families.newton_family import NewtonFamily, require_orbit
from contact.orbits.families.single_impact import SingleImpactOrbit
from contact.orbits.families.touch_orbit import PeriodicOrbit

GREATEST_STEP = 10.0  # longest step of log v: over four decades at once

LOSSES = ("torus", "period doubling", "branch point", "undecided")
"""Events other than folds and grazings at which orbits can lose their stability."""


def _require(family: NewtonFamily, near: object = None) -> None:
    """Refuse what is no family to follow, and a `near` that is neither an orbit near it nor None."""
    require_kind("family", family, NewtonFamily, "a Shooting family")
    if near is not None:
        require_orbit(family, "near", near)


def follow(
    family: NewtonFamily, start: PeriodicOrbit, *, low: float, high: float, step: float = 0.1
) -> Branch:
    """Follow the branch of a family through an orbit, between two approach velocities.

    With one touch, the approach velocity rises along the branch.  With several touches, it can turn round.

    Parameters
    ----------
    family : Shooting
        The family whose orbits are followed; the drive amplitude of its oscillator does not matter.
    start : PeriodicOrbit
        An orbit of the family, from which the branch is followed both ways.
    low, high : float
        Range of the approach velocity of the first touch, which must enclose the start [m/s].
    step : float, optional
        Longest step of arc length, from 1e-9 to 10 [1]; near grazing, of the logarithm of the velocity.

    Returns
    -------
    Branch
        The orbits of the branch, its events, and why it ends.

    Raises
    ------
    TypeError, ValueError
        If `start` is no orbit of the Shooting family, outside of `low` to `high`, or `step` is out of range.
    NotPeriodic
        If Newton's method finds no orbit at the start.

    See Also
    --------
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
    >>> branch = follow(family, family.at_speed(0.6), low=0.2, high=2.0)
    >>> [(event.kind, f"{event.orbit.excess:.4f}") for event in branch.events]
    [('fold', '-0.0073'), ('grazing', '0.0121')]
    """
    _require(family)
    require_orbit(family, "start", start, member=True)
    for name, value in (("low", low), ("high", high)):
        require_within(name, value, "m/s")
    require_within("step", step, "[1]", low=SMALLEST, high=GREATEST_STEP)
    words = f"low and high are {low} and {high} m/s; they must enclose the start, {start.speed:g} m/s"
    require(0 < low < start.speed < high, words)
    curve = AmplitudeCurve(like=start, family=family, slowest=low, fastest=high)
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
    _require(family)
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


def fold_of(family: NewtonFamily, near: PeriodicOrbit | None = None) -> PeriodicOrbit | None:
    """Return the fold of a family at the smallest amplitude.

    Parameters
    ----------
    family : Shooting
        The family of orbits; the drive amplitude of its oscillator does not matter.
    near : PeriodicOrbit, optional
        An orbit close to the fold.  The first fold downhill from it is taken for the lowest one.
        Without it, the search starts from the fold of the kick description.

    Returns
    -------
    PeriodicOrbit or None
        The orbit at the fold, or None if the branch has no fold.

    Raises
    ------
    TypeError, ValueError
        If `family` is no Shooting family, or `near` is no PeriodicOrbit with as many modes and touches.
    BranchEnded
        If there is no orbit to start from, if the branch is lost, or if its amplitude does not yet rise at
        the greatest speed.  If it has no fold, and its stable orbits end by another event, such as a torus or
        a period doubling.  The `orbit` of the error is the last orbit, or the orbit at that event.

    See Also
    --------
    first_event : What ends a stable orbit first; a torus or a period doubling can come before the fold.
    orbit_end : The end of the motion itself, when the drive is lowered.

    Notes
    -----
    The whole branch reaches from its graze to a speed of 100 times 2 pi f gap, where its amplitude rises.
    Where contact is soft, at an excess of some 1e-5 and less, it can have several folds, and go on below
    them until another touch grazes.  A fold above grazing is therefore looked for on the whole branch.
    One of the `multipliers` at a fold is 1; one above 1 in size says that stability was lost before.

    If the fold is not `admissible`, a second family is tried.  It has as many touches as the collision at the
    fold of the kick description.

    Examples
    --------
    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop
    >>> from contact.orbits import Shooting, fold_of
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> law = LinearContact.with_restitution(stiffness=1e7, restitution=0.3, mass=1.0)
    >>> stop, drive = Stop(gap=11.9e-3, law=law), HarmonicDrive(frequency=21.5)
    >>> family = Shooting(oscillator=ImpactOscillator(model=spring, stop=stop, drive=drive), m=4)
    >>> print(f"{fold_of(family).excess:.4f}")
    -0.0073
    """
    fold, losses = lowest_fold(family, near)
    if losses:
        words = ", ".join(f"a {event.kind} at excess {event.orbit.excess:.6g}" for event in losses)
        raise branch_ended(losses[0].orbit, f"it has no fold, and its stable orbits end by {words}")
    return fold


def lowest_fold(
    family: NewtonFamily, near: PeriodicOrbit | None = None
) -> tuple[PeriodicOrbit | None, list[Event]]:
    """The fold of `fold_of`, or None and the events by which stable orbits end, by falling excess."""
    fold, losses = _fold_of_these_touches(family, near)
    if fold is None or fold.admissible:
        return fold, losses
    try:
        kick = family.kicks.fold()
        if kick is None or kick.kick.impacts == fold.impacts:
            return fold, losses
        other = _fold_of_these_touches(replace(family, impacts=kick.kick.impacts), None)[0]
    except ContactError:
        return fold, []
    return (other if other is not None and other.admissible else fold), []


def _fold_of_these_touches(
    family: NewtonFamily, near: PeriodicOrbit | None
) -> tuple[PeriodicOrbit | None, list[Event]]:
    """The result of `lowest_fold` with as many touches as the family has."""
    _require(family, near)
    fold: PeriodicOrbit | None = None
    with suppress(ContactError):  # the search of the whole branch says why
        guess = near or fold_of_the_kicks(family)
        legs = downhill(family, family.at_speed(guess.speed, near)) if guess else ()
        events = (event for leg in legs for event in leg.events)
        fold = next((event.orbit for event in events if event.kind == "fold"), None)
    if fold is not None and fold.excess < 0.0:
        return fold, []
    branch = whole_branch(family, near if fold is None else fold)[2]
    folds = branch.of_kind("fold")
    if folds:
        return min(folds, key=lambda orbit: (not orbit.admissible, orbit.excess)), []
    losses = [event for event in branch.events if event.kind in LOSSES and event.orbit.admissible]
    if losses and any(orbit.stable for orbit in branch.orbits):
        return None, sorted(losses, key=lambda event: -event.orbit.excess)
    return None, []


def fold_of_the_kicks(family: NewtonFamily) -> SingleImpactOrbit | None:
    """The fold of the kick description at any speed of the search, the usual ones first."""
    found = family.kicks.fold()
    with suppress(NotPeriodic):  # a collision so fast that it does not end in time is no kick
        found = found or family.kicks.fold((SPEEDS[1] / 2.0, GREATEST_SPEED))
    return found


def fold_along_frequency(
    family: NewtonFamily, frequencies: np.ndarray, near: PeriodicOrbit | None = None
) -> list[PeriodicOrbit | ContactError | None]:
    """Return the folds of a family at several drive frequencies, each started from the fold before.

    Parameters
    ----------
    family : Shooting
        The family of orbits; the drive of its oscillator is replaced by one of each frequency.
    frequencies : ndarray, shape (n_frequencies,)
        Drive frequencies in the order of the search [Hz].
    near : PeriodicOrbit, optional
        An orbit close to the fold at the first frequency.

    Returns
    -------
    list of PeriodicOrbit, ContactError or None
        For each frequency the fold, None without a fold, or the error that says why the search failed.

    Raises
    ------
    TypeError, ValueError
        If `frequencies` is no row of numbers above zero, or if `fold_of` refuses `family` or `near`.
    """
    _require(family, near)
    found: list[PeriodicOrbit | ContactError | None] = []
    for frequency in require_array("frequencies", frequencies, "Hz", dimensions=1, words="drive frequencies"):
        drive = replace(family.oscillator.driven, frequency=float(frequency))
        here = replace(family, oscillator=replace(family.oscillator, drive=drive))
        result: PeriodicOrbit | ContactError | None = None
        for start in dict.fromkeys((near, None)):
            try:
                near = result = fold_of(here, start)
            except ContactError as error:
                near, result = None, error
            if near is not None:
                break
        found.append(result)
    return found
