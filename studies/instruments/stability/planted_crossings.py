"""A flight with one crossing of known depth, at any phase of the looks that a method takes.

Undamped modes swing freely and are all at their peak at t = 0, where the tip is at gap (1 + delta):

    x(t) = gap (1 + delta) sum_k b_k cos(omega_k t),   sum b_k = 1,   a = sum b_k omega_k^2 gap

so that it is beyond the stop for about 2 sqrt(2 delta gap / a) around t = 0 and, for a small delta, at no
other time of the run.  The run starts a lead time before the peak; leads that fill an interval much longer
than the spacing of the looks evenly (multiples of the golden ratio) put the peak at every phase between two
of them.  A method that looks only every h sees the crossing with probability (duration)/h:

    share missed = max(0, 1 - 2 sqrt(2 delta gap / a) / h),   one half at   delta = a h^2 / (32 gap).      (a)

and where the spacing differs from flight to flight, the mean of that over the spacings around the peak.  With
delta < 0 the tip stays away from the stop, and any touch is invented.  The modes have no damping, no
drive: what is tried is the detection alone.  Units: SI.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from beam import ModalModel
from contact.errors import ContactError
from contact.integrators import Integrator
from contact.laws import HERTZ, LINEAR, NEWTON, ContactLaw, HertzContact, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State

__all__ = [
    "Swing",
    "Verdict",
    "half_missed",
    "half_missed_by_percussions",
    "invented_by_percussions",
    "share_missed",
    "share_missed_by_percussions",
    "spacings_of",
]

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


RESTITUTION = 0.5


def share_missed(overshoot: float | np.ndarray, spacings: np.ndarray, pace: float) -> np.ndarray:
    """Share of crossings missed, (a), for overshoots over gap, with pace = sqrt(a/gap) [1/s]."""
    duration = 2.0 * np.sqrt(2.0 * np.asarray(overshoot, dtype=float)) / pace
    return np.maximum(0.0, 1.0 - np.multiply.outer(1.0 / spacings, duration)).mean(axis=0)


def half_missed(spacings: np.ndarray, pace: float) -> float:
    """Overshoot over gap at which half the crossings are missed, (a)."""
    most = float((pace * spacings.max()) ** 2 / 8.0)
    return float(brentq(lambda d: float(share_missed(d, spacings, pace)) - 0.5, 0.0, most, xtol=1e-18))


def share_missed_by_percussions(overshoot: float | np.ndarray, step: float, pace: float) -> np.ndarray:
    """Share of crossings missed, (b)."""
    x = 0.5 * (np.sqrt(1.0 + 8.0 * np.asarray(overshoot, dtype=float) / (pace * step) ** 2) - 1.0)
    return np.maximum(0.0, 1.0 / (1.0 + RESTITUTION) - x)


def half_missed_by_percussions(step: float, pace: float) -> float:
    """Overshoot over gap at which half the crossings are missed, (b)."""
    x = 1.0 / (1.0 + RESTITUTION) - 0.5
    return 0.5 * (pace * step) ** 2 * x * (1.0 + x)


def invented_by_percussions(step: float, pace: float) -> float:
    """Undershoot over gap down to which touches are invented, (c)."""
    return 0.5 * (pace * step) ** 2 * RESTITUTION / (1.0 + RESTITUTION) ** 2


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Out of `runs`: how many missed the crossing (or, below the gap, invented one) and how many failed."""

    runs: int
    wrong: int
    failed: int

    @property
    def share(self) -> float:
        """Part of the runs that ended without an error and are wrong; NaN if none ended [1]."""
        ended = self.runs - self.failed
        return self.wrong / ended if ended else math.nan


