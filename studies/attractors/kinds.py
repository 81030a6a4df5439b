"""What a motion settles on: periodic, chaotic or neither, by its period and its largest Lyapunov exponent.

    lyapunov_map     largest exponent per drive period, from the Jacobians of the period map
    lyapunov_flow    the same per second, from two neighbouring motions: an independent route
    kind             periodic, chaotic (exponent above zero by three standard errors), not settled (below zero
                     by as much: a long period or a slow transient), or undecided

Both exponents are one number, lyapunov_map = lyapunov_flow / f.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from contact import StrobedMap
from contact.orbits import divergence_rate, map_exponents, orbit_exponents, settle

__all__ = ["ALIGN", "CHAOTIC", "KINDS", "NOT_SETTLED", "PERIODIC", "UNDECIDED", "WITHOUT", "Attractor", "Row",
           "agreement", "classify"]  # fmt: skip

S = TypeVar("S")

SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

KINDS = WITHOUT, PERIODIC, CHAOTIC, NOT_SETTLED, UNDECIDED = (
    "without impacts", "periodic", "chaotic", "not settled", "undecided"
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Attractor:
    """What a motion settled on.

    `period` in drive periods, 0 for none; `impacts` in one such period, or `impacts_per_period` on average;
    `lyapunov_map` per drive period and `lyapunov_flow` [1/s] with their standard errors (NaN: not computed).
    """

    kind: str
    period: int
    impacts: int
    impacts_per_period: float
    lyapunov_map: float
    error_map: float
    lyapunov_flow: float
    error_flow: float


@dataclass(frozen=True, kw_only=True)
class Row(Attractor):
    """One amplitude of a scan."""

    model: str
    direction: str
    excess: float


def classify(
    strobed: StrobedMap[S],
    state: S,
    *,
    most_cycles: int = 4000,
    cycles: int = 600,
    flow: bool = True,
) -> Attractor:
    """Settle from `state`, then tell chaos from a long period or a slow transient by the exponents.

    Parameters
    ----------
    strobed : StrobedMap
        At its amplitude.
    state : State
    most_cycles : int
        Bound of settling.
    cycles : int
        Drive periods in the averages.
    flow : bool
        Whether the second route is taken as well.
    """
    settled = settle(strobed, state, most_cycles=most_cycles)
    if settled.period:
        exponents = orbit_exponents(strobed, settled.end, settled.period)
        impacts, mean = settled.impacts, settled.impacts / settled.period
        kind = PERIODIC if impacts else WITHOUT
    else:
        exponents, _end = map_exponents(strobed, settled.end, cycles, align=ALIGN)
        impacts, mean = 0, float(strobed.orbit(settled.end, cycles).impacts.mean())
        clear = abs(exponents.largest) > SIGNIFICANT * exponents.error
        kind = UNDECIDED if not clear else CHAOTIC if exponents.largest > 0 else NOT_SETTLED
    rate = error = float("nan")
    if flow:
        found = divergence_rate(strobed, settled.end, cycles * strobed.period, align=ALIGN * strobed.period)
        rate, error = found.largest, found.error
    return Attractor(
        kind=kind, period=settled.period, impacts=impacts, impacts_per_period=mean,
        lyapunov_map=exponents.largest, error_map=exponents.error, lyapunov_flow=rate, error_flow=error,
    )  # fmt: skip


def agreement(rows: Sequence[Row], frequency: float) -> dict[str, float | None]:
    """Largest difference of both routes on periodic orbits, and on chaos in standard errors."""
    regular, chaos = [], []
    for row in rows:
        difference = abs(row.lyapunov_map - row.lyapunov_flow / frequency)
        if row.period:
            regular.append(difference)
        else:
            chaos.append(difference / float(np.hypot(row.error_map, row.error_flow / frequency)))
    return {"periodic": max(regular, default=None), "chaotic_in_standard_errors": max(chaos, default=None)}
