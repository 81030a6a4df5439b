"""Settling on a periodic orbit, and its period.

**Repetition.** The motion is followed in blocks.  After each block the last points are compared with the
points before them (``contact.orbits.observation.repetition``), to `TOLERANCE` of the scale.  A period is
accepted when a repetition `ALIKE` times as rough has the same one.  A motion that has not settled after
`most_cycles` periods gets period 0.  Any strobed map settles this way.

**Proof.** A motion of an impact oscillator that repeats to `FIRST_LOOK` is compared with a stable, admissible
orbit, found from it by shooting (``contact.orbits.shooting``).  It ends there if over a whole block

    distance(n + block) <= SLACK |mu|^(block/m) distance(n) + rounding,     mu the largest multiplier.

The motion without impacts is settled when the free motion that is left cannot reach the stop.  See
``docs/theory/orbits.md``.
"""

from dataclasses import replace
from typing import Any, Generic, TypeVar

import numpy as np

from beam.parameters import Refusal, record, require_whole, require_within
from contact.errors import ContactError
from contact.impacts import deviations
from contact.maps.protocol import require_map
from contact.maps.stroboscope import StrobedMap, StrobedOrbit, StroboscopicMap
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.orbits.observation.repetition import free_for_good, repeats_after
from contact.orbits.shooting import Shooting
from contact.state import State

S = TypeVar("S")

TOLERANCE = 1e-9
"""Largest change over one period of a settled orbit, relative to the scale of its coordinates.  Rounding is
at 1e-14; the slow drift past a vanished fold at relative distance 1e-7 moves by more than this per period."""

ALIKE = 1000.0
"""Two repetitions with this ratio of tolerances must have the same period.  Next to a doubling with a
multiplier of -0.999, points m apart differ by 1000 times as much as points 2m apart."""

BELOW = -1e-3
"""Excess of the motion without impacts from which the drive is raised, four times the letter's amplitude
stability below grazing."""

FIRST_LOOK = 1e-3  # repetition over the gap at which an orbit is looked for, at the cost of ten drive periods

CLOSER = 0.5
"""A search without result is repeated when the motion repeats better by this factor, or much worse.
Otherwise every block would be searched next to a vanished fold, or in chaos next to an unstable orbit."""

SLACK = 1.5  # factor on the decay that the multiplier predicts, for the other multipliers and the curvature
NEAR = 1e-3  # distance over the gap from the orbit, within which the linear neighbourhood is looked for


@record
class Settled(Generic[S]):
    """The orbit on which a motion settled, as `settle` and `onset_orbit` return it.

    Parameters
    ----------
    m : int
        Smallest period in drive periods, at most `largest_m`; 0 if the run has not repeated.
    impacts : int
        Impacts in one such period; without a period, impacts in the last block of the run.
    end : State
        The state reached; where the orbit was proved, a state on it.
    cycles : int
        Drive periods spent.
    points : ndarray, shape (2 largest_m, n_coordinates)
        The strobed points of the last block, in the unit of the map.
    """

    m: int
    impacts: int
    end: S
    cycles: int
    points: np.ndarray


