"""The Pareto front of error against cost, and the cheapest method for an error that is asked for.

A point is on the front if no other is at least as good in both and better in one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["TARGETS", "cheapest", "front"]

TARGETS = tuple(10.0**-p for p in range(1, 15))
"""Errors asked for."""

Row = Mapping[str, Any]


def _measured(rows: Sequence[Row], error: str, cost: str) -> list[Row]:
    """Rows that have both numbers."""
    return [
        row for row in rows
        if row.get(error) is not None and row.get(cost) is not None
        and math.isfinite(row[error]) and math.isfinite(row[cost])
    ]  # fmt: skip


def front(rows: Sequence[Row], *, error: str = "error", cost: str = "us_per_period") -> list[Row]:
    """The rows that no other row beats, by rising cost; of equal ones, all."""
    kept: list[Row] = []
    for row in sorted(_measured(rows, error, cost), key=lambda row: (row[cost], row[error])):
        tied = bool(kept) and (row[cost], row[error]) == (kept[-1][cost], kept[-1][error])
        if not kept or row[error] < kept[-1][error] or tied:
            kept.append(row)
    return kept


def cheapest(
    rows: Sequence[Row], target: float, *, error: str = "error", cost: str = "us_per_period"
) -> Row | None:
    """The row of least cost with an error of at most `target`; None if there is none."""
    enough = [row for row in _measured(rows, error, cost) if row[error] <= target]
    return min(enough, key=lambda row: (row[cost], row[error])) if enough else None
