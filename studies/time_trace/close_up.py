"""One collision from close by: tip relative to the plate, and the contact force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact import Collision, ImpactOscillator, State, simulate
from studies.force import contact_force

__all__ = ["CloseUp", "close_up"]

MARGIN, LEAST_MARGIN, SAMPLES = 2.0, 50e-6, 1201
"""Time before and after in contact times, and at least [s]; samples."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CloseUp:
    """Time from the first touch [s], tip past the plate [m], contact force [N]; `spans` are the contacts
    [s]."""

    time: NDArray[np.float64]
    height: NDArray[np.float64]
    force: NDArray[np.float64]
    spans: list[tuple[float, float]]


def close_up(oscillator: ImpactOscillator, state: State, collision: Collision) -> CloseUp:
    """A collision of the motion from `state`."""
    margin = max(MARGIN * collision.contact_time, LEAST_MARGIN)
    first, last = collision.first_touch - margin, collision.end + margin
    times = np.linspace(max(first, state.time), last, SAMPLES)
    run = simulate(oscillator, state, duration=last - state.time + margin, times=times)
    impacts = run.impacts
    inside = (impacts.start >= first) & (impacts.start <= collision.end)
    ends = zip(impacts.start[inside], impacts.end[inside], strict=True)
    return CloseUp(
        time=times - collision.first_touch,
        height=run.displacement @ oscillator.model.phi - oscillator.stop.gap,
        force=contact_force(oscillator, run),
        spans=[(float(a) - collision.first_touch, float(b) - collision.first_touch) for a, b in ends],
    )
