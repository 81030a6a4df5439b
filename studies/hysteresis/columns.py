"""One period m over the drive frequencies: the folds of p_m, and downward scans that confirm them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from beam import ModalModel
from contact import ContactError, State, StroboscopicMap, band
from contact.orbits import PeriodicOrbit, Shooting, orbit_end
from studies.hysteresis.descriptions import Row, folds_at
from studies.scene import Scene, corresponding, periods_of

FREQUENCIES_HZ = (19.6, 23.8)
"""Of the letter's spring; others at the same f T."""

BELOW_BAND = 0.5
"""How far below its band in the map a period is looked for, in widths of the band: there it coexists."""


def column(
    scene: Scene, model: ModalModel, step: float, confirmed: Sequence[float], period: int
) -> list[Row]:
    """The folds of p_m over the frequencies where it can exist, each started from its neighbour; at the
    frequencies `confirmed` where the letter saw p_m a downward scan ends it as well."""
    keys, seen = scene.single_mode, periods_of(scene)
    edges = band(period, free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s,
                 restitution=keys.restitution)  # fmt: skip
    low = corresponding(scene, FREQUENCIES_HZ[0])
    low = max(low, edges.lower - BELOW_BAND * (edges.upper - edges.lower))
    grid = np.arange(FREQUENCIES_HZ[0], FREQUENCIES_HZ[1] + 1e-9, step)
    values = {round(corresponding(scene, float(f)), 6) for f in grid}
    values |= {f for f, m in seen.items() if m == period}
    rows, near = list[Row](), None
    for frequency in sorted((f for f in values if low <= f < edges.upper), reverse=True):
        row, near = folds_at(scene, frequency, period, model, near)
        if near is not None and frequency in confirmed and seen[frequency] == period:
            row = replace(row, beam_scan=scanned_end(near))
        rows.append(row)
    return rows[::-1]


def scanned_end(fold: PeriodicOrbit) -> float | None:
    """The end of the beam's orbit in a downward scan of its motion, from the stable orbit above the fold: the
    middle of a bracket of 0.1 %."""
    start = 0.9 * fold.excess
    try:
        state = stable_state(fold, start)
        end = orbit_end(
            StroboscopicMap(oscillator=fold.oscillator), state, start, most_cycles=20_000, relative=1e-3,
            absolute=1e-8, first_step=0.02 * abs(fold.excess),
        )  # fmt: skip
    except ContactError:
        return None
    return None if end is None or end.period != fold.period else 0.5 * (end.held + end.lost)


def stable_state(fold: PeriodicOrbit, excess: float) -> State:
    """A strobe state on the stable orbit at `excess`: the arm of the faster touch."""
    orbit = fold
    family = Shooting(oscillator=orbit.oscillator, period=orbit.period, impacts=orbit.impacts)
    while orbit.excess < excess:  # ends: the excess rises without bound with the speed
        orbit = family.at_speed(1.1 * orbit.speed, orbit)
    return family.at_excess(excess, orbit).strobe_state()
