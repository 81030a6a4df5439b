"""Clouds of strobe points in noise of the drive: which p_m can be distinguished, and which is still there.

At an excess of 1e-3 the m strobe points of p_m become m clouds, sorted by the strobes since the last impact.
Over `WAITS` waitings neighbouring clouds are separate if they are further apart than wide (90 % of the
points).  In one record of the 40 strobes that the letter draws they are separate if no two overlap: a slow
drift moves all points of a record together.  p_m is held if it is seen one standard deviation of the
amplitude above grazing.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from contact import StroboscopicMap
from contact.orbits import onset_m, onset_orbit
from studies.letter import SETTLE_CYCLES, STROBE_POINTS
from studies.physics.drive_noise import DriveNoise, watched
from studies.shell.scene import READOUT, Scene, band_of

BORN_EXCESS = 1e-3  # excess of the orbit in noise

SHARE_OF_BAND = 0.15
"""Distance of the frequency from the upper edge of the band of p_m over its width: the letter's mean."""

WAITS, WAITING = 10, SETTLE_CYCLES
"""Waitings for which the orbit is followed, one after the other, and their drive periods."""

FEWEST = 10  # least number of points of a cloud

SEED = 1996

Points = NDArray[np.float64]
Counts = NDArray[np.int64]
ByNoise = Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Clouds:
    """The clouds of p_m, a number for each kind of noise; None where another period is born."""

    description: str
    m: int
    frequency_hz: float
    born: Annotated[int | None, "period born without noise; 0 for none"]
    apart: Annotated[ByNoise | None, "least distance of neighbouring clouds over their mean width"] = None
    records: Annotated[ByNoise | None, "part of the records of 40 strobes in which no clouds overlap"] = None
    held: Annotated[ByNoise | None, "part of the waitings in which p_m is seen next to grazing"] = None


def key_of(noise: DriveNoise) -> str:
    """The kind of noise in the name of a column."""
    return noise.name.replace(" ", "_")


def frequency_of(scene: Scene, m: int) -> float:
    """The drive frequency at which p_m of Eq. (1) is put into noise [Hz]."""
    edges = band_of(scene, m)
    return edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)


def since_impact(impacts: Counts) -> Counts:
    """Strobes since the last impact, below 0 before the first one."""
    n = np.arange(impacts.size)
    last = np.maximum.accumulate(np.where(impacts > 0, n, -1))
    return np.where(last < 0, -1, n - last)


def separate(points: Points, impacts: Counts, m: int) -> float:
    """Part of the records of `STROBE_POINTS` strobes in which the groups of points do not overlap."""
    records = np.arange(points.size // STROBE_POINTS * STROBE_POINTS).reshape(-1, STROBE_POINTS)[1:]
    values, phase = points[records], since_impact(impacts)[records]
    own = [np.where(phase == j, values, math.nan) for j in range(m)]
    low = np.array([np.fmin.reduce(each, axis=1) for each in own])
    high = np.array([np.fmax.reduce(each, axis=1) for each in own])
    order = np.argsort(low, axis=0)
    clear = np.take_along_axis(low, order, 0)[1:] > np.take_along_axis(high, order, 0)[:-1]
    return float(np.mean(clear.all(axis=0) & (phase < m).all(axis=1)))


def apart(points: Points, impacts: Counts, m: int) -> float:
    """Least distance of neighbouring clouds over their mean width; NaN with too few points in one."""
    groups = [points[since_impact(impacts) == j] for j in range(m)]
    if min(group.size for group in groups) < FEWEST:
        return math.nan
    low, centre, high = np.array([np.quantile(group, (0.05, 0.5, 0.95)) for group in groups]).T
    order = np.argsort(centre)
    centre, width = centre[order], (high - low)[order]
    return float(np.min(np.diff(centre) / np.maximum(0.5 * (width[1:] + width[:-1]), 1e-300)))


def clouds_of(noises: Sequence[DriveNoise], described: tuple[str, StroboscopicMap, int]) -> Clouds:
    """p_m of a named description: the tip of Eq. (1), the read-out point of a beam."""
    description, strobed, m = described
    row = Clouds(
        description=description,
        m=m,
        frequency_hz=strobed.oscillator.driven.frequency,
        born=onset_m(strobed, BORN_EXCESS),
    )
    if row.born != m:
        return row
    found = zip(*(_in_noise(noise, strobed, m) for noise in noises), strict=True)
    keys = [key_of(noise) for noise in noises]
    between, records, held = (dict(zip(keys, numbers, strict=True)) for numbers in found)
    return replace(row, apart=between, records=records, held=held)


def _in_noise(noise: DriveNoise, strobed: StroboscopicMap, m: int) -> tuple[float, float, float]:
    """`apart`, `records` and `held` of p_m in one kind of noise."""
    here, frequency = strobed.at(BORN_EXCESS), strobed.oscillator.driven.frequency
    dice = np.random.default_rng([SEED, m, round(1e3 * frequency), round(1e3 * noise.correlation_s)])
    factors = 1.0 + noise.drift(frequency, dice).next(WAITS * WAITING)
    run = here.orbit(onset_orbit(strobed, BORN_EXCESS).end, factors.size, factors=factors)
    low = onset_orbit(strobed, noise.stability).end
    lower = strobed.at(noise.stability).orbit(low, factors.size, factors=factors)
    held = [watched(part, m)[0] > 0.5 for part in np.split(lower.impacts, WAITS)]
    at_laser = READOUT in strobed.oscillator.model.points
    points = here.readout(run.points, READOUT) if at_laser else here.tip(run.points)
    between, clear = round(apart(points, run.impacts, m), 3), round(separate(points, run.impacts, m), 3)
    return between, clear, float(np.mean(held))
