"""Eq. (1) in heyoka, as one who knows it would write it: no wrapper, the impact in the callback of an event.

    x'' + mu x' + Omega^2 x = F sin(w t),   at x = gap, rising:  x' -> -tau x'

At its default tolerance (the rounding of a double), one orbit or several in a batch.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contact.oscillator import ImpactOscillator

__all__ = ["Orbit", "batch_of", "orbit_of"]

Orbit = Callable[[int], None]
"""orbit(periods): carries the motion on by that many drive periods."""


def _equations(oscillator: ImpactOscillator, hy: Any) -> tuple[list[Any], Any]:
    """The equations with the amplitude of the push as parameter, and what is watched."""
    model, drive = oscillator.model, oscillator.drive
    assert drive is not None
    x, v = hy.make_vars("x", "v")
    push = hy.par[0] * hy.sin(drive.angular_frequency * hy.time)
    system = [(x, v), (v, push - model.decay_rate[0] * v - model.omega[0] ** 2 * x)]
    return system, x - oscillator.stop.gap / model.phi[0]


def _push(oscillator: ImpactOscillator) -> float:
    drive = oscillator.drive
    assert drive is not None
    return float(oscillator.model.participation[0] * drive.amplitude * drive.angular_frequency**2)


def orbit_of(oscillator: ImpactOscillator) -> Orbit:
    """One orbit from rest."""
    import heyoka as hy

    system, depth = _equations(oscillator, hy)
    restitution, period = oscillator.stop.law.numbers[0], oscillator.period

    def impact(taylor: Any, _sign: int) -> bool:
        taylor.state[1] *= -restitution
        return True

    touch = hy.t_event(depth, direction=hy.event_direction.positive, callback=impact)
    taylor = hy.taylor_adaptive(system, [0.0, 0.0], t_events=[touch])
    taylor.pars[0] = _push(oscillator)

    def orbit(periods: int) -> None:
        taylor.propagate_until(taylor.time + periods * period)

    return orbit


def batch_of(oscillators: Sequence[ImpactOscillator]) -> Orbit:
    """As many orbits side by side as there are oscillators, which differ in the drive amplitude alone."""
    import heyoka as hy

    system, depth = _equations(oscillators[0], hy)
    restitution, period = oscillators[0].stop.law.numbers[0], oscillators[0].period

    def impact(taylor: Any, _sign: int, lane: int) -> bool:
        taylor.state[1, lane] *= -restitution
        return True

    touch = hy.t_event_batch(depth, direction=hy.event_direction.positive, callback=impact)
    taylor = hy.taylor_adaptive_batch(system, np.zeros((2, len(oscillators))), t_events=[touch])
    taylor.pars[0] = [_push(oscillator) for oscillator in oscillators]

    def orbit(periods: int) -> None:
        taylor.propagate_until([float(t) + periods * period for t in taylor.time])

    return orbit
