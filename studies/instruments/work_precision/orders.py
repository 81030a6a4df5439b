"""The order of convergence that the rows of a method show.

Least-squares slope of log(error) over log(step), over the settings whose error lies between `ROUNDING` and
`COARSE`: above, the method is not yet in its asymptotic range; below, rounding over millions of steps shows.
Where the contact is met between grid points, the error carries a factor that depends on where, so that single
ratios scatter about the slope.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.instruments.work_precision.methods import STEPPED

__all__ = ["measured_order", "measured_orders"]

ROUNDING, COARSE = 1e-11, 3e-2

FEWEST = 3
"""Settings that a slope needs."""


def measured_order(rows: Sequence[Mapping[str, Any]], measure: str = "error") -> float | None:
    """Slope over the settings of one method on one problem; None with fewer than three in range."""
    points = [
        (row["value"], row[measure]) for row in rows
        if row[measure] is not None and ROUNDING < row[measure] < COARSE and math.isfinite(row["value"])
    ]  # fmt: skip
    if len(points) < FEWEST:
        return None
    step, error = np.log(np.array(points).T)
    return float(np.polyfit(step, error, 1)[0])


def measured_orders(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """For each problem and method with a step: the order stated and those that three measures show."""
    found = []
    pairs = dict.fromkeys((row["problem"], row["method"]) for row in rows if row["family"] == STEPPED)
    for problem, method in pairs:
        here = [row for row in rows if (row["problem"], row["method"]) == (problem, method)]
        found.append({
            "problem": problem, "method": method, "stated": here[0]["order"],
            "measured": measured_order(here), "measured_time": measured_order(here, "error_time"),
            "measured_fold": measured_order(here, "error_fold"),
        })  # fmt: skip
    return found
