"""Settling on a periodic orbit and telling its period.

The motion is followed in blocks.  After each block the last points are compared with those p strobes earlier,
p = 1 ... `largest_period`: the orbit has period p if all coordinates of the last `largest_period` points
repeat to `TOLERANCE` of the scale and the impact counts repeat exactly.  A motion that has not repeated after
`most_cycles` periods gets period 0: chaos, a longer period, or a transient that is not over.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from contact.stroboscope import StrobedMap

__all__ = ["TOLERANCE", "Settled", "period_of", "settle"]

S = TypeVar("S")

TOLERANCE = 1e-9
"""Largest change over one period of a settled orbit, relative to the scale of its coordinates.  Rounding is
at 1e-14; the slow drift past a vanished fold at relative distance 1e-7 moves by more than this per period."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Settled(Generic[S]):
    """What a motion settled on.

    Parameters
    ----------
    period : int
        Smallest period in strobes, 0 if none was found.
    impacts : int
        Impacts in one such period (or in the last block, if there is none).
    end : State
        The state reached.
    cycles : int
        Periods of the drive that it took.
    points : ndarray, shape (block, n_coordinates)
        The last strobed points.
    """

    period: int
    impacts: int
    end: S
    cycles: int
    points: np.ndarray


def period_of(points: np.ndarray, impacts: np.ndarray, *, largest_period: int, tolerance: float) -> int:
    """The smallest p <= `largest_period` with which the last `largest_period` points repeat, or 0.

    Parameters
    ----------
    points : ndarray, shape (n_strobes, n_coordinates)
        At least 2 * `largest_period` strobes.
    impacts : ndarray of int, shape (n_strobes,)
    largest_period : int
    tolerance : float
        In the unit of the points.
    """
    last = points[-1]
    for period in range(1, largest_period + 1):
        if np.max(np.abs(last - points[-1 - period])) > tolerance:
            continue
        stretch = slice(-largest_period, None)
        before = slice(-largest_period - period, -period)
        if np.array_equal(impacts[stretch], impacts[before]) and (
            np.max(np.abs(points[stretch] - points[before])) <= tolerance
        ):
            return period
    return 0


def settle(
    strobed: StrobedMap[S],
    state: S,
    *,
    most_cycles: int,
    largest_period: int = 64,
    tolerance: float = TOLERANCE,
) -> Settled[S]:
    """Follow a motion until it is periodic, or for `most_cycles` drive periods.

    Parameters
    ----------
    strobed : StrobedMap
        The beam, Eq. (1) or the Nordmark map at one drive amplitude.
    state : State
        Where to start.
    most_cycles : int
        The bound on the run; a block of 2 * `largest_period` is run in any case.
    largest_period : int
    tolerance : float
        Relative to the scale of the strobed map.
    """
    block = 2 * largest_period
    cycles = 0
    while True:
        orbit = strobed.orbit(state, block)
        state, cycles = orbit.end, cycles + block
        period = period_of(
            orbit.points, orbit.impacts, largest_period=largest_period, tolerance=tolerance * strobed.scale
        )
        if period or cycles >= most_cycles:
            counted = orbit.impacts[-period:] if period else orbit.impacts
            return Settled(
                period=period, impacts=int(counted.sum()), end=state, cycles=cycles, points=orbit.points
            )
