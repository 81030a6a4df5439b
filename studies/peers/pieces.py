"""A motion put together from pieces: a solver integrates to the next event, here it is said what follows.

flight --d rises--> Newton's law: v_k -> v_k - phi_k (1 + e) d'/sum phi^2, and on in flight;  else in contact
in contact --d falls--> flight
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from contact import (
    Chatter,
    ImpactOscillator,
    Impacts,
    State,
    Trajectory,
)
from contact.integrators import Run
from studies.peers.equations import EPS, Array, Equations

__all__ = ["Advance", "Piece", "pieced"]

MOST_IMPACTS = 2000
"""Bound of impacts in one period: with so many the tip is on its way to rest, which is not followed."""

MOST_STALLS = 50
"""Bound of pieces in a row without a duration; flights and contacts of a regular motion alternate."""


class Piece(NamedTuple):
    """How far a solver came: time, state, whether an event ended it, the states at the times passed, and what
    it has spent."""

    end: float
    state: Array
    event: bool
    samples: Array
    evaluations: int


Advance = Callable[[bool, float, Array, Array], Piece]
"""advance(contact, begin, y, times) -> Piece: to the first event or to the last of `times`."""


Event = tuple[float, Array]
"""Time and state of a touch or release."""


def pieced(
    oscillator: ImpactOscillator, run: Run, tolerance: float, solver: Callable[[Equations], Advance]
) -> Trajectory:
    """The motion of `run`, from one event to the next."""
    e = Equations(oscillator, run, tolerance)
    n, period, start, advance = e.n, oscillator.period, run.start, solver(e)
    y = np.concatenate([start.displacement, start.velocity])
    depth, rate = e.tip(y)
    if start.regime != 0 or depth > e.rounding:
        raise ValueError(
            f"regime of the state is {start.regime}, {depth:.3g} m behind the stop; outside solvers begin "
            "off the stop"
        )
    contact, touches, releases, begun = False, list[Event](), list[Event](), list[float]()
    if depth >= -e.rounding and rate > 0.0:
        contact, before, y = e.touch(y)
        touches.append((0.0, before))
        begun.append(0.0)
        releases += [] if contact else [(0.0, y)]
    passed = np.arange(run.first + 1, run.last + 1)
    strobe = np.clip((passed - run.first) * period - run.clock, 0.0, run.length)
    sample = np.clip((run.sample_period - run.first) * period + run.sample_clock - run.clock, 0.0, run.length)
    times, place = np.unique(np.concatenate([strobe, sample, [run.length]]), return_inverse=True)
    states, reached, s = np.empty((times.size, 2 * n)), 0, 0.0
    spent, stalls, slack = 0, 0, 8.0 * EPS * run.length
    while True:
        while reached < times.size and times[reached] <= s + slack:
            states[reached] = y
            reached += 1
        if reached == times.size:
            break
        piece = advance(contact, s, y, times[reached:])
        states[reached : reached + len(piece.samples)] = piece.samples
        reached, spent = reached + len(piece.samples), spent + piece.evaluations
        stalls = stalls + 1 if piece.end <= s + slack else 0
        s, y = piece.end, piece.state
        if not np.all(np.isfinite(y)):
            raise e.failed(s, y, "the state is not finite")
        if not piece.event:
            continue
        if contact:
            contact = False
            releases.append((s, y))
        else:
            contact, before, y = e.touch(y)
            touches.append((s, before))
            begun.append(s)
            releases += [] if contact else [(s, y)]
        if stalls > MOST_STALLS:
            raise e.failed(s, y, "the solver finds one event after another there")
        if len(begun) > MOST_IMPACTS and s - begun[-MOST_IMPACTS] < period:
            raise e.failed(s, y, f"more than {MOST_IMPACTS} in one period", Chatter)
    counts = np.bincount(np.searchsorted(strobe, begun), minlength=passed.size + 1)[: passed.size]
    at_strobe, at_sample, last = np.split(states[place], [passed.size, passed.size + sample.size])
    end = State(displacement=last[0, :n], velocity=last[0, n:], time=run.last * period + run.clock_end,
                regime=int(contact))  # fmt: skip
    return Trajectory(
        end=end, strobe_time=passed * period, strobe_displacement=at_strobe[:, :n],
        strobe_velocity=at_strobe[:, n:], strobe_impacts=counts.astype(np.int64), time=run.times,
        displacement=at_sample[:, :n], velocity=at_sample[:, n:], impacts=impacts_of(e, touches, releases),
        evaluations=spent,
    )  # fmt: skip


def impacts_of(e: Equations, touches: list[Event], releases: list[Event]) -> Impacts:
    """The touches as named arrays; a contact that has not ended has no release."""
    n, count = e.n, len(touches)
    begin = np.array([s for s, _y in touches]).reshape(count)
    before = np.array([y for _s, y in touches]).reshape(count, 2 * n)
    end, after = np.full(count, np.nan), np.full((count, 2 * n), np.nan)
    for i, (s, y) in enumerate(releases):
        end[i], after[i] = s, y
    approach, rebound = before[:, n:] @ e.phi, after[:, n:] @ e.phi
    lost = 0.5 * (approach**2 - rebound**2) / e.compliance if e.hard else 0.0 * rebound
    return Impacts(
        start=e.start.time + begin, end=e.start.time + end, approach=approach, rebound=rebound, loss=lost,
        kind=np.zeros(count, dtype=np.int64), displacement_start=before[:, :n], velocity_start=before[:, n:],
        displacement_end=after[:, :n], velocity_end=after[:, n:],
    )  # fmt: skip
