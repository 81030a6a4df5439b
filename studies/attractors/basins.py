"""Basins of attraction of Eq. (1) on the strobe plane, between the fold of p_m and grazing.

The starts are a grid in x/gap and x'/(2 pi f gap). Without impacts the deviation from the steady motion p1 is
a damped oscillation with the envelope

    sqrt(u^2 + ((u' + c u/2)/w_d)^2),

u the deviation of the tip, c its decay rate, w_d its damped frequency: once the envelope is smaller than what
the steady peak leaves to the wall, the motion never touches again and has reached p1. It has reached p_m at a
distance `NEAR` of one of its strobe points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import born, settle
from studies.scene import Scene, single_mode_at

__all__ = ["Plane", "parts", "plane_of"]

FAR = 1.5
"""Half the side of the plane of starts, in x/gap and x'/(2 pi f gap)."""

NEAR = 1e-5
"""Distance from an orbit at which a motion has reached it, in gaps (a basin narrower than that is missed)."""

BESIDE = 1e-3
"""Distance from p1 of a start that is to lead to it, in gaps."""

MOST_PERIODS, STRETCH = 4000, 32
"""Bound of a motion in the basins (what has not been told by then is something else); strobes looked at
together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Plane:
    """Starts on the strobe plane: `x` [m], `velocity` [m/s]; `orbit`, shape (m, 2), strobe points of p_m [m,
    m/s]."""

    strobed: StroboscopicMap
    excess: float
    x: np.ndarray
    velocity: np.ndarray
    orbit: np.ndarray
    period: int

    @cached_property
    def rest(self) -> tuple[float, float]:
        """The strobe point of p1 [m, m/s]."""
        steady = self.strobed.steady()
        return float(steady.displacement[0]), float(steady.velocity[0])

    def envelope(self, state: State) -> float:
        """Of the deviation from p1 [m]."""
        model = self.strobed.oscillator.model
        half = 0.5 * float(model.decay_rate[0])
        damped = math.sqrt(float(model.omega[0]) ** 2 - half**2)
        u, v = float(state.displacement[0]) - self.rest[0], float(state.velocity[0]) - self.rest[1]
        return math.hypot(u, (v + half * u) / damped)

    def leads(self, x: float, velocity: float) -> int:
        """Where a start leads: 1 motion without impacts, m for p_m, 0 something else, -1 behind the wall."""
        gap, omega = self.strobed.scale, float(self.strobed.oscillator.model.omega[0])
        if x >= gap:
            return -1
        state = State(displacement=np.array([x]), velocity=np.array([velocity]))
        try:
            for _ in range(MOST_PERIODS // STRETCH):
                state = self.strobed.orbit(state, STRETCH).end
                if self.envelope(state) < -self.excess * gap:
                    return 1
                away = np.abs(self.orbit - (state.displacement[0], state.velocity[0])) / (1.0, omega)
                if self.period > 1 and float(np.min(np.max(away, axis=1))) < NEAR * gap:
                    return self.period
        except ContactError:
            pass
        return 0

    def free(self) -> bool:
        """Whether a start beside p1 leads to it: a coarse grid may have none in its basin."""
        x, velocity = self.rest
        return self.leads(x - BESIDE * self.strobed.scale, velocity) == 1

    def line(self, velocity: float) -> list[int]:
        """`leads` for all x at one velocity."""
        return [self.leads(float(x), velocity) for x in self.x]


def parts(leads: np.ndarray, period: int) -> dict[str, float]:
    """Part of the starts before the wall that leads to each motion, p_m that of `period`."""
    before = leads[leads >= 0]
    names = {1: "p1 without impacts", period: f"p{period}", 0: "something else"}
    return {name: float(np.mean(before == code)) for code, name in names.items()}


def plane_of(scene: Scene, frequency: float, excess: float, side: int) -> Plane:
    """`side` by `side` starts on the strobe plane at drive `frequency` [Hz]."""
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    here = strobed.at(excess)
    end = settle(here, born(strobed, most_cycles=MOST_PERIODS).end, most_cycles=MOST_PERIODS)
    orbit = end.points[-max(end.period, 1) :] * (1.0, float(here.oscillator.model.omega[0]))
    gap, speed = here.scale, 2.0 * math.pi * frequency * here.scale
    return Plane(
        strobed=here, excess=excess, orbit=orbit, period=end.period, x=np.linspace(-FAR, 1.0, side) * gap,
        velocity=FAR * speed * np.linspace(-1.0, 1.0, side),
    )  # fmt: skip
