"""Eq. (1) and the beam at the letter's Fig. 5: what is open, what is born, scans through grazing, the island.

The scene's spring with thickness and tape fitted again to T and mu, ball and gap as they were (the letter
prints no drive amplitude with Fig. 5). What is not printed can be varied: the mass of ball and mount, with
the thickness that keeps T, and a factor on the damping of the modes above the first.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from beam import ModalModel
from contact import StroboscopicMap
from contact.orbits import Shooting, fold_excess, onset_m, onset_orbit, orbit_diagram
from studies import letter
from studies.physics.calibration import calibrate, calibrate_thickness
from studies.physics.descriptions import Diagram, fold_orbit, or_none, up_and_down
from studies.shell.scene import Scene, SceneError, beam_at, harmonic, model_of, single_mode_of, spring_of

FREQUENCY_HZ, FREE_PERIOD_S = letter.BREAKDOWN["frequency_hz"], letter.BREAKDOWN["free_period_s"]
DECAY_RATE_PER_S, BORN_PERIOD = letter.BREAKDOWN["decay_rate_per_s"], letter.BREAKDOWN["born_period"]

BORN_EXCESS, SEARCH_CYCLES = 1e-3, 1500
"""Where the born period is read, and the drive periods that a motion gets to settle there."""

NEAR = 0.2  # relative distance from the free period of Fig. 5 beyond which a spring is another one

CHAOS_AT = letter.BREAKDOWN["chaos_at"]
LOWEST, HIGHEST = -0.14, 0.012
"""Least lower end of the scans, and their upper end: the letter's finer steps above grazing."""

ISLAND_STEP, ISLAND_CYCLES = 5e-4, 1500
"""Step of the excess and drive periods at each, for the end of the island; beyond it chaos is a transient."""

LAST = 0.05  # impacts may go on below p3 for this part of its excess and still end with it


def fig_5(scene: Scene) -> Scene:
    """The scene with period and damping of Fig. 5; ball and gap as they were."""
    spring_of(harmonic(scene))  # refuses measured modes: a thickness is fitted
    if not abs(scene.single_mode.free_period_s / FREE_PERIOD_S - 1.0) <= NEAR:
        raise SceneError(
            f"single_mode.free_period_s is {scene.single_mode.free_period_s:g} s; to be fitted to the spring "
            f"of Fig. 5 it must be within {100 * NEAR:g} % of {FREE_PERIOD_S:g} s"
        )
    own = {"single_mode.free_period_s": FREE_PERIOD_S, "single_mode.decay_rate_per_s": DECAY_RATE_PER_S}
    return calibrate(scene, free_period_s=FREE_PERIOD_S, decay_rate_per_s=DECAY_RATE_PER_S).replace(own)


def tuned(scene: Scene, mass: float) -> ModalModel:
    """Modes of the spring with another ball [kg], its sheet so thick that mode 1 keeps its period."""
    return model_of(calibrate_thickness(scene.replace({"tip.mass_kg": mass}), FREE_PERIOD_S))


@dataclass(frozen=True, kw_only=True)
class Spring:
    """The spring with one choice of what is not printed; Eq. (1) has no ball."""

    scene: Scene
    model: ModalModel
    tip_mass_kg: float
    higher_damping: float = 1.0

    def __str__(self) -> str:
        return f"{1e3 * self.tip_mass_kg:g} g, damping x {self.higher_damping:g}"

    def strobed(self) -> StroboscopicMap:
        """Driven as in Fig. 5."""
        rates = np.array(self.model.decay_rate)
        rates[1:] *= self.higher_damping
        model = replace(self.model, decay_rate=rates)
        return StroboscopicMap(oscillator=beam_at(self.scene, FREQUENCY_HZ, model))


