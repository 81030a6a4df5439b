"""What the six printed pairs (f, m) say about the free period T in motion, beside 40.80 +- 0.02 ms.

    map      the band in which the map has p_m as rho -> 0-: a matter of f T, up to f T = 2m/(2m+1)
    has      Eq. (1) has a stable p_m, in closed form (``contact.orbits.MaximalFamily``): below, its last peak
             but one reaches the stop, above the period doubles
    settles  p_m is what Eq. (1) settles on when it is raised to the excess from just below grazing

Where that holds on several stretches of T the longest counts; at an excess of 1e-2, where p_m coexists with
others, it has gaps that a finer grid would find.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, product

import numpy as np
from matplotlib.figure import Figure

from contact import ContactError, ImpactOscillator, MapFamily, NordmarkMap, StroboscopicMap
from contact.orbits import MaximalFamily, born_period
from studies import plotting
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S, FREE_PERIOD_S, PERIODS
from studies.parameters import with_values

FREQUENCY_ERROR_HZ, CYCLES, GRID, HALVINGS = 0.005, 8000, 121, 14
"""Half the last digit of f; most drive periods to settle; places of a grid; halvings at a stretch's ends."""

WAYS = (("map", 0.0), ("has", 0.0), *product(["settles"], (AMPLITUDE_STABILITY, 1e-3, 4e-3, 1e-2)))
KINDS = [(*way, tau) for tau, way in product((0.1, 0.0, 0.3), WAYS)]
PRINTED_S = FREE_PERIOD_S - FREE_PERIOD_ERROR_S, FREE_PERIOD_S, FREE_PERIOD_S + FREE_PERIOD_ERROR_S

Kind = tuple[str, float, float]
"""Description, excess [1] (0: at grazing), tau [1]."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """Free periods [s] at which p_m of one pair, or of several, is born (lowest above highest: at none), the
    m that set the ends, and how far 40.80 +- 0.02 ms lies above it (below it: negative) [s]."""

    pairs: str
    description: str
    excess: float
    restitution: float
    lowest_s: float
    highest_s: float
    from_m: int
    to_m: int
    missed_by_s: float

    def __str__(self) -> str:
        return f"{1e3 * self.lowest_s:.3f} (p{self.from_m}) to {1e3 * self.highest_s:.3f} ms (p{self.to_m})"


def is_born(single: ImpactOscillator, kind: Kind, frequency: float, period: float) -> bool:
    """Whether Eq. (1), `single`, gives birth to the letter's p_m at `frequency` [Hz], its T `period` [s]."""
    (description, excess, tau), m = kind, PERIODS[frequency]
    one = with_values(single, {"frequency": frequency, "free_period": period, "restitution": tau})
    if description == "map":
        return any(orbit.admissible for orbit in MapFamily(NordmarkMap.from_oscillator(one), m).at_rho(0.0))
    if description == "has":
        orbits = MaximalFamily(oscillator=one, period=m).orbits(excess)
        return any(orbit.admissible and orbit.stable for orbit in orbits)
    try:
        return born_period(StroboscopicMap(oscillator=one), excess, most_cycles=CYCLES) == m
    except ContactError:
        return False


