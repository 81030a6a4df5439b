"""The record of touches, for a run, for the flow from touch to touch, and for a periodic orbit.

Times are kept as the number of a drive period and the time since its strobe, so that a million periods bring
no loss of phase.  In an orbit they count from its first touch.  States are those that the method carries:
deviations from the steady motion, or displacements and velocities themselves.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from beam.parameters import Array
from contact.machine.compiled import kernel, part
from contact.trajectory import IMPACT

MARKS = np.dtype([(name, "i8") for name in ("logged", "sampled", "strobed", "impacts", "touching")])
"""Rows in use of log, samples and strobes; impacts since the last strobe; whether the tip touches."""

_NAMES = ("period", "start", "end_period", "end", "approach", "rebound", "loss", "kind")
TOUCH = np.dtype([(name, "i8" if name in ("period", "end_period", "kind") else "f8") for name in _NAMES])
"""A touch: period and clock of its start and of its end [s], tip velocity at both [m/s], energy lost [J] and
``contact.trajectory.ImpactKind``."""


class Touches(NamedTuple):
    """Touches in the order in which they began; a record with more fields can stand in its place."""

    marks: np.ndarray  # `MARKS`, shape (1,)
    log: np.ndarray  # `TOUCH`, shape (capacity,); empty if no touches are wanted
    log_state: np.ndarray  # (u, v) just before the touch and just after the release, (capacity, 4 n_modes)

    @property
    def states(self) -> Array:
        """(u, v) just before and just after each touch, shape (capacity, 2, 2, n_modes)."""
        return self.log_state.reshape(len(self.log), 2, 2, -1)

    def since(self, start: float) -> Touches:
        """The touches so far, their times counted from `start` [s]."""
        logged = int(self.marks[0]["logged"])
        log = self.log[:logged].copy()
        log["start"], log["end"] = log["start"] - start, log["end"] - start
        return Touches(self.marks, log, self.log_state[:logged])


def new_touches(capacity: int, n_modes: int) -> Touches:
    """An empty record with a place for `capacity` touches."""
    return Touches(np.zeros(1, MARKS), np.zeros(capacity, TOUCH), np.empty((capacity, 4 * n_modes)))


@part
def put_state(row, at, u, v):
    """Write (u, v) into a row from column `at` on."""
    n = u.size
    for k in range(n):
        row[at + k] = u[k]
        row[at + n + k] = v[k]


@part
def is_full(record):
    """Whether the log has no rows left for a touch and the stay that may follow it."""
    return record.log.size > 0 and record.marks[0].logged >= record.log.size - 1


@kernel
def open_touch(record, period, clock, approach, kind, u, v):
    """Start a row of the log."""
    marks = record.marks[0]
    marks.touching = 1
    marks.impacts += 1 if kind == IMPACT else 0
    i = marks.logged
    marks.logged += 1
    if record.log.size == 0:
        return
    row, n = record.log[i], u.size
    row.period, row.start, row.end_period, row.end = period, clock, period, math.nan
    row.approach, row.rebound, row.loss, row.kind = approach, math.nan, 0.0, kind
    put_state(record.log_state[i], 0, u, v)
    record.log_state[i, 2 * n :] = math.nan


@part
def add_loss(record, energy):
    """Add energy that the touch under way has taken [J]."""
    if record.log.size > 0:
        record.log[record.marks[0].logged - 1].loss += energy


@kernel
def close_touch(record, period, clock, rebound, u, v):
    """Complete the last row of the log."""
    record.marks[0].touching = 0
    if record.log.size == 0:
        return
    i = record.marks[0].logged - 1
    row = record.log[i]
    row.end_period, row.end, row.rebound = period, clock, rebound
    put_state(record.log_state[i], 2 * u.size, u, v)
