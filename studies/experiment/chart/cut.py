"""A cut through the plane at one drive frequency: period, impacts and Lyapunov exponent over the amplitude.

The amplitude is raised and lowered again, and the state is carried along.

lyapunov_map     largest Lyapunov exponent per drive period, from the Jacobians of the period map
kind             periodic, chaotic (exponent above zero by three standard errors), not settled (below zero
                 by as much: a long period or a slow transient), or undecided
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import Exponents, Settled, map_exponents, orbit_exponents, settle
from studies.shell.scene import READOUT, Scene

FREQUENCY = 21.50
"""Drive frequency of the letter's period 4 [Hz]."""

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}

SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

KINDS = WITHOUT, PERIODIC, CHAOTIC, NOT_SETTLED, UNDECIDED = (
    "without impacts",
    "periodic",
    "chaotic",
    "not settled",
    "undecided",
)


@dataclass(frozen=True, kw_only=True)
class Settlement:
    """The settled motion at one amplitude: `period` in drive periods, 0 for none; `impacts` in one such
    period; `lyapunov_map` per drive period with its standard error."""

    model: str
    direction: str
    excess: float
    kind: str
    period: int
    impacts: int
    lyapunov_map: float
    error_map: float


def kind_of(strobed: StroboscopicMap, settled: Settled[State], cycles: int) -> tuple[str, Exponents]:
    """Chaos told from a long period or a slow transient by the exponents, averages over `cycles` drive
    periods."""
    if settled.period:
        kind = PERIODIC if settled.impacts else WITHOUT
        return kind, orbit_exponents(strobed, settled.end, settled.period)
    exponents, _end = map_exponents(strobed, settled.end, cycles, align=ALIGN)
    if abs(exponents.largest) <= SIGNIFICANT * exponents.error:
        return UNDECIDED, exponents
    return CHAOTIC if exponents.largest > 0 else NOT_SETTLED, exponents


def carried(
    named: tuple[str, StroboscopicMap], scene: Scene, values: np.ndarray, cycles: int
) -> tuple[list[Settlement], list[np.ndarray], list[str]]:
    """Upward and downward scan of one model, the settled state the start at the next amplitude; with the rows
    their strobed read-out, shape (record_cycles,) each, and third what failed.

    On the way up a motion stays without impacts as far as it can, on the way down it stays on p_m.
    """
    name, strobed = named
    rows, points, failures = [], [], []
    state = strobed.at(float(values[0])).steady()
    for direction, ordered in (("up", values), ("down", values[::-1])):
        for excess in ordered.tolist():
            here = strobed.at(excess)
            try:
                settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
                state = replace(settled.end, time=0.0)
                orbit = here.orbit(state, scene.scan.record_cycles)
                kind, exponents = kind_of(here, settled, cycles)
            except ContactError as error:
                failures.append(f"{TITLES[name]}, excess {excess:.6g}, {direction}: {error}")
                continue
            points.append(here.readout(orbit.points, READOUT))
            rows.append(
                Settlement(
                    model=name,
                    direction=direction,
                    excess=excess,
                    kind=kind,
                    period=settled.period,
                    impacts=settled.impacts if settled.period else 0,
                    lyapunov_map=exponents.largest,
                    error_map=exponents.error,
                )
            )
    return rows, points, failures