def longest(holds: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Ends of the longest stretch from `low` to `high` where something holds, bisected; none: inf, -inf."""
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


def intervals_of(single: ImpactOscillator, kind: Kind) -> list[Interval]:
    """The six pairs, each, all as printed and with the error of f, and all but those that set the ends."""
    ends = dict[int, tuple[float, float]]()
    for f, m in PERIODS.items():
        low, high = (2.0 * k / ((2.0 * k + 1.0) * f) for k in (m - 1, m))  # upper edges of two bands
        room = high - low
        ends[m] = longest(partial(is_born, single, kind, f), low - 0.3 * room, high + 1.2 * room)

    def shared(words: str, periods: Sequence[int], error: float = 0.0) -> Interval:
        known = [(*ends[m], m, error / f) for f, m in PERIODS.items() if m in periods]
        low, first = max((low * (1.0 - part), m) for low, _, m, part in known)
        high, last = min((high * (1.0 + part), m) for _, high, m, part in known)
        missed = PRINTED_S[0] - high if high < PRINTED_S[0] else min(PRINTED_S[2] - low, 0.0)
        return Interval(pairs=words, description=kind[0], excess=kind[1], restitution=kind[2], lowest_s=low,
                        highest_s=high, from_m=first, to_m=last, missed_by_s=missed)  # fmt: skip

    every = shared("all", list(ends))
    rows = [*(shared(f"p{m}", [m]) for m in ends), every]
    rows.append(shared(f"all, f +- {FREQUENCY_ERROR_HZ:g} Hz", list(ends), FREQUENCY_ERROR_HZ))
    less = dict.fromkeys((every.from_m, every.to_m))
    return rows + [shared(f"all but p{m}", [k for k in ends if k != m]) for m in less]


def excesses_of_all(single: ImpactOscillator, period: float, tau: float = 0.1) -> tuple[float, float]:
    """Excesses from 1e-6 to 0.1 at which all six are settled on with free period `period` [s]."""
    def settled(f: float, x: float) -> bool:
        return is_born(single, ("settles", 10.0**x, tau), f, period)

    found = [longest(partial(settled, f), -6.0, -1.0) for f in PERIODS]
    return 10.0 ** max(low for low, _ in found), 10.0 ** min(high for _, high in found)


def sentence(single: ImpactOscillator, rows: Sequence[Interval]) -> str:
    """What the pairs say, for the page."""
    told = {(row.description, row.excess, row.restitution, row.pairs): row for row in rows}
    band, wider = told["map", 0.0, 0.1, "all"], next(row for row in rows if row.pairs.startswith("all, f"))
    hertz = next(f for f, m in PERIODS.items() if m == band.to_m) * band.missed_by_s / PRINTED_S[0]
    most = longest(lambda tau: is_born(single, ("settles", 4e-3, tau), 21.50, FREE_PERIOD_S), 0.0, 0.9)[1]
    spans = [(1e3 * period, *excesses_of_all(single, period)) for period in PRINTED_S]
    at = "; ".join(f"{ms:.2f} ms from {low:.1e} to {high:.1e}" for ms, low, high in spans)
    return (
        f"By the map's bands the six pairs need T = {band}, {1e3 * band.missed_by_s:.3f} ms short of the "
        f"printed 40.80 +- 0.02 ms ({1e3 * wider.missed_by_s:.3f} ms with {FREQUENCY_ERROR_HZ:g} Hz of error "
        f"in f); p{band.to_m} alone disagrees, by {hertz:.3f} Hz, the others give "
        f"{told['map', 0.0, 0.1, f'all but p{band.to_m}']}. Eq. (1) with tau = 0.1 gives "
        f"{told['settles', 1e-3, 0.1, 'all']} at an excess of 1e-3, {told['settles', 4e-3, 0.1, 'all']} at "
        f"4e-3, and all six at {at}. p4 at 40.80 ms and 4e-3 asks for tau up to {most:.2f}."
    )


@plotting.in_house_style
def draw(rows: Sequence[Interval]) -> Figure:
    """The intervals of each pair and of all, beside the printed period."""
    figure, axis = plotting.new_figure(height=0.085)
    names = [*(f"p{m}" for m in PERIODS.values()), "all"][::-1]
    for number, (way, excess) in enumerate(WAYS):
        kept = [row for row in rows if (row.description, row.excess, row.restitution) == (way, excess, 0.1)]
        kept = [row for row in kept if row.pairs in names and row.lowest_s <= row.highest_s]
        axis.barh(
            [names.index(row.pairs) + 0.33 - 0.13 * number for row in kept], height=0.11,
            width=[1e3 * (row.highest_s - row.lowest_s) for row in kept], color=plotting.PALETTE[number],
            left=[1e3 * row.lowest_s for row in kept],
            label="map's band" if way == "map" else f"Eq. (1), {f'{excess:g}' if excess else 'grazing'}",
        )  # fmt: skip
    axis.axvspan(1e3 * PRINTED_S[0], 1e3 * PRINTED_S[2], color="0.85", zorder=0)
    axis.set_xlim(40.4, 41.1)
    axis.set_yticks(range(len(names)), names)
    plotting.mark_letter(axis.xaxis, 1e3 * FREE_PERIOD_S)
    plotting.label(axis.xaxis, "free period $T$", "ms")
    plotting.legend_below(figure, [axis], 2)
    return figure
