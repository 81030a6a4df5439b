"""Clouds of strobe points in noise of the drive: which p_m can be told apart, and which is still there.

At an excess of 1e-3 the m strobe points of p_m become m clouds, sorted by the strobes since the last impact.
Over `WAITS` waitings, and by the covariances of ``contact.orbits.cloud``, neighbouring clouds are separate if
they are further apart than wide (90 % of the points).  In one record of the 40 strobes that the letter draws
they are separate if no two overlap: a slow drift moves all points of a record together.  Noise of the
read-out is included.  p_m is held if it is seen one standard deviation of the amplitude above grazing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact import ContactError, StroboscopicMap
from contact.orbits import born, born_period, cloud, fold_excess
from studies.letter import SETTLE_CYCLES, STROBE_POINTS
from studies.physics.drive_noise import DriveNoise, watched
from studies.shell.scene import READOUT, Scene, band_of

BORN_EXCESS = 1e-3
"""Excess of the orbit in noise."""

SHARE_OF_BAND = 0.15
"""Distance of the frequency from the upper edge of the band of p_m over its width: the letter's mean."""

WAITS, WAITING = 10, SETTLE_CYCLES
"""Waitings for which the orbit is followed, one after the other, and their drive periods."""

FEWEST = 10
"""Least number of points of a cloud."""

WIDTH = 3.2897072539029444
"""Standard deviations of a normal distribution between which 90 % lie."""

Points = NDArray[np.float64]
Counts = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Clouds:
    """The clouds of p_m, one number for each kind of noise; None where another period is born.

    Attributes
    ----------
    born, fold : int, float or None
        The period that is born without noise at excess 1e-3, and the excess of the fold of p_m.
    apart : tuple of float
        Least distance of neighbouring clouds over their mean width, simulated.
    predicted : tuple of float or None
        The same by covariances; None where the orbit has none.
    records : tuple of float
        Part of the records of 40 strobes in which no two clouds overlap.
    held : tuple of float
        Part of the waitings in which p_m is seen at an excess of one standard deviation.
    seen : tuple of bool
        Whether both parts are above one half.
    """

    description: str
    m: int
    frequency_hz: float
    born: int
    fold: float | None
    apart: tuple[float, ...] | None = None
    predicted: tuple[float | None, ...] | None = None
    records: tuple[float, ...] | None = None
    held: tuple[float, ...] | None = None
    seen: tuple[bool, ...] = ()


def frequency_of(scene: Scene, m: int) -> float:
    """The drive frequency at which p_m of Eq. (1) is put into noise [Hz]."""
    edges = band_of(scene, m)
    return edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)


def since_impact(impacts: Counts) -> Counts:
    """Strobes since the last impact, below 0 before the first one."""
    n = np.arange(impacts.size)
    last = np.maximum.accumulate(np.where(impacts > 0, n, -1))
    return np.where(last < 0, -1, n - last)


def separate(points: Points, impacts: Counts, period: int) -> float:
    """Part of the records of `STROBE_POINTS` strobes in which the groups of points do not overlap."""
    records = np.arange(points.size // STROBE_POINTS * STROBE_POINTS).reshape(-1, STROBE_POINTS)[1:]
    values, phase = points[records], since_impact(impacts)[records]
    own = [np.where(phase == j, values, math.nan) for j in range(period)]
    low = np.array([np.fmin.reduce(each, axis=1) for each in own])
    high = np.array([np.fmax.reduce(each, axis=1) for each in own])
    order = np.argsort(low, axis=0)
    clear = np.take_along_axis(low, order, 0)[1:] > np.take_along_axis(high, order, 0)[:-1]
    return float(np.mean(clear.all(axis=0) & (phase < period).all(axis=1)))


def apart(points: Points, impacts: Counts, period: int) -> float:
    """Least distance of neighbouring clouds over their mean width; NaN with too few points in one."""
    groups = [points[since_impact(impacts) == j] for j in range(period)]
    if min(group.size for group in groups) < FEWEST:
        return math.nan
    low, centre, high = np.array([np.quantile(group, (0.05, 0.5, 0.95)) for group in groups]).T
    return least_ratio(centre, high - low)


def least_ratio(centre: Points, width: Points) -> float:
    """Least distance of neighbouring centres over the mean width of the two."""
    order = np.argsort(centre)
    between = 0.5 * (width[order][1:] + width[order][:-1])
    return float(np.min(np.diff(centre[order]) / np.maximum(between, 1e-300)))


def clouds_of(
    readout: float, noises: Sequence[DriveNoise], seed: int, described: tuple[str, StroboscopicMap, int]
) -> Clouds:
    """p_m of a named description: the tip of Eq. (1), the read-out point of a beam."""
    description, strobed, m = described
    row = Clouds(
        description=description,
        m=m,
        frequency_hz=strobed.oscillator.driven.frequency,
        born=born_period(strobed, BORN_EXCESS),
        fold=fold_excess(strobed, m) if strobed.oscillator.n_modes == 1 else None,
    )
    if row.born != m:
        return row
    columns = zip(*(_in_noise(readout, noise, seed, strobed, m) for noise in noises), strict=True)
    between, predicted, records, held = columns
    seen = tuple(min(pair) > 0.5 for pair in zip(records, held, strict=True))
    return replace(row, apart=between, predicted=predicted, records=records, held=held, seen=seen)


def _in_noise(
    readout: float, noise: DriveNoise, seed: int, strobed: StroboscopicMap, m: int
) -> tuple[float, float | None, float, float]:
    """`apart`, `predicted`, `records` and `held` of p_m in one kind of noise."""
    here, frequency = strobed.at(BORN_EXCESS), strobed.oscillator.driven.frequency
    dice = np.random.default_rng([seed, m, round(1e3 * frequency), round(1e3 * noise.correlation_s)])
    factors = 1.0 + noise.drift(frequency, dice).next(WAITS * WAITING)
    orbit, low = born(strobed, BORN_EXCESS), strobed.at(noise.stability)
    run = here.orbit(orbit.end, factors.size, factors=factors)
    lower = low.orbit(born(strobed, noise.stability).end, factors.size, factors=factors)
    held = [watched(part, m)[0] > 0.5 for part in np.split(lower.impacts, WAITS)]

    def reading(points: Points) -> Points:
        at_laser = READOUT in strobed.oscillator.model.readouts
        return here.readout(points, READOUT) if at_laser else here.tip(points)

    predicted = None
    with suppress(ContactError, ValueError):  # a strobe in a touch, a graze
        spread = cloud(here, orbit.end, m, deviation=noise.stability, memory=noise.memory(frequency))
        row = reading(np.eye(spread.shape[1]))
        width = WIDTH * np.sqrt(np.einsum("i,jik,k->j", row, spread, row) + readout**2)
        predicted = round(least_ratio(reading(here.orbit(orbit.end, m).points), width), 3)
    points = reading(run.points) + readout * dice.standard_normal(factors.size)
    between, clear = round(apart(points, run.impacts, m), 3), round(separate(points, run.impacts, m), 3)
    return between, predicted, clear, float(np.mean(held))
