"""The loss of a periodic orbit when the drive amplitude is lowered.

**Scan.** The amplitude is lowered in steps that carry the physical state along.  A step succeeds if the
motion settles on an orbit of the same period with the same impacts.  The step is then enlarged; otherwise it
is halved and made again from the last orbit that held.  The last step has the required width, and brackets
the end.

**Exact end.** The orbit that held is then followed through the bracket: by continuation for an impact
oscillator (``contact.orbits.branches.continuation``), in closed form for the Nordmark map.  The first event
on its branch (``contact.orbits.branches.events``) is the end.  If the orbit is stable at the lower end of the
bracket, the scan goes on from the orbit there.  Only the "bracket" is known of other maps, of several
impacts in the map, and of two events closer than 1e-6.  See ``docs/theory/folds.md``.
"""

import math
from dataclasses import replace
from typing import Any, Generic, TypeVar

from beam.parameters import record, require_kind, require_whole, require_within
from contact.errors import BranchEnded, ContactError
from contact.laws import NEWTON
from contact.maps.nordmark import NordmarkMap
from contact.maps.nordmark_orbits import MapFamily
from contact.maps.protocol import require_map
from contact.maps.stroboscope import StrobedMap, StroboscopicMap
from contact.orbits.branches.continuation import first_event
from contact.orbits.branches.folds import fold_of_the_kicks
from contact.orbits.families.protocol import Family
from contact.orbits.families.single_impact import MaximalFamily
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.orbits.observation.settling import orbit_near, settle
from contact.orbits.shooting import Shooting

S = TypeVar("S")

MOST_STEPS = 400  # bound of amplitude steps: 40 doublings reach any excess, and 40 halvings any tolerance
BRACKET = "bracket"  # kind of an end of which only the bracket is known


@record
class OrbitEnd(Generic[S]):
    """The end of an orbit in a downward scan of the drive amplitude.

    Parameters
    ----------
    m : int
        Period of the orbit in drive periods.
    impacts : int
        Impacts in one such period.
    excess : float
        F/F_g - 1 at which the orbit ends [1]; the middle of the bracket if only that is known.
    kind : str
        Kind of the end: "fold", "period doubling", "torus", "branch point" or "grazing".  It is "bracket" if
        no such event was found.
    held : float
        Last excess at which the motion stayed on the orbit [1].
    lost : float
        Excess one step below, at which the motion lost the orbit [1].
    state : State
        A state on the orbit at the excess `held`.
    orbit : PeriodicOrbit, optional
        The orbit at its end; None for the Nordmark map, and where only a bracket is known.  Its approach
        velocity and touches identify it among several orbits of this period.
    """

    m: int
    impacts: int
    excess: float
    kind: str
    held: float
    lost: float
    state: S
    orbit: PeriodicOrbit | None = None


def orbit_end(
    strobed: StrobedMap[S],
    state: S,
    excess: float,
    *,
    most_cycles: int,
    relative: float = 0.01,
    absolute: float = 1e-7,
    first_step: float = 2e-4,
    lowest: float = -0.5,
) -> OrbitEnd[S] | None:
    """Follow an orbit downwards in the drive amplitude until it ends.

    The motion first settles at `excess`.  The amplitude is then lowered in steps that carry the physical
    state along.

    Parameters
    ----------
    strobed : StrobedMap
        The oscillator or map; its own amplitude does not matter.
    state : State
        State from which the motion settles on the orbit.
    excess : float
        Excess F/F_g - 1 at which the motion settles [1].
    most_cycles : int
        Bound of the transient at each amplitude, in drive periods.
    relative : float, optional
        Width of the last step over the excess, zero or more [1].
    absolute : float, optional
        Least width of the last step, above zero [1].  The larger of the two widths counts.
    first_step : float, optional
        First step of the excess, above zero [1].
    lowest : float, optional
        Last excess that is tried, above -1 [1].

    Returns
    -------
    OrbitEnd or None
        Where and how the orbit ends.  None is returned if the motion at `excess` is not periodic with
        impacts, or if the orbit still exists at `lowest`.

    Raises
    ------
    TypeError
        If `strobed` is no strobed map, or an argument is no number.
    ValueError
        If an argument is out of its range, or `state` does not lie at a strobe.
    BranchEnded
        If the bound of 400 steps is used up.
    ContactError
        If the motion at `excess` cannot be followed.

    See Also
    --------
    onset_orbit : The orbit on which the motion settles above grazing.
    orbit_diagram : All strobe points of a scan.
    fold_excess : The fold of the orbit with one collision, without a scan.

    Examples
    --------
    The orbit of period 5 appears just above grazing, and persists below it down to its fold.

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
    >>> from contact.orbits import onset_orbit, orbit_end
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=22.2))
    >>> strobed = StroboscopicMap(oscillator=oscillator)
    >>> end = orbit_end(strobed, onset_orbit(strobed).end, 1e-3, most_cycles=1000)
    >>> print(f"p{end.m} ends by a {end.kind} at excess {end.excess:.5f}")
    p5 ends by a fold at excess -0.00148
    """
    require_map(strobed)
    require_within("relative", relative, "[1]", low=0)
    require_within("absolute", absolute, "[1]", above=0)
    require_within("first_step", first_step, "[1]", above=0)
    require_within("lowest", lowest, "[1]", above=-1)
    start = settle(strobed.at(excess), state, most_cycles=most_cycles)
    if start.m == 0 or start.impacts == 0:
        return None

    def kept(trial: float) -> S | None:
        """The state on the same orbit at the excess `trial`; None if the motion lost it."""
        try:
            settled = settle(strobed.at(trial), state, most_cycles=most_cycles)
        except ContactError:
            return None
        same = (settled.m, settled.impacts) == (start.m, start.impacts)
        return settled.end if same else None

    held, state, step, lost = excess, start.end, first_step, math.inf
    for _ in range(MOST_STEPS):
        final = max(relative * abs(held), absolute)
        # from next to where a longer step fell off (`lost`, if below), the last step is made anew
        step = max(0.5 * (held - lost) if lost < held else step, final)
        trial = max(held - step, lowest)
        if held <= lowest:
            return None
        now = kept(trial)
        if now is None and step <= final:
            bracket = OrbitEnd(
                m=start.m,
                impacts=start.impacts,
                excess=0.5 * (held + trial),
                kind=BRACKET,
                held=held,
                lost=trial,
                state=state,
            )
            end, now = _exact_end(strobed, bracket)
            if end is not None:
                return end
        if now is None:
            lost = trial
        else:
            held, state, step = trial, now, 2.0 * step
    words = f"the bound of {MOST_STEPS} steps is used up at excess {held:.6g}"
    raise BranchEnded(detail=f"{words}; more most_cycles make them longer")


