"""The rows of the study: every method over its settings on one problem, errors first, then cost.

A setting that fails is a row with the sentence of its failure.  A setting whose drive period is expected to
take longer than a bound, from the one before it, is a row that says so.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contact.integrators import method_for
from studies.instruments.work_precision.cost import REPEATS, cost_of
from studies.instruments.work_precision.errors import (
    Yardstick,
    collision_errors,
    fold_errors,
    missed_crossings,
    sentence_of,
)
from studies.instruments.work_precision.methods import Line, Setting

__all__ = ["SLOWEST", "rows_of"]

SLOWEST = 0.5
"""Longest time for one drive period of a setting that is run [s]: its errors and its cost take twenty."""

NOTHING: dict[str, Any] = {
    "error": None, "error_time": None, "error_restitution": None, "error_kick": None, "error_fold": None,
    "fold_note": "", "missed": None, "largest_missed": None, "us_per_period": None,
    "evaluations_per_period": None, "repeats": 0, "failed": "",
}  # fmt: skip


def _row(yardstick: Yardstick, line: Line, setting: Setting) -> dict[str, Any]:
    problem, method = yardstick.problem, setting.method
    order = float(method.order)
    return {
        "problem": problem.name, "method": line.label, "family": line.family, "setting": setting.words,
        "value": setting.value, "order": order, "certified": method.certified, "accuracy": method.accuracy,
        "default": type(method) is type(method_for(problem.law)), **NOTHING,
    }  # fmt: skip


def rows_of(
    yardstick: Yardstick,
    line: Line,
    *,
    slowest: float = SLOWEST,
    repeats: int = REPEATS,
    advance: Callable[[], None] = lambda: None,
) -> list[dict[str, Any]]:
    """One row for each setting of `line`.

    Parameters
    ----------
    yardstick : Yardstick
    line : Line
    slowest : float
        Longest expected time for one drive period [s].
    repeats : int
        Timed runs of a point.
    advance : callable
        Called after each setting.
    """
    rows, expected = [], 0.0
    for setting in line.settings:
        row = _row(yardstick, line, setting)
        rows.append(row)
        if expected > slowest:
            row["failed"] = f"not run: a period would take about {expected:.2g} s, the bound is {slowest:g} s"
            expected *= line.growth
            advance()
            continue
        try:
            row.update(collision_errors(yardstick, setting.method))
            row.update(fold_errors(yardstick, setting.method))
            row.update(missed_crossings(yardstick, setting.method))
            cost = cost_of(yardstick.problem, setting.method, repeats=repeats)
            row.update(
                us_per_period=cost.microseconds, evaluations_per_period=cost.evaluations, repeats=cost.repeats
            )
            expected = 1e-6 * cost.microseconds * line.growth
        except Exception as error:  # an outside solver may raise anything, and it is a result
            row["failed"] = sentence_of(error)
        advance()
    return rows
