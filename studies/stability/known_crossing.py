r"""A crossing of known depth, at any phase of the looks that a method takes.

Undamped modes swing freely and are all at their peak at t = 0, where the tip is at gap (1 + delta):

    x(t) = gap (1 + delta) sum_k b_k cos(omega_k t),   sum b_k = 1,   a = sum b_k omega_k^2 gap

so that it is beyond the stop for about 2 sqrt(2 delta gap/a) around t = 0 and, for a small delta, at no other
time of the run. Runs start at lead times (multiples of the golden ratio) that put the peak at every phase of
the method's looks, h apart; it sees the crossing with probability (duration)/h:

    share missed = max(0, 1 - 2 sqrt(2 delta gap/a)/h),   one half at   delta = a h^2/(32 gap);            (a)

where the spacing varies, the mean of that over the spacings around the peak. With delta < 0 the tip stays
away, and any touch is invented. A method by percussions (``contact.integrators.moreau_jean``) strikes in the
step from a grid point if d + (h/2) U >= 0 and U* + e U > 0 there. On the parabola, s steps before the peak,
these are delta gap >= (a h^2/2) s (s - 1) and s > 1/(1 + e); so, with x (1 + x) = 2 delta gap/(a h^2),

    share missed = max(0, 1/(1 + e) - x),                                                                  (b)
    touches invented down to   delta = -(a h^2/(2 gap)) e/(1 + e)^2.                                       (c)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from beam import ModalModel
from contact import (
    ContactLaw,
    HertzContact,
    ImpactOscillator,
    LinearContact,
    NewtonRestitution,
    State,
    Stop,
)
from contact.integrators import Integrator

__all__ = ["RESTITUTION", "Swing", "Touch", "half_missed", "invented_by_percussions", "share_missed"]

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
RESTITUTION = 0.5
Touch = Callable[[float, float], float]
"""touch(overshoot, lead) -> time of the first touch from the peak, NaN if there is none [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swing:
    """Modes that peak together, `lead` to `lead + spread` after a run starts, `tail` before it ends [s]."""

    omega: np.ndarray
    phi: np.ndarray
    height: np.ndarray
    """omega_k [rad/s], tip displacements [kg^-0.5] and parts b_k of the peak, above zero, sum 1 [1]."""
    gap: float
    lead: float
    spread: float
    tail: float

    @property
    def pace(self) -> float:
        """sqrt(a/gap) [1/s]."""
        return math.sqrt(float(self.height @ self.omega**2))

    def leads(self, count: int) -> np.ndarray:
        """Lead times that put the peak at every phase [s]."""
        return self.lead + self.spread * ((np.arange(count) + 0.5) * GOLDEN % 1.0)

    def start(self, overshoot: float, lead: float) -> State:
        """The state `lead` before the peak."""
        size = self.gap * (1.0 + overshoot) * self.height / self.phi
        turn = self.omega * lead
        return State(displacement=size * np.cos(turn), velocity=size * self.omega * np.sin(turn))

    def height_at(self, overshoot: float, time: np.ndarray) -> np.ndarray:
        """Tip displacement over gap, minus 1, at times from the peak [1]; accurate for small overshoots."""
        phase = np.multiply.outer(time, self.omega)
        return overshoot - (1.0 + overshoot) * (2.0 * np.sin(0.5 * phase) ** 2) @ self.height

    def oscillator(self, method: Integrator) -> ImpactOscillator:
        """The modes before a stop with a law that `method` knows, soft enough for any step."""
        soft = 0.01 * float((self.omega[0] / self.phi[0]) ** 2)
        laws: tuple[ContactLaw, ...] = (
            LinearContact(stiffness=soft), NewtonRestitution(local_restitution=RESTITUTION),
            HertzContact(stiffness=soft / math.sqrt(self.gap)),
        )  # fmt: skip
        law = next(law for law in laws if method.accepts(law.code))
        none = np.zeros_like(self.omega)
        model = ModalModel(omega=self.omega, decay_rate=none, phi=self.phi, participation=none)
        return ImpactOscillator(model=model, stop=Stop(gap=self.gap, law=law))

    def share_wrong(self, touch: Touch, overshoot: float, *, runs: int, slack: float) -> float:
        """Share of the runs that miss the crossing, or invent one if the overshoot is negative [1].

        A first touch is the crossing if the tip is beyond the stop within `slack` [s] of it.
        """
        wrong = 0
        for lead in self.leads(runs):
            at = touch(overshoot, float(lead))
            near = at + slack * np.linspace(-1.0, 1.0, 401)
            if abs(at) <= slack:
                near = np.append(near, 0.0)
            seen = overshoot < 0.0 or bool(np.any(self.height_at(overshoot, near) > 0.0))
            wrong += (math.isfinite(at) and seen) == (overshoot < 0.0)
        return wrong / runs


def share_missed(
    overshoot: np.ndarray, spacings: np.ndarray, pace: float, percussions: bool = False
) -> np.ndarray:
    """Share of crossings missed, (a) or (b), for overshoots over gap [1]."""
    if percussions:
        x = 0.5 * (np.sqrt(1.0 + 8.0 * overshoot / (pace * spacings[0]) ** 2) - 1.0)
        return np.maximum(0.0, 1.0 / (1.0 + RESTITUTION) - x)
    duration = 2.0 * np.sqrt(2.0 * overshoot) / pace
    return np.maximum(0.0, 1.0 - np.multiply.outer(1.0 / spacings, duration)).mean(axis=0)


def half_missed(spacings: np.ndarray, pace: float, percussions: bool = False) -> float:
    """Overshoot over gap at which half the crossings are missed, (a) or (b) [1]."""
    most = float((pace * spacings.max()) ** 2 / 8.0)

    def excess(depth: float) -> float:
        return float(share_missed(np.array(depth), spacings, pace, percussions)) - 0.5

    return float(brentq(excess, 0.0, most, xtol=1e-18))


def invented_by_percussions(step: float, pace: float) -> float:
    """Undershoot over gap down to which touches are invented, (c) [1]."""
    return 0.5 * (pace * step) ** 2 * RESTITUTION / (1.0 + RESTITUTION) ** 2
