"""Clouds of strobe points in noise of the drive and of the read-out: covariances against simulated motions.

A p_m orbit half way between its fold and grazing is followed for many periods in noise so weak that the
theory of first order (``contact.orbits.cloud``) holds; means of products over blocks, each far longer than
the noise remembers, have a standard error of their own.  How clouds grow: as the inverse fourth root of the
distance to the fold, along the one direction whose multiplier becomes 1; and towards grazing at the upper
edge of a band, where the orbit shrinks with the excess, as its inverse square root, so that at distances of
the size of the noise they are of the size of its square root (Simpson, Hogan and Kuske, arXiv:1207.2703).
At grazing itself impacts follow one another within a turn, and a square root is taken of a square root.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from contact.orbits import cloud
from studies.measurement.noise.places import Place
from studies.measurement.noise.scans import Drift, memory_of, named

BLOCKS = 100
WEAK = {"map": 1e-10, "Eq. (1)": 1e-7, "beam": 1e-7}
"""Noise so weak that the cloud is linear: the map's orbits are thinner."""

MEMORIES_S = (0.0, 1.0)
FOLD_DISTANCES = (1e-2, 1e-3, 1e-4)
"""From the fold, over its own distance from grazing."""

EXCESSES = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
SOFT = {"beam": 1e-4}
"""Excess below which a contact that is not hard has other orbits: Hertz's halves the kick at 7e-5."""

CLEAR = 30.0
"""Distance from grazing, in standard deviations, at which a cloud is all on one side."""

EXPONENTS = {"fold": -0.25, "grazing": -0.5, "noise, 30 of it above grazing": 0.5}
"""What the standard deviation of a cloud is expected to grow with."""

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Covariance:
    """Simulated covariances at the m strobes over the predicted ones.

    `ratio`: of the traces, `error` its standard error; `worst` of all entries, in standard errors, of
    `entries`; `readout`: variance of a reading of the tip with noise as large as the cloud, over the sum of
    both.
    """

    description: str
    m: int
    frequency_hz: float
    noise: str
    periods: int
    ratio: float
    error: float
    worst: float
    entries: int
    readout: float


@dataclass(frozen=True, kw_only=True)
class Growth:
    """Exponent with which the deviation of the points grows, simulated, and expected at a hard stop."""

    description: str
    towards: str
    exponent: float
    expected: float


def folded(place: Place) -> Any:
    """The orbit at the fold of a place; ValueError without one."""
    if place.fold is None:
        raise InvalidValue(f"p{place.m} has no fold below grazing at {place.frequency_hz:g} Hz")
    return place.fold


def away(place: Place, excess: float, state: object, noise: Array) -> Array:
    """Points of the orbit through `state` in noise, less those without, shape (m, cycles, coordinates)."""
    strobed, m = place.strobed.at(excess), place.m
    clean = strobed.orbit(state, m).points
    noisy = strobed.orbit(state, noise.size, factors=1.0 + noise).points
    cycles = noise.size // m
    return np.asarray(noisy[: cycles * m].reshape(cycles, m, -1).swapaxes(0, 1) - clean[:, None])


def drift(place: Place, deviation: float, correlation_s: float, count: int, seed: int) -> Array:
    """Noise of `count` periods."""
    dice = np.random.default_rng([seed, count, round(1e3 * correlation_s)])
    return Drift(deviation, memory_of(correlation_s, place.frequency_hz), dice).next(count)


def covariance_of(periods: int, seed: int, case: tuple[Place, float]) -> Covariance:
    """One description in noise with a correlation time [s]."""
    place, correlation_s = case
    excess, sigma = 0.5 * folded(place).excess, WEAK[place.description]
    state = place.stable(excess)
    strobed, memory = place.strobed.at(excess), memory_of(correlation_s, place.frequency_hz)
    predicted = cloud(strobed, state, place.m, deviation=sigma, memory=memory)
    found = away(place, excess, state, drift(place, sigma, correlation_s, periods, seed))
    found = found[:, found.shape[1] // 20 :]  # settled
    found = found[:, : found.shape[1] // BLOCKS * BLOCKS]
    size = min(found.shape[2], 4)
    blocks = found[:, :, :size].reshape(place.m, BLOCKS, -1, size)
    products = np.einsum("jbni,jbnk->jbik", blocks, blocks) / blocks.shape[2]
    error = products.std(axis=1, ddof=1) / math.sqrt(BLOCKS)
    off = np.abs(products.mean(axis=1) - predicted[:, :size, :size]) / error
    traces = np.einsum("jbii->b", products) / np.einsum("jii->", predicted[:, :size, :size])
    across = place.across(found.shape[2])
    expected = np.einsum("i,jik,k->j", across, predicted, across)
    reading = np.random.default_rng([seed, 1]).standard_normal(found.shape[:2]) * np.sqrt(expected)[:, None]
    readout = np.var(found @ across + reading, axis=1) / (2.0 * expected)
    return Covariance(
        description=place.description,
        m=place.m,
        frequency_hz=place.frequency_hz,
        noise=named(correlation_s),
        periods=periods,
        ratio=float(traces.mean()),
        error=float(traces.std(ddof=1) / math.sqrt(BLOCKS)),
        worst=float(off.max()),
        entries=place.m * size * (size + 1) // 2,
        readout=float(readout.mean()),
    )


def growth_of(periods: int, seed: int, case: tuple[Place, Place]) -> list[Growth]:
    """Exponents of one description: a place with a fold, and one at the upper edge of the band."""
    inside, edge = case
    fold, found = folded(inside), dict[str, list[tuple[float, float]]]()
    periods //= 1 if inside.model is None else 10

    def add(name: str, at: float, place: Place, excess: float, sigma: float, over: float) -> None:
        state = place.stable(excess)
        if state is not None:
            noise = drift(place, sigma, 0.0, periods, seed)
            spread = away(place, excess, state, noise)[0, periods // (10 * place.m) :]
            found.setdefault(name, []).append((at, float(np.sqrt(np.var(spread, axis=0).sum())) / over))

    for part in FOLD_DISTANCES:
        gap = part * abs(fold.excess)
        add("fold", gap, inside, fold.excess + gap, 1e-4 * gap, 1e-4 * gap)
    for excess in (x for x in EXCESSES if x >= SOFT.get(edge.description, 0.0)):
        add("grazing", excess, edge, excess, 1e-3 * excess, 1e-3 * excess)
        add("noise, 30 of it above grazing", excess, edge, excess, excess / CLEAR, 1.0)
    rows = []
    for name, expected in EXPONENTS.items():
        if len(found.get(name, ())) > 1:
            x, y = np.log(np.array(found[name])).T
            slope = float(np.polynomial.Polynomial.fit(x, y, 1).convert().coef[1])
            rows.append(
                Growth(description=inside.description, towards=name, exponent=slope, expected=expected)
            )
    return rows
