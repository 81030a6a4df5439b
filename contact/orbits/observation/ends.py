"""Where a periodic orbit ends when the drive amplitude is lowered.

**Scan.** The amplitude is lowered in steps that carry the physical state along.  A step succeeds if the
motion settles on an orbit of the same period with the same impacts; the step is then enlarged, otherwise
halved and tried again from the last orbit that held.  (Impacts alone would not do: below the end of a p_m
orbit they can go on for thousands of periods.)  A long step can fall off an orbit that is still there, as its
basin is narrow near a fold; an end is therefore only where the orbit was lost by one final step of the wanted
width, made from an orbit that held.  That step brackets the end.

**Exact end.** The orbit that held is then followed, as an orbit and not as a motion, through the bracket: by
shooting for an impact oscillator (``contact.orbits.branches.continuation``), in closed form for the Nordmark
map (``contact.maps.nordmark_orbits``).  What is met first is the end, a "fold", "period doubling", "torus",
"branch point" or "grazing" (``contact.orbits.branches.events``), with the excess of that very point.  If the
orbit leaves the bracket at its lower end, stable, the motion had been lost too early, and the scan goes on
from the orbit there.  Where nothing of this is found (a map without these tools, several impacts in the map,
two events closer than 1e-6) the end is known to its "bracket" only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from beam.parameters import require_kind, require_whole, require_within
from contact.errors import ContactError
from contact.laws import NEWTON
from contact.maps.nordmark import NordmarkMap
from contact.maps.nordmark_orbits import MapFamily
from contact.maps.protocol import require_map
from contact.maps.stroboscope import StrobedMap, StroboscopicMap
from contact.orbits.branches.continuation import first_event
from contact.orbits.families.family import Family
from contact.orbits.families.kick import KickFamily
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.orbits.families.shooting import Shooting
from contact.orbits.families.single_impact import MaximalFamily
from contact.orbits.observation.settling import Settled, orbit_near, settle

S = TypeVar("S")

MOST_STEPS = 400
"""Bound of amplitude steps: 40 doublings reach any excess, 40 halvings any tolerance, with room to spare."""

BRACKET = "bracket"
"""Kind of an end that is known to its bracket only."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitEnd(Generic[S]):
    """The end of a p_m orbit in a downward scan.

    Parameters
    ----------
    period, impacts : int
        Of the orbit that was followed.
    excess : float
        F/F_g - 1 at which it ends [1]; the middle of the bracket if that is all that is known.
    kind : str
        "fold", "period doubling", "torus", "branch point" or "grazing"; "bracket" if none of these was found
        in it.
    held, lost : float
        Excess at which the motion held the orbit last, and that one step below at which it lost it [1].
    state : State
        On the orbit at `held`.
    orbit : PeriodicOrbit, optional
        The orbit at its end; None for the Nordmark map, and where only a bracket is known.  If several orbits
        have this period, the approach velocity and the touches of `orbit` identify the one that ends.
    """

    period: int
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
    """Follow the orbit on which `state` settles at `excess` downwards until it ends.

    Parameters
    ----------
    strobed : StrobedMap
    state : State
    excess : float
        Where to start [1].
    most_cycles : int
        Bound of the transient at each amplitude.
    relative, absolute : float
        The last step is `relative` of the excess itself or `absolute`, whichever is larger.
    first_step : float
        First step of the excess.
    lowest : float
        Excess below which the search is given up.

    Returns
    -------
    OrbitEnd, or None if the motion at `excess` is not periodic with impacts, or never ends above `lowest`.
    """
    require_map(strobed)
    require_within("relative", relative, "[1]", low=0)
    require_within("absolute", absolute, "[1]", above=0)
    require_within("first_step", first_step, "[1]", above=0)
    require_within("lowest", lowest, "[1]", above=-1)
    start = settle(strobed.at(excess), state, most_cycles=most_cycles)
    if start.period == 0 or start.impacts == 0:
        return None

    def kept(trial: float) -> S | None:
        """The state on the same orbit at the excess `trial`; None if the motion lost it."""
        try:
            settled = settle(strobed.at(trial), state, most_cycles=most_cycles)
        except ContactError:
            return None
        same = (settled.period, settled.impacts) == (start.period, start.impacts)
        return settled.end if same else None

    held, state, step, lost = excess, start.end, first_step, math.inf
    for _ in range(MOST_STEPS):
        final = max(relative * abs(held), absolute)
        # from next to where a longer step fell off (`lost`, if below), the last step is made anew
        step = max(0.5 * (held - lost) if lost < held else step, final)
        trial = held - step
        if trial < lowest:
            return None
        now = kept(trial)
        if now is None and step <= final:
            end, now = _exact_end(strobed, state, start, held, trial)
            if end is not None:
                return OrbitEnd(
                    period=start.period,
                    impacts=start.impacts,
                    kind=end[0],
                    excess=end[1],
                    held=held,
                    lost=trial,
                    state=state,
                    orbit=end[2],
                )
        if now is None:
            lost = trial
        else:
            held, state, step = trial, now, 2.0 * step
    return None


