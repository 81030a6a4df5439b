"""From a scene to the three descriptions that the letter compares, at one drive frequency.

    beam_of(scene, f)           the spring with its modes and the contact of the scene
    single_mode_oscillator(...) Eq. (1) of the letter with its restitution
    nordmark_of(scene, f)       Eqs. (2), (3) of the letter with the coefficients of Eq. (1)

The linear contact whose stiffness is left open (0) gets k = M (pi / t_c)^2, M the mass of ball and mount and
t_c its contact time under Hertz's law at the approach speed of excess 0.013 (the letter's Fig. 4): half a
period of M on that spring lasts as long as the Hertz contact.
"""

from __future__ import annotations

import math

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.laws import ContactLaw, HertzContact, LinearContact, NewtonRestitution
from contact.nordmark import NordmarkMap
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of, single_mode_of

__all__ = ["approach_speed", "beam_of", "contact_law_of", "hertz_of", "nordmark_of", "single_mode_oscillator"]

REFERENCE_EXCESS = 0.013
"""Excess of the letter's Fig. 4."""


def approach_speed(frequency: float, gap: float, excess: float) -> float:
    """Tip velocity at the stop, steady motion at excess e above 0: 2 pi f gap sqrt((1 + e)^2 - 1) [m/s]."""
    return 2.0 * math.pi * frequency * gap * math.sqrt(excess * (2.0 + excess))


def hertz_of(scene: Scene) -> HertzContact:
    """Hertz's law for the ball and the plate of the scene."""
    tip = scene.tip
    return HertzContact.of_bodies(
        radius=tip.ball_radius_m,
        youngs_modulus=tip.ball_young_modulus_pa,
        poissons_ratio=tip.ball_poisson_ratio,
        other_modulus=tip.plate_young_modulus_pa,
        other_ratio=tip.plate_poisson_ratio,
    )


def contact_law_of(scene: Scene) -> ContactLaw:
    """The contact law of the scene."""
    keys = scene.contact
    if keys.law == "newton":
        return NewtonRestitution(local_restitution=keys.local_restitution)
    if keys.law == "hertz":
        return hertz_of(scene)
    stiffness = keys.stiffness_n_per_m
    if stiffness == 0.0:
        mass = scene.modal_data.tip_mass_kg if scene.spring.kind == "modal_data" else scene.tip.mass_kg
        if not mass > 0:
            raise SceneError(
                "contact.stiffness_n_per_m is 0, to be found from the contact time of the ball, but the "
                "ball has no mass: give the stiffness or the mass above zero"
            )
        middle = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2]
        speed = approach_speed(middle, scene.stop.gap_m, REFERENCE_EXCESS)
        stiffness = mass * (math.pi / hertz_of(scene).contact_time(mass, speed)) ** 2
    return LinearContact(stiffness=stiffness, damping=keys.damping_ns_per_m)


def beam_of(scene: Scene, frequency: float, model: ModalModel | None = None) -> ImpactOscillator:
    """The spring of the scene at drive `frequency` [Hz]; `model` saves computing its modes again."""
    return ImpactOscillator(
        model=model_of(scene) if model is None else model,
        stop=Stop(gap=scene.stop.gap_m, law=contact_law_of(scene)),
        drive=HarmonicDrive(frequency=frequency),
    )


def single_mode_oscillator(scene: Scene, frequency: float) -> ImpactOscillator:
    """Eq. (1) of the letter at drive frequency `frequency` [Hz], with the gap of the scene."""
    law = NewtonRestitution(local_restitution=scene.single_mode.restitution)
    return ImpactOscillator(
        model=single_mode_of(scene),
        stop=Stop(gap=scene.stop.gap_m, law=law),
        drive=HarmonicDrive(frequency=frequency),
    )


def nordmark_of(scene: Scene, frequency: float) -> NordmarkMap:
    """Eqs. (2), (3) of the letter, corrected, at drive frequency `frequency` [Hz]."""
    return NordmarkMap.from_oscillator(single_mode_oscillator(scene, frequency))
