"""Drive periods as a map: what every strobed or iterated system offers.

Sampling a driven oscillator at the strobe times t_n = n/f turns its motion into the iteration of a map; its
periodic orbits are the p_m orbits of the letter (1996, Fig. 2).  ``StroboscopicMap`` is that map for any
impact oscillator, ``StrobedNordmarkMap`` the letter's Eqs. (2), (3): whatever scans, settles or classifies
orbits takes either, and any other class with these methods.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import InvalidValue, require_array, require_kind

S = TypeVar("S")

Jacobians = tuple[list[tuple[np.ndarray, int]], S]
"""Derivatives along an orbit, each with the number of steps that it spans, and where the orbit ended."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StrobedOrbit(Generic[S]):
    """A stretch of a strobed motion.

    Parameters
    ----------
    end : State
        Where it ended.
    points : ndarray, shape (n_strobes, n_coordinates)
        Coordinates at the strobes, all in the same unit, the start excluded.
    impacts : ndarray of int, shape (n_strobes,)
        Impacts since the strobe before.
    """

    end: S
    points: np.ndarray
    impacts: np.ndarray


@runtime_checkable
class StrobedMap(Protocol[S]):
    """A strobed or iterated system; its coordinates have one unit and a common `scale`."""

    @property
    def scale(self) -> float:
        """The size of a coordinate at grazing, in the unit of `points`."""

    def at(self, excess: float) -> StrobedMap[S]:
        """The same system at another excess over grazing [1]."""

    def steady(self) -> S:
        """The orbit without impacts at a strobe; above grazing, what it would be without the stop."""

    def orbit(self, state: S, count: int) -> StrobedOrbit[S]:
        """`count` periods from `state`."""


def require_map(strobed: object, kind: type = StrobedMap) -> None:
    """TypeError unless this is a strobed map of this kind."""
    words = "with derivatives, " if kind is DifferentiableMap else ""
    require_kind("strobed", strobed, kind, f"a strobed map {words}such as a StroboscopicMap")


def amplitude_factors(factors: ArrayLike | None, count: int) -> np.ndarray:
    """Factors of the drive amplitude, one for each of `count` periods; none, shape (0,), for None.

    Raises
    ------
    TypeError, ValueError
        If they are not `count` numbers above zero.
    """
    if factors is None:
        return np.empty(0)
    found = require_array("factors", factors, "[1]", shape=(count,), words="one number for each period")
    if found.size and not found.min() > 0.0:
        raise InvalidValue(f"factors holds {found.min()} [1]; every factor of the amplitude must be above 0")
    return found.copy()  # one that may be written to, as kernels are compiled for


@runtime_checkable
class DifferentiableMap(StrobedMap[S], Protocol[S]):
    """One whose derivatives are known: what exponents are found of."""

    def jacobians(self, state: S, count: int) -> Jacobians[S]:
        """Derivatives of the points with respect to those before, along at least one of `count` periods."""

    def coordinates(self, state: S) -> np.ndarray:
        """Coordinates of a state, those of `points`, shape (n_coordinates,)."""
