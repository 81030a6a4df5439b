"""What theory draws over the chart: band edges of the map, and the folds at which p_m orbits end.

Bands (``contact.band``): frequencies at which p_m is born at grazing in the map.  Folds: in closed
form for Eq. (1) (``contact.MaximalFamily``), by shooting and continuation along the frequency for the
beam (``contact.orbits``).  Only orbits with one impact, and only where no further touch spoils
them (certified).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contact import Band, ImpactOscillator, MaximalFamily
from contact.orbits import Shooting, fold_along_frequency
from studies.experiment.chart.cells import Fold
from studies.shell.scene import Scene, band_of

LARGEST = 24
"""Largest m that is drawn; its band ends at 23.98 Hz for the letter's period."""

FEWEST = 7
"""Folds of the beam looked for in each band at least, so that its curve is smooth."""


def bands_in(scene: Scene, low: float, high: float) -> tuple[Band, ...]:
    """The bands of p_2 ... p_24 that reach into `low` ... `high` [Hz]."""
    found = (band_of(scene, m) for m in range(2, LARGEST + 1))
    return tuple(band for band in found if band.upper > low and band.lower < high)


def folds_of_single_mode(oscillator: ImpactOscillator, frequencies: np.ndarray, lowest: float) -> list[Fold]:
    """The folds of Eq. (1) at `frequencies` [Hz] above the excess `lowest`."""
    found = []
    for frequency in frequencies.tolist():
        here = _driven(oscillator, frequency)
        for period in range(2, LARGEST + 1):
            fold = MaximalFamily.from_oscillator(here, period=period).fold()
            if fold is not None and fold.excess > lowest and fold.admissible:
                found.append(Fold(period=period, frequency_hz=frequency, excess=fold.excess))
    return found


def _driven(oscillator: ImpactOscillator, frequency: float) -> ImpactOscillator:
    return replace(oscillator, drive=replace(oscillator.driven, frequency=frequency))


def folds_of_beam(
    oscillator: ImpactOscillator, near: tuple[Band, ...], frequencies: np.ndarray, lowest: float
) -> list[Fold]:
    """The folds of the beam in and a little below the bands `near`, above the excess `lowest`.

    At those of `frequencies` [Hz] that lie there, or where these are few at some more within their range.
    """
    found = []
    for band in near:
        low = max(float(frequencies[0]), band.lower - 0.1 * (band.upper - band.lower))
        high = min(float(frequencies[-1]), band.upper)
        if not low < high:
            continue
        inside = frequencies[(frequencies >= low) & (frequencies <= high)]
        if inside.size < FEWEST:
            inside = np.union1d(inside, np.linspace(low, high, FEWEST))
        middle = inside.size // 2
        family = Shooting(oscillator=_driven(oscillator, float(inside[middle])), period=band.period)
        for way in (inside[middle::-1], inside[middle + 1 :]):
            for frequency, fold in zip(way.tolist(), fold_along_frequency(family, way), strict=True):
                if fold is not None and fold.admissible and fold.excess > lowest:
                    found.append(Fold(period=band.period, frequency_hz=frequency, excess=fold.excess))
    return sorted(found, key=lambda one: (one.period, one.frequency_hz))
