"""Error against cost of every method for impacts.

Claim: on these problems no outside solver and no method with a time step is both faster and as accurate as
the exact method, which `simulate` takes by default. Two cost about the same: the letter's scheme, which
samples the same flights and proves nothing (note [11]), and heyoka where a soft contact lasts the whole run.

Four problems: Eq. (1) with the hard wall; the scene's beam with a linear contact that lasts as long as
Hertz's; the same with Hertz's contact; the periodic motion of NLvib's two masses, found by harmonic balance,
shooting or settling. For every method, also of outside solvers, and every setting:

    error     of mode 1 past the first collision
    missed    share of shallow crossings of known depth that are not noticed by the free modes' motion
    cost      time per drive period along the settled orbit
    against   a Taylor series in extended precision, whose own error is stated

Then the cheapest setting of each method for two errors, the cost of a drive period against the number of
modes and beside heyoka, and the errors of gradients through impacts. A method that fails at a setting is a
row that says why, and so is a setting at which a drive period would take longer than half a second. Timings
are taken one at a time, so that --workers makes no difference.

Run:     python -m studies work_precision
Writes:  rows.csv, cheapest.csv, costs.csv, gradients.csv; work_precision.png
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from studies import letter
from studies.methods.peers import missing_solvers
from studies.methods.work_precision import costs, gradients
from studies.methods.work_precision.methods import EXACT, SAMPLED, sweeps_for
from studies.methods.work_precision.model import (
    REPEATS,
    SLOWEST,
    Measured,
    cheapest,
    orbit_rows,
    reference_of,
    rows_of,
)
from studies.methods.work_precision.problems import EQ_1, HERTZ, MODES, problems_of
from studies.shell.digits import written
from studies.shell.scene import Scene, harmonic, single_mode_at
from studies.shell.study import Run, study

SLOWEST_QUICK, MODES_QUICK, GRADIENT_HZ = 0.01, 4, letter.TRANSITION_HZ[5]
"""With --quick: longest time for a drive period [s], modes of the beam. Drive frequency of gradients [Hz]."""


@dataclass(frozen=True, kw_only=True)
class Cheapest:
    """Least cost of a method for errors of 1e-4 and 1e-8, and the crossings that it misses there."""

    problem: Annotated[str, "problem"]
    method: Annotated[str, "method"]
    time_for_1e_4: Annotated[float | None, "time per drive period for an error of 10⁻⁴ [µs]"]
    missed_at_1e_4: Annotated[float | None, "share of shallow crossings missed at 10⁻⁴"]
    time_for_1e_8: Annotated[float | None, "time per drive period for an error of 10⁻⁸ [µs]"]
    missed_at_1e_8: Annotated[float | None, "share of shallow crossings missed at 10⁻⁸"]


@study()
def work_precision(scene: Scene, run: Run) -> Mapping[str, object]:
    """Measure, store, draw."""
    problems = problems_of(harmonic(scene), MODES_QUICK if run.quick else MODES)
    references = [reference_of(one) for one in run.track(problems, "references")]
    jobs = [(one, sweep) for one in references for sweep in sweeps_for(one.problem, quick=run.quick)]
    slowest, repeats = (SLOWEST_QUICK, 3) if run.quick else (SLOWEST, REPEATS)
    rows: list[Measured] = []
    for reference, sweep in run.track(jobs, "sweeps of errors and costs"):  # nothing runs beside a timing
        rows += rows_of(reference, sweep, slowest=slowest, repeats=repeats)
    reference, periodic = orbit_rows(quick=run.quick, repeats=repeats)
    references, rows = [*references, reference], [*rows, *periodic]
    run.table("rows", rows, "Every method at every setting.", of=Measured, show=())
    best = cheapest_of(rows)
    run.table("cheapest", best, "The cheapest setting of each method for two errors.", of=Cheapest)
    spent = costs.costs(scene.replace({"contact.law": "hertz"}), run)
    ratios = costs.ratios_of(spent)
    run.table("costs", spent, "Time per drive period and per collision.", of=costs.Cost)
    run.say(", ".join(f"{name} {ratio:.3g}" for name, ratio in ratios.items()))
    paths = [] if run.quick else gradients.gradients(single_mode_at(scene, GRADIENT_HZ).with_excess(1e-3))
    if paths:
        run.table("gradients", paths, "Error and time of a gradient through impacts.", of=gradients.Gradient)
    for row in rows:
        if row.family == EXACT and row.failed:
            run.failed(f"{row.problem}, {row.method}", row.failed)
    judge(run, rows)
    if missing_solvers():
        run.say(f"not installed: {', '.join(missing_solvers())}")

    from studies.methods.work_precision import figure  # matplotlib is slow to import

    run.figure(
        "work_precision",
        figure.draw_errors(rows, references),
        "Error of mode 1 past the first collision against the time for a drive period; for two masses, error "
        "of a periodic orbit against the time that finds it. The errors of the references are below "
        f"{written(2.0 * max(one.own_error for one in references), 1)}.",
    )
    for sentence in sentences(rows):
        run.finding(sentence)
    return {
        "rows": rows,
        "gradients": paths,
        "costs": spent,
        "ratios": ratios,
        "missing_solvers": missing_solvers(),
        "reference_errors": {one.problem.name: one.own_error for one in references},
    }


def cheapest_of(rows: Sequence[Measured]) -> list[Cheapest]:
    """The cheapest setting of each method for both errors."""
    found = []
    for problem, method in dict.fromkeys((row.problem, row.method) for row in rows):
        mine = [row for row in rows if (row.problem, row.method) == (problem, method)]
        numbers = dict[str, float | None]()
        for name, level in {"1e_4": 1e-4, "1e_8": 1e-8}.items():
            best = cheapest(mine, level)
            numbers[f"time_for_{name}"] = best.time_per_period_us if best else None
            numbers[f"missed_at_{name}"] = best.missed if best else None
        found.append(Cheapest(problem=problem, method=method, **numbers))
    return found


def sentences(rows: Sequence[Measured]) -> Iterator[str]:
    """What the beam with Hertz's contact says of the methods."""
    here = [row for row in rows if row.problem == HERTZ and row.error is not None]
    known = [(row, row.time_per_period_us) for row in here if row.time_per_period_us is not None]
    exact = min((time for row, time in known if row.family == EXACT), default=math.nan)
    if math.isfinite(exact):
        yield f"The exact method takes {written(exact, 2)} µs for a drive period of the beam."
    others = [(row, time) for row, time in known if row.family != EXACT and row.method != SAMPLED]
    if times := [time for row, time in others if row.missed == 0.0 and (row.error or 0.0) <= 1e-8]:
        ratio = written(min(times) / exact, 2)
        yield f"Without exact flights, a small error and no missed touch take at least {ratio} times as long."
    if missed := max((row.missed or 0.0 for row, _ in known if row.method == SAMPLED), default=0.0):
        yield f"Flights that are sampled too rarely miss {100.0 * missed:.0f} % of the shallow touches."


def judge(run: Run, rows: Sequence[Measured]) -> None:
    """Verdict on note [11]: the crossings of Eq. (1) that the letter's scheme misses."""
    scheme = [row for row in rows if row.problem == EQ_1 and row.method == SAMPLED]
    missed = [row.missed for row in scheme if row.missed is not None]
    if missed:
        run.verdict(
            "sampled",
            "agrees" if max(missed) == 0.0 else "in part",
            found=f"{f'{100 * max(missed):.0f} %' if max(missed) else 'none'} of the shallow touches missed",
            note=f"the scheme in Eq. (1) with {scheme[0].setting} to {scheme[-1].setting}; it proves nothing",
        )
