"""A scan of the drive amplitude that carries the state along, upwards and downwards, and its rows.

The settled state at one amplitude is the start at the next: on the way up a motion stays without impacts as
far as it can, on the way down it stays on p_m.  Each start is classified on its own afterwards.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.orbits.settling import settle
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies.instruments.attractors.kinds import UNDECIDED, classify
from studies.instruments.scene import Scene

__all__ = ["Start", "TITLES", "carried", "row_of"]

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """A state of a scan and what is drawn of it: `tip`, its strobed read-out, (record_cycles,) [m]."""

    model: str
    direction: str
    excess: float
    state: State
    tip: np.ndarray


def carried(
    strobed: StroboscopicMap, name: str, values: np.ndarray, scene: Scene, readout: str = "readout"
) -> tuple[list[Start], list[str]]:
    """Upward and downward scan of one model: the state is carried from one amplitude to the next."""
    found, failures = [], []
    state = strobed.at(float(values[0])).steady()
    for direction, ordered in (("up", values), ("down", values[::-1])):
        for excess in ordered:
            here = strobed.at(float(excess))
            try:
                settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
                orbit = here.orbit(settled.end, scene.scan.record_cycles)
            except ContactError as error:
                failures.append(f"{TITLES[name]}, excess {excess:.6g}: {error}")
                continue
            state = replace(settled.end, time=0.0)
            tip = here.readout(orbit.points, readout)
            found.append(Start(model=name, direction=direction, excess=float(excess), state=state, tip=tip))
    return found, failures


def row_of(strobed: StroboscopicMap, start: Start, cycles: int, settle_cycles: int) -> dict[str, Any]:
    """One row of the table."""
    head = {"model": start.model, "direction": start.direction, "excess": start.excess}
    try:
        found = classify(strobed.at(start.excess), start.state, cycles=cycles, most_cycles=settle_cycles)
    except ContactError as error:
        empty = {"period": None, "impacts": None, "lyapunov_map": None, "lyapunov_flow": None}
        return {**head, **empty, "kind": UNDECIDED, "failure": f"{TITLES[start.model]}: {error}"}
    return {**head, **asdict(found), "failure": ""}
