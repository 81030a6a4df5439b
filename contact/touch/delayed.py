"""A rebound that waits: the tip stays on the wall for a time, then leaves (``DelayedRestitution``).

The letter's "energy loss and time delay" as a law of one mode: restitution and delay are functions of the
approach speed, sampled with their slopes in a table.  In the regime WAITING the tip rides on the wall, which
for one mode says all: u = -(x_s(t) - gap)/phi, v = -x_s'(t)/phi.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

from contact.compiled import kernel
from contact.flight.modal_flow import tip_steady
from contact.flight.motion import WEIGHT
from contact.touch import newton
from contact.trajectory import OUTSIDE, WAITING

__all__ = ["force", "from_table", "leave", "place", "room", "slopes", "state", "step", "stiffness", "strike",
           "work"]  # fmt: skip

force, stiffness, slopes, room, place, work = (
    newton.force, newton.stiffness, newton.slopes, newton.room, newton.place, newton.work
)  # fmt: skip

RESTITUTION, DELAY = 1, 3
"""Rows of the table, each with its slope behind; the first holds the approach speeds."""


@kernel
def from_table(table, speed, row):
    """Value of row `row` of a law's table at an approach speed, by the cubic through values and slopes."""
    n = table.shape[1]
    if speed <= table[0, 0]:
        return table[row, 0]
    if speed >= table[0, n - 1]:
        return table[row, n - 1]
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[0, middle] <= speed:
            low = middle
        else:
            high = middle
    h = table[0, high] - table[0, low]
    s = (speed - table[0, low]) / h
    a, b = table[row, low], table[row, high]
    da, db = h * table[row + 1, low], h * table[row + 1, high]
    return a + s * (da + s * (3.0 * (b - a) - 2.0 * da - db + s * (2.0 * (a - b) + da + db)))


@kernel
def strike(motion, run, u, v, approach):
    """The touch: how long the tip will wait, and with which velocity it will leave."""
    run.rebound = -from_table(motion.table, approach, RESTITUTION) * approach
    run.wait = from_table(motion.table, approach, DELAY)
    return WAITING, run.rebound, 0.5 * (approach * approach - run.rebound**2) / motion.compliance


@kernel
def step(motion, run, u, v, limit, series):
    """The wait, at most `limit` [s]; see ``contact.touch``."""
    if run.wait <= limit:
        h, following, run.wait = run.wait, OUTSIDE, 0.0
    else:
        h, following, run.wait = limit, WAITING, run.wait - limit
    return h, h, following


@kernel
def state(motion, run, h, series, u, v):
    """The deviation a time `h` [s] into the wait."""
    height, velocity, _acceleration = tip_steady(motion, run.clock + h)
    u[0] = -height / motion.modes[WEIGHT, 0]
    v[0] = -velocity / motion.modes[WEIGHT, 0]


@kernel
def leave(motion, run, u, v):
    """The rebound."""
    v[0] += run.rebound / motion.modes[WEIGHT, 0]
    run.order = 1 if run.rebound < 0.0 else 2
