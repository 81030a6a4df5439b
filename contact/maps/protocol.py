"""Drive periods as a map: the methods of every strobed or iterated system.

Sampling a driven oscillator at the strobe times t_n = n/f turns its motion into the iteration of a map.  Its
periodic orbits are the p_m orbits of the letter (1996, Fig. 2).  Scans and searches for orbits take the maps
of ``contact.maps``, and any other class with the methods of `StrobedMap`.
"""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import record, require, require_array, require_kind

S = TypeVar("S")

Jacobians = tuple[list[tuple[np.ndarray, int]], S]
"""Derivatives along an orbit, each with the number of steps that it spans, and the state at its end.

A singular one may be given as several rectangular factors, in the order of time; all but the last span 0."""


@record
class StrobedOrbit(Generic[S]):
    """The strobes of a motion one after the other, and the state at the end.

    Parameters
    ----------
    end : State
        The state at the last strobe; the start if there are no strobes.
    points : ndarray, shape (n_strobes, n_coordinates)
        Coordinates at the strobes, all in the same unit, the start excluded.
    impacts : ndarray of int, shape (n_strobes,)
        Impacts in the period before each strobe.
    """

    end: S
    points: np.ndarray
    impacts: np.ndarray


@runtime_checkable
class StrobedMap(Protocol[S]):
    """A strobed or iterated system.  Its coordinates have one unit and a common `scale`.

    This is a protocol: every class with these methods is a strobed map.  The maps of this package also take
    `factors` of the drive amplitude, one for each period of an `orbit`.
    """

    @property
    def scale(self) -> float:
        """The size of a coordinate at grazing, in the unit of `points`."""

    def at(self, excess: float) -> StrobedMap[S]:
        """This system at another excess over grazing [1]."""

    def steady(self) -> S:
        """The state of the steady motion at a strobe, as it would be without the stop."""

    def orbit(self, state: S, count: int) -> StrobedOrbit[S]:
        """`count` periods from `state`."""


def require_map(strobed: object, kind: type = StrobedMap) -> None:
    """TypeError unless this is a strobed map of this kind."""
    words = "with derivatives, " if kind is DifferentiableMap else ""
    require_kind("strobed", strobed, kind, f"a strobed map {words}such as a StroboscopicMap")


def amplitude_factors(factors: ArrayLike | None, count: int) -> np.ndarray:
    """Factors of the drive amplitude for `count` periods; an empty array, shape (0,), for None.

    Raises TypeError or ValueError if they are not `count` numbers above zero.
    """
    if factors is None:
        return np.empty(0)
    found = require_array("factors", factors, "[1]", shape=(count,), words="one number for each period")
    least = found.min(initial=1.0)
    require(least > 0.0, f"factors holds {least} [1]; every factor of the amplitude must be above 0")
    return found.copy()  # kernels are compiled for arrays that may be written to


@runtime_checkable
class DifferentiableMap(StrobedMap[S], Protocol[S]):
    """A strobed map with derivatives, as Lyapunov exponents need them."""

    def jacobians(self, state: S, count: int) -> Jacobians[S]:
        """Derivatives of each point with respect to the one before, along at least one of `count` periods."""

    def coordinates(self, state: S) -> np.ndarray:
        """Coordinates of a state, shape (n_coordinates,), as in the `points` of an orbit."""