def single_mode(scene: Scene, restitution: float) -> Spring:
    """Eq. (1) with this restitution [1]."""
    law = {"contact.law": "newton", "contact.local_restitution": restitution}
    return Spring(scene=scene.replace(law), model=single_mode_of(scene), tip_mass_kg=0.0)


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The period that begins at grazing for one choice of what is not printed."""

    tip_mass_kg: Annotated[float, "mass of ball and mount [kg]"]
    higher_damping: Annotated[float, "factor on the damping of the higher modes"]
    m: Annotated[int, "born period; 0 for none up to 64"]
    impacts: Annotated[int, "impacts in a period"]


def cell_of(spring: Spring) -> Cell:
    """One cell of the search."""
    settled = onset_orbit(spring.strobed(), BORN_EXCESS, most_cycles=SEARCH_CYCLES)
    return Cell(
        tip_mass_kg=spring.tip_mass_kg,
        higher_damping=spring.higher_damping,
        m=settled.m,
        impacts=settled.impacts,
    )


def nearest_first(springs: Iterable[Spring], mass: float) -> list[Spring]:
    """Sorted by their distance from the scene: damping as the strips', then a mass near to `mass` [kg]."""

    def distance(one: Spring) -> tuple[float, float]:
        ratio = one.tip_mass_kg / mass if mass > 0.0 else 1.0 + one.tip_mass_kg
        return abs(math.log(one.higher_damping)), abs(math.log(ratio))

    return sorted(springs, key=distance)


@dataclass(frozen=True, kw_only=True)
class Island:
    """p3 and chaos of Eq. (1) below grazing, from the fold of p3 to the last excess with impacts."""

    restitution: float
    fold_p3: Annotated[float, "fold of p3, F/F_g − 1"]
    end: Annotated[float, "last excess with impacts, F/F_g − 1"]


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What is born at excess 1e-3, and how the downward scan ends."""

    description: str
    tip_mass_kg: Annotated[float | None, "mass of ball and mount [kg]"]
    higher_damping: Annotated[float, "factor on the damping of the higher modes"]
    born_period: Annotated[int, "born period; 0 where the motion did not settle"]
    fold_p3: Annotated[float | None, "fold of p3, F/F_g − 1"]
    p3_first: Annotated[float | None, "p3 of the downward scan from, F/F_g − 1"]
    p3_last: Annotated[float | None, "p3 of the downward scan to, F/F_g − 1"]
    impacts_end: Annotated[float | None, "last impacts of the downward scan, F/F_g − 1"]

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
    fold = or_none(fold_excess, strobed, 3)
    lowest = max(1.12 * fold, LOWEST) if fold is not None and fold < -0.01 else -0.1
    below = np.linspace(lowest, 0.0, points)[:-1]
    values = np.concatenate([below, np.linspace(0.0, HIGHEST, points // 2 + 1)[1:]])
    counts = {"settle_cycles": cycles, "record_cycles": letter.STROBE_POINTS}
    ways = up_and_down(strobed, values, **counts, early=early)
    down = ways["down"]
    on_p3 = down.excess[(down.m == 3) & (down.impacts == 1)].tolist() or [None]
    struck = down.excess[down.impacts > 0].tolist() or [None]
    outcome = Outcome(
        description=name,
        tip_mass_kg=spring.tip_mass_kg or None,
        higher_damping=spring.higher_damping,
        born_period=onset_m(strobed, BORN_EXCESS, most_cycles=cycles),
        fold_p3=fold,
        p3_first=on_p3[0],
        p3_last=on_p3[-1],
        impacts_end=struck[-1],
    )
    return outcome, ways


def periods(diagram: Diagram) -> np.ndarray:
    """Periods of a scan; a motion without impacts is p1, even while it has not quite come to rest."""
    return np.where((diagram.impacts == 0) & (np.array(diagram.kind) != "failed"), 1, diagram.m)


def island(scene: Scene, restitution: float, *, step: float = ISLAND_STEP) -> tuple[Island, Diagram]:
    """The p3 of Eq. (1) and what it turns into, followed upwards from its fold until the motion is free.

    The motion without impacts is stable all along, so that the island is not connected to what is born at
    grazing.
    """
    strobed = single_mode(scene, restitution).strobed()
    fold = fold_orbit(strobed.oscillator, 3)
    assert fold is not None  # f T lies in the band of p3
    orbit = Shooting(oscillator=strobed.oscillator, m=3).at_speed(1.02 * fold.speed)
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
    columns = ("excess", "points", "m", "impacts", "cycles")
    diagram = replace(whole, **{name: getattr(whole, name)[kept] for name in columns})
    end = float(diagram.excess[-1]) if diagram.excess.size else fold.excess  # lost with the first step
    return Island(restitution=restitution, fold_p3=fold.excess, end=end), diagram
