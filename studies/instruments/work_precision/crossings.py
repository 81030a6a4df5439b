r"""Planted shallow crossings of the stop, to see which a method misses.

For each overshoot h = 1e-2 ... 1e-8 of the gap, runs start a little before a peak of the tip at gap (1 + h),
and end as much after it.  Half of the peaks are those of the steady motion, driven at F/F_g - 1 = h; on the
other half a mode j >= 2 rings as well:

    steady motion at F/F_g - 1 = -a,  u_j(t) = (a + h) gap/phi_j  at rest at the steady peak,

followed backwards in closed form to the start.  Both parts have their crest at one instant; before and after
it the ringing repeats lower than the steady motion has sunk, so that the tip is over the stop once, for

    2 sqrt(2 h gap / |x''|),   x'' = -(w^2 (1 - a) + omega_j^2 (a + h)) gap.

One mode alone has only steady peaks.  Starts are shifted by golden fractions of the lead, so that no grid is
favoured, and are the same in every run of the study.  Without drive nothing is planted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.errors import ContactError
from contact.flight.modal_flow import propagate, steady_motion
from contact.integrators import Integrator
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import ImpactKind, State

__all__ = ["Plant", "missed_share", "plants"]

OVERSHOOTS = tuple(10.0**-p for p in range(2, 9))
"""Of the gap; the grazing of the package's own exact methods begins at 1e-13."""

PHASES = 4
"""Starts for each overshoot."""

RINGING = 2e-3
"""a: mode 2 rings with two thousandths of the gap, as it does between collisions of the scene's beam."""

LEAD = 1.0 / 8.0
"""Longest time from a start to its crossing, in drive periods, give or take half the crossing's width."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Plant:
    """One crossing: oscillator at its amplitude, start, length of the run [s], overshoot [1]."""

    oscillator: ImpactOscillator
    start: State
    length: float
    overshoot: float


def plants(oscillator: ImpactOscillator) -> list[Plant]:
    """All planted crossings of a driven oscillator, in a fixed order."""
    found: list[Plant] = []
    if oscillator.drive is None:
        return found
    model, gap, period = oscillator.model, oscillator.stop.gap, oscillator.period
    rings = [j for j in range(1, min(4, oscillator.n_modes)) if model.phi[j] != 0.0]
    for overshoot in OVERSHOOTS:
        for phase in range(PHASES):
            width = math.sqrt(2.0 * overshoot) / oscillator.drive.angular_frequency  # half of it, at most
            lead = 1.5 * width + LEAD * period * (0.25 + 0.75 * math.fmod(GOLDEN * (len(found) + 1), 1.0))
            ringing = rings[phase % len(rings)] if rings and phase % 2 else None
            driven = oscillator.with_excess(overshoot if ringing is None else -RINGING)
            motion = driven.motion()
            crest = math.atan2(motion.tip_sine, motion.tip_cosine) % (2.0 * math.pi) / motion.drive
            time = crest - lead if crest > lead else crest + period - lead
            q, v = steady_motion(motion, np.array([time]))
            u, rate = np.zeros(model.omega.size), np.zeros(model.omega.size)
            if ringing is not None:
                u[ringing] = (RINGING + overshoot) * gap / model.phi[ringing]
            propagate(motion, u, rate, -lead, u, rate)
            start = State(displacement=q[0] + u, velocity=v[0] + rate, time=time)
            found.append(Plant(oscillator=driven, start=start, length=2.0 * lead, overshoot=overshoot))
    return found


def missed_share(method: Integrator, planted: list[Plant]) -> tuple[float | None, float | None]:
    """Share of the planted crossings without an impact, and the largest overshoot missed.

    None for both where there are no plants; a run that fails counts as missed, since it has not found one.
    """
    if not planted:
        return None, None
    missed = []
    for plant in planted:
        try:
            run = simulate(plant.oscillator, plant.start, duration=plant.length, method=method)
            found = bool(np.any(run.impacts.kind == ImpactKind.IMPACT))
        except ContactError:
            found = False
        if not found:
            missed.append(plant.overshoot)
    return len(missed) / len(planted), max(missed, default=0.0)
