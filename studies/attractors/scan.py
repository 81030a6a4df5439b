"""A scan of the drive amplitude that carries the state along, and what its motions settle on.

lyapunov_map     largest Lyapunov exponent per drive period, from the Jacobians of the period map
kind             periodic, chaotic (exponent above zero by three standard errors), not settled (below zero
                 by as much: a long period or a slow transient), or undecided
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import map_exponents, orbit_exponents, settle
from studies.scene import READOUT, Scene

__all__ = ["CHAOTIC", "KINDS", "TITLES", "Row", "Start", "carried", "classify", "row_of"]

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}

SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

KINDS = WITHOUT, PERIODIC, CHAOTIC, NOT_SETTLED, UNDECIDED = (
    "without impacts", "periodic", "chaotic", "not settled", "undecided"
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a motion at one amplitude settled on: `period` in drive periods, 0 for none; `impacts` in one such
    period; `lyapunov_map` per drive period with its standard error."""

    kind: str
    period: int
    impacts: int
    lyapunov_map: float
    error_map: float
    model: str = ""
    direction: str = ""
    excess: float = 0.0


def classify(strobed: StroboscopicMap, state: State, *, most_cycles: int = 4000, cycles: int = 600) -> Row:
    """Settle from `state` within `most_cycles`, then tell chaos from a long period or a slow transient by the
    exponents, averages over `cycles` drive periods."""
    settled = settle(strobed, state, most_cycles=most_cycles)
    if settled.period:
        exponents = orbit_exponents(strobed, settled.end, settled.period)
        kind = PERIODIC if settled.impacts else WITHOUT
    else:
        exponents, _end = map_exponents(strobed, settled.end, cycles, align=ALIGN)
        clear = abs(exponents.largest) > SIGNIFICANT * exponents.error
        kind = UNDECIDED if not clear else CHAOTIC if exponents.largest > 0 else NOT_SETTLED
    return Row(
        kind=kind, period=settled.period, impacts=settled.impacts if settled.period else 0,
        lyapunov_map=exponents.largest, error_map=exponents.error,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """A state of a scan and what is drawn of it: `points`, its strobed read-out, shape (record_cycles,)."""

    model: str
    direction: str
    strobed: StroboscopicMap
    excess: float
    state: State
    points: np.ndarray

    def __str__(self) -> str:
        return f"{TITLES[self.model]}, excess {self.excess:.6g}, {self.direction}"


def carried(
    named: tuple[str, StroboscopicMap], scene: Scene, values: np.ndarray
) -> tuple[list[Start], list[str]]:
    """Upward and downward scan of one model: the settled state is the start at the next amplitude.

    On the way up a motion stays without impacts as far as it can, on the way down it stays on p_m.
    """
    name, strobed = named
    found, failures = [], []
    state = strobed.at(float(values[0])).steady()
    for direction, ordered in (("up", values), ("down", values[::-1])):
        for excess in ordered.tolist():
            here = strobed.at(excess)
            try:
                settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
                orbit = here.orbit(settled.end, scene.scan.record_cycles)
            except ContactError as error:
                failures.append(f"{TITLES[name]}, excess {excess:.6g}: {error}")
                continue
            state = replace(settled.end, time=0.0)
            found.append(Start(model=name, direction=direction, strobed=here, excess=excess, state=state,
                               points=here.readout(orbit.points, READOUT)))  # fmt: skip
    return found, failures


def row_of(start: Start, cycles: int, most_cycles: int) -> Row:
    """What the motion from a start settles on."""
    found = classify(start.strobed, start.state, cycles=cycles, most_cycles=most_cycles)
    return replace(found, model=start.model, direction=start.direction, excess=start.excess)
