"""The contact law of a scene, from the bodies of ball and plate or from its own numbers."""

import math

from contact import ContactLaw, HertzContact, HuntCrossley, LinearContact, NewtonRestitution, PowerContact
from studies import letter
from studies.shell.scene.key import SceneError
from studies.shell.scene.values import Scene


def approach_speed(frequency: float, gap: float, excess: float) -> float:
    """Tip velocity at the stop, steady motion at excess e above 0: 2 pi f gap sqrt((1 + e)^2 - 1) [m/s]."""
    return 2.0 * math.pi * frequency * gap * math.sqrt(excess * (2.0 + excess))


def hertz_of(scene: Scene) -> HertzContact:
    """Hertz's law for the ball and the plate of the scene."""
    ball = {"youngs_modulus": "tip.ball_young_modulus_pa", "poissons_ratio": "tip.ball_poisson_ratio"}
    plate = {"other_modulus": "tip.plate_young_modulus_pa", "other_ratio": "tip.plate_poisson_ratio"}
    return scene.make(HertzContact.of_bodies, {"radius": "tip.ball_radius_m"} | ball | plate)


def ball_mass(scene: Scene) -> float:
    """Mass of ball and mount, from which a law gets its numbers [kg]; SceneError if the ball has none."""
    mass = scene.modal_data.tip_mass_kg if scene.spring.kind == "modal_data" else scene.tip.mass_kg
    if not mass > 0:
        law, stiffness = scene.contact.law, f"{scene.contact.stiffness_n_per_m:g} N/m"
        words = "both need the mass of the ball; give it above zero"
        raise SceneError(f"contact.law is {law}, and contact.stiffness_n_per_m is {stiffness}: {words}")
    return mass


def contact_law_of(scene: Scene) -> ContactLaw:
    """The contact law of the scene.

    A linear contact whose stiffness is left open (0) gets k = M (pi/t_c)^2, M the mass of ball and mount and
    t_c its contact time under Hertz's law at the approach speed of the letter's Fig. 4.
    """
    law, stiffness = scene.contact.law, scene.contact.stiffness_n_per_m
    if law == "hertz":
        return hertz_of(scene)
    if law == "newton":
        return scene.make(NewtonRestitution, {"local_restitution": "contact.local_restitution"})
    if law == "hunt_crossley":
        keys = {"dissipation": "contact.dissipation_s_per_m"}
        return scene.make(HuntCrossley, keys, stiffness=hertz_of(scene).stiffness)
    if law == "tsuji":
        keys = {"restitution": "contact.local_restitution"}
        given = {"stiffness": hertz_of(scene).stiffness, "exponent": 1.5, "mass": ball_mass(scene)}
        return scene.make(PowerContact.with_restitution, keys, **given)
    if stiffness == 0.0:
        mass = ball_mass(scene)
        middle = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2]
        speed = approach_speed(middle, scene.stop.gap_m, letter.TIME_TRACE_EXCESS)
        stiffness = mass * (math.pi / hertz_of(scene).contact_time(mass, speed)) ** 2
    keys = {"stiffness": "contact.stiffness_n_per_m", "damping": "contact.damping_ns_per_m"}
    return scene.make(LinearContact, keys, stiffness=stiffness)
