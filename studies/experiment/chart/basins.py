"""Basins of attraction of Eq. (1) on the strobe plane, between the fold of p_m and grazing.

The starts are a grid in x/gap and x'/(2 pi f gap). A motion has reached an orbit when a strobe lies within
`NEAR` of one of the orbit's, in x and x'/omega: for p_m then nothing else is near, and next to the motion
without impacts, p1, what is left of the free oscillation is a small part of what the tip keeps off the wall.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import born, settle
from studies.shell.scene import Scene, single_mode_at
from studies.shell.study import Run

EXCESS = -0.006

FAR = 1.5
"""Half the side of the plane of starts, in x/gap and x'/(2 pi f gap)."""

NEAR, OF_EXCESS = 1e-5, 0.1
"""Distance from an orbit at which a motion has reached it, in gaps (a basin narrower than that is missed),
and at most in excesses below grazing."""

MOST_PERIODS, STRETCH = 4000, 32
"""Bound of a motion in the basins (what has not been told by then is something else); strobes looked at
together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Starts:
    """Starts on the strobe plane, `x` [m] and `velocity` [m/s], and what they may lead to.

    `orbits`: strobe points (x, x'/omega) [m] of p1 without impacts and of p_m by their periods, shape (m, 2).
    """

    strobed: StroboscopicMap
    x: np.ndarray
    velocity: np.ndarray
    orbits: Mapping[int, np.ndarray]
    near: float

    @property
    def period(self) -> int:
        """m of p_m; 1 if there is none beside p1."""
        return max(self.orbits)

    def strobes(self, period: int) -> np.ndarray:
        """Strobe points of an orbit, x [m] and x' [m/s], shape (period, 2)."""
        return self.orbits[period] * (1.0, float(self.strobed.oscillator.model.omega[0]))

    def leads(self, x: float, velocity: float) -> int:
        """Where a start leads: 1 motion without impacts, m for p_m, 0 something else, -1 behind the wall."""
        if x >= self.strobed.scale:
            return -1
        state = State(displacement=np.array([x]), velocity=np.array([velocity]))
        try:
            for _ in range(MOST_PERIODS // STRETCH):
                run = self.strobed.orbit(state, STRETCH)
                state = run.end
                for code, points in self.orbits.items():
                    if np.abs(points - run.points[-1]).max(axis=1).min() < self.near:
                        return code
        except ContactError:
            pass
        return 0

    def line(self, velocity: float) -> list[int]:
        """`leads` for all x at one velocity."""
        return [self.leads(float(x), velocity) for x in self.x]


def parts(leads: np.ndarray, period: int) -> dict[str, float]:
    """Part of the starts before the wall that leads to each motion, p_m that of `period`."""
    before = leads[leads >= 0]
    names = {period: f"p{period}", 0: "something else", 1: "p1 without impacts"}
    return {name: float(np.mean(before == code)) for code, name in names.items()}


def plane_of(scene: Scene, frequency: float, side: int, excess: float = EXCESS) -> Starts:
    """`side` by `side` starts on the strobe plane at drive `frequency` [Hz]."""
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    here = strobed.at(excess)
    end = settle(here, born(strobed, most_cycles=MOST_PERIODS).end, most_cycles=MOST_PERIODS)
    rest, gap, speed = here.coordinates(here.steady()), here.scale, here.oscillator.unit_speed
    return Starts(
        strobed=here,
        orbits={max(end.period, 1): end.points[-max(end.period, 1) :], 1: rest[None]},
        near=gap * min(NEAR, -OF_EXCESS * excess),
        x=np.linspace(-FAR, 1.0, side) * gap,
        velocity=FAR * speed * np.linspace(-1.0, 1.0, side),
    )


def basins(scene: Scene, run: Run, f: float, side: int) -> Mapping[str, object]:
    """The basins of Eq. (1) at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import cut_figure  # matplotlib is slow to import

    plane = plane_of(scene, f, side)
    leads = np.array(run.map(plane.line, plane.velocity.tolist(), "basins"))  # shape (velocities, x)
    run.arrays("basins", x=plane.x, velocity=plane.velocity, leads=leads)
    run.figure("basins", cut_figure.draw_basins(plane, leads, f), cut_figure.BASINS)
    period, shares = plane.period, parts(leads, plane.period)
    both = period > 1 and shares[f"p{period}"] > 0.0  # p1 without impacts is stable below grazing
    run.verdict(
        "coexistence",
        "agrees" if both else "differs",
        found=f"Eq. (1): p1 and p{period}" if both else "Eq. (1): one of them alone",
        note=f"at excess {EXCESS:g} the start decides which of them is reached",
    )
    return {"basins": {"excess": EXCESS, "period": period, "parts": shares}}
