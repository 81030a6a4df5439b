"""The plane of the chart, the cells of one column, and what all of them say.

Frequencies are evenly spaced. Excesses are even in

    s = asinh(excess/KNEE),   KNEE = 0.005,

in steps of (range of s) KNEE/(n - 1) around grazing and in proportion to the excess far from it: the
hysteresis of the letter's transitions, 1e-4 to 1.3e-2, would be lost within a step or two of an even grid of
400 amplitudes over -0.15 ... 0.1; here the step at grazing is 1e-4 and the last ones are 3e-3, ten to the
width of the islands near -0.1.

Theory draws over the chart the band edges of the map, and the folds at which p_m orbits end. Bands
(``contact.frequency_band``) are the frequencies at which p_m appears at grazing in the map. Folds come in
closed form for Eq. (1) (``contact.MaximalFamily``), and by shooting and continuation along the frequency for
the beam (``contact.orbits``). Only orbits with one impact are drawn, and only where no further touch spoils
them (certified).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue
from contact import Band, ImpactOscillator
from contact.orbits import AmplitudeScan, PeriodicOrbit, Shooting, fold_along_frequency
from studies.physics.descriptions import fold_orbit
from studies.physics.parameters import with_values
from studies.shell.options import MOST_CELLS
from studies.shell.scene import Scene, band_of
from studies.shell.sweep import Column

FREQUENCIES_HZ = (19.5, 24.0)
EXCESSES = (-0.15, 0.1)
KNEE = 0.005
DIRECTIONS = ("up", "down")


def sheared(excess: float | Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    """s of the module's docstring: the upright coordinate of the chart [1]."""
    found: NDArray[np.float64] = np.arcsinh(np.asarray(excess, dtype=float) / KNEE)
    return found


@dataclass(frozen=True, kw_only=True)
class Plane:
    """`columns` frequencies between given ends [Hz] by `rows` excesses [1]."""

    columns: int
    rows: int
    frequencies_hz: tuple[float, float] = FREQUENCIES_HZ

    def __post_init__(self) -> None:
        if self.columns * self.rows > MOST_CELLS:
            found = f"{self.columns} {self.rows}, which makes {self.columns * self.rows:.3g} cells"
            raise InvalidValue(f"points is {found}; at most {MOST_CELLS} are computed")

    def frequencies(self) -> NDArray[np.float64]:
        """All of them, rising [Hz]."""
        return np.linspace(*self.frequencies_hz, self.columns)

    def rising_excesses(self) -> NDArray[np.float64]:
        """All of them, rising [1]."""
        low, high = sheared(EXCESSES).tolist()
        excesses: NDArray[np.float64] = KNEE * np.sinh(np.linspace(low, high, self.rows))
        excesses[[0, -1]] = EXCESSES
        return excesses


def column_at(frequency: float, scan: AmplitudeScan, plane: Plane) -> Column:
    """The amplitude raised and lowered again at a frequency [Hz]: arrays that broadcast to (2, rows), the
    upward scan first."""
    excesses = plane.rising_excesses()
    found = scan(frequency, excesses)
    return {
        "frequency_hz": np.array(frequency),
        "direction": np.array(DIRECTIONS)[:, None],
        "excess": excesses,
        "m": found.m,
        "impacts": found.impacts,
        "cycles": found.cycles,
        "reason": found.reason,
    }


@dataclass(frozen=True, kw_only=True)
class Fold:
    """The exact end of a p_m orbit with one impact."""

    m: int
    frequency_hz: float
    excess: float


LARGEST = 24  # largest m that is drawn; its band ends at 23.98 Hz for the letter's period

FEWEST = 7  # folds of the beam looked for in each band at least, so that its curve is smooth


def bands_in(scene: Scene, low: float, high: float) -> tuple[Band, ...]:
    """The bands of p_2 ... p_24 that reach into `low` ... `high` [Hz]."""
    found = (band_of(scene, m) for m in range(2, LARGEST + 1))
    return tuple(band for band in found if band.upper > low and band.lower < high)


def folds_of_single_mode(oscillator: ImpactOscillator, frequencies: np.ndarray, lowest: float) -> list[Fold]:
    """The folds of Eq. (1) at `frequencies` [Hz] above the excess `lowest`."""
    found = []
    for frequency in frequencies.tolist():
        here = with_values(oscillator, {"frequency": frequency})
        for period in range(2, LARGEST + 1):
            fold = fold_orbit(here, period)
            if fold is not None and fold.excess > lowest and fold.admissible:
                found.append(Fold(m=period, frequency_hz=frequency, excess=fold.excess))
    return found


def folds_of_beam(
    oscillator: ImpactOscillator, near: tuple[Band, ...], frequencies: np.ndarray, lowest: float
) -> list[Fold]:
    """The folds of the beam in and a little below the bands `near`, above the excess `lowest`.

    At the `frequencies` [Hz] that lie there, or where these are few at some more within their range.
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
        there = with_values(oscillator, {"frequency": float(inside[middle])})
        family = Shooting(oscillator=there, m=band.m)
        for way in (inside[middle::-1], inside[middle + 1 :]):
            for frequency, fold in zip(way.tolist(), fold_along_frequency(family, way), strict=True):
                if isinstance(fold, PeriodicOrbit) and fold.admissible and fold.excess > lowest:
                    found.append(Fold(m=band.m, frequency_hz=frequency, excess=fold.excess))
    return sorted(found, key=lambda one: (one.m, one.frequency_hz))