def _exact_end(strobed: Any, bracket: OrbitEnd[Any]) -> tuple[OrbitEnd[Any] | None, Any]:
    """The end in the `bracket`; or None and the state at `lost`, if the orbit still exists there."""
    m, impacts, lost = bracket.m, bracket.impacts, bracket.lost
    if isinstance(strobed, NordmarkMap) and impacts == 1:
        return _map_end(MapFamily(strobed, m), bracket)
    if not isinstance(strobed, StroboscopicMap):
        return bracket, None
    orbit = orbit_near(strobed.at(bracket.held), bracket.state, m, impacts)
    if orbit is None:
        return bracket, None
    family = Shooting(oscillator=orbit.oscillator, m=m, impacts=impacts)
    try:
        event = first_event(family, orbit, lost)
        if event is not None and event.kind == "undecided":
            return bracket, None
        if event is not None and event.orbit.excess >= lost:
            return replace(bracket, kind=event.kind, excess=event.orbit.excess, orbit=event.orbit), None
        below = family.at_excess(lost, orbit)
    except ContactError:
        return bracket, None
    return (None, below.strobe_state()) if below.stable else (bracket, None)


def _map_end(family: MapFamily, bracket: OrbitEnd[S]) -> tuple[OrbitEnd[S] | None, Any]:
    """The result of `_exact_end` for an orbit of the Nordmark map with one impact in a period."""
    at_fold, stable = family.fold(), family.stable_range()
    if at_fold is None or stable is None or not stable[0] <= family.map.rho(bracket.held) <= stable[1]:
        return bracket, None
    end = family.map.excess(stable[0])
    if end < bracket.lost:
        return None, family.orbits(bracket.lost)[-1].states[0]
    if stable[0] == at_fold.rho:
        return replace(bracket, kind="fold", excess=end), None
    doubles = family.at_rho(stable[0])[-1].multipliers.real.min() < -1.0 + 1e-6
    return replace(bracket, kind="period doubling" if doubles else "grazing", excess=end), None


def fold_excess(strobed: StrobedMap[Any], m: int) -> float | None:
    """Return the excess at the fold of the p_m orbit with one collision.

    The Nordmark map and Newton's law with a constant restitution have it in closed form.  Under any other law
    it is found by shooting, with as many touches as the collision at the fold of the kick description.

    Parameters
    ----------
    strobed : StroboscopicMap or NordmarkMap
        The oscillator or map; its own amplitude does not matter.
    m : int
        Period of the orbit in drive periods; 0 for a motion that did not settle.

    Returns
    -------
    float or None
        F_m/F_g - 1 at the fold [1], or None without a fold and for `m` below 2.

    Raises
    ------
    TypeError
        If `strobed` is neither a StroboscopicMap nor a NordmarkMap, or `m` is no number.
    ValueError
        If `m` is no whole number of zero or more, or if the oscillator has a constant load or no drive that
        moves the tip.
    BranchEnded
        If the orbits around the expected place of the fold are not found.
    """
    if require_whole("m", m, "drive periods", low=0) < 2:
        return None
    family: Family
    if isinstance(strobed, NordmarkMap):
        family = MapFamily(strobed, m)
    else:
        words = "a StroboscopicMap or a NordmarkMap"
        oscillator = require_kind("strobed", strobed, StroboscopicMap, words).oscillator
        law = oscillator.stop.law
        if law.code == NEWTON and law.table.size == 0:  # a constant restitution
            family = MaximalFamily.from_oscillator(oscillator, m=m)
        else:
            one = Shooting(oscillator=oscillator, m=m)
            kick = fold_of_the_kicks(one)
            if kick is None:
                return None
            family = replace(one, impacts=kick.kick.impacts)
    at_fold = family.fold()
    return None if at_fold is None else at_fold.excess
