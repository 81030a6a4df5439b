"""Error against cost of every method for impacts.

Claim: on these problems no outside solver and no method with a time step is both faster and as accurate as
the exact method that `simulate` takes by default; the letter's own scheme, the same flights with a search
that proves nothing (note [11]), costs about the same, and so does heyoka where one soft contact lasts as long
as the run.

Four problems: Eq. (1) with the hard wall; the scene's beam with a linear contact that lasts as long as
Hertz's; the same with Hertz's contact; the periodic motion of NLvib's two masses, found by harmonic balance,
shooting or settling. For every method, the package's own
and outside solvers, and every setting:

    error     of mode 1 past the first collision
    missed    share of shallow crossings of known depth that are not noticed by the free modes' motion
    cost      time per drive period along the settled orbit
    against   a Taylor series in extended precision, whose own error is stated

Then the cheapest setting of each method for two errors, the cost of a drive period
against the number of modes and beside heyoka, and the errors of gradients through impacts. A method
that fails at a setting is a row that says why; a setting at which a drive period would take longer than half
a second is a row that says so. Timings are taken one at a time, so that --workers makes no difference. What
the modes left out of the beam weigh beside all this is told by `studies.methods.adequacy`.

Run:     python -m studies work_precision
Writes:  rows.csv, cheapest.csv, costs.csv, gradients.csv; work_precision (png, pdf)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from studies.methods.peers import missing_solvers
from studies.methods.work_precision import costs, gradients
from studies.methods.work_precision.measures import (
    REPEATS,
    SLOWEST,
    Row,
    cheapest,
    orbit_rows,
    reference_of,
    rows_of,
)
from studies.methods.work_precision.methods import EXACT, SAMPLED, sweeps_for
from studies.methods.work_precision.problems import MODES, problems_of
from studies.shell.scene import Scene, harmonic, single_mode_at
from studies.shell.study import Run, study

SLOWEST_QUICK = 0.01
"""Longest time for one drive period with --quick [s]."""

GRADIENT_HZ = 22.2
"""Drive frequency of the motion of Eq. (1) whose gradients are compared [Hz]."""

MODES_QUICK = 4
"""Modes of the beam with --quick."""


@dataclass(frozen=True, kw_only=True)
class Cheapest:
    """Least cost of a method for errors of 1e-4 and 1e-8, and the crossings that it misses there."""

    problem: str
    method: str
    us_for_1e_4: float | None
    missed_at_1e_4: float | None
    us_for_1e_8: float | None
    missed_at_1e_8: float | None


@study()
def work_precision(scene: Scene, run: Run) -> Mapping[str, object]:
    """Measure, store, draw."""
    problems = problems_of(harmonic(scene), MODES_QUICK if run.quick else MODES)
    references = [reference_of(one) for one in run.track(problems, "references")]
    jobs = [(one, sweep) for one in references for sweep in sweeps_for(one.problem, quick=run.quick)]
    slowest, repeats = (SLOWEST_QUICK, 3) if run.quick else (SLOWEST, REPEATS)
    rows: list[Row] = []
    for reference, sweep in run.track(jobs, "sweeps of errors and costs"):  # nothing runs beside a timing
        rows += rows_of(reference, sweep, slowest=slowest, repeats=repeats)
    reference, periodic = orbit_rows(quick=run.quick, repeats=repeats)
    references, rows = [*references, reference], [*rows, *periodic]
    run.table("rows", rows, "Every method at every setting.", of=Row, show=())
    best = cheapest_of(rows)
    run.table("cheapest", best, "Time per drive period [µs], crossings missed, by error.", of=Cheapest)
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

    from studies.methods.work_precision import figures  # matplotlib is slow to import

    run.figure(
        "work_precision",
        figures.draw_errors(rows, references),
        "Error of mode 1 past the first "
        "collision against time per drive period; black star, the exact method.",
    )
    return {
        "rows": rows,
        "gradients": paths,
        "costs": spent,
        "ratios": ratios,
        "missing_solvers": missing_solvers(),
        "reference_errors": {one.problem.name: one.own_error for one in references},
    }


def cheapest_of(rows: Sequence[Row]) -> list[Cheapest]:
    """The cheapest setting of each method for both errors."""
    found = []
    for problem, method in dict.fromkeys((row.problem, row.method) for row in rows):
        mine = [row for row in rows if (row.problem, row.method) == (problem, method)]
        numbers = dict[str, float | None]()
        for name, level in {"1e_4": 1e-4, "1e_8": 1e-8}.items():
            best = cheapest(mine, level)
            numbers[f"us_for_{name}"] = best.us_per_period if best else None
            numbers[f"missed_at_{name}"] = best.missed if best else None
        found.append(Cheapest(problem=problem, method=method, **numbers))
    return found


def judge(run: Run, rows: Sequence[Row]) -> None:
    """Verdict on note [11]: the crossings of Eq. (1) that the letter's scheme misses."""
    scheme = [row for row in rows if row.problem == "single mode" and row.method == SAMPLED]
    missed = [row.missed for row in scheme if row.missed is not None]
    if missed:
        run.verdict(
            "sampled",
            "agrees" if max(missed) == 0.0 else "in part",
            found=f"{min(missed):.0%} to {max(missed):.0%} of shallow crossings missed",
            note=f"the scheme in Eq. (1) with {scheme[0].setting} to {scheme[-1].setting}; it proves nothing",
        )
