"""One elastic collision of the spring, exactly and by another method.

The driven spring comes from its steady motion, so that the higher modes are at rest before the first touch;
the collision is that of ``contact.collision``.  The energy is followed on the same spring without damping and
drive, from a few steps before the touch: what a method loses there, it loses by itself, since law and spring
lose nothing.  It is given in units of mode 1's energy of approach, v^2/(2 phi_1^2); the bent spring holds
some 1/(2 excess) times as much, of which a method that damps mode 1 loses a part as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from beam import ModalModel
from contact.collision import Collision, before_collision, collisions
from contact.integrators.method import Integrator
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import State

__all__ = ["ElasticCollision", "Maker"]

Maker = Callable[[float], Integrator]
"""A method for a step [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticCollision:
    """One elastic collision: the driven spring before it, its exact outcome, and the unit of the step [s]."""

    driven: ImpactOscillator
    start: State
    exact: Collision
    unit: float
    touch: State

    @staticmethod
    def of(driven: ImpactOscillator, unit: float | None) -> ElasticCollision:
        """`unit` None stands for the contact time."""
        start = before_collision(driven)
        motion = simulate(driven, start, periods=2)
        exact = collisions(driven, motion, unfinished="drop")[0]
        impacts = motion.impacts
        touch = State(displacement=impacts.displacement_start[0], velocity=impacts.velocity_start[0])
        unit = exact.contact_time if unit is None else unit
        return ElasticCollision(driven=driven, start=start, exact=exact, unit=unit, touch=touch)

    @property
    def free(self) -> ImpactOscillator:
        """The same spring without damping and drive."""
        model = self.driven.model
        undamped = ModalModel(
            omega=model.omega, decay_rate=np.zeros(model.omega.size), phi=model.phi,
            participation=model.participation,
        )  # fmt: skip
        return replace(self.driven, model=undamped, drive=None)

    def measured(self, method: Integrator) -> tuple[float, float]:
        """Restitution and kick of the first collision by `method`; NaN if its damping keeps the tip off the
        stop."""
        motion = simulate(self.driven, self.start, periods=2, method=method)
        found = collisions(self.driven, motion, unfinished="drop")
        return (found[0].restitution, found[0].kick) if found else (math.nan, math.nan)

    def lost(self, method: Integrator, step: float, place: float) -> tuple[float, float]:
        """Energy lost in the contact and until a drive period after it, over mode 1's energy of approach."""
        spring, back = self.free, (2.0 + place) * step
        unit = 0.5 * (self.exact.approach / spring.model.phi[0]) ** 2
        away = State(displacement=self.touch.displacement, velocity=-self.touch.velocity)
        turned = simulate(spring, away, duration=back).end  # exact flight, backwards in time
        start = State(displacement=turned.displacement, velocity=-turned.velocity)
        begun = float(spring.energy(start.displacement, start.velocity))
        count = math.ceil(self.driven.period / step)
        times = step * np.arange(1, count + 1)
        motion = simulate(spring, start, duration=count * step, times=times, method=method)
        energy = (begun - spring.energy(motion.displacement, motion.velocity)) / unit
        away_again = motion.displacement @ spring.model.phi <= spring.stop.gap
        after = np.flatnonzero(away_again & (times > float(motion.impacts.end[0]) - 0.5 * step))
        return float(energy[after[0]]), float(energy[-1])
