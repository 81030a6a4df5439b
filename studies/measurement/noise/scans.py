"""Scans of the amplitude as an observer makes them, with noise of the drive.

The observer raises or lowers the amplitude by a step, smoothly over `RAMP` of the waiting that follows, and
notes p_m if more than half of the periods lie between impacts m periods apart.  p_1 is noted if more than
half of them lie in spans without impact longer than `QUIET` periods.

    lost, left         the first amplitude at which p_m, or p_1, is not noted
    slipped, touched   before that: for the first time two impacts are not m periods apart; the first impact
                       (in the first half of the waiting, or it counts for the next step)

Below its fold the motion can be thrown back to p_m many times before it is lost.  A scan begins at a random
part of a step, so that results do not lie on a grid; downwards it begins on p_m next to its fold, where this
leaves space for the noise.  Whether a scan from above grazing reaches p_m at all is a question of its own
(`meets`): low in a band Eq. (1) is chaotic there, and can end in p_1 first.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from contact import ContactError
from contact.orbits import onset_orbit
from studies.measurement.noise.places import Place
from studies.physics.drive_noise import Array, Drift, DriveNoise, watched

FAR = 6.0  # standard deviations of the noise, beside two steps, from the start of a scan to the orbit's end
BEYOND = 30  # steps beyond the end of an orbit at most: p_m held by noise alone lasts a few
RAMP = 0.02  # part of the waiting in which the amplitude goes to its new value, without overshoot
MEETINGS = 10  # scans from the scene's `born_excess` for the share of them that meets p_m
MARGIN = 3.0
"""Standard deviations of the noise above the start of a scan at which p_m must still be: in the low half of a
band Eq. (1) has it in a window above its fold only, up to the graze of another touch, at the end of the band
too narrow to hold it in noise."""
RATIO = 20.0  # of noise and step, or of step and noise, at most
FEWEST = 1000  # drive periods waited: long against `QUIET`
EPS = 1e-9

ENDS = ("slipped", "lost", "touched", "left")
"""Ends that are noted: of p_m downwards, of p_1 upwards."""


@dataclass(frozen=True, kw_only=True)
class Protocol(DriveNoise):
    """How a scan is made, in which noise.

    Parameters
    ----------
    step : float
        Of the excess [1].
    waiting : int
        At each amplitude, in drive periods.
    """

    step: float
    waiting: int

    @property
    def reach(self) -> float:
        """How far from the end of an orbit a scan begins [1]."""
        return FAR * self.stability + 2.0 * self.step

    @property
    def steps(self) -> int:
        """Most steps of a scan."""
        return math.ceil(2.0 * self.reach / self.step) + BEYOND

    def __post_init__(self) -> None:
        low, high = self.stability / RATIO, self.stability * RATIO
        if not low * (1.0 - EPS) <= self.step <= high * (1.0 + EPS):
            valid = f"with a stability of {self.stability:g} it must lie between {low:g} and {high:g}"
            raise InvalidValue(f"amplitude_step is {self.step:g} [1]; {valid}")


def waitings(
    strobed: Any, state: Any, levels: Array, protocol: Protocol, drift: Drift
) -> Iterator[NDArray[np.int64]]:
    """Impacts of each period at the first of the `levels`, at the next one, and so on."""
    count, before = protocol.waiting, levels[0]
    ramp = np.minimum(np.arange(count) / (RAMP * count), 1.0)
    for level in levels:
        factors = (1.0 + before + (level - before) * ramp) * (1.0 + drift.next(count))
        run = strobed.orbit(state, count, factors=factors)
        yield run.impacts
        before, state = level, run.end


def scan(strobed: Any, state: Any, levels: Array, m: int, protocol: Protocol, drift: Drift) -> Array:
    """The first of `levels` at which p_m, p_1 for m = 0, is broken, and the first at which it is not seen.

    NaN where the last one is reached.
    """
    found = np.full(2, math.nan)
    try:
        for k, impacts in enumerate(waitings(strobed, state, levels[:-1], protocol, drift)):
            share, passed = watched(impacts, m)
            if math.isnan(found[0]) and passed < 1.0:
                found[0] = levels[k] if passed < 0.5 else levels[k + 1]
            if not share > 0.5:
                found[1] = levels[k]
                break
    except ContactError:  # what could not be followed has no end
        found[:] = math.nan
    return found


def meets(strobed: Any, state: Any, levels: Array, m: int, protocol: Protocol, drift: Drift) -> bool:
    """Whether p_m is seen at one of the falling `levels`, and not p_1 before."""
    with suppress(ContactError):
        for impacts in waitings(strobed, state, levels, protocol, drift):
            if watched(impacts, m)[0] > 0.5:
                return True
            if watched(impacts, 0)[0] > 0.5:
                return False
    return False


def scans(place: Place, protocol: Protocol, count: int, seed: int) -> dict[str, Array]:
    """`count` downward and upward scans: excesses at which p_m slipped and was lost, and at which p_1 was
    touched and left, each (count,); whether a scan from above "met" p_m, 0 or 1, of `MEETINGS` at most.

    NaN where the orbit was not seen at the first amplitude, or not lost in `Protocol.steps`.
    """
    key = [seed, round(1e3 * place.frequency_hz), place.m, round(1e3 * protocol.correlation_s)]

    def dice_of(i: int, way: int) -> tuple[Drift, float]:
        dice = np.random.default_rng([*key, i, way])
        return protocol.drift(place.frequency_hz, dice), dice.random()

    below = place.strobed.at(-protocol.reach).steady()
    down = start_of(place, protocol), -protocol.step, place.m
    ways = down, ((-protocol.reach, below), protocol.step, 0)
    found = np.full((len(ways), 2, count), math.nan)
    for way, (start, step, m) in enumerate(ways):
        if start is None:
            continue
        for i in range(count):
            drift, part = dice_of(i, way)
            levels: Array = start[0] + step * (np.arange(protocol.steps, dtype=np.float64) + part)
            ends = scan(place.strobed, start[1], levels, m, protocol, drift)
            found[way, :, i] = ends if ends[1] != levels[0] else math.nan
    met, top = np.empty(min(count, MEETINGS) if place.fold else 0), place.scene.scan.born_excess
    state = onset_orbit(place.strobed, top).end if place.fold else None
    for i in range(met.size):
        drift, part = dice_of(i, len(ways))
        levels = np.arange(top - part * protocol.step, place.fold.excess, -protocol.step)
        met[i] = meets(place.strobed, state, levels, place.m, protocol, drift)
    return {**dict(zip(ENDS, found.reshape(-1, count), strict=True)), "met": met}


def start_of(place: Place, protocol: Protocol) -> tuple[float, Any] | None:
    """Excess and strobe from which downward scans start; None where noise throws p_m out at once."""
    if place.fold is None:
        return None
    excess = place.fold.excess + protocol.reach
    if place.stable(excess + MARGIN * protocol.stability) is None:
        return None
    state = place.stable(excess)
    return None if state is None else (excess, state)


def cell(count: int, seed: int, where: tuple[Place, Protocol]) -> dict[str, Array]:
    """`scans` at a place in one noise."""
    return scans(*where, count, seed)
