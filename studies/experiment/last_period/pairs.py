"""Intervals of the free period T from the six printed pairs (f, m), beside the printed 40.80 +- 0.02 ms.

In the map p_m is born where it exists as rho -> 0-.  This depends on f T alone and ends at f T = 2m/(2m+1).
In Eq. (1) p_m is born where the motion settles on it after a step from just below grazing to an excess.
Where that holds on several intervals of T the longest counts.  At an excess of 1e-2, where p_m coexists with
other motions, the interval has gaps that a finer grid would find.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from typing import Annotated

import numpy as np

from contact import ContactError, ImpactOscillator, MapFamily, NordmarkMap, StroboscopicMap
from contact.orbits import onset_m
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S, FREE_PERIOD_S, PERIODS
from studies.physics.parameters import with_values

FREQUENCY_ERROR_HZ, CYCLES, GRID, HALVINGS = 0.005, 8000, 121, 14
"""Half the last digit of f; most drive periods to settle; places of a grid; halvings at an end."""

EXCESSES = 0.0, AMPLITUDE_STABILITY, 1e-3, 4e-3, 1e-2  # of Eq. (1); 0 is the map
PRINTED_S = FREE_PERIOD_S - FREE_PERIOD_ERROR_S, FREE_PERIOD_S, FREE_PERIOD_S + FREE_PERIOD_ERROR_S


@dataclass(frozen=True)
class Interval:
    """Free periods at which p_m of one pair, or of several, is born; empty if lowest is above highest."""

    pairs: str
    excess: Annotated[float, "excess F/F_g − 1; 0 for the map"]
    lowest_s: Annotated[float, "shortest free period [s]"]
    highest_s: Annotated[float, "longest free period [s]"]
    from_m: Annotated[int, "m that sets the shortest"]
    to_m: Annotated[int, "m that sets the longest"]
    missed_by_s: Annotated[float, "printed period beyond the interval [s]; negative where it is shorter"]


def is_born(single: ImpactOscillator, excess: float, frequency: float, period: float) -> bool:
    """Whether the letter's p_m is born in Eq. (1), `single`, at `frequency` [Hz] with T = `period` [s]."""
    one, m = with_values(single, {"frequency": frequency, "free_period": period}), PERIODS[frequency]
    if excess == 0.0:
        return any(orbit.admissible for orbit in MapFamily(NordmarkMap.from_oscillator(one), m).at_rho(0.0))
    try:
        return onset_m(StroboscopicMap(oscillator=one), excess, most_cycles=CYCLES) == m
    except ContactError:
        return False


def longest(holds: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Bisected ends of the longest interval from `low` to `high` where `holds` is true; none: inf, -inf."""
    grid = np.linspace(low, high, GRID).tolist()
    runs = [list(part) for true, part in groupby(range(GRID), lambda i: holds(grid[i])) if true]
    run = max(runs, key=len, default=None)

    def end(last: int, next_to_it: int) -> float:
        inside, outside = grid[last], grid[min(max(next_to_it, 0), GRID - 1)]
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if holds(middle) else (inside, middle)
        return float(inside)

    return (end(run[0], run[0] - 1), end(run[-1], run[-1] + 1)) if run else (np.inf, -np.inf)


def intervals_of(single: ImpactOscillator, excess: float) -> list[Interval]:
    """Each of the six pairs; all, as printed and with the error of f; all but one that sets an end."""
    ends = dict[int, tuple[float, float]]()
    for f, m in PERIODS.items():
        low, high = (2.0 * k / ((2.0 * k + 1.0) * f) for k in (m - 1, m))  # upper edges of two bands
        width = high - low
        ends[m] = longest(partial(is_born, single, excess, f), low - 0.3 * width, high + 1.2 * width)

    def shared(words: str, periods: Sequence[int], error: float = 0.0) -> Interval:
        known = [(*ends[m], m, error / f) for f, m in PERIODS.items() if m in periods]
        low, first = max((low * (1.0 - part), m) for low, _, m, part in known)
        high, last = min((high * (1.0 + part), m) for _, high, m, part in known)
        missed = PRINTED_S[0] - high if high < PRINTED_S[0] else min(PRINTED_S[2] - low, 0.0)
        return Interval(words, excess, low, high, first, last, missed)

    every = shared("all", list(ends))
    rows = [*(shared(f"p{m}", [m]) for m in ends), every]
    rows.append(shared(f"all, f ± {FREQUENCY_ERROR_HZ:g} Hz", list(ends), FREQUENCY_ERROR_HZ))
    less = dict.fromkeys((every.from_m, every.to_m))
    return rows + [shared(f"all but p{m}", [k for k in ends if k != m]) for m in less]
