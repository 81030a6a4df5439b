"""A p_m orbit whose drive amplitude is noisy.

The amplitude is redrawn at every strobe, its excess 1e-3 + s d_n with s = 2.5e-4 and d_n of unit variance,
the motion relative to the base carried along:

    jitter           d_n independent from one drive period to the next
    drift            d_n = r d_(n-1) + sqrt(1 - r^2) xi_n with r = exp(-1/100): correlated over 100 periods

This is asked for p_m in Eq. (1) where the letter's frequencies lie on average: 15 % of the band below its
upper edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from contact.maximal_orbits import band
from contact.orbits.settling import born
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.sensitivity.grazing_births import BORN_EXCESS, NOISE, upper_end
from studies.instruments.sensitivity.strobe_clouds import clouds

__all__ = ["CORRELATION", "SEED", "SHARE_OF_BAND", "SKIPPED", "STROBES", "noise_at", "noisy"]

CORRELATION = 100.0
"""Drive periods over which the drift is correlated: some seconds, longer than 40 strobe points take."""

SHARE_OF_BAND = 0.15
"""Where in its band p_m is asked about noise, from the upper edge."""

STROBES, SKIPPED = 1000, 200
"""Noisy drive periods followed, and those left out at the start."""

SEED = 1996


def noisy(
    strobed: StroboscopicMap,
    observe: Callable[[np.ndarray], np.ndarray],
    kind: str,
    strobes: int,
    seed: int = SEED,
) -> tuple[np.ndarray, np.ndarray]:
    """Strobe points [m] and impacts in each period, at excess 1e-3 with a noisy amplitude."""
    dice, correlation = np.random.default_rng(seed), math.exp(-1.0 / CORRELATION)
    state, deviation = born(strobed).end, 0.0
    points, impacts = np.empty(strobes), np.zeros(strobes, dtype=np.int64)
    for n in range(strobes):
        fresh = float(dice.standard_normal())
        deviation = (
            fresh if kind == "jitter" else correlation * deviation + math.sqrt(1.0 - correlation**2) * fresh
        )
        one = strobed.at(BORN_EXCESS + NOISE * deviation).orbit(state, 1)
        state, points[n], impacts[n] = one.end, observe(one.points)[0], one.impacts[0]
    return points[SKIPPED:], impacts[SKIPPED:]


def noise_at(scene: Scene, period: int, strobes: int) -> dict[str, Any]:
    """p_m of Eq. (1) in noise, 15 % of its band below the upper edge."""
    keys = scene.single_mode
    edges = band(
        period, free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s, restitution=keys.restitution
    )
    frequency = edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)
    oscillator = single_mode_oscillator(scene, frequency)
    strobed = StroboscopicMap(oscillator=oscillator)
    fold = MaximalFamily.from_oscillator(oscillator, period=period).fold()
    row: dict[str, Any] = {
        "m": period,
        "frequency_hz": frequency,
        "band_hz": edges.upper - edges.lower,
        "born": born(strobed).period,
        "fold": None if fold is None else fold.excess,
        "upper_end": upper_end(strobed, period),
    }
    for kind in ("jitter", "drift"):
        points, impacts = noisy(strobed, strobed.tip, kind, strobes)
        row[kind] = clouds(points / scene.stop.gap_m, impacts, period)
    return row
