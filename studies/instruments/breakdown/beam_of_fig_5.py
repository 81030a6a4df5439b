"""The beam of the letter's Fig. 5: f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s.

The scene's spring with thickness and tape fitted again to T and mu, ball and gap as they were (the letter
prints no drive amplitude with Fig. 5).  What is not printed can be varied: the mass of ball and mount, with
the thickness that keeps T; the damping of the modes above the first, a factor on what the strips give; the
loss in the contact (Hunt-Crossley, by the restitution of a free ball at the approach speed of excess 0.013).

The born period is that of the settled orbit at F/F_g - 1 = 1e-3, started just below grazing; the fold of p3
comes from shooting.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.errors import ContactError
from contact.laws import ContactLaw, HuntCrossley
from contact.orbits import settling
from contact.orbits.continuation import fold_of
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from studies.instruments.calibration import calibrate, free_period, solve_for
from studies.instruments.oscillators import REFERENCE_EXCESS, approach_speed, contact_law_of, hertz_of
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.published import BREAKDOWN

__all__ = [
    "BORN_EXCESS",
    "CHAOS_AT",
    "DECAY_RATE_PER_S",
    "FREE_PERIOD_S",
    "FREQUENCY_HZ",
    "SEARCH_CYCLES",
    "born",
    "driven",
    "fold_of_p3",
    "lossy",
    "scene_of_fig_5",
    "tuned",
]

FREQUENCY_HZ, FREE_PERIOD_S = float(BREAKDOWN["frequency_hz"]), float(BREAKDOWN["free_period_s"])
DECAY_RATE_PER_S, CHAOS_AT = float(BREAKDOWN["decay_rate_per_s"]), float(BREAKDOWN["chaos_at"])
BORN_EXCESS = 1e-3
SEARCH_CYCLES = 1500
NEAR = 0.2
"""Relative distance from the free period of Fig. 5 within which the thickness brings a spring to it."""


def scene_of_fig_5(scene: Scene) -> Scene:
    """The scene with period and damping of Fig. 5; ball and gap as they were."""
    if scene.spring.kind == "modal_data":
        raise ValueError(
            "spring.kind is modal_data; Fig. 5 needs a spring whose thickness can be fitted to its period"
        )
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; Fig. 5 needs a harmonic drive")
    if not abs(scene.single_mode.free_period_s / FREE_PERIOD_S - 1.0) <= NEAR:
        raise ValueError(
            f"single_mode.free_period_s is {scene.single_mode.free_period_s:g} s; to be fitted to the spring "
            f"of Fig. 5 it must be within {100 * NEAR:g} % of {FREE_PERIOD_S:g} s"
        )
    fitted = calibrate(scene, free_period_s=FREE_PERIOD_S, decay_rate_per_s=DECAY_RATE_PER_S)
    return fitted.replace(
        {"single_mode.free_period_s": FREE_PERIOD_S, "single_mode.decay_rate_per_s": DECAY_RATE_PER_S}
    )


def tuned(scene: Scene, period: float, *, mass: float | None = None) -> ModalModel:
    """Modes of the spring with another ball [kg], its sheet so thick that mode 1 has this period [s]."""
    here = scene if mass is None else scene.replace({"tip.mass_kg": mass})
    h = scene.spring.thickness_m
    return model_of(
        solve_for(
            "spring.thickness_m",
            here,
            free_period,
            period,
            name="free period",
            unit="s",
            low=0.7 * h,
            high=1.25 * h,
        )
    )


def driven(
    scene: Scene, model: ModalModel, *, factor: float = 1.0, local_restitution: float | None = None
) -> StroboscopicMap:
    """The driven spring; `factor` on the rates of the higher modes, `local_restitution` of the contact."""
    rates = np.array(model.decay_rate)
    rates[1:] *= factor
    law = contact_law_of(scene) if local_restitution is None else lossy(scene, local_restitution)
    return StroboscopicMap(
        oscillator=ImpactOscillator(
            model=replace(model, decay_rate=rates),
            stop=Stop(gap=scene.stop.gap_m, law=law),
            drive=HarmonicDrive(frequency=FREQUENCY_HZ),
        )
    )


def lossy(scene: Scene, restitution: float) -> ContactLaw:
    """Hertz's law with the loss that gives a free ball this restitution at the speed of excess 0.013."""
    return HuntCrossley.with_restitution(
        stiffness=hertz_of(scene).stiffness,
        restitution=restitution,
        velocity=approach_speed(FREQUENCY_HZ, scene.stop.gap_m, REFERENCE_EXCESS),
    )


def born(strobed: StroboscopicMap, cycles: int = SEARCH_CYCLES) -> tuple[int, int]:
    """Period and impacts of the settled orbit at excess 1e-3, started from the motion just below grazing."""
    settled = settling.born(strobed, BORN_EXCESS, most_cycles=cycles)
    return settled.period, settled.impacts


def fold_of_p3(strobed: StroboscopicMap) -> float | None:
    """F_3/F_g - 1 of the p3 orbit with one collision; None where there is none."""
    try:
        orbit = fold_of(Shooting(oscillator=strobed.oscillator, period=3))
    except ContactError:
        return None
    return None if orbit is None else orbit.excess
