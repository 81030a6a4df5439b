"""The beam of the letter's Fig. 5, f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s, and what it leaves open.

The scene's spring with thickness and tape fitted again to T and mu, ball and gap as they were (the letter
prints no drive amplitude with Fig. 5). What is not printed can be varied: the mass of ball and mount, with
the thickness that keeps T; a factor on the damping of the modes above the first; the loss in the contact
(Hunt-Crossley, by the restitution of a free ball at the approach speed of excess 0.013).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beam import ModalModel
from contact import ContactError, HarmonicDrive, HuntCrossley, ImpactOscillator, Stop, StroboscopicMap
from contact.orbits import Shooting, born, fold_of
from studies import letter
from studies.calibration import calibrate, free_period, solve_for
from studies.scene import Scene, SceneError, approach_speed, contact_law_of, harmonic, hertz_of, model_of

__all__ = ["Beam", "Cell", "Errors", "at_errors", "cell_of", "fig_5", "fold_of_p3", "nearest_first", "tuned"]

FREQUENCY_HZ, FREE_PERIOD_S = letter.BREAKDOWN["frequency_hz"], letter.BREAKDOWN["free_period_s"]
DECAY_RATE_PER_S, BORN_PERIOD = letter.BREAKDOWN["decay_rate_per_s"], letter.BREAKDOWN["born_period"]

BORN_EXCESS, SEARCH_CYCLES = 1e-3, 1500
"""Where the born period is read, and the drive periods that a motion gets to settle there."""

NEAR = 0.2
"""Relative distance from the free period of Fig. 5 within which the thickness brings a spring to it."""

THICKNESSES = (0.7, 1.25)
"""Where the thickness that keeps T is looked for, over that of the scene."""


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


def tuned(scene: Scene, mass: float | None = None, period: float = FREE_PERIOD_S) -> ModalModel:
    """Modes of the spring with another ball [kg], its sheet so thick that mode 1 has this period [s]."""
    here = scene if mass is None else scene.replace({"tip.mass_kg": mass})
    between = (THICKNESSES[0] * scene.spring.thickness_m, THICKNESSES[1] * scene.spring.thickness_m)
    return model_of(solve_for("spring.thickness_m", here, free_period, period, name="free period", unit="s",
                              between=between))  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Beam:
    """The spring with one choice of what is not printed; `local_restitution` None keeps the scene's law."""

    scene: Scene
    model: ModalModel
    tip_mass_kg: float
    higher_damping: float = 1.0
    local_restitution: float | None = None

    def strobed(self) -> StroboscopicMap:
        """Driven as in Fig. 5."""
        rates = np.array(self.model.decay_rate)
        rates[1:] *= self.higher_damping
        law = contact_law_of(self.scene)
        if self.local_restitution is not None:
            law = HuntCrossley.with_restitution(
                stiffness=hertz_of(self.scene).stiffness, restitution=self.local_restitution,
                velocity=approach_speed(FREQUENCY_HZ, self.scene.stop.gap_m, letter.TIME_TRACE_EXCESS),
            )  # fmt: skip
        return StroboscopicMap(oscillator=ImpactOscillator(
            model=replace(self.model, decay_rate=rates), stop=Stop(gap=self.scene.stop.gap_m, law=law),
            drive=HarmonicDrive(frequency=FREQUENCY_HZ),
        ))  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Cell:
    """What a beam is born with at grazing: period (0: none up to 64, None: failed), impacts,
    fold of p3."""

    tip_mass_kg: float
    higher_damping: float
    local_restitution: float | None
    period: int | None
    impacts: int | None
    fold_p3: float | None = None
    failure: str = ""


def cell_of(beam: Beam) -> Cell:
    """One cell of the search; the fold is known where the period is the letter's."""
    numbers = (beam.tip_mass_kg, beam.higher_damping, beam.local_restitution)
    period, impacts, fold, failure = None, None, None, ""
    try:
        settled = born(beam.strobed(), BORN_EXCESS, most_cycles=SEARCH_CYCLES)
        period, impacts = settled.period, settled.impacts
        fold = fold_of_p3(beam.strobed()) if period == BORN_PERIOD else None
    except ContactError as error:
        failure = str(error)
    return Cell(
        tip_mass_kg=numbers[0], higher_damping=numbers[1], local_restitution=numbers[2], period=period,
        impacts=impacts, fold_p3=fold, failure=failure,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Errors:
    """What the calibrated beam is born with at an end of the letter's errors of T and mu (period 0: none)."""

    free_period_s: float
    decay_rate_per_s: float
    period: int | None
    impacts: int | None


def at_errors(scene: Scene, change: tuple[float, float]) -> Errors:
    """The calibrated beam with other T and mu."""
    period, rate = FREE_PERIOD_S + change[0], DECAY_RATE_PER_S + change[1]
    here = scene.replace({"damping.decay_rate_per_s": rate})
    cell = cell_of(Beam(scene=here, model=tuned(here, period=period), tip_mass_kg=scene.tip.mass_kg))
    return Errors(free_period_s=period, decay_rate_per_s=rate, period=cell.period, impacts=cell.impacts)


def nearest_first(cells: Sequence[Cell], mass: float) -> list[int]:
    """Places of the cells with the letter's period, by what they ask for: contact elastic, damping as the
    strips', the mass nearest to `mass` [kg]."""

    def asks(place: int) -> tuple[float, float, float]:
        cell = cells[place]
        lost = 1.0 - (1.0 if cell.local_restitution is None else cell.local_restitution)
        return lost, abs(math.log(cell.higher_damping)), abs(math.log(cell.tip_mass_kg / mass))

    return sorted((i for i, cell in enumerate(cells) if cell.period == BORN_PERIOD), key=asks)


def fold_of_p3(strobed: StroboscopicMap) -> float | None:
    """F_3/F_g - 1 of the p3 orbit with one touch; None where there is none."""
    try:
        orbit = fold_of(Shooting(oscillator=strobed.oscillator, period=3))
    except ContactError:
        return None
    return None if orbit is None else orbit.excess
