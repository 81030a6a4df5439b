"""Transients that end as soon as the orbit is known, not when it has been reached.

A motion that seems to repeat to a part in a thousand is compared with a periodic orbit in its neighbourhood,
found by shooting (``contact.orbits.shooting``) from the motion itself.  If that orbit is stable, touches
the stop only where it should (certified), and the motion has come closer to it over a whole block of drive
periods by what its largest multiplier says,

    distance(n + block) <= SLACK |mu|^(block/m) distance(n) + rounding,

the motion is in the linear neighbourhood of the orbit and ends on it: the rest of the transient need not be
computed.  The motion without impacts is settled when the free motion that is left, which can only shrink,
cannot reach the stop any more.  Near a fold, where |mu| comes close to 1, this saves thousands of periods.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.orbits.shooting import PeriodicOrbit, Shooting
from contact.stroboscope import StrobedOrbit, StroboscopicMap
from contact.trajectory import State
from studies.instruments.periodicity import TOLERANCE, Settled, period_of

__all__ = ["orbit_near", "settle_on_orbit"]

FIRST_LOOK = 1e-3
"""Repetition, relative to the gap, at which an orbit is looked for: a search costs some ten drive periods."""

SLACK = 1.5
"""Factor on the decay that the multiplier promises: the other multipliers and curvature need some room."""

NEAR = 1e-3
"""Distance from the orbit, relative to the gap, within which the linear neighbourhood is looked for."""


def orbit_near(strobed: StroboscopicMap, state: State, period: int, impacts: int) -> PeriodicOrbit | None:
    """The stable, admissible orbit next to `state`, by shooting; None if there is none."""
    try:
        family = Shooting(oscillator=strobed.oscillator, period=period, impacts=impacts)
        orbit = family.from_state(replace(state, time=0.0))
    except (ContactError, ValueError, TypeError):
        return None
    return orbit if orbit.stable and orbit.admissible else None


def _points_of(strobed: StroboscopicMap, orbit: PeriodicOrbit) -> StrobedOrbit[State]:
    """One period of strobed points of an orbit."""
    return strobed.orbit(replace(orbit.strobe_state(), time=0.0), orbit.period)


def _distance(points: np.ndarray, cycle: np.ndarray) -> tuple[float, int]:
    """Largest distance of the last points from a cycle, in its best phase, and that phase."""
    m = len(cycle)
    last = points[-m:]
    gaps = [float(np.max(np.abs(last - np.roll(cycle, -k, axis=0)))) for k in range(m)]
    best = int(np.argmin(gaps))
    return gaps[best], best


def _free_for_good(strobed: StroboscopicMap, state: State) -> bool:
    """Whether the free motion left over in `state` can never bring the tip to the stop."""
    model, steady = strobed.oscillator.model, strobed.steady()
    if np.any(model.omega <= 0):
        return False
    u, v = state.displacement - steady.displacement, state.velocity - steady.velocity
    left = float(np.sum(np.abs(model.phi) * np.hypot(u, v / model.omega)))
    reach = abs(strobed.oscillator.tip_response()) * strobed.oscillator.drive.amplitude  # type: ignore[union-attr]
    return reach + left < strobed.oscillator.stop.gap * (1.0 - 1e-12)


def settle_on_orbit(
    strobed: Any,
    state: State,
    *,
    most_cycles: int,
    largest_period: int = 64,
    tolerance: float = TOLERANCE,
) -> Settled[State]:
    """Follow a motion until the orbit on which it ends is proved, or for `most_cycles` drive periods.

    Parameters and result are those of ``periodicity.settle``; `strobed` is a StroboscopicMap.  The end state
    and the points lie on the orbit itself.
    """
    block = 2 * largest_period
    cycles, known, before = 0, None, np.inf
    while True:
        run = strobed.orbit(state, block)
        state, cycles = run.end, cycles + block
        exact = period_of(
            run.points, run.impacts, largest_period=largest_period, tolerance=tolerance * strobed.scale
        )
        rough = exact or period_of(
            run.points, run.impacts, largest_period=largest_period, tolerance=FIRST_LOOK * strobed.scale
        )
        hits = int(run.impacts[-rough:].sum()) if rough else int(run.impacts.sum())
        if exact or cycles >= most_cycles:
            return Settled(period=exact, impacts=hits, end=state, cycles=cycles, points=run.points)
        if rough and hits == 0:
            if _free_for_good(strobed, state):
                end = strobed.steady()
                end = State(displacement=end.displacement, velocity=end.velocity, time=state.time)
                still = strobed.orbit(end, block)
                return Settled(period=1, impacts=0, end=still.end, cycles=cycles, points=still.points)
            known = None
            continue
        if not rough or rough > largest_period // 2:
            known, before = None, np.inf
            continue
        if known is None or (known.period, known.impacts) != (rough, hits):
            known, before = orbit_near(strobed, state, rough, hits), np.inf
        if known is None:
            continue
        cycle = _points_of(strobed, known).points
        distance, phase = _distance(run.points, cycle)
        promised = SLACK * abs(known.multipliers[0]) ** (block / known.period) * before
        if before < NEAR * strobed.scale and distance <= promised + TOLERANCE * strobed.scale:
            # go on from the orbit itself, in the phase in which the motion is
            on_orbit = strobed.orbit(_points_of(strobed, known).end, _steps_to(phase, known.period)).end
            final = strobed.orbit(replace(on_orbit, time=state.time), block)
            return Settled(
                period=known.period, impacts=known.impacts, end=final.end, cycles=cycles, points=final.points
            )
        before = distance


def _steps_to(phase: int, period: int) -> int:
    """Strobes from the end of a cycle to the point that follows it in the given phase."""
    return phase % period or period
