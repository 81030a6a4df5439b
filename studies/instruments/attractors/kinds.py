"""What a motion settles on: periodic, chaotic or neither, by its period and its largest Lyapunov exponent.

    lyapunov_map        largest exponent per drive period, from the Jacobians of the period map
    lyapunov_flow       the same per second, from two neighbouring motions: an independent route
    kind                periodic, chaotic (exponent above zero by three standard errors), not settled (below
                        zero by as much: a long period or a slow transient), or undecided

Both exponents are one number, lyapunov_map = lyapunov_flow / f.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from contact.orbits.lyapunov import (
    Differentiable,
    divergence_rate,
    map_exponents,
    of_oscillator,
    orbit_exponents,
)
from contact.orbits.settling import settle
from contact.stroboscope import StrobedMap

__all__ = [
    "ALIGN",
    "Attractor",
    "CHAOTIC",
    "NOT_SETTLED",
    "PERIODIC",
    "SIGNIFICANT",
    "UNDECIDED",
    "WITHOUT",
    "agreement",
    "classify",
]

S = TypeVar("S")

SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

WITHOUT, PERIODIC, CHAOTIC = "without impacts", "periodic", "chaotic"
NOT_SETTLED, UNDECIDED = "not settled", "undecided"


@dataclass(frozen=True, kw_only=True)
class Attractor:
    """What a motion settled on.

    `period` in drive periods, 0 for none; `impacts` in one such period, or `impacts_per_period` on average;
    `lyapunov_map` per drive period and `lyapunov_flow` [1/s] with their standard errors; `kind` as in the
    module's docstring.
    """

    kind: str
    period: int
    impacts: int
    impacts_per_period: float
    lyapunov_map: float
    error_map: float
    lyapunov_flow: float
    error_flow: float


def classify(
    strobed: StrobedMap[S],
    state: S,
    derivatives: Callable[[Any], Differentiable[Any]] = of_oscillator,
    *,
    most_cycles: int = 4000,
    cycles: int = 600,
    largest_period: int = 64,
    flow: bool = True,
) -> Attractor:
    """Settle from `state`, then tell chaos from a long period or a slow transient by the exponents.

    Parameters
    ----------
    strobed : StrobedMap
        At its amplitude.
    state : State
        Where to start.
    derivatives : callable
        From the strobed map to its derivatives; `of_oscillator` by default.
    most_cycles, largest_period : int
        Bounds of settling, as in `settle`.
    cycles : int
        Drive periods in the averages.
    flow : bool
        Whether the second route is taken as well; without it those fields are not numbers.

    Raises
    ------
    ContactError
        If the motion could not be followed.
    """
    system = derivatives(strobed)
    settled = settle(strobed, state, most_cycles=most_cycles, largest_period=largest_period)
    if settled.period:
        exponents = orbit_exponents(system, settled.end, settled.period)
        impacts, mean = settled.impacts, settled.impacts / settled.period
        kind = PERIODIC if impacts else WITHOUT
    else:
        exponents, _end = map_exponents(system, settled.end, cycles, align=ALIGN)
        counted = strobed.orbit(settled.end, cycles).impacts
        impacts, mean = 0, float(counted.mean())
        clear = abs(exponents.largest) > SIGNIFICANT * exponents.error
        kind = UNDECIDED if not clear else CHAOTIC if exponents.largest > 0 else NOT_SETTLED
    rate = error = float("nan")
    if flow:
        found = divergence_rate(system, settled.end, cycles * system.period, align=ALIGN * system.period)
        rate, error = found.largest, found.error
    return Attractor(
        kind=kind,
        period=settled.period,
        impacts=impacts,
        impacts_per_period=mean,
        lyapunov_map=exponents.largest,
        error_map=exponents.error,
        lyapunov_flow=rate,
        error_flow=error,
    )


def agreement(rows: Sequence[Mapping[str, Any]], frequency: float) -> dict[str, float | None]:
    """Largest difference of both routes on periodic orbits, and on chaos in standard errors."""
    regular, chaos = [], []
    for row in rows:
        if row["lyapunov_map"] is None:
            continue
        difference = abs(row["lyapunov_map"] - row["lyapunov_flow"] / frequency)
        if row["period"]:
            regular.append(difference)
        else:
            chaos.append(difference / float(np.hypot(row["error_map"], row["error_flow"] / frequency)))
    return {"periodic": max(regular, default=None), "chaotic_in_standard_errors": max(chaos, default=None)}
