"""The touches of a motion put together from pieces, row by row as they happen.

The energy lost in an elastic contact is the difference of its potential, k d^2/2 or (2/5) k d^(5/2), between
touch and release; in a dissipative one it is the last component of the solver's state.
"""

from __future__ import annotations

import math

import numpy as np

from contact.laws import HERTZ, LINEAR
from contact.trajectory import ImpactKind, Impacts
from studies.instruments.peers.problem import Problem

__all__ = ["TouchLog"]


class TouchLog:
    """The rows so far, and the times at which impacts began."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.n = problem.equation.phi.size
        self.rows: list[list[float]] = []
        self.states: list[np.ndarray] = []
        self.begun: list[float] = []
        self.stored = 0.0
        self.open = False

    def _potential(self, depth: float) -> float:
        """Energy of an elastic contact [J]."""
        e = self.problem.equation
        power = {LINEAR: 2.0, HERTZ: 2.5}.get(e.law)
        return 0.0 if power is None else e.number0 * max(depth, 0.0) ** power / power

    def touch(self, s: float, y: np.ndarray, kind: int = ImpactKind.IMPACT, *, counted: bool = True) -> None:
        """A new row; `kind` as in ``Impacts``."""
        depth, rate = self.problem.tip(y)
        self.rows.append([s, math.nan, rate, math.nan, math.nan, float(kind)])
        self.states.append(np.concatenate([y[: 2 * self.n], np.full(2 * self.n, np.nan)]))
        self.stored = self._potential(depth)
        self.open = True
        if counted:
            self.begun.append(s)

    def release(self, s: float, y: np.ndarray, loss: float | None = None) -> None:
        """Complete the last row; `loss` where the law says it [J]."""
        depth, rate = self.problem.tip(y)
        if loss is None:
            loss = float(y[-1]) if y.size > 2 * self.n else self._potential(depth) - self.stored
        self.rows[-1][1], self.rows[-1][3], self.rows[-1][4] = s, rate, loss
        self.states[-1][2 * self.n :] = y[: 2 * self.n]
        self.open = False

    def impacts(self) -> Impacts:
        """The rows as named arrays."""
        n, start = self.n, self.problem.start
        rows, states = np.array(self.rows).reshape(-1, 6), np.array(self.states).reshape(-1, 4 * n)
        return Impacts(
            start=start + rows[:, 0], end=start + rows[:, 1], approach=rows[:, 2], rebound=rows[:, 3],
            loss=rows[:, 4], kind=rows[:, 5].astype(np.int64),
            displacement_start=states[:, :n], velocity_start=states[:, n : 2 * n],
            displacement_end=states[:, 2 * n : 3 * n], velocity_end=states[:, 3 * n :],
        )  # fmt: skip
