"""Folds of families of periodic orbits over the drive amplitude.

The curve is that of ``contact.orbits.branches.amplitude_curve``.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from beam.parameters import require_array
from contact.errors import ContactError, NotPeriodic
from contact.orbits.branches.amplitude_curve import GREATEST_SPEED, branch_ended, downhill, whole_branch
from contact.orbits.branches.curve import deadline
from contact.orbits.branches.events import Event
from contact.orbits.families.kick import SPEEDS
from contact.orbits.families.newton_family import NewtonFamily, require_family
from contact.orbits.families.single_impact import SingleImpactOrbit
from contact.orbits.families.touch_orbit import PeriodicOrbit

LOSSES = ("torus", "period doubling", "branch point", "undecided")
"""Events other than folds and grazings at which orbits can lose their stability."""


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
        a period doubling.  If the search takes more than 20 s of processor time.  The `orbit` of the error is
        the last orbit, or the orbit at that event.

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
    until = deadline()
    fold, losses = _fold_of_these_touches(family, near, until)
    if fold is None or fold.admissible:
        return fold, losses
    try:
        kick = family.kicks.fold()
        if kick is None or kick.kick.impacts == fold.impacts:
            return fold, losses
        other = _fold_of_these_touches(replace(family, impacts=kick.kick.impacts), None, until)[0]
    except ContactError:
        return fold, []
    return (other if other is not None and other.admissible else fold), []


def _fold_of_these_touches(
    family: NewtonFamily, near: PeriodicOrbit | None, until: float
) -> tuple[PeriodicOrbit | None, list[Event]]:
    """The result of `lowest_fold` with as many touches as the family has."""
    require_family(family, near)
    fold: PeriodicOrbit | None = None
    with suppress(ContactError):  # the search of the whole branch says why
        guess = near or fold_of_the_kicks(family)
        legs = downhill(family, family.at_speed(guess.speed, near), until) if guess else ()
        events = (event for leg in legs for event in leg.events)
        fold = next((event.orbit for event in events if event.kind == "fold"), None)
    if fold is not None and fold.excess < 0.0:
        return fold, []
    branch = whole_branch(family, near if fold is None else fold, until)[2]
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
    require_family(family, near)
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
