"""Error against cost of every method for impacts, over its step or tolerance.

Claim: on this problem no outside solver and no method with a time step is both faster and as accurate as the
exact method that `simulate` takes by default; the letter's own scheme, the same flights with a search that
proves nothing, costs about the same.  With up to eight modes, what is left out of the beam weighs more than
a time step of a quarter of the contact.

Four problems (`studies.instruments.work_precision.problems`): Eq. (1) of the letter with the hard wall; the
scene's beam with a linear contact that lasts as long as Hertz's; the same with Hertz's contact; the beam of
code_aster's SDNL32 swung on a spring.  For every method, the package's own and outside solvers, and every
setting:

    errors    mode 1 past the first collision, impact time, restitution, kick (`errors`); shift of the fold of
              p4, dA = -w.(P~ - P)/(w.P_A) (`fold_shift`); share of planted shallow crossings missed
              (`crossings`)
    cost      time per drive period along the settled orbit, and evaluations (`cost`)
    against   a solution in extended precision by two independent routes, whose difference is its error
              (`extended_reference`)

Then the Pareto front, the cheapest method for each error (`front`), and the error of a truncated beam beside
that of the time step (`model_error`).  A method that fails at a setting is a row that says why; a setting at
which a drive period would take longer than half a second is a row that says so.  Timings are taken one at a
time, so that --workers makes no difference.  Outside solvers that are not installed are listed.

Run time: four minutes; --quick half a minute.  Command: python -m studies.work_precision.  Outputs:
summary.json, rows.csv, model_error.csv; work_precision, other_errors and model_error (png, pdf).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from contact.integrators import INTEGRATORS
from studies.instruments.command_line import Request, run_study
from studies.instruments.scene import Scene
from studies.instruments.work_precision.cost import REPEATS
from studies.instruments.work_precision.errors import Yardstick, yardstick_of
from studies.instruments.work_precision.front import front
from studies.instruments.work_precision.measures import SLOWEST, rows_of
from studies.instruments.work_precision.methods import lines_for, missing_peers
from studies.instruments.work_precision.model_error import ModelErrors, model_errors
from studies.instruments.work_precision.orders import measured_orders
from studies.instruments.work_precision.problems import Problem, problems_of
from studies.instruments.work_precision.words import (
    cheapest_by_target,
    model_words,
    named,
    order_words,
    table_lines,
    verdict_of,
    verdict_words,
)

__all__ = ["main", "run"]

SCHEMA = 1
"""Number of the layout of this study's part of the summary."""

SLOWEST_QUICK = 0.01
"""Longest time for one drive period with --quick [s]."""


def run(scene: Scene, request: Request) -> Mapping[str, Any]:
    """Measure, store, draw."""
    problems = problems_of(scene)
    with request.progress("references in extended precision", total=len(problems)) as progress:
        yardsticks = []
        for problem in problems:
            yardsticks.append(yardstick_of(problem))
            progress.advance()
    rows = measured(yardsticks, request)
    with request.progress("number of modes against time step") as progress:
        model = model_errors(scene, quick=request.quick)
        progress.advance()
    titles = {problem.name: problem.title for problem in problems}
    store(rows, model, request)
    reference = {yardstick.problem.name: yardstick.reference_error for yardstick in yardsticks}
    draw(rows, model, problems, reference, request)

    by_problem = {name: [row for row in rows if row["problem"] == name] for name in titles}
    verdicts = {name: verdict_of(here) for name, here in by_problem.items()}
    missing = missing_peers()
    for name, title in titles.items():
        print("\n".join(table_lines(title, by_problem[name])))
    orders = measured_orders(rows)
    print("\n".join([*order_words(orders), *model_words(model)]))
    for name, title in titles.items():
        print(verdict_words(title, verdicts[name]))
    largest = max(error for errors in reference.values() for error in errors.values())
    print(f"reference: the two routes differ by {largest:.0e} at most")
    if missing:
        print(f"not installed: {', '.join(missing)}")
    return {
        "work_precision_schema": SCHEMA,
        "rows": rows,
        "front": {
            name: [
                {"method": row["method"], "setting": row["setting"], "error": row["error"],
                 "us_per_period": row["us_per_period"]}
                for row in front(here)
            ]
            for name, here in by_problem.items()
        },
        "cheapest": {name: cheapest_by_target(here) for name, here in by_problem.items()},
        "reference_error": reference,
        "fold_excess": {y.problem.name: y.problem.fold.excess for y in yardsticks if y.problem.fold},
        "model_error": model.rows(),
        "orders": orders,
        "verdict": verdicts,
        "methods": sorted(INTEGRATORS),
        "versions": {name: installed(name) for name in ("mpmath", "heyoka", "scikit-sundae", "scipy")},
        "missing_peers": missing,
        "failures": [
            {"problem": row["problem"], "method": named(row), "failed": row["failed"]}
            for row in rows if row["failed"]
        ],
        "failed_cells": sum(bool(row["failed"]) for row in rows if row["default"]),
    }  # fmt: skip


def installed(name: str) -> str | None:
    """Version of a package, None if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def measured(yardsticks: Sequence[Yardstick], request: Request) -> list[dict[str, Any]]:
    """All rows, one setting after the other: nothing runs beside a timing."""
    jobs = [
        (yardstick, line)
        for yardstick in yardsticks
        for line in lines_for(yardstick.problem, quick=request.quick)
    ]
    rows: list[dict[str, Any]] = []
    with request.progress("errors and costs", total=sum(len(line.settings) for _, line in jobs)) as progress:
        for yardstick, line in jobs:
            rows += rows_of(
                yardstick, line, slowest=SLOWEST_QUICK if request.quick else SLOWEST,
                repeats=3 if request.quick else REPEATS, advance=progress.advance,
            )  # fmt: skip
    return rows


def store(rows: Sequence[Mapping[str, Any]], model: ModelErrors, request: Request) -> None:
    """The tables."""
    request.record.write_table("rows", {key: [row[key] for row in rows] for key in rows[0]})
    table: dict[str, Any] = {
        "modes": model.modes, "model_error": model.model_error, "us_per_period": model.default_cost,
        "balanced_step_s": model.balance,
    }  # fmt: skip
    for j, step in enumerate(model.steps):
        table[f"error_step_{step:.3g}_s"] = model.step_error[:, j]
        table[f"us_step_{step:.3g}_s"] = model.step_cost[:, j]
    request.record.write_table("model_error", table)


def draw(
    rows: Sequence[Mapping[str, Any]],
    model: ModelErrors,
    problems: Sequence[Problem],
    reference: Mapping[str, Mapping[str, float]],
    request: Request,
) -> None:
    """The figures."""
    from studies.instruments.work_precision import figures  # matplotlib is slow to import

    request.record.write_figure(figures.work_precision_figure(rows, problems, reference), "work_precision")
    request.record.write_figure(figures.other_errors_figure(rows, problems), "other_errors")
    request.record.write_figure(figures.model_figure(model), "model_error")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "work_precision",
        "Error against cost of every method for impacts, against a reference in extended precision.",
        run,
        argv,
    )


if __name__ == "__main__":
    raise SystemExit(main())
