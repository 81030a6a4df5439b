"""A cut through the plane at one drive frequency: period, impacts and Lyapunov exponent over the amplitude.

The amplitude is raised and lowered again, and the state is carried along. A motion without a period is
chaotic if its exponent is above zero by three standard errors, not settled (a long period or a slow
transient) if it is below by as much, otherwise undecided.

Then basins of attraction of Eq. (1) on the strobe plane, between the fold of p_m and grazing. The starts are
a grid in x/gap and x'/(2 pi f gap). A motion has reached an orbit when a strobe lies within `NEAR` of one of
the orbit's, in x and x'/omega: for p_m then nothing else is near, and next to the motion without impacts, p1,
what is left of the free oscillation is a small part of what the tip keeps off the wall.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import Exponents, Settled, map_exponents, onset_orbit, orbit_exponents, settle
from studies.physics.descriptions import TITLES, both_ways
from studies.shell.scene import READOUT, Scene, single_mode_at

CUT, QUICK_CUT = (np.linspace(-0.016, 0.06, 39), 600), (np.linspace(-0.016, 0.06, 11), 100)
"""Amplitudes of the cut [1] and drive periods in the averages of the exponents; of the small form."""

SIGNIFICANT = 3.0  # standard errors by which an exponent must differ from zero to count

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

WITHOUT, PERIODIC, CHAOTIC = "without impacts", "periodic", "chaotic"
NOT_SETTLED, UNDECIDED = "not settled", "undecided"


@dataclass(frozen=True, kw_only=True)
class Settlement:
    """The settled motion at one amplitude."""

    model: Annotated[str, "description"]
    direction: Annotated[str, "direction of the scan"]
    excess: float
    kind: Annotated[str, "kind of motion"]
    m: int
    impacts: Annotated[int, "impacts in a period"]
    lyapunov_map: Annotated[float, "largest Lyapunov exponent per drive period"]
    error_map: Annotated[float, "standard error of the exponent"]


def kind_of(strobed: StroboscopicMap, settled: Settled[State], cycles: int) -> tuple[str, Exponents]:
    """The kind of motion, and its exponents: averages over `cycles` drive periods where it has no period."""
    if settled.m:
        kind = PERIODIC if settled.impacts else WITHOUT
        return kind, orbit_exponents(strobed, settled.end, settled.m)
    exponents, _end = map_exponents(strobed, settled.end, cycles, align=ALIGN)
    if abs(exponents.largest) <= SIGNIFICANT * exponents.error:
        return UNDECIDED, exponents
    return CHAOTIC if exponents.largest > 0 else NOT_SETTLED, exponents


def carried(
    named: tuple[str, StroboscopicMap], scene: Scene, values: np.ndarray, cycles: int
) -> tuple[list[Settlement], list[np.ndarray], list[str]]:
    """Upward and downward scan of one model, the settled state the start at the next amplitude; with the rows
    their strobed read-out, shape (record_cycles,) each, and third what failed.

    On the way up a motion stays without impacts as far as it can, on the way down it stays on p_m.
    """
    (name, strobed), rows, points, failures = named, list[Settlement](), list[np.ndarray](), list[str]()

    def scan(direction: str, excesses: np.ndarray, state: State) -> tuple[None, State]:
        for excess in excesses.tolist():
            here = strobed.at(excess)
            try:
                settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
                state = replace(settled.end, time=0.0)
                orbit = here.orbit(state, scene.scan.record_cycles)
                kind, exponents = kind_of(here, settled, cycles)
            except ContactError as error:
                failures.append(f"{TITLES[name]}, excess {excess:.6g}, {direction}: {error}")
                continue
            points.append(here.readout(orbit.points, READOUT))
            impacts = settled.impacts if settled.m else 0
            found: dict[str, Any] = {"m": settled.m, "impacts": impacts}
            found |= {"lyapunov_map": exponents.largest, "error_map": exponents.error}
            rows.append(Settlement(model=name, direction=direction, excess=excess, kind=kind, **found))
        return None, state

    both_ways(strobed, values, scan)
    return rows, points, failures


EXCESS = -0.006

FAR = 1.5  # half the side of the plane of starts, in x/gap and x'/(2 pi f gap)

NEAR, OF_EXCESS = 1e-5, 0.1
"""Distance from an orbit at which a motion has reached it, in gaps (a basin narrower than that is missed),
and at most in excesses below grazing."""

MOST_PERIODS, STRETCH = 4000, 32
"""Bound of a motion in the basins (what has reached no orbit by then is something else); strobes looked at
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
    def m(self) -> int:
        """m of p_m; 1 if there is none beside p1."""
        return max(self.orbits)

    def strobes(self, m: int) -> np.ndarray:
        """Strobe points of an orbit, x [m] and x' [m/s], shape (period, 2)."""
        return self.orbits[m] * (1.0, float(self.strobed.oscillator.model.omega[0]))

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


def parts(leads: np.ndarray, m: int) -> dict[str, float]:
    """Part of the starts before the wall that leads to each motion, p_m that of `period`."""
    before = leads[leads >= 0]
    names = {m: f"p{m}", 0: "something else", 1: "p1 without impacts"}
    return {name: float(np.mean(before == code)) for code, name in names.items()}


def plane_of(scene: Scene, frequency: float, side: int, excess: float = EXCESS) -> Starts:
    """`side` by `side` starts on the strobe plane at drive `frequency` [Hz]."""
    strobed = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    here = strobed.at(excess)
    end = settle(here, onset_orbit(strobed, most_cycles=MOST_PERIODS).end, most_cycles=MOST_PERIODS)
    rest, gap, speed = here.coordinates(here.steady()), here.scale, here.oscillator.unit_speed
    return Starts(
        strobed=here,
        orbits={max(end.m, 1): end.points[-max(end.m, 1) :], 1: rest[None]},
        near=gap * min(NEAR, -OF_EXCESS * excess),
        x=np.linspace(-FAR, 1.0, side) * gap,
        velocity=FAR * speed * np.linspace(-1.0, 1.0, side),
    )
