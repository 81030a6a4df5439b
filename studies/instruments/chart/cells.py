"""The cells of a store as arrays over (direction, frequency, excess), and what they say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.instruments.sweep.store import Store
from studies.instruments.sweep.tasks import DIRECTIONS, Grid

__all__ = ["Cells", "fold_agreement"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """Arrays of shape (2, n_frequencies, n_excesses), upward scan first; excesses rise in both.

    `period` 0: none found; `cycles` drive periods spent; -1 everywhere where the computation failed.
    """

    frequencies: np.ndarray
    excesses: np.ndarray
    period: np.ndarray
    impacts: np.ndarray
    cycles: np.ndarray

    @staticmethod
    def of_store(store: Store, grid: Grid) -> Cells:
        """Read row by row."""
        shape = (len(DIRECTIONS), len(grid.frequencies), len(grid.excesses))
        found = {name: np.full(shape, -1, dtype=np.int32) for name in ("period", "impacts", "cycles")}
        for number, _f, _way, step, _excess, period, impacts, cycles, reason, _state in store.rows():
            way, column = number % 2, number // 2
            row = step if way == 0 else shape[2] - 1 - step
            if not reason:
                found["period"][way, column, row] = period
                found["impacts"][way, column, row] = impacts
                found["cycles"][way, column, row] = cycles
        return Cells(
            frequencies=np.array(grid.frequencies), excesses=np.array(grid.excesses), **found
        )

    def counts(self) -> dict[str, dict[str, int]]:
        """Cells of each period, by direction."""
        return {
            way: {
                str(p): int(n) for p, n in zip(*np.unique(self.period[k], return_counts=True), strict=True)
            }
            for k, way in enumerate(DIRECTIONS)
        }


def fold_agreement(cells: Cells, folds: Sequence[dict[str, Any]]) -> tuple[int, int]:
    """In how many columns the exact fold lies in the step in which p_m ends, and in how many it could.

    It can where the downward scan is on p_m with one impact in the two rows above the fold.
    """
    agree = able = 0
    place = {float(f): k for k, f in enumerate(cells.frequencies)}
    for fold in folds:
        column = place.get(fold["frequency_hz"])
        if column is None:
            continue
        on = (cells.period[1, column] == fold["period"]) & (cells.impacts[1, column] == 1)
        above = int(np.searchsorted(cells.excesses, fold["excess"]))
        if above + 1 < on.size and above > 0 and on[above + 1]:
            able += 1
            agree += bool(on[above] and not on[above - 1])
    return agree, able
