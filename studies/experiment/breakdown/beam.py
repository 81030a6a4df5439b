"""Eq. (1) and the beam at the letter's Fig. 5, f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s, and what it leaves
open.

The scene's spring with thickness and tape fitted again to T and mu, ball and gap as they were (the letter
prints no drive amplitude with Fig. 5). What is not printed can be varied: the mass of ball and mount, with
the thickness that keeps T, and a factor on the damping of the modes above the first.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from beam import ModalModel
from contact import ContactError, HarmonicDrive, ImpactOscillator, Stop, StroboscopicMap
from contact.orbits import born, fold_excess
from studies import letter
from studies.physics.calibration import calibrate, calibrate_thickness
from studies.shell.scene import Scene, SceneError, contact_law_of, harmonic, model_of, single_mode_of

FREQUENCY_HZ, FREE_PERIOD_S = letter.BREAKDOWN["frequency_hz"], letter.BREAKDOWN["free_period_s"]
DECAY_RATE_PER_S, BORN_PERIOD = letter.BREAKDOWN["decay_rate_per_s"], letter.BREAKDOWN["born_period"]

BORN_EXCESS, SEARCH_CYCLES = 1e-3, 1500
"""Where the born period is read, and the drive periods that a motion gets to settle there."""

NEAR = 0.2
"""Relative distance from the free period of Fig. 5 beyond which a spring is another one."""


def fig_5(scene: Scene) -> Scene:
    """The scene with period and damping of Fig. 5; ball and gap as they were."""
    if harmonic(scene).spring.kind == "modal_data":
        raise SceneError("spring.kind is modal_data; the thickness of the spring of Fig. 5 must be fitted")
    if not abs(scene.single_mode.free_period_s / FREE_PERIOD_S - 1.0) <= NEAR:
        raise SceneError(
            f"single_mode.free_period_s is {scene.single_mode.free_period_s:g} s; to be fitted to the spring "
            f"of Fig. 5 it must be within {100 * NEAR:g} % of {FREE_PERIOD_S:g} s"
        )
    fitted = calibrate(scene, free_period_s=FREE_PERIOD_S, decay_rate_per_s=DECAY_RATE_PER_S)
    return fitted.replace(
        {"single_mode.free_period_s": FREE_PERIOD_S, "single_mode.decay_rate_per_s": DECAY_RATE_PER_S}
    )


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
        return StroboscopicMap(
            oscillator=ImpactOscillator(
                model=replace(self.model, decay_rate=rates),
                drive=HarmonicDrive(frequency=FREQUENCY_HZ),
                stop=Stop(gap=self.scene.stop.gap_m, law=contact_law_of(self.scene)),
            )
        )


def single_mode(scene: Scene, restitution: float) -> Spring:
    """Eq. (1) with this restitution [1]."""
    law = {"contact.law": "newton", "contact.local_restitution": restitution}
    return Spring(scene=scene.replace(law), model=single_mode_of(scene), tip_mass_kg=0.0)


@dataclass(frozen=True, kw_only=True)
class Cell:
    """What a beam is born with at grazing: period (0: none up to 64), impacts, fold of p3 (where the period
    is the letter's)."""

    tip_mass_kg: float
    higher_damping: float
    period: int
    impacts: int
    fold_p3: float | None = None


def cell_of(spring: Spring) -> Cell:
    """One cell of the search."""
    strobed = spring.strobed()
    settled = born(strobed, BORN_EXCESS, most_cycles=SEARCH_CYCLES)
    return Cell(
        tip_mass_kg=spring.tip_mass_kg,
        higher_damping=spring.higher_damping,
        period=settled.period,
        impacts=settled.impacts,
        fold_p3=fold_of_p3(strobed) if settled.period == BORN_PERIOD else None,
    )


def fold_of_p3(strobed: StroboscopicMap) -> float | None:
    """F_3/F_g - 1 of the p3 orbit; None where there is none."""
    try:
        return fold_excess(strobed, 3)
    except ContactError:
        return None


def nearest_first(springs: Iterable[Spring], mass: float) -> list[Spring]:
    """Sorted by their distance from the scene: damping as the strips', then a mass near to `mass` [kg]."""

    def distance(one: Spring) -> tuple[float, float]:
        ratio = one.tip_mass_kg / mass if mass > 0.0 else 1.0 + one.tip_mass_kg
        return abs(math.log(one.higher_damping)), abs(math.log(ratio))

    return sorted(springs, key=distance)
