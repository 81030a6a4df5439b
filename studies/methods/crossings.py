r"""Crossings of the stop of known depth, at any phase of the looks that a method takes.

Undamped modes move freely and are all at their peak at t = 0, where the tip is at gap (1 + delta):

    x(t) = gap (1 + delta) sum_k b_k cos(omega_k t),   sum b_k = 1,   a = sum b_k omega_k^2 gap

so that it is beyond the stop for about 2 sqrt(2 delta gap/a) around t = 0 and, for a small delta, at no other
time of the run; with delta < 0 it stays away. Runs start at lead times (multiples of the golden ratio) that
put the peak at every phase of a grid, whatever its spacing. Which crossings a method misses is a column of
``studies.methods.work_precision``; ``studies.methods.stability`` sets that beside theory.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from beam import ModalModel
from contact import ContactError, ImpactKind, ImpactOscillator, State, Stop, simulate
from contact.integrators import Integrator

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing:
    """Free modes that peak together before a stop.

    The peak lies `lead` to `lead + spread` after a run starts, `tail` before it ends [s]; the others are in
    step with mode 1 at the peak alone.
    """

    oscillator: ImpactOscillator
    height: np.ndarray  # b_k [1]
    lead: float
    spread: float
    tail: float

    @staticmethod
    def of(model: ModalModel, stop: Stop, ringing: float) -> Crossing:
        """All modes of the model, without their damping; those above the first make up the part `ringing` of
        the peak [1]."""
        n, period = model.omega.size, 2.0 * math.pi / float(model.omega[0])
        parts = (0.6, 0.25, 0.4) if n == 1 else (0.05, 0.02, 0.02)
        lead, spread, tail = (part * period for part in parts)
        height = np.ones(1) if n == 1 else np.array([1.0 - ringing, *[ringing / (n - 1)] * (n - 1)])
        free = ImpactOscillator(model=replace(model, decay_rate=0.0 * model.decay_rate), stop=stop)
        return Crossing(oscillator=free, height=height, lead=lead, spread=spread, tail=tail)

    @property
    def rate(self) -> float:
        """sqrt(a/gap) [1/s]."""
        return math.sqrt(float(self.height @ self.oscillator.model.omega**2))

    def leads(self, count: int) -> np.ndarray:
        """Lead times that put the peak at every phase [s]."""
        return self.lead + self.spread * ((np.arange(count) + 0.5) * GOLDEN % 1.0)

    def start(self, overshoot: float, lead: float) -> State:
        """The state `lead` before the peak."""
        model = self.oscillator.model
        size = self.oscillator.stop.gap * (1.0 + overshoot) * self.height / model.phi
        turn = model.omega * lead
        return State(displacement=size * np.cos(turn), velocity=size * model.omega * np.sin(turn))

    def height_at(self, overshoot: float, time: np.ndarray) -> np.ndarray:
        """Tip displacement over gap, minus 1, at times from the peak [1]; accurate for small overshoots."""
        phase = np.multiply.outer(time, self.oscillator.model.omega)
        return overshoot - (1.0 + overshoot) * (2.0 * np.sin(0.5 * phase) ** 2) @ self.height

    def touch(self, method: Integrator, overshoot: float, lead: float) -> float:
        """Time of the first touch by a method, from the peak; NaN if it finds none or fails [s]."""
        start, duration = self.start(overshoot, lead), lead + self.tail
        try:
            impacts = simulate(self.oscillator, start, duration=duration, method=method).impacts
        except ContactError:
            return math.nan
        touches = impacts.start[impacts.kind == ImpactKind.IMPACT] - lead
        return float(touches[0]) if touches.size else math.nan
