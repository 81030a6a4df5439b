"""Where each method fails: the limit that theory gives and the limit found, method by method.

A method for impacts can fail by its step (explicit methods in flight and in contact), by what it does to the
energy of a contact, by a touch that it does not see, by impacts that accumulate, by a law that has no limit
as modes are added, by a stiff contact, by odd modes, and by drift in long runs. Each family of failures is
one file of ``studies.instruments.stability``: its docstring derives the limit, its `measure` finds the same
limit by bisection or by direct measurement, and says whether the package refuses to go beyond it.

Columns of the table: method; case; the quantity that is turned; its limit by theory (empty where theory gives
no sharp one); the limit found (empty where the failure did not appear); refused: whether asking for more is
refused before a number comes out, "-" where there is nothing to refuse.

Run time: three to four minutes on two cores; --quick half a minute.  Command: python -m studies.stability
[--families explicit_limits,odd_modes].  Outputs: summary.json with all rows, and for every family its rows
(csv), the arrays of its figures (npz) and the figures. A family that cannot be computed becomes a failed row
with its sentence, the others go on, and the exit code is 3.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib import import_module
from multiprocessing import get_context
from typing import Any, Protocol, cast

from studies.instruments.command_line import Request, WrongUse, run_study
from studies.instruments.record import Record
from studies.instruments.scene import Scene
from studies.instruments.stability.findings import Findings, Limit

FAMILIES = (
    "explicit_limits",
    "splitting_limits",
    "implicit_contact",
    "numerical_restitution",
    "missed_crossings",
    "accumulation",
    "newton_modes",
    "stiff_contact",
    "odd_modes",
    "long_runs",
)
"""The files of ``studies.instruments.stability`` that hold a family each, in the order of the table."""

LONGEST = ("missed_crossings", "implicit_contact", "splitting_limits", "numerical_restitution")
"""Families that take longest: begun first, so that no core waits for them at the end."""


class Family(Protocol):
    """What such a file offers."""

    def measure(self, *, quick: bool, scene: Scene) -> Findings:
        """The limits, and the arrays of the figures."""

    def draw(self, findings: Findings, record: Record) -> None:
        """Its figures, from what it has found."""


def family(name: str) -> Family:
    """The family `name`, imported when it is needed."""
    return cast(Family, import_module(f"studies.instruments.stability.{name}"))


def sentence(error: Exception) -> str:
    """What went wrong, in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def failed(name: str, what: str, why: str) -> Limit:
    """The row of a family that could not be measured or drawn."""
    return Limit(
        method="none", case=f"{name}: could not be {what}", knob="", theory=None, measured=None, refused=None,
        note=why,
    )  # fmt: skip


def measured(name: str, quick: bool, scene: Scene) -> tuple[Findings | str, float]:
    """What the family finds, or in a sentence why it does not, and the seconds that it has computed."""
    began = time.thread_time()
    try:
        result: Findings | str = family(name).measure(quick=quick, scene=scene)
    except Exception as error:  # whatever goes wrong in one family must not take the others along
        result = sentence(error)
    return result, time.thread_time() - began


def all_measured(
    names: Sequence[str], scene: Scene, request: Request
) -> dict[str, tuple[Findings | str, float]]:
    """What `measured` gives for every family, by name.

    Families run in processes of their own (spawned), because much of their time is spent in outside solvers
    and in arithmetic of many digits, which hold the interpreter; with one worker, one after another in this
    one.
    """
    results: dict[str, tuple[Findings | str, float]] = {}
    workers = min(request.workers, len(names))
    with request.progress("families", total=len(names)) as progress:
        if workers == 1:
            for name in names:
                results[name] = measured(name, request.quick, scene)
                progress.advance()
            return results
        pool = ProcessPoolExecutor(max_workers=workers, mp_context=get_context("spawn"))
        try:
            long_first = sorted(names, key=lambda name: name not in LONGEST)
            futures = {pool.submit(measured, name, request.quick, scene): name for name in long_first}
            for future in as_completed(futures):
                results[futures[future]] = future.result()
                progress.advance()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
    return results


def store(name: str, findings: Findings, record: Record) -> str | None:
    """Rows, arrays and figures of a family; what went wrong in drawing, if anything did."""
    rows = [limit.row() for limit in findings.limits]
    keys = ("method", "case", "knob", "limit_theory", "limit_measured", "refused", "note")
    columns = {key: ["" if row[key] is None else str(row[key]) for row in rows] for key in keys}
    record.write_table(name, columns)
    try:
        if findings.arrays:
            record.write_arrays(name, **findings.arrays)
        family(name).draw(findings, record)
    except Exception as error:
        return sentence(error)
    return None


def words(value: float | bool | None) -> str:
    """A cell of the table."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.7g}"


def table(limits: Sequence[Limit]) -> list[str]:
    """The rows as lines of text with a heading."""
    heading = ("method", "case", "knob", "theory", "measured", "refused")
    rows = [heading] + [
        (x.method, x.case, x.knob, words(x.theory), words(x.measured), words(x.refused)) for x in limits
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(heading))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows]  # fmt: skip


def run(scene: Scene, request: Request) -> Mapping[str, Any]:
    """Measure all families, store them, draw them and print the table."""
    names = _chosen(request.options.families)
    results = all_measured(names, scene, request)
    rows: list[dict[str, Any]] = []
    failures: list[str] = []
    for name in names:
        result = results[name][0]
        if isinstance(result, str):
            limits = [failed(name, "measured", result)]
        else:
            undrawn = store(name, result, request.record)
            limits = [*result.limits, *([] if undrawn is None else [failed(name, "drawn", undrawn)])]
        failures += [f"{limit.case}; {limit.note}" for limit in limits if limit.method == "none"]
        rows += [{**limit.row(), "family": name} for limit in limits]
        print(f"\n{name}", *table(limits), sep="\n", flush=True)
    for line in failures:
        print(line, flush=True)
    seconds = {name: round(results[name][1], 1) for name in names}
    return {"rows": rows, "seconds": seconds, "failures": failures, "failed_cells": len(failures)}


def _chosen(text: str) -> tuple[str, ...]:
    """The families named on the command line."""
    names = tuple(name.strip() for name in text.split(",")) if text else FAMILIES
    for name in names:
        if name not in FAMILIES:
            raise WrongUse(f"families names {name!r}; it must be among {', '.join(FAMILIES)}")
    return names


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--families", default="", metavar="NAME,NAME", help="only these families (default: all)"
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "stability",
        "Where each method fails: theory against measurement.",
        run,
        argv,
        options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
