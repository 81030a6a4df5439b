"""Cost of a drive period: against the number of modes, and beside heyoka.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02; the beam's p4 at 21.50 Hz and excess 0.013
against the number of modes, with Hertz contact, and the same without a touch.  The time of an orbit beyond
that of its flights is the cost of its collisions.  heyoka, if it is installed, integrates Eq. (1) in its own
loop as its documentation recommends, and the beam through the interface of all methods at the tolerance 1e-7,
with which mode 1 errs by less than 1e-8 past a collision.  Compared programs are timed in turns, A B A B ...,
so that a machine that slows down slows both; medians are taken.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from beam import InvalidValue
from contact import ImpactOscillator, StroboscopicMap, simulate
from studies import letter
from studies.methods.peers import OutsideSolver, missing_solvers
from studies.shell.scene import Scene, beam_at, harmonic, model_of, single_mode_at
from studies.shell.study import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OURS, HEYOKA = "grazing-spring", "heyoka"
SINGLE, BEAM, FREE = "single mode", "beam, hertz contact", "beam, no touch"
EXCESS, SINGLE_EXCESS, BELOW = letter.TIME_TRACE_EXCESS, 0.02, -0.02
"""F/F_g - 1 of the beam, of Eq. (1), and of a motion without a touch."""

FREQUENCY = 21.50
"""The letter's Fig. 4 [Hz]."""

COUNTS, COUNTS_QUICK = (1, 2, 4, 8, 15, 20, 40), (1, 8)
"""Numbers of modes."""

TOLERANCE = 1e-7
"""Of heyoka: the coarsest decade that brings its error with eight modes below 1e-8."""

SETTLING = 2000
"""Drive periods before the clock starts: a free motion falls to 0.92 in each."""

DRAWN = ((BEAM, OURS, "Hertz contact"), (FREE, OURS, "no touch"), (BEAM, HEYOKA, "heyoka, Hertz contact"))
"""Case, tool and title of the lines of the figure."""

Orbit = Callable[[int], object]
"""orbit(periods): carries a motion on by that many drive periods."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What a drive period costs with one tool."""

    case: str
    tool: str
    modes: int
    frequency_hz: float
    excess: float
    us_per_period: float
    us_per_collision: float | None = None


def costs(scene: Scene, run: Run) -> list[Cost]:
    """Time Eq. (1) and the beam, one after the other; nothing else runs meanwhile."""
    frequencies = sorted(letter.PERIODS)[: 2 if run.quick else None]
    counts = COUNTS_QUICK if run.quick else COUNTS
    model = model_of(harmonic(scene).replace({"modes.count": max(counts)}))
    rows: list[Cost] = []
    for frequency in run.track(frequencies, "cost of Eq. (1)"):
        rows += single_rows(scene, frequency, quick=run.quick)
    for n in run.track(counts, "cost of the beam"):
        rows += beam_rows(beam_at(scene, FREQUENCY, model.truncated(n)), quick=run.quick)
    return rows


def in_turns(runs: Mapping[str, tuple[Orbit, int]], repeats: int) -> dict[str, float]:
    """Median microseconds per drive period of each orbit over its periods, after one of each to warm up, in
    the thread's own time."""
    spent: dict[str, list[float]] = {name: [] for name in runs}
    for orbit, periods in runs.values():
        orbit(periods)
    for _ in range(repeats):
        for name, (orbit, periods) in runs.items():
            began = time.thread_time()
            orbit(periods)
            spent[name].append(1e6 * (time.thread_time() - began) / periods)
    return {name: median(times) for name, times in spent.items()}


def heyoka_orbit(oscillator: ImpactOscillator) -> tuple[Orbit, Any]:
    """An orbit of Eq. (1) from rest by heyoka alone, the impact in the callback of an event, at its default
    tolerance (the rounding of a double); and its integrator."""
    import heyoka as hy

    model, drive = oscillator.model, oscillator.drive
    if drive is None:
        raise InvalidValue("oscillator has no drive; the orbit that is timed is driven")
    w = drive.angular_frequency
    x, v = hy.make_vars("x", "v")
    push = model.participation[0] * drive.amplitude * w**2 * hy.sin(w * hy.time)
    system = [(x, v), (v, push - model.decay_rate[0] * v - model.omega[0] ** 2 * x)]

    def impact(taylor: Any, _sign: int) -> bool:
        taylor.state[1] *= -oscillator.stop.law.numbers[0]
        return True

    touch = hy.t_event(
        x - oscillator.stop.gap / model.phi[0], direction=hy.event_direction.positive, callback=impact
    )
    taylor = hy.taylor_adaptive(system, np.zeros(2), t_events=[touch])

    def orbit(periods: int) -> None:
        taylor.propagate_until(taylor.time + periods * oscillator.period)

    return orbit, taylor


