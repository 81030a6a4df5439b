"""A scan of the drive amplitude that carries the state along, upwards and downwards, and its rows."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import settle
from studies.attractors.kinds import Row, classify
from studies.scene import READOUT, Scene

__all__ = ["TITLES", "Start", "carried", "row_of"]

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}


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


def row_of(start: Start, cycles: int, most_cycles: int) -> Row | ContactError:
    """What the motion from a start settles on, or why that is not known."""
    try:
        found = classify(start.strobed, start.state, cycles=cycles, most_cycles=most_cycles)
    except ContactError as error:
        return error
    return Row(model=start.model, direction=start.direction, excess=start.excess, **asdict(found))