def settle(
    strobed: StrobedMap[S],
    state: S,
    *,
    most_cycles: int,
    largest_m: int = 64,
    tolerance: float = TOLERANCE,
    prove: bool = True,
) -> Settled[S]:
    """Follow a motion until it is known to be periodic.

    A motion is settled when its points repeat, or when the orbit that it approaches is proved.

    Parameters
    ----------
    strobed : StrobedMap
        The oscillator or map at one drive amplitude, such as a StroboscopicMap or a NordmarkMap.
    state : State
        State at a strobe from which the motion starts.
    most_cycles : int
        Bound of the run in drive periods; a block of 2 `largest_m` is run in any case.
    largest_m : int, optional
        Longest period that is looked for, in drive periods.
    tolerance : float, optional
        Largest change over one period of a settled orbit, relative to the scale of the map [1].
    prove : bool, optional
        Whether the transient of a StroboscopicMap ends where its orbit is proved, before the points repeat.

    Returns
    -------
    Settled
        Period, impacts and end of the settled motion; period 0 if none was found.

    Raises
    ------
    TypeError, ValueError
        If `strobed` is no strobed map, a number is out of range, or `state` does not lie at a strobe.
    ContactError
        If the motion cannot be followed.

    See Also
    --------
    onset_orbit : Settle after the drive is raised through grazing.
    orbit_diagram : Settle at one amplitude after the other.

    Examples
    --------
    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
    >>> from contact.orbits import settle
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=22.2))
    >>> strobed = StroboscopicMap(oscillator=oscillator).at(1e-3)
    >>> settled = settle(strobed, strobed.at(-1e-3).steady(), most_cycles=1000)
    >>> settled.m, settled.impacts
    (5, 1)
    """
    require_map(strobed)
    require_whole("most_cycles", most_cycles, "drive periods", low=0)
    largest_m = require_whole("largest_m", largest_m, "drive periods")
    fine = require_within("tolerance", tolerance, "[1]", low=0) * strobed.scale
    block, cycles = 2 * largest_m, 0
    proof: Any = _Proof(strobed, largest_m, fine) if prove and isinstance(strobed, StroboscopicMap) else None
    while True:
        strobes = strobed.orbit(state, block)
        state, cycles = strobes.end, cycles + block
        points, impacts, over = strobes.points, strobes.impacts, cycles >= most_cycles
        m = repeats_after(points, impacts, largest_m=largest_m, tolerance=fine)
        if not over and m != repeats_after(points, impacts, largest_m=m, tolerance=ALIKE * fine):
            m = 0
        if proof is not None and not over and m == 0:
            m, strobes = proof.after(strobes)
        if over or m:
            hits = int(strobes.impacts[-m:].sum())
            return Settled(m=m, impacts=hits, end=strobes.end, cycles=cycles, points=strobes.points)


def onset_orbit(
    strobed: StrobedMap[S], excess: float = 1e-3, *, below: float = BELOW, most_cycles: int = 4000
) -> Settled[S]:
    """Return the orbit on which the motion settles when the drive is raised through grazing.

    Parameters
    ----------
    strobed : StrobedMap
        The oscillator or map; its own amplitude does not matter.
    excess : float, optional
        Excess F/F_g - 1 to which the drive is raised in one step [1].
    below : float, optional
        Excess at which the motion starts without impacts, below zero [1].
    most_cycles : int, optional
        Bound of the transient in drive periods.  Orbits next to grazing settle in some hundred periods.

    Returns
    -------
    Settled
        Period, impacts and end of the settled motion; period 0 if none up to 64 was found.

    Raises
    ------
    TypeError, ValueError, ContactError
        If `settle` raises them, or if `below` is not below zero.

    See Also
    --------
    settle : Settle from any state.
    orbit_end : Where this orbit ends when the drive is lowered.

    Examples
    --------
    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
    >>> from contact.orbits import onset_orbit
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=21.5))
    >>> onset = onset_orbit(StroboscopicMap(oscillator=oscillator), excess=1e-3)
    >>> print(f"period {onset.m}, with {onset.impacts} impact")
    period 4, with 1 impact
    """
    require_map(strobed)
    raised = strobed.at(excess)
    require_within("below", below, "[1]", below=0)
    return settle(raised, strobed.at(below).steady(), most_cycles=most_cycles)


