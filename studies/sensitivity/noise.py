"""A p_m orbit whose drive amplitude is noisy, and whether its strobe points are still told apart.

The amplitude is redrawn at every strobe, its excess 1e-3 + s d_n with s the letter's stability, 2.5e-4, and
d_n of unit variance, the motion relative to the base carried along:

    jitter           d_n independent from one drive period to the next
    drift            d_n = r d_(n-1) + sqrt(1 - r^2) xi_n with r = exp(-1/100): correlated over 100 periods

With noise the m strobe points are m clouds, sorted by the strobes since the last impact. One cloud is told
from the next if they are further apart than they are wide (90 % of the points).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact import StroboscopicMap
from contact.orbits import born, born_period, fold_excess
from studies.letter import AMPLITUDE_STABILITY
from studies.scene import READOUT, Scene, band_of

KINDS = ("jitter", "drift")

BORN_EXCESS = 1e-3
"""Excess of the orbit in noise."""

CORRELATION = 100.0
"""Drive periods over which the drift is correlated: some seconds, longer than 40 strobe points take."""

SHARE_OF_BAND = 0.15
"""Where in its band p_m of Eq. (1) is asked about noise, from the upper edge: as the letter's frequencies on
average."""

SKIPPED, SEED = 200, 1996
"""Noisy drive periods left out at the start; seed of the noise."""

FEWEST = 10
"""Points that a cloud must have."""

Points = NDArray[np.float64]
Counts = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Clouds:
    """How well the m strobe points of p_m are told apart.

    `born` and `fold` [1] (Eq. (1) alone) are those of the orbit without noise. `regular`: part of the
    intervals between periods with impact that are m long; `told_apart`: least ratio of the distance of
    neighbours to their mean width, NaN with too few points.
    """

    description: str
    m: int
    frequency_hz: float
    born: int
    fold: float | None = None
    noise: str
    regular: float
    told_apart: float


def noisy(strobed: StroboscopicMap, kind: str, strobes: int) -> tuple[Points, Counts]:
    """Strobed coordinates and impacts in each of `strobes` periods at excess 1e-3 with a noisy amplitude."""
    dice, correlation = np.random.default_rng(SEED), math.exp(-1.0 / CORRELATION)
    state, deviation = born(strobed, BORN_EXCESS).end, 0.0
    points, impacts = [], []
    for _ in range(strobes + SKIPPED):
        fresh = float(dice.standard_normal())
        drifted = correlation * deviation + math.sqrt(1.0 - correlation**2) * fresh
        deviation = fresh if kind == "jitter" else drifted
        one = strobed.at(BORN_EXCESS + AMPLITUDE_STABILITY * deviation).orbit(state, 1)
        state = one.end
        points.append(one.points[0])
        impacts.append(one.impacts[0])
    return np.array(points)[SKIPPED:], np.array(impacts)[SKIPPED:]


def since_impact(impacts: Counts) -> Counts:
    """Strobes since the last impact, below 0 before the first one."""
    n = np.arange(impacts.size)
    last = np.maximum.accumulate(np.where(impacts > 0, n, -1))
    return np.where(last < 0, -1, n - last)


def apart(points: Points, impacts: Counts, period: int) -> tuple[float, float]:
    """`regular` and `told_apart` of `Clouds`."""
    phase, intervals = since_impact(impacts), np.diff(np.flatnonzero(impacts))
    regular = float(np.mean(intervals == period)) if intervals.size else 0.0
    groups = [points[phase == j] for j in range(period)]
    if min(group.size for group in groups) < FEWEST:
        return regular, math.nan
    low, centre, high = np.array([np.quantile(group, (0.05, 0.5, 0.95)) for group in groups]).T
    order = np.argsort(centre)
    width = (high - low)[order]
    ratio = np.diff(centre[order]) / np.maximum(0.5 * (width[1:] + width[:-1]), 1e-300)
    return regular, float(ratio.min())


def frequency_of(scene: Scene, m: int) -> float:
    """Where p_m of Eq. (1) is asked about noise [Hz]."""
    edges = band_of(scene, m)
    return edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)


def in_noise(strobes: int, described: tuple[str, StroboscopicMap, int]) -> list[Clouds]:
    """p_m of a named description in both kinds of noise: the tip of Eq. (1), the read-out point of a beam."""
    description, strobed, m = described
    model, period = strobed.oscillator.model, born_period(strobed, BORN_EXCESS)
    fold, found = fold_excess(strobed, m) if model.n_modes == 1 else None, list[Clouds]()
    for kind in KINDS:
        raw, impacts = noisy(strobed, kind, strobes)
        points = strobed.readout(raw, READOUT) if READOUT in model.readouts else strobed.tip(raw)
        regular, told_apart = apart(points, impacts, max(m, 2))
        found.append(Clouds(
            description=description, m=m, frequency_hz=strobed.oscillator.drive.frequency, born=period,  # type: ignore[union-attr]
            fold=fold, noise=kind, regular=regular, told_apart=told_apart,
        ))  # fmt: skip
    return found
