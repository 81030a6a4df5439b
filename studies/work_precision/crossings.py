r"""Crossings of the stop of known depth, to see which a method misses.

For each overshoot h = 1e-2 ... 1e-8 of the gap, runs start a little before a peak of the tip at gap (1 + h),
and end as much after it. Half of the peaks are those of the steady motion, driven at F/F_g - 1 = h; on the
other half a mode j >= 2 rings as well:

    steady motion at F/F_g - 1 = -a,  u_j(t) = (a + h) gap/phi_j  at rest at the steady peak,

followed backwards by the exponential of its 2 x 2 system. Both parts have their crest at one instant; before
and after it the ringing repeats lower than the steady motion has sunk, so that the tip is over the stop once,
for

    2 sqrt(2 h gap / |x''|),   x'' = -(w^2 (1 - a) + omega_j^2 (a + h)) gap.

One mode alone has only steady peaks. Starts are shifted by golden fractions of the lead, so that no grid is
favoured, and are the same in every run of the study. Without drive there are none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from contact import ContactError, ImpactOscillator, State, simulate
from contact.integrators import Integrator
from studies.work_precision.problems import steady_at

__all__ = ["OVERSHOOTS", "KnownCrossing", "known_crossings", "missed_share"]

OVERSHOOTS = tuple(10.0**-p for p in range(2, 9))
"""Of the gap; the grazing of the package's own exact methods begins at 1e-13."""

PHASES = 4
"""Starts for each overshoot."""

RINGING = 2e-3
"""a: a mode rings with two thousandths of the gap, as mode 2 does between collisions of the scene's beam."""

LEAD = 1.0 / 8.0
"""Longest time from a start to its crossing, in drive periods, give or take half the crossing's width."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownCrossing:
    """One crossing: oscillator at its amplitude, start, length of the run [s], overshoot over gap [1]."""

    oscillator: ImpactOscillator
    start: State
    length: float
    overshoot: float


def known_crossings(oscillator: ImpactOscillator) -> list[KnownCrossing]:
    """All crossings for a driven oscillator, in a fixed order."""
    found: list[KnownCrossing] = []
    if oscillator.drive is None:
        return found
    model, gap, period = oscillator.model, oscillator.stop.gap, oscillator.period
    w, rings = (
        oscillator.drive.angular_frequency,
        [j for j in range(1, min(4, oscillator.n_modes)) if model.phi[j]],
    )
    for overshoot in OVERSHOOTS:
        for phase in range(PHASES):
            width = math.sqrt(2.0 * overshoot) / w  # half of it, at most
            lead = 1.5 * width + LEAD * period * (0.25 + 0.75 * math.fmod(GOLDEN * (len(found) + 1), 1.0))
            ringing = rings[phase % len(rings)] if rings and phase % 2 else None
            driven = oscillator.with_excess(overshoot if ringing is None else -RINGING)
            before = steady_at(driven, -w * lead)
            q, v = before.displacement.copy(), before.velocity.copy()
            if ringing is not None:
                system = np.array([[0.0, 1.0], [-(model.omega[ringing] ** 2), -model.decay_rate[ringing]]])
                u, rate = expm(-lead * system) @ [(RINGING + overshoot) * gap / model.phi[ringing], 0.0]
                q[ringing] += u
                v[ringing] += rate
            start = State(displacement=q, velocity=v, time=before.time)
            found.append(
                KnownCrossing(oscillator=driven, start=start, length=2.0 * lead, overshoot=overshoot)
            )
    return found


def missed_share(method: Integrator, crossings: Sequence[KnownCrossing]) -> tuple[float | None, float | None]:
    """Share of the crossings without an impact, and the largest overshoot missed.

    None for both where there are no crossings; a run that fails counts as missed, since it has found none.
    """
    missed = []
    for crossing in crossings:
        try:
            run = simulate(crossing.oscillator, crossing.start, duration=crossing.length, method=method)
            seen = bool(np.any(run.impacts.kind == 0))
        except ContactError:
            seen = False
        if not seen:
            missed.append(crossing.overshoot)
    return (len(missed) / len(crossings), max(missed, default=0.0)) if crossings else (None, None)
