"""A batch of orbits of one mode: carried side by side, one by one where that does not settle a period.

``orbit_lanes`` carries orbits until each has come to the end or to a period that its straight pieces do not
settle: one that has to be searched, or that begins on the wall.  Such an orbit goes on alone for `ALONE`
periods by ``single_mode_loop`` and then joins the others again.  Where that happens changes nothing: both go
through the same operations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contact.flight import Motion
from contact.impact_log import ORDER, REGIME
from contact.integrators.event_loop import DONE
from contact.integrators.orbit_lanes import carry_lanes
from contact.integrators.single_mode_loop import strobed_motion
from contact.integrators.strobe_nodes import StrobeNodes
from contact.integrators.struck_period import LoopNumbers
from contact.series import OUTSIDE

__all__ = ["Lane", "carried_orbits"]

ALONE = 1000
"""Periods that an orbit goes on alone: they take several times as long as the call that begins them."""


@dataclass(kw_only=True)
class Lane:
    """An orbit on its way: its oscillator, where it stands, and what came of it.

    Parameters
    ----------
    motion, nodes, numbers, mean, weight
        As the kernels take them.
    u, v, integers, floats
        Deviation and bookkeeping as ``event_loop.advance`` takes them; overwritten.
    first : int
        Number of the strobe at which it starts.
    status, reached : int
        As those of ``advance``.
    """

    motion: Motion
    nodes: StrobeNodes
    numbers: LoopNumbers
    mean: np.ndarray
    weight: np.ndarray
    u: np.ndarray
    v: np.ndarray
    integers: np.ndarray
    floats: np.ndarray
    first: int
    status: int = DONE
    reached: int = 0

    @property
    def fits(self) -> bool:
        """Whether it stands at a strobe as the lanes take it: off the wall, not touching it."""
        return bool(self.integers[REGIME] == OUTSIDE and self.integers[ORDER] == 0)


def carried_orbits(orbits: Sequence[Lane], periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Carry at most `LANES` orbits over `periods` periods, each on its own clock.

    Returns
    -------
    points, counts : ndarray, shapes (n_orbits, periods, 2) and (n_orbits, periods)
        Good up to the period that an orbit has `reached`, if its status is not DONE.
    """
    points = np.empty((len(orbits), periods, 2))
    counts = np.empty((len(orbits), periods), dtype=np.int64)
    done = np.zeros(len(orbits), dtype=np.int64)
    going = list(range(len(orbits)))
    while going:
        _carry_together(orbits, [i for i in going if orbits[i].fits], done, points, counts)
        for i in going:
            orbit, here = orbits[i], int(done[i])
            there = min(here + ALONE, periods)
            if here < there:
                orbit.status, orbit.reached, _searched, _left = strobed_motion(
                    orbit.motion, orbit.nodes, orbit.numbers, orbit.u, orbit.v, orbit.integers, orbit.floats,
                    orbit.first + here, there - here, orbit.mean, orbit.weight, points[i, here:there],
                    counts[i, here:there],
                )  # fmt: skip
                done[i] = there
        going = [i for i in going if done[i] < periods and orbits[i].status == DONE]
    return points, counts


def _carry_together(
    orbits: Sequence[Lane], places: list[int], done: np.ndarray, points: np.ndarray, counts: np.ndarray
) -> None:
    """Carry those of `orbits` in `places` as far as lanes do."""
    if not places:
        return
    lanes = [orbits[i] for i in places]
    u, v = np.array([lane.u[0] for lane in lanes]), np.array([lane.v[0] for lane in lanes])
    rows = [lane.nodes.rows for lane in lanes]
    carry_lanes(
        np.array([lane.numbers for lane in lanes]), np.concatenate(rows),
        np.cumsum([0, *map(len, rows)]), u, v, np.array(places), done,
        np.array([lane.mean for lane in lanes]), np.array([lane.weight for lane in lanes]), points, counts,
    )  # fmt: skip
    for lane, un, vn in zip(lanes, u, v, strict=True):
        lane.u[0], lane.v[0] = un, vn
