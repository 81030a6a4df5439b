"""The orbit that is born at grazing, and the excesses between which it keeps its period.

The oscillator starts from its motion just below grazing, F/F_g - 1 = -1e-3, and is driven at a small excess
until it settles: the period of what it settles on is the born period.  Followed upwards in steps of 10 % of
the excess, the orbit keeps its period up to some end; a start from just below grazing gives another period
only from some first excess on.  No start is closer to grazing than the amplitude is stable.
"""

from __future__ import annotations

from typing import Any

from contact.errors import ContactError
from contact.orbits.settling import born, born_period, settle
from contact.stroboscope import StroboscopicMap
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M

__all__ = [
    "BORN_EXCESS",
    "NOISE",
    "STEP",
    "first_birth",
    "period_of_birth",
    "upper_end",
]

BORN_EXCESS, CYCLES = 1e-3, 3000
NOISE = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M
"""Relative rms of the amplitude: 2.5e-4."""

STEP = 1.1
"""Factor between excesses when the upper end of an orbit is looked for."""


def period_of_birth(strobed: Any) -> int | None:
    """Period of the orbit that is born; None where it could not be computed."""
    try:
        return born_period(strobed, BORN_EXCESS, most_cycles=CYCLES)
    except ContactError:
        return None


def upper_end(strobed: StroboscopicMap, period: int, highest: float = 0.1) -> float | None:
    """Highest excess, in steps of 10 %, up to which the orbit born at 1e-3 keeps its period."""
    settled = born(strobed, BORN_EXCESS, most_cycles=CYCLES)
    if settled.period != period:
        return None
    excess, state = BORN_EXCESS, settled.end
    while excess < highest:
        settled = settle(strobed.at(STEP * excess), state, most_cycles=CYCLES)
        if settled.period != period:
            break
        excess, state = STEP * excess, settled.end
    return excess


def first_birth(strobed: StroboscopicMap, period: int, highest: float = 0.02) -> float | None:
    """Lowest excess, in steps of 10 %, at which a start from just below grazing gives this period."""
    excess = NOISE
    while excess < highest:
        if born_period(strobed, excess, most_cycles=CYCLES) == period:
            return excess
        excess *= STEP
    return None
