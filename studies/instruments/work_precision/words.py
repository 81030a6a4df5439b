"""What the study says: the front, the cheapest method for each error, and a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.work_precision.front import TARGETS, cheapest, front
from studies.instruments.work_precision.methods import OUTSIDE
from studies.instruments.work_precision.model_error import ModelErrors

__all__ = [
    "cheapest_by_target", "model_words", "named", "order_words", "table_lines", "verdict_of", "verdict_words",
]  # fmt: skip

Row = Mapping[str, Any]

TIE = 1.25
"""Ratio of costs within which two methods count as equally fast: timings repeat to a fifth."""

UNLIKE = 0.6
"""Difference of orders that is told: five settings with contacts between grid points scatter by a half."""

ROUNDED = 1e-13
"""Errors of mode 1 below this are rounding, and count as equal."""


def named(row: Row) -> str:
    """Method and setting."""
    return row["method"] if row["setting"] == "exact" else f"{row['method']}, {row['setting']}"


def cheapest_by_target(rows: Sequence[Row]) -> dict[str, str | None]:
    """Target error -> method and setting of least cost; None where no row is good enough."""
    found = {target: cheapest(rows, target) for target in TARGETS}
    return {f"{target:.0e}": None if row is None else named(row) for target, row in found.items()}


def verdict_of(rows: Sequence[Row]) -> dict[str, Any]:
    """About the default on one problem.

    `faster_and_as_accurate`: rows with no larger error (of rounding, or of the default) at less than 1/TIE of
    its cost; `on_front`: there are none; `next_within_accuracy`, `outside_within_accuracy`: the cheapest
    other row and outside solver within the accuracy that the default states, with their cost over its cost.
    """
    (default,) = [row for row in rows if row["default"]]
    others = [row for row in rows if not row["default"]]
    if default["failed"]:
        return {
            "default": default["method"], "failed": default["failed"], "on_front": False,
            "within_accuracy": False,
        }  # fmt: skip
    rival = cheapest(others, default["accuracy"])
    outside = cheapest([row for row in others if row["family"] == OUTSIDE], default["accuracy"])
    beaten = [
        row for row in others
        if row["error"] is not None and row["us_per_period"] is not None
        and row["error"] <= max(default["error"], ROUNDED)
        and row["us_per_period"] * TIE < default["us_per_period"]
    ]  # fmt: skip
    return {
        "default": default["method"],
        "error": default["error"],
        "us_per_period": default["us_per_period"],
        "accuracy": default["accuracy"],
        "on_front": not beaten,
        "within_accuracy": default["error"] <= default["accuracy"],
        "missed": default["missed"],
        "faster_and_as_accurate": [named(row) for row in beaten],
        "next_within_accuracy": None if rival is None else named(rival),
        "cost_ratio": None if rival is None else rival["us_per_period"] / default["us_per_period"],
        "outside_within_accuracy": None if outside is None else named(outside),
        "outside_cost_ratio": (
            None if outside is None else outside["us_per_period"] / default["us_per_period"]
        ),
    }


def table_lines(title: str, rows: Sequence[Row]) -> list[str]:
    """The front of one problem, and the cheapest method for each error."""
    lines = [f"{title}: the front", f"  {'error':>9} {'us/period':>10} {'missed':>7}  method"]
    for row in front(rows):
        missed = "" if row["missed"] is None else f"{row['missed']:.2f}"
        lines.append(f"  {row['error']:9.1e} {row['us_per_period']:10.4g} {missed:>7}  {named(row)}")
    before: str | None = ""
    for target, name in cheapest_by_target(rows).items():
        if name != before:
            lines.append(f"  for an error of {target}: {name or 'none'}")
            before = name
    return lines


def verdict_words(title: str, verdict: Mapping[str, Any]) -> str:
    """One sentence a problem."""
    if verdict.get("failed"):
        return f"{title}: the default, {verdict['default']}, failed: {verdict['failed']}"
    where = "on the front" if verdict["on_front"] else "NOT on the front"
    keeps = "within" if verdict["within_accuracy"] else "BEYOND"
    beaten = verdict["faster_and_as_accurate"]
    rival = ""
    if verdict["next_within_accuracy"] is not None:
        rival = f"; next is {verdict['next_within_accuracy']}, at {verdict['cost_ratio']:.3g} times its cost"
    if verdict["outside_within_accuracy"] is not None:
        rival += (
            f"; the fastest outside solver within {verdict['accuracy']:.0e} is "
            f"{verdict['outside_within_accuracy']}, at {verdict['outside_cost_ratio']:.3g} times"
        )
    return (
        f"{title}: {verdict['default']} is {where}, error {verdict['error']:.1e}, {keeps} its accuracy of "
        f"{verdict['accuracy']:.0e}; "
        + (f"faster and as accurate: {', '.join(beaten)}" if beaten else "nothing is faster and as accurate")
        + rival
    )


def order_words(orders: Sequence[Row]) -> list[str]:
    """The methods whose errors fall with another power of the step than they state."""
    lines = [
        f"  {row['problem']}: {row['method']} states order {row['stated']:g} and shows {row['measured']:.1f}"
        for row in orders
        if row["measured"] is not None and abs(row["measured"] - row["stated"]) > UNLIKE
    ]
    return ["orders that differ from those stated for smooth motion", *(lines or ["  none"])]


def model_words(found: ModelErrors) -> list[str]:
    """Where refining the step is wasted, and where adding modes is."""
    lines = ["truncated beam, mode 1 against four times as many modes, and central difference beside it"]
    for i, n in enumerate(found.modes):
        errors, level, step = found.step_error[i], found.model_error[i], found.balance[i]
        known = np.flatnonzero(np.isfinite(errors))
        if math.isfinite(step):
            words = f"steps below {1e6 * step:.3g} us are wasted"
        elif known.size == 0:
            words = "every step tried is refused"
        elif errors[known[0]] < level:
            words = f"the coarsest stable step tried, {1e6 * found.steps[known[0]]:.3g} us, is fine enough"
        else:
            words = f"more modes are wasted at every step tried, down to {1e6 * found.steps[-1]:.3g} us"
        cost = f"exact method {found.default_cost[i]:.3g} us/period"
        lines.append(f"  {n:3d} modes: model error {level:.1e}; {words}; {cost}")
    return lines
