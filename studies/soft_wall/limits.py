"""What the closed forms say at one frequency, and how the end of p_m nears that of the hard wall."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from scipy.optimize import brentq

from contact import ContactError
from studies import letter
from studies.scene import Scene, single_mode_at
from studies.soft_wall.closed_forms import SoftWall
from studies.soft_wall.measured import Case, end_of

__all__ = ["Limits", "attempt", "limits_at"]

HARD, HARDEST = 1e7, 1e8
"""Between these the distance of the fold from that of the hard wall is a power of K."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What the closed forms say at one frequency: K below which p1 without dashpot never doubles, K below
    which it doubles above the letter's amplitude stability, K times the relative error of the formula for
    K -> infinity; and the powers of K with which the end of p_m nears the hard wall's."""

    frequency_hz: float
    least_hardness: float
    visible_below_hardness: float | None
    shortfall_times_hardness: float
    power_of_end_lossless: float | None
    power_of_end_dashpot: float | None


def attempt(job: Callable[[Any], Any], argument: Any) -> Any:
    """The result, or the error that a cell may end with."""
    try:
        return job(argument)
    except (ContactError, ValueError) as error:
        return error


def limits_at(scene: Scene, zeta: float, frequency: float) -> Limits:
    """One row of the limits."""

    def beyond(log_hardness: float) -> float:
        wall = SoftWall(oscillator=single_mode_at(scene, frequency), hardness=math.exp(log_hardness))
        peak = wall.doubling_peak()
        return 1.0 if peak is None else math.log(wall.excess_of(peak) / letter.AMPLITUDE_STABILITY)

    def power(ratio: float) -> float | None:
        shifts = [
            attempt(partial(end_of, scan=False),
                    Case(scene=scene, frequency_hz=frequency, hardness=K, zeta=ratio)).shift
            for K in (HARD, HARDEST)
        ]  # fmt: skip
        return None if None in shifts else math.log(shifts[1] / shifts[0]) / math.log(HARDEST / HARD)

    low, high = math.log(1.0 + 1e-3), math.log(HARDEST)
    wall = SoftWall(oscillator=single_mode_at(scene, frequency), hardness=2.0)
    visible = math.exp(brentq(beyond, low, high, xtol=1e-6)) if beyond(high) < 0.0 else None
    return Limits(
        frequency_hz=frequency, least_hardness=wall.least_hardness, visible_below_hardness=visible,
        shortfall_times_hardness=wall.leading_shortfall, power_of_end_lossless=power(0.0),
        power_of_end_dashpot=power(zeta),
    )  # fmt: skip
