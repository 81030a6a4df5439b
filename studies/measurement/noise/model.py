"""Where orbits end in scans, and the hysteresis that an observer measures.

The observed hysteresis is the excess at which p_1 is left less that at which p_m is lost.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from studies.measurement.noise.places import Place
from studies.measurement.noise.rates import law_of, quantiles
from studies.measurement.noise.scans import ENDS, Protocol

PARTS = (0.05, 0.5, 0.95)

Scans = Mapping[str, np.ndarray]
Made = tuple[Place, Protocol, Scans]


@dataclass(frozen=True)
class End:
    """Excess at which an orbit ends in scans. Slips and touches have a formula of the median."""

    frequency_hz: float
    m: int
    noise: Annotated[str, "noise of the drive amplitude"]
    fold: Annotated[float | None, "fold of p_m without noise, F/F_g − 1"]
    end: Annotated[str, "how the orbit ends"]
    scans: Annotated[int, "number of scans"]
    low: Annotated[float, "excess at the end, 5 % of the scans"]
    median: Annotated[float, "excess at the end, median"]
    high: Annotated[float, "excess at the end, 95 % of the scans"]
    error: Annotated[float, "standard error of the median"]
    formula: Annotated[float | None, "median by formula"] = None
    off: Annotated[float | None, "formula less median, in standard errors"] = None


@dataclass(frozen=True)
class Observed:
    """The observed hysteresis; NaN where most scans do not reach p_m, or where noise throws p_m out at once.

    It is `seen` if it exceeds a step in 95 % of the pairs.
    """

    frequency_hz: float
    m: int
    noise: Annotated[str, "noise of the drive amplitude"]
    map: Annotated[float | None, "hysteresis of the map without noise"]
    fold: Annotated[float, "hysteresis of Eq. (1) without noise"]
    scans: Annotated[int, "number of pairs of scans"]
    low: Annotated[float, "observed hysteresis, 5 % of the pairs"]
    median: Annotated[float, "observed hysteresis, median"]
    high: Annotated[float, "observed hysteresis, 95 % of the pairs"]
    met: Annotated[float, "part of the scans from above grazing that reach p_m and not p1 before"]
    seen: Annotated[bool, "whether the hysteresis is seen"]


def ends_of(made: Made) -> list[End]:
    """The ends at one place in one noise."""
    place, protocol, scans = made
    rows, fold = list[End](), None if place.fold is None else place.fold.excess
    for name in ENDS:
        values = np.sort(scans[name][np.isfinite(scans[name])])
        if values.size < 2:
            continue
        law = law_of(place, protocol, name) if name in ("slipped", "touched") else None
        formula = quantiles(law, (0.5,))[0] if law else None
        # ranks half a binomial standard deviation, sqrt(n)/2, below and above the median
        ranks = 0.5 * (values.size + np.array([-1.0, 1.0]) * math.sqrt(values.size))
        below, above = np.interp(ranks, np.arange(values.size) + 0.5, values)
        (low, median, high), error = np.quantile(values, PARTS).tolist(), 0.5 * float(above - below)
        off = None if formula is None else (formula - median) / error
        found = name, values.size, low, median, high, error, formula, off
        rows.append(End(place.frequency_hz, place.m, protocol.name, fold, *found))
    return rows


def observed_of(made: Made) -> Observed | None:
    """The hysteresis at one place in one noise; None without a fold."""
    place, protocol, found = made
    if place.fold is None:
        return None
    widths = found["left"] - found["lost"]
    count, met = int(np.count_nonzero(np.isfinite(widths))), float(found["met"].mean())
    often = count > 0.5 * widths.size and met > 0.5
    low, median, high = np.nanquantile(widths, PARTS) if often else (math.nan,) * 3
    by_map = None if place.map_fold is None else -place.map_fold
    about = place.frequency_hz, place.m, protocol.name, by_map, -place.fold.excess
    return Observed(*about, count, low, median, high, met, bool(low > protocol.step))