End = tuple[str, float, PeriodicOrbit | None]
"""Kind of an end, its excess, and the orbit there if it is known."""


def _exact_end(
    strobed: Any, state: Any, start: Settled[Any], held: float, lost: float
) -> tuple[End | None, Any]:
    """The end in the bracket; or None and the state at `lost`, if the orbit is still there."""
    unknown = (BRACKET, 0.5 * (held + lost), None), None
    if isinstance(strobed, NordmarkMap) and start.impacts == 1:
        return _map_end(MapFamily(strobed, start.period), held, lost) or unknown
    if not isinstance(strobed, StroboscopicMap):
        return unknown
    orbit = orbit_near(strobed.at(held), state, start.period, start.impacts)
    if orbit is None:
        return unknown
    family = Shooting(oscillator=orbit.oscillator, period=start.period, impacts=start.impacts)
    try:
        event = first_event(family, orbit, lost)
        if event is not None and event.kind == "undecided":
            return unknown
        if event is not None and event.orbit.excess >= lost:
            return (event.kind, event.orbit.excess, event.orbit), None
        below = family.at_excess(lost, orbit)
    except ContactError:
        return unknown
    return (None, below.strobe_state()) if below.stable else unknown


def _map_end(family: MapFamily, held: float, lost: float) -> tuple[End | None, Any] | None:
    """The same for the orbit of the Nordmark map with one impact in a period; None if it is not known."""
    at_fold, stable = family.fold(), family.stable_range()
    if at_fold is None or stable is None or not stable[0] <= family.map.rho(held) <= stable[1]:
        return None
    end = family.map.excess(stable[0])
    if end < lost:
        return None, family.orbits(lost)[-1].states[0]
    if stable[0] == at_fold.rho:
        return ("fold", end, None), None
    doubles = family.at_rho(stable[0])[-1].multipliers.real.min() < -1.0 + 1e-6
    return ("period doubling" if doubles else "grazing", end, None), None


def fold_excess(strobed: StrobedMap[Any], period: int) -> float | None:
    """F_m/F_g - 1 at the fold of the p_m orbit with one collision, whatever the description.

    The Nordmark map and Newton's law have it in closed form; under any other law it is found by shooting,
    with the touches of the collision at the fold of the kick description.  None without a fold, or for
    m < 2.

    Parameters
    ----------
    strobed : StrobedMap
        A NordmarkMap or a StroboscopicMap; its own amplitude does not matter.
    period : int
        m, in drive periods; 0 is the period of a motion that did not settle.

    Raises
    ------
    NotPeriodic
        If the orbits around the place where the fold should be are not found.
    """
    if require_whole("period", period, "drive periods", low=0) < 2:
        return None
    family: Family
    if isinstance(strobed, NordmarkMap):
        family = MapFamily(strobed, period)
    else:
        words = "a StroboscopicMap or a NordmarkMap"
        oscillator = require_kind("strobed", strobed, StroboscopicMap, words).oscillator
        if oscillator.stop.law.code == NEWTON:
            family = MaximalFamily.from_oscillator(oscillator, period=period)
        else:
            kick = KickFamily(oscillator=oscillator, period=period).fold()
            if kick is None:
                return None
            family = Shooting(oscillator=oscillator, period=period, impacts=kick.kick.touches)
    at_fold = family.fold()
    return None if at_fold is None else at_fold.excess