def single_rows(scene: Scene, frequency: float, *, quick: bool) -> list[Cost]:
    """One orbit of Eq. (1): the package and, if installed, heyoka."""
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency).with_excess(SINGLE_EXCESS))
    state = strobed.orbit(strobed.steady(), SETTLING).end
    runs: dict[str, tuple[Orbit, int]] = {
        OURS: (lambda periods: strobed.orbit(state, periods), 2000 if quick else 20000)
    }
    if HEYOKA not in missing_solvers():
        orbit, _taylor = heyoka_orbit(strobed.oscillator)
        orbit(SETTLING)
        runs[HEYOKA] = (orbit, 200 if quick else 2000)
    return [
        Cost(
            case=SINGLE, tool=tool, modes=1, frequency_hz=frequency, excess=SINGLE_EXCESS, us_per_period=spent
        )
        for tool, spent in in_turns(runs, 3 if quick else 7).items()
    ]


def beam_rows(oscillator: ImpactOscillator, *, quick: bool) -> list[Cost]:
    """The beam's settled orbit, the same without a touch and, if installed, heyoka."""
    count, driven = 200 if quick else 2000, oscillator.with_excess(EXCESS)
    strobed = StroboscopicMap(oscillator=driven)
    free = strobed.at(BELOW)
    state, still = strobed.orbit(strobed.steady(), SETTLING).end, free.steady()
    impacts = strobed.orbit(state, count).impacts.sum() / count
    runs: dict[str, tuple[Orbit, int]] = {
        OURS: (lambda periods: strobed.orbit(state, periods), count),
        FREE: (lambda periods: free.orbit(still, periods), count),
    }
    if HEYOKA not in missing_solvers():
        peer = OutsideSolver(solver="heyoka Taylor", tolerance=TOLERANCE)
        runs[HEYOKA] = (
            lambda periods: simulate(driven, state, periods=periods, method=peer),
            8 if quick else 40,
        )
    spent = in_turns(runs, 3 if quick else 7)
    row = partial(Cost, modes=oscillator.n_modes, frequency_hz=1.0 / oscillator.period)
    rows = [
        row(
            case=BEAM,
            tool=OURS,
            excess=EXCESS,
            us_per_period=spent[OURS],
            us_per_collision=(spent[OURS] - spent[FREE]) / impacts if impacts else None,
        ),
        row(case=FREE, tool=OURS, excess=BELOW, us_per_period=spent[FREE]),
    ]
    if HEYOKA not in missing_solvers():
        rows.append(row(case=BEAM, tool=HEYOKA, excess=EXCESS, us_per_period=spent[HEYOKA]))
    return rows


def costs_of(rows: Sequence[Cost], case: str, tool: str) -> list[tuple[int, float]]:
    """Numbers of modes and times of a case and tool, the fewest modes first."""
    return sorted((row.modes, row.us_per_period) for row in rows if (row.case, row.tool) == (case, tool))


def ratios_of(rows: Sequence[Cost]) -> dict[str, float]:
    """heyoka's time over ours for Eq. (1) over the frequencies, and the exponent of the beam's growth between
    the two largest numbers of modes."""
    costs = {(row.tool, row.frequency_hz): row.us_per_period for row in rows if row.case == SINGLE}
    over = [cost / costs[OURS, frequency] for (tool, frequency), cost in costs.items() if tool == HEYOKA]
    named = (("least", min), ("median", median), ("largest", max))
    ratios = {f"single_mode_{name}": chosen(over) for name, chosen in named if over}
    for (few, low), (many, high) in list(pairwise(costs_of(rows, BEAM, OURS)))[-1:]:
        ratios["hertz_growth_with_modes"] = math.log(high / low) / math.log(many / few)
    return ratios


def draw_costs(rows: Sequence[Cost]) -> Figure:
    """Time per drive period against the number of modes."""
    from studies.shell import plotting  # matplotlib is slow to import

    with plotting.house_style():
        figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.075)
        for number, (case, tool, title) in enumerate(DRAWN):
            if cost := costs_of(rows, case, tool):
                axes.plot(*zip(*cost, strict=True), **plotting.series(number), label=title)
        ticks = sorted({row.modes for row in rows if row.case == BEAM})
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(ticks, [str(tick) for tick in ticks])
        axes.minorticks_off()
        plotting.label(axes.xaxis, "number of modes")
        plotting.label(axes.yaxis, "time per drive period", "µs")
        figure.legend(loc="outside lower center", ncols=2)
    return figure