@dataclass(frozen=True, kw_only=True, eq=False)
class Swing:
    """Modes that peak together.

    Parameters
    ----------
    omega : ndarray, shape (n_modes,)
        Frequencies [rad/s].
    phi : ndarray, shape (n_modes,)
        Tip displacements of the modes [kg^-0.5].
    height : ndarray, shape (n_modes,)
        Parts b_k of the peak, above zero, sum 1 [1].
    gap : float
        [m]
    lead, spread, tail : float
        The run starts `lead` to `lead` + `spread` before the peak and ends `tail` behind it [s].
    """

    omega: np.ndarray
    phi: np.ndarray
    height: np.ndarray
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

    def oscillator(self, method: Integrator) -> ImpactOscillator:
        """The modes before a stop with a law that `method` knows, soft enough for any step."""
        soft = 0.01 * float((self.omega[0] / self.phi[0]) ** 2)
        laws: dict[int, ContactLaw] = {
            LINEAR: LinearContact(stiffness=soft),
            NEWTON: NewtonRestitution(local_restitution=RESTITUTION),
            HERTZ: HertzContact(stiffness=soft / math.sqrt(self.gap)),
        }
        law = next(laws[code] for code in laws if code in method.laws)
        none = np.zeros_like(self.omega)
        model = ModalModel(omega=self.omega, decay_rate=none, phi=self.phi, participation=none)
        return ImpactOscillator(model=model, stop=Stop(gap=self.gap, law=law))

    def start(self, overshoot: float, lead: float) -> State:
        """The state `lead` before the peak, at time 0."""
        size = self.gap * (1.0 + overshoot) * self.height / self.phi
        turn = self.omega * lead
        return State(displacement=size * np.cos(turn), velocity=size * self.omega * np.sin(turn))

    def height_at(self, overshoot: float, time: float | np.ndarray) -> np.ndarray:
        """Tip displacement over gap, minus 1, at a `time` from the peak [1]."""
        phase = np.multiply.outer(np.asarray(time, dtype=float), self.omega)
        # 1 - cos as a square keeps the digits of small overshoots
        return overshoot - (1.0 + overshoot) * (2.0 * np.sin(0.5 * phase) ** 2) @ self.height

    def first_crossing(self, overshoot: float) -> tuple[float, float]:
        """When the tip first goes beyond the stop and when it is back, from the peak [s]."""
        width = math.sqrt(2.0 * overshoot) / self.pace

        def depth(time: float) -> float:
            return float(self.height_at(overshoot, time))

        fine = np.arange(-self.lead, 0.0, 0.02 / float(self.omega.max()))
        above = np.flatnonzero(self.height_at(overshoot, fine) > 0.0)
        inside = float(fine[above[0]]) if above.size else 0.0
        step = min(width, 0.1 / float(self.omega.max()))
        ends = []
        for way in (-1.0, 1.0):
            near = inside
            while depth(near + way * step) > 0.0:
                near += way * step
            ends.append(float(brentq(depth, near, near + way * step, xtol=1e-18, rtol=1e-14)))
        return ends[0], ends[1]

    def verdict(self, method: Integrator, overshoot: float, *, runs: int, slack: float) -> Verdict:
        """How often `method` misses the first crossing, or invents one if the overshoot is negative.

        A touch counts as the crossing if it begins within `slack` [s] of it.
        """
        oscillator = self.oscillator(method)
        first, last = self.first_crossing(overshoot) if overshoot > 0.0 else (-math.inf, math.inf)
        wrong = failed = 0
        for lead in self.leads(runs):
            try:
                run = simulate(
                    oscillator, self.start(overshoot, lead), duration=lead + self.tail, method=method
                )
            except ContactError:
                failed += 1
                continue
            touches = run.impacts.start[run.impacts.kind == 0] - lead
            seen = bool(touches.size and first - slack <= touches[0] <= last + slack)
            wrong += seen if overshoot < 0.0 else not seen
        return Verdict(runs=runs, wrong=wrong, failed=failed)


def spacings_of(looks: list[float], swing: Swing, fly: Callable[[float], object], count: int) -> np.ndarray:
    """Spacing of the two looks of a solver between which the peak lies, in each of `count` flights [s].

    `fly(lead)` makes a flight that meets nothing and fills `looks`.
    """
    found = []
    for lead in swing.leads(count):
        looks.clear()
        fly(lead)
        times = np.unique(looks)
        after = int(np.searchsorted(times, lead))
        found.append(times[after] - times[after - 1])
    return np.array(found)
