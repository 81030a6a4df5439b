"""The island of p3 and chaos of Eq. (1) below grazing.

It begins at the fold of p3 with one impact (closed form) and is followed upwards, the state carried along,
until the motion is free of impacts: its other end.  The motion without impacts is stable all along, so that
the island is not connected to what is born at grazing.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.orbits.scan import OrbitDiagram
from contact.orbits.settling import settle
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from studies.instruments.breakdown.beam_of_fig_5 import CHAOS_AT, FREQUENCY_HZ
from studies.instruments.breakdown.scans import HIGHEST
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene
from studies.published import STROBE_POINTS

__all__ = ["ISLAND_CYCLES", "ISLAND_STEP", "island"]

ISLAND_STEP, ISLAND_CYCLES = 5e-4, 1500
"""Step of the excess and drive periods at each, for the end of the island; beyond it chaos is a transient."""


def island(
    scene: Scene, restitution: float, *, step: float = ISLAND_STEP
) -> tuple[dict[str, Any], OrbitDiagram[Any]]:
    """The p3 of Eq. (1) and what it turns into, followed upwards from its fold until the motion is free."""
    scene = scene.replace({"single_mode.restitution": restitution})
    oscillator = single_mode_oscillator(scene, FREQUENCY_HZ)
    strobed = StroboscopicMap(oscillator=oscillator)
    fold = MaximalFamily.from_oscillator(oscillator, period=3).fold()
    assert fold is not None  # theta lies in the band of p3
    family = Shooting(oscillator=oscillator, period=3)
    orbit = family.at_speed(1.02 * fold.speed)
    values = np.arange(orbit.excess, HIGHEST, step)
    state, used = orbit.strobe_state(), values.size
    period = np.zeros(values.size, dtype=np.int64)
    impacts, points = np.zeros(values.size, dtype=np.int64), np.full((values.size, STROBE_POINTS), np.nan)
    for i, excess in enumerate(values):
        here = strobed.at(float(excess))
        settled = settle(here, state, most_cycles=ISLAND_CYCLES)
        if settled.impacts == 0:
            used = i
            break
        recorded = here.orbit(settled.end, STROBE_POINTS)
        state, points[i] = recorded.end, strobed.tip(recorded.points)
        period[i], impacts[i] = settled.period, settled.impacts
    last = float(values[used - 1])
    around = np.flatnonzero(np.abs(values[:used] - CHAOS_AT) <= step)
    found = {
        "restitution": restitution,
        "fold_p3": fold.excess,
        "end": last,
        "alive_at_letters_chaos": last >= CHAOS_AT,
        "period_at_letters_chaos": int(period[around[0]]) if around.size else None,
    }
    kept = slice(0, used)
    return found, OrbitDiagram(
        excess=values[kept],
        points=points[kept],
        period=period[kept],
        impacts=impacts[kept],
        cycles=np.zeros(used, dtype=np.int64),
        failures=(),
        end=state,
    )