def onset_m(
    strobed: StrobedMap[Any], excess: float = 1e-3, *, below: float = BELOW, most_cycles: int = 4000
) -> int:
    """Return the period of the orbit on which the motion settles above grazing.

    Parameters
    ----------
    strobed : StrobedMap
        The oscillator or map; its own amplitude does not matter.
    excess : float, optional
        Excess F/F_g - 1 to which the drive is raised [1].
    below : float, optional
        Excess at which the motion starts without impacts, below zero [1].
    most_cycles : int, optional
        Bound of the transient in drive periods.

    Returns
    -------
    int
        Period of the result of `onset_orbit` in drive periods; 0 if no period up to 64 was found.

    Raises
    ------
    TypeError, ValueError, ContactError
        If `onset_orbit` raises them.
    """
    return onset_orbit(strobed, excess, below=below, most_cycles=most_cycles).m


def orbit_near(strobed: StroboscopicMap, state: State, m: int, impacts: int) -> PeriodicOrbit | None:
    """The stable, admissible orbit next to `state`, by shooting; None if there is none."""
    try:
        family = Shooting(oscillator=strobed.oscillator, m=m, impacts=impacts)
        orbit = family.from_state(replace(state, time=0.0))
    except (ContactError, Refusal):
        return None
    return orbit if orbit.stable and orbit.admissible else None


Cycle = tuple[PeriodicOrbit, StrobedOrbit[State]]  # an orbit, and one period of its strobes


class _Proof:
    """The proof of the module's docstring, strobes after strobes of a transient."""

    def __init__(self, strobed: StroboscopicMap, largest_m: int, rounding: float) -> None:
        self.strobed, self.largest_m, self.rounding = strobed, largest_m, rounding
        self.known: Cycle | None = None
        self.before = np.inf
        self.failed = np.inf  # change over a period when an orbit was looked for in vain

    def look(self, state: State, m: int, impacts: int) -> Cycle | None:
        """The orbit next to `state`; None if it has a shorter period or is not found."""
        orbit = orbit_near(self.strobed, state, m, impacts)
        if orbit is None:
            return None
        cycle = self.strobed.orbit(replace(orbit.strobe_state(), time=0.0), m)
        points, counts = np.tile(cycle.points, (2, 1)), np.zeros(2 * m)
        shortest = repeats_after(points, counts, largest_m=m, tolerance=ALIKE * self.rounding)
        return (orbit, cycle) if shortest == m else None

    def after(self, strobes: StrobedOrbit[State]) -> tuple[int, StrobedOrbit[State]]:
        """m, and a block on the orbit in the phase of the motion; 0 and `strobes` without a proof."""
        strobed, points, end = self.strobed, strobes.points, strobes.end
        close = FIRST_LOOK * strobed.scale
        rough = repeats_after(points, strobes.impacts, largest_m=self.largest_m, tolerance=close)
        hits, found = int(strobes.impacts[-rough:].sum()), None
        if self.known is None or (self.known[0].m, self.known[0].impacts) != (rough, hits):
            self.known, self.before = None, np.inf
            if rough and hits == 0:
                numbers = strobed.oscillator.numbers()
                if free_for_good(numbers, *deviations(numbers, 0.0, end.displacement, end.velocity)):
                    found = 1, strobed.steady()
            elif 0 < rough <= self.largest_m // 2:
                open_by = float(np.max(np.abs(points[rough:] - points[:-rough])[-self.largest_m :]))
                if not CLOSER * self.failed <= open_by <= self.failed / CLOSER**3:
                    self.known = self.look(end, rough, hits)
                    self.failed = open_by if self.known is None else np.inf
        if self.known is not None:
            orbit, cycle = self.known
            gaps = [np.max(np.abs(points[-rough:] - np.roll(cycle.points, -k, axis=0))) for k in range(rough)]
            distance, phase = float(min(gaps)), int(np.argmin(gaps))
            predicted = SLACK * abs(orbit.multipliers[0]) ** (len(points) / rough) * self.before
            if self.before < NEAR * strobed.scale and distance <= predicted + self.rounding:
                found = rough, strobed.orbit(cycle.end, phase or rough).end
            self.before = distance
        if found is None:
            return 0, strobes
        return found[0], strobed.orbit(replace(found[1], time=end.time), len(points))
