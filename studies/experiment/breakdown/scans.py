"""Scans of the amplitude through grazing, and the island of Eq. (1) below it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from contact import MaximalFamily
from contact.orbits import OrbitDiagram, Shooting, born, orbit_diagram
from studies import letter
from studies.experiment.breakdown.beam import BORN_EXCESS, Spring, fold_of_p3, single_mode
from studies.shell.scene import READOUT, Scene

CHAOS_AT = letter.BREAKDOWN["chaos_at"]
LOWEST, HIGHEST = -0.14, 0.012
"""Least lower end of the scans, and their upper end: the letter's finer steps above grazing."""

ISLAND_STEP, ISLAND_CYCLES = 5e-4, 1500
"""Step of the excess and drive periods at each, for the end of the island; beyond it chaos is a transient."""

LAST = 0.05
"""Impacts may go on below p3 for this part of its excess and still end with it."""

Diagram = OrbitDiagram[Any]


@dataclass(frozen=True, kw_only=True)
class Island:
    """p3 and chaos of Eq. (1) below grazing, from the fold of p3 to the last excess with impacts."""

    restitution: float
    fold_p3: float
    end: float


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What is born at excess 1e-3 (period 0: did not settle), the fold of p3, the part of the downward scan
    on p3 with one impact, and the excess at which that scan has its last impacts."""

    description: str
    tip_mass_kg: float | None
    higher_damping: float
    born_period: int
    born_impacts: int
    fold_p3: float | None
    p3_first: float | None
    p3_last: float | None
    impacts_end: float | None

    @property
    def ends_on_p3(self) -> bool:
        """Whether p3 is met in the downward scan, and met last."""
        if self.p3_last is None or self.impacts_end is None:
            return False
        return abs(self.impacts_end - self.p3_last) <= LAST * abs(self.p3_last)


def scanned(
    named: tuple[str, Spring], *, points: int, cycles: int, early: bool
) -> tuple[Outcome, dict[str, Diagram]]:
    """What is born, and the upward and downward scan through grazing: even steps from below the fold of p3,
    finer ones above; the state is carried along."""
    name, spring = named
    strobed = spring.strobed()
    fold = fold_of_p3(strobed)
    lowest = max(1.12 * fold, LOWEST) if fold is not None and fold < -0.01 else -0.1
    below = np.linspace(lowest, 0.0, points)[:-1]
    values = np.concatenate([below, np.linspace(0.0, HIGHEST, points // 2 + 1)[1:]])
    scan = partial(
        orbit_diagram,
        strobed,
        observe=partial(strobed.readout, name=READOUT),
        settle_cycles=cycles,
        record_cycles=letter.STROBE_POINTS,
        early=early,
    )
    up = scan(values, strobed.at(lowest).steady())
    down = scan(values[::-1], up.end)
    settled = born(strobed, BORN_EXCESS, most_cycles=cycles)
    on_p3 = down.excess[(down.period == 3) & (down.impacts == 1)].tolist() or [None]
    struck = down.excess[down.impacts > 0].tolist() or [None]
    outcome = Outcome(
        description=name,
        tip_mass_kg=spring.tip_mass_kg or None,
        higher_damping=spring.higher_damping,
        born_period=settled.period,
        born_impacts=settled.impacts,
        fold_p3=fold,
        p3_first=on_p3[0],
        p3_last=on_p3[-1],
        impacts_end=struck[-1],
    )
    return outcome, {"up": up, "down": down}


def periods(diagram: Diagram) -> np.ndarray:
    """Periods of a scan; a motion without impacts is p1, even while it has not quite come to rest."""
    return np.where((diagram.impacts == 0) & (np.array(diagram.kind) != "failed"), 1, diagram.period)


def island(scene: Scene, restitution: float, *, step: float = ISLAND_STEP) -> tuple[Island, Diagram]:
    """The p3 of Eq. (1) and what it turns into, followed upwards from its fold until the motion is free.

    The motion without impacts is stable all along, so that the island is not connected to what is born at
    grazing.
    """
    strobed = single_mode(scene, restitution).strobed()
    fold = MaximalFamily.from_oscillator(strobed.oscillator, period=3).fold()
    assert fold is not None  # f T lies in the band of p3
    orbit = Shooting(oscillator=strobed.oscillator, period=3).at_speed(1.02 * fold.speed)
    whole = orbit_diagram(
        strobed,
        np.arange(orbit.excess, 0.0, step),
        orbit.strobe_state(),
        observe=strobed.tip,
        settle_cycles=ISLAND_CYCLES,
        record_cycles=letter.STROBE_POINTS,
    )
    free = np.flatnonzero((whole.impacts == 0) & (np.array(whole.kind) != "failed"))
    kept = slice(0, int(free[0]) if free.size else None)
    columns = ("excess", "points", "period", "impacts", "cycles")
    diagram = replace(whole, **{name: getattr(whole, name)[kept] for name in columns})
    end = float(diagram.excess[-1]) if diagram.excess.size else fold.excess  # lost with the first step
    return Island(restitution=restitution, fold_p3=fold.excess, end=end), diagram
