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

from contact import MaximalFamily, StroboscopicMap, band
from contact.orbits import born, born_period, settle
from studies.letter import AMPLITUDE_STABILITY
from studies.scene import READOUT, Scene, single_mode_at

KINDS = ("jitter", "drift")

BORN_EXCESS, CYCLES = 1e-3, 4000
"""Excess of the orbit in noise, and bound of a transient [drive periods]."""

STEP = 1.1
"""Factor between excesses when the ends of an orbit are looked for."""

CORRELATION = 100.0
"""Drive periods over which the drift is correlated: some seconds, longer than 40 strobe points take."""

SHARE_OF_BAND = 0.15
"""Where in its band p_m of Eq. (1) is asked about noise, from the upper edge: as the letter's frequencies on
average."""

SKIPPED, SEED = 200, 1996
"""Noisy drive periods left out at the start; seed of the noise."""

FEWEST = 10
"""Points that a cloud must have."""

Points = NDArray[np.float64] | NDArray[np.int64]
Counts = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Clouds:
    """How well the m strobe points of p_m are told apart; lengths over the gap, None with too few points.

    `born`, `fold` [1] and `upper_end` [1] are those of the orbit without noise. `regular`: part of the
    intervals between periods with impact that are m long; `spread`: greatest width of a cloud; `separation`:
    distance of the closest two; `told_apart`: least ratio of the distance of neighbours to their mean width;
    `closest`: these two, by the strobes since the impact.
    """

    description: str
    m: int
    frequency_hz: float
    born: int
    fold: float | None = None
    upper_end: float | None = None
    noise: str
    regular: float
    spread: float | None = None
    separation: float | None = None
    told_apart: float | None = None
    closest: tuple[int, int] | None = None


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
    """Strobes since the last impact, -1 before the first one."""
    found, count = np.empty(impacts.size, dtype=np.int64), -1
    for n, touched in enumerate(impacts):
        count = 0 if touched else count + 1 if count >= 0 else -1
        found[n] = count
    return found


def apart(points: Points, impacts: Counts, period: int) -> dict[str, object]:
    """The numbers of `Clouds` from `regular` to `closest`."""
    phase, intervals = since_impact(impacts), np.diff(np.flatnonzero(impacts))
    found: dict[str, object] = {"regular": float(np.mean(intervals == period)) if intervals.size else 0.0}
    groups = [points[phase == j] for j in range(period)]
    if min(group.size for group in groups) < FEWEST:
        return found
    centre = np.array([np.median(group) for group in groups])
    width = np.array([np.quantile(group, 0.95) - np.quantile(group, 0.05) for group in groups])
    order = np.argsort(centre)
    distance = np.diff(centre[order])
    ratio = distance / np.maximum(0.5 * (width[order][1:] + width[order][:-1]), 1e-300)
    worst = int(np.argmin(ratio))
    return found | {
        "spread": float(width.max()),
        "separation": float(distance.min()),
        "told_apart": float(ratio[worst]),
        "closest": (int(order[worst]), int(order[worst + 1])),
    }


def single_mode_in_noise(scene: Scene, strobes: int, period: int) -> list[Clouds]:
    """p_m of Eq. (1) in both kinds of noise, `SHARE_OF_BAND` of its band below the upper edge."""
    keys = scene.single_mode
    edges = band(period, free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s,
                 restitution=keys.restitution)  # fmt: skip
    frequency = edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    fold = MaximalFamily.from_oscillator(strobed.oscillator, period=period).fold()
    found = []
    for kind in KINDS:
        points, impacts = noisy(strobed, kind, strobes)
        found.append(Clouds(
            description="Eq. (1)", m=period, frequency_hz=frequency, born=born_period(strobed, BORN_EXCESS),
            fold=None if fold is None else fold.excess, upper_end=upper_end(strobed, period), noise=kind,
            **apart(strobed.tip(points) / scene.stop.gap_m, impacts, period),  # type: ignore[arg-type]
        ))  # fmt: skip
    return found


def beam_in_noise(
    strobed: StroboscopicMap, period: int, strobes: int
) -> tuple[list[Clouds], dict[str, Points]]:
    """The read-out point of the beam in both kinds of noise, its points [m], strobes since the impact."""
    drive, gap = strobed.oscillator.drive, strobed.oscillator.stop.gap
    found, arrays = list[Clouds](), dict[str, Points]()
    for kind in KINDS:
        raw, impacts = noisy(strobed, kind, strobes)
        points = strobed.readout(raw, READOUT)
        arrays |= {kind: points, f"{kind}_phase": since_impact(impacts)}
        found.append(Clouds(
            description="beam", m=period, frequency_hz=drive.frequency if drive else math.nan, born=period,
            noise=kind, **apart(points / gap, impacts, max(period, 2)),  # type: ignore[arg-type]
        ))  # fmt: skip
    return found, arrays


def upper_end(strobed: StroboscopicMap, period: int, highest: float = 0.1) -> float | None:
    """Highest excess, in steps of 10 %, up to which the orbit born at 1e-3 keeps its period."""
    settled = born(strobed, BORN_EXCESS)
    if settled.period != period:
        return None
    excess, state = BORN_EXCESS, settled.end
    while excess < highest:
        settled = settle(strobed.at(STEP * excess), state, most_cycles=CYCLES)
        if settled.period != period:
            break
        excess, state = STEP * excess, settled.end
    return excess


def first_birth(strobed: StroboscopicMap, period: int, highest: float = 0.02) -> float | None:
    """Lowest excess, in steps of 10 %, at which a start from just below grazing gives this period; none is
    closer to grazing than the amplitude is stable."""
    excess = AMPLITUDE_STABILITY
    while excess < highest:
        if born_period(strobed, excess) == period:
            return excess
        excess *= STEP
    return None
