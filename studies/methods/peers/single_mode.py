"""Eq. (1) of the letter in heyoka, for what only its own interface can do: callbacks, variational equations.

    x'' + c x' + ((2 pi/T)^2 + c^2/4) x = Z w^2 sin w t,   w = 2 pi f,   a touch where x rises through the gap

The parameters at run time are, in this order, T, c, f, Z and the gap.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contact import ImpactOscillator
from studies.physics.parameters import parameters_of

NAMES = ("free_period", "decay_rate", "frequency", "amplitude", "gap")
"""As in ``studies.physics.parameters``."""


def equation_1() -> tuple[list[Any], list[Any], Any]:
    """Variables, system, and what rises through zero at a touch."""
    import heyoka as hy

    variables = x, v = hy.make_vars("x", "v")
    period, decay, frequency, amplitude, gap = (hy.par[i] for i in range(len(NAMES)))
    w = 2.0 * np.pi * frequency
    pull = decay * v + ((2.0 * np.pi / period) ** 2.0 + (0.5 * decay) ** 2.0) * x
    return [*variables], [(x, v), (v, amplitude * w * w * hy.sin(w * hy.time) - pull)], x - gap


def heyoka_orbit(oscillator: ImpactOscillator) -> tuple[Callable[[int], None], Any]:
    """An orbit of Eq. (1) from rest by heyoka alone, and its integrator.

    The impact is the callback of an event, as heyoka's documentation recommends; the tolerance is its
    default, the rounding of a double.
    """
    import heyoka as hy

    _, system, surface = equation_1()

    def impact(taylor: Any, _sign: int) -> bool:
        taylor.state[1] *= -oscillator.stop.law.numbers[0]
        return True

    touch = hy.t_event(surface, direction=hy.event_direction.positive, callback=impact)
    taylor, known = hy.taylor_adaptive(system, np.zeros(2), t_events=[touch]), parameters_of(oscillator)
    taylor.pars[:] = [known[name].value for name in NAMES]

    def orbit(periods: int) -> None:
        taylor.propagate_until(taylor.time + periods * oscillator.period)

    return orbit, taylor
