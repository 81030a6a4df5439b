"""Where each method fails: the limit that theory gives and the limit found, method by method.

A method for impacts can fail by its step (explicit methods in flight and in contact), by what it does to the
energy of a contact, by a touch that it does not see, by impacts that accumulate, by a law that has no limit as
modes are added, by a stiff contact, by odd modes, and by drift in long runs. Each family of failures is one
file of ``studies.instruments.stability``: its docstring derives the limit, its `measure` finds the same limit
by bisection or by direct measurement, and says whether the package refuses to go beyond it.

Columns of the table: method; case; the quantity that is turned; its limit by theory (empty where theory gives
no sharp one); the limit found (empty where the failure did not appear); refused: whether asking for more is
refused before a number comes out, "-" where there is nothing to refuse.

Run time: two to three minutes on two cores; --quick half a minute.  Command: python -m studies.stability
[--families explicit_limits,odd_modes].  Outputs: summary.json with all rows, and for every family its rows
(csv), the arrays of its figures (npz) and the figures. A family that cannot be computed becomes a failed row
with its sentence, the others go on, and the exit code is 3.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
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
"""The files of ``studies.instruments.stability`` that hold a family of failures, in the order of the table."""


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


def failed(name: str, error: Exception, what: str = "measured") -> Limit:
    """The row of a family that could not be computed."""
    return Limit(
        method="none", case=f"{name}: could not be {what}", knob="", theory=None, measured=None, refused=None,
        note=sentence(error),
    )  # fmt: skip


def measured(name: str, quick: bool, scene: Scene) -> Findings | Exception:
    """What the family finds, or why it does not."""
    try:
        return family(name).measure(quick=quick, scene=scene)
    except Exception as error:  # whatever goes wrong in one family must not take the others along
        return error


def store(name: str, findings: Findings, record: Record) -> Exception | None:
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
        return error
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
    results: dict[str, Findings | Exception] = {}
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        futures = {name: pool.submit(measured, name, request.quick, scene) for name in names}
        with request.progress("families", total=len(names)) as progress:
            for name, future in futures.items():
                results[name] = future.result()
                progress.advance()
    rows: list[dict[str, Any]] = []
    failures: list[str] = []
    for name, result in results.items():
        if isinstance(result, Exception):
            limits = [failed(name, result)]
        else:
            undrawn = store(name, result, request.record)
            limits = [*result.limits, *([] if undrawn is None else [failed(name, undrawn, "drawn")])]
        failures += [f"{limit.case}; {limit.note}" for limit in limits if limit.method == "none"]
        rows += [{**limit.row(), "family": name} for limit in limits]
        print(f"\n{name}", *table(limits), sep="\n", flush=True)
    for line in failures:
        print(line, flush=True)
    return {"rows": rows, "failures": failures, "failed_cells": len(failures)}


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
