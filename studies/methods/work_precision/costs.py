"""Cost of a drive period: against the number of modes, and beside heyoka.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02; the beam's p4 at 21.50 Hz and excess 0.013
against the number of modes, with Hertz contact, and the same without a touch.  The time of an orbit beyond
that of its flights is the cost of its collisions.  heyoka, if it is installed, integrates Eq. (1) in its own
loop as its documentation recommends, and the beam through the interface of all methods at the tolerance 1e-7,
with which mode 1 errs by less than 1e-8 past a collision.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from statistics import median
from typing import Annotated

import numpy as np

from contact import ImpactOscillator, StroboscopicMap, simulate
from studies import letter
from studies.methods.peers import OutsideSolver, missing_solvers
from studies.methods.peers.adapters import Heyoka, heyoka_equations
from studies.methods.peers.piecewise import numbers_of
from studies.methods.work_precision.model import Orbit, in_turns
from studies.methods.work_precision.problems import EQ_1, HERTZ
from studies.shell.scene import Scene, beam_at, harmonic, model_of, single_mode_at
from studies.shell.study import Run

OURS, HEYOKA = "grazing-spring", "heyoka"
SINGLE, BEAM, FREE = EQ_1, HERTZ, "beam, no touch"
EXCESS, SINGLE_EXCESS, BELOW = letter.TIME_TRACE_EXCESS, 0.02, -0.02
"""F/F_g - 1 of the beam, of Eq. (1), and of a motion without a touch."""

SETTLING = 2000  # drive periods before the clock starts: a free motion falls to 0.92 in each

COUNTS, COUNTS_QUICK, TOLERANCE = (1, 2, 4, 8, 15, 20, 40), (1, 8), 1e-7
"""Numbers of modes; of heyoka the coarsest decade that brings its error with eight modes below 1e-8."""


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What a drive period costs with one tool."""

    case: Annotated[str, "case"]
    tool: Annotated[str, "tool"]
    modes: Annotated[int, "modes"]
    frequency_hz: float
    excess: float
    time_per_period_us: Annotated[float, "time per drive period [µs]"]
    time_per_collision_us: Annotated[float | None, "time per collision [µs]"] = None


def costs(scene: Scene, run: Run) -> list[Cost]:
    """Time Eq. (1) and the beam, one after the other; nothing else runs meanwhile."""
    frequencies = sorted(letter.PERIODS)[: 2 if run.quick else None]
    counts = COUNTS_QUICK if run.quick else COUNTS
    model = model_of(harmonic(scene).replace({"modes.count": max(counts)}))
    cases = [(SINGLE, single_mode_at(scene, frequency)) for frequency in frequencies]
    cases += [(BEAM, beam_at(scene, letter.TIME_TRACE_HZ, model.truncated(n))) for n in counts]
    tracked = run.track(cases, "costs of a drive period")
    return [row for case, oscillator in tracked for row in rows_of(case, oscillator, quick=run.quick)]


def heyoka_orbit(oscillator: ImpactOscillator) -> tuple[Orbit, Heyoka]:
    """An orbit of Eq. (1) from rest by heyoka alone, the impact in the callback of an event, at its default
    tolerance (the rounding of a double); and its integrator."""
    import heyoka as hy

    modes, scalars = numbers_of(oscillator)
    system, depth = heyoka_equations(modes.tolist(), scalars.tolist())

    def impact(taylor: Heyoka, _sign: int) -> bool:
        taylor.state[1] *= -oscillator.stop.law.numbers[0]
        return True

    touch = hy.t_event(depth, direction=hy.event_direction.positive, callback=impact)
    taylor = hy.taylor_adaptive(system, np.zeros(2), t_events=[touch])
    return lambda periods: taylor.propagate_until(taylor.time + periods * oscillator.period), taylor


def rows_of(case: str, oscillator: ImpactOscillator, *, quick: bool) -> list[Cost]:
    """The settled orbit, that of the beam without a touch as well, and, if installed, heyoka's."""
    excesses = {SINGLE: SINGLE_EXCESS, BEAM: EXCESS, FREE: BELOW}
    driven, count = oscillator.with_excess(excesses[case]), 200 if quick else 2000
    strobed = StroboscopicMap(oscillator=driven)
    free, state = strobed.at(BELOW), strobed.orbit(strobed.steady(), SETTLING).end
    still, impacts = free.steady(), strobed.orbit(state, count).impacts.sum() / count
    runs = dict[tuple[str, str], tuple[Orbit, int]]()
    runs[case, OURS] = partial(strobed.orbit, state), 10 * count if case == SINGLE else count
    if case != SINGLE:
        runs[FREE, OURS] = partial(free.orbit, still), count
    if HEYOKA not in missing_solvers():
        peer = OutsideSolver(solver="heyoka Taylor", tolerance=TOLERANCE)
        runs[case, HEYOKA] = (
            (heyoka_orbit(driven)[0], count)
            if case == SINGLE
            else (lambda n: simulate(driven, state, periods=n, method=peer), 8 if quick else 40)
        )
    spent = in_turns(runs, 3 if quick else 7)
    touching = (case, OURS) if case == BEAM and impacts else None
    return [
        Cost(
            case=name,
            tool=tool,
            modes=oscillator.n_modes,
            frequency_hz=oscillator.driven.frequency,
            excess=excesses[name],
            time_per_period_us=time,
            time_per_collision_us=(time - spent[FREE, OURS]) / impacts if (name, tool) == touching else None,
        )
        for (name, tool), time in spent.items()
    ]


def ratios_of(rows: Sequence[Cost]) -> dict[str, float]:
    """heyoka's time over ours for Eq. (1) over the frequencies, and the exponent of the beam's growth between
    the two largest numbers of modes."""
    costs = {(row.tool, row.frequency_hz): row.time_per_period_us for row in rows if row.case == SINGLE}
    over = [cost / costs[OURS, frequency] for (tool, frequency), cost in costs.items() if tool == HEYOKA]
    named = (("least", min), ("median", median), ("largest", max))
    ratios = {f"single_mode_{name}": chosen(over) for name, chosen in named if over}
    beam = sorted((row.modes, row.time_per_period_us) for row in rows if (row.case, row.tool) == (BEAM, OURS))
    for (few, low), (many, high) in list(pairwise(beam))[-1:]:
        ratios["hertz_growth_with_modes"] = math.log(high / low) / math.log(many / few)
    return ratios
