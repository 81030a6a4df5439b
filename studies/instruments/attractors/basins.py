"""Basins of attraction of Eq. (1) on the strobe plane, between the fold of p_m and grazing.

The starts are a grid in x/gap and x'/(2 pi f gap).  Without impacts the deviation from the steady motion p1
is a damped oscillation with the envelope

    phi sqrt(u^2 + ((u' + c u/2)/w_d)^2),

u the deviation of the mode, c its decay rate, w_d its damped frequency: once the envelope is smaller than
what the steady peak leaves to the wall, the motion never touches again.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from contact.errors import ContactError
from contact.flight.modal_flow import steady_motion
from contact.orbits.settling import settle
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene

__all__ = ["Basins", "CLOSE", "FAR", "MOST_PERIODS", "NEAR", "basins"]

FAR, CLOSE = 1.5, 0.03
"""Half the sides of the two planes of starts, in x/gap and x'/(2 pi f gap): all of it, and around p1."""

NEAR = 1e-5
"""Distance from an orbit at which a motion has reached it, in gaps (a basin narrower than that is missed)."""

MOST_PERIODS = 4000
"""Bound of a motion in the basins; what has not been told by then is counted as something else."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Basins:
    """Starts on the strobe plane and where they lead.

    `x` [m] and `velocity` [m/s] of the starts, `rest` those of p1; `leads`, shape (velocities, x): 1 motion
    without impacts, m for the p_m orbit, 0 something else, -1 starts behind the wall; `orbit`, shape (m, 2):
    strobe points of p_m.
    """

    x: np.ndarray
    velocity: np.ndarray
    leads: np.ndarray
    orbit: np.ndarray
    rest: tuple[float, float]
    period: int

    def parts(self) -> dict[str, float]:
        """Part of the starts before the wall that leads to each."""
        before = self.leads >= 0
        names = {1: "p1 without impacts", self.period: f"p{self.period}", 0: "something else"}
        return {name: float(np.mean(self.leads[before] == code)) for code, name in names.items()}


def basins(
    scene: Scene,
    frequency: float,
    excess: float,
    side: int,
    workers: int,
    tell: Callable[[], None],
    *,
    close: bool = False,
) -> Basins:
    """Basins of Eq. (1) between fold and grazing on a grid of `side` by `side` starts, all or `close` to p1.

    A motion has settled on p1 when the envelope of its deviation is smaller than what is left to the wall:
    then it never touches again.  It has settled on p_m at a distance `NEAR` of one of its points.
    """
    strobed = StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency))
    here = strobed.at(excess)
    motion, gap = here.oscillator.motion(), here.oscillator.stop.gap
    born = settle(strobed.at(1e-3), strobed.steady(), most_cycles=MOST_PERIODS)
    below = strobed.at(1e-3)
    state = born.end
    for part in np.linspace(0.0, 1.0, 9):  # carry p_m down to the excess
        below = strobed.at(1e-3 + part * (excess - 1e-3))
        state = settle(below, state, most_cycles=MOST_PERIODS).end
    end = settle(here, state, most_cycles=MOST_PERIODS)
    period = end.period
    orbit = end.points[-period:] if period else end.points[-1:]
    q, q_rate = steady_motion(motion, np.zeros(1))
    weight = float(here.oscillator.model.phi[0])
    omega, damped, half = float(motion.omega[0]), float(motion.damped[0]), 0.5 * float(motion.decay[0])
    speed = 2.0 * np.pi * frequency
    rest = (weight * float(q[0, 0]), weight * float(q_rate[0, 0]))
    grid = np.linspace(-1.0, 1.0, side)
    x = rest[0] + CLOSE * gap * grid if close else np.linspace(-FAR, 1.0, side) * gap
    velocity = rest[1] + CLOSE * speed * gap * grid if close else FAR * speed * gap * grid

    def envelope(points: np.ndarray) -> np.ndarray:
        u = points[:, 0] / weight - q[0, 0]
        v = points[:, 1] * omega / weight - q_rate[0, 0]
        return weight * np.hypot(u, (v + half * u) / damped)

    room = -excess * gap  # between the steady peak and the wall

    def line(j: int) -> np.ndarray:
        leads = np.zeros(side, dtype=np.int64)
        for i in range(side):
            now = State(displacement=np.array([x[i] / weight]), velocity=np.array([velocity[j] / weight]))
            if x[i] >= gap:
                leads[i] = -1
                continue
            try:
                for _ in range(MOST_PERIODS // 32):
                    run = here.orbit(now, 32)
                    now = run.end
                    if envelope(run.points[-1:])[0] < room:
                        leads[i] = 1
                        break
                    if period > 1 and np.min(np.max(np.abs(orbit - run.points[-1]), axis=1)) < NEAR * gap:
                        leads[i] = period
                        break
            except ContactError:
                pass
        tell()
        return leads

    with ThreadPoolExecutor(max_workers=workers) as pool:
        leads = np.array(list(pool.map(line, range(side))))
    points = np.column_stack([orbit[:, 0], orbit[:, 1] * omega])
    return Basins(x=x, velocity=velocity, leads=leads, orbit=points, rest=rest, period=period)
