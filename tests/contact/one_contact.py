"""Laws and one contact under each, integrated independently."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from oscillators import FREQUENCY
from scipy.integrate import solve_ivp

from contact.laws import (
    HertzContact,
    HuntCrossley,
    LinearContact,
)
from contact.oscillator import ImpactOscillator

PERIOD = 1 / FREQUENCY
FREE, IN_CONTACT, WAITING = 0, 1, 4

HERTZ = HertzContact(stiffness=3e7)
SOFTER = HertzContact(stiffness=1e6)
LOSSY = HuntCrossley(stiffness=3e7, dissipation=1.2)
SPRING = LinearContact(stiffness=3e5)
DASHPOT = LinearContact(stiffness=3e5, damping=15.0)


@dataclass
class Contact:
    """One contact, integrated."""

    end: float
    displacement: np.ndarray
    velocity: np.ndarray
    loss: float
    samples: np.ndarray


def integrate_contact(
    oscillator: ImpactOscillator,
    start: float,
    displacement: np.ndarray,
    velocity: np.ndarray,
    times: np.ndarray,
) -> Contact:
    """The modal equations under the law's force by DOP853, from a touch to the release."""
    model, law, gap = oscillator.model, oscillator.stop.law, oscillator.stop.gap
    n = model.omega.size
    load = np.zeros(n) if oscillator.load is None else oscillator.load
    w = oscillator.drive.angular_frequency if oscillator.drive else 0.0
    push = model.participation * (oscillator.drive.amplitude if oscillator.drive else 0.0) * w**2

    def force(y):
        d, rate = model.phi @ y[:n] - gap, model.phi @ y[n : 2 * n]
        if isinstance(law, LinearContact):
            return max(0.0, law.stiffness * d + law.damping * rate)
        chi = law.dissipation if isinstance(law, HuntCrossley) else 0.0
        return law.stiffness * max(d, 0.0) ** 1.5 * (1 + chi * rate)

    def right(t, y):
        pushed = force(y)
        free = load + push * math.sin(w * t) - model.decay_rate * y[n : 2 * n] - model.omega**2 * y[:n]
        return np.concatenate(
            [y[n : 2 * n], free - model.phi * pushed, [pushed * (model.phi @ y[n : 2 * n])]]
        )

    def height(t, y):
        return model.phi @ y[:n] - gap

    height.terminal, height.direction = True, -1
    y = np.concatenate([displacement, velocity, [0.0]])
    settings = dict(method="DOP853", rtol=1e-13, atol=1e-19, dense_output=True)
    # d^(3/2) has no third derivative at the touch: a short first stretch keeps its order out of the rest
    first = solve_ivp(right, (start, start + 1e-7), y, max_step=5e-9, **settings)
    rest = solve_ivp(
        right, (start + 1e-7, start + 0.1), first.y[:, -1], max_step=1e-5, events=height, **settings
    )
    assert rest.status == 1, "it was never let go"
    at = np.array([(first if t < first.t[-1] else rest).sol(t)[: 2 * n] for t in times]).reshape(-1, 2 * n)
    return Contact(rest.t[-1], rest.y[:n, -1], rest.y[n : 2 * n, -1], rest.y[-1, -1], at)


def name_of(value: object) -> str:
    """A test's name for a parameter: its text without addresses, which differ between processes."""
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:80]


FORCES = [HERTZ, SOFTER, LOSSY, SPRING]
"""Laws that let go at the wall only: the integration above ends at the first fall through it."""
